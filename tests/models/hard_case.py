"""What the hard cases share: the precise solution, how far the kernels may be from it, and how long they may take.

The independent solution is ``benchmarks/precise_rocking.py``. A peak of the kernels may be off by `ACCURACY` and by as
much as the precise one moves when C or the record is changed by a share of 1e-13.
"""

import math
import time
from functools import cache

import numpy as np
import precise_rocking as precise
import pytest
from recorded_cases import EQUATIONS

from rocking import Block, Outcome, Reason, recorded_response

#: Of theta_max/alpha_c. The linear map knows rounding only; the series of the nonlinear equation end at a step of 0.08.
ACCURACY = {"linear": 1e-12, "nonlinear": 1e-10}
FALL = 1e-8  # of a time of overturning [s]
NUDGE = precise.ONE / 10**13

#: Processor time of any single call below: well under a second once compiled; more is a loop that does not end [s].
LONGEST = 20.0


@cache
def compiled():
    """Compile the kernels, so that no time of a case has it in."""
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution=0.5)
    for equation in EQUATIONS:
        recorded_response(block, [0.0, 4.0, 0.0], 0.01, equation=equation)


def answer(*arguments, **options):
    """`recorded_response`, in bounded time and never NaN without a reason."""
    compiled()
    start = time.process_time()
    response = recorded_response(*arguments, **options)
    assert time.process_time() - start < LONGEST
    assert np.isnan(response.peak_rotation_ratio) == (response.outcome == Outcome.UNRESOLVED)
    assert (response.reason != Reason.NONE) == (response.outcome == Outcome.UNRESOLVED)
    return response


def exact(block, acceleration, dt, equation, **options):
    """The answer of `precise_rocking` for a block."""
    return precise.respond(
        block.p, block.alpha_c, block.restitution, acceleration, dt, equation, gravity=block.gravity, **options
    )


def assert_right(block, acceleration, dt, equation, **state):
    """The kernel gives the precise outcome, impacts and peak; returns the kernel's answer."""
    fast = answer(block, acceleration, dt, equation=equation, **state)
    slow = exact(block, acceleration, dt, equation, **state)
    assert Outcome(fast.outcome).name == slow.outcome
    assert fast.impacts == slow.impacts
    if math.isinf(slow.peak):
        assert fast.peak_rotation_ratio == math.inf
        assert fast.overturning_time == pytest.approx(slow.overturning_time, abs=FALL) or equation == "linear"
    elif (apart := abs(float(fast.peak_rotation_ratio - slow.peak))) > ACCURACY[equation]:
        nudges = {"restitution_factor": precise.ONE - NUDGE}, {"record_factor": precise.ONE + NUDGE}
        nudged = [exact(block, acceleration, dt, equation, **nudge, **state) for nudge in nudges]
        assert {other.outcome for other in nudged} == {slow.outcome}, "no case to judge by: the outcome flips"
        assert apart <= ACCURACY[equation] + max(abs(float(other.peak - slow.peak)) for other in nudged)
    return fast


def sines(amplitude, frequency, cycles, dt, rest=0.5):
    """(n,) Whole sine cycles, then rest [s]."""
    t = dt * np.arange(round(cycles / frequency / dt) + 1)
    return np.concatenate((amplitude * np.sin(2.0 * np.pi * frequency * t), np.zeros(round(rest / dt))))
