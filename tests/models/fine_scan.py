"""The intervals of a search against a brute-force scan many times finer, on seeded random blocks and motions."""

from typing import NamedTuple

import numpy as np

from rocking import Block, Outcome, critical_scale, recorded_response
from synthetic import synthetic_lanes, synthetic_motion

#: Factors of the search, and steps of the fine scan in one of its steps.
POINTS, FINER = 64, 20
FACTOR_MAX, DT = 10.0, 0.01


class Comparison(NamedTuple):
    """Counts over the cases."""

    wide: int  #: intervals of the fine scan that are wider than the step of the search
    lost: int  #: of them, not found
    own: int  #: ends of them that the search has where the fine scan has them
    joined: int  #: ends that the search has further out, across gaps narrower than its step
    finer: int  #: ends that the search has at a band, or a gap, that is narrower than the step of the fine scan
    wrong: int  #: ends that the search has across a wider gap
    narrow: int  #: narrower intervals
    missed: int  #: of them, not found


def comparisons(seed, count, equation="nonlinear"):
    """Comparison of every one of `count` blocks under the motion of a seed, and its safety factor over the fine one."""
    drawn = synthetic_lanes(seed, count)
    blocks = Block.from_parameters(drawn.p, drawn.alpha, drawn.restitution)
    motion = synthetic_motion(seed, duration=20.0, dt=DT)
    found = critical_scale(blocks, motion, DT, equation, factor_max=FACTOR_MAX, points=POINTS, threads=1)
    threshold = np.tan(blocks.alpha_c) if equation == "nonlinear" else blocks.alpha_c
    start = blocks.gravity * threshold / np.max(np.abs(motion))
    factors = np.geomspace(start, FACTOR_MAX, FINER * (POINTS - 1) + 1)
    lanes = blocks.take(np.tile(np.arange(blocks.shape[0]), factors.shape[0]))
    answer = recorded_response(lanes, motion, DT, equation, block_scale=factors.reshape(-1), threads=1)
    over = (answer.outcome == Outcome.OVERTURNS).reshape(factors.shape)
    first = np.where(over.any(axis=0), factors[np.argmax(over, axis=0), np.arange(count)], np.inf)
    late = np.divide(found.safety_factor, first, out=np.ones(count), where=np.isfinite(first))
    return [
        (compare(factors[:, k], over[:, k], found.lower[found.lane == k], found.upper[found.lane == k]), late[k])
        for k in range(count)
    ]


def compare(factors, over, lower, upper, finer=FINER):
    """What a search has found against a fine scan of the same lane."""
    edges = np.flatnonzero(np.diff(over.astype(int), prepend=0, append=0))
    begins, ends = edges[::2], edges[1::2] - 1
    wide = ends - begins >= finer
    stands, falls = ends[:-1] + 1, begins[1:] - 1  # first and last factor of every gap between two intervals
    narrow_gap = falls - stands + 2 <= finer
    counts = dict.fromkeys(Comparison._fields, 0)
    counts |= {"wide": int(wide.sum()), "narrow": int((~wide).sum())}
    for begin, end in zip(begins[wide], ends[wide], strict=True):
        holds = (lower <= factors[-(-begin // finer) * finer]) & (upper >= factors[end // finer * finer] * (1 - 1e-12))
        if not holds.any():
            counts["lost"] += 1
            continue
        one = int(np.argmax(holds))
        # Gaps of the fine scan between this end and that of the search, which it has passed over.
        below = (stands < begin) & (factors[stands] > lower[one])
        above = (falls > end) & (factors[falls] < upper[one])
        # The last factor before the interval and the first one behind it; at the ends of the scan there is none.
        low = factors[begin - 1] if begin else 0.0
        high = factors[end + 1] if end + 1 < factors.size else np.inf
        for own, passed in (
            (low < lower[one] <= factors[begin] * (1.0 + 1e-6), below),
            (factors[end] * (1.0 - 1e-6) <= upper[one] < high, above),
        ):
            kind = "own" if own else "finer" if not passed.any() else "joined"
            counts[kind if narrow_gap[passed].all() else "wrong"] += 1
    for begin, end in zip(begins[~wide], ends[~wide], strict=True):
        low, high = factors[max(begin - 1, 0)], factors[min(end + 1, factors.size - 1)]
        counts["missed"] += not np.any((lower <= high) & (upper >= low))
    return Comparison(**counts)


def total(found):
    """Counts of all cases together, and the ratios of safety factors."""
    return Comparison(*np.sum([counts for counts, _ in found], axis=0).tolist()), np.array([late for _, late in found])
