"""Hard cases of the rocking models, by name: each right by closed form or by 42 digits, or UNRESOLVED with its reason.

The ground at the threshold and crossings inside a sample are in ``test_hard_crossings.py``; ``hard_case.py`` says how
near is right.
"""

import math

import numpy as np
import pytest
from hard_case import ACCURACY, answer, assert_right, exact, sines
from recorded_cases import EQUATIONS, G, block_of, shaking

from rocking import (
    Block,
    ImpulseSequence,
    Outcome,
    Reason,
    impulsive_response,
    recorded_response,
    resonance,
    sequence_response,
)
from rocking.impulses.half_cycle import CRITICAL_TOLERANCE
from rocking.impulses.main_sequence import critical_impulse
from rocking.march.event import SLOW_IMPACTS

ROUNDING = 1e-12
NEAR = 1e-12  # how near to critical


@pytest.fixture
def wall():
    """Block A of the validation cases with C = 0.9."""
    return Block(half_width=0.5, half_height=math.sqrt(3.75), restitution=0.9, gravity=G)


def test_resonance_within_1e_12_of_the_limit_that_never_overturns(wall):
    """u_1 = 1 - C is the limit; above it u_i = (1 + 1e-12)(1 - C^i) passes 1 late, and 1 is known to a tolerance."""
    limit = (1.0 - wall.restitution) * wall.critical_impulse
    below = resonance(wall, limit * (1.0 - NEAR), 100_000)
    above = resonance(wall, limit * (1.0 + NEAR), 100_000)
    assert below.outcome == Outcome.ROCKS
    assert above.outcome == Outcome.OVERTURNS
    first = math.ceil(math.log(NEAR + CRITICAL_TOLERANCE) / math.log(wall.restitution))
    last = math.ceil(math.log(NEAR) / math.log(wall.restitution))
    assert first <= above.overturning_half_cycle <= last == 263


@pytest.mark.parametrize("sigma", [0.0, 0.3, 0.6])
def test_sequence_within_1e_12_of_the_limit_that_never_overturns(wall, sigma):
    """F4: stabilises iff v* = u* - sigma u_1/2 <= 1, u* = u_1 (1 - C sigma)/(1 - C)."""
    limit = wall.critical_impulse / ((1.0 - 0.9 * sigma) / (1.0 - 0.9) - 0.5 * sigma)
    for share, outcome in ((1.0 - NEAR, Outcome.ROCKS), (1.0 + NEAR, Outcome.OVERTURNS)):
        main = limit * share
        sequence = ImpulseSequence(main, sigma * main, math.nan, math.inf, spacing="continuous")
        assert sequence_response(wall, sequence).outcome == outcome


def test_double_impulse_within_1e_12_of_critical(wall):
    """I_2c = I_1c/(1 + C), the second impulse right after the first impact (V3)."""
    critical = critical_impulse(wall, 2)
    returns = 2.0 * math.atanh(critical / wall.critical_impulse) / wall.p
    for share, outcome in ((1.0 - NEAR, Outcome.ROCKS), (1.0 + NEAR, Outcome.OVERTURNS)):
        assert impulsive_response(wall, [0.0, returns], np.array([1, -1]) * critical * share).outcome == outcome


@pytest.mark.parametrize("pt", [0.5, 3.0])
def test_rectangular_pulse_within_1e_12_of_critical(wall, pt):
    """F6, V13: A/(g alpha) = 1/(1 - exp(-p t_1)); a constant record ends with the jump of the pulse."""
    samples = 10
    critical = G * wall.alpha_c / -math.expm1(-pt)
    for share, outcome in ((1.0 - NEAR, "ROCKS"), (1.0 + NEAR, "OVERTURNS")):
        pulse = np.full(samples + 1, critical * share)
        assert exact(wall, pulse, pt / wall.p / samples, "linear").outcome == outcome
        assert Outcome(answer(wall, pulse, pt / wall.p / samples, equation="linear").outcome).name == outcome


@pytest.mark.parametrize(
    ("equation", "critical"), [("linear", 1.0), pytest.param("nonlinear", math.nan, marks=pytest.mark.sweep)]
)
def test_initial_velocity_within_1e_12_of_critical(wall, equation, critical):
    """theta' = p alpha takes the linear block to its top, 2 p sin(alpha/2) the nonlinear one."""
    if equation == "nonlinear":
        critical = 2.0 * math.sin(0.5 * wall.alpha_c) / wall.alpha_c
    for share, outcome in ((1.0 - NEAR, "ROCKS"), (1.0 + NEAR, "OVERTURNS")):
        velocity = critical * wall.p * wall.alpha_c * share
        quiet = np.zeros(3)
        assert exact(wall, quiet, 0.01, equation, initial_velocity=velocity).outcome == outcome
        fast = answer(wall, quiet, 0.01, equation=equation, initial_velocity=velocity)
        assert Outcome(fast.outcome).name == outcome


@pytest.mark.parametrize("equation", EQUATIONS)
def test_without_loss_the_peak_stays_over_a_hundred_half_cycles(equation):
    block = block_of(2.0, 5.0, 1.0)
    start = 0.4
    response = answer(block, np.zeros(12_000), 0.01, equation=equation, initial_rotation=start * block.alpha_c)
    assert response.outcome == Outcome.ROCKS
    assert response.impacts == -1
    assert response.peak_rotation_ratio == pytest.approx(start, abs=ACCURACY[equation])


@pytest.mark.parametrize("equation", EQUATIONS)
def test_hops_that_never_end_are_unresolved_and_say_so(equation):
    """C = 1 and hops of 1e-9 s: millions in one sample."""
    block = block_of(2.0, 5.0, 1.0)
    response = answer(block, np.zeros(50), 0.01, equation=equation, initial_velocity=1e-9 * block.p * block.alpha_c)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.IMPACT_LIMIT)


@pytest.mark.sweep
@pytest.mark.parametrize("equation", EQUATIONS)
def test_slow_hops_of_a_lane_are_bounded_however_long_the_record(equation):
    """C = 1, hops of 2e-5/p: 1000 in every sample, which no bound for one sample sees, and 1e8 in this record."""
    speed = 1e-5  # over p alpha
    block, lossy = block_of(2.0, 5.0, 1.0), block_of(2.0, 5.0, 0.999)
    silence, dt = np.zeros(100_000), 0.01
    start = speed * block.p * block.alpha_c
    response = recorded_response(block, silence, dt, equation, initial_velocity=start)
    per_sample = block.p * dt / (2.0 * speed)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.IMPACT_LIMIT)
    assert response.active_samples == pytest.approx(SLOW_IMPACTS / per_sample, rel=0.02)
    short = silence[: int(0.25 * SLOW_IMPACTS / per_sample)]
    followed = recorded_response(block, short, dt, equation, initial_velocity=start)
    assert (followed.outcome, followed.impacts) == (Outcome.ROCKS, 0)
    resting = recorded_response(lossy, silence, dt, equation, initial_velocity=start)
    assert (resting.outcome, resting.active_samples) == (Outcome.ROCKS, 1)


@pytest.mark.sweep
@pytest.mark.parametrize("equation", EQUATIONS)
def test_slow_hops_in_a_weak_motion_are_bounded_too(equation):
    """One sample 1 % above uplift in 500 s of half of it: hops too slow to be counted go on through all the rest."""
    block, lossy = block_of(2.0, 5.0, 1.0), block_of(2.0, 5.0, 0.999)
    dt = 0.01
    uplift = block.gravity * (block.alpha_c if equation == "linear" else math.tan(block.alpha_c))
    weak = 0.5 * uplift * np.sin(2.0 * math.pi * 1.3 * dt * np.arange(50_000))
    weak[100] = 1.01 * uplift
    response = recorded_response(block, weak, dt, equation)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.IMPACT_LIMIT)
    assert response.active_samples < 0.2 * weak.size
    resting = recorded_response(lossy, weak, dt, equation)
    assert (resting.outcome, resting.impacts) == (Outcome.ROCKS, 0)
    assert resting.active_samples < 20


@pytest.mark.parametrize(("equation", "restitution"), [("linear", 0.6), ("nonlinear", 0.9)])
def test_chatter_to_rest_and_uplift_again(equation, restitution):
    """The second pulse finds the block at rest, so that its motion does not depend on the first one."""
    block = block_of(1.0, 5.0, restitution)
    first, second = sines(2.5, 2.0, 0.5, 0.01, rest=3.0), sines(-3.2, 1.5, 0.5, 0.01, rest=0.1)
    alone = assert_right(block, second, 0.01, equation)
    both = answer(block, np.concatenate((first, second)), 0.01, equation=equation)
    assert both.peak_rotation_ratio == alone.peak_rotation_ratio
    assert both.impacts > alone.impacts


DULL, SMALL = block_of(2.0, 5.0, 0.7), Block(0.0125, 0.05)
SPIKE = np.eye(1, 120, 10)[0]
SHORT, LONG = sines(2.6, 1.5, 2.0, 0.02, rest=0.1), sines(2.2, 2.0, 2.0, 0.02, rest=0.1)
#: Body, ground [m/s2] and interval [s].
BOTH = {
    "a cube": (block_of(2.0, 1.0), sines(1.6 * G * math.atan(1.0), 1.5, 1.0, 0.02, rest=0.1), 0.02),
    "a needle": (block_of(2.0, 100.0), sines(1.6 * G * math.atan(0.01), 1.5, 1.0, 0.02, rest=0.1), 0.02),
    "5 cm under a motion of 50 Hz": (SMALL, sines(8.0, 50.0, 2.0, 0.001, rest=0.01), 0.001),
    "100 m": (Block(20.0, 100.0), sines(3.0, 0.5, 1.0, 0.04, rest=0.1), 0.04),
    "C = 0": (block_of(2.0, 5.0, 0.0), SHORT, 0.02),
    "C = 0.001": (block_of(2.0, 5.0, 1e-3), LONG, 0.02),
    "C = 0.9999": (block_of(2.0, 5.0, 0.9999), SHORT, 0.02),
    "C = 1": (block_of(2.0, 5.0, 1.0), LONG, 0.02),
    "spike": (DULL, 40.0 * SPIKE, 0.01),
    "spike of 50 g": (DULL, 490.0 * SPIKE, 0.01),
    "step up": (DULL, np.repeat([0.0, 3.0, 0.0], [5, 25, 60]), 0.01),
    "step from the start": (DULL, np.repeat([-3.0, 0.0], [20, 60]), 0.01),
    "steps from side to side": (DULL, np.repeat([4.0, -4.0, 2.5, 0.0], [15, 25, 20, 40]), 0.01),
    "sawtooth at Nyquist": (DULL, np.append(np.tile([9.0, -9.0], 30), np.zeros(20)), 0.01),
    "ends at its peak": (DULL, 4.0 * np.linspace(0.0, 1.0, 40), 0.01),
}
IN_ONE_SAMPLE = np.array([-0.1, 1.6, 1.2, -1.4, -0.2, 0.0]) * G / 5.0
RECORD_OF_50_HZ = shaking(3, 40, 0.02) * SMALL.gravity / 4.0  # p dt = 0.34: the sample is divided
CASES = {f"{name}, {equation}": (equation, *case, 0.0) for name, case in BOTH.items() for equation in EQUATIONS} | {
    "5 cm, linear": ("linear", SMALL, 4.0 * RECORD_OF_50_HZ, 0.02, 0.0),
    "5 cm, nonlinear": ("nonlinear", SMALL, 1.5 * RECORD_OF_50_HZ, 0.02, 0.0),
    "to rest and up again in one sample, linear": ("linear", block_of(1.0, 5.0, 0.7), IN_ONE_SAMPLE, 0.1, 2e-3),
    "to rest and up again in one sample, nonlinear": ("nonlinear", block_of(1.0, 5.0, 0.3), IN_ONE_SAMPLE, 0.1, 2e-3),
}
QUICK = ("a cube", "a needle", "5 cm under", "5 cm, linear")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name.startswith(QUICK) else pytest.mark.sweep) for name in CASES]
)
def test_motion_is_right(name):
    equation, block, ground, dt, speed = CASES[name]
    response = assert_right(block, ground, dt, equation, initial_velocity=speed * block.p * block.alpha_c)
    assert response.outcome == Outcome.ROCKS or not name.startswith("C = ")


@pytest.mark.parametrize("equation", EQUATIONS)
def test_quiet_record_of_a_million_samples(equation):
    """Below the threshold nothing moves; a burst in its midst acts as it does alone."""
    block = block_of(2.0, 5.0, 0.9)
    quiet = 0.5 * G / 5.0 * np.sin(0.37 * np.arange(1_000_000))
    assert answer(block, quiet, 0.01, equation=equation).outcome == Outcome.AT_REST
    burst = sines(2.6, 1.0, 3.0, 0.01, rest=6.0)
    alone = answer(block, burst, 0.01, equation=equation)
    assert alone.outcome == Outcome.ROCKS
    quiet[:] = 0.0
    quiet[612_345 : 612_345 + burst.size] = burst
    within = answer(block, quiet, 0.01, equation=equation)
    assert (within.outcome, within.impacts) == (alone.outcome, alone.impacts)
    assert within.peak_rotation_ratio == pytest.approx(alone.peak_rotation_ratio, rel=ROUNDING)


@pytest.mark.parametrize("spacing", ["end", "middle", "start", "open"])
def test_trial_interval_of_a_long_wait_gives_two_impulses_a_half_cycle(wall, spacing):
    main = 0.3 * wall.critical_impulse
    trial = ImpulseSequence(main, 0.3 * main, 1500.0 / wall.p, 1e5, spacing=spacing)
    given = ImpulseSequence(main, 0.3 * main, math.nan, 1e5, spacing=spacing, intermediate_count=2)
    response, two = sequence_response(wall, trial), sequence_response(wall, given)
    assert (response.outcome, response.overturning_half_cycle) == (two.outcome, two.overturning_half_cycle)
    assert response.peak_rotation_ratio == two.peak_rotation_ratio


@pytest.mark.parametrize("equation", EQUATIONS)
def test_record_of_p_t_1000_with_the_motion_at_both_ends(equation):
    """From near the top, to rest, and up again after 1000/p: the later pulse acts as it does alone."""
    block = block_of(0.5, 5.0, 0.8)
    count = round(1000.0 / block.p / 0.02)
    burst = sines(2.6, 3.0, 1.0, 0.02)
    ground = np.concatenate((np.zeros(count), burst))
    start = {"initial_rotation": (1.0 - 1e-9) * block.alpha_c}
    response = answer(block, ground, 0.02, equation=equation, **start)
    assert response.outcome == Outcome.ROCKS
    assert response.peak_rotation_ratio == pytest.approx(1.0 - 1e-9, abs=ROUNDING)
    later = answer(block, np.concatenate((np.zeros(count), burst)), 0.02, equation=equation)
    alone = answer(block, burst, 0.02, equation=equation)
    assert later.peak_rotation_ratio == pytest.approx(alone.peak_rotation_ratio, rel=ROUNDING)
    over = {"initial_rotation": (1.0 + 1e-9) * block.alpha_c}
    assert answer(block, ground[:count], 0.02, equation=equation, **over).outcome == Outcome.OVERTURNS
