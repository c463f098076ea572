"""From records to the site tree."""

import dataclasses
from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest

import rockpulse as rp
from rockpulse import CalibrationSettings, RecordSettings, RunSettings
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block
from rockpulse.record.measures import SCALING
from rockpulse.studies.site import site_records as site_record

TIME = 0.01 * np.arange(1200)
BLOCKS = {"wall": Block(0.3, 3.0), "pier": Block(0.8, 3.6), "column": Block(1.0, 8.0)}


def shake(seed, size=1.0, event=None, name=None):
    """A burst of random half-waves around 1.5 Hz, 12 s long, PGA of about 0.35 g times the size."""
    generator = np.random.default_rng(seed)
    phases, rates = generator.uniform(0.0, 2.0 * np.pi, 12), generator.uniform(0.6, 3.0, 12)
    motion = np.sin(2.0 * np.pi * rates * TIME[:, None] + phases).sum(axis=1)
    motion *= np.exp(-(((TIME - 5.0) / 2.0) ** 2))
    event = f"Earthquake {'ABCDEFGHIJKL'[seed]}{'ABCDEFGHIJKL'[seed]}" if event is None else event
    return rp.Record(size * 0.6 * motion, dt=0.01, id=name or f"record{seed:02d}", event=event, processed=True)


RECORDS = [shake(seed, 0.7 + 0.06 * seed) for seed in range(8)]


def config(**calibration):
    return Config(calibration=CalibrationSettings(**{"method": "statistics", "bootstrap": 100, **calibration}))


def site(records=RECORDS, settings=None, **calibration):
    return rp.calibrate(records, settings or config(**calibration), BLOCKS)["site"].to_dataset()


@pytest.fixture(scope="module")
def done():
    return site()


def test_the_facts_of_each_record_are_stored():
    known = dataclasses.replace(RECORDS[1], magnitude=6.3, magnitude_type="Mw", vs30=717.0)
    found = site([RECORDS[0], known])
    np.testing.assert_array_equal(found["magnitude"].values, [np.nan, 6.3])
    assert found["magnitude_type"].values.tolist() == ["", "Mw"]
    assert (found["vs30"].values[1].item(), found["vs30"].attrs["units"]) == (717.0, "m s-1")


def test_every_record_has_its_sequence_event_and_rotations(done):
    assert dict(done.sizes) == {"parameter": 5, "record": 8, "block": 3, "site_event": 8, "other_parameter": 5}
    assert done["record"].values.tolist() == [record.id for record in RECORDS]
    assert done["event"].values.tolist() == [record.event for record in RECORDS]
    for record in RECORDS:
        sequence = rp.record_sequence(rp.half_waves(record), phase=rp.intense_phase(record))
        expected = [sequence.main, sequence.secondary / sequence.main, sequence.interval, sequence.main_count]
        found = done["value"].sel(record=record.id).values
        np.testing.assert_allclose(found, [*expected, sequence.duration], rtol=1e-12)
        recorded = rp.models.recorded_response(BLOCKS["pier"], record.acceleration, record.dt)
        assert done["rotation_ratio"].sel(record=record.id, block="pier") == recorded.peak_rotation_ratio


def test_the_medians_are_those_of_the_logarithms(done):
    np.testing.assert_allclose(done["median"], np.exp(np.log(done["value"]).mean("record")), rtol=1e-12)
    assert (done["median_lower"] < done["median"]).all()
    assert (done["median"] < done["median_upper"]).all()
    assert (done["dispersion_lower"] < done["dispersion"]).all()


@pytest.mark.sweep
def test_nothing_depends_on_the_order_of_the_records(done):
    mixed = site([RECORDS[place] for place in (5, 2, 7, 0, 1, 6, 3, 4)])
    assert mixed.identical(done)


@pytest.mark.sweep
def test_the_seed_decides_the_intervals_and_nothing_else(done):
    other = site(settings=dataclasses.replace(config(), run=RunSettings(seed=9)))
    assert (other["median"] == done["median"]).all()
    assert (other["design"] == done["design"])[:4].all()
    assert not (other["median_lower"] == done["median_lower"]).any()


def test_few_records_and_events_are_said_loudly(done):
    assert "FEW RECORDS: 8, fewer than 10" in str(done["site_warnings"].item())
    assert "FEW EVENTS" not in str(done["site_warnings"].item())
    three = site(RECORDS[:3])
    assert "FEW EVENTS: 3, fewer than 5" in str(three["site_warnings"].item())
    # Chi-square of 7 and 2 degrees of freedom: ends apart by factors of 2.5 and 7.6, and more for not knowing those.
    widths = [(one["dispersion_upper"] / one["dispersion_lower"]).values for one in (done, three)]
    assert (widths[0] > 2.4).all()
    assert (widths[1] > 7.5).all()


@pytest.mark.sweep
def test_few_records_are_said_by_the_quantile(done):
    assert "about 1.3 of them lie above the quantile 0.84" in str(done["site_warnings"].item())
    assert "the quantile 0.5 lies among them" in str(site(quantile=0.5)["site_warnings"].item())


@pytest.mark.sweep
def test_events_that_lift_nothing_are_not_counted_as_more():
    still = [dataclasses.replace(shake(seed, 0.01), id=f"still{seed}") for seed in range(4, 8)]
    found = site([*RECORDS[:2], *still])
    assert (int(found["event_count"]), int(found["lifting_events"])) == (6, 2)
    warnings = str(found["site_warnings"].item())
    assert warnings.startswith("FEW EVENTS: 6, only 2 with a record that lifts a block, fewer than 5")
    assert "(lifts no block)" in warnings


def test_a_coverage_that_rests_on_little_says_so(done):
    marks = done["covered"].values
    assert int(done["judged_pairs"]) == np.count_nonzero((marks == 0) | (marks == 1))
    assert int(done["judged_events"]) == np.count_nonzero(((marks == 0) | (marks == 1)).any(axis=1))
    three = site(RECORDS[:3])
    assert int(three["judged_events"]) < 5
    assert f"of {int(three['judged_events'])} of 3 events" in str(three["site_warnings"].item())


@pytest.mark.sweep
def test_unresolved_pairs_count_as_overturned(monkeypatch):
    respond = site_record.recorded_response

    def aloft(blocks, acceleration, dt, vertical):
        response = respond(blocks, acceleration, dt, vertical=vertical)
        if not np.array_equal(acceleration, RECORDS[7].acceleration):
            return response
        return dataclasses.replace(
            response, outcome=np.full(3, rp.models.Outcome.UNRESOLVED), peak_rotation_ratio=np.full(3, np.nan)
        )

    monkeypatch.setattr(site_record, "recorded_response", aloft)
    unresolved = site()
    overturned = np.where(np.isnan(unresolved["rotation_ratio"]), np.inf, unresolved["rotation_ratio"])
    assert float(unresolved["unresolved_share"]) == pytest.approx(1.0 / 8.0)
    assert np.isinf(overturned[7]).all()
    assert set(unresolved["covered"].values[7].tolist()) <= {0, 2}
    main, ratio, interval, count, duration = unresolved["value"].values[7].tolist()
    own = rp.models.ImpulseSequence(main, ratio * main, interval, duration, int(count), spacing="end")
    fallen = [np.isinf(rp.models.sequence_response(block, own).peak_rotation_ratio) for block in BLOCKS.values()]
    assert float(unresolved["unsafe_share"][7]) == pytest.approx(1.0 - np.mean(fallen))
    assert "12.5% of the pairs of record and block are unresolved" in str(unresolved["site_warnings"].item())
    assert float(unresolved["lifted_share"]) >= float(site(RECORDS[:7])["lifted_share"])


def test_one_event_is_a_statement_not_a_number():
    one = site([dataclasses.replace(record, event="Kobe") for record in RECORDS])
    assert str(one["site_warnings"].item()).startswith("ONE EVENT (Kobe): no event can be left out")
    names = ["coverage", "coverage_lower", "coverage_upper", "median_lower", "median_upper", "design_lower"]
    assert all(np.isnan(one[name]).all() for name in [*names, "design_upper", "dispersion_upper", "left_out_main"])
    assert np.isfinite(one["design"]).all()
    assert np.isfinite(one["dispersion"]).all()
    assert (one["covered"] == -1).all()


def test_one_record_alone_still_has_a_design():
    one = site(RECORDS[:1])
    assert np.isfinite(one["design"]).all()
    assert np.isnan(one["dispersion"]).all()


@pytest.mark.sweep
@pytest.mark.parametrize("measure", SCALING)
def test_scaling_to_twice_the_target_doubles_every_impulse(measure):
    weak, strong = (site(RECORDS[:3], scale_to=measure, target=target) for target in (1.5, 3.0))
    name = "largest_impulse" if measure == "impulse" else measure
    np.testing.assert_allclose(strong[name], 3.0, rtol=1e-12)
    np.testing.assert_allclose(strong["scale_factor"], 2.0 * weak["scale_factor"], rtol=1e-12)
    ratio = (strong["value"] / weak["value"]).values
    np.testing.assert_allclose(ratio, np.tile([2.0, 1.0, 1.0, 1.0, 1.0], (3, 1)), rtol=1e-12)
    np.testing.assert_allclose(strong["median"][0], 2.0 * weak["median"][0], rtol=1e-12)


def test_scaled_beyond_the_usual_is_said():
    far = site(RECORDS[:2], scale_to="pga", target=40.0)
    assert "2 of 2 records are scaled by less than 0.25 or more than 4" in str(far["site_warnings"].item())
    assert "scaled by" in str(far["warnings"][0].item())
    assert "scaled by" in str(far["processing"][0].item())


@pytest.mark.sweep
def test_weights_by_event_give_every_event_the_same():
    records = [*RECORDS, *(shake(0, 1.5, name=f"more{number}") for number in range(3))]
    found = site(records, weights="event")
    sums = found["weight"].groupby(found["event"]).sum()
    np.testing.assert_allclose(sums, len(records) / 8)


def test_a_table_of_weights_and_events_is_used(tmp_path):
    ids = [record.id for record in RECORDS]
    pd.DataFrame({"record": ids, "weight": [0, 0, 0, 0, 1, 1, 2, 2]}).to_csv(tmp_path / "weights.csv", index=False)
    pd.DataFrame({"record": ids, "event": list("aabbccdd")}).to_csv(tmp_path / "events.csv", index=False)
    settings = Config(
        calibration=CalibrationSettings(method="statistics", weights="weights.csv", bootstrap=200),
        records=RecordSettings(events="events.csv"),
        folder=tmp_path,
    )
    found = site(settings=settings)
    assert found["event"].values.tolist() == list("aabbccdd")
    assert (int(found["record_count"]), int(found["event_count"])) == (4, 2)
    expected = np.average(np.log(found["value"].values[4:, 0]), weights=[1, 1, 2, 2])
    assert np.log(found["median"].values[0]) == pytest.approx(expected, rel=1e-12)
    assert found["weight"].values.mean() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("record,weight\nrecord00,1\n", "has no weight for 7 of 8 records: record01"),
        ("record,weight\n" + "".join(f"record0{n},0\n" for n in range(8)), "weights of all records are 0"),
        ("record,weight\nrecord00,heavy\n", "expected a number >= 0, found 'heavy'"),
        ("record,weight\nrecord00,-1\n", "expected a number >= 0"),
        ("record,weight\nrecord00,1\nrecord00,2\n", "more than one row for record00"),
        ("record,weight\nrecord00,1\n\nrecord01,1,2\n", "row 4: expected the 2 cells of the header, found 3"),
        ("record,weight\n" + "".join(f"record0{n},1,2\n" for n in range(8)), "row 2: expected the 2 cells"),
        ("record,weight\nrecord00,\n", "row 2: expected a record and its weight, found an empty cell"),
        ("id,weight\nrecord00,1\n", "missing: record; found: id, weight"),
        ("", "expected a CSV table"),
    ],
)
def test_tables_of_weights_that_do_not_fit_are_refused(tmp_path, text, message):
    (tmp_path / "weights.csv").write_text(text)
    settings = dataclasses.replace(config(weights="weights.csv"), folder=tmp_path)
    with pytest.raises(ConfigError, match=message):
        site(settings=settings)


def test_a_record_that_fails_is_a_row_and_never_the_end():
    dead = rp.Record(np.zeros(1000), dt=0.01, id="dead", event="Nowhere", processed=True)
    tree = rp.calibrate([RECORDS[0], dead], config(), BLOCKS)
    assert "dead" not in tree["site"]["record"].values
    rows = tree["failures"].to_dataset()
    assert (rows["kind"].values.tolist(), rows["stage"].values.tolist()) == (["failed"], ["calibrate"])
    assert "dead" in str(rows["reason"].values[0])
    with pytest.raises(RecordRefused, match=r"no record could be calibrated[\s\S]*dead"):
        rp.calibrate([dead], config(), BLOCKS)


def test_bodies_that_nothing_lifts_have_no_design():
    with pytest.raises(RecordRefused, match="no record lifts a block"):
        rp.calibrate(RECORDS, config(), {"slab": Block(6.0, 6.0)})


def test_a_body_of_several_restitutions_is_several_blocks():
    found = rp.calibrate(RECORDS[:2], config(), {"pier": Block(0.8, 3.6, restitution=[0.7, 0.9])})["site"]
    assert found["block"].values.tolist() == ["pier C 0.7", "pier C 0.9"]
    assert found["restitution"].values.tolist() == [0.7, 0.9]


@pytest.mark.sweep
def test_without_bodies_the_default_family_is_judged():
    found = rp.calibrate(RECORDS[:1], config())["site"]
    assert found.sizes["block"] == 100


def test_horizontal_pairs_are_rotated_and_verticals_act_as_in_an_assessment():
    def channel(number, orientation, azimuth):
        return dataclasses.replace(
            shake(number, event="Kobe"),
            network="XX",
            station="STA",
            channel=f"HN{'NEZ'[number]}",
            orientation=orientation,
            azimuth=azimuth,
            start_time=datetime(2020, 1, 1, tzinfo=UTC),
            source="one.file",
        )

    north, east = channel(0, "horizontal", 0.0), channel(1, "horizontal", 90.0)
    up = channel(2, "vertical", np.nan)
    settings = dataclasses.replace(
        config(scale_to="pga", target=3.0),
        records=RecordSettings(components="azimuth", azimuth=30.0, include_vertical=True),
    )
    tree = rp.calibrate([north, east, up], settings, BLOCKS)
    found = tree["site"].to_dataset()
    assert found.sizes["record"] == 1
    assert found["event"].values.tolist() == ["Kobe"]
    assert "vertical acceleration" in str(found["processing"].values[0])
    plain = dataclasses.replace(settings, records=RecordSettings(components="azimuth", azimuth=30.0))
    level = rp.calibrate([north, east, up], plain, BLOCKS)["site"]
    assert (found["rotation_ratio"].values != level["rotation_ratio"].values).any()
    assert tree["failures"]["kind"].values.tolist() == ["vertical"]
