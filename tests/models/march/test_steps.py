"""The quick way through a step, against the careful one (polynomial.py) on the same polynomials."""

import numpy as np
import pytest

from rocking.march import slots as row
from rocking.march.equations import nonlinear_steps
from rocking.march.polynomial import ORDER, first_impact, value, velocity
from rocking.march.steps import IMPACT, LOOK_CLOSER, NOTHING, finish_steps


def steps(seed):
    """Slots just above the ground, rising and falling, with ground from calm to rough; every third starts a hop."""
    rng = np.random.default_rng(seed)
    f = np.zeros(row.FLOAT_ROWS * row.WIDTH)
    for name, low, high in (
        (row.PHI, -7.0, -2.0),
        (row.SPEED, -5.0, -1.0),
        (row.STEP, -3.0, -1.1),
        (row.SLOPE, -2.0, 0.7),
        (row.PEAK, -6.0, -1.0),
    ):
        f[name : name + row.WIDTH] = 10.0 ** rng.uniform(low, high, row.WIDTH)
    f[row.PHI : row.PHI + row.WIDTH : 3] = 0.0
    hops = f[row.PHI : row.PHI + row.WIDTH] == 0.0
    f[row.SPEED : row.SPEED + row.WIDTH] *= np.where(hops, 1.0, rng.choice([-1.0, 1.0], row.WIDTH))
    f[row.SLOPE : row.SLOPE + row.WIDTH] *= rng.choice([-1.0, 1.0], row.WIDTH)
    f[row.GROUND : row.GROUND + row.WIDTH] = rng.uniform(-0.15, 0.1, row.WIDTH)
    f[row.LIFT : row.LIFT + row.WIDTH] = 1.0
    f[row.ALPHA : row.ALPHA + row.WIDTH] = rng.uniform(0.05, 0.3, row.WIDTH)
    f[row.RESTITUTION : row.RESTITUTION + row.WIDTH] = 0.9
    f[row.SIDE : row.SIDE + row.WIDTH] = 1.0
    f[row.TRUNCATION : row.TRUNCATION + row.WIDTH] = np.inf
    f[row.TOP : row.TOP + row.WIDTH] = 0.5 * np.pi
    f[row.PEAK : row.PEAK + row.WIDTH] = np.maximum(
        f[row.PEAK : row.PEAK + row.WIDTH], f[row.PHI : row.PHI + row.WIDTH]
    )
    return f


def polynomial(f, j):
    """Coefficients of phi in the step of slot j."""
    c = np.zeros(ORDER + 1)
    c[:2] = f[row.PHI + j], f[row.SPEED + j]
    for k in range(2, ORDER + 1):
        c[k] = f[row.RATE_2 + (k - 2) * row.WIDTH + j] / k
    return c


@pytest.mark.sweep
def test_quick_answers_are_those_of_the_careful_search():
    found = {NOTHING: 0, IMPACT: 0, LOOK_CLOSER: 0}
    for seed in range(60):
        f = steps(seed)
        nonlinear_steps(f, row.WIDTH)
        before = f.copy()
        finish_steps(f, row.WIDTH)
        for j in range(row.WIDTH):
            c, h, peak = polynomial(before, j), before[row.STEP + j], before[row.PEAK + j]
            impact, largest = first_impact(c, h, peak)
            event = f[row.EVENT + j]
            found[event] += 1
            if event == NOTHING:
                assert impact < 0.0
                assert f[row.PHI + j] == pytest.approx(value(c, h), rel=1e-14)
                assert f[row.SPEED + j] == pytest.approx(velocity(c, h), rel=1e-12, abs=1e-16)
                assert f[row.PEAK + j] == pytest.approx(max(peak, largest), rel=1e-14)
                assert f[row.PASSED + j] == h
            elif event == IMPACT:
                assert f[row.PASSED + j] == pytest.approx(impact, rel=1e-13)
                assert f[row.ARRIVAL + j] == pytest.approx(-velocity(c, impact), rel=1e-12)
                assert f[row.SPEED + j] == 0.9 * f[row.ARRIVAL + j]
                assert (f[row.PHI + j], f[row.SIDE + j], f[row.PEAK + j]) == (0.0, -1.0, peak)
                assert largest <= peak
            else:
                unchanged = [name + j for name in (row.PHI, row.SPEED, row.SIDE, row.PASSED, row.PEAK)]
                assert np.array_equal(f[unchanged], before[unchanged])
    assert min(found.values()) > 100


def test_marked_step_is_left_to_the_careful_search():
    f = steps(1)
    nonlinear_steps(f, row.WIDTH)
    f[row.MARKED : row.MARKED + row.WIDTH] = 1.0
    finish_steps(f, row.WIDTH)
    assert np.all(f[row.EVENT : row.EVENT + row.WIDTH] == LOOK_CLOSER)
