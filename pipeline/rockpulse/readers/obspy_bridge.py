"""Helpers of the readers that lean on obspy, which is imported only when a file needs it."""

from __future__ import annotations

import io
import math
import os
import sys
import tempfile
import threading
import warnings as python_warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any

from rockpulse.errors import RecordFormatError
from rockpulse.readers.facing import Direction, direction, means_vertical
from rockpulse.readers.source import SourceFile
from rockpulse.remark import Remark

__all__ = ["obspy_notes", "obspy_stream", "seed_direction", "utc_time"]


#: No news about the record: obspy's own future, and files that somebody else left open.
_NO_NEWS = (DeprecationWarning, FutureWarning, ResourceWarning)
#: Python's filters of warnings are those of the whole process: blocks that overlap in two threads would leave theirs.
_ALONE = threading.RLock()
#: SEED: from here on a dip means a vertical sensor, up to there a horizontal one [degrees].
_STEEP, _FLAT = 60.0, 30.0
#: A sensor called N or E may be this far from the axis, either way, before its name is doubted [degrees].
_OFF_AXIS = 45.0


@contextmanager
def obspy_notes(terminal: bool = False) -> Iterator[list[str]]:
    """A list that, once the block has ended, holds the warnings that obspy gave in it; one thread at a time.

    With `terminal` also the lines that its C libraries print on the standard error of the process.
    """
    notes: list[str] = []
    with _ALONE, python_warnings.catch_warnings(record=True) as caught:
        python_warnings.simplefilter("always")
        with _standard_error(terminal) as printed, _unraisable() as lost:
            yield notes
    told = [str(item.message) for item in caught if not issubclass(item.category, _NO_NEWS)]
    notes += dict.fromkeys(f"obspy: {' '.join(text.split())}" for text in (*told, *printed, *lost))


@contextmanager
def _standard_error(wanted: bool) -> Iterator[list[str]]:
    """Collect the lines that are written to file descriptor 2 within the block, if `wanted`."""
    lines: list[str] = []
    if not wanted:
        yield lines
        return
    sys.stderr.flush()
    before = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(before, 2)
            os.close(before)
            file.seek(0)
            lines += [line for line in file.read().decode("utf-8", "replace").splitlines() if line.strip()]


@contextmanager
def _unraisable() -> Iterator[list[str]]:
    """Collect the errors that a callback of a C library could not raise, such as a message in no encoding."""
    lines: list[str] = []
    before = sys.unraisablehook
    sys.unraisablehook = lambda lost: lines.append(f"a message of its C library is lost ({lost.exc_value})")
    try:
        yield lines
    finally:
        sys.unraisablehook = before


def obspy_stream(file: SourceFile, format: str, content: bytes | None = None) -> tuple[Any, list[str]]:
    """The obspy Stream of a file and obspy's warnings; any exception of obspy becomes a `RecordFormatError`.

    `content`, where given, is handed to obspy in place of the bytes of the file.
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
    """Direction from SEED's azimuth and dip where known, else from the channel code; unknown where they contradict.

    A channel code that says vertical does so against a dip of 0, which is what many a header leaves it at.

    The azimuth is clockwise from north, the dip down from the horizontal [degrees]: -90 is up, 90 is down.
    """
    azimuth = None if azimuth is None or not math.isfinite(azimuth) else float(azimuth) % 360.0
    dip = None if dip is None or not math.isfinite(dip) else float(dip)
    named = direction(code)
    if dip is None:
        lies = named.orientation
    else:
        lies = "vertical" if _STEEP <= abs(dip) <= 90.0 else "horizontal" if abs(dip) <= _FLAT else "unknown"
        if lies == "horizontal" and means_vertical(code):
            told = f"a dip of {dip:g} degrees (-90 is up, 0 horizontal)"
            return Direction("vertical", note=Remark("vertical_by_code", channel=code, told=told))
        if lies == "unknown" or named.orientation not in (lies, "unknown"):
            return Direction(
                note=f"the direction is unknown: the channel code says {code!r}, the dip is {dip:g} degrees "
                "(-90 is up, 0 horizontal)"
            )
    if lies == "vertical" and dip is not None:
        return Direction("vertical", sign=1.0 if dip < 0.0 else -1.0)
    if lies != "horizontal" or azimuth is None:
        return named if named.orientation == lies else Direction(lies)
    off = abs((azimuth - named.azimuth + 90.0) % 180.0 - 90.0)  # NaN where the code names no axis
    note = f"the channel code says {code!r}, the azimuth is {azimuth:g} degrees, which is used"
    return Direction("horizontal", azimuth, note=note if off > _OFF_AXIS else "")
