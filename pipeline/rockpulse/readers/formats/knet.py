"""K-NET and KiK-net ASCII files of NIED (Japan), through obspy.

obspy returns counts with an offset; it has already converted Japanese time to UTC and subtracted the 15 s that the
logger adds to the record time. The counts are scaled and the offset is subtracted here.
"""

import re

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with
from rockpulse.readers.kit.obspy_bridge import codes_of, obspy_stream, utc_time

_SCALE = re.compile(r"Scale Factor\s+(\d+\.?\d*)\s*\(gal\)\s*/\s*(\d+\.?\d*)", re.IGNORECASE)
_PEAK = re.compile(r"Max\. Acc\. \(gal\)\s+(-?\d+\.?\d*)", re.IGNORECASE)
_HEADER_LINES = 17
_DIRECTIONS = re.compile(r"\.(EW|NS|UD)([12]?)$", re.IGNORECASE)


def read_knet(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file, and subtract the mean of the whole record as its offset."""
    lines = kit.text_lines(file.content)
    kit.check_count(f"{file.name}:{len(lines)}", _HEADER_LINES, len(lines), "header lines")
    header = [line[: kit.LONGEST_LINE] for line in lines[:_HEADER_LINES]]
    scale = _SCALE.match(header[13])
    if not scale or float(scale[1]) == 0.0 or float(scale[2]) == 0.0:
        raise kit.unexpected(f"{file.name}:14", "'Scale Factor' as 2000(gal)/8388608", repr(header[13].strip()))
    # The error states the line of a damaged number, which obspy does not.
    kit.free_numbers(lines[_HEADER_LINES:], _HEADER_LINES + 1, file.name)
    # obspy accepts only ASCII and LF.
    content = "\n".join([*header, *lines[_HEADER_LINES:], ""]).encode("ascii", errors="replace")
    (trace,), notes = obspy_stream(file, "KNET", content)
    stats = trace.stats
    expected = float(stats.knet.duration) * float(stats.sampling_rate)
    if not 0.0 < expected < len(file.content):
        wanted = "a sampling frequency and a duration that fit the file"
        raise kit.unexpected(f"{file.name}:11", wanted, f"{stats.sampling_rate} Hz and {stats.knet.duration} s")
    declared = round(expected)
    kit.check_count(f"{file.name}:{len(lines)}", declared, int(stats.npts))
    component, warnings = _component(file, stats.channel)
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
            **{**codes_of(stats), "channel": component},
            start_time=utc_time(file, stats.starttime),
            origin_time=utc_time(file, stats.knet.evot),
            magnitude=(float(stats.knet.mag), ""),
            hypocentre=(float(stats.knet.evla), float(stats.knet.evlo)),
            depth_km=float(stats.knet.evdp),
            station_place=(float(stats.knet.stla), float(stats.knet.stlo)),
            header_peak=kit.printed_number(kit.matched(_PEAK, header[14])),
            peak_factor=kit.UNITS["gal"],
            event=f"{utc_time(file, stats.knet.evot):%Y-%m-%d %H:%M:%S} UTC M{stats.knet.mag:g}",
            warnings=[*notes, *warnings, *kit.clipping_warning(counts)],
            processing=[f"recorder offset removed: mean of the record, {offset * factor:.6g} m/s2"],
        )
    ]


def _component(file: kit.SourceFile, channel: str) -> tuple[str, list[str]]:
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
