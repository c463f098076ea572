"""One channel of ground acceleration with its metadata."""

import math
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime
from fnmatch import fnmatchcase
from itertools import chain, count
from typing import Any, Literal
from unicodedata import normalize

import numpy as np

from rocking.pictures import BLUE, GREY, RED, Picture, Shown, thinned
from rockpulse.errors import RecordFormatError

#: The file unit "g", always this value [m/s2].
STANDARD_GRAVITY = 9.80665
#: Between the files of a record that was made of several, and between their checksums.
BETWEEN = "; "
#: Largest sample that is taken for an acceleration [m/s2]; the squares of larger ones may overflow.
STRONGEST = 1e9
#: Fields whose texts many records of a batch have in common.
SHARED = frozenset(
    (
        "network",
        "channel",
        "component",
        "orientation",
        "format",
        "source_unit",
        "event",
        "event_id",
        "magnitude_type",
        "stage",
    )
)

Orientation = Literal["horizontal", "vertical", "structural", "unknown"]
Stage = Literal["read", "checked", "conditioned"]


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Record(Shown):
    """An accelerogram: one channel, equally spaced, in m/s2.

    Attributes
    ----------
    acceleration : (n,) ndarray
        Ground acceleration [m/s2], n >= 2, finite, read-only, linear between samples. A constant that
        ``np.broadcast_to`` spreads over n samples stays that, and takes no memory.
    dt : float
        Sampling interval [s].
    id : str
        ``NET.STA.LOC.CHA@YYYYMMDDTHHMMSS`` where known, else ``<file stem>.<channel>``.
    network, station, location, channel, station_name : str
        Codes as the file gives them, and the name of the station; empty where unknown.
    component : str
        The channel's direction as the file words it ("90 Deg", "UP").
    orientation : {"horizontal", "vertical", "structural", "unknown"}
        What the direction means; "structural" is a channel on a building.
    azimuth : float
        Clockwise from north [degrees]; NaN where unknown or not horizontal.
    start_time, origin_time : datetime or None
        UTC times of the first sample and of the earthquake, with ``tzinfo=UTC``.
    source, source_sha256 : str
        File the record came from (``archive.zip!member`` for a member of an archive), and its SHA-256; empty without.
    format, source_unit : str
        Name of the reader (see ``rockpulse formats``), and unit in the file.
    unit_factor : float
        Acceleration in m/s2 = value in the file x unit_factor.
    processed : bool or None
        True for a corrected volume, False for a raw one, None where the format does not say.
    header_peak : float
        Peak acceleration that the header states [m/s2]; NaN where it does not.
    event, event_id : str
        Name of the earthquake as in the file, and its identifier at the agency; empty where unknown.
    warnings : tuple of str
        Warnings for the user; those that have a code are of :class:`rockpulse.warning_text.WarningText`.
    processing : tuple of str
        Conditioning steps applied so far, in order.
    magnitude, magnitude_type : float, str
        Magnitude of the earthquake, NaN where unknown, and its scale as the file has it ("Mw", "ML").
    hypocentre_latitude, hypocentre_longitude, hypocentre_depth : float
        Place of the hypocentre [degrees north, degrees east, m]; NaN where unknown.
    epicentral_distance : float
        Distance of the station from the epicentre as the file states it [m]; NaN where it does not.
    station_latitude, station_longitude : float
        Place of the station [degrees north, degrees east]; NaN where unknown.
    vs30, site_class : float, str
        Time-averaged velocity of shear waves in the upper 30 m [m/s], NaN where unknown, and class of the ground.
    sensor_depth : float
        Depth of the sensor below the ground [m]; NaN where the file does not state it.
    stage : {"read", "checked", "conditioned"}
        How far it has come: its samples are checked for defects once, and it is conditioned for a verdict once.
    outline : tuple of float
        What :func:`outline_of` returns, of a record that has its samples no more; else empty.

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
    outline: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        where = self.source or self.id
        acceleration = self.acceleration if _spread(self.acceleration) else np.array(self.acceleration, dtype=float)
        if acceleration.ndim != 1 or acceleration.size < 2:
            raise RecordFormatError(
                f"{where}: expected at least 2 samples in one row, found shape {acceleration.shape}; the file may be "
                "truncated"
            )
        bad = np.flatnonzero(~np.isfinite(acceleration))
        if bad.size:
            raise RecordFormatError(
                f"{where}: {bad.size} of {acceleration.size} samples are NaN or infinite, the first at index {bad[0]}; "
                "repair the file or cut the record there"
            )
        strongest = int(np.argmax(np.abs(acceleration)))
        if abs(acceleration[strongest]) > STRONGEST:
            raise RecordFormatError(
                f"{where}: sample {strongest} is {acceleration[strongest]:.3g} m/s2, no ground motion; is the file "
                "damaged, or the unit wrong?"
            )
        if not (np.isfinite(self.dt) and self.dt > 0.0):
            raise RecordFormatError(f"{where}: expected a positive sampling interval dt in s, found {self.dt!r}")
        acceleration.setflags(write=False)
        object.__setattr__(self, "acceleration", acceleration)
        object.__setattr__(self, "dt", float(self.dt))

    def __reduce__(self) -> tuple[Any, ...]:
        values = [getattr(self, item.name) for item in fields(self)]
        if _spread(self.acceleration):  # pickle would write every sample
            values[0] = (float(self.acceleration[0]), self.npts)
        return _restored, (type(self), values)

    def without_samples(self) -> "Record":
        """The same record with zeros that take no memory in place of its samples."""
        return replace(self, acceleration=np.broadcast_to(0.0, self.npts), outline=outline_of(self))

    def with_warning(self, warning: str) -> "Record":
        """The same record with one more warning."""
        return replace(self, warnings=(*self.warnings, warning))

    def with_note(self, step: str) -> "Record":
        """The same record with one more processing step written down."""
        return replace(self, processing=(*self.processing, step))

    @property
    def npts(self) -> int:
        """Number of samples."""
        return int(self.acceleration.size)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return (self.npts - 1) * self.dt

    @property
    def time(self) -> np.ndarray:
        """(n,) Time of the samples from the first [s]."""
        return self.dt * np.arange(self.npts)

    @property
    def pga(self) -> float:
        """Largest absolute acceleration [m/s2]."""
        return float(np.max(np.abs(self.acceleration)))

    def _facts(self) -> dict[str, str]:
        facts = {"": self.id}
        if self.event or math.isfinite(self.magnitude):
            size = f"{self.magnitude_type or 'M'} {self.magnitude:g}" if math.isfinite(self.magnitude) else ""
            facts["event"] = f"{self.event} {size}".strip()
        if self.orientation == "horizontal" and math.isfinite(self.azimuth):
            facts["azimuth"] = f"{self.azimuth:g} degrees"
        elif self.orientation != "unknown":
            facts["direction"] = self.orientation
        facts["samples"] = f"{self.npts} at {self.dt:.4g} s"
        facts["PGA"] = f"{self.pga:.4g} m/s2"
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


def outline_of(record: Record) -> tuple[float, ...]:
    """Number of samples, peak about the mean [m/s2], times of 5, 25, 50, 75, 95 % of the energy [s]; empty if flat."""
    if _spread(record.acceleration):
        return record.outline if record.outline[:1] == (record.npts,) else ()
    if not np.ptp(record.acceleration):
        return ()
    about = record.acceleration - np.mean(record.acceleration)
    peak = float(np.max(np.abs(about)))
    energy = np.cumsum(about**2)
    times = np.searchsorted(energy, energy[-1] * np.array((0.05, 0.25, 0.5, 0.75, 0.95))) * record.dt
    return (record.npts, peak, *times.tolist())


def _restored(kind: type[Record], values: list[Any]) -> Record:
    """A record as it was pickled; thousands of them share their codes, units and unknown numbers."""
    if isinstance(values[0], tuple):
        values[0] = np.broadcast_to(*values[0])
    values[0].setflags(write=False)
    record = object.__new__(kind)
    for item, value in zip(fields(kind), values, strict=True):
        if item.name in SHARED and type(value) is str:
            value = sys.intern(value)
        elif isinstance(value, float) and math.isnan(value):
            value = math.nan
        object.__setattr__(record, item.name, value)
    return record


def _spread(acceleration: np.ndarray) -> bool:
    """Whether the array is one number in memory, spread over n samples."""
    return (
        isinstance(acceleration, np.ndarray)
        and acceleration.dtype == float
        and acceleration.strides == (0,)
        and not acceleration.flags.writeable
    )


def record_id(
    network: str, station: str, location: str, channel: str, start_time: datetime | None, stem: str, number: int
) -> str:
    """``NET.STA.LOC.CHA@YYYYMMDDTHHMMSS`` or ``<stem>.<channel or number>``, of word characters and ``.@~-``."""
    text = f"{stem}.{channel or number}"
    if station and start_time is not None:
        text = f"{network}.{station}.{location}.{channel or number}@{start_time:%Y%m%dT%H%M%S}"
    return re.sub(r"[^\w.@~-]", "_", normalize("NFC", text))


def id_matches(name: str, patterns: Iterable[str]) -> bool:
    """Whether the id of a record is that of one of some patterns, in which * and ? stand for any letters."""
    return any(fnmatchcase(name, pattern) for pattern in patterns)


def distinct_ids(records: Sequence[Record]) -> list[Record]:
    """The records in the same order, those whose id was taken already renamed to ``id~2``, ``id~3``..."""
    taken: set[str] = set()
    result = []
    for record in records:
        plain = re.sub(r"~\d+$", "", record.id)
        names = chain([plain], (f"{plain}~{number}" for number in count(2)))
        name = next(one for one in names if one not in taken)
        taken.add(name)
        result.append(record if name == record.id else replace(record, id=name))
    return result
