"""What a set of records is too small or too odd to tell, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rockpulse.calibration.site_record import USUAL_FACTORS, SiteRecord
from rockpulse.config import Config

__all__ = ["FEWEST_EVENTS", "FEWEST_RECORDS", "site_remarks"]

#: With fewer than these the intervals are those of a guess, and are called so.
FEWEST_RECORDS, FEWEST_EVENTS = 10, 5

#: Blocks whose records lift so few pairs say little.
FEW_LIFTED = 0.1


def site_remarks(
    site: Mapping[str, Any], done: Sequence[SiteRecord], events: Sequence[str], weights: np.ndarray, config: Config
) -> list[str]:
    """The remarks of a site file, the gravest first.

    Parameters
    ----------
    site : mapping of str to object
        The scalars of the file: counts, coverage, quantile.
    done, events, weights
        As in :func:`rockpulse.calibration.site_tree.build_site_tree`.
    config : Config
        Section calibration is used.

    Returns
    -------
    list of str
        One remark each, without line breaks.
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
    elif count < FEWEST_EVENTS:
        remarks.append(
            f"FEW EVENTS: {count}, fewer than {FEWEST_EVENTS}: the intervals are wide because little is known, and "
            "even so they take the parameters for lognormal; take records of more earthquakes"
        )
    if records < FEWEST_RECORDS:
        remarks.append(
            f"FEW RECORDS: {records}, fewer than {FEWEST_RECORDS}: the quantile {quantile:g} lies beyond what so few "
            "can show; take more records"
        )
    if site["standing_share"] == 0.0:
        remarks.append(
            "the design overturns every block that a record sets rocking: no rotation is left to be covered, and the "
            "design says no more than that; take sturdier blocks or a lower quantile"
        )
    elif count > 1 and math.isnan(site["coverage"]):
        remarks.append(
            "the coverage is not known: no event could be judged by a design of the others that leaves a block "
            "standing which the event sets rocking"
        )
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
    factors = np.array([one.factor for one in done])
    low, high = USUAL_FACTORS
    odd = int(np.count_nonzero((factors < low) | (factors > high)))
    if odd:
        remarks.append(
            f"{odd} of {factors.size} records are scaled by less than {low:g} or more than {high:g} (from "
            f"{factors.min():.2g} to {factors.max():.2g}): their duration and interval are those of earthquakes of "
            "another size"
        )
    return remarks
