"""``recorded_response`` of bodies of every kind against ``body_reference.py``, a slow solver."""

import math

import numpy as np
import pytest
from body_cases import KINDS, drawn
from body_reference import reference
from recorded_cases import block_of, shaking

from rocking.march.recorded import recorded_response
from rocking.response import Outcome

AGREES = 1e-9
#: Relative perturbation that tells how well conditioned a case is.
RELATIVE = 1e-13
#: Kinds that take the slow solver a second and more.
LONG = ("brittle", "friction", "all")


def distance(one, other, alpha):
    """Largest difference of theta over alpha at the samples that both know, and of the peaks."""
    both = np.isfinite(one.rotation) & np.isfinite(other.rotation)
    apart = float(np.max(np.abs(one.rotation - other.rotation)[both], initial=0.0)) / alpha
    peaks = one.peak_rotation_ratio, other.peak_rotation_ratio
    return max(apart, abs(peaks[0] - peaks[1])) if all(map(math.isfinite, peaks)) else apart


def judged(kind, number, seconds=4.0):
    """How far the kernel is from the reference, and "agrees", "ill-conditioned" or what is wrong."""
    block, ground, dt, equation = drawn(kind, number, seconds)
    fast = recorded_response(block, ground, dt, equation, history=True)
    try:
        slow = reference(block, ground, dt, equation=equation)
    except RuntimeError:  # a load whose friction holds the body up on its hops
        return math.nan, "not followed"
    apart = distance(fast, slow, block.weaker.alpha_c)
    counted = kind not in ("plain", "corners", "wall") or fast.impacts == slow.impacts
    late = slow.outcome == Outcome.OVERTURNS and abs(fast.overturning_time - slow.overturning_time)
    soon = not late or late < (1e-8 if equation == "nonlinear" else 1.01 * dt)
    if fast.outcome == slow.outcome and apart <= AGREES and counted and soon:
        return apart, "agrees"
    other = recorded_response(block, ground * (1.0 + RELATIVE), dt, equation, history=True)
    moved = distance(fast, other, block.weaker.alpha_c)
    if fast.outcome != other.outcome or moved > 1e-11:
        return apart, "ill-conditioned"
    return apart, f"{fast.outcome} {slow.outcome} {apart:g} {fast.impacts} {slow.impacts} {late}, moved {moved:g}"


@pytest.mark.parametrize(
    ("kind", "number", "seconds"),
    [
        *((kind, 0, 1.5) for kind in KINDS if kind not in LONG),
        *(pytest.param(kind, 0, 1.5, marks=pytest.mark.sweep) for kind in LONG),
        *(pytest.param(kind, 1, 3.0, marks=pytest.mark.sweep) for kind in KINDS if kind != "all"),
    ],
)
def test_the_kernel_agrees_with_the_slow_solver(kind, number, seconds):
    assert judged(kind, number, seconds)[1] in ("agrees", "ill-conditioned", "not followed")


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_two_hundred_cases_of_each_kind_agree(kind):
    found = [judged(kind, number) for number in range(200)]
    verdicts = [verdict for _, verdict in found]
    known = ("agrees", "ill-conditioned", "not followed")
    print(kind, {word: verdicts.count(word) for word in known}, "median", np.nanmedian([apart for apart, _ in found]))
    assert [verdict for verdict in verdicts if verdict not in known] == []
    assert verdicts.count("agrees") >= 190 - verdicts.count("not followed")


@pytest.mark.parametrize(
    ("radius", "slenderness", "restitution", "start"),
    [(2.0, 5.0, 0.85, (0.3, -0.2)), (1.0, 4.0, "housner", (-0.1, -0.1)), (0.5, 6.0, 0.6, (0.0, 0.4))],
)
def test_vertical_motion_and_initial_state_agree_with_the_slow_solver(radius, slenderness, restitution, start):
    block = block_of(radius, slenderness, restitution)
    ground = shaking(40, 200, 0.01) * 2.0 * block.gravity / slenderness
    up = shaking(60, 200, 0.01, 0.5, 12.0) * 0.6 * block.gravity
    theta, speed = start[0] * block.alpha_c, start[1] * block.p * block.alpha_c
    slow = reference(block, ground, 0.01, vertical=up, rotation=theta, velocity=speed)
    state = {"initial_rotation": theta, "initial_velocity": speed}
    fast = recorded_response(block, ground, 0.01, vertical=up, history=True, **state)
    assert (fast.outcome, fast.impacts) == (slow.outcome, slow.impacts)
    assert distance(fast, slow, block.alpha_c) <= AGREES
