"""Median and largest over direction, as RotD50 and RotD100 are of response spectra (Boore 2010).

.. note:: A direction without an answer (unresolved, or not assessed) may stand for any value from 0 to overturning. A
   median that it could change, and a largest or smallest value that it could exceed, is NaN.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.record.measures import PGA
from rockpulse.storage.variables.assessment import DIRECTIONS
from rockpulse.storage.variables.probability import MEAN


def direction_statistics(
    summary: xr.Dataset,
    azimuths: Sequence[float] | np.ndarray,
    pairs: Mapping[str, Sequence[str]],
    with_probability: bool = False,
) -> xr.Dataset:
    """The node /directions of the results, from /summary, in which the directions are records.

    `azimuths` are the d directions of the sweep [degrees]; `pairs` has the name of each pair, and the ids of its
    records in the d directions. A pair is left out if none of them is a record. `with_probability` adds the mean over
    direction of the probability of overturning.

    References
    ----------
    Boore, D. M. (2010), Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal
    components of motion, Bull. Seismol. Soc. Am. 100(4), 1830-1835, doi:10.1785/0120090400.
    """
    place = {str(record): number for number, record in enumerate(summary["record"].values)}
    pairs = {pair: records for pair, records in pairs.items() if any(record in place for record in records)}
    index = np.array([[place.get(record, -1) for record in records] for records in pairs.values()], dtype=int)
    index = index.reshape(len(pairs), len(azimuths))

    def swept(name: str) -> np.ndarray:
        """(pair, direction, ...) values; NaN where the direction was not assessed."""
        values = summary[name].values.astype(float)
        return np.concatenate([values, np.full((1, *values.shape[1:]), np.nan)])[index]

    directions = np.asarray(azimuths, dtype=float)
    measures: dict[str, Any] = {"pair": list(pairs), "direction_azimuth": directions, "record_index": index}
    for name, measure in ((PGA, swept(PGA)), ("main_impulse", swept("main_impulse"))):
        largest, at = largest_over(measure)
        measures |= {f"{name}_median": median_over(measure), f"{name}_largest": largest}
        measures[f"{name}_azimuth"] = _at(directions, at)

    peaks, factors = swept("peak_rotation_ratio"), swept("safety_factor")
    over = swept("outcome") == Outcome.OVERTURNS
    # Of several directions that overturn the one that does it first.
    largest, at = largest_over(
        peaks, first=np.where(over, np.nan_to_num(swept("overturning_time"), nan=np.inf), np.inf)
    )
    smallest, factor_at = smallest_over(factors)
    answers = {
        "median_rotation_ratio": median_over(peaks),
        "largest_rotation_ratio": largest,
        "largest_azimuth": _at(directions, at),
        "overturning_share": over.mean(axis=1),
        "unanswered_count": np.isnan(peaks).sum(axis=1),
        "smallest_safety_factor": smallest,
        "safety_factor_azimuth": _at(directions, factor_at),
    }
    dims = dict.fromkeys(answers, ("pair", *(str(dim) for dim in summary["peak_rotation_ratio"].dims[1:])))
    if with_probability:
        answers[MEAN] = swept("overturning_probability").mean(axis=1)
        dims[MEAN] = ("pair", *(str(dim) for dim in summary["overturning_probability"].dims[1:]))
    values = measures | answers
    variables = {name: one.variable(values[name], dims.get(name)) for name, one in DIRECTIONS.items() if name in values}
    return xr.Dataset(variables, {"pair": variables.pop("pair"), "block": summary["block"], "model": summary["model"]})


def median_over(values: np.ndarray) -> np.ndarray:
    """Median over the second of the dimensions (a, d, ...); inf where half of the directions overturn.

    The values are not negative, inf where the block overturns, NaN where there is no answer; the median is NaN where
    the missing answers could change it.

    Examples
    --------
    >>> median_over(np.array([[0.1, 0.2, 0.3], [0.1, 0.2, np.nan], [0.2, 0.2, np.nan], [0.2, np.inf, np.inf]])).tolist()
    [0.2, nan, 0.2, inf]
    """
    unknown = np.isnan(values)
    low, high = (np.median(np.where(unknown, bound, values), axis=1) for bound in (0.0, np.inf))
    return np.where(low == high, low, np.nan)


def largest_over(values: np.ndarray, first: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Largest value over the second of the dimensions (a, d, ...), and its place.

    The largest is inf where one is inf, else NaN where an answer is missing, and its place then -1. Of several places
    with inf it is the one where `first`, of the same shape, is smallest; without `first` it is the first place.
    """
    endless = np.isposinf(values)
    largest = np.where(endless.any(axis=1), np.inf, values.max(axis=1))
    key = np.where(endless, np.zeros_like(values) if first is None else first, np.inf)
    among = np.argmax(endless & (key == key.min(axis=1, keepdims=True)), axis=1)
    place = np.where(endless.any(axis=1), among, np.argmax(values, axis=1))
    return largest, np.where(np.isnan(largest), -1, place)


def smallest_over(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest value over the second of the dimensions (a, d, ...), and its place: -1 where it is NaN or inf.

    The values are inf where the search found none, NaN where there is no answer; the smallest is NaN where one is.
    """
    smallest = values.min(axis=1)
    return smallest, np.where(np.isfinite(smallest), np.argmin(values, axis=1), -1)


def _at(azimuths: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.append(azimuths, np.nan)[place]
