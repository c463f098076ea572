"""Tables of a ground motion for the march of slender blocks of one frequency parameter p (:mod:`.slender`).

.. note:: In tau = p t the ground acceleration a_g is linear between nodes, which are at most `LONGEST` apart. With
   H(tau) and G(tau), the impulses before and after tau weighted by e^-(distance),

   H = integral of e^-(tau - t) a_g(t) dt to tau,  G = integral of e^-(t - tau) a_g(t) dt from tau on,

   the particular solution Q = (G + H)/2 satisfies Q'' = Q - a_g and Q' = (G - H)/2, so Q + Q' = G and Q - Q' = H.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

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
#: Columns of `Tables.blocks`, for each group: e^tau over the group; the largest LIFTING in the group and at the node
#: before it; cosh h - 1 of the longest piece of all; the largest abs(a_g) of all; upper bounds of -G, and of G (AHEAD +
#: 1), from the group on.
GROWTH, HIGHEST, REACH, STRONGEST, AHEAD = range(5)


class Tables(NamedTuple):
    """Ground motion and solution Q at n nodes, in b groups of `BLOCK` nodes; nodes after the last piece are empty."""

    pieces: int  #: number of pieces
    points: np.ndarray  #: (n, 8)
    rows: np.ndarray  #: (3, n) copy of Q, e^tau and e^-tau with contiguous rows
    blocks: np.ndarray  #: (b, 6)


@njit(_nrt=False)
def _impulses(length, start, slope, past, future):
    """Fill `past` with H and `future` with G at the nodes; H of the first node and G of the last one are given."""
    count = length.shape[0]
    for k in range(count):
        even, odd = hyperbolic(length[k])
        decay = 1.0 - length[k] + even - odd
        past[k + 1] = past[k] * decay + start[k] * (1.0 - decay) + slope[k] * (even - odd)
    for k in range(count - 1, -1, -1):
        even, odd = hyperbolic(length[k])
        decay = 1.0 - length[k] + even - odd
        ramp = length[k] * (length[k] - even + odd) - even + odd
        future[k] = future[k + 1] * decay + start[k] * (1.0 - decay) + slope[k] * ramp


@njit(_nrt=False)
def _exponentials(length, up, down, growth):
    """Fill `up`, `down` with e^tau, e^-tau from the start of each group of nodes, `growth` with e^tau at its end."""
    grown = 1.0
    for k in range(up.shape[0]):
        if k % BLOCK == 0:
            if k > 0:
                growth[k // BLOCK - 1] = grown
            grown = 1.0
        up[k], down[k] = grown, 1.0 / grown
        if k < length.shape[0]:
            even, odd = hyperbolic(length[k])
            grown *= 1.0 + length[k] + even + odd
    growth[-1] = grown


class SlenderGround:
    """A ground motion for blocks of one p: lengths [s] of pieces (k,) and the accelerations at both ends [m/s2].

    `wall` is True for blocks beside a wall, which only an acceleration below zero can lift.
    """

    def __init__(self, pieces: Sequence[np.ndarray], rate: float, wall: bool) -> None:
        self.pieces, self.rate, self.wall = pieces, rate, wall
        count = pieces[0].size
        self._divided = np.max(pieces[0]) * rate > LONGEST
        if self._divided:
            self._parts = np.maximum(np.ceil(pieces[0] * rate / LONGEST), 1.0).astype(np.int64)
            self._ends = np.cumsum(self._parts)
            count = int(self._ends[-1])
        self._count, self._firsts = count, range(0, count, AT_ONCE)
        # G at the end of each set of tables, and the largest -G and G after it.
        self._after = [(0.0, np.zeros(2))]
        for first in reversed(self._firsts[1:]):
            tables = self._tables(first, 0.0, *self._after[0])
            self._after.insert(0, (tables.points[0, RESPONSE] + tables.points[0, SPEED], tables.blocks[0, AHEAD:]))
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
        """Return tables from piece `first` on; `past` is H before them, `future` G after them, and `left` bounds G."""
        own = np.arange(first, min(first + AT_ONCE, self._count))
        whole, parts, place = own, np.ones_like(own), np.zeros_like(own)
        if self._divided:
            whole = np.searchsorted(self._ends, own, side="right")
            parts = self._parts[whole]
            place = own - (self._ends[whole] - parts)
        seconds, begin, end = (one[whole] for one in self.pieces)
        length, step = seconds * self.rate / parts, (end - begin) / parts
        start = begin + step * place
        ends = np.where(place + 1 == parts, end, start + step)
        slope = (ends - start) / length
        count = own.size
        size = (count // BLOCK + 1) * BLOCK
        before, after, up, down, push = np.zeros((5, size))
        growth = np.zeros(size // BLOCK)
        before[0], after[count] = past, future
        _impulses(length, start, slope, before, after)
        _exponentials(length, up, down, growth)
        push[:count] = self._push(start)
        np.maximum(push[1 : count + 1], self._push(ends), out=push[1 : count + 1])
        highest = np.max(np.stack([push, np.append(0.0, push[:-1])]).reshape(2, -1, BLOCK), axis=(0, 2))
        sides = np.stack([-after, after]).reshape(2, -1, BLOCK).max(axis=2)
        sides[:, -1] = np.maximum(sides[:, -1], left)
        longest = np.max(length)
        reach = np.full(growth.size, 0.505 * longest**2)
        left = np.maximum(np.maximum.accumulate(sides[:, ::-1], axis=1)[:, ::-1], 0.0)
        strongest = np.full(growth.size, max(np.max(np.abs(start)), np.max(np.abs(ends))))
        slack = 0.5 * longest * (np.max(np.abs(after)) + np.max(np.abs(start)) + np.max(np.abs(ends)))
        points = np.zeros((size, 8))
        points[:count, :3] = np.stack([length, start, slope], axis=1)
        points[:, 3:] = np.stack([0.5 * (after + before), 0.5 * (after - before), up, down, push], axis=1)
        blocks = np.vstack([growth, highest, reach, strongest, left + slack]).T.copy()
        return Tables(count, points, points[:, [RESPONSE, UP, DOWN]].T.copy(), blocks)

    def _push(self, ground: np.ndarray) -> np.ndarray:
        return np.maximum(-ground, 0.0) if self.wall else np.abs(ground)


@njit()
def weighted_impulse(times: np.ndarray, ground: np.ndarray, rate: float, last: float) -> np.ndarray:
    """Return the weighted impulse E (march/demand.py) at points of a piecewise linear a_g; `last` is its last value."""
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
    """Return the index of the largest abs(E) in each run of values of one sign, in order; zeros belong to no run."""
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
