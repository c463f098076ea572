"""The diagram says what its floor is, and its texts stand apart."""

import itertools

import numpy as np
import pandas as pd
import pytest

from rockpulse.accuracy_diagram import diagram


@pytest.fixture(scope="module")
def panel():
    """Errors below the floor, and two tolerances of about the same error and cost."""
    methods = ["reference", "rockpulse", "RK45", "RK45", "RK45"]
    rows = pd.DataFrame(
        {
            "equation": "nonlinear",
            "method": methods,
            "option": ["perturbation", "step", "rtol", "rtol", "rtol"],
            "setting": [1e-13, 0.08, 1e-3, 1e-6, 1e-9],
            "call": ["lanes", "lanes", "single", "single", "single"],
            "cases": 6,
            "median": [1e-12, 4e-18, 4e-4, 2e-4, 2e-7],
            "p90": [1e-10, 3e-13, 2e-3, 1e-3, 1e-6],
            "ns_per_active_sample": [np.nan, 60.0, 7.5e4, 1.5e5, 5.5e5],
        }
    )
    figure = diagram(pd.concat([rows, rows.assign(equation="linear")]))
    figure.draw_without_rendering()
    return figure.axes[0]


def test_the_tick_of_the_floor_says_that_smaller_errors_stand_there(panel):
    labels = dict(zip(panel.get_yticks().tolist(), (tick.get_text() for tick in panel.get_yticklabels()), strict=True))
    assert labels[1e-16] == r"$\leq 10^{-16}$"
    assert labels[1e-14] == r"$10^{-14}$"
    assert min(panel.lines[0].get_ydata()) == 1e-16


def test_no_text_of_a_tolerance_touches_another(panel):
    boxes = [text.get_window_extent().padded(2.0) for text in panel.texts]
    assert len(boxes) == 4
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
