"""Results in Python: functions that read files, and the accessor ``tree.rockpulse`` with verdicts and margins."""

import math
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

import pandas as pd
import xarray as xr

from rocking.pictures import BLUE, GREY, INK, ORANGE, RED, Picture, Shown
from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import BodyVerdict, Grade, verdicts
from rockpulse.errors import ResultsError
from rockpulse.option import hint
from rockpulse.storage.hdf5 import results_file
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words

#: Colours of the verdicts in the picture, and largest number of bodies in it.
COLOURS = {
    Grade.AT_REST: GREY,
    Grade.ROCKS: BLUE,
    Grade.MAY_OVERTURN: ORANGE,
    Grade.NOT_KNOWN: INK,
    Grade.OVERTURNS: RED,
}
DRAWN = 20
#: Height of a body in the picture [px].
ROW = 18.0


class Results(Shown):
    """The verdicts and margins of an assessment, ``tree.rockpulse`` of a tree of results.

    The accessor is registered by :func:`rockpulse.assess`, :func:`rockpulse.assess_sequence`, :func:`rockpulse.load`
    and :func:`rockpulse.open_results`. Type checkers do not know accessors; for them ``rockpulse.Results(tree)`` is the
    same.

    Parameters
    ----------
    tree : xarray.DataTree
        Results of :func:`rockpulse.assess`, or read from a file.

    Examples
    --------
    >>> results.rockpulse.verdicts()["verdict"].to_dict()
    {'stele': 'overturns', 'pier': 'rocks'}
    >>> results.rockpulse
    <Results 5 records, 2 bodies, model nonlinear, overturns 1, rocks 1>
    """

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def verdicts(self) -> pd.DataFrame:
        """Return the verdict on every body over all records, as in the overview and the report.

        Returns
        -------
        pandas.DataFrame
            One row for each body, or for each restitution of a body that has several. `verdict` is "at rest", "rocks",
            "may overturn", "not known", "overturns" or "no verdict"; it follows from `probability`, the mean
            probability of overturning over earthquakes [-] (at the worst of the site's demands, if any), with its 90 %
            interval (`low`, `high`). `overturned` is the number of the `motions` that overturn the body without
            scaling. `worst` is the record with the smallest factor, or empty. Each demand has columns `verdict at NAME`
            and `probability at NAME`.

        Raises
        ------
        ResultsError
            For a tree without an assessment.
        """
        rows = []
        for one in self._verdicts:
            row: dict[str, str | int | float] = {
                "verdict": one.word,
                "probability": one.decides.value,
                "low": one.decides.low,
                "high": one.decides.high,
                "overturned": one.overturned,
                "motions": len(self._answers.motions.names),
                "worst": self._answers.records[one.governing] if one.governing >= 0 else "",
            }
            for demand in one.demands:
                row[f"verdict at {demand.name}"] = "no verdict" if demand.few else demand.grade.word
                row[f"probability at {demand.name}"] = demand.share.value
            rows.append(row)
        return pd.DataFrame(rows, index=self._bodies())

    def margin(self, demand: str | None = None) -> pd.DataFrame:
        """Return the scale factor on the records, or the multiple of a demand, that each body survives.

        Parameters
        ----------
        demand : str, optional
            Name of a demand of the configuration; by default the factor refers to the unscaled records.

        Returns
        -------
        pandas.DataFrame
            One row for each body: the `smallest` and the `median` over the motions of the factor at which the
            probability of overturning is 10 %, or else of the safety factor [-]; inf if no such factor was found, NaN
            if it is unknown. `smallest_is_bound` and `median_is_bound` mark lower bounds, at which the model gives no
            result; `searched_up_to` is the end of the search if no factor was found. `motion` is the record, or the
            pair of channels, with the smallest factor; `unknown` is the number of motions without a result.

        Raises
        ------
        ResultsError
            For a tree without an assessment, or an unknown demand.
        """
        answers = self._answers
        if demand is not None and demand not in answers.demands:
            known = ", ".join(answers.demands) or "none"
            raise ResultsError(f"no demand {demand!r}{hint(demand, answers.demands, f'there are: {known}')}")
        rows = [
            {
                "smallest": one.smallest,
                "median": one.median,
                "smallest_is_bound": one.bounds[0],
                "median_is_bound": one.bounds[1],
                "searched_up_to": one.limit,
                "motion": answers.motions.names[one.place] if one.place >= 0 else "",
                "unknown": one.unknown,
            }
            for one in answers.margins(demand=demand)
        ]
        return pd.DataFrame(rows, index=self._bodies())

    @cached_property
    def _answers(self) -> Answers:
        if not self._assessed:
            found = str(self._tree.attrs.get("kind", ASSESSMENT))
            what = kind_in_words(found) if found != ASSESSMENT else "a tree without the group summary"
            raise ResultsError(f"expected results of rockpulse.assess, found {what}")
        return answers_of(self._tree)

    @cached_property
    def _verdicts(self) -> list[BodyVerdict]:
        return verdicts(self._answers)

    def _bodies(self) -> "pd.Index[str]":
        return pd.Index([body.name for body in self._answers.bodies], name="body")

    @property
    def _assessed(self) -> bool:
        return self._tree.attrs.get("kind", ASSESSMENT) == ASSESSMENT and "summary" in self._tree.children

    def _facts(self) -> dict[str, str]:
        if not self._assessed:
            return {"kind": str(self._tree.attrs.get("kind", "unknown")), "groups": ", ".join(self._tree.children)}
        records, bodies = len(self._answers.records), len(self._answers.bodies)
        counts = Counter(one.word for one in self._verdicts)
        facts = {"": f"{records} record{'s' * (records != 1)}, {bodies} bod{'y' if bodies == 1 else 'ies'}"}
        return facts | {"model": self._answers.model} | {word: str(count) for word, count in counts.items()}

    def _picture(self) -> Picture | None:
        """Draw the probability of overturning of every body with its interval; the colour is that of the verdict."""
        if not self._assessed or not self._verdicts:
            return None
        shown = self._verdicts[:DRAWN]
        picture = Picture((-0.7, 1.4), (-len(shown), 0.5), height=ROW * len(shown) + 40.0)
        for place, one in enumerate(shown):
            at, colour, name = -float(place), COLOURS[one.overall], one.body.name
            picture.words(name if len(name) <= 24 else name[:23] + "…", -0.05, at - 0.2, "end")
            picture.line([0.0, 1.0], [at, at], GREY, 0.3)
            if math.isfinite(one.decides.value):
                picture.line([one.decides.low, one.decides.high], [at, at], colour, 1.5)
                picture.dot(one.decides.value, at, colour, 4.0)
            picture.words(one.word, 1.06, at - 0.2, "start", colour)
        for share in (0.0, 0.5, 1.0):
            picture.words(f"{share:g}", share, -len(shown) - 0.3, "middle", GREY)
        return picture


def registered(tree: xr.DataTree) -> xr.DataTree:
    """Register :class:`Results` as the accessor ``rockpulse`` of all trees, and return the tree."""
    if not hasattr(xr.DataTree, "rockpulse"):
        xr.register_datatree_accessor("rockpulse")(Results)
    return tree


def load(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read results into memory; the file is closed afterwards.

    Parameters
    ----------
    path : str or Path
        File written by :func:`save`.

    Returns
    -------
    xarray.DataTree
        The tree that was saved, with the provenance in its attributes; ``tree.rockpulse`` is a :class:`Results`.

    Raises
    ------
    ResultsError
        For a file that is not HDF5, is damaged, was not written by rockpulse, or has another major schema version.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> rp.load("results.h5").rockpulse
    <Results 5 records, 2 bodies, model nonlinear, overturns 1, rocks 1>
    """
    return registered(results_file.load_tree(path))


@contextmanager
def open_results(path: str | os.PathLike[str]) -> Iterator[xr.DataTree]:
    """Open results in a ``with`` block; numbers are read on demand inside the block.

    Parameters
    ----------
    path : str or Path
        File written by :func:`save`.

    Yields
    ------
    xarray.DataTree
        A tree as from :func:`load`. Data needed after the block must be read inside it, with ``.load()`` or
        ``.values``.

    Raises
    ------
    ResultsError, OSError
        As in :func:`load`. Damaged numbers raise an OSError of HDF5 when they are read.

    Examples
    --------
    >>> with rp.open_results("results.h5") as tree:
    ...     round(float(tree["summary"]["pga"].max()), 2)  # m/s2
    4.86
    """
    with results_file.open_results_file(Path(path)) as file:
        yield registered(file.tree())
