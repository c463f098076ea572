"""How a body stands under a record: what may be counted as safe, and what may not.

.. note:: A model's outcome alone is no proof of safety. Rocking is not monotonic in the strength of the motion: a body
   may rock under a record and be overturned by a weaker copy of it. Such a body is not counted as safe.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.views.shared.terminal import restitution
from rockpulse.views.text.capacity import thin_margin
from rockpulse.views.text.overview import cases

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["GRADES", "WORDS", "Body", "Standing", "bodies_of", "lanes", "standings", "why_unknown"]


class Standing(IntEnum):
    """How a body stands under a record, from best to worst."""

    STANDS = 0  #: neither the record nor a weaker copy overturns it
    THIN = 1  #: the same, but a copy hardly stronger does: the search is not that fine
    NO_MARGIN = 2  #: the record does not overturn it; weaker and stronger ones were not searched
    UNKNOWN = 3  #: the model cannot say, or not reliably
    WEAKER_OVERTURNS = 4  #: it survives the record as it is, a weaker copy overturns it
    OVERTURNS = 5  #: the record overturns it


WORDS = {
    Standing.STANDS: "stands",
    Standing.THIN: "stands, hardly a margin",
    Standing.NO_MARGIN: "stands, margin not computed",
    Standing.UNKNOWN: "not known",
    Standing.WEAKER_OVERTURNS: "a weaker copy overturns it",
    Standing.OVERTURNS: "overturns",
}

#: How each is marked (:class:`rockpulse.views.report.tables.Cell`).
GRADES = {
    Standing.STANDS: "good",
    Standing.THIN: "fair",
    Standing.NO_MARGIN: "fair",
    Standing.UNKNOWN: "unknown",
    Standing.WEAKER_OVERTURNS: "bad",
    Standing.OVERTURNS: "bad",
}


@dataclass(frozen=True)
class Body:
    """A body with one of its restitutions.

    Attributes
    ----------
    block : str
        Name in the results.
    place : int
        Place along `block`.
    case : int
        Place along `case`.
    restitution : float
        Velocity ratio C [-].
    several : bool
        Whether the block has several restitutions.
    """

    block: str
    place: int
    case: int
    restitution: float
    several: bool

    @property
    def name(self) -> str:
        """Name of the block, with the restitution where it has several."""
        return f"{self.block}, C = {restitution(self.restitution)}" if self.several else self.block


def bodies_of(summary: xr.Dataset) -> list[Body]:
    """The bodies of the results, one for each restitution that differs.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    """
    found = []
    for place, block in enumerate(str(name) for name in summary["block"].values):
        every = np.atleast_1d(summary["restitution"].sel(block=block).values)
        own = cases(summary, block)
        found += [Body(block, place, case, float(every[case]), len(own) > 1) for case in own]
    return found


def lanes(summary: xr.Dataset, name: str, bodies: list[Body], model: str | None = None) -> np.ndarray | None:
    """A variable of every record and body.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    name : str
        Variable along record, block, perhaps case, model and others.
    bodies : list of Body
        Which.
    model : str, optional
        Whose answers, for a variable along `model`.

    Returns
    -------
    (records, bodies, ...) ndarray or None
        None where the results lack the variable.
    """
    if name not in summary:
        return None
    variable = summary[name]
    if model is not None:
        variable = variable.sel(model=model)
    if "case" not in variable.dims:
        variable = variable.expand_dims(case=1)
    table = variable.transpose("record", "block", "case", ...).values
    places = [body.place for body in bodies]
    return np.asarray(table[:, places, [min(body.case, table.shape[2] - 1) for body in bodies]])


def standings(summary: xr.Dataset, bodies: list[Body], model: str) -> np.ndarray:
    """How every body stands under every record.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    bodies : list of Body
        Which.
    model : str
        Whose answers are counted.

    Returns
    -------
    (records, bodies) ndarray of int8
        :class:`Standing`.

    Notes
    -----
    What overturns, overturns; a safety factor below 1 at which the model answers is overturning by a weaker record;
    one below :func:`rockpulse.views.text.capacity.thin_margin` is hardly a margin, nor is a search that ended below it.
    Unresolved, outside the range of the model, not predictable, or a factor below 1 at which the model cannot answer:
    not known. A body at rest without a factor stands without a margin like any other.
    """
    answers = _Answers(summary, bodies, model)
    found = np.full(answers.outcome.shape, Standing.STANDS, dtype=np.int8)
    found[np.isnan(answers.factor)] = Standing.NO_MARGIN
    proven = np.where(np.isinf(answers.factor), answers.safe_up_to, answers.factor)
    found[~np.isnan(answers.factor) & ~(proven >= answers.margin)] = Standing.THIN
    for mask, _ in answers.doubts():
        found[mask] = Standing.UNKNOWN
    found[(answers.factor < 1.0) & (answers.resolved != 0)] = Standing.WEAKER_OVERTURNS
    found[answers.outcome == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


def why_unknown(summary: xr.Dataset, bodies: list[Body], model: str) -> np.ndarray:
    """Why an answer is not known, or not to be relied on; empty where there is no doubt.

    Parameters
    ----------
    summary, bodies, model
        As of :func:`standings`.

    Returns
    -------
    (records, bodies) ndarray of str
    """
    answers = _Answers(summary, bodies, model)
    found = np.full(answers.outcome.shape, "", dtype=object)
    for mask, words in answers.doubts():
        found[mask] = words
    for code in Reason:
        named = (answers.outcome == Outcome.UNRESOLVED) & (answers.reason == code)
        found[named] = "unresolved" if code == Reason.NONE else code.name.lower().replace("_", " ")
    return found.astype(str)


class _Answers:
    """The answers of one model; what the results lack is taken for unmarked."""

    def __init__(self, summary: xr.Dataset, bodies: list[Body], model: str) -> None:
        def found(name: str, otherwise: float) -> np.ndarray:
            table = lanes(summary, name, bodies, model)
            return np.full(self.outcome.shape, otherwise) if table is None else table

        outcome = lanes(summary, "outcome", bodies, model)
        assert outcome is not None, "the results have no outcome"
        self.outcome = outcome
        self.reason = found("reason", Reason.NONE)
        self.factor = found("safety_factor", np.nan)
        self.resolved = found("factor_resolved", -1)
        self.safe_up_to = found("safe_up_to", np.nan)
        self.margin = thin_margin(found("search_step", np.nan))
        self.predictable = found("predictable", -1)
        self.applicable = found("applicable", 1)

    def doubts(self) -> list[tuple[np.ndarray, str]]:
        """What keeps an answer from being relied on, the gravest last."""
        return [
            ((self.factor < 1.0) & (self.resolved == 0), "a weaker copy may overturn it, no answer from there on"),
            (self.applicable == 0, "outside the range of the model"),
            (self.predictable == 0, "not predictable: changes with the ninth digit"),
            (self.outcome == Outcome.UNRESOLVED, "unresolved"),
        ]
