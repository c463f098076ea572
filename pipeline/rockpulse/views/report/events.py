"""How many earthquakes the records come from, and what can be said of others with which confidence."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rockpulse.studies.fragility.statements import FEWEST_EVENTS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CONFIDENCE", "FEWEST_EVENTS", "events_of", "largest_share"]

#: Confidence of the bounds in the report [-].
CONFIDENCE = 0.9


def events_of(summary: xr.Dataset) -> list[str]:
    """The earthquake of every record.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.

    Returns
    -------
    list of str
        One label a record, as the assessment counted them (:func:`rockpulse.motions.events.group_events`).
    """
    return [str(label) for label in summary["event"].values]


def largest_share(hit: int, events: int) -> float:
    """Upper bound of the share of earthquakes that hit, from those that did (Clopper & Pearson 1934).

    Parameters
    ----------
    hit : int
        Earthquakes with a record that overturns the body, or may.
    events : int
        Earthquakes.

    Returns
    -------
    float
        One-sided, with the confidence :data:`CONFIDENCE`, as if the earthquakes were drawn at random from those that
        are to be expected; NaN for fewer than :data:`FEWEST_EVENTS`.

    Examples
    --------
    >>> round(largest_share(0, 3), 3), round(1.0 - 0.1 ** (1 / 3), 3), largest_share(0, 2)
    (0.536, 0.536, nan)
    """
    if events < FEWEST_EVENTS:
        return math.nan
    if hit == events:
        return 1.0
    from scipy.special import betaincinv

    return float(betaincinv(hit + 1, events - hit, CONFIDENCE))
