"""From records to the site tree."""

import dataclasses
from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest

import rockpulse as rp
from rockpulse import CalibrationSettings, ConditioningSettings, RecordSettings, RunSettings, SequenceSettings
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block
from rockpulse.record.measures import SCALING

TIME = 0.01 * np.arange(1200)
NONE = ConditioningSettings(baseline="none")
BLOCKS = {"wall": Block(0.3, 3.0), "pier": Block(0.8, 3.6), "column": Block(1.0, 8.0)}
SHAPE = ("ratio", "interval", "main_count")


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
    return Config(calibration=CalibrationSettings(**{"bootstrap": 100, **calibration}))


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
    assert (found["vs30"].values[1].item(), found["vs30"].attrs["units"]) == (717.0, "m s^-1")


def test_every_record_has_its_sequence_and_the_site_their_medians(done):
    assert dict(done.sizes) == {"record": 8, "block": 3, "site_event": 8}
    assert done["record"].values.tolist() == [record.id for record in RECORDS]
    assert done["event"].values.tolist() == [record.event for record in RECORDS]
    for record in RECORDS:
        sequence = rp.record_sequence(rp.half_waves(record), phase=rp.intense_phase(record))
        own = done.sel(record=record.id)
        expected = [sequence.secondary / sequence.main, sequence.interval, sequence.main_count]
        np.testing.assert_allclose([float(own[f"record_{name}"]) for name in SHAPE], expected, rtol=1e-12)
    for name in SHAPE:
        middle, low, high = (float(done[f"{name}{end}"]) for end in ("", "_lower", "_upper"))
        assert middle == np.sort(done[f"record_{name}"].values)[3]
        assert 0.0 <= low <= middle <= high


@pytest.mark.slow
def test_nothing_depends_on_the_order_of_the_records(done):
    mixed = site([RECORDS[place] for place in (5, 2, 7, 0, 1, 6, 3, 4)])
    assert mixed.identical(done)


@pytest.mark.slow
def test_the_seed_decides_the_intervals_and_nothing_else(done):
    other = site(settings=dataclasses.replace(config(), run=RunSettings(seed=9)))
    for name in (*SHAPE, "effective_impulse", "main"):
        np.testing.assert_array_equal(other[name], done[name])
    assert not (other["effective_impulse_lower"] == done["effective_impulse_lower"]).any()


@pytest.mark.sweep
def test_the_number_of_main_impulses_can_be_given_and_must_be_one():
    given = dataclasses.replace(config(quantile=0.5), sequence=SequenceSettings(main_count=7))
    found = site(RECORDS[:5], given)
    assert [float(found[f"main_count{end}"]) for end in ("", "_lower", "_upper")] == [7.0] * 3
    with pytest.raises(ConfigError, match=r'main_count: "none" gives no design sequence'):
        site(settings=dataclasses.replace(config(), sequence=SequenceSettings(main_count="none")))


@pytest.mark.slow
@pytest.mark.parametrize("measure", SCALING)
def test_scaling_to_twice_the_target_doubles_every_impulse(measure):
    weak, strong = (site(RECORDS[:3], scale_to=measure, target=target) for target in (1.5, 3.0))
    name = "largest_impulse" if measure == "impulse" else measure
    np.testing.assert_allclose(strong[name], 3.0, rtol=1e-12)
    np.testing.assert_allclose(strong["scale_factor"], 2.0 * weak["scale_factor"], rtol=1e-12)
    for name in SHAPE:
        np.testing.assert_allclose(strong[f"record_{name}"], weak[f"record_{name}"], rtol=1e-12)


def test_scaled_beyond_the_usual_is_said():
    far = site(RECORDS[:2], scale_to="pga", target=40.0)
    assert "2 of 2 records are scaled by less than 0.25 or more than 4" in str(far["site_warnings"].item())
    assert "scaled by" in str(far["warnings"][0].item())
    assert "scaled by" in str(far["processing"][0].item())


@pytest.mark.sweep
def test_a_table_of_weights_and_events_is_used(tmp_path):
    ids = [record.id for record in RECORDS]
    pd.DataFrame({"record": ids, "weight": [0, 0, 0, 0, 1, 1, 2, 2]}).to_csv(tmp_path / "weights.csv", index=False)
    pd.DataFrame({"record": ids, "event": list("aabbccdd")}).to_csv(tmp_path / "events.csv", index=False)
    settings = Config(
        calibration=CalibrationSettings(weights="weights.csv", bootstrap=200),
        records=RecordSettings(events="events.csv"),
        folder=tmp_path,
    )
    found = site(settings=settings)
    assert found["event"].values.tolist() == list("aabbccdd")
    assert (int(found["record_count"]), int(found["event_count"])) == (4, 2)
    assert found["weight"].values.mean() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("record,weight\nrecord00,1\n", "has no weight for 7 of 8 records: record01"),
        ("record,weight\n" + "".join(f"record0{n},0\n" for n in range(8)), "weights of all records are 0"),
        ("record,weight\nrecord00,heavy\n", "expected a number >= 0, found 'heavy'"),
        ("record,weight\nrecord00,-1\n", "expected a number >= 0"),
        ("record,weight\nrecord00,1\nrecord00,2\n", "more than one row for record00"),
        ("record,weight\nrecord00,1\n\nrecord01,1,2\n", "row 2: expected 2 cells, as in the heading, found 3"),
        ("record,weight\nrecord00,\n", "row 1: expected a record and its weight, found an empty cell"),
        ("id,weight\nrecord00,1\n", "missing: record; found: id, weight"),
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


def test_records_without_three_half_waves_have_no_sequence():
    motion = 5.0 * np.where(abs(TIME - 5.0) < 0.5, np.cos(np.pi * (TIME - 5.0)), 0.0)
    pulses = [rp.Record(motion, 0.01, f"p{number}", event=f"Quake {'ABCDE'[number] * 3}") for number in range(5)]
    with pytest.raises(RecordRefused, match="no record has the three half-waves"):
        rp.calibrate(pulses, dataclasses.replace(config(quantile=0.5), conditioning=NONE), BLOCKS)


def test_a_body_of_several_restitutions_is_several_blocks():
    found = rp.calibrate(RECORDS[:2], config(), {"pier": Block(0.8, 3.6, restitution=[0.7, 0.9])})["site"]
    assert found["block"].values.tolist() == ["pier C 0.7", "pier C 0.9"]
    assert found["restitution"].values.tolist() == [0.7, 0.9]


def test_horizontal_pairs_are_rotated_and_verticals_are_left_out():
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
    assert "the vertical acceleration is left out" in str(found["site_warnings"].item())
    assert tree["failures"]["kind"].values.tolist() == ["vertical"]
