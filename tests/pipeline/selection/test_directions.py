"""Which motions are assessed, and what the answers of all directions come to."""

from dataclasses import replace
from datetime import timedelta

import numpy as np
import pytest
from nominal import Config
from swept_motions import ALONG, POLARISED, START, TOWER, channel, config, motions_under, sweep, upwards

from rockpulse import BlockSettings, ConditioningSettings, IntensePhaseSettings, ModelSettings
from rockpulse.assessment.assessment import assess
from rockpulse.models import Outcome
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.selection.directions import conditioned_motions, plan_motions, planned_ids, sweep_azimuths
from rockpulse.views.shared.files_used import failure_rows, files_used
from rockpulse.views.text.margins import direction_table
from rockpulse.warning_text import code_of


@pytest.fixture(scope="module")
def tree():
    return sweep(channel(90.0), channel(0.0))


def test_as_recorded_nothing_is_rotated():
    records = [channel(90.0), channel(0.0)]
    motions, _ = motions_under(records, Config())
    assert [motion.record.id for motion in motions] == [record.id for record in records]
    for motion, record in zip(motions, records, strict=True):
        np.testing.assert_array_equal(motion.record.acceleration, record.acceleration)


def test_a_channel_is_conditioned_behind_its_warnings():
    raw = replace(channel(0.0), processed=False, acceleration=channel(0.0).acceleration + 0.5)
    options = replace(
        config("azimuth", azimuth=0.0, include_vertical=True), conditioning=ConditioningSettings(baseline="none")
    )
    (motion,), _ = motions_under([raw], options)
    expected = condition(raw, **options.conditioning)
    np.testing.assert_array_equal(motion.record.acceleration, expected.acceleration)
    assert motion.record.warnings[0].startswith("no second channel: assessed as recorded")
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
    models = ModelSettings(use=("linear",))
    tree = assess([*parallel, *pair], config("azimuth", models=models, azimuth=5.0, keep=("*",)))
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
    models = ModelSettings(use=("linear",))
    options = replace(config("sweep", blocks=(TOWER,), azimuth_step=45.0, models=models), intense_phase=phase)
    tree = assess([channel(90.0), channel(0.0), *weak], options)
    assert tree["directions"]["pair"].values.tolist() == ["CI.CCC..90-0@20190706T031953"]
    assert sum("CLC" in reason for reason in tree["failures"]["reason"].values) == 4


@pytest.mark.sweep
def test_channels_without_a_partner_and_parallel_ones_are_failed_rows_and_the_others_go_on():
    alone, parallel = channel(90.0, "TOW2"), [channel(z, "CLC") for z in (90.0, 276.0)]
    models = ModelSettings(use=("linear",))
    tree = assess([channel(90.0), channel(0.0), alone, *parallel], config("strongest", models=models))
    assert tree["summary"].sizes["record"] == 1
    failures = tree["failures"]
    assert failures["kind"].values.tolist() == ["failed"] * 3
    assert failures["stage"].values.tolist() == ["pair", "rotate", "rotate"]
    assert all('components = "horizontal"' in reason for reason in failures["reason"].values)


def test_the_answer_in_the_direction_of_a_channel_is_that_of_the_channel_as_recorded(tree):
    recorded = assess([channel(90.0), channel(0.0)], config("horizontal"))["summary"]
    here = tree["summary"]["peak_rotation_ratio"].sel(record="CI.CCC..H000@20190706T031953")
    there = recorded["peak_rotation_ratio"].sel(record="CI.CCC..0@20190706T031953")
    assert np.array_equal(here, there)


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


@pytest.mark.sweep
def test_a_polarised_motion_is_worst_along_itself_and_nothing_across():
    """A body that rocks little: near overturning a smaller motion may do more."""
    pier = BlockSettings(name="pier", width=3.0, height=10.0)
    models = ModelSettings(use=("impulsive", "linear", "nonlinear"))
    found = sweep(channel(90.0, across=0.0), channel(0.0, across=0.0), blocks=(pier,), models=models)["directions"]
    found = found.isel(pair=0, block=0)
    for model in ("impulsive", "linear", "nonlinear"):
        assert found["largest_azimuth"].sel(model=model).item() == POLARISED
        assert found["median_rotation_ratio"].sel(model=model) < found["largest_rotation_ratio"].sel(model=model) < 1.0
    assert found["main_impulse_azimuth"].item() == found["pga_azimuth"].item() == POLARISED


def test_the_first_to_overturn_gives_the_azimuth(tree):
    summary = tree["summary"].sel(block="wall", model="nonlinear")
    first = int(np.nanargmin(np.where(summary["outcome"] == Outcome.OVERTURNS, summary["overturning_time"], np.nan)))
    azimuth = tree["directions"]["largest_azimuth"].sel(block="wall", model="nonlinear").item()
    assert summary["azimuth"].values[first] == azimuth


@pytest.mark.sweep
def test_directions_that_cannot_be_assessed_are_unanswered_not_forgotten():
    """Across the polarisation the motion does not exceed the bracket."""
    phase = IntensePhaseSettings(method="bracketed", level=2.0)
    options = config("sweep", azimuth_step=20.0)
    models = ModelSettings(use=("nonlinear",))
    options = Config(bodies=(TOWER,), records=options.records, intense_phase=phase, models=models)
    tree = assess([channel(90.0), channel(0.0)], options)
    found = tree["directions"].isel(pair=0)
    missing = found["record_index"].values < 0
    assert 0 < missing.sum() < 5
    assert tree["failures"].sizes["failure"] == missing.sum()
    assert found["unanswered_count"].sel(model="nonlinear").item() == missing.sum()
    assert np.isnan(found["largest_rotation_ratio"].sel(model="nonlinear"))
    assert np.isnan(found["largest_azimuth"].sel(model="nonlinear"))
    assert np.isnan(found["pga_largest"])
    assert f"0 +{missing.sum()}?" in direction_table(tree["summary"].to_dataset(), tree["directions"].to_dataset())


@pytest.mark.sweep
def test_the_vertical_of_the_station_acts_in_every_direction():
    models = ModelSettings(use=("nonlinear",))
    records = (channel(90.0), channel(0.0), upwards())
    lifted = sweep(*records, blocks=(TOWER,), models=models, azimuth_step=60.0, include_vertical=True)["summary"]
    plain = sweep(*records, blocks=(TOWER,), models=models, azimuth_step=60.0)["summary"]
    assert all("vertical acceleration: CCC.up" in text for text in lifted["processing"].values)
    strong = plain["peak_rotation_ratio"].values > 0.0
    assert strong.any()
    assert np.all((lifted["peak_rotation_ratio"].values != plain["peak_rotation_ratio"].values)[strong])


@pytest.mark.sweep
def test_a_range_of_restitution_keeps_its_dimension():
    several = BlockSettings(name="wall", width=0.4, height=3.0, restitution=[0.6, 0.9])
    models = ModelSettings(use=("linear",))
    found = sweep(channel(90.0), channel(0.0), blocks=(several,), models=models, azimuth_step=60.0)
    assert found["directions"]["largest_rotation_ratio"].dims == ("pair", "block", "case", "model")
    assert direction_table(found["summary"].to_dataset(), found["directions"].to_dataset()).count("  wall") == 2


@pytest.mark.parametrize(
    ("recorded", "asked", "words"),
    [
        (45.0, 45.0, "as recorded, at 45 degrees, in place of 45 degrees"),
        (45.6, 45.0, "as recorded, at 45.6 degrees"),
        (0.0, 359.5, "as recorded, at 0 degrees"),
        (225.0, 45.0, "in place of 45 degrees (its mirror image"),
        (359.5, 180.0, "in place of 180 degrees (its mirror image"),
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
        alone_told, vertical_told = both[0].warnings
        assert alone_told.startswith("no second channel: assessed as recorded")
        assert (
            vertical_told == "no vertical channel of this station overlaps in time: vertical acceleration taken as zero"
        )
        assert code_of(vertical_told) == "vertical_missing"
    for components in ("strongest", "sweep"):
        assert [one.kind for one in plan_motions([alone], config(components))[1]] == ["failed"]


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
