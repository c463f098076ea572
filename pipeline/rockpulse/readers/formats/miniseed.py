"""miniSEED, with the gain from StationXML beside it."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.channel import build_record, usable_channels
from rockpulse.readers.clipping import clipping_warning
from rockpulse.readers.facts import stated
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.instrument import without_response
from rockpulse.readers.obspy_bridge import obspy_stream, seed_direction, utc_time
from rockpulse.readers.sensitivity import sensitivity_factor, sensitivity_notes
from rockpulse.readers.source import SourceFile
from rockpulse.readers.station_xml import PROCESSED, station_channel
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_miniseed", "read_miniseed"]

#: Two statements of the sampling rate may differ by this share.
_RATE_TOLERANCE = 1e-3


def is_miniseed(head: bytes, name: str) -> bool:
    """Whether the file begins with a data record: six digits, a quality letter, a blank."""
    return (
        len(head) >= 48 and head[:6].strip(b"0123456789 \x00") == b"" and head[6:7] in b"DRQM" and head[7:8] in b" \0"
    )


def read_miniseed(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every acceleration channel; the gain comes from a StationXML file in the same folder.

    A StationXML with the stem of the miniSEED file comes before the others.

    Raises
    ------
    NotAcceleration
        If all channels record velocity or displacement, and `options.response` is not "remove".
    RecordRefused
        Gaps, overlaps, counts without a gain or with several.
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
            f"{where} has {len(traces) - 1} gaps or overlaps, the first at {stats.endtime}; cut a part without gaps, "
            "or download the record again"
        )
    channel, site, notes = station_channel(file, trace, full=options.response == "remove")
    counts = np.asarray(trace.data)
    samples = counts.astype(float)
    warnings: list[str] = []
    processing: list[str] = []
    if options.response == "remove":
        removed = without_response(where, samples, float(stats.delta), channel.response)
        samples, factor, processing = removed.samples, removed.factor, [removed.note]
        warnings = [*clipping_warning(counts), *removed.warnings]
    else:
        factor = sensitivity_factor(where, channel.response)
        warnings = sensitivity_notes(channel.response)
    warnings += _held_rate(float(stats.sampling_rate), channel)
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
        station_name=site,
        start_time=utc_time(file, stats.starttime),
        sensor_depth=float("nan") if channel.depth is None else float(channel.depth),
        facts=stated(station=(float(channel.latitude), float(channel.longitude))),
        warnings=[*notes, *warnings],
        processing=processing,
    )


def _held_rate(rate: float, channel: Any) -> list[str]:
    """A warning where the StationXML states another sampling rate than the data [1/s]."""
    told = rate if channel.sample_rate is None else float(channel.sample_rate)
    if abs(told - rate) <= _RATE_TOLERANCE * rate:
        return []
    return [f"the StationXML states {told:g} samples per s, the data {rate:g}; the interval is that of the data"]


FORMATS = (
    Format(
        name="miniseed",
        what="miniSEED with StationXML in the same folder",
        recognised="record header",
        unit="counts, gain from StationXML",
        processed="no",
        example="CI.WCS2..HNE.mseed",
        detect=is_miniseed,
        parse=read_miniseed,
        obspy_reads=True,
    ),
)
