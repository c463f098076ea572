"""Response to given impulses against an integrator of the equation of motion that knows none of its closed forms."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking.body.block import Block
from rocking.impulses.impulsive import GAINS, impulsive_response
from rocking.response import IMPACT_CUTOFF, Outcome

G = 9.81
BODY = Block(half_width=0.5, half_height=np.sqrt(3.75), restitution=0.6, gravity=G)


def gain_of(gain, theta, side):
    alpha = BODY.alpha_c
    cosine = {
        "paper": math.cos(alpha),
        "linear": 1.0,
        "tangent": alpha / math.tan(alpha),
        "exact": math.cos(side * alpha - theta),
    }[gain]
    return BODY.p**2 * cosine / G


def integrated(times, impulses, gain):
    """Peak over alpha_c, outcome and counted impacts by integrating theta'' = p^2 (theta - s alpha) between impacts."""
    alpha, p = BODY.alpha_c, BODY.p
    theta = omega = 0.0
    side, peak, impacts = 0, 0.0, 0

    def ground(_, state, corner):
        return corner * state[0]

    ground.terminal = True

    def turning(_, state, corner):
        return state[1]

    def fallen(_, state, corner):
        return abs(state[0]) - 50.0 * alpha

    fallen.terminal = True
    ends = [*times[1:], times[-1] + 60.0 / p]
    for begin, impulse, end in zip(times, impulses, ends, strict=True):
        push = -gain_of(gain, theta, side if side else math.copysign(1.0, -impulse)) * impulse
        side = side or int(math.copysign(1.0, push))
        omega += push
        clock = begin
        while side and clock < end:
            ground.direction = -1.0
            run = solve_ivp(
                lambda _, state, corner: (state[1], p**2 * (state[0] - corner * alpha)),
                (clock, end),
                (theta, omega),
                "DOP853",
                events=(ground, turning, fallen),
                args=(side,),
                rtol=1e-12,
                atol=1e-15,
            )
            tops = [abs(state[0]) for state in run.y_events[1]]
            peak = max([peak, *(value / alpha for value in tops), abs(run.y[0, -1]) / alpha])
            clock, (theta, omega) = run.t[-1], run.y[:, -1]
            if run.t_events[2].size:
                return np.inf, Outcome.OVERTURNS, impacts
            if not run.t_events[0].size:
                break
            impacts += abs(omega) / (p * alpha) > IMPACT_CUTOFF
            theta, omega, side = 0.0, BODY.restitution * omega, -side
            if abs(omega) / (p * alpha) < 1e-6:
                side, omega = 0, 0.0
    return peak, Outcome.ROCKS, impacts


def random_train(seed, strength, count=7, length=5.0):
    rng = np.random.default_rng(seed)
    return np.sort(rng.uniform(0.0, length, count)), strength * BODY.critical_impulse * rng.normal(size=count)


@pytest.mark.slow
@pytest.mark.parametrize("gain", sorted(GAINS))
@pytest.mark.parametrize("strength", [0.15, 0.9])
@pytest.mark.parametrize("seed", range(6))
def test_response_agrees_with_the_integrated_equation_of_motion(seed, strength, gain):
    times, impulses = random_train(seed, strength)
    peak, outcome, impacts = integrated(times, impulses, gain)
    response = impulsive_response(BODY, times, impulses, gain=gain)
    assert response.outcome == outcome
    assert response.peak_rotation_ratio == pytest.approx(peak, rel=1e-7)
    assert response.impacts == impacts


@pytest.mark.slow
def test_random_trains_of_the_comparison_rock_and_overturn():
    outcomes = {impulsive_response(BODY, *random_train(seed, 0.9)).outcome for seed in range(6)}
    assert {Outcome.ROCKS, Outcome.OVERTURNS} <= outcomes
