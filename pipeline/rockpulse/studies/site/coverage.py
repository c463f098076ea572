"""How well a design sequence serves records it has not seen: one event after the other left out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.studies.site.design import BEYOND, SiteSample, covered, design_sequence
from rockpulse.studies.site.statistics import share_interval

__all__ = ["Coverage", "coverage_of", "judged", "leave_one_event_out", "unjudged_events"]


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
        As in :func:`rockpulse.studies.site.design.design_sequence`.

    Returns
    -------
    Coverage
        NaN throughout for a single event: nothing can be left out.
    """
    marks, mains = np.full(sample.peaks.shape, math.nan), np.full(sample.weights.size, math.nan)
    for event in np.unique(sample.events):
        out = sample.events == event
        others = ~out & (sample.weights > 0.0)
        if not np.any(others):
            continue
        try:
            sequence = design_sequence(sample.part(others), quantile, design)
        except RecordRefused:  # the others do not make a design: these records stay unjudged
            continue
        marks[out] = covered(sample.part(out), sequence)
        mains[out] = sequence.main
    return Coverage(marks, mains)


def judged(marks: np.ndarray, sample: SiteSample, standing: bool = True) -> np.ndarray:
    """Pairs of record and block that a coverage rests on.

    Parameters
    ----------
    marks, sample, standing
        As in :func:`coverage_of`.

    Returns
    -------
    (n, m) ndarray of bool
    """
    counted: np.ndarray = ~np.isnan(marks) & (sample.weights[:, np.newaxis] > 0.0)
    if standing:
        counted &= marks != BEYOND
    return counted


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
    counted = judged(marks, sample, standing)
    rows = np.nonzero(counted)[0]
    if rows.size == 0:
        return math.nan, math.nan, math.nan
    return share_interval(np.minimum(marks[counted], 1.0), sample.weights[rows], sample.events[rows], confidence)


def unjudged_events(found: Coverage, sample: SiteSample) -> dict[int, str]:
    """Events of a weight above zero that the coverage of standing blocks does not rest on, and why.

    Parameters
    ----------
    found : Coverage
        Of the sample.
    sample : SiteSample
        n records, m blocks.

    Returns
    -------
    dict of int to str
        Reason by number of the event, to stand behind its name.
    """
    rests = np.any(judged(found.covered, sample), axis=1)
    lifts = np.any(~np.isnan(sample.peaks), axis=1)
    reasons = {}
    for event in np.unique(sample.events[sample.weights > 0.0]):
        rows = (sample.events == event) & (sample.weights > 0.0)
        if np.any(rests[rows]):
            continue
        if not np.any(lifts[rows]):
            reasons[int(event)] = "lifts no block"
        elif np.isnan(found.main[rows]).all():
            reasons[int(event)] = "the others alone make no design"
        else:
            reasons[int(event)] = "the design of the others overturns all that it lifts"
    return reasons
