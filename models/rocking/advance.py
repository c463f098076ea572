"""From the end of a step of every slot to the start of the next one: its sample, ground and length.

.. note:: Units and signs of :mod:`rocking.slots`. Like the steps themselves one loop without a branch; what
   needs a decision is left to :mod:`rocking.recorded_event` by setting ATTENTION.
"""

from __future__ import annotations

from numba import njit

from rocking import slots as row
from rocking.finish import IMPACT, LOOK_CLOSER, OVER
from rocking.ground import BLOCK_BITS
from rocking.response import IMPACT_CUTOFF

__all__ = ["IMPACTS_PER_SAMPLE", "REMNANT", "advance_steps", "advance_vertical", "keep_history"]

#: Impacts followed inside one sample before the lane is given up (only a restitution next to one gets there).
IMPACTS_PER_SAMPLE = 10_000

#: What is left of a sample below this share of the longest step belongs to the step before it.
REMNANT = 1e-9


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False)
def advance_steps(f, width, acceleration, left, fastest):
    """Take each of the first `width` slots whose step is done to its next step.

    `left` (b + 1,) is the row LEFT of the extremes [m/s2]. Beyond the speed `fastest` over alpha_c, an impact may have
    overturned the block; inf with the nonlinear equation.
    """
    last = acceleration.size - 1
    for j in range(width):
        held = f[row.EVENT + j] >= LOOK_CLOSER
        over = (f[row.LENGTH + j] - f[row.PASSED + j] <= REMNANT * f[row.LONGEST + j]) & ~held
        f[row.ENTERED + j] = 1.0 if over else 0.0
        f[row.SAMPLE + j] += 1.0 if over else 0.0
    for j in range(width):
        k = min(int(f[row.SAMPLE + j]), last - 1)
        factor = f[row.FACTOR + j]
        f[row.SAMPLE_GROUND + j] = acceleration[k] * factor
        f[row.SAMPLE_SLOPE + j] = (acceleration[k + 1] - acceleration[k]) * (factor * f[row.PER_SAMPLE + j])
        f[row.LIMIT + j] = left[min(((k + 1) >> BLOCK_BITS) + 1, left.size - 1)] * factor
    for j in range(width):
        held = f[row.EVENT + j] >= LOOK_CLOSER
        impact = f[row.EVENT + j] == IMPACT
        over = f[row.ENTERED + j] == 1.0
        alpha = f[row.ALPHA + j]
        longest = f[row.LONGEST + j]
        side = f[row.SIDE + j]
        speed = f[row.SPEED + j]
        cutoff = IMPACT_CUTOFF * alpha

        passed = 0.0 if over else f[row.PASSED + j]
        remaining = f[row.LENGTH + j] - passed
        step = remaining if remaining <= longest * (1.0 + REMNANT) else longest
        slope = f[row.SAMPLE_SLOPE + j]
        ground = f[row.SAMPLE_GROUND + j] + slope * passed
        f[row.PASSED + j] = passed
        f[row.GROUND + j] = f[row.GROUND + j] if held else side * ground
        f[row.SLOPE + j] = f[row.SLOPE + j] if held else side * slope
        f[row.STEP + j] = f[row.STEP + j] if held else step

        hits = f[row.HITS + j] + (1.0 if impact else 0.0)
        quick = (speed < cutoff) | (speed > fastest * alpha) | (hits > IMPACTS_PER_SAMPLE)
        settle = impact & (quick | (f[row.SAMPLE + j] >= f[row.CALM_FROM + j]))
        attention = (f[row.EVENT + j] == OVER) | settle | (f[row.SAMPLE + j] >= last)
        counted = impact & (f[row.ARRIVAL + j] >= cutoff)
        f[row.HITS + j] = 0.0 if over else hits
        f[row.IMPACTS + j] += 1.0 if counted else 0.0
        f[row.ACTIVE + j] += 1.0 if over & (f[row.SAMPLE + j] < last) else 0.0
        f[row.ATTENTION + j] = 1.0 if attention else 0.0


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def enter_vertical(f, j, vertical):
    """Take the vertical acceleration of the slot's sample; False where it cancels gravity."""
    k = int(f[row.SAMPLE + j])
    start = 1.0 + vertical[k] * f[row.FACTOR + j]
    end = 1.0 + vertical[k + 1] * f[row.FACTOR + j]
    f[row.SAMPLE_LIFT + j] = start
    f[row.SAMPLE_LIFT_SLOPE + j] = (end - start) * f[row.PER_SAMPLE + j]
    return start > 0.0 and end > 0.0


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def advance_vertical(f, i, width, vertical):
    """Take the vertical acceleration along with :func:`advance_steps`; FLIES is 1 where the block loses the ground."""
    for j in range(width):
        if i[row.LANE + j] < 0 or f[row.EVENT + j] >= LOOK_CLOSER:
            continue
        if f[row.ENTERED + j] == 1.0 and f[row.SAMPLE + j] < vertical.size - 1 and not enter_vertical(f, j, vertical):
            i[row.FLIES + j] = 1
            f[row.ATTENTION + j] = 1.0
        f[row.LIFT + j] = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * f[row.PASSED + j]
        f[row.LIFT_SLOPE + j] = f[row.SAMPLE_LIFT_SLOPE + j]


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def keep_history(f, i, width, history):
    """Write theta [rad] and theta' [rad/s] of the slots that have reached a sample into (lanes, n, 2)."""
    for j in range(width):
        if i[row.LANE + j] >= 0 and f[row.ENTERED + j] == 1.0:
            lane, sample = i[row.LANE + j], int(f[row.SAMPLE + j])
            history[lane, sample, 0] = f[row.SIDE + j] * f[row.PHI + j]
            history[lane, sample, 1] = f[row.SIDE + j] * f[row.SPEED + j] * f[row.P + j]
