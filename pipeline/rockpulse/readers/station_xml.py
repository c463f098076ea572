"""StationXML beside miniSEED: the channel, in one of several files, that tells gain and direction of a record."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import PurePosixPath
from typing import Any

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.obspy_bridge import obspy_notes, seed_direction
from rockpulse.readers.source import SourceFile

__all__ = ["PROCESSED", "station_channel", "told_otherwise"]

#: Descriptions of a StationXML channel that rockpulse writes beside its own miniSEED, and `Record.processed`.
PROCESSED = {
    "corrected accelerogram, written by rockpulse": True,
    "raw accelerogram, written by rockpulse": False,
    "accelerogram, raw or corrected unknown, written by rockpulse": None,
}

_NO_FILE = "no StationXML file of the station"

Files = Sequence[tuple[str, bytes]]


@lru_cache(maxsize=4)
def _inventory(name: str, content: bytes) -> tuple[Any, list[str]]:
    """A StationXML file and obspy's warnings; it serves all channels of a station, and a parse costs 10 ms and more."""
    import obspy

    try:
        with obspy_notes() as notes:
            inventory = obspy.read_inventory(io.BytesIO(content), format="STATIONXML")
        return inventory, notes
    except Exception as fault:  # lxml, ValueError, TypeError: whatever the damaged element leads to
        raise RecordFormatError(f"{name}: cannot be read as StationXML: {fault}") from fault


def _channels(
    name: str, content: bytes, network: str, station: str, location: str, channel: str
) -> Iterator[tuple[Any, str]]:
    """The channels of these codes that have a sensitivity, each with the name of its station."""
    if station.encode() not in content:
        return
    for net in _inventory(name, content)[0].select(network, station, location, channel):
        for found, site in ((found, place.site) for place in net for found in place):
            sensitivity = found.response.instrument_sensitivity if found.response else None
            if sensitivity is not None and sensitivity.value:
                yield found, (site.name or "").strip() if site else ""


def _is_of(name: str, file: SourceFile) -> bool:
    """Whether a StationXML file was named by the caller, or has the stem of the miniSEED file."""
    return file.chosen or PurePosixPath(name.replace("\\", "/").rpartition("!")[2]).stem == file.path.stem


def station_channel(file: SourceFile, trace: Any, full: bool) -> tuple[Any, str, list[str]]:
    """The one StationXML channel whose epoch holds the whole record, the name of its station, and obspy's warnings.

    A file with the stem of the miniSEED file comes first, and one that rockpulse wrote serves no other. Several
    channels are one if they tell the same: sensitivity (where `full`, response), direction, raw or corrected. Raises
    RecordRefused if there is none, or if several differ, and RecordFormatError if a file of the station is damaged.
    """
    stats = trace.stats
    files = [(name, content) for name, content in file.station_files() if stats.station.encode() in content]
    looked: list[str] = []
    notes: list[str] = []
    found: list[tuple[Any, str]] = []
    for own in (True, False):
        for name, content in files:
            if _is_of(name, file) is not own:
                continue
            try:
                warned = _inventory(name, content)[1]
                channels = list(_channels(name, content, stats.network, stats.station, stats.location, stats.channel))
            except RecordFormatError as fault:
                raise RecordFormatError(f"{fault}; it is needed for {file.name}") from fault
            notes += [f"{name}: {note}" for note in warned]
            serving = [(channel, site) for channel, site in channels if own or channel.description not in PROCESSED]
            bound = len(serving) < len(channels)
            looked.append(f"{name}, which serves the miniSEED file of its own name only" if bound else name)
            found += [(channel, site) for channel, site in serving if _holds(channel, stats.starttime, stats.endtime)]
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


def told_otherwise(files: Files, network: str, station: str, channel: Any) -> bool:
    """Whether a StationXML contradicts a channel of the same codes at a time that overlaps its epoch."""
    return any(
        _overlap(channel, other) and _gap(channel, other, full=False)
        for name, content in files
        for other, _ in _channels(name, content, network, station, channel.location_code, channel.code)
    )


def _holds(channel: Any, start: Any, end: Any) -> bool:
    begins, ends = channel.start_date, channel.end_date
    return not ((begins and begins > start) or (ends and ends < end))


def _overlap(one: Any, other: Any) -> bool:
    """Whether two epochs have a time in common; without a limit they are open."""
    return not any(
        first.end_date and second.start_date and first.end_date < second.start_date
        for first, second in ((one, other), (other, one))
    )


def _gap(one: Any, other: Any, full: bool) -> tuple[str, str] | None:
    """Name of the property in which two channels differ, and its two values; None where they tell the same."""
    if full and one.response != other.response:
        return "responses", ""
    pairs = (
        ("sensitivities", _sensitivity(one), _sensitivity(other)),
        ("directions", _facing(one), _facing(other)),
        ("states of processing", _state(one), _state(other)),
    )
    return next(((what, f"{mine}; {theirs}") for what, mine, theirs in pairs if mine != theirs), None)


def _sensitivity(channel: Any) -> str:
    told = channel.response.instrument_sensitivity
    return f"{float(told.value)!r} per {str(told.input_units).upper()}"


def _facing(channel: Any) -> str:
    facing = seed_direction(channel.code, channel.azimuth, channel.dip)
    if facing.orientation == "vertical":
        return "up" if facing.sign > 0.0 else "down"
    return f"{facing.orientation}, azimuth {facing.azimuth:g}"


def _state(channel: Any) -> str:
    return {True: "corrected", False: "raw", None: "unknown"}[PROCESSED.get(channel.description, False)]
