"""Loops over the slots (slots.py) that finish a time step of every body and begin the next one, without branches.

Steps that these loops cannot finish are marked LOOK_CLOSER, and bodies that need a decision ATTENTION.
"""

import math

from rocking.kernel_cache import njit
from rocking.march import slots as row
from rocking.march.slots import BLOCK_BITS
from rocking.response import IMPACT_CUTOFF

# Events in a step. The body does not advance if LOOK_CLOSER (the step must be examined by event.resolve_step), HALVED
# (the step is repeated with half its length) or OVER (the body has overturned).
NOTHING, IMPACT, LOOK_CLOSER, HALVED, OVER = 0.0, 1.0, 2.0, 3.0, 4.0
#: An impact time is accepted if the last correction is below this share of it: corrections converge with third order.
CONVERGED = 3e-6


@njit(inline="always")
def value_of(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Return phi(t) = c_0 + sum of d_k t^k/k, k = 1 ... 10."""
    s = t * t
    low = d1 + t * ((1 / 2) * d2) + s * ((1 / 3) * d3 + t * ((1 / 4) * d4))
    high = ((1 / 5) * d5 + t * ((1 / 6) * d6)) + s * ((1 / 7) * d7 + t * ((1 / 8) * d8))
    high += (s * s) * ((1 / 9) * d9 + t * ((1 / 10) * d10))
    return c0 + t * (low + (s * s) * high)


@njit(inline="always")
def speed_of(t, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Return phi'(t) = sum of d_k t^(k-1), k = 1 ... 10."""
    s = t * t
    low = d1 + t * d2 + s * (d3 + t * d4)
    high = (d5 + t * d6) + s * (d7 + t * d8) + (s * s) * (d9 + t * d10)
    return low + (s * s) * high


@njit(inline="always")
def store_step(f, j, end, end_speed, end_pull, strongest, marked, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Write the results of a step of body j into the rows that :func:`finish_steps` reads."""
    f[row.RATE_2 + j] = d2
    f[row.RATE_3 + j] = d3
    f[row.RATE_4 + j] = d4
    f[row.RATE_5 + j] = d5
    f[row.RATE_6 + j] = d6
    f[row.RATE_7 + j] = d7
    f[row.RATE_8 + j] = d8
    f[row.RATE_9 + j] = d9
    f[row.RATE_10 + j] = d10
    f[row.END + j] = end
    f[row.END_SPEED + j] = end_speed
    f[row.END_PULL + j] = end_pull
    f[row.STRONGEST + j] = strongest
    f[row.MARKED + j] = 1.0 if marked else 0.0


@njit(inline="always")
def correction(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Return the number to subtract from an approximate root t of phi: Newton's step with a term for the curvature."""
    inverse = 1.0 / speed_of(t, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10)
    newton = value_of(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10) * inverse
    pull = d2 + t * (2.0 * d3 + t * (3.0 * d4))
    return newton * (1.0 + 0.5 * newton * inverse * pull)


@njit(fastmath={"contract"}, _nrt=False)
def finish_steps(f, width):
    """Write the states after the steps in the first `width` slots, the EVENT of each step and the impact speed ARRIVAL.

    A curve differs from its chord by at most h^2/8 max abs(phi''). If phi'' < 0 in the whole step, it lies above its
    chord and below its tangents: there is no impact if its end is above the ground, exactly one if it is below, and the
    intersection of the tangents is an upper bound of phi. Most impacts are single impacts of this kind; the first guess
    of their time is from the first terms of the series if the step starts at phi = 0, else from a parabola.
    """
    for j in range(width):
        phi = f[row.PHI + j]
        speed = f[row.SPEED + j]
        h = f[row.STEP + j]
        end = f[row.END + j]
        end_speed = f[row.END_SPEED + j]
        end_pull = f[row.END_PULL + j]
        d2 = f[row.RATE_2 + j]
        d3 = f[row.RATE_3 + j]
        d4 = f[row.RATE_4 + j]
        d5 = f[row.RATE_5 + j]
        d6 = f[row.RATE_6 + j]
        d7 = f[row.RATE_7 + j]
        d8 = f[row.RATE_8 + j]
        d9 = f[row.RATE_9 + j]
        d10 = f[row.RATE_10 + j]
        hop = phi == 0.0
        bend = (end - phi - speed * h) / (h * h)
        middle = 0.5 * d2 if hop else speed
        product = (4 / 3) * speed * d3 if hop else 4.0 * bend * phi
        way = 2.0 * (speed if hop else phi) / (math.sqrt(max(middle * middle - product, 0.0)) - middle)
        t = min(max(way, 0.0), h)
        t -= correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        t -= correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        last = correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        t -= last
        arrival = -speed_of(t, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)

        peak = f[row.PEAK + j]
        strongest = f[row.STRONGEST + j]
        margin = 0.125 * h * h * strongest
        arched = (d2 < 0.0) & (end_pull < 0.0)
        down = end <= 0.0
        near = (min(phi, end) <= margin) & ~arched
        turns = (max(abs(speed), abs(end_speed)) < h * strongest) & (max(phi, end) + margin > peak)
        low = max(speed, 0.0) * (end - phi - end_speed * h) <= (peak - phi) * (speed - end_speed)
        found = (abs(last) <= CONVERGED * t) & (t <= h) & (arrival > 0.0) & low
        marked = f[row.MARKED + j] != 0.0
        impact = down & arched & found & ~marked
        closer = marked | near | (~down & turns) | (down & ~impact)

        f[row.ARRIVAL + j] = arrival
        f[row.EVENT + j] = LOOK_CLOSER if closer else (IMPACT if impact else NOTHING)
        f[row.PHI + j] = phi if closer else (0.0 if impact else end)
        f[row.SPEED + j] = speed if closer else (f[row.RESTITUTION + j] * arrival if impact else end_speed)
        f[row.SIDE + j] = -f[row.SIDE + j] if impact else f[row.SIDE + j]
        f[row.PASSED + j] += 0.0 if closer else (t if impact else h)
        f[row.PEAK + j] = peak if closer | impact else max(peak, end)


#: Largest number of impacts in one sample (only a restitution close to one reaches it); a lane with more is UNRESOLVED.
IMPACTS_PER_SAMPLE = 10_000
#: A remainder of a sample that is shorter than this share of the longest step is added to the step before it.
REMNANT = 1e-9


@njit(fastmath={"contract"}, _nrt=False)
def advance_steps(f, width, acceleration, left, fastest):
    """Begin the next step in the first `width` slots; set ATTENTION, also for impacts faster than `fastest` alpha."""
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


@njit(_nrt=False)
def enter_vertical(f, j, vertical):
    """Write the vertical acceleration at the sample of body j; return False if it cancels gravity."""
    k = int(f[row.SAMPLE + j])
    start = 1.0 + vertical[k] * f[row.FACTOR + j]
    end = 1.0 + vertical[k + 1] * f[row.FACTOR + j]
    f[row.SAMPLE_LIFT + j] = start
    f[row.SAMPLE_LIFT_SLOPE + j] = (end - start) * f[row.PER_SAMPLE + j]
    return start > 0.0 and end > 0.0


@njit(_nrt=False)
def advance_vertical(f, i, width, vertical):
    """Write the vertical acceleration for the next steps; set FLIES for a body that loses contact with the ground."""
    for j in range(width):
        if i[row.LANE + j] < 0 or f[row.EVENT + j] >= LOOK_CLOSER:
            continue
        if f[row.ENTERED + j] == 1.0 and f[row.SAMPLE + j] < vertical.size - 1 and not enter_vertical(f, j, vertical):
            i[row.FLIES + j] = 1
            f[row.ATTENTION + j] = 1.0
        f[row.LIFT + j] = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * f[row.PASSED + j]
        f[row.LIFT_SLOPE + j] = f[row.SAMPLE_LIFT_SLOPE + j]


@njit(_nrt=False)
def keep_history(f, i, width, history):
    """Write theta [rad] and theta' [rad/s] of bodies that have reached a sample into `history` (lanes, n, 2)."""
    for j in range(width):
        if i[row.LANE + j] >= 0 and f[row.ENTERED + j] == 1.0:
            lane, sample = i[row.LANE + j], int(f[row.SAMPLE + j])
            history[lane, sample, 0] = f[row.SIDE + j] * f[row.PHI + j]
            history[lane, sample, 1] = f[row.SIDE + j] * f[row.SPEED + j] * f[row.P + j]
