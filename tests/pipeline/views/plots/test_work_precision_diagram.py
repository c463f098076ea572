"""The diagram says what its floor is, and its texts stand apart."""

import itertools

import numpy as np
import pytest

from rockpulse.views.plots.work_precision_diagram import work_precision


@pytest.fixture(scope="module")
def panels(work_precision_rows):
    axes = work_precision(work_precision_rows)
    axes[0].figure.draw_without_rendering()
    return axes


def test_the_tick_of_the_floor_says_that_smaller_errors_stand_there(panels):
    ax = panels[0]
    labels = dict(zip(ax.get_yticks().tolist(), (tick.get_text() for tick in ax.get_yticklabels()), strict=True))
    assert labels[1e-16] == r"$\leq 10^{-16}$"
    assert labels[1e-14] == r"$10^{-14}$"
    assert min(ax.lines[0].get_ydata()) == 1e-16


def test_no_text_of_a_tolerance_touches_another(panels):
    boxes = [text.get_window_extent().padded(1.0) for text in panels[0].texts]
    assert len(boxes) == 4
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


def test_every_equation_has_a_panel_and_every_method_its_lines(panels, work_precision_rows):
    assert [ax.get_title(loc="left").split(" ")[0] for ax in panels] == ["nonlinear", "linear"]
    words = [line.get_label() for line in panels[0].lines]
    assert words == [
        "rockpulse by longest step p dt: median",
        "rockpulse by longest step p dt: p90",
        "solve_ivp RK45 by rtol: median",
        "solve_ivp RK45 by rtol: p90",
        "reference under a change of 1e-13: p90",
    ]
    own = work_precision_rows[work_precision_rows["method"] == "RK45"].head(3)
    for line, name in zip(panels[0].lines[2:4], ("median", "p90"), strict=True):
        assert np.array_equal(line.get_xdata(), own["ns_per_active_sample"])
        assert np.array_equal(line.get_ydata(), own[name])
    assert panels[0].lines[3].get_markerfacecolor() == "white"
    assert panels[0].lines[4].get_ydata()[0] == 1e-10
    assert (panels[0].get_xscale(), panels[0].get_yscale()) == ("log", "log")
    assert panels[0].get_ylabel() == r"error of $\theta_{max}/\alpha_c$ [-]"
    assert panels[0].get_xlabel() == "cost [ns per active sample]"
