"""From records and a target to a selection, which assess and fragility read as a table."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import rockpulse as rp
from rocking.body.block import Block
from rockpulse.assessment.site_demands import demand_factors
from rockpulse.errors import ConfigError
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.studies.check.code_spectra import spectrum_of
from rockpulse.studies.selection import selection
from rockpulse.studies.selection.selection import fitting_set, own_factors
from rockpulse.views.text.site import selection_overview, selection_table

TIME = np.arange(0.0, 6.0, 0.01)
WIDE = {"factors": (0.01, 100.0), "records": 3, "tolerance": (0.9, 9.0)}
PLAIN, NTC = rp.Config(), rp.CheckSettings(ag=0.25, f0=2.4, tc_star=0.35, ground="B")


def burst(number, event=None, **known):
    """A wave packet of a frequency of its own."""
    ground = (1.0 + 0.1 * number) * np.sin((8.0 + 3.0 * number) * TIME) * np.exp(-(((TIME - 3.0) / 0.8) ** 2))
    name = EVENTS[number] if event is None else event
    return rp.Record(ground, dt=0.01, id=f"burst.{number}", event=name, processed=True, **known)


FEW, EVENTS = 16, ("Kobe", "Maule", "Izmit", "Duzce", "Friuli", "Irpinia", "Cosenza")
RECORDS = [burst(number) for number in range(6)]


@pytest.fixture(autouse=True)
def few_periods(request, monkeypatch):
    """Fewer periods, which take less time, except for real records."""
    if "records_folder" not in request.fixturenames:
        monkeypatch.setattr(selection, "PERIODS", FEW)


def selected(motions=RECORDS, check=NTC, config=PLAIN, **asked):
    return rp.select(motions, replace(config, check=check, selection=rp.SelectionSettings(**{**WIDE, **asked})))


def test_spectra_are_those_of_the_scaled_records_and_their_mean_is_compared_with_the_code():
    found = selected()["selection"].to_dataset()
    periods = found["period"].values.tolist()
    assert (periods[0], periods[-1]) == pytest.approx((0.15, 2.0))
    by_id = {one.id: one for one in RECORDS}
    for row in found["record"].values:
        own, record = found.sel(record=row), by_id[str(row)]
        scaled = replace(record, acceleration=float(own["factor"]) * rp.condition(record).acceleration)
        there = [spectral_acceleration(scaled, period) for period in periods[::5]]
        assert own["spectrum"].values[::5] == pytest.approx(there)
    assert found["mean"].values == pytest.approx(found["spectrum"].values.mean(axis=0))
    assert found["target"].values == pytest.approx([spectrum_of(NTC)(period) for period in periods])
    deviation = (found["mean"] / found["target"] - 1.0).values
    assert found.attrs["lowest"] == pytest.approx(deviation.min())
    assert found.attrs["highest"] == pytest.approx(deviation.max())
    assert found.attrs["mean_deviation"] == pytest.approx(deviation.mean())
    assert found.attrs["mean_absolute_deviation"] == pytest.approx(np.abs(deviation).mean())


def test_the_spectrum_of_one_record_as_target_selects_this_record_with_its_factor(tmp_path):
    periods = np.geomspace(0.15, 2.0, FEW)
    rows = [f"{period!r},{1.7 * spectral_acceleration(RECORDS[4], period)!r}" for period in periods.tolist()]
    (tmp_path / "uhs.csv").write_text("\n".join(["period [s],sa [m/s2]", *rows]))
    config = rp.Config(folder=tmp_path)
    found = selected(check=rp.CheckSettings(), config=config, records=1, target="uhs.csv")["selection"]
    assert found["record"].values.tolist() == ["burst.4"]
    assert float(found["factor"][0]) == pytest.approx(1.7)
    assert abs(found.attrs["lowest"]) < 1e-9
    assert found.attrs["compatible"] == 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("period [s],sa [g]\n0.1,1\n0.9,1\n", r"uhs\.csv: expected a target from 0\.15 to 2 s.* found 0\.1 to 0\.9 s"),
        ("period [s],sa [g]\n", r"uhs\.csv: expected a target from 0\.15 to 2 s.* found no period"),
    ],
)
def test_a_wrong_target_is_an_error_of_its_file_and_row(tmp_path, text, told):
    (tmp_path / "uhs.csv").write_text(text)
    with pytest.raises(ConfigError, match=told):
        selected(config=rp.Config(folder=tmp_path), target="uhs.csv")


def test_too_few_records_of_different_earthquakes_are_an_error():
    with pytest.raises(ConfigError, match=r"expected 7 channels .* found 6\. Of 6 channels, 6 \(of 6 earthquakes\)"):
        selected(records=7)
    nameless = [replace(one, event="") for one in RECORDS]
    with pytest.raises(ConfigError, match=r"found 1\. Of 6 channels, 6 \(of 1 earthquake\) .*\[records\] events"):
        rp.select(nameless, rp.Config(check=NTC, selection=rp.SelectionSettings(**WIDE)))
    with pytest.raises(ConfigError, match=r"found 0\. Of 6 channels, 0 .* from 1000 to 1001"):
        selected(factors=(1000.0, 1001.0))
    with pytest.raises(ConfigError, match=r"\[selection\] target: no target spectrum is given"):
        selected(check=rp.CheckSettings())


@pytest.mark.parametrize(
    ("records", "asked", "told"),
    [
        ({"components": "strongest"}, {}, "ids are known only"),
        ({"components": "sweep"}, {"components": "pairs"}, "as recorded"),
    ],
)
def test_components_that_a_table_cannot_name_are_an_error(records, asked, told):
    with pytest.raises(ConfigError, match=told):
        selected(config=rp.Config(records=rp.RecordSettings(**records)), **asked)


def test_both_channels_of_a_pair_have_one_factor_by_the_geometric_mean_of_their_spectra():
    pairs = []
    for station in range(3):
        known = {"network": "XX", "station": f"S{station}", "source": f"{station}.txt"}
        for place, azimuth in enumerate((0.0, 90.0)):
            one = burst(2 * station + place, event=EVENTS[station], azimuth=azimuth, **known)
            pairs.append(replace(one, component=f"{azimuth:g}", orientation="horizontal"))
    tree = selected([*pairs, burst(6)], components="pairs", records=2)
    found = tree["selection"].to_dataset()
    assert found.sizes["record"] == 4
    factor = found["factor"].values.reshape(2, 2)
    assert factor[:, 0].tolist() == factor[:, 1].tolist()
    both = found["spectrum"].values.reshape(2, 2, -1)
    assert found["mean"].values == pytest.approx(np.sqrt(both[:, 0] * both[:, 1]).mean(axis=0))
    assert "channels without a known partner (1)" in str(tree["failures"]["reason"].values)
    assert "2 pairs of 3" in selection_overview(tree)


@pytest.fixture
def table(tmp_path):
    tree = selected()
    selection_table(tree).to_csv(tmp_path / "chosen.csv", index=False)
    return tree["selection"]


@pytest.mark.sweep
def test_a_demand_scales_the_selected_records_by_their_factors_and_leaves_out_the_others(table, tmp_path):
    demand = rp.DemandSettings("SLV", selection="chosen.csv")
    config = rp.Config(folder=tmp_path, demands=(demand,), models=rp.ModelSettings(use=("linear",)))
    summary = rp.assess(RECORDS, config, {"wall": (0.4, 3.0)})["summary"].to_dataset()
    assert summary["record"].values.tolist() == table["record"].values.tolist()
    assert summary["demand_factor"].values.ravel() == pytest.approx(table["factor"].values)


def test_a_selection_and_a_measure_are_demands_side_by_side(table, tmp_path):
    demands = rp.DemandSettings("SLV", selection="chosen.csv"), rp.DemandSettings("PGA", value=3.0)
    beside = rp.Config(folder=tmp_path, demands=demands)
    factors = [demand_factors([one], Block(0.4, 3.0).lanes(1), beside, one.id)[0] for one in RECORDS]
    chosen = [one.id in table["record"].values for one in RECORDS]
    assert np.isfinite([one for one, _ in factors]).tolist() == chosen
    assert [other for _, other in factors] == pytest.approx([3.0 / one.pga for one in RECORDS])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("record,level\nburst.0,1\n", "expected the column factor"),
        ("record,factor\nburst.0,1\nburst.0,2\n", "expected one row for each record, found 2 for burst.0"),
        ("record,factor\nburst.0,-1\n", r"chosen\.csv: row 1 of column 'factor': expected a number above 0"),
        ("record,factor\nnobody,1\n", r"\[\[demand\]\] selection: no record id matches nobody"),
    ],
)
def test_a_wrong_table_of_a_demand_is_an_error(tmp_path, text, told):
    (tmp_path / "chosen.csv").write_text(text)
    config = rp.Config(folder=tmp_path, demands=(rp.DemandSettings("SLV", selection="chosen.csv"),))
    with pytest.raises(ConfigError, match=told):
        rp.assess(RECORDS, config, {"wall": (0.4, 3.0)})


def test_a_demand_has_a_selection_or_a_value():
    with pytest.raises(ConfigError, match="selection gives the scale factors; remove value"):
        rp.DemandSettings("SLV", selection="chosen.csv", value=3.0)
    with pytest.raises(ConfigError, match=r"\[\[demand\]\] SLV selection: it names records"):
        rp.Config(
            demands=(rp.DemandSettings("SLV", selection="a.csv"),), records=rp.RecordSettings(components="strongest")
        )


@pytest.mark.sweep
def test_fragility_reads_the_table(table, tmp_path):
    config = rp.Config(folder=tmp_path, fragility=rp.FragilitySettings(selection="chosen.csv", measures=("pga",)))
    found = rp.fragility(RECORDS, config, {"wall": (0.4, 3.0)})["capacities"]
    assert found["factor"].values.ravel() == pytest.approx(table["factor"].values)


@pytest.mark.slow
def test_seven_records_of_p695_are_within_ten_percent_of_an_ntc_spectrum(records_folder):
    found, _ = rp.read_all([records_folder / "fema_p695" / "records.zip"], units="g")
    rows = (records_folder / "fema_p695" / "events.tsv").read_text().splitlines()[1:]
    events = {row.split(".txt")[0]: row.split("\t")[1] for row in rows}
    known = [replace(one, event=events[one.id.split(".")[0]]) for one in found]
    tree = rp.select(known, rp.Config(check=NTC))
    found, by_id = tree["selection"].to_dataset(), {one.id: one for one in known}
    assert len(set(found["event"].values)) == 7
    periods = np.geomspace(0.15, 2.0, 237)  # between the periods of the search too
    spectra = [
        [factor * spectral_acceleration(record, period) for period in periods]
        for factor, name in zip(found["factor"].values, found["record"].values, strict=True)
        for record in [rp.condition(by_id[str(name)])]
    ]
    deviation = np.mean(spectra, axis=0) / [spectrum_of(NTC)(period) for period in periods] - 1.0
    assert np.abs(deviation).max() < 0.1
    assert found.attrs["compatible"] == 1


PERIODS = np.geomspace(0.15, 2.0, 24)
BOUNDS = (0.25, 4.0)


def waves(count):
    """(count, k) shapes whose mean over the periods and whose mean over the spectra are 1."""
    phase = 2.0 * np.pi * np.arange(PERIODS.size) / PERIODS.size
    turns = 2.0 * np.pi * np.arange(count) / count
    return 1.0 + 0.5 * np.sin(phase[None, :] + turns[:, None])


def others(count, seed=1):
    """(count, k) shapes with random peaks of their own."""
    random = np.random.default_rng(seed)
    centre, wide = random.uniform(0, PERIODS.size, (count, 1)), random.uniform(2.0, 5.0, (count, 1))
    return 0.5 + 2.0 * np.exp(-(((np.arange(PERIODS.size) - centre) / wide) ** 2))


def test_a_set_whose_mean_is_the_target_is_found_with_its_factors():
    strength = np.array([0.5, 1.6, 3.1, 0.8])
    ratios = np.concatenate([others(30), waves(4) / strength[:, None], others(30, seed=2)])
    found = fitting_set(ratios, [str(row) for row in range(len(ratios))], 4, BOUNDS)
    assert found.members.tolist() == [30, 31, 32, 33]
    assert found.factors == pytest.approx(strength)
    assert found.ratio == pytest.approx(np.ones(PERIODS.size))


def test_the_search_finds_the_best_of_all_sets_where_all_can_be_tried():
    ratios = others(14)
    shapes = ratios * own_factors(ratios, (1e-9, 1e9))[:, None]
    spreads = [np.ptp(np.log(shapes[list(some)].mean(axis=0))) for some in combinations(range(14), 3)]
    found = fitting_set(ratios, [*map(str, range(14))], 3, (1e-9, 1e9))
    assert np.ptp(np.log(found.ratio)) == pytest.approx(min(spreads))


def test_one_earthquake_gives_no_more_than_allowed():
    ratios = np.concatenate([waves(4), others(12)])
    events = ["one"] * 4 + [f"quake {row // 2}" for row in range(12)]
    for most in (1, 2):
        found = fitting_set(ratios, events, 4, BOUNDS, per_event=most)
        named = [events[member] for member in found.members]
        assert max(map(named.count, named)) <= most
    assert fitting_set(ratios, events, 4, BOUNDS, per_event=4).members.tolist() == [0, 1, 2, 3]


def test_factors_stay_within_their_bounds():
    shapes = others(20) / others(20).mean(axis=1, keepdims=True) / np.linspace(0.85, 1.25, 20)[:, None]
    ratios = np.concatenate([waves(4) / 6.0, shapes])  # the best set needs factors of 6
    for bounds in ((0.25, 4.0), (0.8, 1.3)):
        found = fitting_set(ratios, [*map(str, range(24))], 5, bounds)
        assert np.all((found.factors >= bounds[0]) & (found.factors <= bounds[1]))
        assert found.members.min() >= 4
    assert np.isnan(own_factors(ratios, BOUNDS)[:4]).all()


@pytest.mark.parametrize(
    ("tolerance", "low", "high"),
    [
        ((0.1, 0.3), 0.9, 1.265),
        ((0.3, 0.1), 0.78255, 1.1),
        ((0.5, 0.5), 0.83137, 1.16863),
        ((0.01, 0.02), 0.83137, 1.16863),
    ],
)
def test_the_common_factor_centres_the_deviations_unless_the_tolerance_asks_for_another(tolerance, low, high):
    shape = np.linspace(1.0, 1.40566, PERIODS.size)
    found = fitting_set(shape[None, :], ["one"], 1, BOUNDS, tolerance=tolerance)
    assert (found.ratio.min(), found.ratio.max()) == pytest.approx((low, high), abs=1e-4)


def test_the_set_does_not_depend_on_the_order_of_equal_input():
    ratios, events = others(20), [*map(str, range(20))]
    found = fitting_set(ratios, events, 5, BOUNDS)
    reverse = fitting_set(ratios[::-1], events[::-1], 5, BOUNDS)
    assert sorted(19 - reverse.members) == found.members.tolist()


def test_a_zero_spectrum_is_not_used():
    found = fitting_set(np.concatenate([np.zeros((1, PERIODS.size)), waves(2)]), ["a", "b", "c"], 2, BOUNDS)
    assert found.members.tolist() == [1, 2]
