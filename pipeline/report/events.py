"""How many earthquakes the records come from, and what can be said of others with which confidence."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.events import group_events
from rockpulse.fragility.statements import FEWEST_EVENTS
from rockpulse.record import Record

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CONFIDENCE", "FEWEST_EVENTS", "events_of", "largest_share"]

#: Confidence of the bounds in the report [-].
CONFIDENCE = 0.9


def events_of(summary: xr.Dataset, *others: xr.Dataset) -> list[str]:
    """The earthquake of every record.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    *others : xarray.Dataset
        Groups with `event` along `record`, such as /site of a site file and /capacities of a fragility file: there the
        events are those of the user's own table, if there was one. The first that has a record names its event.

    Returns
    -------
    list of str
        One label a record (:func:`rockpulse.events.group_events`).
    """
    stand_ins = [_labels(summary, place) for place in range(summary.sizes["record"])]
    ids = {record.id for record in stand_ins}
    named: dict[str, str] = {}
    for other in reversed(others):
        pairs = zip(other["record"].values.tolist(), other["event"].values.tolist(), strict=True)
        named |= {name: event for name, event in pairs if name in ids and event.strip()}
    return group_events(stand_ins, named)


def _labels(summary: xr.Dataset, place: int) -> Record:
    """What tells the earthquake of a record, without its motion."""

    def found(name: str) -> str:
        return str(summary[name].values[place]) if name in summary else ""

    start = found("start_time")
    return Record(
        np.zeros(2),
        dt=1.0,
        id=str(summary["record"].values[place]),
        event=found("event"),
        source=found("source"),
        start_time=_utc(datetime.fromisoformat(start)) if start else None,
    )


def _utc(moment: datetime) -> datetime:
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


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
    from scipy.stats import beta

    return float(beta.ppf(CONFIDENCE, hit + 1, events - hit))
