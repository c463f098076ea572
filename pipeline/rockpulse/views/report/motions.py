"""What is counted in a verdict: records, pairs of channels swept over direction, or the design sequence of a site."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.motions.events import UNKNOWN
from rockpulse.views.report.events import events_of
from rockpulse.views.report.standing import Standing
from rockpulse.views.shared.table import Cell, Heading, Table
from rockpulse.views.shared.terminal import several

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Motions", "event_table", "motions_of"]


@dataclass(frozen=True, eq=False)
class Motions:
    """The ground motions of the results.

    Attributes
    ----------
    names : list of str
        One a motion: id of the record, or name of the pair.
    rows : list of ndarray of int
        Rows of /summary that belong to each: one, or the directions of a sweep.
    missing : ndarray of bool
        Whether a direction of the motion was not assessed.
    events : list of str
        Earthquake of each.
    kind : {"record", "pair", "sequence"}
        What they are.
    directions : int
        Directions of each; 1 unless swept.
    """

    names: list[str]
    rows: list[np.ndarray]
    missing: np.ndarray
    events: list[str]
    kind: str
    directions: int

    @property
    def event_count(self) -> int:
        """Number of earthquakes that are known to be others; one where none is known."""
        return len({event for event in self.events if event != UNKNOWN}) or len(set(self.events))

    def of_unknown_event(self) -> str:
        """A sentence on the motions whose earthquake is unknown, after a blank; empty where all are known."""
        count = self.events.count(UNKNOWN)
        which = f"{several(count, 'motion')} whose earthquake neither the files nor a table ([records] events) tell"
        if not count:
            return ""
        return f" As one earthquake counts: {which}." if count == len(self.events) else f" Not counted is: {which}."

    def counted(self) -> str:
        """Their number in words: "7 records of 2 earthquakes"."""
        if self.kind == "sequence":
            return "one design sequence, which stands for the records of its site calibration"
        noun = "record" if self.kind == "record" else "pair of channels"
        of = several(self.event_count, "earthquake")
        each = f", each in {self.directions} directions" if self.kind == "pair" else ""
        return f"{several(len(self.names), noun)} of {of}{each}"

    def worst(self, standings: np.ndarray) -> np.ndarray:
        """The standing of every body under every motion: that of its worst direction.

        Parameters
        ----------
        standings : (records, bodies) ndarray
            :class:`~rockpulse.views.report.standing.Standing`.

        Returns
        -------
        (motions, bodies) ndarray
            At best not known where a direction is missing.
        """
        found = np.array([standings[rows].max(axis=0) for rows in self.rows]).reshape(-1, standings.shape[1])
        found[self.missing] = np.maximum(found[self.missing], Standing.UNKNOWN)
        return found


def motions_of(tree: xr.DataTree) -> Motions:
    """The motions of the results of an assessment.

    Parameters
    ----------
    tree : xarray.DataTree
        The results.
    """
    summary = tree["summary"].to_dataset()
    events = events_of(summary)
    ids = [str(name) for name in summary["record"].values]
    if "directions" not in tree.children:
        rows = [np.array([place]) for place in range(len(ids))]
        given = len(ids) == 1 and "npts" in summary and int(summary["npts"].values[0]) < 0
        kind = "sequence" if given else "record"
        return Motions(ids, rows, np.zeros(len(ids), dtype=bool), events, kind, 1)
    directions = tree["directions"].to_dataset()
    index = directions["record_index"].transpose("pair", "direction").values
    kept = [place for place, of in enumerate(index) if np.any(of >= 0)]
    rows = [index[place][index[place] >= 0] for place in kept]
    names = [str(directions["pair"].values[place]) for place in kept]
    missing = np.array([bool(np.any(index[place] < 0)) for place in kept], dtype=bool)
    return Motions(names, rows, missing, [events[of[0]] for of in rows], "pair", index.shape[1])


def event_table(motions: Motions) -> Table:
    """The earthquakes, with the motions that are counted to each.

    Parameters
    ----------
    motions : Motions
        The motions of the results.
    """
    of_event: dict[str, list[str]] = {}
    for event, name in zip(motions.events, motions.names, strict=True):
        of_event.setdefault(event, []).append(name)
    rows = tuple(
        (Cell(event), Cell(str(len(names)), float(len(names))), Cell(", ".join(names)))
        for event, names in of_event.items()
    )
    headings = (Heading("earthquake"), Heading("motions"), Heading("which"))
    return Table(
        "earthquakes", "Earthquakes that the motions are counted to, by the table, by name and by time", headings, rows
    )
