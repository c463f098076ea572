"""Marks beside the name of a record whose peak may not be what it seems: a verdict under it rests on it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rockpulse.readers.kit.channel import CREDIBLE_PEAK_G
from rockpulse.record.measures import PGA
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.remark import remarked
from rockpulse.views.shared.table import Cell, Mark

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["doubt", "doubt_notes", "record_cells"]

_PEAK = Mark(
    " (peak?)",
    "(peak?): a peak above 5 g or below 1e-6 g, or that of the file's header differs from it by a factor of 1.5 or "
    "more: the unit may be wrong ([records] units), and with it every verdict under the record.",
)
_CLIPPED = Mark(
    " (clipped?)",
    "(clipped?): the record stays at its largest or smallest value: its peaks may be cut off, and it was stronger "
    "then.",
)


def doubt(pga: float, codes: str) -> tuple[Mark, ...]:
    """Marks of one record, by its PGA [m/s2] and the codes of its warnings.

    Most records have none; the PGA of a sequence in place of a record is NaN.

    Examples
    --------
    >>> [mark.sign for mark in (*doubt(981.0, ""), *doubt(4.2, "baseline_guessed clipped"))]
    [' (peak?)', ' (clipped?)']
    """
    low, high = (STANDARD_GRAVITY * bound for bound in CREDIBLE_PEAK_G)
    peak = pga < low or pga > high or remarked(codes, "header_peak")
    return ((_PEAK,) if peak else ()) + ((_CLIPPED,) if remarked(codes, "clipped", "full_scale") else ())


def record_cells(summary: xr.Dataset) -> list[Cell]:
    """The id of every record of /summary, or of a part of it, with its marks."""
    columns = (summary[name].values.tolist() for name in ("record", PGA, "warning_codes"))
    return [Cell(str(name), marks=doubt(pga, str(codes))) for name, pga, codes in zip(*columns, strict=True)]


def doubt_notes(cells: Iterable[Cell]) -> list[str]:
    """The meanings of the marks of doubt that some cells bear."""
    found = {mark for cell in cells for mark in cell.marks}
    return [mark.note for mark in (_PEAK, _CLIPPED) if mark in found]
