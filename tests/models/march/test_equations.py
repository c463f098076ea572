"""Steps of the linear and the nonlinear equation, and the free motion, against fifty digits and an integrator."""

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from rocking.march import slots as row
from rocking.march.equations import (
    flight_time,
    hyperbolic,
    linear_steps,
    nonlinear_after,
    nonlinear_rates,
    top_rotation,
)
from rocking.march.steps import speed_of, value_of


@pytest.mark.parametrize("h", [1e-12, 1e-3, 0.04, 0.3])
def test_hyperbolic_functions_of_a_step_keep_their_digits(h):
    with mpmath.workdps(50):
        exact = [mpmath.cosh(h) - 1, mpmath.sinh(h), mpmath.sinh(h) - h]
        for found, value in zip(hyperbolic(h), exact, strict=True):
            assert abs(found / value - 1) < 4e-16


def test_step_is_the_solution_of_the_equation_in_every_slot():
    rng = np.random.default_rng(4)
    f = np.zeros(row.FLOAT_ROWS * row.WIDTH)
    for name, low, high in (
        (row.PHI, 0.0, 0.1),
        (row.SPEED, -0.1, 0.1),
        (row.STEP, 0.001, 0.08),
        (row.ALPHA, 0.05, 0.3),
        (row.GROUND, -0.5, 0.5),
        (row.SLOPE, -5.0, 5.0),
    ):
        f[name : name + row.WIDTH] = rng.uniform(low, high, row.WIDTH)
    linear_steps(f, row.WIDTH)
    with mpmath.workdps(50):
        for j in range(row.WIDTH):
            phi, speed, h, alpha, ground, slope = (
                mpmath.mpf(f[name + j]) for name in (row.PHI, row.SPEED, row.STEP, row.ALPHA, row.GROUND, row.SLOPE)
            )
            # phi'' = phi - alpha - ground - slope tau: a straight line plus two hyperbolic functions.
            line = alpha + ground
            end = line + slope * h + (phi - line) * mpmath.cosh(h) + (speed - slope) * mpmath.sinh(h)
            end_speed = slope + (phi - line) * mpmath.sinh(h) + (speed - slope) * mpmath.cosh(h)
            assert abs(f[row.END + j] - end) < 1e-16
            assert abs(f[row.END_SPEED + j] - end_speed) < 2e-16
            assert abs(f[row.END_PULL + j] - (end - line - slope * h)) < 4e-16


ALPHA = 0.25


def speed_at(phi, excess):
    """dphi/dtau from the energy above that of rest at the top."""
    return math.sqrt(2.0 * excess + 4.0 * math.sin(0.5 * (phi - ALPHA)) ** 2)


@pytest.mark.parametrize("excess", [1e-12, 1e-6, 0.01, 0.3])
def test_flight_over_the_top_takes_the_time_of_the_energy_integral(excess):
    start, stop = -ALPHA, 0.5 * math.pi - ALPHA
    points = sorted({0.0, *(10.0**-k * s for k in range(1, 8) for s in (-1, 1) if 10.0**-k < ALPHA)})
    exact = quad(lambda psi: 1.0 / speed_at(psi + ALPHA, excess), start, stop, points=points, limit=400, epsrel=1e-13)
    assert flight_time(excess, start, stop) == pytest.approx(exact[0], rel=1e-11)


def test_flight_towards_the_top_without_energy_to_spare_never_ends():
    assert flight_time(0.0, -ALPHA, 0.1) == math.inf


def test_half_cycle_below_the_top_takes_the_time_of_an_integrator():
    speed = 0.2
    excess = 0.5 * speed**2 - 2.0 * math.sin(0.5 * ALPHA) ** 2
    top = -2.0 * math.asin(math.sqrt(-0.5 * excess))
    rise = flight_time(excess, -ALPHA, top)

    def turning(_, state):
        return state[1]

    turning.terminal = True
    motion = solve_ivp(
        lambda _, s: [s[1], -math.sin(ALPHA - s[0])], (0, 10), [0.0, speed], "DOP853", rtol=1e-13, atol=1e-15,
        events=turning,
    )  # fmt: skip
    assert rise == pytest.approx(motion.t_events[0][0], rel=1e-10)
    assert top + ALPHA == pytest.approx(motion.y_events[0][0, 0], rel=1e-10)
    assert top_rotation(speed, ALPHA) == pytest.approx(motion.y_events[0][0, 0], rel=1e-12)


def test_small_hop_keeps_its_digits():
    speed = 1e-9
    assert top_rotation(speed, ALPHA) == pytest.approx(0.5 * speed**2 / math.sin(ALPHA), rel=1e-12)


@pytest.mark.parametrize(
    ("phi", "speed", "overturns"),
    [
        (0.1, 0.3, True),  # more than enough to pass the top
        (0.1, 0.1, False),
        (0.1, -0.1, False),
        (ALPHA, 0.0, True),  # at rest on the top: it does not come back
        (0.3, 0.0, True),
        (0.3, -0.01, True),  # inward, but too slow to come back over the top
        (0.3, -0.1, False),
    ],
)
def test_verdict_on_a_still_ground_is_that_of_energy(phi, speed, overturns):
    peak, wait, impacts, _ = nonlinear_after(phi, speed, ALPHA, 0.9)
    assert (peak == math.inf) is overturns
    assert math.isnan(wait) is not overturns
    assert impacts == 0


def test_wait_of_a_block_that_turns_beyond_the_top_is_that_of_an_integrator():
    def fallen(_, state):
        return state[0] - 0.5 * math.pi

    fallen.terminal = True
    motion = solve_ivp(
        lambda _, s: [s[1], -math.sin(ALPHA - s[0])], (0, 50), [0.3, -0.04], "DOP853", rtol=1e-13, atol=1e-15,
        events=fallen,
    )  # fmt: skip
    assert np.min(motion.y[0]) > ALPHA
    assert nonlinear_after(0.3, -0.04, ALPHA, 0.9)[1] == pytest.approx(motion.t_events[0][0], rel=1e-10)


@pytest.mark.parametrize("lift_slope", [0.7])
def test_series_is_the_motion_of_the_equation(lift_slope):
    ground, slope, lift, h = -0.4, 1.3, 1.1, 0.1
    start = (0.05, 0.1)
    series = nonlinear_rates(*start, ALPHA, ground, slope, lift, lift_slope)

    def equation(t, s):
        angle = ALPHA - s[0]
        return [s[1], -(lift + lift_slope * t) * math.sin(angle) - (ground + slope * t) * math.cos(angle)]

    motion = solve_ivp(equation, (0, h), [0.05, 0.1], "DOP853", rtol=1e-13, atol=1e-16)
    assert value_of(h, *start, *series) == pytest.approx(motion.y[0, -1], rel=1e-13)
    assert speed_of(h, start[1], *series) == pytest.approx(motion.y[1, -1], rel=1e-12)
