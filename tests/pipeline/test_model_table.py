"""The table of models: what each is searched with, what it cannot answer, where it holds and how it is drawn."""

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from nominal import Config, scene_of_record

from rocking.body.block_lanes import FEATURES
from rockpulse import BlockSettings, DemandSettings, ModelSettings, RecordSettings, SearchSettings
from rockpulse.assessment.assessment import assess
from rockpulse.model_table import (
    ALL_MODELS,
    DEFAULT_MODELS,
    DRAWN,
    EQUATIONS,
    FOLLOWING,
    MODELS,
    NAMES,
    SEQUENCE_MODELS,
    fullest,
    is_full,
    is_upper_bound,
)
from rockpulse.models import (
    Block,
    Outcome,
    critical_scale,
    impulsive_critical_scale,
    resonance_critical_scale,
    sequence_critical_scale,
)
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.views.plots.style import look

BLOCKS = Block(half_width=[0.1, 0.2, 0.4], half_height=[1.0, 1.5, 3.0])
T = np.arange(0.0, 12.0, 0.01)
MOTION = 3.0 * np.sin(5.0 * T + 2.0 * np.sin(T)) * np.exp(-(((T - 5.0) / 2.0) ** 2))


def scene(motion=MOTION, **options):
    return scene_of_record(Record(motion, 0.01, id="one", processed=True), Config(**options))


@pytest.mark.sweep
@pytest.mark.parametrize("name", MODELS)
def test_every_model_answers_and_is_searched(name):
    one, model = scene(), MODELS[name]
    assert model.name == name
    assert model.words
    assert model.response(BLOCKS, one).outcome.shape == (3,)
    assert model.intervals(BLOCKS, one).safety_factor.shape == (3,)
    assert set(model.knows) <= set(FEATURES)


def test_what_models_can_do():
    expected = {
        NAMES: ["resonance", "sequence", "balanced", "conservative", "impulsive", "linear", "nonlinear"],
        DEFAULT_MODELS: ["sequence", "nonlinear"],
        ALL_MODELS: ["resonance", "sequence", "impulsive", "linear", "nonlinear"],
        SEQUENCE_MODELS: ["resonance", "sequence"],
        DRAWN: ["nonlinear", "linear", "impulsive", "sequence", "resonance"],
        FOLLOWING: ["nonlinear", "linear", "impulsive"],
        EQUATIONS: ["nonlinear", "linear"],
    }
    ours = expected[NAMES]
    for names, those in expected.items():
        assert [name for name in names if name in ours] == those
    for name in ours:
        assert is_full(name) == MODELS[name].vertical == (name == "nonlinear")
        assert is_upper_bound(name) == MODELS[name].needs_end == (name == "resonance")
        assert MODELS[name].paired == (name == "sequence")
    assert not is_full("x")
    assert not is_upper_bound("x")
    assert fullest(["nonlinear", "resonance"]) == "nonlinear"
    assert fullest(["x", "sequence", "resonance"]) == "sequence"


@pytest.mark.parametrize("name", FOLLOWING)
def test_a_model_that_follows_the_record_gives_the_motion_under_it_times_factors(name):
    one = scene()
    answer, both = MODELS[name].respond(BLOCKS, one), MODELS[name].respond(BLOCKS, one, np.array([0.5, 1.0]))
    assert both.outcome.shape == (2, 3)
    assert np.array_equal(both.peak_rotation_ratio[1], answer.peak_rotation_ratio)
    assert answer.rotation is None
    assert both.rotation.shape[:2] == (2, 3)
    largest = np.nanmax(np.abs(BLOCKS.ratio(both.rotation[1].T)), axis=0)
    rocks = answer.outcome == Outcome.ROCKS
    assert largest[rocks] == pytest.approx(answer.peak_rotation_ratio[rocks], rel=0.01)


def test_the_range_of_a_model():
    squat_and_slender = Block(half_width=[0.5, 0.2], half_height=[1.0, 1.6])
    by_statistics, by_rule = scene(), replace(scene(), rule="conservative")
    inside = {name: model.applicable(squat_and_slender, by_statistics).tolist() for name, model in MODELS.items()}
    assert inside == {name: [not model.slender, True] for name, model in MODELS.items()}
    assert inside["nonlinear"] == [True, True]
    assert inside["linear"] == [False, True]
    tiny = Block(half_width=[0.02], half_height=[0.16])
    for one, ruled in ((by_statistics, set()), (by_rule, {"sequence"})):
        fitted = {"balanced", "conservative", *ruled}
        assert {name for name, model in MODELS.items() if not model.applicable(tiny, one)[0]} == fitted
        assert {name for name, model in MODELS.items() if model.rule(one) is not None} == fitted


def test_models_are_told_apart_without_their_colour():
    lines = {(str(model.look[1]), model.look[2]) for model in MODELS.values()}
    assert len(lines) == len({look(name) for name in MODELS}) == len(MODELS)


@pytest.mark.sweep
def test_each_model_is_searched_with_its_own_input():
    one = scene(search=SearchSettings(factor_max=5.0, points=40, step=1.02))
    record, waves = one.record, one.waves
    expected = {
        "resonance": resonance_critical_scale(BLOCKS, one.sequence, 5.0),
        "sequence": sequence_critical_scale(BLOCKS, one.sequence, 5.0, 1.02),
        "impulsive": impulsive_critical_scale(BLOCKS, waves.centroid, waves.impulse, "paper", 5.0, 40),
        "linear": critical_scale(BLOCKS, record.acceleration, 0.01, "linear", factor_max=5.0, points=40),
        "nonlinear": critical_scale(BLOCKS, record.acceleration, 0.01, factor_max=5.0, points=40),
    }
    found = {name: MODELS[name].intervals(BLOCKS, one) for name in expected}
    for model, scales in expected.items():
        for name in ("safety_factor", "safe_up_to", "step", "lane", "lower", "upper", "open", "resolved"):
            assert np.array_equal(getattr(found[model], name), getattr(scales, name)), (model, name)
        assert np.any(np.isfinite(scales.safety_factor)), model


@pytest.mark.sweep
@pytest.mark.parametrize(("intervals", "searched"), [(False, ["sequence"]), (True, ["sequence", "linear"])])
def test_models_that_are_not_searched_have_no_factor(intervals, searched):
    config = Config(bodies=(BlockSettings(name="a", width=0.2, height=2.0),))
    config = replace(config, search=SearchSettings(models=("linear", "sequence"), intervals=intervals))
    tree = assess([Record(MOTION, 0.01, id="one", processed=True)], config)
    for name in ("safety_factor", "search_step"):
        known = tree["summary"][name].notnull().any(("record", "block"))
        assert tree["summary"]["model"].values[known].tolist() == searched
    assert {ALL_MODELS[row] for row in tree["overturning_intervals"]["model_index"].values} <= {*searched}


def with_free_flight(strength, up):
    """A motion and a short vertical acceleration: beyond -g of it is free flight."""
    vertical = np.where((T > 4.8) & (T < 5.1), up * np.sin(np.pi * (T - 4.8) / 0.3), 0.0)
    motion = {"horizontal": strength * MOTION, "vertical": vertical}
    stamp = {"network": "XX", "station": f"S{strength:g}", "start_time": datetime(2020, 1, 1, tzinfo=UTC)}
    return [
        Record(one, 0.01, id=f"{strength:g}.{way}", orientation=way, component=way, processed=True, **stamp)
        for way, one in motion.items()
    ]


@pytest.fixture(scope="module")
def flights():
    """A strong record whose vertical reaches -g at 0.93 of its strength, a weak one without."""
    config = Config(
        records=RecordSettings(include_vertical=True),
        models=ModelSettings(use=("nonlinear",)),
        demands=(DemandSettings(name="collapse", value=1.0),),
    )
    records = [*with_free_flight(1.0, -10.5), *with_free_flight(0.5, -1.0)]
    return assess(records, config, {"tall": Block(1.0, 5.0), "tower": Block(6.0, 18.0)})


def test_what_the_model_cannot_answer_keeps_the_lower_bound_of_the_search(flights):
    summary = flights["summary"].sel(model="nonlinear")
    strong, weak = (summary.sel(record=name) for name in ("1.horizontal", "0.5.horizontal"))
    assert np.all(strong["outcome"] == Outcome.UNRESOLVED)
    assert strong["safety_factor"].values == pytest.approx(STANDARD_GRAVITY / 10.5, rel=2e-6)
    assert np.all(strong["safe_up_to"] < strong["safety_factor"])
    assert np.all(strong["factor_resolved"] == 0)
    assert np.all(strong["interval_count"] >= 1)
    capacity = strong["safety_factor"] * strong["pga"]
    assert strong["capacity_ratio"].squeeze().values == pytest.approx(capacity.values, rel=1e-12)
    assert np.all(weak["outcome"] != Outcome.UNRESOLVED)
    assert np.array_equal(weak["factor_resolved"] == 1, (weak["safety_factor"] < 9.3) | np.isinf(weak["safety_factor"]))
