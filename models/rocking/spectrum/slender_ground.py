"""Tables of a ground motion for the motion of slender blocks of one frequency parameter p (:mod:`.slender`).

.. note:: In tau = p t the ground acceleration a_g is linear between nodes, which are at most `LONGEST` apart. With
   H(tau) and G(tau), the impulses before and after tau weighted by e^-(distance),

   H = integral of e^-(tau - t) a_g(t) dt to tau,  G = integral of e^-(t - tau) a_g(t) dt from tau on,

   the particular solution Q = (G + H)/2 satisfies Q'' = Q - a_g and Q' = (G - H)/2, so Q + Q' = G and Q - Q' = H.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from rocking.kernel_cache import njit
from rocking.spectrum.slender_piece import LONGEST, hyperbolic

#: Number of nodes in a group; the nodes of a group are searched together.
BLOCK = 16
#: Number of pieces in one set of tables, so that records of days need no more memory than those of minutes.
AT_ONCE = 2**16


#: Columns of `Tables.points`. Of the piece after each node: its length in tau, a_g at its start [m/s2] and the slope of
#: a_g with tau. Of each node: Q and Q' [m/s2], e^tau and e^-tau from the start of its group, and the acceleration that
#: can lift a block at rest [m/s2].
LENGTH, START, SLOPE, RESPONSE, SPEED, UP, DOWN, LIFTING = range(8)
#: Columns of `Tables.blocks`, for each group: e^tau over the group and its reciprocal; the largest LIFTING in the group
#: and at the node before it; 1.01 h^2/2, a bound of cosh h - 1, for the longest piece that ends in the group; the
#: largest abs(a_g) of all; the least and the largest Q; from the group on, upper bounds of -G, of G (AHEAD + 1) and of
#: the integral of abs(a_g). Those from AHEAD on, at the first group, are `left` of the tables before.
GROWTH, DECAY, HIGHEST, REACH, STRONGEST, LEAST, MOST, AHEAD, _, IMPULSE = range(10)


class Tables(NamedTuple):
    """Ground motion and solution Q at n nodes, in b groups of `BLOCK` nodes; nodes after the last piece are empty."""

    pieces: int  #: number of pieces
    points: np.ndarray  #: (n, 8)
    rows: np.ndarray  #: (b, 5, `BLOCK`) of each group: Q, Q', e^tau, e^-tau, and a_g at the start of the piece before
    blocks: np.ndarray  #: (b, 10)


@njit(inline="always", _nrt=False)
def lifting(ground, wall):
    """Return abs(ground), or zero if it pushes towards the wall and thus cannot lift a resting block."""
    return max(-ground, 0.0) if wall else abs(ground)


@njit(inline="always", _nrt=False)
def search(row, begin, force, grow, fall, near, fastest):
    """Return twice the number of the first node after `begin` at which u is at most 0, plus 1 if it is small instead.

    u is small if it is at most `near` and u' from 0 to `fastest`, or, if u falls again, if u + h abs(u')/3 is at most a
    third of `near` for the length h = 2 near/fastest of a piece, at whose start u'' was not negative. The result is
    2 BLOCK if there is no such node.
    """
    # 2 % below h/3 (h = 2 near/fastest) and 5 % above near/3, because u'' is not quite linear.
    length = 0.65 * near / max(fastest, 1e-300)
    q, rate, up, down, start = row[0], row[1], row[2], row[3], row[4]
    found = 2 * BLOCK
    for j in range(BLOCK):
        grown, fallen = grow * up[j], fall * down[j]
        u, v = 1.0 + force * q[j] + grown + fallen, force * rate[j] + grown - fallen
        rises = (u <= near) & (v > 0.0) & (v <= fastest)
        falls = (v <= 0.0) & (u - length * v <= 0.35 * near) & (-force * start[j] >= 1.0 - near)
        small = rises | falls
        place = 2 * j if u <= 0.0 else 2 * j + 1
        found = min(found, place if ((u <= 0.0) | small) & (j > begin) else 2 * BLOCK)
    return found


@njit(inline="always", _nrt=False)
def exceeds(row, begin, force, grow, fall, high):
    """Return True if u exceeds `high` at a node after `begin`."""
    q, up, down = row[0], row[2], row[3]
    above = 0
    for j in range(BLOCK):
        above += (1.0 + force * q[j] + grow * up[j] + fall * down[j] > high) & (j > begin)
    return above > 0


@njit(_nrt=False)
def _fill_points(length, start, slope, past, future, points, rows):
    """Fill `rows` and columns of `points` up to DOWN; `past` is H at the first node, `future` G at the last node."""
    count, grown = length.shape[0], 1.0
    points[count, RESPONSE] = future
    for k in range(count - 1, -1, -1):
        even, odd = hyperbolic(length[k])
        decay = 1.0 - length[k] + even - odd
        # Integral of t e^-t over the piece; that of t e^-(h - t) is e^-h - 1 + h = even - odd below.
        ramp = length[k] * (length[k] - even + odd) - even + odd
        future = future * decay + start[k] * (1.0 - decay) + slope[k] * ramp
        points[k, RESPONSE] = future
    for k in range(points.shape[0]):
        future = points[k, RESPONSE]
        points[k, RESPONSE], points[k, SPEED] = 0.5 * (future + past), 0.5 * (future - past)
        grown = 1.0 if k % BLOCK == 0 else grown
        points[k, UP], points[k, DOWN] = grown, 1.0 / grown
        for row in range(4):
            rows[k // BLOCK, row, k % BLOCK] = points[k, RESPONSE + row]
        rows[k // BLOCK, 4, k % BLOCK] = start[k - 1] if 0 < k <= count else 0.0
        past_of_next = 0.0
        if k < count:
            points[k, LENGTH], points[k, START], points[k, SLOPE] = length[k], start[k], slope[k]
            even, odd = hyperbolic(length[k])
            decay = 1.0 - length[k] + even - odd
            past_of_next = past * decay + start[k] * (1.0 - decay) + slope[k] * (even - odd)
            grown *= 1.0 + length[k] + even + odd
        past = past_of_next


@njit(_nrt=False)
def _fill_blocks(ends, wall, left, points, blocks):
    """Fill `blocks` and column LIFTING of `points` from a_g at the `ends` of pieces; `left`: AHEAD to IMPULSE after."""
    count, push, length, longest, strongest, largest = ends.shape[0], 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(points.shape[0]):
        block, before, even, odd = k // BLOCK, push, 0.0, 0.0
        if k % BLOCK == 0:
            blocks[block, REACH], blocks[block, IMPULSE] = 0.0, 0.0
            blocks[block, LEAST], blocks[block, MOST] = points[k, RESPONSE], points[k, RESPONSE]
        blocks[block, LEAST] = min(blocks[block, LEAST], points[k, RESPONSE])
        blocks[block, MOST] = max(blocks[block, MOST], points[k, RESPONSE])
        blocks[block, REACH] = max(blocks[block, REACH], 0.505 * length**2)
        push, length = 0.0, points[k, LENGTH]
        if k < count:
            push = lifting(points[k, START], wall)
            longest, strongest = max(longest, points[k, LENGTH]), max(strongest, abs(points[k, START]), abs(ends[k]))
            blocks[block, IMPULSE] += 0.5 * points[k, LENGTH] * (abs(points[k, START]) + abs(ends[k]))
            even, odd = hyperbolic(points[k, LENGTH])
        if 0 < k <= count:
            push = max(push, lifting(ends[k - 1], wall))
        points[k, LIFTING] = push
        after = points[k, RESPONSE] + points[k, SPEED]
        largest = max(largest, abs(after))
        if k % BLOCK == 0:
            blocks[block, HIGHEST], blocks[block, AHEAD], blocks[block, AHEAD + 1] = before, -after, after
        blocks[block, HIGHEST] = max(blocks[block, HIGHEST], push)
        blocks[block, AHEAD] = max(blocks[block, AHEAD], -after)
        blocks[block, AHEAD + 1] = max(blocks[block, AHEAD + 1], after)
        blocks[block, GROWTH] = points[k, UP] * (1.0 + points[k, LENGTH] + even + odd)
    minus, plus, later = max(left[0], 0.0), max(left[1], 0.0), left[2]
    # Between nodes G differs from the nearer one by at most h/2 abs(G - a_g), with abs(G) <= largest + strongest.
    slack = 0.5 * longest * (largest + 2.0 * strongest)
    for block in range(blocks.shape[0] - 1, -1, -1):
        minus, plus = max(minus, blocks[block, AHEAD]), max(plus, blocks[block, AHEAD + 1])
        blocks[block, AHEAD], blocks[block, AHEAD + 1] = minus + slack, plus + slack
        later += blocks[block, IMPULSE]
        blocks[block, STRONGEST], blocks[block, IMPULSE] = strongest, later
        blocks[block, DECAY] = 1.0 / blocks[block, GROWTH]


class SlenderGround:
    """A ground motion for blocks of one p: lengths [s] of pieces (k,) and the accelerations at both ends [m/s2].

    `wall` is True for blocks beside a wall, which only an acceleration below zero can lift.
    """

    def __init__(self, pieces: Sequence[np.ndarray], rate: float, wall: bool) -> None:
        self.pieces, self.rate, self.wall = pieces, rate, wall
        count = pieces[0].size
        self._divided = np.max(pieces[0]) * rate > LONGEST
        if self._divided:
            parts = np.maximum(np.ceil(pieces[0] * rate / LONGEST), 1.0)
            self._starts = np.append(0.0, np.cumsum(parts)).astype(np.int64)
            count = int(self._starts[-1])
            del parts
        self._count, self._firsts = count, range(0, count, AT_ONCE)
        # G at the end of each set of tables, and AHEAD to IMPULSE after it.
        self._after = [(0.0, np.zeros(3))]
        for first in reversed(self._firsts[1:]):
            tables = self._tables(first, 0.0, *self._after[0])
            left = tables.blocks[0, AHEAD:].copy()
            self._after.insert(0, (tables.points[0, RESPONSE] + tables.points[0, SPEED], left))
        self._single = self._tables(0, 0.0, *self._after[0]) if len(self._firsts) == 1 else None

    def __iter__(self) -> Iterator[tuple[Tables, bool]]:
        """Yield the tables of each part of the ground motion, and whether the part is the last one."""
        if self._single:
            yield self._single, True
            return
        past = 0.0
        for first, after in zip(self._firsts, self._after, strict=True):
            tables = self._tables(first, past, *after)
            past = tables.points[tables.pieces, RESPONSE] - tables.points[tables.pieces, SPEED]
            yield tables, first == self._firsts[-1]
            del tables

    def _tables(self, first: int, past: float, future: float, left: np.ndarray) -> Tables:
        """Return tables from piece `first` on; `past` is H before, `future` G and `left` AHEAD to IMPULSE after."""
        last = min(first + AT_ONCE, self._count)
        whole: Any = slice(first, last)
        parts, place = np.array(1), np.array(0)
        if self._divided:
            own = np.arange(first, last)
            whole = np.searchsorted(self._starts, own, side="right") - 1
            parts = self._starts[whole + 1] - self._starts[whole]
            place = own - self._starts[whole]
        seconds, begin, end = (one[whole] for one in self.pieces)
        length, step = seconds * self.rate / parts, (end - begin) / parts
        start = begin + step * place
        ends = np.where(place + 1 == parts, end, start + step)
        slope = (ends - start) / length
        size = (length.size // BLOCK + 1) * BLOCK
        points, rows, blocks = (
            np.zeros((size, 8)),
            np.empty((size // BLOCK, 5, BLOCK)),
            np.empty((size // BLOCK, IMPULSE + 1)),
        )
        _fill_points(length, start, slope, past, future, points, rows)
        _fill_blocks(ends, self.wall, left, points, blocks)
        return Tables(length.size, points, rows, blocks)


@njit()
def largest_impulse(times: np.ndarray, ground: np.ndarray, rate: float) -> float:
    """Return the largest abs(E) of the weighted impulse E (march/demand.py) at the points of a piecewise linear a_g."""
    weighted, largest = 0.0, 0.0
    for i in range(times.shape[0] - 2, -1, -1):
        length = times[i + 1] - times[i]
        if length > 0.0:
            decay, whole, late = _weights(rate, length)
            weighted = decay * weighted + (whole - late) * ground[i] + late * ground[i + 1]
            largest = max(largest, abs(weighted))
    return largest


@njit()
def weighted_lobes(
    times: np.ndarray, ground: np.ndarray, rate: float, points: int, tops: np.ndarray, sizes: np.ndarray
) -> int:
    """Fill `tops` [s] and `sizes` [m/s] with the largest abs(E) of each lobe, the last lobe first; return their number.

    E is computed at the start of each piece of a_g and, if E has an extremum within the piece, at the start of each of
    `points` equal parts of it; zeros belong to no lobe. Between two zeros of a_g the sign of E changes at most once.
    """
    count, side, weighted = 0, 0.0, 0.0
    for i in range(times.shape[0] - 2, -1, -1):
        length, change = times[i + 1] - times[i], ground[i + 1] - ground[i]
        if length <= 0.0:
            continue
        decay, whole, late = _weights(rate, length)
        start = decay * weighted + whole * ground[i] + late * change
        # E' = p E - a_g is monotonic within a piece.
        parts = 1
        if (rate * start - ground[i]) * (rate * weighted - ground[i + 1]) < 0.0:
            parts = points
            decay, whole, late = _weights(rate, length / parts)
        step, rise = length / parts, change / parts
        for k in range(parts - 1, -1, -1):
            weighted = decay * weighted + whole * (ground[i] + rise * k) + late * rise
            if not abs(weighted) > 0.0:  # NaN, too
                continue
            here = np.sign(weighted)
            if here != side:
                if count == tops.size:
                    return count
                count, side = count + 1, here
            elif abs(weighted) < abs(sizes[count - 1]):
                continue
            tops[count - 1], sizes[count - 1] = times[i] + step * k, weighted
    return count


@njit(inline="always", _nrt=False)
def _weights(rate, length):
    """Return e^-(p h) of a part of length h, and the weights of a_g at its start and of the change of a_g within it."""
    lost = -np.expm1(-rate * length)
    whole = lost / rate
    return 1.0 - lost, whole, (whole - length * (1.0 - lost)) / (rate * length)
