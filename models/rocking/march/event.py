"""Events in a time step of the response to a record: impact, new peak, overturning, rest, uplift."""

import math

from rocking.kernel_cache import njit
from rocking.march import slots as row
from rocking.march.polynomial import ORDER, ROTATION, bracketed_root, first_impact, value, velocity
from rocking.march.slots import BLOCK, LARGEST, LEFT, STEEPEST, largest_left, next_exceedance
from rocking.march.steps import HALVED, IMPACT, NOTHING, OVER, REMNANT, enter_vertical
from rocking.response import IMPACT_CUTOFF

LINEAR, NONLINEAR = 0, 1
# States of a body after a step.
MOVING, RESTING, OVERTURNED, IMPACT_LIMITED, FLYING, CALM = range(6)
#: Half-cycles between slow impacts are replaced by rest only if they are below this share of the largest phi.
CHATTER_SHARE = 1e-3
#: After this number of impacts in one sample (restitution close to one), half-cycles need only be below the largest
#: phi, and half-cycles in later samples, too, are replaced by rest, even in a history.
MANY_IMPACTS = 1000
#: Largest number of consecutive impacts slower than the cut-off; a lane with more, such as with C = 1, is UNRESOLVED.
SLOW_IMPACTS = 1_000_000
#: Smallest step to which the error control of the series may reduce a step, as a share of the longest step.
SHORTEST = 1.0 / 4096.0


@njit(_nrt=False)
def uplift_time(ground, slope, threshold, threshold_slope, remaining):
    """Return the time tau until abs(ground) exceeds the threshold (both linear); -1 if tau exceeds `remaining`."""
    if abs(ground) > threshold:
        return 0.0
    end = ground + slope * remaining
    side = 1.0 if end > 0.0 else -1.0
    start_gap = threshold - side * ground
    end_gap = threshold + threshold_slope * remaining - side * end
    if end_gap >= 0.0:
        return -1.0
    return remaining * start_gap / (start_gap - end_gap)


@njit(_nrt=False)
def chatter_ends(speed, demand, largest, slope, restitution, window, cutoff, highest):
    """Return whether all half-cycles after an impact end before the ground can lift the block again.

    Speeds (w = `speed` after the impact) and rotations are divided by the restoring acceleration of the resting block.
    abs(a_g)/threshold is `demand` at the impact; A = `largest` and m = `slope` are upper bounds of this ratio and of
    its slope in the `window` of tau, which is shortened if A exceeds (1 + demand)/2. There the restoring acceleration
    stays above d = (1 - A) - w^2/(1 - A): the first half-cycle lasts less than T = 2 w/d, each next one less than q =
    C (1 + m T/(2 (1 - A))) times the one before, all together less than T/(1 - q); no impact is faster than w q/C.
    """
    if demand >= 1.0:
        return False
    halfway = 0.5 * (1.0 + demand)
    if largest > halfway:
        largest = halfway
        window = min(window, (halfway - demand) / slope)
    margin = 1.0 - largest
    floor = margin - speed * speed / margin
    if floor <= 0.0:
        return False
    hop = 2.0 * speed / floor
    growth = 1.0 + 0.5 * slope * hop / margin
    left = 1.0 - restitution * growth
    return hop < window * left and speed * growth < cutoff and 0.5 * speed * speed / floor < highest


@njit(_nrt=False)
def hops_end(f, j, record, far, level, rise, demand, demand_end, restitution, speed, cutoff, highest):
    """Return whether body j comes to rest before the next sample or, if `far`, within the next group of samples.

    `level` is the abs(a_g)/g that lifts the body, `rise` its derivative with respect to 1 + a_v/g.
    """
    length, passed = f[row.LENGTH + j], f[row.PASSED + j]
    lift_end = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * length
    if far and f[row.SAMPLE_LIFT + j] == 1.0 and lift_end == 1.0:
        sample = int(f[row.SAMPLE + j])
        block = sample // BLOCK
        end = min((block + 2) * BLOCK, record.acceleration.size - 1)
        factor = f[row.FACTOR + j] / level
        largest = factor * max(record.extremes[LARGEST, block], record.extremes[LARGEST, block + 1])
        steepest = max(record.extremes[STEEPEST, block], record.extremes[STEEPEST, block + 1])
        slope = factor * f[row.PER_SAMPLE + j] * steepest
        if chatter_ends(speed, demand, largest, slope, restitution, (end - sample) * length - passed, cutoff, highest):
            return True
    slope = (abs(f[row.SAMPLE_SLOPE + j]) + abs(f[row.SAMPLE_LIFT_SLOPE + j]) * rise) / level
    return chatter_ends(speed, demand, max(demand, demand_end), slope, restitution, length - passed, cutoff, highest)


@njit(_nrt=False)
def chatter_is_over(f, j, record, equation, far):
    """Return whether body j comes to rest after a slow impact, before the ground can lift it again."""
    threshold, length, passed = f[row.THRESHOLD + j], f[row.LENGTH + j], f[row.PASSED + j]
    lift = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * passed
    lift_end = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * length
    weakest = min(lift, lift_end)
    demand = abs(f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * passed) / (lift * threshold)
    if demand >= 1.0:
        return False
    demand_end = abs(f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * length) / (lift_end * threshold)
    per_scale = 1.0 / (weakest * (f[row.ALPHA + j] if equation == LINEAR else math.sin(f[row.ALPHA + j])))
    share = CHATTER_SHARE if f[row.HITS + j] < MANY_IMPACTS else 1.0
    speed, highest = f[row.SPEED + j] * per_scale, share * f[row.PEAK + j] * per_scale
    cutoff = IMPACT_CUTOFF * f[row.ALPHA + j] * per_scale
    restitution, level = f[row.RESTITUTION + j], weakest * threshold
    return hops_end(f, j, record, far, level, threshold, demand, demand_end, restitution, speed, cutoff, highest)


@njit(_nrt=False)
def impacts_above_cutoff(speed, restitution):
    """Return the number of impacts of a free decay that are faster than the cut-off; -1 if they never end."""
    if not speed >= IMPACT_CUTOFF:
        return 0
    if restitution >= 1.0:
        return -1
    if restitution <= 0.0:
        return 1
    return 1 + math.floor(math.log(IMPACT_CUTOFF / speed) / math.log(restitution))


@njit(_nrt=False)
def enter_sample(f, j, record):
    """Write the ground motion at the sample of body j; return False if the vertical acceleration cancels gravity."""
    k = int(f[row.SAMPLE + j])
    acceleration, left = record.acceleration, record.extremes[LEFT]
    start = acceleration[k] * f[row.FACTOR + j]
    f[row.SAMPLE_GROUND + j] = start
    f[row.SAMPLE_SLOPE + j] = (acceleration[k + 1] * f[row.FACTOR + j] - start) * f[row.PER_SAMPLE + j]
    f[row.LIMIT + j] = left[min((k + 1) // BLOCK + 1, left.size - 1)] * f[row.FACTOR + j]
    f[row.PASSED + j] = 0.0
    f[row.HITS + j] = 0.0
    return record.vertical.size == 0 or enter_vertical(f, j, record.vertical)


@njit(_nrt=False)
def begin_step(f, j):
    """Set the ground acceleration and the length of the next step of body j."""
    passed, side, longest = f[row.PASSED + j], f[row.SIDE + j], f[row.LONGEST + j]
    f[row.GROUND + j] = side * (f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * passed)
    f[row.SLOPE + j] = side * f[row.SAMPLE_SLOPE + j]
    f[row.LIFT + j] = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * passed
    f[row.LIFT_SLOPE + j] = f[row.SAMPLE_LIFT_SLOPE + j]
    remaining = f[row.LENGTH + j] - passed
    f[row.STEP + j] = remaining if remaining <= longest * (1.0 + REMNANT) else longest


@njit(_nrt=False)
def wake(f, i, j, record):
    """Advance resting body j; return MOVING at uplift, FLYING at loss of contact, RESTING at the end of the record."""
    threshold, length = f[row.THRESHOLD + j], f[row.LENGTH + j]
    last = record.acceleration.size - 1
    for _ in range(last + 1):
        passed = f[row.PASSED + j]
        slope, lift_slope = f[row.SAMPLE_SLOPE + j], f[row.SAMPLE_LIFT_SLOPE + j]
        ground = f[row.SAMPLE_GROUND + j] + slope * passed
        lift = f[row.SAMPLE_LIFT + j] + lift_slope * passed
        wait = uplift_time(ground, slope, lift * threshold, lift_slope * threshold, length - passed)
        if 0.0 <= wait < length - passed:
            f[row.PASSED + j] = passed + wait
            f[row.SIDE + j] = -1.0 if ground + slope * wait > 0.0 else 1.0
            f[row.PHI + j] = 0.0
            f[row.SPEED + j] = 0.0
            i[row.MOVED + j] = 1
            i[row.SLOW + j] = 0
            f[row.ACTIVE + j] += 1.0 if i[row.ENDED + j] != int(f[row.SAMPLE + j]) else 0.0
            return MOVING
        sample = int(f[row.SAMPLE + j])
        ahead = next_exceedance(sample + 1, record, f[row.FACTOR + j], threshold)
        if ahead > last:
            return RESTING
        # The body lifts before sample `ahead`, or at `sample` + 1 if rounding has moved the uplift there.
        f[row.SAMPLE + j] = max(ahead - 1, sample + 1)
        if f[row.SAMPLE + j] >= last:
            return RESTING
        if not enter_sample(f, j, record):
            return FLYING
    return RESTING


@njit(_nrt=False)
def must_overturn(f, j, record):
    """Return whether body j must overturn (linear equation): its growing mode exceeds all later abs(a_g)/g."""
    growing = f[row.PHI + j] - f[row.ALPHA + j] + f[row.SPEED + j]
    if growing <= f[row.LIMIT + j]:
        return False
    left = largest_left(int(f[row.SAMPLE + j]) + 1, record) * f[row.FACTOR + j]
    ground = abs(f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * f[row.PASSED + j])
    return growing > max(left, ground)


@njit(_nrt=False)
def resolve_step(f, j, c, record, equation):
    """Complete a step of body j marked LOOK_CLOSER up to the first impact or overturning, or halve it; set EVENT."""
    phi, speed, h, alpha = f[row.PHI + j], f[row.SPEED + j], f[row.STEP + j], f[row.ALPHA + j]
    last_term = abs(f[row.RATE_10 + j]) * h**10
    too_long = equation == NONLINEAR and last_term > f[row.TRUNCATION + j] * (alpha + phi)
    if too_long and h > SHORTEST * f[row.LONGEST + j]:
        f[row.STEP + j] = 0.5 * h
        f[row.EVENT + j] = HALVED
        return
    c[0] = phi
    c[1] = speed
    for k in range(2, ORDER + 1):
        c[k] = f[row.RATE_2 + (k - 2) * row.WIDTH + j] / k
    if phi == 0.0 and speed == 0.0:
        c[2] = max(c[2], 0.0)  # zero at uplift; rounding could make it negative
    impact, largest = first_impact(c, h, f[row.PEAK + j])
    if equation == NONLINEAR and largest >= f[row.TOP + j]:
        wait = h
        if value(c, h) > f[row.TOP + j]:
            wait = bracketed_root(c, ROTATION, f[row.TOP + j], 0.0, h, -1.0)
        f[row.PASSED + j] += wait
        f[row.EVENT + j] = OVER
        return
    f[row.PEAK + j] = max(f[row.PEAK + j], largest)
    if impact < 0.0:
        f[row.PHI + j] = value(c, h)
        f[row.SPEED + j] = velocity(c, h)
        f[row.PASSED + j] += h
    else:
        f[row.ARRIVAL + j] = max(-velocity(c, impact), 0.0)
        f[row.PHI + j] = 0.0
        f[row.SPEED + j] = f[row.RESTITUTION + j] * f[row.ARRIVAL + j]
        f[row.SIDE + j] = -f[row.SIDE + j]
        f[row.PASSED + j] += impact
        f[row.EVENT + j] = IMPACT
        return
    f[row.EVENT + j] = OVER if equation == LINEAR and must_overturn(f, j, record) else NOTHING
