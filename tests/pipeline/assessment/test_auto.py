"""The model that chooses among the others, and the check whether a verdict is predictable."""

import numpy as np
import pytest
from bursts import DT, TOWER, WALL, record
from nominal import Config

from rockpulse import (
    BlockSettings,
    ModelSettings,
)
from rockpulse.assessment.assessment import assess
from rockpulse.models import Block, Outcome, recorded_response
from rockpulse.record.record import Record

AUTO = ModelSettings(use=("nonlinear",), auto=True)
SPREAD = tuple(
    BlockSettings(name=f"p {p} alpha {alpha}", p=p, alpha=alpha) for p in (1.0, 2.0, 4.0) for alpha in (0.06, 0.15, 0.3)
)


@pytest.fixture(scope="module")
def chosen():
    records = [record("one"), record("two", 1, 1.0), record("three", 3, 2.0)]
    return assess(records, Config(blocks=SPREAD, models=AUTO))["summary"]


def used(summary, model="auto"):
    """Names of the models used, by the flags of the variable."""
    variable = summary["model_used"].sel(model=model)
    meanings = dict(zip(variable.attrs["flag_values"], variable.attrs["flag_meanings"].split(), strict=True))
    return np.vectorize(meanings.get)(variable.values)


def test_auto_is_one_more_model_with_the_outcomes_of_the_nonlinear_one(chosen):
    assert list(chosen["model"].values) == ["nonlinear", "auto"]
    outcome = chosen["outcome"]
    assert np.array_equal(outcome.sel(model="auto"), outcome.sel(model="nonlinear"))
    assert {"static", "impulsive", "nonlinear"} <= set(used(chosen).ravel())
    assert set(used(chosen, "nonlinear").ravel()) == {"nonlinear"}
    assert np.all(np.isfinite(chosen["peak_rotation_ratio"].values[outcome.values == Outcome.ROCKS]))
    assert np.all((used(chosen) == "static") == (outcome.sel(model="auto").values == Outcome.AT_REST))


def test_auto_with_a_tolerance_on_the_peak_gives_the_peaks():
    models = ModelSettings(use=("nonlinear",), auto=True, output="peak", tolerance=1e-9)
    summary = assess([record("two", 1, 1.0)], Config(blocks=SPREAD, models=models))["summary"]
    peak = summary["peak_rotation_ratio"]
    assert np.array_equal(peak.sel(model="auto"), peak.sel(model="nonlinear"))
    assert set(used(summary).ravel()) <= {"static", "nonlinear"}


def test_auto_leaves_histories_to_the_models_that_are_named():
    models = ModelSettings(use=("nonlinear",), auto=True, histories=True)
    kept = assess([record("two", 1, 1.0)], Config(blocks=(WALL,), models=models))["records"]
    assert kept["history_model_index"].values.tolist() == [0]


def test_predictability_is_checked_only_where_asked_for():
    tree = assess([record("one")], Config(blocks=(WALL, TOWER)))
    assert np.all(tree["summary"]["predictable"] == -1)


def test_predictability_marks_the_models_that_answer_for_the_record():
    sharp = record("one", 5, 1.0)
    blocks = [BlockSettings(name="calm", p=1.0, alpha=0.08), BlockSettings(name="edge", p=2.0, alpha=0.05)]
    # The factor at which the second block just overturns is found by bisection: there the ninth digit decides.
    low, high = 0.1, 4.0
    edge = Block.from_parameters(2.0, 0.05, "housner")
    for _ in range(60):
        middle = 0.5 * (low + high)
        fell = recorded_response(edge, middle * sharp.acceleration, DT).outcome == Outcome.OVERTURNS
        low, high = (low, middle) if fell else (middle, high)
    at_edge = Record(low * sharp.acceleration, DT, id="edge", processed=True)
    models = ModelSettings(use=("resonance", "linear", "nonlinear"), auto=True, predictability=True)
    summary = assess([at_edge], Config(blocks=tuple(blocks), models=models))["summary"].to_dataset().squeeze()
    marks = summary["predictable"]
    assert np.all(marks.sel(model="resonance") == -1)
    assert np.all(marks.sel(model=["linear", "nonlinear", "auto"]) >= 0)
    assert marks.sel(block="edge", model="nonlinear") == marks.sel(block="edge", model="auto") == 0
    assert marks.attrs["flag_meanings"] == "not_checked no yes"
    assert list(marks.attrs["flag_values"]) == [-1, 0, 1]


def test_the_check_of_auto_is_about_what_it_was_asked_for():
    # With a tolerance far below what the ninth digit moves every peak that is not zero fails; the verdicts stay.
    marks = {}
    for output in ("outcome", "peak"):
        models = ModelSettings(use=("nonlinear",), auto=True, output=output, tolerance=1e-15, predictability=True)
        summary = assess([record("two", 1, 1.0)], Config(blocks=SPREAD, models=models))["summary"].to_dataset()
        rocks = (summary["outcome"].sel(model="nonlinear") == Outcome.ROCKS).values
        assert rocks.any()
        assert np.all(summary["predictable"].sel(model="nonlinear").values[rocks] == 0)
        marks[output] = summary["predictable"].sel(model="auto").values[rocks]
    assert np.all(marks["outcome"] == 1)
    assert np.all(marks["peak"] == 0)
