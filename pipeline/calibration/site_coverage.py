"""How well a design sequence serves records it has not seen: one event after the other left out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rockpulse.calibration.site_design import BEYOND, SiteSample, covered, design_sequence
from rockpulse.calibration.site_statistics import share_interval
from rockpulse.errors import RecordRefused

__all__ = ["Coverage", "coverage_of", "leave_one_event_out"]


@dataclass(frozen=True, eq=False)
class Coverage:
    """Coverage by designs that were fitted without the event they are judged on.

    Attributes
    ----------
    covered : (n, m) ndarray
        1 covered, 0 not, 2 where that design overturns the block; NaN where the pair does not count, or no design could
        be made without its event.
    main : (n,) ndarray
        Main impulse of the design without the record's event [m/s]; NaN without a design.
    """

    covered: np.ndarray
    main: np.ndarray


def leave_one_event_out(sample: SiteSample, quantile: float, design: str) -> Coverage:
    """Judge the design sequence of each set of all events but one on the records of that one.

    Parameters
    ----------
    sample : SiteSample
        n records, m blocks.
    quantile, design
        As in :func:`rockpulse.calibration.site_design.design_sequence`.

    Returns
    -------
    Coverage
        NaN throughout for a single event: nothing can be left out.
    """
    marks, mains = np.full(sample.peaks.shape, math.nan), np.full(sample.weights.size, math.nan)
    for event in np.unique(sample.events):
        out = sample.events == event
        if not np.any(sample.weights[~out] > 0.0):
            continue
        try:
            sequence = design_sequence(sample.part(~out), quantile, design)
        except RecordRefused:  # the others do not make a design: these records stay unjudged
            continue
        marks[out] = covered(sample.part(out), sequence)
        mains[out] = sequence.main
    return Coverage(marks, mains)


def coverage_of(
    marks: np.ndarray, sample: SiteSample, confidence: float, standing: bool = True
) -> tuple[float, float, float]:
    """Weighted share of covered pairs of record and block, with its event-clustered interval.

    Parameters
    ----------
    marks : (n, m) ndarray
        As :attr:`Coverage.covered`.
    sample : SiteSample
        Weights and events of the records.
    confidence : float
        Of the interval [-].
    standing : bool
        Of the blocks that the design leaves standing; else of all, those that it overturns being covered.

    Returns
    -------
    share, lower, upper : float
        NaN where nothing counts; the ends also with a single event.
    """
    counted = ~np.isnan(marks) & (sample.weights[:, np.newaxis] > 0.0)
    if standing:
        counted &= marks != BEYOND
    rows = np.nonzero(counted)[0]
    if rows.size == 0:
        return math.nan, math.nan, math.nan
    return share_interval(np.minimum(marks[counted], 1.0), sample.weights[rows], sample.events[rows], confidence)
