"""A curve in time as the extremes of each of many columns, in numbers of 16 bits that the script of the page reads."""

from __future__ import annotations

import base64
from dataclasses import dataclass

import numpy as np

__all__ = ["COLUMNS", "Columns", "packed"]

#: Columns of a stretch of time, more than a screen shows.
COLUMNS = 1500

#: The largest 16-bit number, and the one that stands for no value.
LARGEST, NONE = 32767, -32768


@dataclass(frozen=True)
class Columns:
    """A stretch of time from `start` to `end` [s], divided into `count` columns of one width."""

    start: float
    end: float
    count: int

    def extremes(self, time: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(2, count) smallest and largest value of each column; of one without a sample the value before it.

        NaN where all of a column is NaN, and before and after the first and the last value.
        """
        edges = np.linspace(self.start, self.end, self.count + 1)
        first = np.searchsorted(time, edges - 1e-9 * self.end)
        inside = values[: max(int(first[-1]), 1)]
        places = np.minimum(first[:-1], inside.size - 1)
        found = np.stack([one.reduceat(inside, places) for one in (np.fmin, np.fmax)])
        found[:, edges[:-1] > time[-1]] = np.nan
        return found


def packed(extremes: np.ndarray) -> dict[str, float | str]:
    """Extremes as JSON: base64 of int16, all minima before all maxima, and the value of one unit."""
    largest = float(np.nanmax(np.abs(extremes), initial=0.0))
    scale = largest / LARGEST or 1.0
    whole = np.where(np.isnan(extremes), NONE, np.rint(extremes / scale))
    return {"scale": scale, "data": base64.b64encode(whole.astype("<i2").tobytes()).decode("ascii")}
