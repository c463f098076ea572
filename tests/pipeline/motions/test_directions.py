"""Which motions are assessed, and what the answers of all directions come to."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import xarray as xr

from rockpulse import (
    BlockSettings,
    ConditioningSettings,
    DemandSettings,
    IntensePhaseSettings,
    ModelSettings,
    RecordSettings,
)
from rockpulse.assessment.answers import answers_of
from rockpulse.assessment.assessment import assess
from rockpulse.assessment.direction_statistics import largest_over, median_over, smallest_over
from rockpulse.assessment.verdict import verdicts
from rockpulse.config.configuration import Config
from rockpulse.models import Outcome
from rockpulse.motions.directions import conditioned_motions, plan_motions, planned_ids, sweep_azimuths
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from rockpulse.remark import code_of
from rockpulse.views.report.bodies import body_table
from rockpulse.views.shared.files_used import failure_rows, files_used
from rockpulse.views.text import large_overview
from rockpulse.views.text.capacity import smallest_capacities
from rockpulse.views.text.directions import direction_table
from rockpulse.views.text.overview import overview

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)
DT = 0.01
TIME = DT * np.arange(1200)
#: A burst along the azimuth of 40 degrees, and a tenth of it across.
ALONG = 4.5 * np.sin(2.0 * np.pi * TIME) * np.exp(-(((TIME - 5.0) / 1.5) ** 2))
ACROSS = 0.1 * 4.5 * np.cos(3.0 * np.pi * TIME) * np.exp(-(((TIME - 5.0) / 1.5) ** 2))
POLARISED = 40.0
WALL = BlockSettings(name="wall", width=0.4, height=3.0)
TOWER = BlockSettings(name="tower", width=3.0, height=9.0)


def channel(azimuth, station="CCC", across=ACROSS, **options):
    turn = np.radians(azimuth - POLARISED)
    code = f"{azimuth:g}"
    known = {"id": f"CI.{station}..{code}@20190706T031953", "network": "CI", "station": station, "channel": code}
    known |= {"start_time": START, "processed": True, "source": f"{station}.v1", "orientation": "horizontal"}
    return Record(ALONG * np.cos(turn) + across * np.sin(turn), DT, azimuth=azimuth, **known | options)


def upwards(station="CCC"):
    return channel(0.0, station, id=f"{station}.up", channel="Up", orientation="vertical")


def config(components, blocks=(WALL, TOWER), models=None, **records):
    return Config(
        blocks=blocks, records=RecordSettings(components=components, **records), models=models or ModelSettings()
    )


def sweep(*records, **options):
    return assess(records, config("sweep", azimuth_step=20.0, **options))


def motions_under(records, options):
    """The motions that come of all channels, and the names of what they come of."""
    planned, failures = plan_motions(records, options)
    assert not failures
    motions = [(one.name, motion) for one in planned for motion in conditioned_motions(one, options)]
    return [motion for _, motion in motions], [name for name, _ in motions]


@pytest.fixture(scope="module")
def tree():
    return sweep(channel(90.0), channel(0.0))


def test_as_recorded_nothing_is_rotated():
    records = [channel(90.0), channel(0.0)]
    motions, _ = motions_under(records, Config())
    assert [motion.record.id for motion in motions] == [record.id for record in records]
    for motion, record in zip(motions, records, strict=True):
        np.testing.assert_array_equal(motion.record.acceleration, record.acceleration)


def test_a_channel_is_conditioned_behind_its_remarks():
    raw = replace(channel(0.0), processed=False, acceleration=channel(0.0).acceleration + 0.5)
    options = replace(
        config("azimuth", azimuth=0.0, include_vertical=True), conditioning=ConditioningSettings(baseline="none")
    )
    (motion,), _ = motions_under([raw], options)
    expected = condition(raw, **options.conditioning)
    np.testing.assert_array_equal(motion.record.acceleration, expected.acceleration)
    assert motion.record.warnings[0].startswith("no pair: as recorded")
    assert [code_of(text) for text in motion.record.warnings[1:]] == ["vertical_missing", "baseline_drift"]
    assert motion.record.warnings[2:] == expected.warnings


def test_one_azimuth_is_one_motion_of_the_pair():
    motions, _ = motions_under([channel(90.0), channel(0.0)], config("azimuth", azimuth=POLARISED))
    assert [motion.record.id for motion in motions] == ["CI.CCC..H040@20190706T031953"]
    assert motions[0].record.acceleration == pytest.approx(ALONG, abs=1e-12)


def test_the_strongest_direction_is_that_of_a_polarised_motion():
    motions, _ = motions_under([channel(70.0), channel(10.0)], config("strongest"))
    assert motions[0].record.azimuth == pytest.approx(POLARISED, abs=2.0)
    impulse = np.max(np.abs(half_waves(motions[0].record).impulse))
    assert impulse >= np.max(np.abs(half_waves(channel(POLARISED)).impulse))


def test_a_sweep_has_all_directions_of_a_half_circle_once():
    motions, names = motions_under([channel(90.0), channel(0.0)], config("sweep", azimuth_step=22.5))
    assert [motion.record.azimuth for motion in motions] == [0.0, 22.5, 45.0, 67.5, 90.0, 112.5, 135.0, 157.5]
    assert len({motion.record.id for motion in motions}) == 8
    assert len(sweep_azimuths(1.0)) == 180
    assert len(set(names)) == 1


def test_directions_of_any_sweep_have_different_numbers():
    for count in range(2, 181):
        assert len({int(azimuth + 0.5) for azimuth in sweep_azimuths(180.0 / count)}) == count


def test_two_pairs_with_one_name_keep_apart():
    records = [channel(z, source=source, format=source) for source in ("a", "b") for z in (90.0, 0.0)]
    motions, names = motions_under(records, config("azimuth", azimuth=5.0))
    assert [motion.record.id for motion in motions] == [
        "CI.CCC..H005@20190706T031953",
        "CI.CCC..H005@20190706T031953~2",
    ]
    assert names == ["CI.CCC..90-0@20190706T031953", "CI.CCC..90-0@20190706T031953~2"]


def test_the_number_of_a_pair_stays_its_own_when_another_pair_cannot_be_rotated():
    parallel = [channel(z, source="a", format="a") for z in (90.0, 270.0)]
    pair = [channel(z, source="b", format="b", channel=f"HN{z:g}") for z in (80.0, 350.0)]
    tree = assess([*parallel, *pair], config("azimuth", azimuth=5.0, keep=("*",)))
    assert tree["summary"]["record"].values.tolist() == ["CI.CCC..H005@20190706T031953~2"]
    assert tree["failures"]["stage"].values.tolist() == ["rotate", "rotate"]


@pytest.mark.parametrize("way", [{}, {"components": "azimuth", "azimuth": 30.0}, {"components": "sweep"}])
def test_the_ids_are_known_before_the_samples_are(way):
    options = config(**{"components": "horizontal", **way}, include_vertical=True)
    records = [channel(90.0), channel(0.0), upwards()]
    empty, full = (plan_motions(some, options)[0] for some in ([one.without_samples() for one in records], records))
    motions = [motion for one in full for motion in conditioned_motions(one, options)]
    assert [name for one in empty for name in planned_ids(one, options)] == [motion.record.id for motion in motions]
    assert all(one.vertical.id == motion.vertical.id == "CCC.up" for one in empty for motion in motions)


def test_the_strongest_direction_is_not_known_before():
    planned, _ = plan_motions([channel(90.0), channel(0.0)], config("strongest"))
    assert planned_ids(planned[0], config("strongest")) == []


def test_the_id_of_a_rotated_pair_has_the_time_of_its_channel_however_the_pair_is_cut():
    late = channel(0.0, start_time=START + timedelta(seconds=2.0))
    (motion,), _ = motions_under([channel(90.0), late], config("azimuth", azimuth=30.0))
    assert motion.record.start_time == late.start_time
    assert motion.record.id == "CI.CCC..H030@20190706T031953"


def test_a_pair_of_which_no_direction_was_assessed_is_left_out_of_the_statistics():
    weak = [channel(z, "CLC", across=0.0) for z in (90.0, 0.0)]
    weak = [replace(one, acceleration=0.1 * one.acceleration) for one in weak]
    phase = IntensePhaseSettings(method="bracketed", level=2.0)
    options = replace(config("sweep", blocks=(TOWER,), azimuth_step=45.0), intense_phase=phase)
    tree = assess([channel(90.0), channel(0.0), *weak], options)
    assert tree["directions"]["pair"].values.tolist() == ["CI.CCC..90-0@20190706T031953"]
    assert sum("CLC" in reason for reason in tree["failures"]["reason"].values) == 4


def test_channels_without_a_partner_and_parallel_ones_are_failed_rows_and_the_others_go_on():
    alone, parallel = channel(90.0, "TOW2"), [channel(z, "CLC") for z in (90.0, 276.0)]
    tree = assess([channel(90.0), channel(0.0), alone, *parallel], config("strongest"))
    assert tree["summary"].sizes["record"] == 1
    failures = tree["failures"]
    assert failures["kind"].values.tolist() == ["failed"] * 3
    assert failures["stage"].values.tolist() == ["pair", "rotate", "rotate"]
    assert all('components = "horizontal"' in reason for reason in failures["reason"].values)


def test_the_answer_in_the_direction_of_a_channel_is_that_of_the_channel_as_recorded(tree):
    recorded = assess([channel(90.0), channel(0.0)], Config(blocks=(WALL, TOWER)))["summary"]
    here = tree["summary"]["peak_rotation_ratio"].sel(record="CI.CCC..H000@20190706T031953")
    there = recorded["peak_rotation_ratio"].sel(record="CI.CCC..0@20190706T031953")
    assert np.array_equal(here, there)


def test_without_a_sweep_there_are_no_directions():
    assert "directions" not in assess([channel(90.0), channel(0.0)], config("strongest")).children
    assert "directions" not in assess([channel(90.0)], Config(blocks=(WALL,))).children


def test_every_direction_is_a_record_and_the_group_says_which(tree):
    found = tree["directions"]
    assert dict(found.sizes) == {"pair": 1, "direction": 9, "block": 2, "model": 5}
    assert found["direction_azimuth"].values.tolist() == [20.0 * k for k in range(9)]
    index = found["record_index"].values[0]
    assert tree["summary"]["azimuth"].values[index].tolist() == found["direction_azimuth"].values.tolist()


def test_the_group_holds_the_median_and_the_largest_of_the_records(tree):
    summary, found = tree["summary"], tree["directions"].isel(pair=0)
    peaks = summary["peak_rotation_ratio"].values
    assert np.array_equal(found["median_rotation_ratio"].values, np.median(peaks, axis=0))
    assert np.array_equal(found["largest_rotation_ratio"].values, peaks.max(axis=0))
    assert np.array_equal(
        found["overturning_share"].values, (summary["outcome"].values == Outcome.OVERTURNS).mean(axis=0)
    )
    assert np.all(found["unanswered_count"] == 0)
    for name in ("pga", "main_impulse"):
        assert found[f"{name}_median"].item() == np.median(summary[name])
        assert found[f"{name}_largest"].item() == summary[name].max()
        assert found[f"{name}_azimuth"].item() == POLARISED
    factors = summary["safety_factor"].values
    assert np.array_equal(found["smallest_safety_factor"].values, factors.min(axis=0))


def test_a_polarised_motion_is_worst_along_itself_and_nothing_across():
    """A body that rocks little: near overturning a smaller motion may do more."""
    pier = BlockSettings(name="pier", width=3.0, height=10.0)
    found = sweep(channel(90.0, across=0.0), channel(0.0, across=0.0), blocks=(pier,))["directions"]
    found = found.isel(pair=0, block=0)
    for model in ("impulsive", "linear", "nonlinear"):
        assert found["largest_azimuth"].sel(model=model).item() == POLARISED
        assert found["median_rotation_ratio"].sel(model=model) < found["largest_rotation_ratio"].sel(model=model) < 1.0
    assert found["main_impulse_azimuth"].item() == found["pga_azimuth"].item() == POLARISED


def test_some_directions_overturn_and_others_do_not(tree):
    found = tree["directions"].isel(pair=0).sel(block="wall", model="nonlinear")
    assert 0.0 < found["overturning_share"].item() < 1.0
    assert np.isinf(found["largest_rotation_ratio"])


def test_the_first_to_overturn_gives_the_azimuth(tree):
    summary = tree["summary"].sel(block="wall", model="nonlinear")
    first = int(np.nanargmin(np.where(summary["outcome"] == Outcome.OVERTURNS, summary["overturning_time"], np.nan)))
    azimuth = tree["directions"]["largest_azimuth"].sel(block="wall", model="nonlinear").item()
    assert summary["azimuth"].values[first] == azimuth


def test_directions_that_cannot_be_assessed_are_unanswered_not_forgotten():
    """Across the polarisation the motion does not exceed the bracket."""
    phase = IntensePhaseSettings(method="bracketed", level=2.0)
    options = config("sweep", azimuth_step=20.0)
    tree = assess([channel(90.0), channel(0.0)], Config(blocks=(TOWER,), records=options.records, intense_phase=phase))
    found = tree["directions"].isel(pair=0)
    missing = found["record_index"].values < 0
    assert 0 < missing.sum() < 5
    assert tree["failures"].sizes["failure"] == missing.sum()
    assert found["unanswered_count"].sel(model="nonlinear").item() == missing.sum()
    assert np.isnan(found["largest_rotation_ratio"].sel(model="nonlinear"))
    assert np.isnan(found["largest_azimuth"].sel(model="nonlinear"))
    assert np.isnan(found["pga_largest"])
    assert f"0 +{missing.sum()}?" in direction_table(tree["summary"].to_dataset(), tree["directions"].to_dataset())


def test_the_vertical_of_the_station_acts_in_every_direction():
    models = ModelSettings(use=("nonlinear",))
    records = (channel(90.0), channel(0.0), upwards())
    lifted = sweep(*records, blocks=(TOWER,), models=models, include_vertical=True)["summary"]
    plain = sweep(*records, blocks=(TOWER,), models=models)["summary"]
    assert all("vertical acceleration: CCC.up" in text for text in lifted["processing"].values)
    strong = plain["peak_rotation_ratio"].values > 0.0
    assert strong.any()
    assert np.all((lifted["peak_rotation_ratio"].values != plain["peak_rotation_ratio"].values)[strong])


def test_a_range_of_restitution_keeps_its_dimension():
    several = BlockSettings(name="wall", width=0.4, height=3.0, restitution=[0.6, 0.9])
    found = sweep(channel(90.0), channel(0.0), blocks=(several,), models=ModelSettings(use=("nonlinear",)))
    assert found["directions"]["largest_rotation_ratio"].dims == ("pair", "block", "case", "model")
    assert direction_table(found["summary"].to_dataset(), found["directions"].to_dataset()).count("  wall") == 2


def test_the_overview_of_a_sweep_is_one_table_for_each_pair(tree):
    text = overview(tree)
    head, tables = text.split("\n\n", 1)
    pair = tables.splitlines()[0]
    assert ": 1 pair, 9 directions, 2 blocks; " in head
    assert pair.startswith("CI.CCC..90-0@20190706T031953  PGA ")
    assert "(at 40°)" in pair
    assert text.count("  wall") == 1
    assert "H040" not in tables.split("\n\n", 1)[0]
    assert "Median and largest over 9 directions" in text
    assert "OVERTURNS" in text
    assert "upper-bound type input" in text


@pytest.mark.sweep
def test_of_a_large_sweep_the_worst_pairs_are_shown(monkeypatch):
    records = [channel(azimuth, f"S{k}", id=f"S{k}.{azimuth:g}") for k in range(4) for azimuth in (90.0, 0.0)]
    records = [replace(one, acceleration=one.acceleration * (1 + 0.1 * (k // 2))) for k, one in enumerate(records)]
    tree = sweep(*records, models=ModelSettings(use=("linear",)))
    text = overview(tree)
    assert "worst of" not in text
    monkeypatch.setattr(large_overview, "WHOLE", 50)
    text = overview(tree)
    assert ": 4 pairs, 9 directions, 2 blocks; linear" in text
    assert "The 3 worst of 4 pairs of channels:" in text
    assert [f"\nCI.S{k}" in text for k in range(4)] == [False, True, True, True]


@pytest.mark.parametrize(
    ("recorded", "asked", "words"),
    [
        (45.0, 45.0, "as recorded, at 45 degrees, for the azimuth 45"),
        (45.6, 45.0, "as recorded, at 45.6 degrees"),
        (0.0, 359.5, "as recorded, at 0 degrees"),
        (225.0, 45.0, "for the azimuth 45, the mirror image"),
        (359.5, 180.0, "for the azimuth 180, the mirror image"),
        (46.5, 45.0, None),
        (135.0, 45.0, None),
        (np.nan, 45.0, None),
    ],
)
def test_a_lone_channel_that_faces_the_azimuth_needs_no_partner(recorded, asked, words):
    alone = replace(channel(10.0, "TOW"), azimuth=recorded)
    pair = channel(90.0), channel(0.0)
    options = config("azimuth", azimuth=asked)
    planned, rows = plan_motions([alone, *pair, upwards("TOW")], options)
    assert [one.kind for one in rows if one.stage == "pair"] == ([] if words else ["failed"])
    assert [one.channels for one in planned] == ([(alone,)] if words else []) + [pair]
    if words:
        (motion,) = conditioned_motions(planned[0], options)
        assert words in motion.record.warnings[-1]
        assert planned_ids(planned[0], options) == [motion.record.id] == [alone.id]
        np.testing.assert_array_equal(motion.record.acceleration, alone.acceleration)
        both = plan_motions([alone], replace(options, records=replace(options.records, include_vertical=True)))[0]
        alone_told, vertical_told = both[0].remarks
        assert alone_told.startswith("no pair: as recorded")
        assert vertical_told == "no vertical channel of this station overlaps: taken as zero"
        assert code_of(vertical_told) == "vertical_missing"
    for components in ("strongest", "sweep"):
        assert [one.kind for one in plan_motions([alone], config(components))[1]] == ["failed"]


def test_against_the_azimuth_a_body_that_rocks_to_both_sides_does_the_same():
    """45 and 225 degrees are one direction for it."""
    trees = [assess([channel(90.0), channel(0.0)], config("azimuth", azimuth=angle)) for angle in (45.0, 225.0)]
    for name in ("peak_rotation_ratio", "outcome", "safety_factor"):
        one, other = (tree["summary"][name].values for tree in trees)
        np.testing.assert_allclose(one, other, rtol=1e-6)


def test_a_table_of_a_sweep_marks_a_doubtful_peak_and_says_how_far_was_searched(tree):
    summary, directions = (tree[name].to_dataset().copy(deep=True) for name in ("summary", "directions"))
    assert "peak?" not in direction_table(summary, directions)
    directions["pga_largest"][0] = 60.0
    summary["safety_factor"][:], summary["safe_up_to"][:] = np.inf, 10.0
    directions["smallest_safety_factor"][:], directions["safety_factor_azimuth"][:] = np.inf, np.nan
    text = direction_table(summary, directions)
    assert f"{directions['pair'].values[0]} (peak?)  PGA" in text
    assert "(peak?): a peak above 5 g" in text
    assert next(line for line in text.splitlines() if line.startswith("  wall")).split()[5:7] == [">10", "-"]
    assert ">10: none found up to there" in " ".join(text.split())
    one, other = directions["record_index"].values[0, :2]
    for first, second, shown in ((0.0, 10.0, ">0"), (10.0, 0.0, ">0"), (10.0, np.nan, "none"), (np.nan, 10.0, "none")):
        summary["safe_up_to"][one], summary["safe_up_to"][other] = first, second
        text = direction_table(summary, directions)
        assert next(line for line in text.splitlines() if line.startswith("  wall")).split()[5] == shown


def test_the_overview_of_a_sweep_shows_the_smallest_factor_and_capacity_over_direction():
    demands = (DemandSettings(name="collapse", acceleration=2.5),)
    options = config("sweep", (WALL,), ModelSettings(use=("nonlinear",)), azimuth_step=20.0)
    tree = assess([channel(90.0), channel(0.0)], replace(options, demands=demands))
    summary, directions = tree["summary"].to_dataset(), tree["directions"].to_dataset()
    found = directions.isel(pair=0, block=0, model=0)
    factor, azimuth = found["smallest_safety_factor"].item(), found["safety_factor_azimuth"].item()
    text = overview(tree)
    rows = [line.split() for line in text.splitlines() if line.startswith("  wall")]
    assert rows[0][5:7] == [f"{factor:.2f}", f"{azimuth:g}°"]
    assert "SF: smallest factor on the record, over direction, at which the block overturns" in text
    assert "of the pairs, each in its worst direction" in " ".join(text.split())
    capacity = f"{summary['capacity_ratio'].min().item():.2f}"
    assert rows[1][2:] == [f"{capacity},", capacity]
    assert "SF" not in direction_table(summary.drop_vars("safety_factor"), directions)
    summary["factor_resolved"][int(np.argmin(summary["safety_factor"].values))] = 0
    marked = direction_table(summary, directions)
    assert next(line for line in marked.splitlines() if line.startswith("  wall")).split()[5] == f"{factor:.2f}!"
    lost = int(np.argmax(summary["capacity_ratio"].values[directions["record_index"].values[0]].ravel()))
    directions["record_index"][0, lost] = -1
    assert float(capacity) < 1.0
    tree["directions"] = xr.DataTree(directions)
    assert f"≤{capacity}" in smallest_capacities(answers_of(tree))  # fails whatever the lost one would say
    tree["summary"] = xr.DataTree(summary.assign(capacity_ratio=summary["capacity_ratio"] * 10.0))
    told = " ".join(smallest_capacities(answers_of(tree)).split())
    assert f"≤{10.0 * summary['capacity_ratio'].min().item():.2f}!, -" in told
    assert "≤: may be less, for a direction has no answer; left out of the median (up to 1 of the pairs)" in told


def capacity_part(text):
    """The table of capacities over demand in an overview, as far as the blank line behind its note."""
    return text[text.index("Capacity (safety factor x PGA") :].split("\n\n")[:3]


def test_all_views_of_a_sweep_tell_the_same_margins(monkeypatch):
    """Over all rotated records of two pairs of different strength the median would be another than over the pairs."""
    records = [channel(azimuth, f"S{k}", across=(1.0 - 0.3 * k) * ACROSS) for k in range(2) for azimuth in (90.0, 0.0)]
    records = [replace(r, acceleration=r.acceleration * (0.7 if r.station == "S1" else 1.0)) for r in records]
    options = config("sweep", (WALL, TOWER), ModelSettings(use=("linear", "nonlinear")), azimuth_step=45.0)
    tree = assess(records, replace(options, demands=(DemandSettings(name="collapse", acceleration=2.5),)))
    answers = answers_of(tree)
    index = tree["directions"]["record_index"].values
    found = []
    for name in ("safety_factor", "capacity_ratio"):
        every = tree["summary"][name].sel(model="nonlinear", block="wall").values.ravel()
        pairs = every[index].min(axis=1)
        assert f"{np.median(every):.2f}" != f"{np.median(pairs):.2f}"
        found.append((f"{pairs.min():.2f}", f"{np.median(pairs):.2f}"))
    (smallest, median), capacities = found
    whole = overview(tree)
    assert ", ".join(capacities) in " ".join(whole.split())
    monkeypatch.setattr(large_overview, "WHOLE", 1)
    large = overview(tree)
    assert "Verdicts, " in large
    assert "Verdicts, " not in whole
    assert capacity_part(large) == capacity_part(whole)
    fallen = (tree["summary"]["outcome"].sel(model="nonlinear", block="wall").values[index] == Outcome.OVERTURNS).any(1)
    blocks = large[large.index("pairs that overturn it") :].splitlines()
    row = next(line.split() for line in blocks if line.startswith("  wall"))
    assert row[2:] == [str(fallen.sum()), "of", "2", f"{fallen.mean():.1%}", median]
    in_report = next(row for row in body_table(answers, verdicts(answers)).rows if row[0].text == "wall")
    assert [in_report[3].marked, in_report[5].marked] == [smallest, median]
    assert in_report[6].text == f"{capacities[0]}, median {capacities[1]}"


INF, NAN = np.inf, np.nan


@pytest.mark.parametrize(
    ("values", "median", "largest", "place"),
    [
        ([0.1, 0.4, 0.2], 0.2, 0.4, 1),
        ([0.1, 0.4, 0.2, 0.3], 0.25, 0.4, 1),
        ([0.1, INF, 0.2], 0.2, INF, 1),
        ([INF, 0.1, INF], INF, INF, 0),
        ([INF, 0.1], INF, INF, 0),
        ([0.0, 0.0, 0.0], 0.0, 0.0, 0),
        ([0.1, NAN, 0.2], NAN, NAN, -1),
        ([0.2, NAN, 0.2], 0.2, NAN, -1),
        ([INF, NAN, INF, INF], INF, INF, 0),
        ([NAN, NAN], NAN, NAN, -1),
    ],
)
def test_median_and_largest_with_overturning_and_without_an_answer(values, median, largest, place):
    row = np.array([values])
    assert median_over(row) == pytest.approx([median], nan_ok=True)
    found, at = largest_over(row)
    assert found == pytest.approx([largest], nan_ok=True)
    assert at == [place]


@pytest.mark.parametrize(
    ("values", "smallest", "place"),
    [([2.0, 0.5, 1.0], 0.5, 1), ([INF, 3.0], 3.0, 1), ([INF, INF], INF, -1), ([NAN, 0.5], NAN, -1)],
)
def test_smallest_safety_factor(values, smallest, place):
    found, at = smallest_over(np.array([values]))
    assert found == pytest.approx([smallest], nan_ok=True)
    assert at == [place]


@pytest.mark.parametrize("components", ["horizontal", "sweep"])
def test_a_vertical_channel_that_cannot_be_conditioned_is_the_one_that_is_named(components):
    up = replace(upwards(), source="up.v1", acceleration=upwards().acceleration[:200])
    options = replace(
        config(components, blocks=(TOWER,), include_vertical=True), conditioning=ConditioningSettings(resample_s=5.0)
    )
    tree = assess([channel(90.0), channel(0.0), up], options)
    rows = [row for row in failure_rows(tree) if row.kind == "failed"]
    assert {row.stage for row in rows} == {"assess"}
    assert all("the vertical channel CCC.up of " in row.reason for row in rows)
    assert {row.file for row in rows} == {"CCC.v1", "up.v1"}
    assert {row.place for row in rows if row.file == "up.v1"} == {"CCC.up"}
    assert {row.file for row in files_used(tree).unused} == {"CCC.v1", "up.v1"}
