"""From the numbers of one channel to a `Record`: direction, unit, and the checks that every format shares."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import UNITS, other_readings
from rockpulse.record import STANDARD_GRAVITY, Orientation, Record, record_id

__all__ = ["Direction", "build_record", "direction", "on_structure"]

#: A stated peak further from the data than this, and than its own rounding, is reported.
PEAK_TOLERANCE = 0.02
#: Peaks outside these bounds [g] are reported with the readings in other units.
CREDIBLE_PEAK_G = (1e-6, 5.0)

_UP = {"UP", "U", "V", "Z", "VERT", "VERTICAL", "VER", "UD", "U-D", "UP-DOWN"}
_DOWN = {"DOWN", "DN", "DWN"}
_COMPASS = {"N": 0.0, "NS": 0.0, "N-S": 0.0, "NORTH": 0.0, "E": 90.0, "EW": 90.0, "E-W": 90.0, "EAST": 90.0}
_COMPASS |= {"S": 180.0, "SOUTH": 180.0, "W": 270.0, "WEST": 270.0}
_SIDEWAYS = {"H1", "H2", "L", "T", "LONG", "TRAN", "TRANS", "LONGITUDINAL", "TRANSVERSE"}
_DEGREES = re.compile(r"(\d{1,3}(?:\.\d*)?)\s*(?:DEG(?:REES)?|°)?", re.ASCII)
_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d*)?)\s*([EW])", re.ASCII)
# SEED instrument codes of accelerometers; the last letter is the direction.
_SEED = re.compile(r"[A-Z][NLG]([ENZ123])")

_ON_STRUCTURE = re.compile(
    r"\b(\d+(?:st|nd|rd|th)\s+fl(?:oor|r)?|roof|penthouse|basement|bsmt|mezzanine|attic|abut(?:ment)?|deck|pier|"
    r"bent|span|column|footing|pile|girder|crest|gallery|ground\s+floor)\b",
    re.IGNORECASE,
)
_FREE_FIELD = re.compile(r"free[\s-]*field|^ground(?:\s+(?:level|surface))?$|^surface$", re.IGNORECASE)


@dataclass(frozen=True)
class Direction:
    """What the wording of a component means.

    Attributes
    ----------
    orientation : {"horizontal", "vertical", "unknown"}
        As in `Record`.
    azimuth : float
        Clockwise from north [degrees]; NaN where unknown or not horizontal.
    sign : float
        -1 for a channel that is positive downwards, else 1.
    """

    orientation: Orientation = "unknown"
    azimuth: float = float("nan")
    sign: float = 1.0


def direction(wording: str) -> Direction:
    """Read a component such as ``90 Deg``, ``S05W``, ``UP``, ``N-S``, ``HNE``.

    Examples
    --------
    >>> direction("S05W").azimuth
    185.0
    >>> direction("Up").orientation
    'vertical'
    """
    word = " ".join(wording.upper().split()).strip(" .")
    seed = _SEED.fullmatch(word)
    if seed:
        word = {"1": "H1", "2": "H2", "3": ""}.get(seed[1], seed[1])
    if word in _UP:
        return Direction("vertical")
    if word in _DOWN:
        return Direction("vertical", sign=-1.0)
    if word in _COMPASS:
        return Direction("horizontal", _COMPASS[word])
    if word in _SIDEWAYS:
        return Direction("horizontal")
    degrees = _DEGREES.fullmatch(word)
    if degrees and float(degrees[1]) <= 360.0:
        return Direction("horizontal", float(degrees[1]) % 360.0)
    quadrant = _QUADRANT.fullmatch(word)
    if quadrant and float(quadrant[2]) <= 90.0:
        angle = float(quadrant[2]) if quadrant[3] == "E" else -float(quadrant[2])
        return Direction("horizontal", (angle if quadrant[1] == "N" else 180.0 - angle) % 360.0)
    return Direction()


def on_structure(place: str, stated: bool = False) -> bool:
    """Whether the wording of a place means a structure rather than the ground beside it.

    Parameters
    ----------
    place : str
        Location of a channel, or name of a station.
    stated : bool
        True for a field that only instrumented structures have, where anything but the free field counts.
    """
    if not place.strip() or _FREE_FIELD.search(place.strip()):
        return False
    return stated or bool(_ON_STRUCTURE.search(place))


def _peak_warnings(
    peak: float, unit: str, factor: float, header_peak: float, rounding: float, samples_peak: float
) -> list[str]:
    if peak == 0.0:
        return ["all samples are zero: a dead channel"]
    warnings = []
    g = STANDARD_GRAVITY
    gap = abs(abs(header_peak) - peak)
    if gap > PEAK_TOLERANCE * max(peak, abs(header_peak)) and gap > rounding:
        warnings.append(
            f"the header states a peak of {abs(header_peak) / g:.4g} g, the data have {peak / g:.4g} g; "
            "check the unit and that the file is whole"
        )
    low, high = CREDIBLE_PEAK_G
    if not low <= peak / g <= high:
        named = unit if unit in UNITS else f"{unit} x {abs(factor):.4g} m/s2"
        warnings.append(
            f"peak {peak / g:.3g} g in the unit {named}; the values would be {other_readings(samples_peak)}"
        )
    return warnings


def build_record(
    file: SourceFile,
    number: int,
    samples: np.ndarray,
    dt: float,
    unit: str,
    *,
    format: str,
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
    header_peak: float = float("nan"),
    peak_rounding: float = 0.0,
    original_peak: float | None = None,
    warnings: Sequence[str] = (),
    processing: Sequence[str] = (),
) -> Record:
    """Make the record of one channel and check it.

    Parameters
    ----------
    file : SourceFile
        Where it comes from.
    number : int
        Number of the channel in the file, from 1.
    samples : (n,) ndarray
        Values as the file holds them [unit].
    dt : float
        Sampling interval [s].
    unit : str
        A key of `UNITS`, or "counts" with a `factor`.
    factor : float, optional
        m/s2 per file unit, where `UNITS` does not say.
    facing : Direction, optional
        Where the format knows more than the wording of `component`.
    header_peak, peak_rounding : float
        Peak that the header states and half a unit of its last digit [m/s2].
    original_peak : float, optional
        Largest absolute value before resampling [unit]; it is what the header describes.

    Returns
    -------
    Record
        In m/s2. A channel that is positive downwards changes its sign, so that vertical motion is positive up.

    Raises
    ------
    RecordFormatError
        Fewer than two samples, values that are not finite, dt <= 0.
    """
    facing = facing or direction(component)
    factor = UNITS[unit] if factor is None else factor
    if not (np.isfinite(dt) and dt > 0.0):
        raise RecordFormatError(
            f"{file.name}: channel {number}: expected a positive sampling interval in s, found {dt!r}"
        )
    if samples.size < 2:
        raise RecordFormatError(
            f"{file.name}: channel {number}: expected at least 2 samples, found {samples.size}; "
            "the file may be truncated: download it again"
        )
    samples_peak = float(np.max(np.abs(samples))) if original_peak is None else original_peak
    notes = list(warnings)
    notes += _peak_warnings(samples_peak * abs(factor), unit, factor, header_peak, peak_rounding, samples_peak)
    if facing.sign < 0.0:
        notes.append("positive downwards in the file; the sign is changed so that upwards is positive")
    factor *= facing.sign
    code = channel or re.sub(r"\s*DEG(REES)?$", "", component.strip(), flags=re.IGNORECASE).strip()
    with np.errstate(over="ignore"):  # Record refuses what is not finite
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
        start_time=start_time,
        station_name=station_name,
        source=file.name,
        source_sha256=file.sha256,
        format=format,
        source_unit=unit,
        unit_factor=factor,
        processed=processed,
        header_peak=abs(header_peak),
        event=event,
        warnings=tuple(notes),
        processing=tuple(processing),
    )
