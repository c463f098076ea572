"""Volumes 1 and 2 of the University of Southern California (and of Caltech before it), in the layout of CSMIP.

Volume 1 holds pairs of time [s] and acceleration [g/10] of a digitised trace, with unequal steps and a blank for the
line printer in front of every row. Volume 2 holds corrected acceleration [cm/s2], then velocity and displacement. The
time in the header is the minute of the earthquake; when the record starts nobody knows.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rockpulse.readers.csmip_layout import HEADER_LINES, TEXT_LINES, Header, channels
from rockpulse.readers.facing import on_structure
from rockpulse.readers.fields import check_count
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.formats.csmip_v2 import read_corrected
from rockpulse.readers.pairs import declared_points, pair_block, pair_unit
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_usc_v1", "is_usc_v2", "read_usc_v1", "read_usc_v2"]

_TITLE = re.compile(r"\s?file\s+\d+\s+of uncorrected accelerogram data\b", re.IGNORECASE)
_CORRECTED = re.compile(r"\s?corrected accelerogram\b[^\r\n]*[\r\n]+" + _TITLE.pattern, re.IGNORECASE)
#: Words end here; the number of a punched card follows.
_WORDS = 72
_STATION = re.compile(r"\s*station\s+(?:usc#|no\.?)\s*(\w+)", re.IGNORECASE)
_COMPONENT = re.compile(r"\s*comp(?:onent)?\s+(.*)", re.IGNORECASE)


def is_usc_v1(head: bytes, name: str) -> bool:
    """Whether the first line is the title of an uncorrected volume."""
    return bool(_TITLE.match(head[:200].decode("latin-1")))


def is_usc_v2(head: bytes, name: str) -> bool:
    """Whether the first two lines are the titles of a corrected and of its uncorrected volume."""
    return bool(_CORRECTED.match(head[:1000].decode("latin-1")))


def read_usc_v1(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel; the options are not used, because the format states everything."""
    lines, spans = channels(file, _TITLE, "FILE N OF UNCORRECTED ACCELEROGRAM DATA")
    records = []
    for number, (start, end) in enumerate(spans, 1):
        check_count(f"{file.name}:{end}", HEADER_LINES, end - start, f"header lines of channel {number}")
        count = declared_points(lines[start + 10], f"{file.name}:{start + 11}")
        unit = pair_unit(lines[start + 11], f"{file.name}:{start + 12}")
        block = pair_block(file.name, lines, start + HEADER_LINES, end, count, unit)
        records.append(
            _header(lines[start : start + TEXT_LINES]).record(file, number, block, format="usc_v1", processed=False)
        )
    return records


def read_usc_v2(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the acceleration of every channel; raises NotAcceleration for a file of velocity or displacement only."""
    return read_corrected(file, "usc_v2", _header)


def _header(lines: Sequence[str]) -> Header:
    """The header from the 13 lines of text."""
    text = [line[:_WORDS].strip() for line in lines[:TEXT_LINES]]
    component, station = _COMPONENT.match(text[6]), _STATION.match(text[4])
    return Header(
        component[1] if component else text[6],
        structural=on_structure(text[5]),
        station=station[1] if station else "",
        station_name=text[5],
        event=" ".join((text[7] or text[1]).split()),
    )


FORMATS = (
    Format(
        name="usc_v1",
        what="USC volume 1 (pairs of a digitised trace)",
        recognised="first line 'FILE N OF UNCORRECTED ACCELEROGRAM DATA'",
        unit="g/10, from the header",
        processed="no",
        example="017m30lw.e0a",
        detect=is_usc_v1,
        parse=read_usc_v1,
    ),
    Format(
        name="usc_v2",
        what="USC volume 2, the acceleration",
        recognised="second line 'FILE N OF UNCORRECTED ACCELEROGRAM DATA'",
        unit="cm/s2, from the peak in the header",
        processed="yes",
        example="274o42pv.s0a",
        detect=is_usc_v2,
        parse=read_usc_v2,
    ),
)
