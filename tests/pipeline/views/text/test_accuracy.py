"""The printed report: what it leaves out because too few lanes stand behind it."""

import numpy as np
import pandas as pd

from rockpulse.views.text.accuracy import grid_text, model_form_text

NO_CLASSIFIERS = pd.DataFrame({"ensemble": []})


def printed(survivors, at_rest):
    """The cells of each line, by the label of the line."""
    rows = pd.DataFrame(
        {
            "ensemble": "made up",
            "model": "cheap",
            "demand_low": [0.0, 0.25],
            "demand_high": [np.inf, 0.5],
            "lanes": 40,
            "unresolved": 0,
            "overturn": 7,
            "missed": 0,
            "false": 0,
            "survivors": survivors,
            "at_rest": at_rest,
            "bias": [1.25, 3.5],
            "dispersion": [0.42, 0.61],
        }
    )
    text = model_form_text(rows, NO_CLASSIFIERS)
    return {line[:14].strip(): line[14:].split() for line in text.splitlines()}


def test_bias_and_dispersion_of_fewer_than_five_survivors_are_not_printed():
    lines = printed([5, 4], 0)
    assert lines["survivors"] == ["5", "4"]
    assert lines["bias"] == ["1.25", "-"]
    assert lines["dispersion"] == ["0.42", "-"]
    assert "at rest" not in lines


def test_survivors_at_rest_do_not_count():
    lines = printed([9, 9], [4, 5])
    assert lines["survivors"] == ["9", "9"]
    assert lines["at rest"] == ["4", "5"]
    assert lines["bias"] == ["1.25", "-"]


def test_the_synthetic_grid_stands_beside_the_reference():
    rows = pd.DataFrame(
        {
            "equation": ["nonlinear"],
            "restitution": 0.9,
            "step": 0.08,
            "cases": 300,
            "compared": 200,
            "median": 2e-15,
            "p99": 3e-7,
            "flips": 1,
            "reference_p99": 4e-6,
            "reference_flips": 2,
        }
    )
    last = grid_text(rows).splitlines()[-1]
    assert " ".join(last.split()) == "nonlinear, C = 0.9, step 0.08 300 2.0e-15 3.0e-07 1 4.0e-06 2"
