"""What may be counted as safe under one record, on answers that are known."""

import numpy as np
import pytest
import xarray as xr
from results_tree import results_tree

from rocking.response import Outcome, Reason
from rockpulse.views.report.standing import Standing, bodies_of, lanes, standings, why_unknown

OF = ("record", "block", "model")


def one(**answers):
    """A summary of one answer: at factor 1 it rocks, with a safety factor of 2, unless said otherwise."""
    found = {"outcome": Outcome.ROCKS, "safety_factor": 2.0, "factor_resolved": 1, "predictable": 1, "applicable": 1}
    found |= {"reason": Reason.NONE} | answers
    variables = {name: (OF, np.full((1, 1, 1), value)) for name, value in found.items() if value is not None}
    variables["restitution"] = (("block",), np.array([0.9]))
    return xr.Dataset(variables, {"record": ["r"], "block": ["b"], "model": ["nonlinear"]})


@pytest.mark.parametrize(
    ("answers", "expected"),
    [
        ({}, Standing.STANDS),
        ({"safety_factor": 1.0}, Standing.THIN),
        ({"safety_factor": 1.1}, Standing.STANDS),
        ({"safety_factor": np.inf, "safe_up_to": 10.0, "outcome": Outcome.AT_REST}, Standing.STANDS),
        ({"safety_factor": np.inf, "safe_up_to": 1.0}, Standing.THIN),
        ({"safety_factor": np.inf}, Standing.THIN),
        ({"safety_factor": 1.3, "search_step": 1.014}, Standing.STANDS),
        ({"safety_factor": 1.3, "search_step": 1.06}, Standing.THIN),
        ({"safety_factor": 40.0, "search_step": 48.9}, Standing.THIN),
        ({"safety_factor": np.nan}, Standing.NO_MARGIN),
        ({"safety_factor": None}, Standing.NO_MARGIN),
        ({"safety_factor": 0.9}, Standing.WEAKER_OVERTURNS),
        ({"safety_factor": 0.9, "factor_resolved": 0}, Standing.UNKNOWN),
        ({"safety_factor": 2.0, "factor_resolved": 0}, Standing.STANDS),
        ({"outcome": Outcome.OVERTURNS, "safety_factor": 0.5}, Standing.OVERTURNS),
        ({"outcome": Outcome.OVERTURNS, "predictable": 0, "applicable": 0}, Standing.OVERTURNS),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": np.nan}, Standing.UNKNOWN),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": 0.5}, Standing.WEAKER_OVERTURNS),
        ({"predictable": 0}, Standing.UNKNOWN),
        ({"predictable": -1}, Standing.STANDS),
        ({"applicable": 0}, Standing.UNKNOWN),
    ],
    ids=lambda value: str(value),
)
def test_the_standing_of_an_answer(answers, expected):
    summary = one(**answers)
    assert standings(summary, bodies_of(summary), "nonlinear")[0, 0] == expected


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({}, ""),
        ({"outcome": Outcome.UNRESOLVED, "reason": Reason.FREE_FLIGHT}, "free flight"),
        ({"outcome": Outcome.UNRESOLVED}, "unresolved"),
        ({"predictable": 0}, "not predictable"),
        ({"applicable": 0}, "outside the range"),
        ({"safety_factor": 0.9, "factor_resolved": 0}, "a weaker copy may overturn it"),
    ],
)
def test_why_it_is_not_known(answers, words):
    summary = one(**answers)
    found = str(why_unknown(summary, bodies_of(summary), "nonlinear")[0, 0])
    assert found.startswith(words)
    assert bool(found) == bool(words)


def test_bodies_and_lanes_of_restitution_cases():
    summary = results_tree(cases=2)["summary"].to_dataset()
    bodies = bodies_of(summary)
    # The first block has the same restitution twice: one body.
    assert [body.name for body in bodies] == [
        "boundary wall",
        "column, C = 0.930",
        "column, C = 0.830",
        "cabinet, C = 0.790",
        "cabinet, C = 0.690",
    ]
    factor = lanes(summary, "safety_factor", bodies, "sequence")
    assert factor.shape == (3, 5)
    expected = summary["safety_factor"].sel(block="cabinet", model="sequence").isel(case=1)
    np.testing.assert_array_equal(factor[:, 4], expected)
    assert lanes(summary, "uplift_ratio", bodies).shape == (3, 5)
    assert lanes(summary, "no such variable", bodies) is None
