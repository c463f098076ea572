"""Merges records of several files: drops duplicates, and joins records that an agency split into several files.

Velocities and displacements among files of plain columns are detected as integrals of another file.
"""

import hashlib
import re
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import groupby, pairwise
from pathlib import PurePath

import numpy as np

from rockpulse.errors import Failure, last_part
from rockpulse.readers.file_pairs import without_unlike
from rockpulse.readers.kit.channel import SIGNS
from rockpulse.readers.kit.facts import later
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import BETWEEN, Record, distinct_ids, of_kind, record_id
from rockpulse.warning_text import WarningText, code_of, find

_NEVER = datetime.max.replace(tzinfo=UTC)
_STEP_SHARE = 0.25  # largest gap or overlap between two parts [sampling steps]; printed times are rounded
_POINTS, _FEWEST = 128, 50  # number of samples that are compared, and smallest number of samples of a file
_BLOCK = 64  # number of files that are compared with all others at once
_ALIKE = 0.98  # correlation of the slopes of one file with the values of another above which it is the integral


@dataclass(frozen=True, eq=False, repr=False)
class Part(Record):
    """A channel in one part of a record that is split into several files."""

    whole: str = ""  # name of the file without the number of the part
    part: int = 1  # number of the part, from 1
    first_time: float = 0.0  # time of the first sample in the file's own column of times [s]


@dataclass(frozen=True)
class PartRule:
    """The rule by which an agency names the files of a long record; see `Format.parts`."""

    name: re.Pattern[str]  # matches a file name without suffix; groups: name of the whole record, number of the part
    # returns the time of the first sample of each component in the file's own column of times [s]
    first_times: Callable[[SourceFile], dict[str, float]]

    def read(self, file: SourceFile, records: list[Record]) -> list[Record]:
        """Return the channels of a file as parts with their start times, or unchanged if the file is not a part."""
        name = self.name.fullmatch(file.path.stem)
        if not name:
            return records
        times, note = self.first_times(file), WarningText("part_of_record", part=int(name[2]))
        parts = []
        for record in records:
            first_time = times[record.component]
            start = later(record.start_time, first_time)
            of_part = {"whole": name[1], "part": int(name[2]), "first_time": first_time}
            part = of_kind(Part, record, start_time=start, id=_id(record, start, file.path.stem), **of_part)
            parts.append(part.with_warning(note))
        return parts


def _id(record: Record, start: datetime | None, stem: str) -> str:
    return record_id(record.network, record.station, record.location, record.channel, start, stem, 1)


def sample_digest(record: Record) -> bytes:
    """Return the SHA-256 of the samples and the interval, followed by the sign, + or -, of the last non-zero sample.

    If the sign is -, the hash is that of the negated samples: records of opposite polarity differ only in this sign.
    """
    turned = np.flatnonzero(record.acceleration)[-1:]
    sign = b"-" if np.any(record.acceleration[turned] < 0.0) else b"+"
    digest = hashlib.sha256((0.0 + (record.acceleration if sign == b"+" else -record.acceleration)).data)
    digest.update(f"{record.dt:.9g}".encode())
    return digest.digest() + sign


def settled(
    records: Sequence[Record], digest: Callable[[Record], bytes]
) -> tuple[list[tuple[Record, tuple[Record, ...]]], list[Failure]]:
    """Return the sorted records without duplicates, each with its parts; records split into files are joined.

    The second value contains a failure for each duplicate (equal `digest`), for each integral of another file, and for
    each file of a pair whose files differ in interval or length.
    """
    kept, duplicates, twins = _without_duplicates(sorted(records, key=_place), digest)
    kept, integrals = without_integrals(kept)
    kept, unlike = without_unlike(kept)
    whole = sorted(whole_records(kept), key=lambda item: _place(item[0]))
    kept = [record.with_warning(twins[id(pieces[0])]) if id(pieces[0]) in twins else record for record, pieces in whole]
    named = distinct_ids(kept)
    pieces_of = [(record, pieces) for record, (_, pieces) in zip(named, whole, strict=True)]
    return pieces_of, [*duplicates, *integrals, *unlike]


def _place(record: Record) -> tuple[str, str]:
    return record.source, record.channel


def _without_duplicates(
    records: Sequence[Record], digest: Callable[[Record], bytes]
) -> tuple[list[Record], list[Failure], dict[int, WarningText]]:
    """Return the distinct records, a failure for each duplicate, and warnings by ``id(record)``.

    Of several duplicates, one with a known direction, start time or earthquake is preferred. A warning is given for a
    record that is kept as a different channel although a record of another file has the same samples.
    """
    digests = {id(record): digest(record) for record in records}

    def samples(record: Record) -> bytes:
        return digests[id(record)][:-1]

    copies: dict[int, Failure] = {}
    twins: dict[int, WarningText] = {}
    for _, alike in groupby(sorted(records, key=samples), samples):
        kept: list[Record] = []
        group = sorted(alike, key=lambda one: (one.orientation == "unknown", one.start_time is None, not one.event))
        for record in group:
            known = digests[id(record)]
            first = next((one for one in kept if digests[id(one)] == known and _same_motion(one, record)), None)
            if first is None:
                twin = next((one for one in kept if one.source != record.source), None)
                if twin is not None and not find(record.warnings, "dead_channel"):
                    turned = SIGNS[1.0 if digests[id(twin)] == known else -1.0]
                    for one, other in ((twin, record), (record, twin)):
                        copy = WarningText("same_samples", other=last_part(other.source), turned=turned)
                        twins.setdefault(id(one), copy)
                kept.append(record)
                continue
            reason = f"channel {record.channel}: same samples and interval as {first.id} of {first.source}"
            copies[id(record)] = Failure(record.source, "read", reason, "duplicate")
    failures = [copies[id(record)] for record in records if id(record) in copies]
    return [record for record in records if id(record) not in copies], failures, twins


def _same_motion(one: Record, other: Record) -> bool:
    """Return whether two records with equal samples are copies, not dead channels or different channels of one file."""
    same = np.array_equal(one.azimuth, other.azimuth, equal_nan=True) and one.orientation == other.orientation
    if not same and "unknown" not in (one.orientation, other.orientation):
        return False
    if one.component == other.component:
        return True
    if one.source == other.source or any(find(record.warnings, "dead_channel") for record in (one, other)):
        return False
    return same or "unknown" in (one.orientation, other.orientation)


def whole_records(records: Sequence[Record]) -> list[tuple[Record, tuple[Record, ...]]]:
    """Join the parts of records that were split into files; return each record with its parts in order.

    Parts 1, 2, ... with the same file name (apart from the number) and station are joined if they contain the same
    channels and each begins one step after the last sample of the previous part, according to the times of the samples
    or the start times; otherwise they get a warning. Parts come last in the result. Other files of one channel, such as
    files of single days, are joined if each begins one step after the last sample of the previous one.
    """
    result: list[tuple[Record, tuple[Record, ...]]] = []
    groups: dict[tuple[str, str], dict[str, list[Part]]] = {}
    channels: dict[tuple[object, ...], list[Record]] = defaultdict(list)
    for record in records:
        if isinstance(record, Part):
            files = groups.setdefault((record.whole.lower(), record.station_name), {})
            files.setdefault(record.source, []).append(record)
        elif record.start_time is None or not (record.station or record.station_name):
            result.append((record, (record,)))
        else:
            channels[_channel(record)].append(record)
    for chain in (chain for one in channels.values() for chain in _chains(one)):
        step = f"{len(chain)} files of one channel joined: each begins where the previous one ends"
        result.append((chain[0] if len(chain) == 1 else _joined(chain, chain[0].id, step), tuple(chain)))
    for files in groups.values():
        parts = sorted(files.values(), key=lambda part: part[0].part)
        fault = _fault(parts)
        if len(parts) > 1 and not fault:
            step = f"parts {', '.join(str(part[0].part) for part in parts)} joined"
            for pieces in zip(*parts, strict=True):
                name = _id(pieces[0], pieces[0].start_time, pieces[0].whole)
                result.append((_joined(pieces, name, step), pieces))
        else:
            result += [(piece.with_warning(fault) if fault else piece, (piece,)) for part in parts for piece in part]
    return result


def _channel(record: Record) -> tuple[object, ...]:
    """Return the properties that all files of one channel share, such as the codes of the channel."""
    codes = (record.network, record.station, record.location, record.channel, record.station_name)
    unit, numbers = (record.source_unit, record.unit_factor), (record.azimuth, record.sensor_depth, record.dt)
    words = (record.component, record.orientation, record.format, record.processed)
    return (*codes, *unit, *words, *(f"{number:g}" for number in numbers))


def _chains(records: Sequence[Record]) -> list[list[Record]]:
    """Group the records of one channel; in a group, each begins one step after the last sample of the previous one."""
    chains: list[list[Record]] = []
    for record in sorted(records, key=lambda one: (one.start_time or _NEVER, one.source)):
        before = chains[-1][-1] if chains else None
        end = later(before.start_time, before.npts * before.dt) if before else None
        if end and record.start_time and abs((record.start_time - end).total_seconds()) <= _STEP_SHARE * record.dt:
            chains[-1].append(record)
        else:
            chains.append([record])
    return chains


def _fault(parts: Sequence[Sequence[Part]]) -> str:
    """Return the reason why parts cannot be joined to a record; empty if they can, or if there is only one part."""
    if len(parts) < 2:
        return ""
    numbers = [part[0].part for part in parts]
    if numbers != list(range(1, len(parts) + 1)):
        return f"not joined: expected parts 1, 2 ..., found {', '.join(map(str, numbers))}"
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


def _joined(pieces: Sequence[Record], name: str, step: str) -> Record:
    """Join the pieces of one channel to a record with the id `name`; other metadata are those of the first piece."""
    first = pieces[0]
    notes = dict.fromkeys(note for piece in pieces for note in piece.warnings if code_of(note) != "part_of_record")
    return of_kind(
        Record,
        first,
        acceleration=np.concatenate([piece.acceleration for piece in pieces]),
        id=name,
        source=BETWEEN.join(piece.source for piece in pieces),
        source_sha256=BETWEEN.join(piece.source_sha256 for piece in pieces),
        header_peak=float(np.fmax.reduce([piece.header_peak for piece in pieces])),
        warnings=tuple(notes),
        processing=(*first.processing, step),
    )


@dataclass(frozen=True, eq=False, repr=False)
class ColumnRecord(Record):
    """A record of plain columns, with a few samples and slopes to find out whether another record is its integral."""

    values: tuple[float, ...] = ()  # [m/s2]
    slopes: tuple[float, ...] = ()  # [m/s3]


def with_slopes(record: Record) -> Record:
    """Return the record as a `ColumnRecord`, or unchanged if it is too short."""
    if record.npts < _FEWEST:
        return record
    at = np.linspace(1, record.npts - 2, _POINTS).astype(int)
    samples = record.acceleration
    slopes = (samples[at + 1] - samples[at - 1]) / (2.0 * record.dt)
    return of_kind(ColumnRecord, record, values=tuple(samples[at].tolist()), slopes=tuple(slopes.tolist()))


def without_integrals(records: Sequence[Record]) -> tuple[list[Record], list[Failure]]:
    """Return the records that are not integrals of another record in their folder, and a failure for each integral."""
    groups: dict[tuple[object, ...], list[ColumnRecord]] = defaultdict(list)
    for record in records:
        if isinstance(record, ColumnRecord):
            groups[str(PurePath(record.source).parent), record.npts, f"{record.dt:.6g}"].append(record)
    rows: dict[int, Failure] = {}
    for group in groups.values():
        if len(group) > 1:
            rows |= _integrals(group)
    return [record for record in records if id(record) not in rows], list(rows.values())


def _integrals(group: Sequence[ColumnRecord]) -> dict[int, Failure]:
    """Return a failure, by ``id(record)``, for each record that is the integral of another record."""
    values, slopes = (_unit_vectors(np.array([getattr(one, name) for one in group])) for name in ("values", "slopes"))
    rows = {}
    for place, record in enumerate(group):
        if place % _BLOCK == 0:
            block = slopes[place : place + _BLOCK] @ values.T
        alike = block[place % _BLOCK]
        alike[place] = 0.0
        other = int(np.argmax(alike))
        # Of two sines, each is the slope of the other.
        if alike[other] > _ALIKE and abs(slopes[other] @ values[place]) <= _ALIKE:
            cause = f"not an acceleration: its derivative is the series of {PurePath(group[other].source).name}"
            held = "so it holds a velocity or a displacement; write acc, vel or disp in the file names"
            reason = f"{record.source}: {cause}, {held}"
            rows[id(record)] = Failure(record.source, "read", reason, "skipped")
    return rows


def _unit_vectors(table: np.ndarray) -> np.ndarray:
    """Return the rows (n, m) without their means, scaled to unit length; constant rows become zero."""
    centred = table - table.mean(axis=1, keepdims=True)
    size = np.linalg.norm(centred, axis=1, keepdims=True)
    return np.divide(centred, size, out=np.zeros_like(centred), where=size > 0.0)
