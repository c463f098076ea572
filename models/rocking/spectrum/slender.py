"""Motion of slender blocks under a ground motion, from impact to impact by the closed form of the linear equation.

.. note:: With phi = theta/alpha, tau = p t, u = s phi on the side s = 1 or -1, and f = x/p, the equation of
   :mod:`.slender_lanes` is linear between impacts, u'' = u - 1 - s f a_g. All lanes (each a block at a scale factor) of
   one p share its bounded particular solution Q (:mod:`.slender_ground`):

   u = 1 + s f Q + (A + B)/2,  u' = s f Q' + (A - B)/2,  with A growing as e^tau and B falling as e^-tau,
   A = u - 1 + u' - s f G,  B = u - 1 - u' - s f H.

   So u at any node of the ground motion costs three products, and `search` computes it at a group of nodes at once to
   find the next node at which the block is near the ground. A group is skipped if a lower bound of u, from the least s
   Q and from A and B, each least at one end of the group, is above all heights that `search` calls small. The growing
   mode is u - 1 + u' = A + s f G; at an impact it is at most -1. It stays above -1, and the block overturns, if A > 0
   and A + 1 > f max(-s G).
   (u'^2 + 2 u - u^2)' = -2 s f a_g u', and for u from 0 to 1 abs(u') is at most w, the square root of u'^2 + 2 u - u^2,
   so w changes by at most f abs(a_g) per unit of tau; impacts reduce it. It is abs(u') at an impact, at least 1 at u =
   1: if u' after an impact plus the integral of f abs(a_g) to the end is below 1, the block cannot overturn any more.

   At an impact s changes its sign (not beside a wall) and u' becomes C abs(u').
   In a piece (between two nodes) of length h, u'' <= u + b with b = f abs(a_g) - 1. If u has been below zero within it
   but is positive at its end, then, from the minimum, u <= (cosh h - 1) max(b) at both ends, u' <= sinh(h) max(b) at
   the end. If u falls again there, u'' was positive at the start, and for a u'' linear in tau u + h abs(u')/3 is at
   most h^2 max(b)/6, a third of the bound of u. Other pieces contain no impact. `_may_dip` applies bounds of this kind,
   with u'' at both ends, to one piece.
   The impacts of `WIDTH` lanes are solved together by three of Halley's steps from the root of a Taylor polynomial, and
   the signs of u'' and of u at its minimum show whether a root is the first one. `first_impact` solves the few cases in
   which it may not be the first one, or in which the steps do not converge.
"""

import math

import numpy as np

from rocking.kernel_cache import njit
from rocking.spectrum.slender_ground import (
    AHEAD,
    BLOCK,
    DECAY,
    DOWN,
    GROWTH,
    HIGHEST,
    IMPULSE,
    LEAST,
    LENGTH,
    LIFTING,
    MOST,
    REACH,
    RESPONSE,
    SLOPE,
    SPEED,
    START,
    STRONGEST,
    UP,
    exceeds,
    lifting,
    search,
)
from rocking.spectrum.slender_piece import (
    first_impact,
    first_root,
    halley_step,
    hyperbolic,
    motion_at,
    peak_on_still_ground,
)

#: Impacts slower than this u' [-] end the motion unless the ground lifts the block: on still ground u reaches 5e-7.
SLOWEST = 1e-3
#: Number of lanes whose impacts are solved together.
WIDTH = 16
#: The last of Halley's steps is at most this share of tau: the error is about its third power.
CONVERGED = 1e-5
#: Start of each row of `s` (in the code the state of lanes; the side s is its row SIDE), at a point of a piece: u, u',
#: s f a_g and its rate, the length left in the piece, u and u' at the end of the piece.
U, V, PUSH, RATE, LEFT, END_U, END_V = (np.uint64(WIDTH * row) for row in range(7))
#: Rows of the lane: f, C, s (0 at rest, when PUSH and RATE have the sign of a_g), the largest u, f times the
#: acceleration that can lift the block at the end of the piece, and what follows the solution of an impact.
STRENGTH, RESTITUTION, SIDE, PEAK, HOLD, NEXT = (np.uint64(WIDTH * row) for row in range(7, 13))
ROWS = 13
#: What follows: no impact was found by these steps, the next impact is in the same piece, the block rests, or it moves.
UNSOLVED, AGAIN, RESTS, MOVES = 0.0, 1.0, 2.0, 3.0
#: In place of the number of a piece: the lane overturns, reaches the end of the tables, or cannot overturn any more.
ENDED, FINAL, SAFE = -1, -2, -3


@njit(_nrt=False)
def _solve_impacts(s, wall):
    """Compute the next impacts of all blocks; NEXT is UNSOLVED if `first_impact` must be used instead."""
    for i in range(np.uint64(WIDTH)):
        u, v, push, rate, left = s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i]
        bend, twist = u - 1.0 - push, v - rate
        even, odd = hyperbolic(left)
        end, speed = u + v * left + bend * even + twist * odd, v + bend * (left + odd) + twist * even
        last = bend * (1.0 + even) + twist * (left + odd)
        s[END_U + i], s[END_V + i] = end, speed
        # Begin at the root of the Taylor polynomial of a hop if u is small (a share of 0.2), of u at the end if it is
        # concave there only, or of u at the start.
        hop = first_root(v, 0.5 * bend, twist / 6.0)
        late = left - first_root(-end, speed, -0.5 * last)
        tau = late if (bend > 0.0) & (last < 0.0) else first_root(u, v, 0.5 * bend)
        tau = hop if (v > 0.0) & (u <= 0.2 * v * hop) else tau
        tau = tau if tau > 0.0 else 0.0
        tau = tau if tau < left else left
        _, tau = halley_step(tau, u, v, bend, twist, left)
        _, tau = halley_step(tau, u, v, bend, twist, left)
        step, tau = halley_step(tau, u, v, bend, twist, left)
        even, odd = hyperbolic(tau)
        impact_speed, curve = -(v + bend * (tau + odd) + twist * even), bend * (1.0 + even) + twist * (tau + odd)
        height = u + v * tau + bend * even + twist * odd  # not zero if the step was limited to the piece
        close = (abs(step) <= CONVERGED * tau) & (abs(height) <= CONVERGED * impact_speed * tau)
        # u'' changes its sign once at most, so an earlier impact is possible only if u falls, is convex, then concave.
        # The minimum of u is at the first zero of v + bend t + twist t^2/2; 2 % exceed the error of this polynomial.
        under = bend * bend - 2.0 * twist * v
        low = -2.0 * v / (bend + math.sqrt(under if under > 0.0 else 0.0))
        low = low if low < left else left
        even, odd = hyperbolic(low)
        above = (under < -0.02 * bend * bend) | (u + v * low + bend * even + twist * odd > 0.02 * u)
        first = (bend <= 0.0) | (curve >= 0.0) | (v >= 0.0) | above
        _bounce(s, i, tau, impact_speed, (impact_speed > 0.0) & close & first, wall)


@njit(inline="always", _nrt=False)
def _bounce(s, i, tau, impact_speed, solved, wall):
    """Apply the impact of block i at `tau` with u' = -`impact_speed` if it is `solved`, and write what follows."""
    turn = 1.0 if wall else -1.0
    push, rate, left = turn * (s[PUSH + i] + s[RATE + i] * tau), turn * s[RATE + i], s[LEFT + i] - tau
    v = s[RESTITUTION + i] * (impact_speed if impact_speed > 0.0 else 0.0)
    bend, twist = -1.0 - push, v - rate
    even, odd = hyperbolic(left)
    end, speed = v * left + bend * even + twist * odd, v + bend * (left + odd) + twist * even
    lifts = -push if wall else abs(push)
    held = s[HOLD + i]
    margin = 1.0 - (lifts if lifts > held else held)
    # It rests if its half-cycles end in this piece: the first lasts about 2 u'/margin, each C times the one before.
    rests = (v <= SLOWEST) | (2.0 * v < margin * (1.0 - s[RESTITUTION + i]) * left)
    following = RESTS if rests else (AGAIN if end <= 0.0 else MOVES)
    s[NEXT + i] = following if solved else UNSOLVED
    s[U + i], s[V + i] = 0.0 if solved else s[U + i], v if solved else s[V + i]
    s[PUSH + i], s[RATE + i] = push if solved else s[PUSH + i], rate if solved else s[RATE + i]
    s[LEFT + i], s[SIDE + i] = left if solved else s[LEFT + i], turn * s[SIDE + i] if solved else s[SIDE + i]
    s[END_U + i], s[END_V + i] = end if solved else s[END_U + i], speed if solved else s[END_V + i]


@njit(_nrt=False)
def _raise_peak(s, i, u, v, push, rate, left):
    """Update the largest u of block i from its motion within `left` after a point with u and u' = `v`."""
    bend, twist = u - 1.0 - push, v - rate
    if u + v * left + max(bend, 0.0) * left * left < s[PEAK + i]:  # u'' is at most max(bend, 0) before a peak
        return
    tau = min(-1.01 * bend / twist, left) if bend > 0.0 > twist else 0.0  # from where u is concave
    for _ in range(6):
        _, speed = motion_at(tau, u, v, bend, twist)
        even, odd = hyperbolic(tau)
        curve = bend * (1.0 + even) + twist * (tau + odd)
        if curve >= 0.0:
            break
        tau = min(max(tau - speed / curve, 0.0), left)
    s[PEAK + i] = max(s[PEAK + i], u, motion_at(tau, u, v, bend, twist)[0])


@njit(_nrt=False)
def _end_of_piece(s, i):
    u, v = s[U + i], s[V + i]
    s[END_U + i], s[END_V + i] = motion_at(s[LEFT + i], u, v, u - 1.0 - s[PUSH + i], v - s[RATE + i])


@njit(_nrt=False)
def _lift(s, i, k, count, points, blocks, wall):
    """Find the point at which block i, at rest in piece `k`, is lifted; return the piece of this point, or FINAL."""
    strength, now, rate, left = s[STRENGTH + i], s[PUSH + i], s[RATE + i], s[LEFT + i]
    if left <= 0.0 or lifting(now, wall) <= 1.0:
        node = k + 1
        while node <= count and strength * points[node, LIFTING] <= 1.0:
            node += 1
            while node % BLOCK == 0 and node <= count and strength * blocks[node // BLOCK, HIGHEST] <= 1.0:
                node += BLOCK
        if node > count:
            return FINAL
        if node - 1 > k:
            k = node - 1
            now, rate, left = strength * points[k, START], strength * points[k, SLOPE], points[k, LENGTH]
        end, wait = now + rate * left, left
        if lifting(end, wall) > 1.0:
            wait = max((math.copysign(1.0, end) - now) / rate, 0.0)
        if wait < left:
            now, left = math.copysign(1.0, end), left - wait
        elif node < count:  # a jump at the node
            k = node
            now, rate, left = strength * points[k, START], strength * points[k, SLOPE], points[k, LENGTH]
        else:
            return FINAL
    side = 1.0 if wall else -math.copysign(1.0, now)
    s[SIDE + i], s[U + i], s[V + i] = side, 0.0, 0.0
    s[PUSH + i], s[RATE + i], s[LEFT + i] = side * now, side * rate, left
    _end_of_piece(s, i)
    return k


@njit(inline="always", _nrt=False)
def _fly(s, i, k, count, points, rows, blocks, peaks):
    """Compute the motion of block i from node `k`; return the next piece at whose end u is small, ENDED or FINAL."""
    u, v, side, strength = s[END_U + i], s[END_V + i], s[SIDE + i], s[STRENGTH + i]
    u = max(u, 0.0)
    if k == count:
        s[U + i], s[V + i] = u, v
        return FINAL
    force = side * strength
    block = k // BLOCK
    # A/2 and B/2 at the start of the group; their terms in u at a node are grow UP and fall DOWN.
    grow = 0.5 * (u - 1.0 + v - force * (points[k, RESPONSE] + points[k, SPEED])) * points[k, DOWN]
    fall = 0.5 * (u - 1.0 - v - force * (points[k, RESPONSE] - points[k, SPEED])) * points[k, UP]
    grow_before, fall_before = grow, fall
    while True:
        if grow > 0.0 and 2.0 * grow + 1.0 > strength * blocks[block, AHEAD if side > 0.0 else AHEAD + 1]:
            s[PEAK + i] = np.inf
            return ENDED
        first = block * BLOCK
        pushed = max(strength * blocks[block, HIGHEST] - 1.0, 0.0)
        # After a dip below zero u <= REACH b = near and u' <= h b = sqrt(2 near b), with b = `pushed`.
        near = blocks[block, REACH] * pushed
        growth, decay, whole = blocks[block, GROWTH], blocks[block, DECAY], first + BLOCK <= count
        least = 1.0 + force * blocks[block, LEAST if side > 0.0 else MOST]
        least += min(grow, grow * growth) + min(fall, fall * decay)
        if peaks or not whole or least <= near:
            found = search(rows[block], k - first, force, grow, fall, near, math.sqrt(2.0 * near * pushed))
            if peaks:
                # From a peak, u falls by at most REACH (1 + f abs(a_g)) to the next node: u'' >= u - 1 - f abs(a_g).
                high = s[PEAK + i] - blocks[block, REACH] * (1.0 + strength * blocks[block, STRONGEST])
                end = min(first + found // 2, first + BLOCK - 1, count)
                if exceeds(rows[block], k - first, force, grow, fall, high):
                    _scan_peak(s, i, max(k + 1, first), end, force, grow, fall, points, blocks)
            if found < 2 * BLOCK or not whole:
                break
        grow_before, fall_before = grow, fall
        grow, fall, block = grow * growth, fall * decay, block + 1
    node, last = first + found // 2, min(first + BLOCK - 1, count)
    if node > last:
        s[U + i] = max(1.0 + force * points[last, RESPONSE] + grow * points[last, UP] + fall * points[last, DOWN], 0.0)
        s[V + i] = force * points[last, SPEED] + grow * points[last, UP] - fall * points[last, DOWN]
        return FINAL
    piece = node - 1
    if piece > k:
        if piece < first:
            grow, fall = grow_before, fall_before
        up, down = grow * points[piece, UP], fall * points[piece, DOWN]
        u = max(1.0 + force * points[piece, RESPONSE] + up + down, 0.0)
        v = force * points[piece, SPEED] + up - down
    s[U + i], s[V + i], s[LEFT + i] = u, v, points[piece, LENGTH]
    s[PUSH + i], s[RATE + i] = force * points[piece, START], force * points[piece, SLOPE]
    s[END_U + i] = 0.0  # an impact: the solver computes the end
    if found % 2 == 1:
        _end_of_piece(s, i)
    return piece


@njit(_nrt=False)
def _scan_peak(s, i, first, last, force, grow, fall, points, blocks):
    """Update the largest u of block i from its motion between nodes `first` - 1 and `last`, all in one group."""
    margin = blocks[first // BLOCK, REACH] * (1.0 + abs(force) * blocks[first // BLOCK, STRONGEST])
    for k in range(first, last + 1):
        up, down = grow * points[k, UP], fall * points[k, DOWN]
        u = 1.0 + force * points[k, RESPONSE] + up + down
        if u + margin > s[PEAK + i]:
            v, piece = force * points[k, SPEED] + up - down, k - 1
            end = points[piece, START] + points[piece, SLOPE] * points[piece, LENGTH]
            s[PEAK + i] = max(s[PEAK + i], u)
            # If u' > 0 at the node, u'' > 0 must have raised it from zero after a peak. In reversed time (u' and the
            # slope of a_g change their signs) the peak comes after the node.
            if v <= max(u - 1.0 - force * end, 0.0) * points[piece, LENGTH]:
                _raise_peak(s, i, u, -v, force * end, -force * points[piece, SLOPE], points[piece, LENGTH])


@njit(inline="always", _nrt=False)
def _may_dip(s, i):
    """Return True if u of block i, positive at the end of this piece, may have been below zero within it.

    The bounds are those of a u'' that is linear in tau, with a margin of 5 % (1 % below) that exceeds the difference.
    """
    u, v, left, end, speed = s[U + i], s[V + i], s[LEFT + i], s[END_U + i], s[END_V + i]
    before = u - 1.0 - s[PUSH + i]
    after = end - 1.0 - s[PUSH + i] - s[RATE + i] * left
    highest, lowest = max(before, after), min(before, after)
    if highest <= 0.0:
        return False
    if lowest < 0.0:
        # Convex in one part of the piece only: from zero to `highest`, u'' changes u' by half of highest part, and u by
        # a sixth of highest part^2.
        part = left * highest / (highest - lowest)
        away, high = (speed, end) if after > before else (-v, u)
        return 0.0 < away <= 0.525 * highest * part and high <= 0.175 * highest * part**2
    if v >= 0.0 or not 0.0 < speed <= 1.05 * highest * left or end > 0.525 * highest * left**2:
        return False
    # With u'' >= lowest, u reaches zero only if u'^2 >= 2 lowest u at both ends.
    return v * v >= 1.98 * lowest * u and speed * speed >= 1.98 * lowest * end


@njit(inline="always", _nrt=False)
def _to_impact(s, i, k, passed, count, points, rows, blocks, wall, peaks):
    """Compute the motion of block i from a point of piece `k` to the next piece that may contain an impact.

    Return this piece, ENDED, FINAL or SAFE. `passed` is True if the rest of piece `k` is known to contain no impact.
    """
    # Only the verdict is needed without `peaks`.
    if not (passed or peaks) and s[V + i] + s[STRENGTH + i] * blocks[k // BLOCK, IMPULSE] < 1.0:
        return SAFE
    while True:
        if s[SIDE + i] == 0.0:
            k = _lift(s, i, k, count, points, blocks, wall)
            passed = False
            if k < 0:
                return k
        if not passed and (s[END_U + i] <= 0.0 or _may_dip(s, i)):
            return k
        bend = s[END_U + i] - 1.0 - s[PUSH + i] - s[RATE + i] * s[LEFT + i]  # as in `_scan_peak`
        if peaks and k >= 0 and s[V + i] >= 0.0 and s[END_V + i] <= max(bend, 0.0) * s[LEFT + i]:
            _raise_peak(s, i, s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i])
        k = _fly(s, i, k + 1, count, points, rows, blocks, peaks)
        if k < 0:
            return k
        passed = False


@njit(inline="always", _nrt=False)
def _after_impact(s, i, wall):
    """Complete an impact of block i; return True if the block reaches the end of its piece without one."""
    if s[NEXT + i] == UNSOLVED:
        u, v, push, rate, left = s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i]
        bend, twist = u - 1.0 - push, v - rate
        tau = first_impact(u, v, bend, twist, left)
        if tau < 0.0:
            return True
        _bounce(s, i, tau, -motion_at(tau, u, v, bend, twist)[1], True, wall)
    if s[NEXT + i] == RESTS:
        s[PUSH + i], s[RATE + i], s[SIDE + i] = s[SIDE + i] * s[PUSH + i], s[SIDE + i] * s[RATE + i], 0.0
    return False


@njit(_nrt=False)
def march_lanes(first, last, s, slots, state, strength, restitution, count, points, rows, blocks, wall, final, peaks):
    """Compute lanes (a block at a scale factor) `first` to `last` - 1 of one p over :class:`.slender_ground.Tables`.

    `s` (ROWS * WIDTH,) and `slots` (2, WIDTH) of integers are working memory. The lanes (n,) have the `strength`
    f = x/p [s2/m] and the `restitution` C (the rebound e beside a wall, with s = 1 always). The `state` (n, 4) is
    updated: largest u (inf if the block overturns; without `peaks` it is only valid if inf), u, u' and s (0 at rest,
    NaN for a lane that has ended). If `final` is True, the ground is still after the tables.
    """
    lane_of, piece = slots[0], slots[1]
    lane_of[:] = -1
    taken, busy = first, 1
    while busy > 0:
        busy = 0
        for i in range(np.uint64(WIDTH)):
            k, passed = piece[i], True
            if lane_of[i] >= 0:
                if s[NEXT + i] == AGAIN:
                    busy += 1
                    continue
                passed = _after_impact(s, i, wall)
            while True:
                if lane_of[i] < 0:
                    while taken < last and np.isnan(state[taken, 3]):
                        taken += 1
                    if taken == last:
                        break
                    lane_of[i] = taken
                    k = _start(s, i, state[taken], strength[taken], restitution[taken], points)
                    passed = True
                    taken += 1
                k = _to_impact(s, i, k, passed, count, points, rows, blocks, wall, peaks)
                if k >= 0:
                    s[HOLD + i] = strength[lane_of[i]] * points[k + 1, LIFTING]
                    busy += 1
                    break
                _store(s, i, state[lane_of[i]], k, final)
                lane_of[i] = -1
            piece[i] = k
        if peaks:
            for i in range(np.uint64(WIDTH)):
                if lane_of[i] >= 0 and s[V + i] >= 0.0:
                    _raise_peak(s, i, s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i])
        _solve_impacts(s, wall)


@njit(_nrt=False)
def _start(s, i, own, strength, restitution, points):
    """Write the state of block i at the first node; return the piece in which it rests, or -1 if it moves."""
    s[STRENGTH + i], s[RESTITUTION + i], s[SIDE + i], s[PEAK + i] = strength, restitution, own[3], own[0]
    s[V + i], s[END_U + i], s[END_V + i] = 0.0, own[1], own[2]
    s[PUSH + i], s[RATE + i], s[LEFT + i] = strength * points[0, START], strength * points[0, SLOPE], points[0, LENGTH]
    return 0 if own[3] == 0.0 else -1


@njit(_nrt=False)
def _store(s, i, own, status, final):
    """Store the state of block i, which has overturned or has reached the end of the tables."""
    own[0], own[1], own[2], own[3] = s[PEAK + i], s[U + i], s[V + i], s[SIDE + i]
    if status == FINAL and final and own[3] != 0.0:
        own[0] = max(own[0], peak_on_still_ground(own[1], own[2], s[RESTITUTION + i]))
    if status in (ENDED, SAFE):
        own[3] = np.nan
