"""Warnings on the design of a site with few or unusual records."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from rockpulse.studies.site.site_records import USUAL_FACTORS
from rockpulse.warning_text import WarningText

#: Smallest numbers of records and events without a warning.
FEWEST_RECORDS, FEWEST_EVENTS = 10, 5
#: Largest width of the interval of the coverage without a warning [-].
WIDE = 0.5
#: Smallest expected number of records beyond a quantile without a warning.
FEWEST_BEYOND = 2.0
#: Largest number of events that a warning names.
LISTED = 5
#: Smallest share of record-block pairs with uplift without a warning [-].
FEW_LIFTED = 0.1


def sequence_design_warnings(
    site: Mapping[str, Any], factors: np.ndarray, events: np.ndarray, weights: np.ndarray, unjudged: Mapping[str, str]
) -> list[WarningText]:
    """Return the warnings on a design sequence, most serious first; `unjudged` has a reason for each untested event."""
    records, count, quantile = site["record_count"], site["event_count"], float(site["quantile"])
    warnings = []
    if count == 1:
        only = next(event for event, weight in zip(events, weights, strict=True) if weight > 0.0)
        warnings.append(WarningText("one_event", event=str(only)))
    elif site["lifting_events"] < FEWEST_EVENTS:
        known = {"count": int(count), "needed": FEWEST_EVENTS}
        every = site["lifting_events"] == count
        lifting = {} if every else {"lifting": int(site["lifting_events"])}
        warnings.append(WarningText("few_events" if every else "few_lifting_events", **known, **lifting))
    if records < FEWEST_RECORDS:
        tail = _tail(records, quantile)
        warnings.append(WarningText("few_records", count=int(records), needed=FEWEST_RECORDS, tail=tail))
    if site["unresolved_share"] > 0.0:
        warnings.append(WarningText("unresolved_pairs", share=float(site["unresolved_share"])))
    if site["standing_share"] == 0.0:
        warnings.append(WarningText("nothing_standing"))
    if site["design_set_by"]:
        left = WarningText("left_none" if site["standing_share"] == 0.0 else "left_without")
        name, share = str(site["design_set_by"]), float(site["share_below"])
        warnings.append(WarningText("set_by", name=name, share=share, left=left))
    if math.isinf(site["design_upper"]):
        warnings.append(WarningText("open_interval"))
    if count > 1:
        warnings += _coverage_warning(site, unjudged)
    if site["coverage_upper"] < quantile:
        share, most = float(site["coverage"]), float(site["coverage_upper"])
        warnings.append(WarningText("falls_short", share=share, most=most, nominal=quantile))
    if site["lifted_share"] < FEW_LIFTED:
        warnings.append(WarningText("few_lifted", share=float(site["lifted_share"])))
    return warnings + unusual_factors_warning(factors)


def unusual_factors_warning(factors: np.ndarray) -> list[WarningText]:
    """Return a warning if some scale factors (n,) of records are unusually small or large, else an empty list."""
    low, high = USUAL_FACTORS
    odd = int(np.count_nonzero((factors < low) | (factors > high)))
    if not odd:
        return []
    ends = {"low": low, "high": high, "least": float(factors.min()), "most": float(factors.max())}
    return [WarningText("scaled_far_in_all", count=odd, total=factors.size, **ends)]


def _tail(records: int, quantile: float) -> WarningText:
    """Return the number of records expected beyond a quantile, in words."""
    beyond, side = (records * (1.0 - quantile), "above") if quantile >= 0.5 else (records * quantile, "below")
    if beyond < FEWEST_BEYOND:
        return WarningText(f"tail_{side}", beyond=float(beyond), quantile=quantile)
    return WarningText("tail_among", quantile=quantile)


def _coverage_warning(site: Mapping[str, Any], unjudged: Mapping[str, str]) -> list[WarningText]:
    """Return a warning if the coverage is based on few earthquakes or has a wide interval."""
    groups = []
    for reason in dict.fromkeys(unjudged.values()):
        every = [name for name, why in unjudged.items() if why == reason]
        names: str = ", ".join(every[:LISTED])
        if len(every) > LISTED:
            names = WarningText("and_more", names=names, count=len(every) - LISTED)
        groups.append(WarningText(reason, names=names))
    without = WarningText("not_judged", groups=groups) if groups else ""
    if not site["judged_events"]:
        return [WarningText("coverage_unknown", without=without)]
    lower, upper = float(site["coverage_lower"]), float(site["coverage_upper"])
    wide = not upper - lower <= WIDE
    if not (unjudged or wide or site["judged_events"] < FEWEST_EVENTS):
        return []
    known = not math.isnan(lower)
    interval = WarningText("share_interval", low=lower, high=upper) if known else WarningText("no_interval")
    numbers = {"pairs": "judged_pairs", "judged": "judged_events", "total": "event_count"}
    return [
        WarningText(
            "coverage_of_few",
            coverage=float(site["coverage"]),
            interval=interval,
            little=WarningText("hardly_known") if wide else "",
            without=without,
            **{name: int(site[of]) for name, of in numbers.items()},
        )
    ]
