"""Marks beside the name of a record whose peak may not be what it seems: a verdict under it rests on it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rockpulse.readers.channel import CREDIBLE_PEAK_G
from rockpulse.record.record import STANDARD_GRAVITY

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["doubt", "doubt_notes", "doubts"]

#: Marks, by the words of a reader's warning.
_WARNED = {"(peak?)": "the header states a peak of", "(clipped?)": "the record may be clipped"}

_MEANING = {
    "(peak?)": "(peak?): a peak above 5 g or below 1e-6 g, or not that of the file's header: the unit may be wrong "
    "([records] units), and with it every verdict under the record.",
    "(clipped?)": "(clipped?): the record stays at its largest or smallest value: its peaks may be cut off, and it was "
    "stronger then.",
}


def doubt(pga: float, warnings: str | None) -> str:
    """Marks of one record, each with a blank before it; empty for most.

    Parameters
    ----------
    pga : float
        [m/s2]; NaN for a sequence in place of a record.
    warnings : str or None
        The warnings of the record, one a line.

    Examples
    --------
    >>> doubt(981.0, ""), doubt(4.2, "8 samples in a row at the largest value: the record may be clipped")
    (' (peak?)', ' (clipped?)')
    """
    low, high = (STANDARD_GRAVITY * bound for bound in CREDIBLE_PEAK_G)
    marks = {mark for mark, words in _WARNED.items() if words in (warnings or "")}
    marks |= {"(peak?)"} if pga < low or pga > high else set()
    return "".join(f" {mark}" for mark in _MEANING if mark in marks)


def doubts(summary: xr.Dataset) -> dict[str, str]:
    """The marks of every record.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary, or a part of it.
    """
    names = [str(name) for name in summary["record"].values]
    warnings = summary["warnings"].values.tolist() if "warnings" in summary else [""] * len(names)
    return {
        name: doubt(pga, str(words))
        for name, pga, words in zip(names, summary["pga"].values.tolist(), warnings, strict=True)
    }


def doubt_notes(shown: Iterable[str]) -> list[str]:
    """What the marks that are shown mean.

    Parameters
    ----------
    shown : iterable of str
        Texts that may hold marks.
    """
    every = " ".join(shown)
    return [meaning for mark, meaning in _MEANING.items() if mark in every]
