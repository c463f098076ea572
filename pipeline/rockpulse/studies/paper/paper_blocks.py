"""The two blocks of Figure 5, and the count of half-cycles of a motion under a limited input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.response import Outcome, Response

__all__ = ["DURATION", "GRAVITY", "RADII", "RESTITUTIONS", "WIDTH", "half_cycle_counts", "paper_block"]

#: Gravity that the numbers of the paper follow [m/s2].
GRAVITY = 9.81

#: 2b of both blocks [m].
WIDTH = 1.0

#: R [m]; the second block is the more slender one.
RADII = {"A": 2.0, "B": 4.0}

#: C of section 4.
RESTITUTIONS = (0.9, 0.6)

#: Length of the input [s].
DURATION = 20.0


def paper_block(name: str, restitution: Any) -> Block:
    """Block "A" or "B" of Figure 5: 2b = 1 m with R = 2 m or 4 m; the restitution is C [-] or "housner".

    Examples
    --------
    >>> round(float(paper_block("A", 0.9).p), 7)
    1.9180068
    """
    half_width = 0.5 * WIDTH
    height = math.sqrt((RADII[name] - half_width) * (RADII[name] + half_width))
    return Block(half_width=half_width, half_height=height, restitution=restitution, gravity=GRAVITY)


def half_cycle_counts(response: Response, duration: float) -> np.ndarray:
    """Number of half-cycles that a main impulse starts in every lane, up to and with the one that overturns.

    The response has the whole table, and `duration` is the finite length of the input [s]. The table ends where the
    motion repeats itself; the half-cycles from there on are as long as its last one.
    """
    assert response.half_cycles is not None
    durations = response.half_cycles.duration
    listed = np.sum(np.isfinite(durations), axis=0)
    last = np.take_along_axis(durations, np.maximum(listed - 1, 0)[None], axis=0)[0]
    with np.errstate(invalid="ignore"):
        left = np.ceil((duration - np.nansum(np.where(np.isfinite(durations), durations, 0.0), axis=0)) / last)
    repeated = listed + np.maximum(np.nan_to_num(left), 0.0)
    overturned = np.asarray(response.outcome) == Outcome.OVERTURNS
    return np.where(overturned, response.overturning_half_cycle, repeated).astype(np.int64)
