"""What the readers that lean on obspy share; obspy is imported only when a file needs it."""

from __future__ import annotations

import io
import warnings as python_warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any

from rockpulse.errors import RecordFormatError
from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.source import SourceFile

__all__ = ["obspy_notes", "obspy_stream", "seed_direction", "utc_time"]


#: No news about the record: obspy's own future, and files that somebody else left open.
_NO_NEWS = (DeprecationWarning, FutureWarning, ResourceWarning)


@contextmanager
def obspy_notes() -> Iterator[list[str]]:
    """A list that holds, once the block has ended, what obspy warned of in it."""
    notes: list[str] = []
    with python_warnings.catch_warnings(record=True) as caught:
        python_warnings.simplefilter("always")
        yield notes
    notes += [f"obspy: {item.message}" for item in caught if not issubclass(item.category, _NO_NEWS)]


def obspy_stream(file: SourceFile, format: str, content: bytes | None = None) -> tuple[Any, list[str]]:
    """The obspy Stream of a file and obspy's warnings; whatever it raises becomes a `RecordFormatError`.

    `content`, where given, is what obspy gets to see in place of the bytes of the file.
    """
    import obspy

    try:
        with obspy_notes() as notes:
            stream = obspy.read(io.BytesIO(file.content if content is None else content), format=format)
            # Joins what fits together exactly; a gap keeps its traces apart.
            stream.merge(-1)
    except Exception as fault:  # the plugins raise anything from TypeError to bare Exception on damaged bytes
        raise RecordFormatError(
            f"{file.name}: obspy cannot read it as {format}: {fault}; the file may be damaged: download it again"
        ) from fault
    if len(stream) == 0:
        raise RecordFormatError(f"{file.name}: no waveform in the file; download it again")
    for trace in stream:  # refuses times that obspy itself cannot print
        utc_time(file, trace.stats.starttime)
        utc_time(file, trace.stats.endtime)
    return stream, notes


def utc_time(file: SourceFile, moment: Any) -> datetime:
    """An obspy time as a datetime with ``tzinfo=UTC``."""
    try:
        return moment.datetime.replace(tzinfo=UTC)
    except (ValueError, OverflowError) as fault:
        raise RecordFormatError(
            f"{file.name}: expected a start time in the years 1 to 9999, found {moment.timestamp} s from 1970; "
            "the header is damaged: download the file again"
        ) from fault


def seed_direction(code: str, azimuth: float | None, dip: float | None) -> Direction:
    """Direction from SEED's azimuth and dip (-90 is up) where known, else from the channel code."""
    if dip is not None and abs(dip) >= 60.0:
        return Direction("vertical", sign=1.0 if dip < 0.0 else -1.0)
    if dip is not None and azimuth is not None and abs(dip) <= 30.0:
        return Direction("horizontal", float(azimuth) % 360.0)
    return direction(code)
