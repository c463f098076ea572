"""Detects velocities and displacements among files of plain columns, as integrals of another file."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

import numpy as np

from rockpulse.errors import Failure
from rockpulse.record.record import Record, of_kind

_POINTS, _FEWEST = 128, 50  # number of samples that are compared, and smallest number of samples of a file
_BLOCK = 64  # number of files that are compared with all others at once
_ALIKE = 0.98  # correlation of slopes and values of two files above which one is the integral of the other


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
            cause = f"not an acceleration: its derivative is {PurePath(group[other].source).name}"
            reason = f"{record.source}: {cause}, so it holds a velocity or a displacement; name the files by their kind"
            rows[id(record)] = Failure(record.source, "read", reason, "skipped")
    return rows


def _unit_vectors(table: np.ndarray) -> np.ndarray:
    """Return the rows (n, m) without their means, scaled to unit length; constant rows become zero."""
    centred = table - table.mean(axis=1, keepdims=True)
    size = np.linalg.norm(centred, axis=1, keepdims=True)
    return np.divide(centred, size, out=np.zeros_like(centred), where=size > 0.0)
