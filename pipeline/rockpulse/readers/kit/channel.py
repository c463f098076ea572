"""Makes the `Record` of a channel from its samples, with the checks that all formats share."""

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from datetime import datetime
from itertools import combinations
from typing import Unpack

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.kit.direction import Direction, direction, vertical_if_so
from rockpulse.readers.kit.facts import Facts, clock_fault, stated
from rockpulse.readers.kit.text import TRUNCATED, UNITS, other_readings, unexpected
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record.components import SHALLOW
from rockpulse.record.record import STANDARD_GRAVITY, Record, record_id
from rockpulse.warning_text import WarningText

#: Relative tolerance of a stated peak, in addition to its rounding; a larger difference gives a warning.
PEAK_TOLERANCE = 0.02
#: Ratio of the stated and the actual peak above which their units differ, or part of the file is missing.
OTHER_PEAK = 1.5
#: Limits of a credible peak [g]; a peak outside is reported with its meaning in other units.
CREDIBLE_PEAK_G = (1e-6, 5.0)
#: Longest credible sampling interval [s]; accelerographs record 40 to 1000 samples per second.
CREDIBLE_INTERVAL = 0.1
#: Largest credible depth of a sensor [m], about that of the deepest boreholes; headers have -9999 for unknown depths.
_DEEPEST_SENSOR = 10e3
# Starts at the first blank only; otherwise the run time for a line of blanks would grow with its length squared.
_DEGREES = re.compile(r"(?<!\s)\s*DEG(?:REES)?$", re.IGNORECASE)
#: Number of samples that are compared first to find copies of a channel; signs of a copy, with the words for each.
_FIRST, SIGNS = 1000, {1.0: "", -1.0: " with the opposite sign"}
#: Number of equal consecutive samples at an extreme value that indicate clipping.
RUN = 5
#: Number of equal samples at each of several flat crests, and number of such crests, that also indicate clipping.
CREST, CRESTS = 3, 2
#: Smallest distance of a clipped value from the mid-range [resolution steps]; nearer values may be equal by rounding.
STEPS_TO_EXTREME = 100
#: Smallest fall of the trace beside a run of equal samples, over half the length of the run [resolution steps]. A
#: smooth crest that is flattened by rounding is a parabola, which falls by about 4 steps there.
STEPS_BESIDE = 10
#: Full scale of a 24-bit recorder [counts], and the share of it above which a peak is reported: the samples of an
#: overdriven recorder need not be equal, and may change sign.
FULL_SCALE, NEAR_FULL_SCALE = 2**23, 0.99


def odd_peak(peak: float, unit: str, factor: float) -> WarningText:
    """Return the warning about a peak [m/s2] that is too large or small to be credible; an empty `unit` means m/s2."""
    unit, factor = (unit, UNITS.get(unit, abs(factor))) if unit else ("m/s2", 1.0)
    named = unit if unit in UNITS else f"{unit} x {factor:.4g} m/s2"
    readings = other_readings(peak / factor, unit)
    return WarningText("odd_peak", peak=peak / STANDARD_GRAVITY, unit=named, readings=readings)


def _peak_warnings(peak: float, unit: str, factor: float, header_peak: float, rounding: float) -> list[WarningText]:
    warnings = []
    g, stated = STANDARD_GRAVITY, abs(header_peak)
    gap = abs(stated - peak)
    if gap > PEAK_TOLERANCE * max(peak, stated) and gap > rounding:
        peaks = {"stated": stated / g, "found": peak / g}
        if max(peak, stated) >= OTHER_PEAK * min(peak, stated):
            warnings.append(WarningText("header_peak", **peaks, decides=stated > 0.0))
        else:
            sense = "less" if peak < stated else "more"
            warnings.append(WarningText("header_peak_near", **peaks, share=100.0 * gap / stated, sense=sense))
    low, high = CREDIBLE_PEAK_G
    if not low <= peak / g <= high:
        warnings.append(odd_peak(peak, unit, factor))
    return warnings


def build_record(
    file: SourceFile,
    samples: np.ndarray,
    dt: float,
    unit: str,
    *,
    number: int = 1,
    format: str = "",
    processed: bool | None,
    factor: float | None = None,
    component: str = "",
    facing: Direction | None = None,
    structural: bool = False,
    channel: str = "",
    network: str = "",
    station: str = "",
    location: str = "",
    station_name: str = "",
    event: str = "",
    start_time: datetime | None = None,
    sensor_depth: float = float("nan"),
    header_peak: tuple[float, float] = (float("nan"), 0.0),
    peak_factor: float | None = None,
    original_peak: float | None = None,
    warnings: Sequence[str] = (),
    processing: Sequence[str] = (),
    **facts: Unpack[Facts],
) -> Record:
    """Return the checked record of a channel in m/s2; vertical motion is positive upwards.

    `number` is the channel's number in the file, from 1. `unit` is a key of `UNITS`, or "counts" with a `factor` [m/s2
    per count]. `header_peak` is the peak stated in the header, with half a unit of its last digit; its unit is
    `peak_factor` m/s2, by default the unit of the samples. If `original_peak`, the peak before resampling [unit], is
    given, `header_peak` is compared with it.
    """
    code = channel or _DEGREES.sub("", component.strip())
    facing = vertical_if_so(facing or direction(component), code)
    factor = UNITS[unit] if factor is None else factor
    where = f"{file.name}: channel {number}"
    if not (np.isfinite(dt) and dt > 0.0):
        raise RecordFormatError(f"{where}: expected a positive sampling interval in s, found {dt!r}")
    if samples.size < 2:
        raise unexpected(where, "at least 2 samples", str(samples.size), TRUNCATED)
    per_peak = UNITS[unit] if peak_factor is None and unit in UNITS else peak_factor or 1.0
    stated_peak, rounding = (value * per_peak for value in header_peak)
    samples_peak = float(np.max(np.abs(samples))) if original_peak is None else original_peak
    # A reader that filters the samples has already given this warning.
    clipped = [] if processed else [note for note in clipping_warning(samples, unit) if note not in warnings]
    notes = [*warnings, *clipped]
    dead = not np.ptp(samples)
    peak = samples_peak * abs(factor)
    notes += [WarningText("dead_channel")] if dead else _peak_warnings(peak, unit, factor, stated_peak, rounding)
    if dt > CREDIBLE_INTERVAL:
        notes.append(WarningText("long_interval", interval=dt))
    fault = clock_fault(start_time) if start_time is not None else ""
    if fault:
        start_time = None
    notes += [note for note in (fault, facing.note) if note]
    sensor_depth = sensor_depth if 0.0 <= sensor_depth <= _DEEPEST_SENSOR else float("nan")
    if sensor_depth > SHALLOW:
        notes.append(f"the sensor lies {sensor_depth:g} m below the ground: motion at depth, not at the ground surface")
    if facing.sign < 0.0:
        notes.append(WarningText("positive_downwards"))
    factor *= facing.sign
    with np.errstate(over="ignore"):  # Record rejects samples that are not finite
        acceleration = samples * factor
    return Record(
        acceleration=acceleration,
        dt=dt,
        id=record_id(network, station, location, code, start_time, file.path.stem, number),
        network=network,
        station=station,
        location=location,
        channel=code or str(number),
        component=component.strip(),
        orientation="structural" if structural else facing.orientation,
        azimuth=facing.azimuth,
        sensor_depth=sensor_depth,
        start_time=start_time,
        station_name=station_name,
        source=file.name,
        source_sha256=file.sha256,
        format=format,
        source_unit=unit,
        unit_factor=factor,
        processed=processed,
        header_peak=abs(stated_peak),
        event=event,
        warnings=tuple(notes),
        processing=tuple(processing),
        **stated(**facts),
    )


def usable_channels(channels: Iterable[Callable[[], Record]], notes: Sequence[str] = ()) -> list[Record]:
    """Return the records of the channels that can be used, with `notes` and a warning about every other channel."""
    records: list[Record] = []
    refusals: list[RecordRefused] = []
    for read_channel in channels:
        try:
            records.append(read_channel())
        except RecordRefused as refusal:
            refusals.append(refusal)
    if not records:
        raise next((refusal for refusal in refusals if not isinstance(refusal, NotAcceleration)), refusals[0])
    return with_warnings(records, (*notes, *(f"another channel of the file is left out: {one}" for one in refusals)))


def with_warnings(records: Sequence[Record], notes: Sequence[str]) -> list[Record]:
    """Return the records with `notes` added to the warnings of each record."""
    return [replace(record, warnings=(*record.warnings, *notes)) if notes else record for record in records]


def with_copy_warnings(records: Sequence[Record]) -> list[Record]:
    """Return the records, with a warning on records whose samples are equal, or equal with the opposite sign."""
    notes: dict[int, list[WarningText]] = defaultdict(list)
    for (at, one), (behind, other) in combinations(enumerate(records), 2):
        if one.component == other.component or one.npts != other.npts or not one.acceleration.any():
            continue
        if not np.array_equal(abs(one.acceleration[:_FIRST]), abs(other.acceleration[:_FIRST])):
            continue
        for sign, turned in SIGNS.items():
            if np.array_equal(one.acceleration, sign * other.acceleration):
                for place, twin in ((at, other), (behind, one)):
                    notes[place].append(WarningText("same_samples", other=f"channel {twin.channel}", turned=turned))
    return [replace(one, warnings=(*one.warnings, *notes[at])) for at, one in enumerate(records)]


def clipping_warning(samples: np.ndarray, unit: str = "counts") -> list[WarningText]:
    """Return a warning if a raw record seems clipped: equal samples at an extreme or a peak at the limit of 24 bits."""
    warnings: list[WarningText] = []
    step, crests = None, 0
    for end, edge in (("largest", np.max(samples)), ("smallest", np.min(samples))):
        at = np.flatnonzero(samples == edge)
        if not CREST <= at.size < samples.size:
            continue
        starts = np.concatenate([[0], np.flatnonzero(np.diff(at) != 1) + 1])
        lengths = np.diff(np.append(starts, at.size))
        firsts, lengths = at[starts[lengths >= CREST]], lengths[lengths >= CREST]
        if not lengths.size:
            continue
        step = float(np.min(np.diff(np.unique(samples)))) if step is None else step
        if 0.5 * float(np.ptp(samples)) < STEPS_TO_EXTREME * step:
            continue
        # If the record begins or ends within the run, only the other side shows whether the trace falls.
        beside = np.clip([firsts - 1 - lengths // 2, firsts + lengths + lengths // 2], 0, samples.size - 1)
        flat = lengths[np.max(np.abs(edge - samples[beside].astype(float)), axis=0) >= STEPS_BESIDE * step]
        crests += flat.size
        if np.max(flat, initial=0) >= RUN:
            warnings.append(WarningText("clipped", count=int(np.max(flat)), end=end))
    if crests >= CRESTS and not warnings:
        warnings.append(WarningText("clipped_crests", count=crests))
    peak = float(np.max(np.abs(samples.astype(float))))
    if unit == "counts" and NEAR_FULL_SCALE * FULL_SCALE <= peak <= FULL_SCALE:
        warnings.append(WarningText("full_scale", counts=FULL_SCALE))
    return warnings
