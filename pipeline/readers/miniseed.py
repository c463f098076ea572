"""miniSEED, with the gain from StationXML beside it."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.channel import Direction, build_record
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.obspy_bridge import clipping_warning, obspy_stream, seed_direction, utc_time
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record import Record

__all__ = ["FORMAT", "is_miniseed", "read_miniseed"]

#: Input units of an accelerometer's response, and m/s2 per unit.
_ACCELERATION_UNITS = {"M/S**2": 1.0, "M/S^2": 1.0, "M/S/S": 1.0, "M/S2": 1.0, "CM/S**2": 0.01, "CM/S^2": 0.01}


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
        If all channels record velocity or displacement.
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
    records: list[Record] = []
    refusals: list[RecordRefused] = []
    for number, traces in enumerate(groups.values(), start=1):
        try:
            records.append(_miniseed_channel(file, traces, number))
        except RecordRefused as refusal:
            refusals.append(refusal)
    if not records:
        # Velocity channels beside each other are skipped together; one unusable acceleration is worth an error.
        raise next((refusal for refusal in refusals if not isinstance(refusal, NotAcceleration)), refusals[0])
    notes += [f"another channel of the file is left out: {refusal}" for refusal in refusals]
    return [replace(record, warnings=(*record.warnings, *notes)) if notes else record for record in records]


def _miniseed_channel(file: SourceFile, traces: list[Any], number: int) -> Record:
    trace = traces[0]
    stats = trace.stats
    if len(traces) > 1:
        raise RecordRefused(
            f"{file.name}: {trace.id} has {len(traces) - 1} gaps or overlaps, the first at {stats.endtime}; "
            "cut a part without gaps, or download the record again"
        )
    factor, facing = _gain(file, trace)
    counts = np.asarray(trace.data)
    return build_record(
        file,
        number,
        counts.astype(float),
        float(stats.delta),
        "counts",
        factor=factor,
        format="miniseed",
        processed=False,
        component=stats.channel,
        facing=facing,
        channel=stats.channel,
        network=stats.network,
        station=stats.station,
        location=stats.location,
        start_time=utc_time(file, stats.starttime),
        warnings=clipping_warning(counts),
    )


def _gain(file: SourceFile, trace: Any) -> tuple[float, Direction]:
    """m/s2 per count and the direction, from the epoch of the StationXML channel that holds the whole record."""
    import obspy

    stats = trace.stats
    looked: list[str] = []
    found: dict[tuple[float, str], Any] = {}
    for name, content in file.station_files():
        # A parse costs 10 ms; a folder may hold hundreds of stations.
        if stats.station.encode() not in content:
            continue
        looked.append(name)
        try:
            inventory = obspy.read_inventory(io.BytesIO(content), format="STATIONXML")
        except Exception as fault:  # lxml, ValueError, TypeError: whatever the damaged element leads to
            raise RecordFormatError(
                f"{name}: cannot be read as StationXML: {fault}; it is needed for {file.name}"
            ) from fault
        matching = inventory.select(stats.network, stats.station, stats.location, stats.channel)
        for channel in (channel for network in matching for station in network for channel in station):
            begins, ends = channel.start_date, channel.end_date
            if (begins and begins > stats.starttime) or (ends and ends < stats.endtime):
                continue
            sensitivity = channel.response.instrument_sensitivity if channel.response else None
            if sensitivity is not None and sensitivity.value:
                found[float(sensitivity.value), str(sensitivity.input_units).upper()] = channel
    if not found:
        raise RecordRefused(
            f"{file.name}: {trace.id} is in counts and no sensitivity for {stats.starttime} to {stats.endtime} was "
            f"found ({'looked in ' + ', '.join(looked) if looked else 'no StationXML file of the station'}); "
            "put the station's StationXML with responses into the same folder"
        )
    if len(found) > 1:
        raise RecordRefused(
            f"{file.name}: {trace.id} has {len(found)} different sensitivities for one time in "
            f"{', '.join(looked)}; keep the right StationXML only"
        )
    (((value, input_unit), channel),) = found.items()
    if input_unit not in _ACCELERATION_UNITS:
        raise NotAcceleration(
            f"{file.name}: {trace.id} records {input_unit}, expected an acceleration (M/S**2); "
            "use the accelerometer channel of the station (code ending in NE, NN, NZ)"
        )
    return _ACCELERATION_UNITS[input_unit] / value, seed_direction(stats.channel, channel.azimuth, channel.dip)


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
