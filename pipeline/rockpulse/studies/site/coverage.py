"""Test of a design sequence on records it has not seen: one event after the other is left out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.studies.site.design import BEYOND, SiteSample, covered, design_sequence
from rockpulse.studies.site.statistics import share_interval


@dataclass(frozen=True, eq=False)
class Coverage:
    """Coverage by designs that were fitted without the event they are judged on.

    `covered` (n, m) is 1 for covered, 0 for not, 2 where that design overturns the block; NaN where the pair does not
    count, or no design could be made without its event. `main` (n,) is the main impulse of the design without the
    record's event [m/s]; NaN without a design.
    """

    covered: np.ndarray
    main: np.ndarray


def leave_one_event_out(sample: SiteSample, quantile: float, design: str) -> Coverage:
    """Judge the design sequence of each set of all events but one on the records of that one.

    The options are those of :func:`rockpulse.studies.site.design.design_sequence`. NaN throughout for a single event,
    because no event can be left out then.
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
    """Pairs (n, m) of record and block on which a coverage rests; the arguments are those of :func:`coverage_of`."""
    counted: np.ndarray = ~np.isnan(marks) & (sample.weights[:, np.newaxis] > 0.0)
    if standing:
        counted &= marks != BEYOND
    return counted


def coverage_of(
    marks: np.ndarray, sample: SiteSample, confidence: float, standing: bool = True
) -> tuple[float, float, float]:
    """Weighted share of covered pairs of record and block, with both ends of its event-clustered interval.

    `marks` are :attr:`Coverage.covered`. With `standing` only the blocks count that the design leaves standing; else
    all, those that it overturns being covered. NaN where no pair counts; the ends also with a single event.
    """
    counted = judged(marks, sample, standing)
    rows = np.nonzero(counted)[0]
    if rows.size == 0:
        return math.nan, math.nan, math.nan
    return share_interval(np.minimum(marks[counted], 1.0), sample.weights[rows], sample.events[rows], confidence)


def unjudged_events(found: Coverage, sample: SiteSample) -> dict[int, str]:
    """Events of a weight above zero on which the coverage of standing blocks does not rest, with the reason by number.

    The reason is a code of a remark.
    """
    rests = np.any(judged(found.covered, sample), axis=1)
    lifts = np.any(~np.isnan(sample.peaks), axis=1)
    reasons = {}
    for event in np.unique(sample.events[sample.weights > 0.0]):
        rows = (sample.events == event) & (sample.weights > 0.0)
        if np.any(rests[rows]):
            continue
        if not np.any(lifts[rows]):
            reasons[int(event)] = "unlifted"
        elif np.isnan(found.main[rows]).all():
            reasons[int(event)] = "no_design"
        else:
            reasons[int(event)] = "overturning_design"
    return reasons
