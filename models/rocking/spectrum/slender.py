"""March of slender blocks under a piecewise linear ground acceleration, with the linear equation in closed form.

.. note:: With phi = theta/alpha, tau = p t, u = s phi and g = (x/p) a_g, linear in tau over a piece, u'' = u - 1 - s g
   (Eqs. 1-2). So y = u - 1 - s g obeys y'' = y: y = A e^tau + B e^-tau with A = (y_0 + y_0')/2 and B = (y_0 - y_0')/2.
   u' = 0 where z = e^tau solves A z^2 + s g' z - B = 0: the extremes of u are roots of a quadratic, and impacts are
   bracketed between them. A block at rest lifts where abs(g) passes 1. It overturns if its growing mode u - 1 + u'
   exceeds the largest later abs(g).
"""

import math

import numpy as np

from rocking.kernel_cache import njit

#: Impacts slower than this u' [-] end the rocking unless the ground lifts the block: u would only reach 5e-7.
SLOWEST = 1e-3
#: Largest number of steps of the search for an impact, and its accuracy in u [-].
STEPS, ACCURACY = 60, 1e-10
#: Largest number of impacts computed within one piece.
MOST_IMPACTS = 100_000


@njit()
def _turning(grow, fall, slope, growth, lowest):
    """Return e^tau at the top (or `lowest` point) of u = grow e^tau + fall e^-tau + a line in a piece; 0 for none."""
    if grow == 0.0:
        roots = (fall / slope if slope != 0.0 else 0.0, 0.0)
    else:
        under = slope * slope + 4.0 * grow * fall
        if under < 0.0:
            return 0.0
        half = -0.5 * (slope + math.copysign(math.sqrt(under), slope))
        roots = (half / grow, -fall / half if half != 0.0 else 0.0)
    for z in roots:
        if 1.0 < z < growth and (grow * z + fall / z > 0.0) == lowest:
            return z
    return 0.0


@njit()
def _impact(grow, fall, level, slope, above, below):
    """Return tau of an impact (u = 0) between `above` (u > 0) and `below` (u <= 0), by bracketed Newton steps."""
    tau = below
    for _ in range(STEPS):
        growth = math.exp(tau)
        up, down = grow * growth, fall / growth
        value = up + down + level + slope * tau
        if abs(value) <= ACCURACY:
            break
        if value > 0.0:
            above = tau
        else:
            below = tau
        speed = up - down + slope
        tau -= value / speed if speed != 0.0 else 0.0
        if not above < tau < below:
            tau = 0.5 * (above + below)
    return tau


@njit(inline="always")
def _pushes(ground, wall):
    """Return the ground acceleration that can lift the resting block; a push towards a wall cannot."""
    return max(-ground, 0.0) if wall else abs(ground)


@njit()
def _march(begin, state, strength, restitution, length, growth, ground, left, wall):
    """March one lane from piece `begin` on; return whether it has ended, at rest or overturned. With a wall, C is e.

    The `state` has the largest u (inf if it overturns), u, u' and s (0 at rest, where u = 0).
    """
    peak, u, speed, side = state[0], state[1], state[2], state[3]
    for j in range(begin, length.shape[0]):
        start, end = strength * ground[j, 0], strength * ground[j, 1]
        low, high = _pushes(start, wall), _pushes(end, wall)
        if side == 0.0 and low <= 1.0 and high <= 1.0:
            if strength * left[j] <= 1.0:
                state[0] = peak
                return True
            continue
        remaining, whole = length[j], growth[j]
        slope = (end - start) / remaining
        for _ in range(MOST_IMPACTS):
            if side == 0.0:
                wait = 0.0
                if _pushes(start, wall) <= 1.0:
                    if high <= 1.0:
                        break
                    wait = (math.copysign(1.0, end) - start) / slope
                    if wait >= remaining:
                        break
                    start, remaining = start + slope * wait, remaining - wait
                    whole = math.exp(remaining)
                side = 1.0 if wall else -math.copysign(1.0, start)
            level, rate = 1.0 + side * start, side * slope
            grow, fall = 0.5 * (u - level + speed - rate), 0.5 * (u - level - speed + rate)
            last_u = grow * whole + fall / whole + level + rate * remaining
            last_speed = grow * whole - fall / whole + rate
            # An impact lies between the points above and below, both as tau; from u = 0 the motion goes upwards.
            above, below = 0.0, remaining if last_u <= 0.0 else -1.0
            if u == 0.0 or (speed > 0.0 and (last_speed < 0.0 or last_u <= 0.0)):
                z = _turning(grow, fall, rate, whole, False)
                if z > 0.0:
                    above = math.log(z)
                    peak = max(peak, grow * z + fall / z + level + rate * above)
            # u has a minimum inside only if u' starts below zero or u'' changes sign.
            dips = speed < 0.0 or grow + fall < 0.0 < grow * whole + fall / whole
            if dips and last_u > 0.0 and last_speed > 0.0 and (u > 0.0 or above > 0.0):
                z = _turning(grow, fall, rate, whole, True)
                if z > 0.0:
                    tau = math.log(z)
                    if tau > above and grow * z + fall / z + level + rate * tau <= 0.0:
                        below = tau
            if below < 0.0 or (u == 0.0 and above == 0.0):
                u, speed = max(last_u, 0.0), last_speed
                peak = max(peak, u)
                break
            tau = _impact(grow, fall, level, rate, above, below)
            z = math.exp(tau)
            speed = restitution * max(fall / z - grow * z - rate, 0.0)
            if speed - 1.0 > strength * left[j]:
                state[0] = np.inf
                return True
            u, side = 0.0, side if wall else -side
            start, remaining = start + slope * tau, remaining - tau
            margin = 1.0 - max(_pushes(start, wall), high)
            # At rest after hops of at most 2 u'/margin, each shorter by C, that all end within the piece.
            if speed <= SLOWEST or 2.0 * speed < margin * (1.0 - restitution) * remaining:
                speed, side = 0.0, 0.0
            if remaining <= 0.0:
                break
            whole = math.exp(remaining)
        if side != 0.0 and u - 1.0 + speed > strength * left[j + 1]:
            state[0] = np.inf
            return True
    state[0], state[1], state[2], state[3] = peak, u, speed, side
    return False


@njit()
def _peak_on_still_ground(u, speed, restitution):
    """Return the largest u on a still ground, of a motion with u and u' at its start; inf if it overturns."""
    # (1 - u)^2 - u'^2 is constant: its value is (1 - u)^2 at the top, 1 - u'^2 at the impact.
    kept = (1.0 - u) ** 2 - speed * speed
    after = restitution * math.sqrt(max(1.0 - kept, 0.0))
    if after > 1.0:
        return np.inf
    top = max(kept, 0.0) if speed > 0.0 else 1.0
    return 1.0 - math.sqrt(min(top, 1.0 - after * after))


@njit()
def march_pieces(first, last, begin, state, place, strength, restitution, length, growth, ground, left, wall, final):
    """March lanes `first` to `last` - 1 over consecutive pieces, from piece `begin` of each lane on; -1: not at all.

    The lanes (n,) have the index `place` of their p, the `strength` x/p [s2/m] and C; `length` and `growth` (a, k) are
    the lengths of the pieces in tau and their e^tau, `ground` (k, 2) is the acceleration at both ends [m/s2], and
    `left` (k + 1,) is its largest absolute value from each piece to the end of the record. The `state` (n, 4) is
    updated (see `_march`), and `begin` is set to 0, or to -1 for a lane that has ended. After the `final` pieces the
    ground is still.
    """
    for lane in range(first, last):
        if begin[lane] < 0:
            continue
        k, own = place[lane], state[lane]
        ended = _march(begin[lane], own, strength[lane], restitution[lane], length[k], growth[k], ground, left, wall)
        begin[lane] = -1 if ended else 0
        if final and not ended and own[3] != 0.0:
            own[0] = max(own[0], _peak_on_still_ground(own[1], own[2], restitution[lane]))


@njit()
def weighted_impulse(times: np.ndarray, ground: np.ndarray, rate: float, last: float) -> np.ndarray:
    """Return E [m/s] (:mod:`rocking.march.demand`) at points (k,) of a piecewise linear ground, `last` at the last."""
    weighted = np.full(times.shape[0], last)
    for i in range(times.shape[0] - 2, -1, -1):
        step = times[i + 1] - times[i]
        if step <= 0.0:
            weighted[i] = weighted[i + 1]
            continue
        decay = np.exp(-rate * step)
        whole = -np.expm1(-rate * step) / rate
        late = (whole - step * decay) / (rate * step)
        weighted[i] = decay * weighted[i + 1] + (whole - late) * ground[i] + late * ground[i + 1]
    return weighted


@njit()
def lobe_tops(weighted: np.ndarray) -> np.ndarray:
    """Return indices of the largest abs(E) (k,) in every run of one sign, in order; zeros belong to no run."""
    tops = np.empty(weighted.shape[0], dtype=np.int64)
    count, side = 0, 0.0
    for i in range(weighted.shape[0]):
        if weighted[i] == 0.0:
            continue
        here = np.sign(weighted[i])
        if here != side:
            tops[count] = i
            count, side = count + 1, here
        elif abs(weighted[i]) > abs(weighted[tops[count - 1]]):
            tops[count - 1] = i
    return tops[:count].copy()
