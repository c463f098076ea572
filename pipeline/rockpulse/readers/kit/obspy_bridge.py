"""Reads waveforms, directions and StationXML with obspy, which is imported only when a file needs it."""

import io
import math
import os
import sys
import tempfile
import threading
import warnings as python_warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import PurePosixPath
from typing import Any

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers import kit
from rockpulse.warning_text import WarningText

#: Warnings that do not concern the record: on future changes of obspy, and on files left open elsewhere.
_NO_NEWS = (DeprecationWarning, FutureWarning, ResourceWarning)
#: Lock, as all threads share Python's warning filters: overlapping blocks of two threads would disturb each other.
_ALONE = threading.RLock()
#: Smallest dip of a vertical sensor, and largest dip of a horizontal sensor in SEED [degrees].
_STEEP, _FLAT = 60.0, 30.0
#: Largest deviation of a sensor named N or E from its axis [degrees].
_OFF_AXIS = 45.0


@contextmanager
def obspy_notes(terminal: bool = False) -> Iterator[list[str]]:
    """Collect obspy's warnings during a ``with`` block in a list; with `terminal`, also its standard error."""
    notes: list[str] = []
    lost: list[str] = []
    with _ALONE, python_warnings.catch_warnings(record=True) as caught:
        python_warnings.simplefilter("always")
        # A callback of a C library cannot raise errors, such as one for a message that cannot be decoded.
        before = sys.unraisablehook
        sys.unraisablehook = lambda one: lost.append(f"a warning of its C library could not be read ({one.exc_value})")
        try:
            with _standard_error(terminal) as printed:
                yield notes
        finally:
            sys.unraisablehook = before
    messages = [str(item.message) for item in caught if not issubclass(item.category, _NO_NEWS)]
    notes += dict.fromkeys(f"obspy: {' '.join(text.split())}" for text in (*messages, *printed, *lost))


@contextmanager
def _standard_error(wanted: bool) -> Iterator[list[str]]:
    """Collect the lines that are written to standard error during a ``with`` block, if `wanted`."""
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


def obspy_stream(file: kit.SourceFile, format: str, content: bytes | None = None) -> tuple[Any, list[str]]:
    """Return the obspy Stream of a file (or of `content`) and obspy's warnings; errors become RecordFormatError."""
    import obspy

    try:
        with obspy_notes() as notes:
            stream = obspy.read(io.BytesIO(file.content if content is None else content), format=format)
            # Joins traces that follow each other exactly; traces with a gap between them stay separate.
            stream.merge(-1)
    except Exception as fault:  # the plugins raise anything from TypeError to bare Exception on damaged bytes
        raise RecordFormatError(
            f"{file.name}: obspy cannot read it as {format}: {fault}; it may be damaged or of another format"
        ) from fault
    if len(stream) == 0:
        raise RecordFormatError(f"{file.name}: no waveform in the file; download it again")
    for trace in stream:  # raises an error for times that obspy itself cannot print
        utc_time(file, trace.stats.starttime)
        utc_time(file, trace.stats.endtime)
    return stream, notes


def codes_of(stats: Any) -> dict[str, Any]:
    """Return network, station, location and channel code of a trace as arguments of `build_record`."""
    return {code: stats[code] for code in ("network", "station", "location", "channel")}


def utc_time(file: kit.SourceFile, moment: Any) -> datetime:
    """Return an obspy time as a datetime in UTC."""
    try:
        return moment.datetime.replace(tzinfo=UTC)
    except (ValueError, OverflowError) as fault:
        found = f"{moment.timestamp} s from 1970"
        raise kit.unexpected(file.name, "a start time in the years 1 to 9999", found) from fault


def seed_direction(code: str, azimuth: float | None, dip: float | None) -> kit.Direction:
    """Return the direction from channel code, azimuth and dip [degrees]; unknown if they contradict each other."""
    # A channel code that means vertical has priority over a dip of 0, the default of many headers.
    azimuth = None if azimuth is None or not math.isfinite(azimuth) else float(azimuth) % 360.0
    dip = None if dip is None or not math.isfinite(dip) else float(dip)
    named = kit.direction(code)
    if dip is None:
        lies = named.orientation
    else:
        lies = "vertical" if _STEEP <= abs(dip) <= 90.0 else "horizontal" if abs(dip) <= _FLAT else "unknown"
        if lies == "horizontal" and kit.means_vertical(code):
            stated = f"a dip of {dip:g} degrees (-90 is up, 0 horizontal)"
            return kit.Direction("vertical", note=WarningText("vertical_by_code", channel=code, stated=stated))
        if lies == "unknown" or named.orientation not in (lies, "unknown"):
            both = f"the channel code says {code!r}, but the dip is {dip:g} degrees (-90 is up, 0 horizontal)"
            note = kit.doubted_direction(named, kit.Direction(lies), f"the direction is unknown: {both}")
            return kit.Direction(note=note)
    if lies == "vertical" and dip is not None:
        return kit.Direction("vertical", sign=1.0 if dip < 0.0 else -1.0)
    if lies != "horizontal" or azimuth is None:
        return named if named.orientation == lies else kit.Direction(lies)
    off = abs((azimuth - named.azimuth + 90.0) % 180.0 - 90.0)  # NaN if the code names no axis
    note = f"the channel code says {code!r}, but the azimuth is {azimuth:g} degrees, which is used"
    return kit.Direction("horizontal", azimuth, note=note if off > _OFF_AXIS else "")


#: Descriptions of a StationXML channel that rockpulse writes with its own miniSEED, and `Record.processed` for each.
PROCESSED = {
    "corrected accelerogram, written by rockpulse": True,
    "raw accelerogram, written by rockpulse": False,
    "accelerogram, raw or corrected unknown, written by rockpulse": None,
}

_NO_FILE = "no StationXML file of the station"
Files = Sequence[tuple[str, bytes]]


@lru_cache(maxsize=4)
def _inventory(name: str, content: bytes) -> tuple[Any, list[str]]:
    """Return the station metadata in a file, and obspy's warnings; the result is cached."""
    import obspy

    try:
        with obspy_notes() as notes:
            # obspy recognises StationXML, ArcLink inventories and dataless SEED.
            inventory = obspy.read_inventory(io.BytesIO(content))
        return inventory, notes
    except Exception as fault:  # any error of lxml, ValueError or TypeError, depending on the damage
        raise RecordFormatError(f"{name}: cannot be read as StationXML or another inventory: {fault}") from fault


def _channels(
    name: str, content: bytes, network: str, station: str, location: str, channel: str
) -> Iterator[tuple[Any, str]]:
    """Yield the StationXML channels with these codes and a sensitivity, each with the name of its station."""
    if station.encode() not in content:
        return
    for net in _inventory(name, content)[0].select(network, station, location, channel):
        for found, site in ((found, place.site) for place in net for found in place):
            sensitivity = found.response.instrument_sensitivity if found.response else None
            if sensitivity is not None and sensitivity.value:
                yield found, (site.name or "").strip() if site else ""


def station_channel(file: kit.SourceFile, trace: Any, full: bool) -> tuple[Any, str, list[str]]:
    """Return the StationXML channel that is valid for a whole trace, its station name, and obspy's warnings.

    A StationXML with the name of the miniSEED file has priority; one that rockpulse wrote is used for no other file.
    """
    stats = trace.stats
    files = [(name, content) for name, content in file.station_files() if stats.station.encode() in content]
    looked: list[str] = []
    notes: list[str] = []
    found: list[tuple[Any, str]] = []
    for own in (True, False):
        for name, content in files:
            stem = PurePosixPath(name.replace("\\", "/").rpartition("!")[2]).stem
            if (file.chosen or stem == file.path.stem) is not own:
                continue
            try:
                warned = _inventory(name, content)[1]
                channels = list(_channels(name, content, stats.network, stats.station, stats.location, stats.channel))
            except RecordFormatError as fault:
                raise RecordFormatError(f"{fault}; it is needed for {file.name}") from fault
            notes += [f"{name}: {note}" for note in warned]
            serving = [(channel, site) for channel, site in channels if own or channel.description not in PROCESSED]
            bound = len(serving) < len(channels)
            looked.append(f"{name}, which applies only to the miniSEED file of the same name" if bound else name)
            whole = (stats.starttime.ns, stats.endtime.ns)
            found += [one for one in serving if _epoch(one[0])[0] <= whole[0] and whole[1] <= _epoch(one[0])[1]]
        if found:
            break
    if not found:
        raise RecordRefused(
            f"{file.name}: {trace.id} is in counts and no sensitivity for {stats.starttime} to {stats.endtime} was "
            f"found ({'; '.join(['looked in ' + ', '.join(looked), *dict.fromkeys(notes)]) if looked else _NO_FILE}); "
            "put the station's StationXML with responses into the same folder, or name it: read(path, "
            "stationxml='station.xml')"
        )
    first, site = found[0]
    gaps = [gap for gap in (_gap(first, channel, full) for channel, _ in found[1:]) if gap]
    if gaps:
        what, values = gaps[0]
        raise RecordRefused(
            f"{file.name}: {trace.id} has {1 + len(gaps)} different {what} for one time in {', '.join(looked)}"
            f"{f' ({values})' if values else ''}; keep the right StationXML only, or give it the name of the "
            f"miniSEED file ({file.path.stem}.xml)"
        )
    return first, site, notes


def contradicts_channel(files: Files, network: str, station: str, channel: Any) -> bool:
    """Return whether a StationXML describes the same channel (same codes, overlapping epoch) differently."""
    first, last = _epoch(channel)
    return any(
        first <= _epoch(other)[1] and _epoch(other)[0] <= last and _gap(channel, other, full=False)
        for name, content in files
        for other, _ in _channels(name, content, network, station, channel.location_code, channel.code)
    )


def _epoch(channel: Any) -> tuple[float, float]:
    """Return the times [ns] from which and to which a channel is described; infinite if they are not stated."""
    begins, ends = channel.start_date, channel.end_date
    return begins.ns if begins else -math.inf, ends.ns if ends else math.inf


def _gap(one: Any, other: Any, full: bool) -> tuple[str, str] | None:
    """Return the name and the two values (as one text) of the first property in which two channels differ, or None."""
    if full and one.response != other.response:
        return "responses", ""
    states = {True: "corrected", False: "raw", None: "unknown"}
    stated = []
    for channel in (one, other):
        sensitivity = channel.response.instrument_sensitivity
        facing = seed_direction(channel.code, channel.azimuth, channel.dip)
        words = f"{facing.orientation}, azimuth {facing.azimuth:g}"
        if facing.orientation == "vertical":
            words = "up" if facing.sign > 0.0 else "down"
        per = f"{float(sensitivity.value)!r} per {str(sensitivity.input_units).upper()}"
        stated.append((per, words, states[PROCESSED.get(channel.description, False)]))
    pairs = zip(("sensitivities", "directions", "states of processing"), *stated, strict=True)
    return next(((what, f"{mine}; {theirs}") for what, mine, theirs in pairs if mine != theirs), None)
