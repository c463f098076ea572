"""The solver of the stored reference: closed forms to 30 digits, and independence of its own steps and numbers."""

import math

import mpmath
import numpy as np
import pytest
from body_reference import reference
from recorded_cases import EQUATIONS, G, block_of, synthetic

#: The nonlinear equation takes four times as long.
LINEAR_FIRST = pytest.mark.parametrize("equation", ["linear", pytest.param("nonlinear", marks=pytest.mark.slow)])

CONTEXT = mpmath.MPContext()
CONTEXT.dps = 45


def digits(number):
    """A number of either library as one of mpmath's with 45 digits."""
    return (
        CONTEXT.mpf(number)
        if isinstance(number, float)
        else CONTEXT.mpf(f"{number:.42e}" if "mpfr" in repr(number) else number)
    )


def peak_from_velocity(equation, alpha, ratio):
    """Peak over alpha of the free motion that starts with theta' = ratio p alpha: energy, Eq. (6) and its like."""
    alpha, ratio = CONTEXT.mpf(alpha), CONTEXT.mpf(ratio)
    if equation == "linear":
        return 1 - CONTEXT.sqrt(1 - ratio**2)
    return 1 - 2 * CONTEXT.asin(CONTEXT.sqrt(CONTEXT.sin(alpha / 2) ** 2 - (ratio * alpha) ** 2 / 4)) / alpha


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.25, 0.75, 0.96875])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_free_motion_has_its_closed_form_peak_to_30_digits(precise, equation, ratio):
    """Dyadic numbers, so that theta' = ratio p alpha is exact in a float; the record lasts beyond the peak."""
    p, alpha = 2.0, 0.1875
    answer = precise.respond(p, alpha, 0.5, np.zeros(160), 0.03125, equation, initial_velocity=ratio * p * alpha)
    assert answer.outcome == "ROCKS"
    expected = peak_from_velocity(equation, alpha, ratio)
    assert abs(digits(answer.peak) - expected) < 1e-30 * expected


@pytest.mark.parametrize(("pt", "threshold"), [(0.5, 2.5414941), (1.0, 1.5819767), (2.0, 1.1565176), (3.0, 1.0523957)])
def test_rectangular_pulse_of_validation_v13(precise, pt, threshold):
    """F6: a constant record of p t_1 ends with the jump."""
    alpha, count = 0.25, 32
    for share, outcome in ((1.0 - 5e-8, "ROCKS"), (1.0 + 5e-8, "OVERTURNS")):
        pulse = np.full(count + 1, threshold * alpha * G * share)
        assert precise.respond(2.0, alpha, 0.9, pulse, pt / 2.0 / count, "linear", gravity=G).outcome == outcome


@pytest.mark.slow
def test_free_decay_of_validation_v12_ends_in_the_record_as_after_it(precise):
    """C = .90625 from x = .5: 68 impacts faster than the cut-off, followed hop by hop or by the closed form."""
    alpha, p = 0.25, 2.0
    start = {"initial_rotation": 0.5 * alpha}
    followed = precise.respond(p, alpha, 0.90625, np.zeros(600), 0.02, "linear", **start)
    closed = precise.respond(p, alpha, 0.90625, np.zeros(2), 0.02, "linear", **start)
    first = math.sqrt(1.0 - 0.5**2)
    assert followed.impacts == closed.impacts == 1 + math.floor(math.log(1e-3 / first) / math.log(0.90625))
    assert float(followed.peak) == float(closed.peak) == 0.5


@pytest.fixture(scope="module")
def scene():
    """A motion of 1.4 s that rocks a small block through some impacts."""
    block = block_of(0.5, 5.0, 0.85)
    return block, synthetic(seed=7, n=70, dt=0.02, peak=3.6), 0.02


def respond(module, scene, equation):
    block, ground, dt = scene
    return module.respond(block.p, block.alpha_c, block.restitution, ground, dt, equation, gravity=block.gravity)


@pytest.mark.slow
@pytest.mark.parametrize("equation", EQUATIONS)
def test_answer_does_not_depend_on_the_step(precise, scene, equation, monkeypatch):
    """A fifth of the step moves nothing before digit 33; the whole-sample map gives way to the series."""
    coarse = respond(precise, scene, equation)
    monkeypatch.setattr(precise, "LONGEST_STEP", 0.016)
    fine = respond(precise, scene, equation)
    assert (coarse.outcome, coarse.impacts) == (fine.outcome, fine.impacts) == ("ROCKS", coarse.impacts)
    assert coarse.impacts > 8
    assert abs(digits(coarse.peak) - digits(fine.peak)) < 1e-33


@LINEAR_FIRST
def test_answer_does_not_depend_on_the_library_of_numbers(precise, precise_with_mpmath, scene, equation):
    assert precise_with_mpmath.NUMBERS == "mpmath"
    one, other = respond(precise, scene, equation), respond(precise_with_mpmath, scene, equation)
    assert (one.outcome, one.impacts) == (other.outcome, other.impacts)
    assert abs(digits(one.peak) - digits(other.peak)) < 1e-33


@pytest.mark.slow
@LINEAR_FIRST
def test_answer_agrees_with_the_solver_of_double_precision(precise, scene, equation):
    block, ground, dt = scene
    slow = reference(block, ground, dt, equation=equation)
    answer = respond(precise, scene, equation)
    assert answer.outcome == slow.outcome.name
    assert float(answer.peak) == pytest.approx(slow.peak_rotation_ratio, abs=1e-11)


@LINEAR_FIRST
def test_perturbation_in_the_numbers_is_one_of_the_arguments(precise, scene, equation):
    """A factor of 1 + 2^-20 on the record, exact in a float, is the same as that scale."""
    block, ground, dt = scene
    given = (block.p, block.alpha_c, block.restitution, ground, dt, equation)
    factor = 1.0 + 2.0**-20
    assert (
        precise.respond(*given, scale=factor).peak == precise.respond(*given, record_factor=precise.real(factor)).peak
    )


def test_hops_without_loss_are_given_up_at_the_bound(precise, monkeypatch):
    monkeypatch.setattr(precise, "HOP_BOUND", 50)
    answer = precise.respond(2.0, 0.2, 1.0, np.zeros(40), 0.01, "linear", initial_velocity=1e-6)
    assert answer.outcome == "UNRESOLVED"
    assert math.isnan(float(answer.peak))


@pytest.mark.slow
def test_overturning_time_after_the_record_is_the_time_of_the_fall(precise):
    """The fall is followed on the ground at rest as it is in a record of zeros."""
    state = {"initial_rotation": 0.3, "initial_velocity": 0.1}
    short = precise.respond(2.0, 0.25, 0.9, np.zeros(3), 0.01, "nonlinear", **state)
    long = precise.respond(2.0, 0.25, 0.9, np.zeros(400), 0.01, "nonlinear", **state)
    assert short.outcome == long.outcome == "OVERTURNS"
    assert short.overturning_time == pytest.approx(long.overturning_time, rel=1e-15)
