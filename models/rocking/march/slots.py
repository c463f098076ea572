"""A sampled record with its extremes, and slots: arrays for the lanes that a kernel computes at the same time.

A lane is one body under one scale factor, and body j is the body of the lane in slot j. Its value in row R is ``f[R +
j]`` of a flat array, so that the compiler knows that rows do not overlap: it turns loops over slots into vector code.

.. note:: phi = s theta >= 0 is the rotation away from the ground, s = sgn theta, tau = p t; angles in rad, speeds in
   rad per unit of tau, accelerations divided by gravity.
"""

from typing import NamedTuple

import numpy as np

from rocking.kernel_cache import njit
from rocking.march.polynomial import ORDER

#: Number of samples in a group (BLOCK), a power of two.
BLOCK_BITS = 5
BLOCK = 1 << BLOCK_BITS
# Rows of the extremes.
LARGEST = 0  #: largest abs(a_g) among the samples of the group and the first sample of the next group [m/s2]
STEEPEST = 1  #: largest change of a_g from a sample of the group to the next sample [m/s2]
FALL = 2  #: smallest a_v among the same samples as LARGEST [m/s2]
LEFT = 3  #: largest abs(a_g) from the first sample of the group to the end of the record [m/s2]


class Accelerogram(NamedTuple):
    """A sampled ground motion, linear between its samples, and its extremes."""

    acceleration: np.ndarray  #: (n,) a_g [m/s2]
    vertical: np.ndarray  #: (n,) a_v [m/s2], positive up; (0,) without vertical acceleration
    extremes: np.ndarray  #: (4, b + 1), see :func:`extremes`
    dt: float  #: sampling interval [s]


@njit()
def extremes(acceleration, vertical):
    """Return the rows LARGEST to LEFT for each of b groups of samples, and a last column of zeros: (4, b + 1)."""
    n = acceleration.size
    blocks = (n + BLOCK - 1) // BLOCK
    found = np.zeros((4, blocks + 1))
    for b in range(blocks - 1, -1, -1):
        for k in range(b * BLOCK, min((b + 1) * BLOCK, n)):
            found[LEFT, b] = max(found[LEFT, b], abs(acceleration[k]))
        found[LARGEST, b] = found[LEFT, b]
        found[LEFT, b] = max(found[LEFT, b], found[LEFT, b + 1])
        for k in range(b * BLOCK, min((b + 1) * BLOCK, n - 1)):
            found[LARGEST, b] = max(found[LARGEST, b], abs(acceleration[k + 1]))
            found[STEEPEST, b] = max(found[STEEPEST, b], abs(acceleration[k + 1] - acceleration[k]))
        if vertical.size > 0:
            found[FALL, b] = np.inf
            for k in range(b * BLOCK, min((b + 1) * BLOCK + 1, n)):
                found[FALL, b] = min(found[FALL, b], vertical[k])
    return found


@njit(_nrt=False)
def largest_left(k, record):
    """Return the largest abs(a_g) from sample k of an :class:`Accelerogram` to its end [m/s2]."""
    block = k // BLOCK + 1
    largest = record.extremes[LEFT, block] if block < record.extremes.shape[1] else 0.0
    for i in range(k, min(block * BLOCK, record.acceleration.size)):
        largest = max(largest, abs(record.acceleration[i]))
    return largest


@njit(_nrt=False)
def next_exceedance(k, record, factor, threshold):
    """Return the first sample, k or later, at which a resting body lifts or loses contact; n if no sample does.

    The body has equal corners and no restraints; :func:`next_lift`, which is slower, also treats other bodies.
    """
    n = record.acceleration.size
    up = record.vertical.size > 0
    while k < n:
        block = k // BLOCK
        lift = 1.0 + record.extremes[FALL, block] * factor
        if record.extremes[LARGEST, block] * factor <= lift * threshold and lift > 0.0:
            k = (block + 1) * BLOCK
            continue
        lift = 1.0 + record.vertical[k] * factor if up else 1.0
        if abs(record.acceleration[k]) * factor > lift * threshold or lift <= 0.0:
            return k
        k += 1
    return n


@njit(_nrt=False)
def next_lift(k, record, factor, side, threshold, extra, other, other_extra):
    """Return the first sample, k or later, at which a resting body lifts or loses contact; n if no sample does.

    It lifts about the corner of `side` at abs(a_g)/g = (1 + a_v/g) threshold + extra, about the other corner with
    `other` and `other_extra`; `factor` is divided by gravity [s2/m].
    """
    n = record.acceleration.size
    while k < n:
        block = k // BLOCK
        lift = 1.0 + record.extremes[FALL, block] * factor
        least = min(lift * threshold + extra, lift * other + other_extra)
        if record.extremes[LARGEST, block] * factor <= least and lift > 0.0:
            k = (block + 1) * BLOCK
            continue
        lift = 1.0 + record.vertical[k] * factor if record.vertical.size > 0 else 1.0
        push = -side * record.acceleration[k] * factor
        if push > lift * threshold + extra or -push > lift * other + other_extra or lift <= 0.0:
            return k
        k += 1
    return n


#: Number of slots: they fill four vector registers, so that the processor works on one while others wait.
WIDTH = 32
#: Number of slots in one register: the number of slots in use is a multiple of it.
GROUP = 8

(
    # The state at the start of the step.
    PHI,
    SPEED,
    PEAK,  # largest phi so far
    PASSED,  # tau since the last sample
    STEP,  # length of the step
    SIDE,  # s
    # The ground acceleration during the step; the horizontal one is multiplied by s.
    GROUND,  # s a_g/g at the start of the step
    SLOPE,  # slope of s a_g/g
    LIFT,  # 1 + a_v/g at the start of the step
    LIFT_SLOPE,
    LIMIT,  # lower bound of the largest abs(a_g)/g after the sample
    # The same from the last sample to the next one, without the factor s.
    SAMPLE_GROUND,
    SAMPLE_SLOPE,
    SAMPLE_LIFT,
    SAMPLE_LIFT_SLOPE,
    # The results of the step.
    END,  # phi, phi' and phi'' at the end of the step
    END_SPEED,
    END_PULL,
    STRONGEST,  # upper bound of abs(phi'') in the step
    MARKED,  # 1.0 if the step must be examined in any case
    EVENT,  # see steps.py
    ARRIVAL,  # abs(phi') at the impact
    RATE_2,  # (k - 1)-th Taylor coefficients of the speed, k = 2 ... 10
    RATE_3,
    RATE_4,
    RATE_5,
    RATE_6,
    RATE_7,
    RATE_8,
    RATE_9,
    RATE_10,
    # The lane.
    ALPHA,
    RESTITUTION,
    P,
    FACTOR,  # scale factor on the record over gravity
    LENGTH,  # p dt
    PER_SAMPLE,  # 1/(p dt)
    LONGEST,  # longest step
    THRESHOLD,  # abs(a_g)/g above which a resting block lifts, at 1 + a_v/g = 1
    TRUNCATION,  # largest last term allowed in a series
    TOP,  # phi at which the nonlinear block has overturned
    CALM_FROM,  # first sample from which each impact may show that the body will not overturn; inf: never
    # Positions and counts: whole numbers, in one array because a loop over one array vectorises.
    SAMPLE,
    HITS,  # impacts in this sample
    IMPACTS,  # impacts faster than the cut-off
    ACTIVE,  # samples in which the body moved
    ENTERED,  # 1 if the step ended a sample
    ATTENTION,  # 1 if a decision is needed: an impact that may be the last, the end of the record, overturning
) = range(0, 48 * WIDTH, WIDTH)
FLOAT_ROWS = 48

(
    LANE,  # index of the lane; -1: empty slot
    MOVED,  # 1 once the body has lifted
    ENDED,  # the sample in which the block last came to rest
    FLIES,  # 1 if the vertical acceleration cancels gravity
    SLOW,  # impacts slower than the cut-off since the last rest
) = range(0, 5 * WIDTH, WIDTH)
INT_ROWS = 5


class Slots(NamedTuple):
    """The arrays of all slots, and the Taylor polynomial of the step that is being examined."""

    f: np.ndarray  #: (FLOAT_ROWS * WIDTH,)
    i: np.ndarray  #: (INT_ROWS * WIDTH,) of int
    c: np.ndarray  #: (ORDER + 1,) Taylor coefficients, see :mod:`rocking.march.polynomial`


def empty_slots(rows: int = FLOAT_ROWS, *positive: int) -> Slots:
    """Return empty slots; the rows ALPHA and `positive` are 0.1, which avoids divisions by zero in empty slots."""
    slots = Slots(np.zeros(rows * WIDTH), np.zeros(INT_ROWS * WIDTH, dtype=np.int64), np.zeros(ORDER + 1))
    slots.i[LANE : LANE + WIDTH] = -1
    for name in (ALPHA, *positive):
        slots.f[name : name + WIDTH] = 0.1
    return slots


@njit(_nrt=False)
def compact_slots(f, i, width):
    """Move the lanes of the last GROUP slots to empty slots before them; return the new number of slots in use."""
    empty = 0
    for j in range(width - GROUP, width):
        if i[LANE + j] < 0:
            continue
        while i[LANE + empty] >= 0:
            empty += 1
        for k in range(f.size // WIDTH):
            f[k * WIDTH + empty] = f[k * WIDTH + j]
        for k in range(INT_ROWS):
            i[k * WIDTH + empty] = i[k * WIDTH + j]
        i[LANE + j] = -1
    return width - GROUP
