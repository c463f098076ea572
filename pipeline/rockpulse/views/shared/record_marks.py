"""Marks beside the name of a record whose peak may not be what it seems: a verdict under it rests on it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rockpulse.readers.channel import CREDIBLE_PEAK_G
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.remark import remarked

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["doubt", "doubt_notes", "doubts"]

#: Marks, by the codes of the remarks that they stand for.
_CODES = {"(peak?)": ("header_peak",), "(clipped?)": ("clipped", "full_scale")}

_MEANING = {
    "(peak?)": "(peak?): a peak above 5 g or below 1e-6 g, or not that of the file's header: the unit may be wrong "
    "([records] units), and with it every verdict under the record.",
    "(clipped?)": "(clipped?): the record stays at its largest or smallest value: its peaks may be cut off, and it was "
    "stronger then.",
}


def doubt(pga: float, codes: str) -> str:
    """Marks of one record, by its PGA [m/s2] and the codes of its warnings, each with a blank before it.

    Most records have none; the PGA of a sequence in place of a record is NaN.

    Examples
    --------
    >>> doubt(981.0, ""), doubt(4.2, "baseline_guessed clipped")
    (' (peak?)', ' (clipped?)')
    """
    low, high = (STANDARD_GRAVITY * bound for bound in CREDIBLE_PEAK_G)
    marks = {mark for mark, wanted in _CODES.items() if remarked(codes, *wanted)}
    marks |= {"(peak?)"} if pga < low or pga > high else set()
    return "".join(f" {mark}" for mark in _MEANING if mark in marks)


def doubts(summary: xr.Dataset) -> dict[str, str]:
    """The marks of every record of /summary, or of a part of it."""
    columns = (summary[name].values.tolist() for name in ("record", "pga", "warning_codes"))
    return {str(name): doubt(pga, str(codes)) for name, pga, codes in zip(*columns, strict=True)}


def doubt_notes(shown: Iterable[str]) -> list[str]:
    """The meanings of the marks that are in some texts."""
    every = " ".join(shown)
    return [meaning for mark, meaning in _MEANING.items() if mark in every]
