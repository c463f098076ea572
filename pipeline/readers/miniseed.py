"""miniSEED, with the gain from StationXML beside it."""

from __future__ import annotations

import io
from functools import lru_cache, partial
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.channel import build_record, usable_channels
from rockpulse.readers.clipping import clipping_warning
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.instrument import sensitivity_factor, without_response
from rockpulse.readers.obspy_bridge import obspy_notes, obspy_stream, seed_direction, utc_time
from rockpulse.readers.source import SourceFile
from rockpulse.record import Record

__all__ = ["FORMAT", "PROCESSED", "is_miniseed", "read_miniseed"]

#: Descriptions of a StationXML channel that rockpulse writes beside its own miniSEED, and `Record.processed`.
PROCESSED = {
    "corrected accelerogram, written by rockpulse": True,
    "raw accelerogram, written by rockpulse": False,
    "accelerogram, raw or corrected unknown, written by rockpulse": None,
}


def is_miniseed(head: bytes, name: str) -> bool:
    """Whether the file begins with a data record: six digits, a quality letter, a blank."""
    return (
        len(head) >= 48 and head[:6].strip(b"0123456789 \x00") == b"" and head[6:7] in b"DRQM" and head[7:8] in b" \0"
    )


def read_miniseed(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every acceleration channel; the gain comes from a StationXML file in the same folder.

    Parameters
    ----------
    file : SourceFile
        The file.
    options : ReadOptions
        `response` tells how counts become m/s2.

    Raises
    ------
    NotAcceleration
        If all channels record velocity or displacement, and `response` is not "remove".
    RecordRefused
        Gaps, overlaps, counts without a gain.
    RecordFormatError
        Damaged bytes.
    """
    stream, notes = obspy_stream(file, "MSEED")
    # Lengths are powers of two, so the shortest divides them all.
    length = min(int(trace.stats.mseed.record_length) for trace in stream)
    if len(file.content) % length:
        raise RecordFormatError(
            f"{file.name}: expected whole data records of {length} bytes, found {len(file.content) % length} bytes "
            "after the last; the file may be truncated: download it again"
        )
    groups: dict[str, list[Any]] = {}
    for trace in stream:
        groups.setdefault(trace.id, []).append(trace)
    channels = (
        partial(_miniseed_channel, file, traces, number, options)
        for number, traces in enumerate(groups.values(), start=1)
    )
    return usable_channels(channels, notes)


def _miniseed_channel(file: SourceFile, traces: list[Any], number: int, options: ReadOptions) -> Record:
    trace = traces[0]
    stats = trace.stats
    where = f"{file.name}: {trace.id}"
    if len(traces) > 1:
        raise RecordRefused(
            f"{where} has {len(traces) - 1} gaps or overlaps, the first at {stats.endtime}; "
            "cut a part without gaps, or download the record again"
        )
    channel, notes = _station_channel(file, trace, full=options.response == "remove")
    counts = np.asarray(trace.data)
    samples = counts.astype(float)
    warnings, processing = [], []
    if options.response == "remove":
        removed = without_response(where, samples, float(stats.delta), channel.response)
        samples, factor, processing = removed.samples, removed.factor, [removed.note]
        warnings = [*clipping_warning(counts), *removed.warnings]
    else:
        factor = sensitivity_factor(where, channel.response)
    return build_record(
        file,
        number,
        samples,
        float(stats.delta),
        "counts",
        factor=factor,
        format="miniseed",
        processed=PROCESSED.get(channel.description, False),
        component=stats.channel,
        facing=seed_direction(stats.channel, channel.azimuth, channel.dip),
        channel=stats.channel,
        network=stats.network,
        station=stats.station,
        location=stats.location,
        start_time=utc_time(file, stats.starttime),
        warnings=[*notes, *warnings],
        processing=processing,
    )


_NO_FILE = "no StationXML file of the station"


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


def _station_channel(file: SourceFile, trace: Any, full: bool) -> tuple[Any, list[str]]:
    """The one StationXML channel whose epoch holds the whole record, with its response; what obspy warned of.

    Several are one if they tell the same: the same sensitivity, or where `full`, the same response.
    """
    stats = trace.stats
    looked: list[str] = []
    found: list[Any] = []
    notes: list[str] = []
    for name, content in file.station_files():
        if stats.station.encode() not in content:
            continue
        looked.append(name)
        try:
            inventory, warned = _inventory(name, content)
        except RecordFormatError as fault:
            raise RecordFormatError(f"{fault}; it is needed for {file.name}") from fault
        notes += [f"{name}: {note}" for note in warned]
        matching = inventory.select(stats.network, stats.station, stats.location, stats.channel)
        for channel in (channel for network in matching for station in network for channel in station):
            begins, ends = channel.start_date, channel.end_date
            if (begins and begins > stats.starttime) or (ends and ends < stats.endtime):
                continue
            sensitivity = channel.response.instrument_sensitivity if channel.response else None
            if sensitivity is not None and sensitivity.value:
                found.append(channel)
    if not found:
        raise RecordRefused(
            f"{file.name}: {trace.id} is in counts and no sensitivity for {stats.starttime} to {stats.endtime} was "
            f"found ({'; '.join(['looked in ' + ', '.join(looked), *dict.fromkeys(notes)]) if looked else _NO_FILE}); "
            "put the station's StationXML with responses into the same folder"
        )
    different = [channel for channel in found[1:] if not _tell_the_same(found[0].response, channel.response, full)]
    if different:
        raise RecordRefused(
            f"{file.name}: {trace.id} has {1 + len(different)} different {'responses' if full else 'sensitivities'} "
            f"for one time in {', '.join(looked)}; keep the right StationXML only"
        )
    return found[-1], notes


def _tell_the_same(one: Any, other: Any, full: bool) -> bool:
    if full:
        return bool(one == other)
    first, second = one.instrument_sensitivity, other.instrument_sensitivity
    return bool(first.value == second.value and str(first.input_units).upper() == str(second.input_units).upper())


FORMAT = Format(
    name="miniseed",
    what="miniSEED with StationXML in the same folder",
    recognised="record header",
    unit="counts, gain from StationXML",
    processed="no",
    example="CI.WCS2..HNE.mseed",
    detect=is_miniseed,
    parse=read_miniseed,
)
