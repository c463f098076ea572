"""Events of a body that turns about two different corners, or about a single corner beside a wall.

.. note:: Units and signs are those of slots.py, with alpha, p and tau = p t of the corner about which the body turns;
   rows OTHER_... contain the values of the other corner, and both are exchanged at an impact. A body beside a wall
   always turns about the same corner. A restrained body lifts at abs(a_g)/g = (1 + a_v/g) THRESHOLD + EXTRA.
"""

import math

from rocking.kernel_cache import njit
from rocking.march import event
from rocking.march import slots as row
from rocking.march.equations import flight_time, top_rotation
from rocking.march.slots import FLOAT_ROWS, WIDTH, next_lift
from rocking.march.steps import IMPACTS_PER_SAMPLE
from rocking.response import IMPACT_CUTOFF

(
    OTHER_ALPHA,
    OTHER_RESTITUTION,
    OTHER_P,
    OTHER_LENGTH,
    OTHER_PER_SAMPLE,
    OTHER_LONGEST,
    OTHER_THRESHOLD,
    OTHER_PEAK,
    EXTRA,  # abs(a_g)/g that restraints add to the uplift threshold of a resting body
    OTHER_EXTRA,
    ONE_SIDED,  # 1.0 beside a wall
    # For a restrained body, see restrained.py.
    SINE_ALPHA,  # sin(alpha) of the corner about which the body turns
    COSINE_ALPHA,
    SINE,  # terms that restraints add to the factors of sin(phi) and cos(phi) in -phi''
    COSINE,
    SINE_2,  # and to the factors of sin(2 phi) and cos(2 phi)
    COSINE_2,
    STIFFEST,  # upper bound of the derivative of the moment of the restraints with respect to phi
    FLOOR,  # range of phi in which the factors are constant
    CEILING,
    SLIDES,  # 1.0 if a reversal of an outward motion changes them, -1.0 if one of an inward motion does, else 0.0
    FREE_LONGEST,  # longest step without restraints
    OTHER_FREE_LONGEST,
    STALLS,  # number of consecutive changes of the restraints without motion
) = range(FLOAT_ROWS * WIDTH, (FLOAT_ROWS + 24) * WIDTH, WIDTH)
CORNER_ROWS = FLOAT_ROWS + 24
#: Rows with one quantity of the current corner and of the other corner.
PAIRS = (
    (row.ALPHA, OTHER_ALPHA),
    (row.RESTITUTION, OTHER_RESTITUTION),
    (row.P, OTHER_P),
    (row.LENGTH, OTHER_LENGTH),
    (row.PER_SAMPLE, OTHER_PER_SAMPLE),
    (row.LONGEST, OTHER_LONGEST),
    (row.THRESHOLD, OTHER_THRESHOLD),
    (row.PEAK, OTHER_PEAK),
    (EXTRA, OTHER_EXTRA),
    (FREE_LONGEST, OTHER_FREE_LONGEST),
)


@njit(_nrt=False)
def turn_over(f, j):
    """Exchange the corners of body j after an impact; a body beside a wall keeps its corner and its side."""
    if f[ONE_SIDED + j] == 1.0:
        f[row.SIDE + j] = -f[row.SIDE + j]
        return
    for own, other in PAIRS:
        f[own + j], f[other + j] = f[other + j], f[own + j]
    faster = f[row.P + j] / f[OTHER_P + j]
    f[row.SPEED + j] /= faster
    f[row.SAMPLE_SLOPE + j] /= faster
    f[row.SAMPLE_LIFT_SLOPE + j] /= faster
    f[row.PASSED + j] *= faster
    f[row.ARRIVAL + j] *= f[row.ALPHA + j] / f[OTHER_ALPHA + j]  # divided by alpha of the old corner


@njit(_nrt=False)
def lift_time(push, slope, threshold, threshold_slope, remaining):
    """Return the time tau until `push` exceeds a threshold (both linear in tau); -1 if tau exceeds `remaining`."""
    gap = threshold - push
    if gap < 0.0:
        return 0.0
    end_gap = gap + (threshold_slope - slope) * remaining
    return remaining * gap / (gap - end_gap) if end_gap < 0.0 else -1.0


@njit(_nrt=False)
def wake_corner(f, i, j, record):
    """Advance resting body j as :func:`rocking.march.event.wake` does, to uplift about either of its two corners."""
    last = record.acceleration.size - 1
    for _ in range(last + 1):
        passed, length, side = f[row.PASSED + j], f[row.LENGTH + j], f[row.SIDE + j]
        remaining = length - passed
        slope, lift_slope = f[row.SAMPLE_SLOPE + j], f[row.SAMPLE_LIFT_SLOPE + j]
        push = -side * (f[row.SAMPLE_GROUND + j] + slope * passed)
        lift = f[row.SAMPLE_LIFT + j] + lift_slope * passed
        threshold, other = f[row.THRESHOLD + j], f[OTHER_THRESHOLD + j]
        wait = lift_time(push, -side * slope, lift * threshold + f[EXTRA + j], lift_slope * threshold, remaining)
        if f[ONE_SIDED + j] == 0.0:
            level = lift * other + f[OTHER_EXTRA + j]
            opposite = lift_time(-push, side * slope, level, lift_slope * other, remaining)
            if 0.0 <= opposite < remaining and not 0.0 <= wait <= opposite:
                f[row.SIDE + j] = -side
                turn_over(f, j)
                wait = opposite * f[row.P + j] / f[OTHER_P + j]
                remaining = f[row.LENGTH + j] - f[row.PASSED + j]
        if 0.0 <= wait < remaining:
            f[row.PASSED + j] += wait
            f[row.PHI + j] = 0.0
            f[row.SPEED + j] = 0.0
            i[row.MOVED + j] = 1
            i[row.SLOW + j] = 0
            f[row.ACTIVE + j] += 1.0 if i[row.ENDED + j] != int(f[row.SAMPLE + j]) else 0.0
            return event.MOVING
        sample = int(f[row.SAMPLE + j])
        levels = f[row.THRESHOLD + j], f[EXTRA + j], f[OTHER_THRESHOLD + j], f[OTHER_EXTRA + j]
        ahead = next_lift(sample + 1, record, f[row.FACTOR + j], f[row.SIDE + j], *levels)
        if ahead > last:
            return event.RESTING
        # The body lifts before sample `ahead`, or at `sample` + 1 if rounding has moved the uplift there.
        f[row.SAMPLE + j] = max(ahead - 1, sample + 1)
        if f[row.SAMPLE + j] >= last:
            return event.RESTING
        if not event.enter_sample(f, j, record):
            return event.FLYING
    return event.RESTING


@njit(_nrt=False)
def hops_have_ended(f, j, record, equation, far, sliding):
    """Return the result of event.chatter_is_over for body j, which has two different corners, a wall or restraints."""
    length, passed = f[row.LENGTH + j], f[row.PASSED + j]
    lift_end = f[row.SAMPLE_LIFT + j] + f[row.SAMPLE_LIFT_SLOPE + j] * length
    weakest = min(f[row.SAMPLE_LIFT + j], lift_end)
    alpha, other_alpha = f[row.ALPHA + j], f[OTHER_ALPHA + j]
    level = weakest * f[row.THRESHOLD + j] + f[EXTRA + j] - sliding
    threshold, other = level, math.inf
    pull = level * (1.0 if equation == event.LINEAR else math.cos(alpha))
    restitution, slowest = f[row.RESTITUTION + j], alpha
    peak = f[row.PEAK + j]
    if f[ONE_SIDED + j] == 0.0:
        faster = f[OTHER_P + j] / f[row.P + j]
        other = weakest * f[OTHER_THRESHOLD + j] + f[OTHER_EXTRA + j] - sliding
        pull = min(pull, faster * faster * other * (1.0 if equation == event.LINEAR else math.cos(other_alpha)))
        threshold = min(level, other)
        restitution = max(restitution, f[OTHER_RESTITUTION + j])
        slowest = min(slowest, other_alpha * faster)
        peak = max(peak, f[OTHER_PEAK + j] * alpha / other_alpha)
    if threshold <= 0.0 or pull <= 0.0:
        return False
    # Each corner has its own uplift threshold; a push towards a wall cannot lift the body.
    start = -f[row.SIDE + j] * (f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * passed)
    end = -f[row.SIDE + j] * (f[row.SAMPLE_GROUND + j] + f[row.SAMPLE_SLOPE + j] * length)
    demand, demand_end = max(start / level, -start / other), max(end / level, -end / other)
    if demand >= 1.0:
        return False
    share = event.CHATTER_SHARE if f[row.HITS + j] < event.MANY_IMPACTS else 1.0
    speed, highest, cutoff = f[row.SPEED + j] / pull, share * peak / pull, IMPACT_CUTOFF * slowest / pull
    rise = f[row.THRESHOLD + j] if f[ONE_SIDED + j] == 1.0 else max(f[row.THRESHOLD + j], f[OTHER_THRESHOLD + j])
    return event.hops_end(f, j, record, far, threshold, rise, demand, demand_end, restitution, speed, cutoff, highest)


@njit(_nrt=False)
def after_impact(f, i, j, record, equation, far, sliding):
    """Return the state of body j after an impact: MOVING, RESTING, OVERTURNED or IMPACT_LIMITED."""
    if f[row.HITS + j] > IMPACTS_PER_SAMPLE:
        return event.IMPACT_LIMITED
    speed = f[row.SPEED + j]
    if speed == 0.0:
        return event.RESTING
    # After a faster impact, which is counted, the motion is computed further.
    if speed < IMPACT_CUTOFF * f[row.ALPHA + j]:
        far = far or f[row.HITS + j] >= event.MANY_IMPACTS
        if sliding is None:
            over = event.chatter_is_over(f, j, record, equation, far)
        else:
            over = hops_have_ended(f, j, record, equation, far, sliding)
        if over:
            return event.RESTING
        i[row.SLOW + j] += 1
        if i[row.SLOW + j] > event.SLOW_IMPACTS:
            return event.IMPACT_LIMITED
    if equation == event.LINEAR and event.must_overturn(f, j, record):
        return event.OVERTURNED
    return event.MOVING


@njit(_nrt=False)
def top_of_hop(speed, alpha, linear):
    """Return the largest phi [rad] on still ground of a motion that starts at phi = 0 with dphi/dtau = `speed`."""
    if not linear:
        return top_rotation(speed, alpha)
    share = speed / alpha
    return alpha * share * share / (1.0 + math.sqrt(max(0.0, 1.0 - share * share)))


@njit(_nrt=False)
def first_excursion(phi, speed, alpha, linear):
    """Return largest phi (inf: overturns), time tau to impact or overturning, and impact speed on still ground."""
    if linear:
        xi, eta = phi / alpha, speed / alpha
        if xi - 1.0 + eta >= 0.0:
            return math.inf, 0.0, math.nan
        square = xi * (2.0 - xi) + eta * eta
        arrival = math.sqrt(square)
        rise = xi * (2.0 - xi) / (arrival - eta) if eta < 0.0 else arrival + eta
        wait = math.log1p((xi + rise) / (1.0 - xi - eta))
        top = max(xi, square / (1.0 + math.sqrt(max(0.0, 1.0 - square)))) if eta > 0.0 else xi
        return alpha * top, wait, alpha * arrival
    half, half_alpha = math.sin(0.5 * (alpha - phi)), math.sin(0.5 * alpha)
    excess = 0.5 * speed * speed - 2.0 * half * half
    fall = 0.5 * math.pi - alpha
    over = speed > 0.0 and excess >= 0.0 if phi < alpha else speed >= 0.0 or excess <= 0.0
    turn = 2.0 * math.asin(min(1.0, math.sqrt(max(0.0, -0.5 * excess))))  # abs(phi - alpha) at which it turns back
    if over:
        if speed >= 0.0:
            return math.inf, flight_time(excess, phi - alpha, fall), math.nan
        return math.inf, flight_time(excess, turn, phi - alpha) + flight_time(excess, turn, fall), math.nan
    arrival = math.sqrt(2.0 * excess + 4.0 * half_alpha * half_alpha)
    if speed <= 0.0:
        return phi, flight_time(excess, -alpha, phi - alpha), arrival
    wait = flight_time(excess, phi - alpha, -turn) + flight_time(excess, -alpha, -turn)
    return max(phi, top_rotation(arrival, alpha)), wait, arrival


@njit(_nrt=False)
def free_motion(f, j, linear):
    """Compute the motion of body j after the record, on still ground, until it rests or overturns.

    Return the largest phi/alpha, inf if it overturns; the time until it overturns [s], else NaN; the number of impacts
    before overturning; and the number of impacts above the cut-off, -1 if they never end.
    """
    alpha, p, restitution = f[row.ALPHA + j], f[row.P + j], f[row.RESTITUTION + j]
    one_sided = f[ONE_SIDED + j] == 1.0
    other_alpha, other_p, other_restitution = f[OTHER_ALPHA + j], f[OTHER_P + j], f[OTHER_RESTITUTION + j]
    if one_sided:
        other_alpha, other_p, other_restitution = alpha, p, restitution
    top, wait, arrival = first_excursion(f[row.PHI + j], f[row.SPEED + j], alpha, linear)
    time = wait / p
    if top == math.inf:
        return top, time, 0, 0
    peak, first, second = top / alpha, arrival / alpha, 0.0
    # Each half-cycle is slower than the one two before it: if the first two do not overturn, no later one does.
    for impact in range(1, 3):
        speed = restitution * arrival * p / other_p
        alpha, other_alpha = other_alpha, alpha
        p, other_p = other_p, p
        restitution, other_restitution = other_restitution, restitution
        if impact == 1:
            second = speed / alpha
        critical = alpha if linear else 2.0 * math.sin(0.5 * alpha)
        if speed >= critical:
            if linear:
                return math.inf, time, impact, 0
            excess = 0.5 * speed * speed - 0.5 * critical * critical
            return math.inf, time + flight_time(excess, -alpha, 0.5 * math.pi - alpha) / p, impact, 0
        top = top_of_hop(speed, alpha, linear)
        peak = max(peak, top / alpha)
        if linear:
            time += 2.0 * math.atanh(speed / alpha) / p
        else:
            excess = 0.5 * speed * speed - 0.5 * critical * critical
            time += 2.0 * flight_time(excess, -alpha, -2.0 * math.asin(math.sqrt(-0.5 * excess))) / p
        arrival = speed
    both = restitution * other_restitution
    odd, even = event.impacts_above_cutoff(first, both), event.impacts_above_cutoff(second, both)
    return peak, math.nan, 0, -1 if odd < 0 or even < 0 else odd + even
