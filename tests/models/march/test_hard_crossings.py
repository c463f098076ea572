"""Hard cases of the response to a record, by name: the ground at the threshold, and the path near the ground.

Each is right by 42 digits, see ``hard_case.py``; that a crossing or a grazing happens is shown in them first.
"""

import math
from functools import cache

import numpy as np
import pytest
from hard_case import ACCURACY, answer, assert_right, exact, precise
from recorded_cases import EQUATIONS

from rocking import Block, Outcome

# Powers of two, so that g alpha is exact and the linear threshold is 2 m/s2 to the last bit.
EXACT_BLOCK = {"p": 2.0, "alpha": 0.25, "restitution": 0.5, "gravity": 8.0}


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    "shape", [[2.0] * 100, [0.0, 1.0, 2.0, 1.0, 0.0], [0.0, 2.0, 2.0, 2.0, -2.0, 0.0]], ids=["plateau", "touch", "both"]
)
def test_ground_exactly_at_the_threshold_leaves_the_block_at_rest(shape, side):
    response = answer(Block.from_parameters(**EXACT_BLOCK), side * np.array(shape), 0.01, equation="linear")
    assert (response.outcome, response.peak_rotation_ratio, response.impacts) == (Outcome.AT_REST, 0.0, 0)


@pytest.mark.parametrize("alpha", [0.05, 0.7])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_plateau_at_the_rounded_threshold_rests_and_a_little_above_rocks(equation, alpha):
    """Whichever way g tan(alpha) or g alpha was rounded: a bit is no uplift, a share of 1e-9 is."""
    block = Block.from_parameters(p=2.0, alpha=alpha, restitution=0.9)
    plateau = np.full(25, block.gravity * (math.tan(alpha) if equation == "nonlinear" else alpha))
    assert answer(block, plateau, 0.01, equation=equation).outcome == Outcome.AT_REST
    assert_right(block, plateau * (1.0 + 1e-9), 0.01, equation)


@pytest.mark.parametrize(
    "shape",
    [
        [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0, 0.0, 0.0],
        [0.0, 2.0, 2.0, 2.0, 3.0, 2.0, 2.0, 0.0, 0.0],
        [2.0, 4.0, 2.0, 0.0, -2.0, -4.0, -2.0, 0.0],
        [0.0, 2.0, -2.0, 2.0, -3.0, 2.0, 0.0],
    ],
    ids=["ramp", "plateau-then-above", "starts-there", "from-side-to-side"],
)
def test_threshold_crossed_exactly_on_a_sample(shape):
    response = assert_right(Block.from_parameters(**EXACT_BLOCK), np.array(shape), 0.05, "linear")
    assert response.outcome == Outcome.ROCKS


PUSHED = {"p": 2.0, "alpha": 0.2, "restitution": 0.7, "gravity": 8.0}
PUSH = np.array([-4.8, -4.8, -3.0, 0.0])  # three thresholds, outward for theta > 0
LONG_SAMPLE = 0.04  # p dt = 0.08
DOWNWARD = -0.004  # theta' [rad/s]


def path_in_the_first_sample(equation, rotation):
    """Taylor series of phi over the first sample as if the ground were not there, and its length in tau."""
    block = Block.from_parameters(**PUSHED)
    ground = [precise.real(float(a)) / 8 for a in PUSH]
    step = precise.real(block.p) * precise.real(LONG_SAMPLE)
    scene = precise.Scene(equation == "linear", precise.real(0.2), precise.real(0.7), ground, step)
    speed = precise.real(DOWNWARD) / precise.real(block.p)
    return precise.series(scene, precise.real(rotation), speed, ground[0], precise.ZERO, step), step


@cache
def grazing_rotation(equation):
    """The rotation from which the path just touches the ground, to 20 digits, by bisection."""
    low, high = precise.ZERO, precise.real(1e-3)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if crossings(equation, middle) else (low, middle)
    return high


def crossings(equation, rotation):
    c, length = path_in_the_first_sample(equation, rotation)
    return len(precise.sign_changes(c, length))


@pytest.mark.sweep
@pytest.mark.parametrize("share", [0.5, 0.999])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_path_that_dips_through_the_ground_between_two_samples_has_an_impact(equation, share):
    """At both samples the path is above the ground: only the inside of the sample knows of the impact."""
    block = Block.from_parameters(**PUSHED)
    rotation = float(share * grazing_rotation(equation))
    c, length = path_in_the_first_sample(equation, rotation)
    assert len(precise.sign_changes(c, length)) == 2
    assert precise.value(c, length) > 0
    response = assert_right(block, PUSH, LONG_SAMPLE, equation, initial_rotation=rotation, initial_velocity=DOWNWARD)
    missed = precise.respond(
        2.0, 0.2, 1.0, PUSH, LONG_SAMPLE, equation, gravity=8.0, initial_rotation=rotation, initial_velocity=DOWNWARD
    )
    assert abs(response.peak_rotation_ratio - float(missed.peak)) > 1e-7  # the loss at the impact is in the answer


@pytest.mark.parametrize("margin", [1e-6, 1e-13])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["above", "below"])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_grazing_impact(equation, side, margin):
    """A path that misses or meets the ground by a share `margin` of its rotation; the impact speed goes as its root."""
    block = Block.from_parameters(**PUSHED)
    rotation = float(grazing_rotation(equation) * (1.0 + side * margin))
    assert crossings(equation, rotation) == (0 if side > 0.0 else 2)
    state = {"initial_rotation": rotation, "initial_velocity": DOWNWARD}
    response = answer(block, PUSH, LONG_SAMPLE, equation=equation, **state)
    slow = exact(block, PUSH, LONG_SAMPLE, equation, **state)
    assert Outcome(response.outcome).name == slow.outcome
    assert abs(float(response.peak_rotation_ratio - slow.peak)) <= ACCURACY[equation]
