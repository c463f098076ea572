"""The trial march through a half-cycle, against the same motion followed in small steps."""

import math

import pytest

from rocking.impulses.half_cycle import END, MIDDLE, OPEN, START, first_return

FIRST_WAIT = {START: 0.0, MIDDLE: 0.5, END: 1.0, OPEN: 1.0}


def followed(velocity, secondary, interval, spacing, limit=30.0, step=1e-4):
    """Time of the first return by exact steps of the natural motion; inf once it is beyond return."""
    x, elapsed, push = 0.0, 0.0, -secondary
    wait = FIRST_WAIT[spacing] * interval
    while elapsed < limit and x < 50.0:
        steps = math.ceil(wait / step)
        for _ in range(steps):
            h = wait / steps
            before = x
            x, velocity = (
                1.0 + (x - 1.0) * math.cosh(h) + velocity * math.sinh(h),
                (x - 1.0) * math.sinh(h) + velocity * math.cosh(h),
            )
            elapsed += h
            if x <= 0.0:
                return elapsed - h + h * before / (before - x)
        velocity += push
        push, wait = -push, interval
    return math.inf


@pytest.mark.parametrize("spacing", [END, MIDDLE, START, OPEN])
@pytest.mark.parametrize(
    ("velocity", "secondary", "interval"),
    [
        (0.6, 0.2, 0.15),
        (0.9, 0.4, 0.4),
        (1.05, 0.3, 0.1),  # on its way over the top, until the first push takes it back
        (1.12, 0.5, 0.2),
        (1.3, 0.1, 0.2),  # beyond return
        (0.97, 0.02, 1.0),
    ],
)
def test_first_return_is_that_of_the_motion_followed_step_by_step(spacing, velocity, secondary, interval):
    exact = followed(velocity, secondary, interval, spacing)
    assert first_return(velocity, secondary, interval, spacing) == pytest.approx(exact, abs=1e-7)


def test_first_push_takes_a_block_back_that_would_have_overturned():
    assert first_return(1.05, 0.0, 0.1, END) == math.inf
    assert first_return(1.05, 0.3, 0.1, END) < math.inf
