"""COSMOS strong-motion data format, version 1.20 (V0, V1, V2, V1c, V2c).

Each channel has 13 lines of text, integers, reals and comments, then one or more series, each after a line such as
``13400 acceleration pts, approx  67 secs, units=g.     (02)Format=(8f9.6)``. The channel ends at a
line ``End-of-data`` or ``/&``. Reference: COSMOS Strong Motion Programs Board (2001), Strong Motion Data Format 1.20.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused, UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with
from rockpulse.readers.kit.cosmos_header import TITLE, CosmosHeader, fortran_layout, held_series, read_cosmos_header

_SERIES = re.compile(
    r"\s*(\d{1,9})\s+(\D{0,40}?)\s*pts\b.{0,60}?units\s*=\s*([^\s(,]{0,20}?)\s*(?=[\s(,]|Format)(?:\(\s*(\d{1,3})\s*\))?",
    re.ASCII | re.IGNORECASE,
)
_GEOLOGY = re.compile(r".*?site geology:\s*(.*?)\s*$", re.IGNORECASE)
#: Pattern of network and number of the earthquake before the channel codes: RcrdId: US.1000hyfh.NP.8040.HNE.01
_EVENT_ID = re.compile(r"\s*\|\s*RcrdId:\s*(\w{2}\.\w+)\.\w{2}\.\w+\.\w{3}\.", re.ASCII | re.IGNORECASE)
_END = re.compile(r"\s*(?:end-of-data|/&)", re.IGNORECASE)
#: Size of each unit of this format, of which some occur in no other [m/s2].
_UNITS = kit.UNITS | {
    "in/s2": 0.0254,
    "mg": 1e-3 * kit.STANDARD_GRAVITY,
    "ug": 1e-6 * kit.STANDARD_GRAVITY,
    "counts": 1.0,
}
_CODES: dict[int | None, str] = {2: "g", 4: "cm/s2", 7: "in/s2", 10: "gal", 11: "mg", 12: "ug", 50: "counts"}
_FACTORS = {22: "microvolts per count", 42: "sensor sensitivity, V/g", 47: "sensor gain"}
#: Values of header integer 2 for quantities other than a linear acceleration.
_OTHER_QUANTITIES = {2: "velocity", 3: "displacement", 10: "angular acceleration", 11: "angular velocity"}
#: Values of header integer 19 for stations whose sensors may be at depth.
_DEPTHS = {9: "underground observatory", 14: "tunnel", 50: "geotechnical array"}
_CLOSING = 3  # blank lines may follow the closing line
#: Relative tolerance of sensitivities: calibrated values deviate by some percent, wrong ones by a factor of 2 or more.
_SENSITIVITY_TOLERANCE = 0.1
_LEAST_FACTOR = 1e-9  # smallest possible value of a factor of the gain, in any unit
_VELOCITY_SENSORS = range(1001, 2000)


@dataclass(frozen=True)
class _Series:
    """The heading of a series: line index, number of samples, kind of motion, unit, and code of the unit."""

    at: int
    count: int
    kind: str
    unit: str
    code: int | None
    warnings: tuple[str, ...] = ()


def read_cosmos(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the acceleration of every channel; velocity and displacement are ignored."""
    lines = kit.text_lines(file.content)
    titles = (at for at, line in enumerate(lines) if " text lines)" in line and TITLE.match(line[: kit.LONGEST_LINE]))
    starts = list(titles)
    if not starts or starts[0] != 0:
        found = f"found {lines[0][:60]!r}"
        raise RecordFormatError(f"{file.name}:1: expected '(Format v01.20 with 13 text lines)', {found}")
    last = [kit.last_of_equal(lines, start) for start in starts]
    notes = [note for first, at in zip(starts, last, strict=True) for note in kit.repeated_marker(first, at)]
    starts = sorted(set(last))
    spans, copies = kit.distinct_sections(lines, list(zip(starts, [*starts[1:], len(lines)], strict=True)))
    headers = [read_cosmos_header(file.name, lines, start, end) for start, end in spans]
    closed = any(_END.match(line) for line in lines[-_CLOSING:])
    missing = kit.completeness(file.name, (header.counted() for header in headers), closed=closed)
    numbered = enumerate(zip(headers, spans, strict=True), start=1)
    channels = (partial(_channel, file, lines, header, end, number) for number, (header, (_, end)) in numbered)
    return kit.usable_channels(channels, (*missing, *notes, *copies))


def _channel(file: kit.SourceFile, lines: Sequence[str], header: CosmosHeader, end: int, number: int) -> kit.Record:
    kind = header.kind.lower()
    code = header.integer(2)
    where = f"{file.name}:{header.start + 1}"
    if code in _OTHER_QUANTITIES and "accel" in kind:
        conflict = f"the title says {header.kind!r}, but integer 2 of the header says {code}, {_OTHER_QUANTITIES[code]}"
        raise RecordFormatError(f"{where}: {conflict}; find out which is right and repair the header")
    if "accel" not in kind:
        raise kit.no_acceleration(where, "acceleration", repr(header.kind))
    series = _acceleration(file.name, lines, header, end)
    where, first = f"{file.name}:{series.at + 1}", series.at + 1
    unit = _unit(series, where)
    per_row, width = fortran_layout(lines[series.at], where)
    kit.check_count(where, series.count, series.count if first < end else 0)
    samples = kit.fixed_width(lines[first:end], first + 1, width, per_row, series.count, file.name)
    step, notes = _interval(header, series.count, file.name)
    notes += series.warnings
    rows = -(-series.count // per_row)
    behind = range(first + rows, end)
    stop = next((at for at in behind if _END.match(lines[at]) or _SERIES.match(lines[at][: kit.LONGEST_LINE])), end)
    notes += kit.surplus(lines, first + rows, stop, used=width * (series.count - (rows - 1) * per_row))
    if unit == "counts":
        factor = _per_count(header, where)
    else:
        factor = _UNITS[unit]
        missing = np.flatnonzero(samples == header.unknown)
        if missing.size:
            which = f"the first is sample {missing[0] + 1}) are {header.unknown:g}, which means unknown"
            found = f"{missing.size} of {samples.size} samples ({which}"
            raise RecordRefused(f"{where}: {found}; end the record before this sample, or get a complete one")
    network, station, location, seed = header.codes()
    channel, component, place = header.channel()
    start_time, time_notes = header.start_time()
    structural = header.structural()
    peak, peak_notes = _peak(header, factor)
    notes += [*peak_notes, *held_series(header, lines[series.at], step, samples)]
    if site := _DEPTHS.get(header.integer(19) or 0):
        notes.append(f"the station is of the type {site!r}: the sensor may lie at depth")
    return kit.build_record(
        file,
        samples,
        step,
        unit,
        number=number,
        factor=factor,
        # "Raw", "Uncorrected" and "Corrected acceleration".
        processed=kind.startswith("corrected"),
        component=f"{component} ({place})" if place else component,
        facing=header.facing(),
        structural=structural,
        channel=seed or (channel if structural or place else ""),
        network=network,
        station=station,
        location=location,
        station_name=header.text[4][40:].strip(),
        event=re.sub(r"^(?:rcrd|record) of\s+", "", " ".join(header.text[1].split()), flags=re.IGNORECASE),
        start_time=start_time,
        event_id=kit.first_match(_EVENT_ID, header.comments),
        origin_time=kit.written(header.text[3]),
        magnitude=kit.preferred((header.real(at), scale) for at, scale in enumerate(("Mw", "Ms", "ML", ""), start=13)),
        hypocentre=(header.real(10), header.real(11)),
        depth_km=header.real(12),
        distance_km=header.real(17),
        station_place=(header.real(1), header.real(2)),
        site_class=kit.matched(_GEOLOGY, header.text[5]),
        header_peak=peak,
        peak_factor=1.0,
        warnings=[*notes, *time_notes],
    )


def _acceleration(name: str, lines: Sequence[str], header: CosmosHeader, end: int) -> _Series:
    """Return the heading of the acceleration of a channel; raise an error unless exactly one is found."""
    found: list[_Series] = []
    begins = header.end
    for at in range(header.end, end):
        match = _SERIES.match(lines[at][: kit.LONGEST_LINE]) if "pts" in lines[at].lower() else None
        if match and not (found and found[-1].at >= at):
            code = int(match[4]) if match[4] else None
            last = kit.last_of_equal(lines, at)
            found.append(_Series(last, int(match[1]), match[2].lower(), match[3], code, kit.repeated_marker(at, last)))
            begins = at if len(found) == 1 else begins
    if not found or begins != header.end:
        line = repr(lines[header.end].strip()[:60]) if header.end < end else "the end of the channel"
        expected = "a line such as '13400 acceleration pts, approx  67 secs, units=g. (02)Format=(8f9.6)'"
        advice = "the file is damaged or cut off: download it again"
        raise kit.unexpected(f"{name}:{header.end + 1}", expected, str(line), advice)
    ends = [*(series.at for series in found[1:]), end]
    linear = [at for at, series in enumerate(found) if "accel" in series.kind and "ang" not in series.kind]
    if linear:
        blocks, copies = kit.distinct_sections(lines, [(found[at].at, ends[at]) for at in linear], "series")
        if len(blocks) > 1:
            where, other = f"{name}:{blocks[1][0] + 1}", f"a second one (the first is in line {blocks[0][0] + 1})"
            raise kit.unexpected(where, "one series of acceleration in the channel", other, kit.FILE_DAMAGED)
        series = found[linear[0]]
        return replace(series, warnings=(*series.warnings, *copies))
    where, advice = f"{name}:{header.end + 1}", "read the acceleration file"
    raise kit.no_acceleration(where, "acceleration", repr(found[0].kind), advice)


def _unit(series: _Series, where: str) -> str:
    """Return the unit of a series; raise an error if the words and the code in its heading contradict each other."""
    word = series.unit.lower().rstrip(".").replace("sec", "s")
    named = "" if not word else word if word in _UNITS else kit.canonical_unit(series.unit, where)
    if series.code is None and named:
        return named
    coded = _CODES.get(series.code)
    if coded is None or (named and (_UNITS[named] != _UNITS[coded] or (named == "counts") != (coded == "counts"))):
        known = ", ".join(f"{unit} ({code:02d})" for code, unit in _CODES.items())
        found = f"the unit has the name {series.unit!r} and the code {series.code}, expected one of {known}"
        raise UnitError(f"{where}: {found}; find out which is right and repair the line")
    return named or coded


def _peak(header: CosmosHeader, factor: float) -> tuple[tuple[float, float], list[str]]:
    """Return the stated peak with half a unit of its last digit [m/s2], and warnings."""
    coded, (number, unit) = header.real(64) * factor, header.peak()
    own = None if unit.lower() == "counts" else _UNITS.get(kit.spelled_unit(unit))
    if own is None or not number:
        return (coded, 0.0), []
    value, rounding = (one * own for one in kit.printed_number(number))
    gap = abs(abs(value) - abs(coded))
    if gap <= max(1.01 * rounding, kit.PEAK_TOLERANCE * abs(coded)):
        return (coded, 0.0), []
    said, real = (abs(one) / kit.STANDARD_GRAVITY for one in (value, coded))
    both = f"the header states peaks of {said:.4g} g (text) and {real:.4g} g (floating-point value 64)"
    return (value, rounding), [] if np.isnan(coded) else [both]


def _per_count(header: CosmosHeader, where: str) -> float:
    """Return m/s2 per count, which is 1e-6 r22 / (r42 r47) g with floating-point header values r22, r42 and r47.

    r22 [microvolts] is the size of a count, r42 [V/g] the sensitivity and r47 the gain. Full-scale output r43 [V] and
    range r44 [g] of the sensor must agree with r42 r47 if they are stated; if r47 is not 1 they are required, because
    programs differ in whether the gain is part of r42.
    """
    if header.integer(52) in _VELOCITY_SENSORS:
        sensor = f"integer 52 of the header is {header.integer(52)}"
        raise kit.NotAcceleration(f"{where}: counts of a velocity sensor ({sensor}); {kit.ACCELERATION_FILE}")
    missing = [f"{number} ({what})" for number, what in _FACTORS.items() if not header.real(number) >= _LEAST_FACTOR]
    advice = "read the V1 or V2 file of the record, or fill in the header"
    if missing:
        lacking = f"the header lacks floating-point value {', '.join(missing)}"
        raise RecordRefused(f"{where}: counts without a gain: {lacking}; {advice}")
    gain = header.real(47)
    sensitivity = header.real(42) * gain
    nominal = header.real(43) / header.real(44) if header.real(44) > 0.0 else float("nan")
    if (gain != 1.0 or np.isfinite(nominal)) and not abs(nominal - sensitivity) <= _SENSITIVITY_TOLERANCE * sensitivity:
        raise RecordRefused(
            f"{where}: counts with a doubtful gain: sensitivity x gain (floating-point header values 42, 47) is "
            f"{sensitivity:g} V/g, output and range of the sensor (values 43, 44) give {nominal:g} V/g; {advice}"
        )
    return 1e-6 * header.real(22) / sensitivity * kit.STANDARD_GRAVITY


def _interval(header: CosmosHeader, count: int, name: str) -> tuple[float, list[str]]:
    """Return the sampling interval [s] that fits the stated length, and warnings."""
    raw, series, length = header.real(34), 1e-3 * header.real(62), header.real(63)
    stated = [step for step in (series, raw) if step > 0.0]
    where = f"{name}:{header.start + 1}"
    if not stated:
        expected = "a sampling interval above 0 (floating-point value 34 [s] or 62 [ms] of the header)"
        raise kit.unexpected(where, expected, "none")
    # Some agencies count the steps between the samples, others the samples.
    fitting = [step for step in stated if abs(count * step - length) <= 0.005 * length + 1.5 * step]
    if max(stated) - min(stated) <= 1e-3 * max(stated):
        if np.isnan(length) or fitting:
            return stated[0], []
        lasting = f"{count} samples at {stated[0]:g} s last {count * stated[0]:g} s"
        return stated[0], [f"the header states {length:g} s, {lasting}"]
    if len(fitting) != 1:
        raise RecordFormatError(
            f"{where}: floating-point values 34 and 62 of the header state sampling intervals of {raw:g} and "
            f"{series:g} s, and the length of {length:g} s (value 63) for {count} samples does not decide between "
            "them; find out which is right"
        )
    both = f"the header states intervals of {raw:g} s (raw record) and {series:g} s (series; values 34 and 62)"
    return fitting[0], [f"{both}; {fitting[0]:g} s is used, which fits the stated length of {length:g} s"]


COSMOS = Format(
    name="cosmos",
    what="COSMOS 1.20 V0, V1, V2",
    recognised="first line '(Format v01.20 with 13 text lines)'",
    unit="as stated for each series: cm/s2, g, gal, counts with gain",
    processed="by title",
    example="CE23837.V1C",
    detect=begins_with(TITLE),
    parse=read_cosmos,
)
