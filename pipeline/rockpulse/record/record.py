"""Defines a record: one channel of ground acceleration with its metadata."""

import math
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime
from fnmatch import fnmatchcase
from functools import lru_cache
from itertools import chain, count
from typing import Any, Literal, TypeVar
from unicodedata import normalize

import numpy as np

from rocking.pictures import BLUE, GREY, RED, Picture, Shown, thinned
from rockpulse.errors import RecordFormatError

#: Value of the unit "g" in files [m/s2].
STANDARD_GRAVITY = 9.80665
#: Separator between the files of a record that consists of several files, and between their checksums.
BETWEEN = "; "
#: Largest sample that is accepted as an acceleration [m/s2]; the squares of larger ones may overflow.
STRONGEST = 1e9

#: Fields of a record whose text other records of a batch do not have, so that it is not shared in memory.
UNIQUE = ("id", "source", "source_sha256")

Orientation = Literal["horizontal", "vertical", "structural", "unknown"]
Stage = Literal["read", "checked", "conditioned"]
Kind = TypeVar("Kind", bound="Record")


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Record(Shown):
    """An accelerogram: one channel of acceleration in m/s2 with a constant sampling interval.

    Attributes
    ----------
    acceleration : (n,) ndarray
        Ground acceleration [m/s2], n >= 2, finite, read-only, linear between samples. A constant from
        ``np.broadcast_to`` is not copied, and needs the memory of one number only.
    dt : float
        Sampling interval [s].
    id : str
        ``NET.STA.LOC.CHA@YYYYMMDDTHHMMSS`` if known, else ``<file stem>.<channel>``.
    network, station, location, channel, station_name : str
        Codes as in the file, and name of the station; empty if unknown.
    component : str
        The channel's direction as worded in the file ("90 Deg", "UP").
    orientation : {"horizontal", "vertical", "structural", "unknown"}
        Kind of direction; "structural" is a channel on a building.
    azimuth : float
        Direction, clockwise from north [degrees]; NaN (may be given as None) if unknown or not horizontal.
    start_time, origin_time : datetime or None
        UTC times of the first sample and of the earthquake, with ``tzinfo=UTC``.
    source, source_sha256 : str
        File of the record (``archive.zip!member`` for a member of an archive), and its SHA-256; empty without a file.
    format, source_unit : str
        Name of the reader (see ``rockpulse formats``), and unit in the file.
    unit_factor : float
        Acceleration in m/s2 = value in the file x unit_factor.
    processed : bool or None
        True for a corrected record, False for a raw one, None if the format does not state it.
    header_peak : float
        Peak acceleration stated in the header [m/s2]; NaN if not stated.
    event, event_id : str
        Name of the earthquake as in the file, and the agency's identifier; empty if unknown.
    warnings : tuple of str
        Warnings for the user; warnings with a code are :class:`rockpulse.warning_text.WarningText`.
    processing : tuple of str
        Conditioning steps applied so far, in order.
    magnitude, magnitude_type : float, str
        Magnitude of the earthquake, NaN if unknown, and its scale as in the file ("Mw", "ML").
    hypocentre_latitude, hypocentre_longitude, hypocentre_depth : float
        Coordinates of the hypocentre [degrees north, degrees east, m]; NaN if unknown.
    epicentral_distance : float
        Distance of the station from the epicentre as stated in the file [m]; NaN if not stated.
    station_latitude, station_longitude : float
        Coordinates of the station [degrees north, degrees east]; NaN if unknown.
    vs30, site_class : float, str
        Time-averaged shear-wave velocity in the upper 30 m [m/s], NaN if unknown, and site class.
    sensor_depth : float
        Depth of the sensor below the ground [m]; NaN if not stated.
    stage : {"read", "checked", "conditioned"}
        "checked": the samples have been checked for defects; "conditioned": the record has also been conditioned.
    outline : bytes
        Result of :func:`outline_of` for a record without its samples, as float64; empty for other records.
    together : str
        Names of the two files that the user states to be one recording ([[records.pair]]); empty for other records.

    Examples
    --------
    >>> rp.Record([0.0, 3.0, -3.0, 0.0], dt=0.1, id="two triangles")
    <Record two triangles, samples 4 at 0.1 s, PGA 3 m/s2>
    """

    acceleration: np.ndarray
    dt: float
    id: str
    network: str = ""
    station: str = ""
    location: str = ""
    channel: str = ""
    component: str = ""
    orientation: Orientation = "unknown"
    azimuth: float = float("nan")
    start_time: datetime | None = None
    station_name: str = ""
    source: str = ""
    source_sha256: str = ""
    format: str = ""
    source_unit: str = ""
    unit_factor: float = 1.0
    processed: bool | None = None
    header_peak: float = float("nan")
    event: str = ""
    warnings: tuple[str, ...] = ()
    processing: tuple[str, ...] = ()
    event_id: str = ""
    origin_time: datetime | None = None
    magnitude: float = float("nan")
    magnitude_type: str = ""
    hypocentre_latitude: float = float("nan")
    hypocentre_longitude: float = float("nan")
    hypocentre_depth: float = float("nan")
    epicentral_distance: float = float("nan")
    station_latitude: float = float("nan")
    station_longitude: float = float("nan")
    vs30: float = float("nan")
    site_class: str = ""
    sensor_depth: float = float("nan")
    stage: Stage = "read"
    outline: bytes = b""
    together: str = ""

    def __post_init__(self) -> None:
        where = self.source or self.id
        acceleration = self.acceleration if _spread(self.acceleration) else read_only(self.acceleration)
        if acceleration.ndim != 1 or acceleration.size < 2:
            raise RecordFormatError(
                f"{where}: expected a one-dimensional array of at least 2 samples, found shape {acceleration.shape}"
            )
        bad = np.flatnonzero(~np.isfinite(acceleration))
        if bad.size:
            raise RecordFormatError(
                f"{where}: {bad.size} of {acceleration.size} samples are NaN or infinite, the first at index {bad[0]}; "
                "repair the file, or keep only a part of the record without them"
            )
        strongest = int(np.argmax(np.abs(acceleration)))
        if abs(acceleration[strongest]) > STRONGEST:
            raise RecordFormatError(
                f"{where}: sample {strongest} is {acceleration[strongest]:.3g} m/s2, too large for ground "
                "motion; is the file damaged, or the unit wrong?"
            )
        if not (np.isfinite(self.dt) and self.dt > 0.0):
            raise RecordFormatError(f"{where}: expected a positive sampling interval dt in s, found {self.dt!r}")
        object.__setattr__(self, "acceleration", acceleration)
        object.__setattr__(self, "dt", float(self.dt))
        object.__setattr__(self, "azimuth", math.nan if self.azimuth is None else self.azimuth)

    def __reduce__(self) -> tuple[Any, ...]:
        values = [getattr(self, item.name) for item in fields(self)]
        if _spread(self.acceleration):  # pickle would write every sample
            values[0] = (float(self.acceleration[0]), self.npts)
        return _restored, (type(self), values)

    def without_samples(self) -> "Record":
        """Return a copy of the record whose samples are replaced by zeros, which need almost no memory."""
        return replace(self, acceleration=_broadcast(0.0, self.npts), outline=np.array(outline_of(self)).tobytes())

    def with_warning(self, warning: str) -> "Record":
        """Return a copy of the record with one more warning."""
        return replace(self, warnings=(*self.warnings, warning))

    def with_note(self, step: str) -> "Record":
        """Return a copy of the record with one more processing step."""
        return replace(self, processing=(*self.processing, step))

    @property
    def npts(self) -> int:
        """Number of samples."""
        return int(self.acceleration.size)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return (self.npts - 1) * self.dt

    @property
    def time(self) -> np.ndarray:
        """Times (n,) of the samples [s], from the first sample."""
        return self.dt * np.arange(self.npts)

    @property
    def pga(self) -> float:
        """Largest absolute acceleration [m/s2]."""
        return largest(self.acceleration)

    def _facts(self) -> dict[str, str]:
        facts = {"": self.id, "samples": f"{self.npts} at {self.dt:.4g} s", "PGA": f"{self.pga:.4g} m/s2"}
        if self.orientation == "horizontal" and math.isfinite(self.azimuth):
            facts["azimuth"] = f"{self.azimuth:g} degrees"
        elif self.orientation != "unknown":
            facts["direction"] = self.orientation
        if self.event or math.isfinite(self.magnitude):
            size = f"{self.magnitude_type or 'M'} {self.magnitude:g}" if math.isfinite(self.magnitude) else ""
            facts["event"] = f"{self.event} {size}".strip()
        return facts | ({"warnings": str(len(self.warnings))} if self.warnings else {})

    def _picture(self) -> Picture:
        reach, end = self.pga or 1.0, self.duration
        strongest = int(np.argmax(np.abs(self.acceleration)))
        picture = Picture((0.0, end), (-reach, reach))
        picture.line([0.0, end], [0.0, 0.0], GREY, 0.5)
        picture.line(*thinned(self.time, self.acceleration), BLUE, 0.7)
        picture.dot(strongest * self.dt, float(self.acceleration[strongest]), RED)
        picture.words(f"{self.pga:.3g} m/s2", 0.0, reach, "start")
        picture.words(f"{end:.4g} s", end, -reach, "end")
        return picture


def read_only(values: Any, dtype: type = float) -> np.ndarray:
    """Return the values as a read-only array; an array that owns its memory is not copied."""
    if type(values) is np.ndarray and values.dtype == dtype and values.flags.owndata and not values.flags.writeable:
        return values
    array: np.ndarray = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array


def largest(values: np.ndarray) -> float:
    """Return the largest absolute value of an array, 0 if it is empty, without making a copy."""
    return float(max(np.max(values, initial=0.0), -np.min(values, initial=0.0)))


def outline_of(record: Record) -> tuple[float, ...]:
    """Return the number of samples, the peak and the times at which 5, 25, 50, 75 and 95 % of the energy are reached.

    Peak [m/s2] and energy are computed about the mean; the times [s] start at the first sample.
    """
    if _spread(record.acceleration):
        outline = tuple(np.frombuffer(record.outline).tolist())
        return outline if outline[:1] == (record.npts,) else ()
    if not np.ptp(record.acceleration):
        return ()
    about = record.acceleration - np.mean(record.acceleration)
    peak = float(np.max(np.abs(about)))
    energy = np.cumsum(about**2)
    times = np.searchsorted(energy, energy[-1] * np.array((0.05, 0.25, 0.5, 0.75, 0.95))) * record.dt
    return (record.npts, peak, *times.tolist())


@lru_cache(maxsize=1024, typed=True)
def _shared(value: float, sign: float) -> float:
    """Return `value`; the same object is returned for equal values with equal `sign`, which saves memory."""
    return value


@lru_cache(maxsize=256)
def _broadcast(value: float, size: int) -> np.ndarray:
    """Return an array of `size` equal numbers that needs the memory of one number; records of equal length share it."""
    return np.broadcast_to(value, size)


def _restored(kind: type[Record], values: list[Any]) -> Record:
    """Restore a pickled record; equal texts and numbers of many records share one object in memory."""
    if isinstance(values[0], tuple):
        values[0] = _broadcast(*values[0])
    values[0].setflags(write=False)
    record = object.__new__(kind)
    for item, value in zip(fields(kind), values, strict=True):
        if type(value) is str and item.name not in UNIQUE:
            value = sys.intern(value)
        elif isinstance(value, float):
            value = math.nan if math.isnan(value) else _shared(value, math.copysign(1.0, value))
        object.__setattr__(record, item.name, value)
    return record


def _spread(acceleration: np.ndarray) -> bool:
    """Return whether an array of samples contains a single number in memory, as ``np.broadcast_to`` returns it."""
    constant = isinstance(acceleration, np.ndarray) and acceleration.strides == (0,)
    return constant and acceleration.dtype == float and not acceleration.flags.writeable


def record_id(
    network: str, station: str, location: str, channel: str, start_time: datetime | None, stem: str, number: int
) -> str:
    """Return ``NET.STA.LOC.CHA@YYYYMMDDTHHMMSS`` if station and time are known, else ``<stem>.<channel or number>``.

    Characters other than letters, digits and ``_.@~-`` are replaced by ``_``.
    """
    text = f"{stem}.{channel or number}"
    if station and start_time is not None:
        text = f"{network}.{station}.{location}.{channel or number}@{start_time:%Y%m%dT%H%M%S}"
    return re.sub(r"[^\w.@~-]", "_", normalize("NFC", text))


def of_kind(kind: type[Kind], record: Record, **changes: Any) -> Kind:
    """Return a copy of a record of the class `kind` (`Record` or a subclass), with the fields in `changes` changed."""
    return kind(**{item.name: getattr(record, item.name) for item in fields(Record)} | changes)


def id_matches(name: str, patterns: Iterable[str]) -> bool:
    """Return whether the id of a record matches one of several patterns, in which * and ? match any characters."""
    return any(fnmatchcase(name, pattern) for pattern in patterns)


def distinct_ids(records: Sequence[Record]) -> list[Record]:
    """Return the records in the same order, with repeated ids renamed to ``id~2``, ``id~3``..."""
    taken: set[str] = set()
    result = []
    for record in records:
        plain = re.sub(r"~\d+$", "", record.id)
        names = chain([plain], (f"{plain}~{number}" for number in count(2)))
        name = next(one for one in names if one not in taken)
        taken.add(name)
        result.append(record if name == record.id else replace(record, id=name))
    return result
