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
    Grade.NO_VERDICT: INK,
    Grade.NOT_KNOWN: INK,
    Grade.SLIDES_FIRST: INK,
    Grade.OVERTURNS: RED,
}
DRAWN = 20
#: Fields of a finding that are columns of :meth:`Results.verdicts`.
_COUNTED = (
    *("overturned", "motions", "earthquakes", "left_out", "weak"),
    *("median_rotation", "largest_rotation", "others_rotation", "sliding"),
)
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
    >>> results.rockpulse.verdicts()["overturned"].to_dict()
    {'stele': 3, 'pier': 0}
    >>> results.rockpulse
    <Results 5 records, 2 bodies, model nonlinear>
    """

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def verdicts(self, demand: str | None = None) -> pd.DataFrame:
        """Return the verdict on every body over all records, as in the overview and the report.

        Parameters
        ----------
        demand : str, optional
            Name of a demand of the configuration; by default, for each body, the demand with the worst verdict.

        Returns
        -------
        pandas.DataFrame
            One row for each body, or for each restitution of a body that has several. All columns refer to the records
            scaled to the `demand`, or as recorded if the results have none. `verdict` is "at rest", "not lifted",
            "rocks", "rocks, no margin", "may overturn", "not known", "slides first" or "overturns"; it is empty without
            a demand or with fewer than five `earthquakes`. `probability` is the mean probability of overturning over
            earthquakes [-], with its 90 % interval (`low`, `high`). `smallest` is the smallest scale factor at P = 10 %
            over the records, or safety factor if there is no P; at a demand it is divided by the scale factor to the
            demand. `governing` is the record with this scale factor, or empty. A motion is a record or a pair of
            channels: `motions` is the number of motions on which the verdict is based, `overturned` the number of these
            that overturn the nominal body, `left_out` the number of motions that cannot be scaled to the demand, and
            `weak` the number of motions that lift no body. `median_rotation` and `largest_rotation` are the median and
            largest rotation of the nominal body over alpha_c [-], inf if it overturns; `others_rotation` is the largest
            rotation without overturning. `sliding` is the largest share of a motion that requires more friction than
            the body has [-], NaN if unknown.

        Raises
        ------
        ResultsError
            For a tree without an assessment, or an unknown demand.
        """
        place = self._place(demand)
        rows = []
        for one in self._verdicts:
            row = one.deciding if place is None else one.demands[place]
            rows.append(
                {
                    "demand": row.demand,
                    "verdict": row.word,
                    "probability": row.share.value,
                    "low": row.share.low,
                    "high": row.share.high,
                    "smallest": row.margin.smallest,
                    "governing": self._answers.records[row.governing] if row.governing >= 0 else "",
                    **{name: getattr(row, name) for name in _COUNTED},
                }
            )
        return pd.DataFrame(rows, index=self._bodies())

    def _place(self, demand: str | None) -> int | None:
        if demand is None:
            return None
        names = list(self._answers.demands)
        if demand not in names:
            available = f"demands in the file: {', '.join(names) or 'none'}"
            raise ResultsError(f"no demand {demand!r}{hint(demand, names, available)}")
        return names.index(demand)

    def margin(self, demand: str | None = None) -> pd.DataFrame:
        """Return the scale factor on the records, or the multiple of a demand, that each body survives.

        Parameters
        ----------
        demand : str, optional
            Name of a demand of the configuration; by default the scale factor refers to the unscaled records.

        Returns
        -------
        pandas.DataFrame
            One row for each body: the `smallest` and the `median` scale factor at P = 10 % over the motions (records or
            pairs of channels), or safety factor without P, divided by the scale factor to the demand if there is one
            [-]; inf if no such scale factor was found, NaN if it is unknown. `smallest_is_bound` and `median_is_bound`
            mark lower bounds, at which the model gives no result; `searched_up_to` is the end of the search if no scale
            factor was found. `motion` is the motion with the smallest scale factor; `unknown` is the number of motions
            without a result. Motions that are not used for the verdict (too weak, or too far from the demand) are left
            out.

        Raises
        ------
        ResultsError
            For a tree without an assessment, or an unknown demand.
        """
        answers, place = self._answers, self._place(demand)
        found = [one.recorded if place is None else one.demands[place] for one in self._verdicts]
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
            for one in (row.margin for row in found)
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
        counts = Counter(filter(None, (one.deciding.word for one in self._verdicts)))
        facts = {"": f"{records} record{'s' * (records != 1)}, {bodies} bod{'y' if bodies == 1 else 'ies'}"}
        return facts | {"model": self._answers.model} | {word: str(count) for word, count in counts.items()}

    def _picture(self) -> Picture | None:
        """Draw the probability of overturning of every body with its interval, in the colour of the verdict."""
        if not self._assessed or not self._verdicts:
            return None
        shown = self._verdicts[:DRAWN]
        picture = Picture((-0.7, 1.4), (-len(shown), 0.5), height=ROW * len(shown) + 40.0)
        for place, one in enumerate(shown):
            at, name = -float(place), one.body.name
            colour = COLOURS[Grade.MAY_OVERTURN if one.deciding.status == "no_margin" else one.grade]
            picture.words(name if len(name) <= 24 else name[:23] + "…", -0.05, at - 0.2, "end")
            picture.line([0.0, 1.0], [at, at], GREY, 0.3)
            if math.isfinite(one.share.value):
                picture.line([one.share.low, one.share.high], [at, at], colour, 1.5)
                picture.dot(one.share.value, at, colour, 4.0)
            counted = f"{one.deciding.overturned} of {one.deciding.motions} overturn"
            picture.words(one.deciding.word or counted, 1.06, at - 0.2, "start", colour)
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
    <Results 5 records, 2 bodies, model nonlinear>
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
