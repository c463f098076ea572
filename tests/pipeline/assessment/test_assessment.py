"""From records and bodies to the tree."""

import numpy as np
import pytest
from bursts import DT, TOWER, WALL, motion, record
from nominal import Config as nominal

import rockpulse as rp
from rocking.impulses.impulse_sequence import SPACINGS
from rockpulse.assessment.assessment import assess
from rockpulse.errors import ConfigError
from rockpulse.models import Block, Outcome, Reason, recorded_response
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import INTERVAL, MAIN, MAIN_COUNT, SECONDARY
from rockpulse.views.plots.selection import block_of


def Config(**sections):
    """Every model and factor, by a search of few factors."""
    return nominal(**{"search": rp.SearchSettings(points=16)} | sections)


@pytest.fixture(scope="module")
def tree():
    return assess([record("one", orientation="horizontal"), record("two", 1, 1.0)], nominal(bodies=(WALL, TOWER)))


def test_every_record_block_and_model_has_an_answer(tree):
    summary = tree["summary"]
    assert dict(summary.sizes) == {"record": 2, "block": 2, "model": 5}
    assert list(summary["record"].values) == ["one", "two"]
    assert list(summary["model"].values) == ["resonance", "sequence", "impulsive", "linear", "nonlinear"]
    assert not np.any(np.isnan(summary["peak_rotation_ratio"]))
    assert np.all(summary["outcome"] != Outcome.UNRESOLVED)


def test_results_are_named_after_the_site(tree):
    assert tree.attrs["title"] == "Rocking response of rigid blocks to recorded ground motions"
    named = Config(bodies=(WALL,), models=rp.ModelSettings(use=("linear",)), site=rp.SiteSettings(name="Borgo"))
    assert assess([record("one")], named).attrs["title"] == "Borgo"


def test_demand_ratios_follow_their_definitions(tree):
    block = Block(0.4, 3.0)
    cell = tree["summary"].sel(record="one", block="wall")
    capacity = block.gravity * np.tan(block.alpha_c)
    assert cell["pga"].item() == pytest.approx(4.0)
    assert cell["uplift_ratio"].item() == pytest.approx(4.0 / capacity)
    assert cell["velocity_ratio"].item() == pytest.approx(block.p * pgv(record("one")) / capacity)
    assert cell["impulse_ratio"].item() == pytest.approx(cell["main_impulse"].item() / block.critical_impulse)


def test_every_model_has_a_safety_factor_and_what_goes_with_it(tree):
    summary = tree["summary"]
    factor = summary["safety_factor"]
    assert np.all(factor > 0.0)
    assert np.all(summary["safe_up_to"] <= np.minimum(factor, 10.0))
    assert np.all((summary["interval_count"] > 0) == np.isfinite(factor))
    assert np.all(summary["factor_resolved"] == 1)
    flag = summary["factor_resolved"].attrs
    assert (flag["flag_meanings"], flag["flag_values"].tolist()) == ("not_computed no yes", [-1, 0, 1])
    assert np.array_equal(
        summary["capacity_pga"].where(np.isfinite(factor), 0.0),
        (factor * summary["pga"]).where(np.isfinite(factor), 0.0),
    )
    assert np.all(summary["search_step"].sel(model="resonance") == 1.0)
    assert np.all(summary["search_step"].sel(model="sequence") <= 1.005)
    assert "search_step" in factor.attrs["comment"]


def test_intervals_of_overturning_begin_with_the_safety_factor_and_hold_the_outcome(tree):
    summary, table = tree["summary"], tree["overturning_intervals"]
    shape = summary["safety_factor"].shape
    place = [table[f"{name}_index"].values for name in ("record", "block", "model")]
    smallest, over = np.full(shape, np.inf), np.zeros(shape, dtype=bool)
    np.minimum.at(smallest, tuple(place), table["lower"].values)
    np.logical_or.at(over, tuple(place), (table["lower"].values <= 1.0) & (table["upper"].values >= 1.0))
    assert np.array_equal(smallest, summary["safety_factor"].values)
    # The record as it is belongs to the factors that are tried.
    assert np.array_equal(over, summary["outcome"].values == Outcome.OVERTURNS)
    counts = np.zeros(shape, dtype=int)
    np.add.at(counts, tuple(place), 1)
    assert np.array_equal(counts, summary["interval_count"].values)
    assert np.array_equal(table["open"].values == 1, table["upper"].values == 10.0)
    assert np.all(table["resolved"] == 1)
    assert np.all(table["case_index"] == 0)


@pytest.mark.sweep
@pytest.mark.parametrize("restitution", ["housner", (0.8, 0.9)])
def test_capacity_is_compared_with_every_demand(restitution):
    demands = (rp.DemandSettings(name="damage", value=1.0), rp.DemandSettings("collapse", "475 years", value=2.5))
    wall = rp.BlockSettings(name="wall", width=0.4, height=3.0, restitution=restitution)
    summary = assess([record("one")], Config(bodies=(wall,), demands=demands))["summary"]
    assert list(summary["demand"].values) == ["damage", "collapse"]
    assert list(summary["demand_acceleration"].values) == [1.0, 2.5]
    assert list(summary["limit_state"].values) == ["", "475 years"]
    assert summary["capacity_ratio"].dims == (*summary["capacity_pga"].dims, "demand")
    expected = summary["capacity_pga"] / 2.5
    np.testing.assert_allclose(summary["capacity_ratio"].sel(demand="collapse"), expected, rtol=1e-12)
    np.testing.assert_allclose(summary["demand_factor"].sel(demand="collapse"), 2.5 / summary["pga"].item(), rtol=1e-12)
    assert np.isnan(summary["demand_probability"]).all()  # none is asked for


def test_squat_block_is_marked_outside_the_range_of_the_linear_models(tree):
    squat = assess([record("one")], Config(), bodies=[rp.BlockSettings(name="chest", width=1.0, height=1.5)])["summary"]
    applicable = squat["applicable"].squeeze().values
    assert list(applicable) == [0, 0, 0, 0, 1]
    assert np.all(tree["summary"]["applicable"] == 1)
    assert "slenderness" in squat["block_warnings"].item()


def test_half_cycles_belong_to_the_sequence_models(tree):
    rows = tree["half_cycles"]
    assert set(rows["model_index"].values) == {0, 1}
    first = rows["half_cycle"].values == 1
    assert first.sum() == 2 * 2 * 2
    ratio = tree["summary"]["impulse_ratio"].values
    resonant = first & (rows["model_index"].values == 0)
    expected = ratio[rows["record_index"].values[resonant], rows["block_index"].values[resonant]]
    assert rows["start_velocity"].values[resonant] == pytest.approx(expected)


def test_records_are_kept_as_ragged_arrays(tree):
    kept = tree["records"]
    assert list(kept["row_size"].values) == [1200, 1200]
    assert np.array_equal(kept["acceleration"].values[:1200], motion(0))
    assert kept["half_wave_row_size"].sum() == kept.sizes["wave"]


def test_histories_of_several_restitutions_stand_at_their_lanes():
    several = rp.BlockSettings(name="wall", width=0.4, height=3.0, restitution=[0.6, 0.9])
    config = Config(models=rp.ModelSettings(use=("nonlinear",), histories=True))
    tree = assess([record("two", 1, 1.5)], config, [several, TOWER])
    kept, summary = tree["records"], tree["summary"].to_dataset()
    assert summary["peak_rotation_ratio"].dims == ("record", "block", "case", "model")
    assert list(summary["restitution"].sel(block="wall").values) == [0.6, 0.9]
    assert kept["history_lane_index"].values.tolist() == [0, 1, 2, 3]
    for place, restitution in enumerate((0.6, 0.9)):
        direct = recorded_response(Block(0.4, 3.0, restitution=restitution), motion(1, 1.5), DT, history=True)
        own = kept["rotation"].values[1200 * place : 1200 * (place + 1)]
        assert np.array_equal(own, direct.rotation, equal_nan=True)
        for name in ("peak_rotation_ratio", "impacts"):
            assert summary[name].sel(block="wall").values[0, place, 0] == getattr(direct, name)


@pytest.mark.sweep
def test_vertical_acceleration_serves_the_nonlinear_model_where_asked_for():
    horizontal = record("one", 0, 2.5, station="S", orientation="horizontal")
    up = record("one-up", 3, 3.0, station="S", orientation="vertical")
    up = Record(up.acceleration, DT, id="up", station="S", orientation="vertical", source="one.txt", processed=True)
    models = rp.ModelSettings(use=("sequence", "linear", "nonlinear"))
    with_up = Config(bodies=(WALL,), models=models, records=rp.RecordSettings(include_vertical=True))
    without = Config(bodies=(WALL,), models=models, records=rp.RecordSettings(include_vertical=False))
    lifted = assess([horizontal, up], with_up)["summary"]["peak_rotation_ratio"].values[0, 0]
    plain = assess([horizontal, up], without)["summary"]["peak_rotation_ratio"].values[0, 0]
    direct = recorded_response(Block(0.4, 3.0), horizontal.acceleration, DT, vertical=up.acceleration)
    assert lifted[2] == direct.peak_rotation_ratio != plain[2]
    assert np.array_equal(lifted[:2], plain[:2])


@pytest.mark.sweep
def test_every_estimator_gives_an_assessment_with_safety_factors():
    tables = {"main": MAIN, "secondary": SECONDARY, "interval": INTERVAL, "main_count": MAIN_COUNT, "spacing": SPACINGS}
    models = rp.ModelSettings(use=("resonance", "sequence"))
    for number in range(max(map(len, tables.values()))):  # each word of every table at least once
        options = {name: [*table][number % len(table)] for name, table in tables.items()}
        config = Config(bodies=(WALL,), models=models, sequence=rp.SequenceSettings(**options))
        tree = assess([record("one")], config)
        assert tree["failures"].sizes["failure"] == 0, options
        assert np.all(tree["summary"]["safety_factor"] > 0.0), options


@pytest.mark.sweep
def test_a_body_with_its_own_radius_answers_as_without_and_keeps_it():
    own = rp.BlockSettings(name="own", p=2.385, alpha=0.2445, radius=1.136, restitution=[0.87, 0.92])
    without = rp.BlockSettings(name="without", p=2.385, alpha=0.2445, restitution=[0.87, 0.92])
    config = Config(bodies=(own, without), models=rp.ModelSettings(use=("sequence", "nonlinear")))
    summary = assess([record("one")], config)["summary"].to_dataset()
    assert summary["radius"].values == pytest.approx([1.136, 1.2930], abs=1e-4)
    assert summary["block_warnings"].values[0] == ""
    assert "of a rectangle with this alpha" in summary["block_warnings"].values[1]
    for name in ("peak_rotation_ratio", "safety_factor", "outcome", "applicable", "impacts"):
        assert np.array_equal(*(summary[name].sel(block=body).values for body in ("own", "without")), equal_nan=True)
    assert block_of(summary, "own", 2).radius == 1.136
    assert block_of(summary, "without", 2).radius == pytest.approx(1.2930, abs=1e-4)


@pytest.mark.sweep
def test_body_beyond_the_reach_of_the_sequence_leaves_the_others_their_answers():
    island = rp.BlockSettings(name="island", width=1e9, height=1e10, confirm_size=True)
    summary = assess([record("one")], Config(bodies=(WALL, island)))["summary"].sel(record="one")
    assert summary["reason"].sel(block="island", model="sequence") == Reason.SHORT_INTERVAL
    island = summary.sel(block="island", model="sequence")
    assert (island["safety_factor"], island["interval_count"], island["search_step"]) == (np.inf, 0, 1.0)
    assert summary["outcome"].sel(block="island", model="nonlinear") == Outcome.ROCKS
    assert np.all(summary["outcome"].sel(block="wall") != Outcome.UNRESOLVED)


@pytest.mark.sweep
def test_numbers_that_a_model_refuses_are_a_failed_row_and_the_others_go_on():
    confirmed = rp.RecordSettings(confirm=("strong",))
    config = Config(bodies=(WALL,), sequence=rp.SequenceSettings(spacing="end"), records=confirmed)
    strong = Record(2.5e7 * motion(0), DT, id="strong", processed=True, source="strong.txt")
    tree = assess([strong, record("one")], config)
    assert list(tree["summary"]["record"].values) == ["one"]
    assert tree["failures"]["kind"].values.tolist() == ["failed"]
    assert "is the record in m/s2" in tree["failures"]["reason"].values[0]


def test_velocity_that_drifts_is_flagged():
    drifting = Record(motion(0) + 0.05, DT, id="drift", processed=True)
    models = rp.ModelSettings(use=("linear",))
    summary = assess([record("one"), drifting], Config(bodies=(WALL,), models=models))["summary"]
    assert summary["pgv_drift"].values.tolist() == [0, 1]


def test_record_without_a_sequence_is_still_assessed_and_says_so():
    pulse = np.zeros(200)
    pulse[50:80] = 3.0 * np.sin(np.pi * np.arange(30) / 30)
    single = Record(pulse, DT, id="pulse", processed=True, orientation="horizontal")
    tree = assess([single], Config(bodies=(WALL,)))
    summary = tree["summary"].to_dataset().squeeze()
    assert list(summary["outcome"].values[:2]) == [Outcome.UNRESOLVED] * 2
    assert np.isnan(summary["safety_factor"].values).tolist() == [True, True, False, False, False]
    assert np.all(np.isfinite(summary["peak_rotation_ratio"].values[2:]) | np.isinf(summary["peak_rotation_ratio"][2:]))
    assert "no impulse sequence" in summary["warnings"].item()
    assert "baseline drift or step" in summary["warnings"].item()  # its velocity stays
    assert tree["failures"].sizes["failure"] == 0


def test_no_record_at_all_gives_an_empty_tree_and_two_of_one_id_are_refused():
    tree = assess([], Config(bodies=(WALL,)))
    assert tree["summary"].sizes["record"] == 0
    assert tree["half_cycles"].sizes["row"] == 0
    with pytest.raises(ConfigError, match="one"):
        assess([record("one"), record("one")], Config(bodies=(WALL,)))
