"""The exact map of the linear equation, against the same formula in fifty digits."""

import mpmath
import numpy as np
import pytest

from rocking.impulses.half_cycle import slots as row
from rocking.march.equations import hyperbolic, linear_steps


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
