"""miniSEED files, with the gain from StationXML in the same folder."""

import re
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.kit import obspy_bridge as bridge
from rockpulse.readers.kit.instrument_response import from_counts
from rockpulse.readers.source import NoRecord

_DATA = re.compile(rb"(?<!\d)\d{6}[DRQM][ \0]")  # the beginning of a data record
_RATE_TOLERANCE = 1e-3  # largest relative difference of two stated sampling rates


def is_miniseed(head: bytes, name: str) -> bool:
    """Return whether the file begins with a data record, or with the volume header of a full SEED file."""
    numbered = len(head) >= 48 and head[:6].strip(b"0123456789 \x00") == b""
    return numbered and head[6:7] in b"DRQMV" and head[7:8] in b" \0"


def read_miniseed(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every acceleration channel; the gain comes from a StationXML file in the same folder, or from full SEED."""
    if file.head[6:7] == b"V":
        if not _DATA.search(file.content):
            raise NoRecord(f"{file.name}: dataless SEED, which contains metadata of stations but no samples")
        stations = [(file.name, file.content)]
        file = replace(file, station_files=lambda: stations, chosen=True)
    stream, notes = bridge.obspy_stream(file, "MSEED")
    # Record lengths are powers of two, so that the shortest divides all others.
    length = min(int(trace.stats.mseed.record_length) for trace in stream)
    if len(file.content) % length:
        found = f"{len(file.content) % length} bytes after the last"
        advice = "the file may be truncated: download it again"
        raise kit.unexpected(file.name, f"whole data records of {length} bytes", found, advice)
    groups: dict[str, list[Any]] = {}
    for trace in stream:
        groups.setdefault(trace.id, []).append(trace)
    named = enumerate(groups.values(), start=1)
    return kit.usable_channels((partial(_channel, file, traces, number, options) for number, traces in named), notes)


def _channel(file: kit.SourceFile, traces: list[Any], number: int, options: ReadOptions) -> kit.Record:
    trace = traces[0]
    stats = trace.stats
    where = f"{file.name}: {trace.id}"
    if len(traces) > 1:
        advice = "extract a part without gaps, or download the record again"
        raise RecordRefused(f"{where} has {len(traces) - 1} gaps or overlaps, the first at {stats.endtime}; {advice}")
    channel, site, notes = bridge.station_channel(file, trace, full=options.response == "remove")
    found = from_counts(where, np.asarray(trace.data), float(stats.delta), channel.response, options.response)
    return kit.build_record(
        file,
        found.samples,
        float(stats.delta),
        "counts",
        number=number,
        factor=found.factor,
        processed=bridge.PROCESSED.get(channel.description, False),
        component=stats.channel,
        facing=bridge.seed_direction(stats.channel, channel.azimuth, channel.dip),
        **bridge.codes_of(stats),
        station_name=site,
        start_time=bridge.utc_time(file, stats.starttime),
        sensor_depth=float("nan") if channel.depth is None else float(channel.depth),
        station_place=(float(channel.latitude), float(channel.longitude)),
        warnings=[*notes, *found.warnings, *_held_rate(float(stats.sampling_rate), channel)],
        processing=found.processing,
    )


def _held_rate(rate: float, channel: Any) -> list[str]:
    """Return a warning if the sampling rate [1/s] in the StationXML differs from that of the data."""
    stated = rate if channel.sample_rate is None else float(channel.sample_rate)
    note = f"the StationXML states {stated:g} samples per s, but the data have {rate:g}"
    return [] if abs(stated - rate) <= _RATE_TOLERANCE * rate else [f"{note}; the interval of the data is used"]


MINISEED = Format(
    name="miniseed",
    what="miniSEED with StationXML or ArcLink XML in the same folder, full SEED",
    recognised="record header",
    unit="counts, with the gain from StationXML",
    example="CI.WCS2..HNE.mseed",
    detect=is_miniseed,
    parse=read_miniseed,
    obspy_reads=True,
)
