"""Formats that obspy decodes: K-NET and KiK-net ASCII files of NIED (Japan), miniSEED, and SAC.

For K-NET, obspy returns counts with an offset; it has already converted Japanese time to UTC and subtracted the 15 s
that the logger adds to the record time. The counts are scaled and the offset is subtracted here. The gain of miniSEED
comes from StationXML in the same folder. A SAC header does not state the unit.
"""

import math
import re
import struct
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rockpulse.errors import RecordRefused, UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with
from rockpulse.readers.kit import obspy_bridge as bridge
from rockpulse.readers.kit.instrument_response import from_counts
from rockpulse.readers.source import NoRecord

_SCALE = re.compile(r"Scale Factor\s+(\d+\.?\d*)\s*\(gal\)\s*/\s*(\d+\.?\d*)", re.IGNORECASE)
_KNET_PEAK = re.compile(r"Max\. Acc\. \(gal\)\s+(-?\d+\.?\d*)", re.IGNORECASE)
_KNET_LINES = 17
_DIRECTIONS = re.compile(r"\.(EW|NS|UD)([12]?)$", re.IGNORECASE)
_DATA = re.compile(rb"(?<!\d)\d{6}[DRQM][ \0]")  # the beginning of a data record
_RATE_TOLERANCE = 1e-3  # largest relative difference of two stated sampling rates
#: Length of the header, and offsets of the words NPTS and NVHDR [bytes].
_SAC_HEADER, _NPTS, _NVHDR = 632, 4 * 79, 4 * 76
#: Offsets of the words DELTA, DEPMIN, DEPMAX, B, E: interval, extremes, times of the first and the last sample.
_SAC_WORDS = {"delta": 0, "depmin": 4, "depmax": 8, "b": 20, "e": 24}
_UNDEFINED = -12345.0
_COORDINATES = {"STLA": 31, "STLO": 32, "EVLA": 35, "EVLO": 36}
_ACCELERATION = 8  # value of IDEP
_IDEP_SERIES = {6: "displacement", 7: "velocity"}  # values of IDEP that exclude acceleration
_LAST_STEPS = 2.0  # largest error of E [steps]


def read_knet(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file, and subtract the mean of the whole record as its offset."""
    lines = kit.text_lines(file.content)
    kit.check_count(f"{file.name}:{len(lines)}", _KNET_LINES, len(lines), "header lines")
    header = [line[: kit.LONGEST_LINE] for line in lines[:_KNET_LINES]]
    scale = _SCALE.match(header[13])
    if not scale or float(scale[1]) == 0.0 or float(scale[2]) == 0.0:
        raise kit.unexpected(f"{file.name}:14", "'Scale Factor' as 2000(gal)/8388608", repr(header[13].strip()))
    # The error states the line of a damaged number, which obspy does not.
    kit.free_numbers(lines[_KNET_LINES:], _KNET_LINES + 1, file.name)
    # obspy accepts only ASCII and LF.
    content = "\n".join([*header, *lines[_KNET_LINES:], ""]).encode("ascii", errors="replace")
    (trace,), notes = bridge.obspy_stream(file, "KNET", content)
    stats = trace.stats
    expected = float(stats.knet.duration) * float(stats.sampling_rate)
    if not 0.0 < expected < len(file.content):
        wanted = "a sampling frequency and a duration that fit the file"
        raise kit.unexpected(f"{file.name}:11", wanted, f"{stats.sampling_rate} Hz and {stats.knet.duration} s")
    declared = round(expected)
    kit.check_count(f"{file.name}:{len(lines)}", declared, int(stats.npts))
    component, warnings = _knet_component(file, stats.channel)
    if declared < stats.npts <= expected + stats.sampling_rate:
        longer = f"duration and sampling frequency of the header give {declared} samples, but the file has {stats.npts}"
        notes.append(f"{longer}; all are kept: is a line duplicated?")
    elif stats.npts > expected:
        wanted, advice = f"{declared} samples (duration and sampling frequency)", "the file holds more than one record"
        raise kit.unexpected(f"{file.name}:{len(lines)}", wanted, str(stats.npts), f"{advice}: download it again")
    counts = np.asarray(trace.data, dtype=float)
    offset = float(np.mean(counts))
    factor = kit.UNITS["gal"] * float(scale[1]) / float(scale[2])
    return [
        kit.build_record(
            file,
            counts - offset,
            float(stats.delta),
            "counts",
            factor=factor,
            processed=False,
            component=component.rstrip("12"),
            **{**bridge.codes_of(stats), "channel": component},
            start_time=bridge.utc_time(file, stats.starttime),
            origin_time=bridge.utc_time(file, stats.knet.evot),
            magnitude=(float(stats.knet.mag), ""),
            hypocentre=(float(stats.knet.evla), float(stats.knet.evlo)),
            depth_km=float(stats.knet.evdp),
            station_place=(float(stats.knet.stla), float(stats.knet.stlo)),
            header_peak=kit.printed_number(kit.matched(_KNET_PEAK, header[14])),
            peak_factor=kit.UNITS["gal"],
            event=f"{bridge.utc_time(file, stats.knet.evot):%Y-%m-%d %H:%M:%S} UTC M{stats.knet.mag:g}",
            warnings=[*notes, *warnings, *kit.clipping_warning(counts)],
            processing=[f"recorder offset removed: mean of the record, {offset * factor:.6g} m/s2"],
        )
    ]


def _knet_component(file: kit.SourceFile, channel: str) -> tuple[str, list[str]]:
    """Return the channel code and warnings; if the file extension and the header differ, the extension is used."""
    named = _DIRECTIONS.search(file.path.name)
    component = named[1].upper() + named[2] if named else channel
    note = f"the header says {channel}, but the file name says {component}; the file name is used"
    doubted = kit.doubted_direction(kit.direction(channel.rstrip("12")), kit.direction(component.rstrip("12")), note)
    warnings = [] if component == channel else [doubted]
    if component.endswith("1"):
        warnings.append("KiK-net borehole sensor: motion at depth, not at the ground surface")
    return component, warnings


KNET = Format(
    name="knet",
    what="K-NET, KiK-net ASCII",
    recognised="first words 'Origin Time'",
    unit="counts, with the scale from the header",
    example="AKT0139608110312.EW",
    detect=begins_with(re.compile("Origin Time")),
    parse=read_knet,
    obspy_reads=True,
)


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
        raise kit.unexpected(file.name, f"whole data records of {length} bytes", found, kit.TRUNCATED)
    groups: dict[str, list[Any]] = {}
    for trace in stream:
        groups.setdefault(trace.id, []).append(trace)
    named = enumerate(groups.values(), start=1)
    return kit.usable_channels(
        (partial(_miniseed_channel, file, traces, number, options) for number, traces in named), notes
    )


def _miniseed_channel(file: kit.SourceFile, traces: list[Any], number: int, options: ReadOptions) -> kit.Record:
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


def _byte_order(head: bytes) -> str | None:
    """Return the byte order in which the version number of the header is valid; None if it is valid in neither."""
    if len(head) < _SAC_HEADER:
        return None
    orders = (order for order in "<>" if struct.unpack_from(order + "i", head, _NVHDR)[0] in (6, 7))
    return next(orders, None)


def read_sac(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of a SAC file; `options.units` is required, as the header does not state the unit."""
    order = _byte_order(file.head)
    if order is None:
        raise kit.unexpected(file.name, "a SAC header of version 6 or 7", "none", "is it a SAC file?")
    declared = struct.unpack_from(f"{order}i", file.content, _NPTS)[0]
    available = (len(file.content) - _SAC_HEADER) // 4
    if not 1 <= declared <= available:
        expected = f"{declared} samples (header NPTS)"
        raise kit.unexpected(file.name, expected, f"room for {available}", kit.TRUNCATED)
    for name, word in _COORDINATES.items():
        # obspy shifts longitudes by 360 degrees until they are in range, which never ends for absurd values.
        value = struct.unpack_from(f"{order}f", file.content, 4 * word)[0]
        if value != _UNDEFINED and not abs(value) <= 360.0:
            expected, advice = f"degrees in the header word {name}", "correct the header, or write the file again"
            raise kit.unexpected(file.name, expected, f"{value:g}", advice)
    (trace,), notes = bridge.obspy_stream(file, "SAC")
    stats = trace.stats
    header = stats.sac
    if header.get("iftype", 1) != 1 or not header.get("leven", 1):
        expected = "an equally spaced time series (IFTYPE 1, LEVEN true)"
        found = f"IFTYPE {header.get('iftype')}, LEVEN {header.get('leven')}"
        raise kit.unexpected(file.name, expected, found, "export the record again")
    series = _IDEP_SERIES.get(header.get("idep"))
    if header.get("idep") not in (*_IDEP_SERIES, _ACCELERATION) and kit.kind_of_name(file) not in ("", "acceleration"):
        raise kit.other_kind(file.name, kit.kind_of_name(file))
    if series:
        raise kit.NotAcceleration(f"{file.name}: expected an acceleration, but the header (IDEP) says {series}")
    if options.units is None:
        raise UnitError(
            f"{file.name}: a SAC header does not state the unit of acceleration; {kit.GIVE_UNIT.advice(file.name)}",
            kit.GIVE_UNIT,
        )
    unit = kit.canonical_unit(options.units, "option units")
    inclination, azimuth = header.get("cmpinc"), header.get("cmpaz")
    dip = None if inclination is None else float(inclination) - 90.0
    with np.errstate(invalid="ignore"):  # a signalling NaN; Record reports it
        values = np.asarray(trace.data, dtype=float)
    start = bridge.utc_time(file, stats.starttime) if "nzyear" in header else None
    # The values in the file, which obspy recalculates; NaN if undefined.
    raw = {key: struct.unpack_from(f"{order}f", file.content, at)[0] for key, at in _SAC_WORDS.items()}
    words = {key: math.nan if value == _UNDEFINED else value for key, value in raw.items()}
    extremes = (words["depmin"], words["depmax"])
    extremes = extremes if math.isfinite(sum(extremes)) else (math.nan, math.nan)
    last, step = words["b"] + words["delta"] * (declared - 1), words["delta"]
    # E is a float32, which has few digits for large times.
    if abs(words["e"] - last) > _LAST_STEPS * abs(step) + 1e-6 * abs(last):
        found = f"{declared} samples at {step:g} s from {words['b']:g} s (B) end at {last:g} s"
        notes.append(f"the header states {words['e']:g} s as the time of the last sample (E), {found}")

    def stated(name: str) -> float:
        return float(f"{float(header.get(name, math.nan)):.7g}")  # the header stores float32

    # An origin time O equal to B, the time of the first sample, was never set: no record begins at the origin time.
    to_origin = stated("o") - stated("b")
    scale = float(header.get("scale", 1.0))
    if scale != 1.0:
        notes.append(f"the header word SCALE = {scale:g} is not applied")
    return [
        kit.build_record(
            file,
            values,
            # The header stores dt as float32: 0.01 would become 0.00999999977648.
            float(f"{stats.delta:.7g}"),
            unit,
            processed=None,
            component=stats.channel,
            facing=bridge.seed_direction(stats.channel, None if azimuth is None else float(azimuth), dip),
            **bridge.codes_of(stats),
            event=str(header.get("kevnm", "")).strip(),
            sensor_depth=float(header.get("stdp", math.nan)),
            start_time=start,
            origin_time=kit.later(start, to_origin) if math.isfinite(to_origin) and to_origin != 0.0 else None,
            magnitude=(stated("mag"), ""),
            hypocentre=(stated("evla"), stated("evlo")),
            depth_km=stated("evdp"),
            distance_km=stated("dist"),
            station_place=(stated("stla"), stated("stlo")),
            # The larger absolute value of DEPMIN and DEPMAX, if both are set and one is not 0.
            header_peak=(max(map(abs, extremes)) or math.nan, 0.0),
            warnings=notes,
        )
    ]


SAC = Format(
    name="sac",
    what="SAC, binary",
    recognised="header version",
    unit="must be given (--units)",
    processed="unknown",
    example="T001230.HNE.sac",
    detect=lambda head, name: _byte_order(head) is not None,
    parse=read_sac,
    obspy_reads=True,
)
