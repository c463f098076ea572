"""Statistics of the errors of answers, by hand."""

import numpy as np
import pandas as pd
import pytest

from laboratory.accuracy.statistics import (
    WELL_CONDITIONED,
    error_statistics,
    observed_order,
    reference_under_perturbation,
)

pytestmark = pytest.mark.slow


#: Eleven survivors at rising peaks, one that overturns, one whose verdict the perturbation flips.
REFERENCE = pd.DataFrame(
    {
        "peak": [*np.linspace(0.1, 0.9, 11), np.inf, 0.5],
        "outcome": ["ROCKS"] * 11 + ["OVERTURNS", "ROCKS"],
        "spread": [1e-14] * 10 + [2.0 * WELL_CONDITIONED, 0.0, np.inf],
    },
    index=[f"case-{number}" for number in range(13)],
)


def answers(errors, **changed):
    """The reference's answers off by some errors; `changed` maps a place to another (peak, outcome)."""
    frame = REFERENCE[["peak", "outcome"]].copy()
    frame.loc[frame.index[:11], "peak"] += errors
    for place, (peak, outcome) in changed.items():
        frame.loc[place.replace("_", "-"), ["peak", "outcome"]] = peak, outcome
    return frame


def test_quantiles_of_known_errors():
    """Errors 0, 1, ... 10 times 1e-6 on the survivors, and 0 on the last case: twelve values, 0 twice."""
    errors = 1e-6 * np.arange(11)
    found = error_statistics(answers(errors), REFERENCE)
    sizes = np.sort([*errors, 0.0])
    # Linear interpolation between the sorted values: place 5.5 of 0..11, 9.9, 10.89.
    assert found["median"] == pytest.approx(0.5 * (sizes[5] + sizes[6]))
    assert found["p90"] == pytest.approx(sizes[9] + 0.9 * (sizes[10] - sizes[9]))
    assert found["p99"] == pytest.approx(sizes[10] + 0.89 * (sizes[11] - sizes[10]))
    assert found["max"] == pytest.approx(1e-5)


def test_well_conditioned_cases_are_those_that_the_perturbation_leaves_alone():
    found = error_statistics(answers(np.r_[np.zeros(10), 0.3]), REFERENCE)
    assert found["max"] == pytest.approx(0.3)
    assert found["max_well"] == 0.0
    assert found["well_conditioned"] == pytest.approx(11 / 13)  # the overturned one stays overturned
    assert found["reference_flips"] == 1


@pytest.mark.parametrize(("case", "answer"), [("case_3", (np.inf, "OVERTURNS")), ("case_11", (0.8, "ROCKS"))])
def test_another_verdict_is_a_flip_and_no_error(case, answer):
    found = error_statistics(answers(np.zeros(11), **{case: answer}), REFERENCE)
    assert found["flips"] == 1
    assert found["max"] == 0.0
    assert found["compared"] == (11 if case == "case_3" else 12)


def test_an_unresolved_answer_is_a_flip_of_its_own_kind():
    found = error_statistics(answers(np.zeros(11), case_0=(np.nan, "UNRESOLVED")), REFERENCE)
    assert (found["unresolved"], found["flips"], found["compared"]) == (1, 1, 11)


def test_the_reference_under_its_perturbation_is_its_spread():
    found = reference_under_perturbation(REFERENCE)
    assert found["flips"] == found["reference_flips"] == 1
    assert found["compared"] == 11  # neither the overturned nor the flipping one
    assert (found["median"], found["max"]) == (1e-14, 2.0 * WELL_CONDITIONED)
    assert found["max_well"] == 1e-14


@pytest.mark.parametrize("order", [1, 2, 7])
def test_the_order_is_read_from_errors_that_follow_a_power(order):
    factor = np.array([1.0, 3.0, 0.2, 5.0])
    coarse = pd.DataFrame({"error": factor * 0.3**order, "step": 0.3})
    fine = pd.DataFrame({"error": factor * 0.1**order, "step": 0.1})
    assert observed_order(coarse, fine) == (pytest.approx(order), 4)


def test_no_order_is_read_from_rounding_or_from_one_step():
    coarse = pd.DataFrame({"error": [1e-9, 1e-15, np.nan], "step": 0.2})
    fine = pd.DataFrame({"error": [1e-15, 1e-15, 1e-9], "step": 0.1})
    assert observed_order(coarse, fine)[1] == 0
    assert np.isnan(observed_order(coarse, fine)[0])
    assert observed_order(coarse, coarse)[1] == 0
