"""Motion of slender blocks under a ground motion, from impact to impact by the closed form of the linear equation.

.. note:: With phi = theta/alpha, tau = p t, u = s phi on the side s = 1 or -1, and f = x/p, the equation (Eqs. 1-2) is
   linear between impacts, u'' = u - 1 - s f a_g. All lanes (each a block at a scale factor) of one p share
   its bounded particular solution Q (:mod:`.slender_ground`):

   u = 1 + s f Q + (A + B)/2,  u' = s f Q' + (A - B)/2,  with A growing as e^tau and B falling as e^-tau,
   A = u - 1 + u' - s f G,  B = u - 1 - u' - s f H.

   So u at any node of the ground motion costs three products, and `_fly` computes it at a group of nodes at once to
   find the next node at which the block is near the ground. The growing mode is u - 1 + u' = A + s f G. It exceeds -1
   at all later times, and the block overturns, if A > 0 and A + 1 > f max(-s G).

   At an impact s changes its sign (not beside a wall) and u' becomes C abs(u').
   Near the ground u'' is at most f abs(a_g) - 1. So if u vanishes within a piece (between two nodes) of length h, it
   is at most (cosh h - 1) max(f abs(a_g) - 1) at the end of this piece: other pieces contain no impact.
   The impacts of `WIDTH` lanes are solved together by Halley's steps from the root of the parabola; `first_impact`
   solves the few cases in which u'' changes sign or the steps do not converge.
"""

import math

import numpy as np

from rocking.kernel_cache import njit
from rocking.spectrum.slender_ground import (
    AHEAD,
    BLOCK,
    DOWN,
    GROWTH,
    HIGHEST,
    LENGTH,
    LIFTING,
    REACH,
    RESPONSE,
    SLOPE,
    SPEED,
    START,
    STRONGEST,
    UP,
    lifting,
)
from rocking.spectrum.slender_piece import first_impact, halley_step, hyperbolic, motion_at

#: Impacts slower than this u' [-] end the motion unless the ground lifts the block: u would only reach 5e-7.
SLOWEST = 1e-3
#: Number of lanes whose impacts are solved together.
WIDTH = 16
#: The last of Halley's steps is at most this share of tau: the error is about its third power.
CONVERGED = 1e-5
#: Rows of the state of lanes, each with `WIDTH` values, at a point of a piece: u, u', s f a_g and its rate, the length
#: left in the piece, u and u' at the end of the piece.
U, V, PUSH, RATE, LEFT, END_U, END_V = (np.uint64(WIDTH * row) for row in range(7))
#: Rows of the impact in this piece: tau, u' after it, and the resulting u and u' at the end of the piece.
TAU, AFTER, NEXT_U, NEXT_V = (np.uint64(WIDTH * row) for row in range(7, 11))
#: Rows of the lane: f, C, s (0 at rest, when PUSH and RATE have the sign of a_g), and the largest u.
STRENGTH, RESTITUTION, SIDE, PEAK = (np.uint64(WIDTH * row) for row in range(11, 15))
ROWS = 15
#: Values in place of the number of a piece: the lane has ended (overturned), or has reached the end of the tables.
ENDED, FINAL = -1, -2


@njit(_nrt=False)
def _solve_impacts(s, turn):
    """Compute the impacts of all blocks in the state `s`; TAU is negative if `first_impact` must be used instead."""
    for i in range(np.uint64(WIDTH)):
        u, v, push, rate, left = s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i]
        bend, twist = u - 1.0 - push, v - rate
        under = v * v - 2.0 * bend * u
        root = math.sqrt(under if under > 0.0 else 0.0)
        top = v + root if v > 0.0 else 2.0 * u
        low = -bend if v > 0.0 else root - v
        tau = top / low
        tau = tau if tau > 0.0 else 0.0
        tau = tau if tau < left else left
        _, tau = halley_step(tau, u, v, bend, twist, left)
        _, tau = halley_step(tau, u, v, bend, twist, left)
        step, tau = halley_step(tau, u, v, bend, twist, left)
        even, odd = hyperbolic(left)
        same = bend * (bend * (1.0 + even) + twist * (left + odd)) > 0.0
        s[TAU + i] = tau if same and abs(step) <= CONVERGED * tau else -1.0
        even, odd = hyperbolic(tau)
        fall = -(v + bend * (tau + odd) + twist * even)
        v = s[RESTITUTION + i] * (fall if fall > 0.0 else 0.0)
        bend, twist = -1.0 - turn * (push + rate * tau), v - turn * rate
        left -= tau
        even, odd = hyperbolic(left)
        s[AFTER + i] = v
        s[NEXT_U + i] = v * left + bend * even + twist * odd
        s[NEXT_V + i] = v + bend * (left + odd) + twist * even


@njit(_nrt=False)
def _raise_peak(s, i, u, v, push, rate, left):
    """Update the largest u of block i from its motion within `left` after a point with u and u' = `v`."""
    bend, twist = u - 1.0 - push, v - rate
    if u + v * left + (1.0 + abs(push)) * left * left < s[PEAK + i]:
        return
    tau = 0.0
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
    if lifting(now, wall) <= 1.0:
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
        end = now + rate * left
        if lifting(end, wall) > 1.0:
            wait = min(max((math.copysign(1.0, end) - now) / rate, 0.0), left)
            now, left = math.copysign(1.0, end), left - wait
        elif node < count:  # a jump at the node
            k = node
            now, rate, left = strength * points[k, START], strength * points[k, SLOPE], points[k, LENGTH]
    side = 1.0 if wall else -math.copysign(1.0, now)
    s[SIDE + i], s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i] = (
        side,
        0.0,
        0.0,
        side * now,
        side * rate,
        left,
    )
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
    grow = 0.5 * (u - 1.0 + v - force * (points[k, RESPONSE] + points[k, SPEED])) * points[k, DOWN]
    fall = 0.5 * (u - 1.0 - v - force * (points[k, RESPONSE] - points[k, SPEED])) * points[k, UP]
    while True:
        if grow > 0.0 and 2.0 * grow + 1.0 > strength * blocks[block, AHEAD if side > 0.0 else AHEAD + 1]:
            s[PEAK + i] = np.inf
            return ENDED
        first = block * BLOCK
        pushed = strength * blocks[block, HIGHEST]
        near = blocks[block, REACH] * (pushed - 1.0) if pushed > 1.0 else 0.0
        # Slices, because indices that may be negative prevent the use of vector instructions.
        ahead = slice(first, first + BLOCK)
        q, e, d = rows[0, ahead], rows[1, ahead], rows[2, ahead]
        found = BLOCK
        for j in range(BLOCK):
            below = (1.0 + force * q[j] + grow * e[j] + fall * d[j] <= near) & (j > k - first)
            found = min(found, j if below else BLOCK)
        if peaks:
            high = s[PEAK + i] - blocks[block, REACH] * (1.0 + strength * blocks[block, STRONGEST])
            above = 0
            for j in range(BLOCK):
                above += (1.0 + force * q[j] + grow * e[j] + fall * d[j] > high) & (j > k - first)
            if above > 0:
                end = min(first + found, first + BLOCK - 1, count)
                _scan_peak(s, i, max(k + 1, first), end, force, grow, fall, points, blocks)
        if found < BLOCK:
            break
        if first + BLOCK > count:
            break
        grow *= blocks[block, GROWTH]
        fall /= blocks[block, GROWTH]
        block += 1
    node, last = first + found, min(first + BLOCK - 1, count)
    if node > last:
        s[U + i] = max(1.0 + force * points[last, RESPONSE] + grow * points[last, UP] + fall * points[last, DOWN], 0.0)
        s[V + i] = force * points[last, SPEED] + grow * points[last, UP] - fall * points[last, DOWN]
        return FINAL
    piece = node - 1
    if piece > k:
        shift = 1.0
        if piece < first:
            shift = blocks[block - 1, GROWTH]
        u = max(
            1.0
            + force * points[piece, RESPONSE]
            + grow * points[piece, UP] / shift
            + fall * points[piece, DOWN] * shift,
            0.0,
        )
        v = force * points[piece, SPEED] + grow * points[piece, UP] / shift - fall * points[piece, DOWN] * shift
    s[U + i], s[V + i], s[LEFT + i] = u, v, points[piece, LENGTH]
    s[PUSH + i], s[RATE + i] = force * points[piece, START], force * points[piece, SLOPE]
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
            v = force * points[k, SPEED] + up - down
            if v > 0.0:
                s[PEAK + i] = max(s[PEAK + i], u)
            else:
                piece = k - 1
                end = points[piece, START] + points[piece, SLOPE] * points[piece, LENGTH]
                _raise_peak(s, i, u, -v, force * end, -force * points[piece, SLOPE], points[piece, LENGTH])


@njit(inline="always", _nrt=False)
def _to_impact(s, i, k, passed, count, points, rows, blocks, wall, peaks):
    """Compute the motion of block i from a point of piece `k` to the next piece that may contain an impact.

    Return this piece, ENDED or FINAL. `passed` is True if the rest of piece `k` is known to contain no impact.
    """
    while True:
        if s[SIDE + i] == 0.0:
            k = _lift(s, i, k, count, points, blocks, wall)
            passed = False
            if k < 0:
                return k
        if not passed:
            end = s[END_U + i]
            if end <= 0.0:
                return k
            if s[END_V + i] > 0.0:
                pushed = s[STRENGTH + i] * blocks[(k + 1) // BLOCK, HIGHEST]
                turns = s[V + i] < 0.0 or s[U + i] - 1.0 - s[PUSH + i] < 0.0
                if turns and end <= 0.51 * s[LEFT + i] ** 2 * max(pushed - 1.0, 0.0):
                    return k
        if peaks and s[V + i] > 0.0 > s[END_V + i]:
            _raise_peak(s, i, s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i])
        k = _fly(s, i, k + 1, count, points, rows, blocks, peaks)
        if k < 0:
            return k
        passed = False


@njit(inline="always", _nrt=False)
def _impact(s, i, k, points, wall, peaks):
    """Apply the next impact within piece `k`; return True if the block reaches the end of the piece without one."""
    u, v, push, rate, left = s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i]
    tau = s[TAU + i]
    turn = 1.0 if wall else -1.0
    solved = s[END_U + i] <= 0.0 and tau >= 0.0
    if peaks and v > 0.0:
        _raise_peak(s, i, u, v, push, rate, left)
    if not solved:
        bend, twist = u - 1.0 - push, v - rate
        tau = first_impact(u, v, bend, twist, left)
        if tau < 0.0:
            return True
        s[AFTER + i] = s[RESTITUTION + i] * max(-motion_at(tau, u, v, bend, twist)[1], 0.0)
    push, left, v = turn * (push + rate * tau), left - tau, s[AFTER + i]
    s[U + i], s[V + i], s[PUSH + i], s[RATE + i], s[LEFT + i] = 0.0, v, push, turn * rate, left
    s[SIDE + i] *= turn
    margin = 1.0 - max(lifting(push, wall), s[STRENGTH + i] * points[k + 1, LIFTING])
    # It rests if its half-cycles end in this piece: the first lasts at most 2 u'/margin, each C times the one before.
    if v <= SLOWEST or 2.0 * v < margin * (1.0 - s[RESTITUTION + i]) * left:
        s[PUSH + i], s[RATE + i] = s[SIDE + i] * push, s[SIDE + i] * turn * rate
        s[SIDE + i] = 0.0
    elif solved:
        s[END_U + i], s[END_V + i] = s[NEXT_U + i], s[NEXT_V + i]
    else:
        _end_of_piece(s, i)
    return False


@njit(_nrt=False)
def _peak_on_still_ground(u, v, restitution):
    """Return the largest u of the motion on still ground from u and u' = `v`; inf if the block overturns."""
    # (1 - u)^2 - u'^2 is constant: its value is (1 - u)^2 at the top, 1 - u'^2 at the impact.
    kept = (1.0 - u) ** 2 - v * v
    after = restitution * math.sqrt(max(1.0 - kept, 0.0))
    if after > 1.0 or u - 1.0 + v > 0.0:
        return np.inf
    top = max(kept, 0.0) if v > 0.0 else 1.0
    return 1.0 - math.sqrt(min(top, 1.0 - after * after))


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
                passed = _impact(s, i, k, points, wall, peaks)
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
                    busy += 1
                    break
                _store(s, i, state[lane_of[i]], k, final)
                lane_of[i] = -1
            piece[i] = k
        _solve_impacts(s, 1.0 if wall else -1.0)


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
        own[0] = max(own[0], _peak_on_still_ground(own[1], own[2], s[RESTITUTION + i]))
    if status == ENDED:
        own[3] = np.nan
