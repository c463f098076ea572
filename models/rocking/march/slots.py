"""A sampled record with its extremes, and the memory of the lanes that a march follows at one time.

A step of every slot is one loop over contiguous rows without a branch, which the compiler turns into vector
instructions. Row R of slot j is ``f[R + j]`` of a flat array, so that the compiler sees that rows do not overlap.

.. note:: phi = s theta >= 0 is the rotation away from the ground, s = sgn theta, tau = p t; angles in rad, speeds in
   rad per unit of tau, accelerations over gravity.
"""

from typing import NamedTuple

import numpy as np

from rocking.kernel_cache import njit
from rocking.march.polynomial import ORDER

#: Samples in a block, a power of two.
BLOCK_BITS = 5
BLOCK = 1 << BLOCK_BITS
# Rows of the extremes.
LARGEST = 0  #: largest abs(a_g) among the samples of the block and the first of the next one [m/s2]
STEEPEST = 1  #: largest step of a_g from one of its samples to the next [m/s2]
FALL = 2  #: smallest a_v among the same samples as LARGEST [m/s2]
LEFT = 3  #: largest abs(a_g) from its first sample to the end of the record [m/s2]


class Accelerogram(NamedTuple):
    """A sampled ground motion, linear between its samples, and its extremes."""

    acceleration: np.ndarray  #: (n,) a_g [m/s2]
    vertical: np.ndarray  #: (n,) a_v [m/s2], positive up; (0,) where there is none
    extremes: np.ndarray  #: (4, b + 1), see :func:`extremes`
    dt: float  #: sampling interval [s]


@njit()
def extremes(acceleration, vertical):
    """Rows LARGEST, STEEPEST, FALL and LEFT of the b blocks of samples, then a column of zeros for the time after."""
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
    """Largest abs(a_g) from sample k of an :class:`Accelerogram` to its end [m/s2]."""
    block = k // BLOCK + 1
    largest = record.extremes[LEFT, block] if block < record.extremes.shape[1] else 0.0
    for i in range(k, min(block * BLOCK, record.acceleration.size)):
        largest = max(largest, abs(record.acceleration[i]))
    return largest


@njit(_nrt=False)
def next_exceedance(k, record, factor, threshold):
    """First sample from k on at which a resting block may lift (abs(a_g)/g > threshold) or lose the ground, or n.

    The search of :func:`next_lift` for two like corners, at two thirds of its time.
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
    """First sample from k on at which a resting block may lift about either corner or lose the ground, or n.

    The corner of `side` lifts at abs(a_g)/g = (1 + a_v/g) threshold + extra; `factor` is that over gravity [s2/m].
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


#: Slots: four registers of the widest vector unit, so that the latency of one is hidden behind the others.
WIDTH = 32
#: Slots of one register: fewer lanes than WIDTH take whole groups.
GROUP = 8

(
    # The state at the start of the step.
    PHI,
    SPEED,
    PEAK,  # largest phi so far
    PASSED,  # tau since the sample began
    STEP,  # length of the step
    SIDE,  # s
    # The ground during the step, as the side in contact feels it.
    GROUND,  # s a_g/g at its start
    SLOPE,  # its slope
    LIFT,  # 1 + a_v/g at its start
    LIFT_SLOPE,
    LIMIT,  # a bound from below of the largest abs(a_g)/g that is left after the sample
    # The ground during the sample, unsigned side.
    SAMPLE_GROUND,
    SAMPLE_SLOPE,
    SAMPLE_LIFT,
    SAMPLE_LIFT_SLOPE,
    # What the step found.
    END,  # phi, phi' and phi'' at its end
    END_SPEED,
    END_PULL,
    STRONGEST,  # a bound of abs(phi'') in it
    MARKED,  # 1.0 where it must be looked at closely whatever happens
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
    FACTOR,  # factor on the record over gravity
    LENGTH,  # p dt
    PER_SAMPLE,  # 1/(p dt)
    LONGEST,  # longest step
    THRESHOLD,  # abs(a_g)/g above which a resting block lifts, at 1 + a_v/g = 1
    TRUNCATION,  # largest last term of a series
    TOP,  # phi at which the nonlinear block has overturned
    CALM_FROM,  # sample from which on impacts check whether the verdict is settled; inf: never
    # Where it is, and what it has counted: whole numbers, kept here since a loop over one array makes vectors.
    SAMPLE,
    HITS,  # impacts in this sample
    IMPACTS,  # impacts faster than the cut-off
    ACTIVE,  # samples in which it moved
    ENTERED,  # 1 where the step ended a sample
    ATTENTION,  # 1 where a decision is due: an impact that may be the last, the end of the record, overturning
) = range(0, 48 * WIDTH, WIDTH)
FLOAT_ROWS = 48

(
    LANE,  # -1: empty
    MOVED,  # 1 once it has lifted
    ENDED,  # the sample in which it last came to rest
    FLIES,  # 1 where the vertical acceleration cancels gravity
    SLOW,  # impacts slower than the cut-off since it last lay at rest
) = range(0, 5 * WIDTH, WIDTH)
INT_ROWS = 5


class Slots(NamedTuple):
    """The slots of one march, and the polynomial of the step that it looks at."""

    f: np.ndarray  #: (FLOAT_ROWS * WIDTH,)
    i: np.ndarray  #: (INT_ROWS * WIDTH,) of int
    c: np.ndarray  #: (ORDER + 1,) Taylor coefficients, see :mod:`rocking.march.polynomial`


def empty_slots(rows: int = FLOAT_ROWS, *positive: int) -> Slots:
    """Slots without lanes, whose steps are harmless: alpha and the other `positive` rows are 0.1."""
    slots = Slots(np.zeros(rows * WIDTH), np.zeros(INT_ROWS * WIDTH, dtype=np.int64), np.zeros(ORDER + 1))
    slots.i[LANE : LANE + WIDTH] = -1
    for name in (ALPHA, *positive):
        slots.f[name : name + WIDTH] = 0.1
    return slots


@njit(_nrt=False)
def close_ranks(f, i, width):
    """Move the lanes of the last group into empty slots before it; returns the number of slots still in use."""
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
