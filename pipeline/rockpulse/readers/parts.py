"""Records of several files made one: each content once, and records joined that an agency cut into files."""

import hashlib
import re
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise

import numpy as np

from rockpulse.errors import Failure
from rockpulse.readers.kit.facts import later
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import BETWEEN, Record, distinct_ids, record_id
from rockpulse.warning_text import WarningText, code_of, find

_STEP_SHARE = 0.25  # largest gap or overlap between two parts, in steps; printed times are rounded


@dataclass(frozen=True, eq=False)
class Part(Record):
    """One channel of one part of a record."""

    whole: str = ""  # name of the file without the number of the part
    part: int = 1  # number of the part, from 1
    first_time: float = 0.0  # time of the first sample in the file's own column of times [s]


@dataclass(frozen=True)
class PartRule:
    """How the agency of a format cuts long records into files; the rule stands in the row of the format."""

    name: re.Pattern[str]  # of a part's file, without suffix; groups: name of the whole record, number of the part
    # time of the first sample of each channel, by its component, in the file's own column of times [s]
    first_times: Callable[[SourceFile], dict[str, float]]

    def read(self, file: SourceFile, records: list[Record]) -> list[Record]:
        """The channels of a file as parts, which start at the first of their times; as they are in any other file."""
        name = self.name.fullmatch(file.path.stem)
        if not name:
            return records
        times, note = self.first_times(file), WarningText("part_of_record", part=int(name[2]))
        parts = []
        for record in records:
            first_time = times[record.component]
            start = later(record.start_time, first_time)
            codes = (record.network, record.station, record.location, record.channel)
            known = {item.name: getattr(record, item.name) for item in fields(record)}
            known |= {"start_time": start, "id": record_id(*codes, start, file.path.stem, 1)}
            parts.append(Part(**known, whole=name[1], part=int(name[2]), first_time=first_time).with_warning(note))
        return parts


def sample_digest(record: Record) -> str:
    """SHA-256 of the samples and the interval of a record as read."""
    digest = hashlib.sha256(record.acceleration.tobytes())
    digest.update(f"{record.dt:.9g}".encode())
    return digest.hexdigest()


def settled(
    records: Sequence[Record], digest: Callable[[Record], str]
) -> tuple[list[tuple[Record, tuple[Record, ...]]], list[Failure]]:
    """Each content once, as `digest` tells, cut records joined, sorted, with the records each is made of; copies."""
    kept, duplicates = _without_duplicates(sorted(records, key=_place), digest)
    whole = sorted(whole_records(kept), key=lambda item: _place(item[0]))
    named = distinct_ids([record for record, _ in whole])
    return [(record, pieces) for record, (_, pieces) in zip(named, whole, strict=True)], duplicates


def _place(record: Record) -> tuple[str, str]:
    return record.source, record.channel


def _without_duplicates(
    records: Sequence[Record], digest: Callable[[Record], str]
) -> tuple[list[Record], list[Failure]]:
    """Each content once, and rows for the others; kept is the record that knows its direction, else time and event."""
    alike: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        alike[digest(record)].append(record)
    copies: dict[int, Failure] = {}
    for group in alike.values():
        kept: list[Record] = []
        group.sort(key=lambda one: (one.orientation == "unknown", one.start_time is None, not one.event))
        for record in group:
            first = next((one for one in kept if _same_motion(one, record)), None)
            if first is None:
                kept.append(record)
                continue
            told = f"channel {record.channel}: same samples and interval as {first.id} of {first.source}"
            copies[id(record)] = Failure(record.source, "read", told, "duplicate")
    failures = [copies[id(record)] for record in records if id(record) in copies]
    return [record for record in records if id(record) not in copies], failures


def _same_motion(one: Record, other: Record) -> bool:
    """Whether two records of equal samples are one motion: channels of one file, and dead ones, need not be."""
    if one.component == other.component:
        return True
    if one.source == other.source or any(find(record.warnings, "dead_channel") for record in (one, other)):
        return False
    if "unknown" in (one.orientation, other.orientation):
        return True
    same = np.array_equal(one.azimuth, other.azimuth, equal_nan=True)
    return one.orientation == other.orientation and same


def whole_records(records: Sequence[Record]) -> list[tuple[Record, tuple[Record, ...]]]:
    """Join the parts of records that were cut into files; each record beside those that it is made of, in their order.

    Parts 1, 2, ... of one file name and station, which come last, are joined if they hold the same channels and each
    begins one step behind the one before, by the columns of times or by the clocks. Else they get a warning.
    """
    result: list[tuple[Record, tuple[Record, ...]]] = []
    groups: dict[tuple[str, str], dict[str, list[Part]]] = {}
    for record in records:
        if isinstance(record, Part):
            files = groups.setdefault((record.whole.lower(), record.station_name), {})
            files.setdefault(record.source, []).append(record)
        else:
            result.append((record, (record,)))
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
            clock = offset
            if one.start_time and other.start_time:
                clock = (other.start_time - one.start_time).total_seconds()
            if min(abs(offset - expected), abs(clock - expected)) > _STEP_SHARE * one.dt:
                found = f"part {other.part} begins {offset:g} s after part {one.part} (channel {one.channel})"
                return f"not joined: {found}, expected {expected:g} s"
    return ""


def _joined(pieces: Sequence[Part]) -> Record:
    """One channel of the whole record, with the metadata of its first part."""
    first = pieces[0]
    codes = (first.network, first.station, first.location, first.channel)
    notes = dict.fromkeys(note for piece in pieces for note in piece.warnings if code_of(note) != "part_of_record")
    return replace(
        Record(**{item.name: getattr(first, item.name) for item in fields(Record)}),
        acceleration=np.concatenate([piece.acceleration for piece in pieces]),
        id=record_id(*codes, first.start_time, first.whole, 1),
        source=BETWEEN.join(piece.source for piece in pieces),
        source_sha256=BETWEEN.join(piece.source_sha256 for piece in pieces),
        header_peak=float(np.fmax.reduce([piece.header_peak for piece in pieces])),
        warnings=tuple(notes),
        processing=(f"parts {', '.join(str(piece.part) for piece in pieces)} joined",),
    )
