"""What a header states about the earthquake and the site of a record, as far as it can be true.

Headers are filled by many hands: zeros and -999 stand for "unknown", units are mixed up. A value that cannot be true is
left out; it is never an error, since no sample depends on it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

from rockpulse.readers.clock import clock_fault

__all__ = ["NOTHING", "Facts", "coordinates", "magnitudes", "preferred", "stated"]

#: A number, or its text in the header.
Number = float | str
#: Latitude and longitude [degrees north, degrees east].
Place = tuple[Number, Number]

_NUMBER = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,15}|\.\d{1,15})(?:[eE][+-]?\d{1,3})?", re.ASCII)
#: Decimal degrees ("35.525N", "19.33 LAT. N") or degrees, minutes and seconds ("34 06 52N") with the side of the globe.
_DECIMAL = re.compile(r"(?<![\d.])(\d{1,3}\.\d{0,9})\s*(?:LAT\.|LONG\.)?\s*([NSEW])(?![A-Z])", re.ASCII | re.IGNORECASE)
_SEXAGESIMAL = re.compile(
    r"(?<![\d.])(\d{1,3})\s{1,3}(\d{1,2})\s{1,3}(\d{1,2}(?:\.\d{0,6})?)\s*([NSEW])(?![A-Z])", re.ASCII | re.IGNORECASE
)
_MAGNITUDE = re.compile(r"(?<![A-Za-z0-9.])(M[A-Za-z]?)\s{0,10}[=:]?\s{0,10}(\d{1,2}(?:\.\d{0,3})?)(?![\d.])", re.ASCII)
#: Scales of magnitudes by their letters, in the order in which one is chosen where a header states several.
_SCALES = {"mw": "Mw", "ms": "Ms", "ml": "ML", "mb": "mb"}
#: Texts that stand for nothing.
_NO_TEXT = re.compile(r"[-_.?/\s]*|n/?a|none|null|unknown", re.IGNORECASE)

_MAGNITUDES = (-1.0, 10.0)
#: Deepest earthquake, and half the way round the Earth [km].
_DEEPEST, _FARTHEST = 800.0, 20_040.0
#: Velocities of shear waves in mud and in the hardest rock [m/s].
_VS30 = (30.0, 5000.0)


@dataclass(frozen=True)
class Facts:
    """Fields of a `Record` by the same names and in the same units; what is not known is NaN, None or empty."""

    event_id: str = ""
    origin_time: datetime | None = None
    magnitude: float = math.nan
    magnitude_type: str = ""
    hypocentre_latitude: float = math.nan
    hypocentre_longitude: float = math.nan
    hypocentre_depth: float = math.nan
    epicentral_distance: float = math.nan
    station_latitude: float = math.nan
    station_longitude: float = math.nan
    vs30: float = math.nan
    site_class: str = ""


#: Of a file that states nothing.
NOTHING = Facts()


def stated(
    *,
    event_id: str = "",
    origin_time: datetime | None = None,
    magnitude: tuple[Number, str] = (math.nan, ""),
    hypocentre: Place = (math.nan, math.nan),
    depth_km: Number = math.nan,
    distance_km: Number = math.nan,
    station: Place = (math.nan, math.nan),
    vs30: Number = math.nan,
    site_class: str = "",
) -> Facts:
    """The facts of a header, without values that cannot be true.

    A magnitude comes with its scale; `vs30` is in m/s. Left out are times that only an unset clock states, magnitudes
    outside -1 to 10, places that are none, and zeros that stand for "unknown": of magnitude, distance and Vs30, of both
    coordinates at once, and of the depth of an unknown place.
    """
    size = _within(magnitude[0], *_MAGNITUDES, zero=False)
    (latitude, longitude), (station_latitude, station_longitude) = _place(hypocentre), _place(station)
    return Facts(
        event_id=_text(event_id),
        origin_time=None if origin_time is None or clock_fault(origin_time) else origin_time,
        magnitude=size,
        magnitude_type="" if math.isnan(size) else _scale(magnitude[1]),
        hypocentre_latitude=latitude,
        hypocentre_longitude=longitude,
        hypocentre_depth=1e3 * _within(depth_km, 0.0, _DEEPEST, zero=not math.isnan(latitude)),
        epicentral_distance=1e3 * _within(distance_km, 0.0, _FARTHEST, zero=False),
        station_latitude=station_latitude,
        station_longitude=station_longitude,
        vs30=_within(vs30, *_VS30),
        site_class=_text(site_class),
    )


def coordinates(text: str) -> tuple[float, float]:
    """Latitude and longitude from a line of a header; NaN where it names none.

    Examples
    --------
    >>> coordinates("STATION NO. 14403   33.929N, 118.260W     SMA-1")
    (33.929, -118.26)
    >>> coordinates("Epicentre  42 30 00S 173 15 00E  Bearing S40E")
    (-42.5, 173.25)
    """
    found = {"N": math.nan, "E": math.nan}
    named = [(float(degrees), side) for degrees, side in _DECIMAL.findall(text)]
    named += [
        (round(float(degrees) + float(minutes) / 60.0 + float(seconds) / 3600.0, 6), side)
        for degrees, minutes, seconds, side in _SEXAGESIMAL.findall(text)
    ]
    for value, side in reversed(named):  # the first of several counts
        axis = "N" if side.upper() in "NS" else "E"
        found[axis] = value if side.upper() == axis else -value
    return found["N"], found["E"]


def magnitudes(text: str) -> tuple[float, str]:
    """Magnitude and scale from a line such as ``ML=6.6, MW=6.7(CIT)``; see `preferred`.

    Examples
    --------
    >>> magnitudes("H=18KM. ML=6.6, MW=6.7(CIT); MS=6.7(NEIC)"), magnitudes("Depth    8km M  5.70")
    ((6.7, 'Mw'), (5.7, ''))
    """
    return preferred((value, scale) for scale, value in _MAGNITUDE.findall(text))


def preferred(named: Iterable[tuple[Number, str]]) -> tuple[float, str]:
    """One of several magnitudes with their scales, without those that cannot be true.

    Mw comes first, then Ms, ML, mb, then the first of the others; NaN where there is none.
    """
    read = [(_within(value, *_MAGNITUDES, zero=False), _scale(scale)) for value, scale in named]
    found = [one for one in read if not math.isnan(one[0])]
    order = list(_SCALES.values())
    return min(found, key=lambda one: order.index(one[1]) if one[1] in order else len(order), default=(math.nan, ""))


def _scale(text: str) -> str:
    text = text.strip()
    return "" if text.upper() == "M" else _SCALES.get(text.lower(), text)


def _within(value: Number, low: float, high: float, zero: bool = True) -> float:
    """The value if it is a number within the bounds, and not 0 unless `zero` may be meant; else NaN."""
    if isinstance(value, str):
        value = float(value) if _NUMBER.fullmatch(value.strip()) else math.nan
    return float(value) if low <= value <= high and (zero or value != 0.0) else math.nan


def _place(place: Place) -> tuple[float, float]:
    latitude, longitude = _within(place[0], -90.0, 90.0), _within(place[1], -360.0, 360.0)
    if math.isnan(latitude + longitude) or latitude == longitude == 0.0:
        return math.nan, math.nan
    return latitude, longitude if abs(longitude) <= 180.0 else longitude - math.copysign(360.0, longitude)


def _text(text: str) -> str:
    words = " ".join(text.split())
    return "" if _NO_TEXT.fullmatch(words) else words
