"""SMC files of the USGS National Strong-Motion Project.

A file has 11 lines of text, 48 integers (8I10), 50 floating-point values (5E15.7), comment lines that begin with ``|``,
and accelerations [cm/s2] in touching fields of 10 characters. Layout: https://escweb.wr.usgs.gov/nsmp-data/smcfmt.html
"""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions

#: Titles of the series of types 1 to 6, in this order.
_KINDS = "UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE SPECTRA|FOURIER"
_TITLE = re.compile(rf"\s?([1-6])\s+({_KINDS})", re.IGNORECASE)
#: Number of lines of text, and indices of the first line of floating-point values and of the first line after them.
_TEXT_LINES, _REALS, _FIRST_COMMENT = 11, 17, 27
_STATION = re.compile(r"station\s*=\s*(.*?)\s*component\s*=\s*(.*)", re.IGNORECASE)
_PEAK = re.compile(r"pk acc\s*=\s*(-?\d+\.?\d*(?:E[+-]?\d+)?)", re.IGNORECASE)
_EVENT_ID = re.compile(r"\|\s*EventID:\s*(\w{1,40})\s*$", re.ASCII | re.IGNORECASE)
_EVENT = re.compile(r"\s*(\d{4})\s+(\d+)\s+(\d+)\s+(\d+)\s+(.*)", re.ASCII)
_RATE_LIMIT = 10_000.0  # limit of the sampling rate [1/s]; some files state an impossible rate
_UNIT = "cm/s2"
#: Values of header integer 19 for a building, bridge, dam or other structure; integers 27 and 28 are 0 in the free
#: field of a bridge or dam.
_STRUCTURES = (1, 2, 3, 4)
_FREE_FIELD_AT = {2: 27, 3: 28}


def is_smc(head: bytes, name: str) -> bool:
    """Return whether the first line is the number and title of a series, and rows of integers follow."""
    lines = kit.text_lines(head[:4000])
    return bool(lines and _TITLE.match(lines[0])) and (
        len(lines) <= _TEXT_LINES or bool(re.fullmatch(r"[\s\d-]+", lines[_TEXT_LINES]))
    )


def read_smc(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file; raise kit.NotAcceleration for velocity, displacement and spectra."""
    lines = kit.text_lines(file.content)
    title = _TITLE.match(lines[0])
    if title is None:
        expected = "the kind of series, '2 CORRECTED ACCELEROGRAM' and the like"
        raise kit.unexpected(f"{file.name}:1", expected, repr(lines[0][:40]), "is it an SMC file?")
    kind = title[1]
    if kind not in "12":
        found = f"type {kind}, {title[2].lower()}"
        raise kit.no_acceleration(f"{file.name}:1", "an accelerogram (type 1 or 2)", found)
    kit.check_count(f"{file.name}:{len(lines)}", _FIRST_COMMENT, len(lines), "header lines")
    integers = kit.fixed_width(lines[_TEXT_LINES:], _TEXT_LINES + 1, 10, 8, 48, file.name)
    reals = kit.fixed_width(lines[_REALS:], _REALS + 1, 15, 5, 50, file.name)
    integers = np.where(integers == integers[0], np.nan, integers)
    reals = np.where(reals >= 0.99 * reals[0], np.nan, reals)
    comments = 0 if np.isnan(integers[15]) else int(integers[15])
    if comments < 0:
        raise kit.unexpected(f"{file.name}:{_TEXT_LINES + 2}", "a number of comment lines (integer 16)", str(comments))
    first = _FIRST_COMMENT + comments
    for number, line in enumerate(lines[_FIRST_COMMENT:first], 1):
        if not line.startswith("|"):
            expected = f"comment {number} of {comments}, a line that begins with '|'"
            raise kit.unexpected(f"{file.name}:{_FIRST_COMMENT + number}", expected, repr(line[:40]))
    block = _block(file.name, lines, first, integers, reals, raw=kind == "1")
    text = [line[: kit.LONGEST_LINE] for line in lines[:_TEXT_LINES]]
    station, peak = _STATION.search(text[5]), _PEAK.search(text[6])
    name, component = (station[1], station[2].strip()) if station else ("", "")
    event = _EVENT.match(text[3])
    known = [float(f"{value:.7g}") for value in reals]  # printed from float32: 5.8000002
    latitude, longitude, depth, *sizes = known[2:9]
    start_time, notes = _start_time(integers, event)
    # On a structure by integers 19, 27 and 28, or 25 (floor); else by the name of the station.
    structural = not np.isnan(integers[24]) or kit.on_structure(name)
    if integers[18] in _STRUCTURES:
        free = _FREE_FIELD_AT.get(int(integers[18]))
        structural = free is None or integers[free - 1] != 0.0
    if integers[17] > 0.0:
        notes.append("the agency flags a problem with this record (integer 18 of the header)")
    return [
        kit.build_record(
            file,
            block.samples,
            block.dt,
            _UNIT,
            processed=kind == "2",
            component=component,
            facing=_facing(component, integers),
            structural=structural,
            station="" if np.isnan(integers[29]) else str(int(integers[29])),
            station_name=name,
            event=" ".join(event[5].split()) if event else "",
            start_time=start_time,
            event_id=kit.first_match(_EVENT_ID, lines[_FIRST_COMMENT:first]),
            origin_time=_origin(event) if event else None,
            magnitude=kit.preferred(zip(sizes, ("Mw", "Ms", "ML", ""), strict=True)),
            hypocentre=(latitude, longitude),
            depth_km=depth,
            distance_km=known[16],
            station_place=(known[10], known[11]),
            header_peak=kit.printed_number(peak[1] if peak else ""),
            original_peak=block.peak,
            warnings=[*block.warnings, *_held_extremes(reals, block), *notes],
        )
    ]


def _block(
    name: str, lines: Sequence[str], first: int, integers: np.ndarray, reals: np.ndarray, raw: bool
) -> kit.ChannelSamples:
    """Return the samples; unequally spaced samples of a digitised trace are resampled."""
    count = 0 if np.isnan(integers[16]) else int(integers[16])
    rate = reals[1]
    pairs = raw and np.isnan(rate)
    if not pairs and not 0.0 < rate <= _RATE_LIMIT:
        expected = f"a sampling rate (floating-point value 2 of the header) above 0 and at most {_RATE_LIMIT:g} per s"
        raise kit.unexpected(f"{name}:{_REALS + 1}", expected, "none" if np.isnan(rate) else str(rate))
    values, warnings = kit.fixed_block(name, lines, (first, len(lines)), 10, 8, count, _TITLE)
    if not pairs:
        return kit.ChannelSamples(values, 1.0 / rate, _UNIT, np.arange(count) / rate, values, warnings)
    if count % 2:
        raise RecordFormatError(
            f"{name}:{_TEXT_LINES + 3}: expected an even number of values for (time, acceleration) pairs, found {count}"
        )
    times, samples = values[::2], values[1::2]
    even, step, notes = kit.make_even(times, samples, name, first + 1, 4, kit.UNITS[_UNIT] / kit.STANDARD_GRAVITY)
    return kit.ChannelSamples(even, step, _UNIT, times, samples, (*warnings, *notes))


def _held_extremes(reals: np.ndarray, block: kit.ChannelSamples) -> list[str]:
    """Return warnings if header values 29 to 32 (maximum, minimum and their times) contradict the samples."""
    notes: list[str] = []
    if reals[29] == reals[31] == 0.0:  # the fields were not filled in
        return notes
    for number, sign, what in ((29, 1.0, "largest"), (31, -1.0, "least")):
        stated, found = reals[number], sign * float(np.max(sign * block.values))
        if abs(stated - found) > kit.PEAK_TOLERANCE * block.peak:  # false for NaN, a value that is not stated
            value = f"{stated:g} cm/s2 as the {what} value, but the samples have {found:g}"
            notes.append(f"floating-point value {number + 1} of the header states {value}")
        notes += kit.held_peak_time(f"{reals[number - 1]:.6g}", block.times, np.maximum(sign * block.values, 0.0))
    return notes


def _facing(component: str, integers: np.ndarray) -> kit.Direction:
    """Return the direction from the component and header integers 13 (angle from the vertical) and 14 (azimuth)."""
    upright, azimuth = integers[12], integers[13]
    coded = kit.Direction()
    if upright in (0.0, 180.0):
        coded = kit.Direction("vertical", sign=1.0 if upright == 0.0 else -1.0)
    elif 0.0 <= azimuth <= 360.0:
        coded = kit.Direction("horizontal", float(azimuth) % 360.0)
    said = " and ".join("none" if np.isnan(value) else f"{value:g}" for value in (upright, azimuth))
    note = f"the text says {component!r}, but integers 13 and 14 of the header say {said}: the direction is unknown"
    return kit.held_direction(kit.direction(component), coded, note)


def _start_time(integers: np.ndarray, event: re.Match[str] | None) -> tuple[datetime | None, list[str]]:
    """Return the UTC time of the first sample (None if it is too far from the earthquake), and warnings."""
    moment = integers[1:7]
    if np.any(np.isnan(moment)):
        return None, []
    year, day, hour, minute, second, millisecond = (int(value) for value in moment)
    start = kit.later(kit.instant((year, 1, 1), (hour, minute, second)), 86_400.0 * (day - 1) + 1e-3 * millisecond)
    if start is None or start.year != year or not 0 <= millisecond < 1000:
        words = " ".join(f"{value:.0f}" for value in moment)
        return None, [
            f"{words} (integers 2 to 7: year, day, hour, minute, second, millisecond) is not a valid start time"
        ]
    return kit.near_event(start, _origin(event)) if event else (start, [])


def _origin(event: re.Match[str]) -> datetime | None:
    year, month, day, time = (int(event[group]) for group in range(1, 5))
    return kit.instant((year, month, day), (time // 100, time % 100, 0))


SMC = Format(
    name="smc",
    what="USGS SMC accelerogram",
    recognised="first line '1 UNCORRECTED' or '2 CORRECTED ACCELEROGRAM'",
    unit="cm/s2",
    processed="by type",
    example="2516b_a.smc",
    detect=is_smc,
    parse=read_smc,
)
