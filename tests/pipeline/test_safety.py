"""Critical scales of a scene: which model is searched with what."""

import numpy as np
import pytest

from rockpulse.assessment import assess
from rockpulse.config import Config
from rockpulse.models import (
    Block,
    critical_scale,
    impulsive_critical_scale,
    resonance_critical_scale,
    sequence_critical_scale,
)
from rockpulse.record import Record
from rockpulse.safety import SEARCHES, critical_scales
from rockpulse.scene import MODELS, prepare
from rockpulse.settings import ModelSettings, SearchSettings

BLOCKS = Block(half_width=[0.1, 0.2, 0.4], half_height=[1.0, 1.5, 3.0])
T = np.arange(0.0, 12.0, 0.01)
MOTION = 3.0 * np.sin(5.0 * T + 2.0 * np.sin(T)) * np.exp(-(((T - 5.0) / 2.0) ** 2))


def scene(motion=MOTION, **options):
    return prepare(Record(motion, 0.01, id="one", processed=True), Config(**options))


def answers(one):
    return {name: MODELS[name](BLOCKS, one) for name in one.config.models.use}


def test_every_model_has_a_search():
    assert list(SEARCHES) == list(MODELS)


def test_each_model_is_searched_with_its_own_input():
    one = scene(search=SearchSettings(factor_max=5.0, points=40, step=1.02))
    found = critical_scales(BLOCKS, one, answers(one))
    record, waves = one.record, one.waves
    expected = {
        "resonance": resonance_critical_scale(BLOCKS, one.sequence, 5.0),
        "sequence": sequence_critical_scale(BLOCKS, one.sequence, 5.0, 1.02),
        "impulsive": impulsive_critical_scale(BLOCKS, waves.centroid, waves.impulse, "paper", 5.0, 40),
        "linear": critical_scale(BLOCKS, record.acceleration, 0.01, "linear", factor_max=5.0, points=40),
        "nonlinear": critical_scale(BLOCKS, record.acceleration, 0.01, factor_max=5.0, points=40),
    }
    assert list(found) == list(expected)
    for model, scales in expected.items():
        for name in ("safety_factor", "safe_up_to", "step", "lane", "lower", "upper", "open", "resolved"):
            assert np.array_equal(getattr(found[model], name), getattr(scales, name)), (model, name)
        assert np.any(np.isfinite(scales.safety_factor)), model


def test_models_that_are_not_searched_have_no_factor():
    one = scene(search=SearchSettings(models=("linear",)))
    found = critical_scales(BLOCKS, one, answers(one))
    for model, scales in found.items():
        assert np.all(np.isnan(scales.safety_factor)) == np.all(np.isnan(scales.step)) == (model != "linear")
        assert (scales.lane.size == 0) == (model != "linear")


@pytest.mark.parametrize("use", [("nonlinear",), ("linear",)])
def test_auto_has_the_factors_of_the_nonlinear_model(use):
    record = Record(MOTION, 0.01, id="one", processed=True)
    names = {f"block {k}": BLOCKS.lane(k) for k in range(3)}
    config = Config(models=ModelSettings(use=use, auto=True))
    summary = assess([record], config, names)["summary"]
    known = critical_scale(BLOCKS, MOTION, 0.01, points=config.search.points).safety_factor
    assert np.array_equal(summary["safety_factor"].sel(model="auto").values[0], known)


def test_a_record_without_a_sequence_has_no_factors_of_the_sequences():
    one = scene(np.concatenate((np.zeros(50), 0.5 * np.sin(np.linspace(0.0, np.pi, 50)), np.zeros(20))))
    assert one.sequence is None
    found = critical_scales(BLOCKS, one, answers(one))
    assert np.all(np.isnan(found["sequence"].safety_factor))
    assert np.all(np.isnan(found["resonance"].safety_factor))
    assert not np.any(np.isnan(found["nonlinear"].safety_factor))


def test_what_the_model_cannot_answer_has_no_factor():
    up = np.zeros(T.size)
    up[500] = -11.0
    vertical = Record(up, 0.01, id="up", processed=True)
    one = prepare(
        Record(MOTION, 0.01, id="one", processed=True), Config(models=ModelSettings(use=("nonlinear",))), vertical
    )
    tall = Block(0.5, 1.5)
    found = critical_scales(tall.lanes(1), one, {"nonlinear": MODELS["nonlinear"](tall.lanes(1), one)})["nonlinear"]
    assert np.isnan(found.safety_factor[0])
    assert found.lane.size == 0
