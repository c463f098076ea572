"""RENADIC volume 1 files of Chile (Universidad de Chile), in the layout of CSMIP pairs, and the joining of their parts.

Recorders of four channels leave one without a sensor, all zeros. Long records are cut into files ``...parte1.v1``,
``...parte2.v1``. Clocks are those of the instruments, without a time signal: some were never set, others are hours off.
The time that the header calls the origin of the earthquake is of the same clock, and is not used.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.readers.clock import later
from rockpulse.readers.csmip_layout import HEADER_LINES, channels
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.formats.csmip_v1 import read_uncorrected
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import BETWEEN, Record, record_id
from rockpulse.remark import Remark, code_of

__all__ = ["FORMATS", "Part", "is_renadic", "read_renadic", "whole_records"]

_TITLE = re.compile(r"\s?uncorrected accelerogram data\b", re.IGNORECASE)
#: Bytes that hold the 13 lines of text of the first channel.
_OPENING = 1500
_PART = re.compile(r"(.*?)[\s_-]*parte?[\s_-]*(\d{1,2})", re.IGNORECASE | re.ASCII)
_FIRST_TIME = re.compile(r"\s*(-?\d{0,6}\.\d{1,9})", re.ASCII)
#: Largest gap or overlap between two parts, in steps; printed times are rounded.
_STEP_SHARE = 0.25


@dataclass(frozen=True, eq=False)
class Part(Record):
    """One channel of one part of a record."""

    whole: str = ""  # name of the file without the number of the part
    part: int = 1  # number of the part, from 1
    first_time: float = 0.0  # time of the first sample in the file's own column of times [s]

    def plain(self) -> Record:
        """The same channel as a whole record."""
        return Record(**{field.name: getattr(self, field.name) for field in fields(Record)})


def is_renadic(head: bytes, name: str) -> bool:
    """Whether the title is that of an uncorrected volume and the text of the first channel names RENADIC."""
    opening = head[:_OPENING].decode("latin-1")
    return bool(_TITLE.match(opening)) and "renadic" in opening.lower()


def read_renadic(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel but dead ones; raises RecordRefused if all are dead.

    Where the name of the file says that it is a part, the records are `Part`; see `whole_records`.
    """
    records = [replace(record, origin_time=None) for record in read_uncorrected(file, "renadic")]
    alive = [record.acceleration.any() for record in records]
    if not any(alive):
        raise RecordRefused(f"{file.name}: all samples of all channels are zero: no sensor was connected")
    notes: list[str] = [
        f"channel {number} ({record.component}) is dead, all samples are zero; it was left out"
        for number, (record, kept) in enumerate(zip(records, alive, strict=True), start=1)
        if not kept
    ]
    name = _PART.fullmatch(file.path.stem)
    if name:
        notes.append(Remark("part_of_record", part=int(name[2])))
        lines, spans, _ = channels(file, _TITLE, "Uncorrected Accelerogram Data")
        rows = [lines[start + HEADER_LINES] for start, _ in spans]
        records = [_part(record, row, file.path.stem, name) for record, row in zip(records, rows, strict=True)]
    kept_records = [record for record, kept in zip(records, alive, strict=True) if kept]
    return [replace(record, warnings=(*record.warnings, *notes)) for record in kept_records]


def _part(record: Record, row: str, stem: str, name: re.Match[str]) -> Part:
    """The channel as a part, which starts at the first of its times after the trigger."""
    time = _FIRST_TIME.match(row)
    first_time = float(time[1]) if time else 0.0
    start = later(record.start_time, first_time)
    codes = (record.network, record.station, record.location, record.channel)
    known = {item.name: getattr(record, item.name) for item in fields(record)}
    known |= {"start_time": start, "id": record_id(*codes, start, stem, 1)}
    return Part(**known, whole=name[1], part=int(name[2]), first_time=first_time)


def whole_records(records: Sequence[Record]) -> list[tuple[Record, tuple[Record, ...]]]:
    """Join the parts of records that were cut into files; each record beside those that it is made of, in their order.

    The records are of any format, duplicates removed. The others come first, as they were, then the parts: joined where
    parts 1, 2, ... of one file name and station hold the same channels and each begins one step behind the last sample
    of the one before, by the files' columns of times or by their clocks; `source` and `source_sha256` name all of them.
    Else they stay apart, with a warning that says why. A part alone stays as it was. Only the number of samples is
    used, not the samples.
    """
    result: list[tuple[Record, tuple[Record, ...]]] = [
        (record, (record,)) for record in records if not isinstance(record, Part)
    ]
    groups: dict[tuple[str, str], dict[str, list[Part]]] = {}
    for record in records:
        if isinstance(record, Part):
            files = groups.setdefault((record.whole.lower(), record.station_name), {})
            files.setdefault(record.source, []).append(record)
    for files in groups.values():
        parts = sorted(files.values(), key=lambda part: part[0].part)
        fault = _fault(parts)
        if len(parts) > 1 and not fault:
            result += [(_joined(pieces), pieces) for pieces in zip(*parts, strict=True)]
        else:
            result += [(piece.with_warning(fault) if fault else piece, (piece,)) for part in parts for piece in part]
    return result


def _fault(parts: Sequence[Sequence[Part]]) -> str:
    """The reason why the parts do not make one record; empty if they do, or if there is only one."""
    if len(parts) < 2:
        return ""
    numbers = [part[0].part for part in parts]
    if numbers != list(range(1, len(parts) + 1)):
        return f"not joined: parts {', '.join(map(str, numbers))} were given"
    for before, after in pairwise(parts):
        if [(piece.component, piece.dt) for piece in before] != [(piece.component, piece.dt) for piece in after]:
            return f"not joined: parts {before[0].part} and {after[0].part} differ in their channels or intervals"
        for one, other in zip(before, after, strict=True):
            expected, offset = one.npts * one.dt, other.first_time - one.first_time
            clock = (
                (other.start_time - one.start_time).total_seconds() if one.start_time and other.start_time else offset
            )
            if min(abs(offset - expected), abs(clock - expected)) > _STEP_SHARE * one.dt:
                return (
                    f"not joined: part {other.part} begins {offset:g} s after part {one.part} (channel {one.channel}), "
                    f"expected {expected:g} s"
                )
    return ""


def _joined(pieces: Sequence[Part]) -> Record:
    """One channel of the whole record, with the metadata of its first part."""
    first = pieces[0]
    codes = (first.network, first.station, first.location, first.channel)
    notes = dict.fromkeys(note for piece in pieces for note in piece.warnings if code_of(note) != "part_of_record")
    return replace(
        first.plain(),
        acceleration=np.concatenate([piece.acceleration for piece in pieces]),
        id=record_id(*codes, first.start_time, first.whole, 1),
        source=BETWEEN.join(piece.source for piece in pieces),
        source_sha256=BETWEEN.join(piece.source_sha256 for piece in pieces),
        header_peak=float(np.fmax.reduce([piece.header_peak for piece in pieces])),
        warnings=tuple(notes),
        processing=(f"parts {', '.join(str(piece.part) for piece in pieces)} joined",),
    )


FORMATS = (
    Format(
        name="renadic",
        what="RENADIC (Chile) volume 1, parts joined",
        recognised="first line 'Uncorrected Accelerogram Data', RENADIC in the header",
        unit="g/10, from the header",
        processed="no",
        example="curico1002271parte1.v1",
        detect=is_renadic,
        parse=read_renadic,
    ),
)
