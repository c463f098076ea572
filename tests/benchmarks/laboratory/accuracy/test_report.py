"""Orders of convergence, kinds of bodies, and the whole accuracy report."""

from dataclasses import replace

import pytest

from laboratory.accuracy.__main__ import QUICK, accuracy, overview
from laboratory.accuracy.bodies import bodies_table
from laboratory.accuracy.convergence import convergence
from laboratory.accuracy.diagram import diagram
from rocking.march.polynomial import ORDER

pytestmark = pytest.mark.slow


def test_the_nonlinear_kernel_converges_with_the_order_of_its_series():
    """Series of phi to order N: the rate is wrong by h^N after a step, the motion by h^(N - 1) after a time."""
    rows = convergence(seed=0, motions=6, divisions=(1, 2, 3), repeats=1)
    assert rows["step"].tolist() == pytest.approx([0.3, 0.15, 0.1])
    assert rows["order_cases"].iloc[1:].min() >= 10
    assert rows["order"].iloc[1:].tolist() == pytest.approx([ORDER - 1, ORDER - 1], abs=1.0)
    assert rows["median"].is_monotonic_decreasing


@pytest.fixture(scope="module")
def by_kind():
    return bodies_table(seed=3, motions=2, repeats=1).set_index("kind")


@pytest.mark.slow
def test_shorter_steps_change_less_than_the_last_digits_of_the_record(by_kind):
    # What is more than rounding is the sensitivity of the motion itself.
    assert (by_kind["max"] < 10.0 * by_kind["max_perturbed"] + 1e-12).all()
    assert (by_kind["median"] < 1e-11).all()


@pytest.fixture(scope="module")
def quick(ridgecrest):
    return accuracy(ridgecrest[:1], replace(QUICK, reference_cases=4, motions=2), seed=1)


def test_every_table_of_the_report_is_reported(quick):
    told = overview(quick)
    assert set(quick["model_form"]["ensemble"]) == {"records", "synthetic"}
    for words in ("linear equation", "RK45, rtol 1e-06", "elastic ties", "impulsive, missed", "velocity_ratio"):
        assert words in told
    assert (quick["work_precision"]["flips"] == 0).all()


def test_the_diagram_has_a_line_for_every_method(quick):
    figure = diagram(quick["work_precision"])
    assert len(figure.axes) == 2
    rows = quick["work_precision"].set_index(["equation", "method", "call"])
    shown = {line.get_label(): line for line in figure.axes[0].lines}
    (line,) = (one for words, one in shown.items() if words == "solve_ivp RK45 by rtol: median")
    assert line.get_ydata() == pytest.approx(rows.loc[("linear", "RK45", "single"), "median"].to_numpy())
