"""Overturning thresholds of pulses under the linear equation: VALIDATION V13 to V15 (D), refined as V22 asks."""

import numpy as np
import pytest

from rocking import Block, Outcome, ground_demand, recorded_response

G = 9.81
SAMPLES = 8000  # a cycle: the error of the piecewise-linear sine is of second order, 5e-8
EDGE = 1e-5


def outcomes(frequency, amplitudes, cycles):
    """Outcome of a block with p = 2 1/s, C = 0.9 under a sine of w = frequency p, for amplitudes over g alpha."""
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9, gravity=G)
    samples = round(cycles * SAMPLES)
    sine = np.sin(2.0 * np.pi * np.arange(samples + 1) / SAMPLES)
    sine[-1] = 0.0
    dt = 2.0 * np.pi / (frequency * 2.0) / SAMPLES
    return recorded_response(block, sine * G * 0.1, dt, "linear", scale=np.asarray(amplitudes)).outcome


@pytest.mark.parametrize(("frequency", "threshold"), [(1, 1.322397), (2, 1.800724), (3, 2.293872), (4, 2.790798)])
def test_half_sine_overturns_from_its_threshold(frequency, threshold):  # V13 (D), F7
    below, above = outcomes(frequency, [threshold * (1.0 - EDGE), threshold * (1.0 + EDGE)], 0.5)
    assert (below, above) == (Outcome.ROCKS, Outcome.OVERTURNS)


@pytest.mark.parametrize(("frequency", "threshold"), [(2, 2.349903), (3, 3.631150), (4, 5.238964), (6, 9.416966)])
def test_one_sine_overturns_without_an_impact_from_its_threshold(frequency, threshold):  # V14 (D), F8 mode 2
    below, above = outcomes(frequency, [threshold * (1.0 - EDGE), threshold * (1.0 + EDGE)], 1.0)
    assert (below, above) == (Outcome.ROCKS, Outcome.OVERTURNS)


@pytest.mark.parametrize(
    ("frequency", "first", "last"),
    [(2, 1.22518, 2.31440), (3, 1.40357, 3.48466), (4, 1.79544, 4.85011), (5, 3.01860, 6.31807)],
)
def test_one_sine_overturns_after_an_impact_within_its_band(frequency, first, last):  # V15 (D), F8 mode 1
    edges = np.array([first * (1.0 - EDGE), first * (1.0 + EDGE), last * (1.0 - EDGE), last * (1.0 + EDGE)])
    found = outcomes(frequency, edges, 1.0)
    assert list(found) == [Outcome.ROCKS, Outcome.OVERTURNS, Outcome.OVERTURNS, Outcome.ROCKS]


def test_one_sine_overturns_again_beyond_the_safe_window():  # V15 (D), w/p = 5
    found = outcomes(5, [7.16813 * (1.0 - EDGE), 7.16813 * (1.0 + EDGE)], 1.0)
    assert list(found) == [Outcome.ROCKS, Outcome.OVERTURNS]


def test_verdict_alone_is_that_of_the_whole_motion_and_costs_less():
    rng = np.random.default_rng(6)
    block = Block.from_parameters(p=rng.uniform(1.0, 6.0, 300), alpha=rng.uniform(0.05, 0.3, 300), restitution=0.9)
    t = 0.01 * np.arange(2000)
    motion = 3.5 * np.sin(7.0 * t) * np.exp(-(((t - 5.0) / 2.0) ** 2)) + 0.05 * np.sin(5.0 * t)
    whole = recorded_response(block, motion, 0.01)
    verdict = recorded_response(block, motion, 0.01, verdict=ground_demand(block, motion, 0.01))
    assert np.array_equal(whole.outcome, verdict.outcome)
    assert {Outcome.ROCKS, Outcome.OVERTURNS} <= set(np.unique(whole.outcome))
    assert np.all(verdict.active_samples <= whole.active_samples)
    assert verdict.active_samples.sum() < 0.8 * whole.active_samples.sum()
    rocks = whole.outcome == Outcome.ROCKS
    assert np.all(verdict.peak_rotation_ratio[rocks] <= whole.peak_rotation_ratio[rocks] * (1.0 + 1e-12))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"verdict": "x"}, "verdict: expected a rocking.Demand"),
        ({"equation": "linear"}, "verdict: expected the nonlinear equation"),
        ({"history": True}, "verdict: expected the nonlinear equation"),
        ({"initial_rotation": 0.1}, "verdict: expected a block at rest"),
        ({"acceleration": np.ones(51)}, "verdict: expected the demand of this record"),
        ({"initial_rotation": np.zeros(3)}, "verdict: expected the demand of this record on these blocks"),
        ({"last_term": "x"}, "last_term"),
        ({"last_term": 1e-300}, "last_term"),
    ],
)
def test_verdict_is_refused_where_it_was_not_measured(change, message):
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9)
    arguments = {"acceleration": np.ones(50), "dt": 0.01, "verdict": ground_demand(block, np.ones(50), 0.01), **change}
    with pytest.raises(ValueError, match=message):
        recorded_response(block, **arguments)
