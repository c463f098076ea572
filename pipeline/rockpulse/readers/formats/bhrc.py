"""BHRC volume 1 files of Iran (Building and Housing Research Center), uncorrected.

Channels are as in `kit.csmip_layout`, with accelerations in g/10 in rows of 10 fields of 13 characters. The line of the
station contains the azimuths of L and T. The time in the header is the origin time.
"""

import re
from collections.abc import Sequence

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with
from rockpulse.readers.kit.csmip_layout import HEADER_LINES, TEXT_LINES, channels

_TITLE = re.compile(r"\s*\*\s*vol1\w*\s+file\s*:", re.IGNORECASE)
_WIDTH, _PER_ROW = 13, 10
_COMPONENTS = 3
_COMPONENT = re.compile(r"\s*comp\s+([LVT])\s*\d*\s*$", re.IGNORECASE)
_STATION = re.compile(r"(.*?)\s+station\b", re.IGNORECASE)
_AZIMUTH = r"azimuth\b.*\b{}\s+(\d{{1,3}}(?:\.\d*)?)(?!\S)"
_ORIGIN = re.compile(r"\s*origin time\s*:\s*(.*)", re.IGNORECASE)
_DEPTH = re.compile(r".*?\bFD\s*(\d{1,3}(?:\.\d{0,3})?)\s*km", re.ASCII | re.IGNORECASE)
_DURATION = re.compile(r".*?duration\s*=\s*(\d{1,6}(?:\.\d{0,9})?)", re.IGNORECASE)
#: Tolerance of the stated duration [steps], which may count the samples or the steps between them.
_DURATION_STEPS = 2.0
_SQUARE = 3.0  # largest deviation of L and T from a right angle [degrees]


def read_bhrc(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every channel; `options` is not used, because the file states unit and interval."""
    lines, spans, copies = channels(file, _TITLE, "* VOL1DS FILE:", HEADER_LINES)
    records = [_channel(file, lines, span, number) for number, span in enumerate(spans, start=1)]
    starts = (start for start, _ in spans)
    counts = (kit.Counted(at + 1, "", one.component, _COMPONENTS) for at, one in zip(starts, records, strict=True))
    units = kit.held_units((record.component, record.source_unit) for record in records)
    missing = kit.completeness(file.name, counts, "files of this format have")
    azimuths = {record.component: record.azimuth for record in records}
    turn = abs(azimuths.get("T", np.nan) - azimuths.get("L", np.nan)) % 180.0
    if abs(turn - 90.0) > _SQUARE:  # false for NaN, an unknown azimuth
        which = f"{azimuths['L']:g} and {azimuths['T']:g} degrees"
        units.append(f"the azimuths of L and T, {which}, are not at right angles")
    return kit.with_warnings(records, (*missing, *copies, *units))


def _channel(file: kit.SourceFile, lines: Sequence[str], span: kit.Span, number: int) -> kit.Record:
    start, end = span
    header, first = [line[: kit.LONGEST_LINE] for line in lines[start : start + TEXT_LINES]], start + HEADER_LINES
    count = kit.declared_points(header[10], f"{file.name}:{start + 11}")
    unit = kit.pair_unit(header[11], f"{file.name}:{start + 12}")
    # Floating-point header value 9 is the sampling rate; it begins the second row, as a row contains eight values.
    rate = float(kit.fixed_width([lines[start + 21][:_WIDTH]], start + 22, _WIDTH, 1, 1, file.name)[0])
    duration = kit.matched(_DURATION, header[10])
    if not rate > 0.0 or (duration and abs(float(duration) * rate - count) > _DURATION_STEPS):
        expected = f"a sampling rate that gives {count} points in {duration or 'an unknown number of'} s"
        raise kit.unexpected(f"{file.name}:{start + 22}", expected, f"{rate:g}")
    samples, notes = kit.fixed_block(file.name, lines, (first, end), _WIDTH, _PER_ROW, count)
    component = kit.matched(_COMPONENT, header[6]).upper()
    if not component:
        where, expected = f"{file.name}:{start + 7}", "'COMP L1', 'COMP V2' or 'COMP T3'"
        raise kit.unexpected(where, expected, repr(header[6].strip()))
    origin, letter = kit.matched(_ORIGIN, header[2]), header[4].strip().upper()
    if letter in ("L", "V", "T") and letter != component:
        notes = (f"the header names both {letter} and {component} as the component; one of them is wrong", *notes)
    azimuth, facing = re.search(_AZIMUTH.format(component), header[7], re.IGNORECASE), kit.direction(component)
    if component != "V" and azimuth and float(azimuth[1]) <= 360.0:
        facing = kit.Direction("horizontal", float(azimuth[1]) % 360.0)
    return kit.build_record(
        file,
        samples,
        1.0 / rate,
        unit,
        number=number,
        processed=False,
        component=component,
        facing=facing,
        station_name=kit.matched(_STATION, header[7]).strip(),
        event=" ".join(origin.split()),
        origin_time=kit.written(origin),
        magnitude=kit.magnitudes(header[8]),
        hypocentre=kit.coordinates(header[8]),
        depth_km=kit.matched(_DEPTH, header[8]),
        station_place=kit.coordinates(header[7]),
        warnings=notes,
    )


BHRC = Format(
    name="bhrc",
    what="BHRC (Iran) volume 1",
    recognised="first line '* VOL1DS FILE:'",
    unit="g/10, from the header",
    example="5520-1.V1",
    detect=begins_with(_TITLE),
    parse=read_bhrc,
)
