"""Remarks on a site: what its set of records is too small or too odd to tell."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from rockpulse.studies.site.records import USUAL_FACTORS

#: With fewer than these the intervals are those of a guess, and are called so.
FEWEST_RECORDS, FEWEST_EVENTS = 10, 5

#: A coverage that is known no better than this is hardly known [-].
WIDE = 0.5

#: Quantiles that fewer records than this lie beyond rest on the strongest or weakest of them.
FEWEST_BEYOND = 2.0

#: Names that a remark lists.
LISTED = 5

#: Blocks whose records lift so few pairs say little.
FEW_LIFTED = 0.1


def site_remarks(
    site: Mapping[str, Any],
    factors: np.ndarray,
    events: np.ndarray,
    weights: np.ndarray,
    unjudged: Mapping[str, str],
) -> list[str]:
    """The remarks of a site file, the gravest first and each without line breaks.

    `site` holds the scalars of the file, with `design_upper` (of I) and `share_below`, the share that the design covers
    just below I; `factors`, `events` and `weights` are those of the records; `unjudged` names the events that the
    coverage does not rest on, and says why.
    """
    records, count, quantile = site["record_count"], site["event_count"], site["quantile"]
    remarks = []
    if count == 1:
        only = next(event for event, weight in zip(events, weights, strict=True) if weight > 0.0)
        remarks.append(
            f"ONE EVENT ({only}): nothing can be left out, so the coverage of other earthquakes is not known, nor is "
            "any interval clustered by event; the dispersion is that within this event. The design describes these "
            "records, not the site"
        )
    elif site["lifting_events"] < FEWEST_EVENTS:
        lifting = (
            ""
            if site["lifting_events"] == count
            else f", only {site['lifting_events']} with a record that lifts a block"
        )
        remarks.append(
            f"FEW EVENTS: {count}{lifting}, fewer than {FEWEST_EVENTS}: the intervals are wide because little is "
            "known (those of two or three events may come out narrow by chance), and even so they take the parameters "
            "for lognormal; correlations of so few mean little; take records of more earthquakes"
        )
    if records < FEWEST_RECORDS:
        remarks.append(f"FEW RECORDS: {records}, fewer than {FEWEST_RECORDS}: {_tail(records, quantile)}")
    if site["unresolved_share"] > 0.0:
        remarks.append(
            f"{site['unresolved_share']:.1%} of the pairs of record and block are unresolved (a vertical acceleration "
            "that cancels gravity, for one) and count as overturned, for nothing else is sure to cover them"
        )
    if site["standing_share"] == 0.0:
        remarks.append(
            "the design overturns every block that a record sets rocking: no rotation is left to be covered, and the "
            "design says no more than that; take sturdier blocks or a lower quantile"
        )
    if site["design_set_by"]:
        left = "no block is left" if site["standing_share"] == 0.0 else "it is no longer among them"
        remarks.append(
            f"I is set by the overturning of {site['design_set_by']}: just below it the design covers "
            f"{site['share_below']:.0%} of the rotations of the blocks left standing, and at it {left}; with sturdier "
            "blocks in the list I may be larger"
        )
    if math.isinf(site["design_upper"]):
        remarks.append(
            "the interval of I is open: in the resamples I stops where a block overturns, which tells of the block and "
            "not of the records"
        )
    if count > 1:
        remarks += _judged(site, unjudged)
    if site["coverage_upper"] < quantile:
        remarks.append(
            f"the design falls short: it covers {site['coverage']:.0%} (at most {site['coverage_upper']:.0%}) of the "
            f"rotations of events left out, on blocks left standing, instead of {quantile:.0%}: the events differ by "
            "more than the others show, or one shape cannot serve all blocks"
        )
    if site["lifted_share"] < FEW_LIFTED:
        remarks.append(
            f"only {site['lifted_share']:.1%} of the pairs of record and block count, for the other records do not "
            "lift the other blocks: the design rests on few of them"
        )
    return remarks + scaled_far(factors)


def scaled_far(factors: np.ndarray) -> list[str]:
    """The remark on records whose scale factors (n,) make another kind of earthquake of them; none without any."""
    low, high = USUAL_FACTORS
    odd = int(np.count_nonzero((factors < low) | (factors > high)))
    if not odd:
        return []
    return [
        f"{odd} of {factors.size} records are scaled by less than {low:g} or more than {high:g} (from "
        f"{factors.min():.2g} to {factors.max():.2g}): their duration and interval are those of earthquakes of "
        "another size"
    ]


def _tail(records: int, quantile: float) -> str:
    """The remark on how little so few records can show of a quantile."""
    beyond, side = (records * (1.0 - quantile), "above") if quantile >= 0.5 else (records * quantile, "below")
    if beyond < FEWEST_BEYOND:
        end = "strongest" if quantile >= 0.5 else "weakest"
        return (
            f"about {beyond:.1f} of them lie {side} the quantile {quantile:g}, which rests on the {end} one or two; "
            "take more records"
        )
    return (
        f"the quantile {quantile:g} lies among them, and is known no better than its interval says; take more records"
    )


def _judged(site: Mapping[str, Any], unjudged: Mapping[str, str]) -> list[str]:
    """The remark on the data that the coverage rests on, where they are few."""
    left = []
    for reason in dict.fromkeys(unjudged.values()):
        names = [name for name, why in unjudged.items() if why == reason]
        more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
        left.append(f"{', '.join(names[:LISTED])}{more} ({reason})")
    without = f"; not judged: {', '.join(left)}" if left else ""
    if not site["judged_events"]:
        return [f"the coverage is not known: no event could be judged{without}"]
    lower, upper = site["coverage_lower"], site["coverage_upper"]
    wide = not upper - lower <= WIDE
    if not (unjudged or wide or site["judged_events"] < FEWEST_EVENTS):
        return []
    interval = ", no interval" if math.isnan(lower) else f", {lower:.0%} to {upper:.0%}"
    little = ": hardly known" if wide else ""
    return [
        f"the coverage ({site['coverage']:.0%}{interval}{little}) rests on {site['judged_pairs']} pairs of record and "
        f"block of {site['judged_events']} of {site['event_count']} events{without}"
    ]
