"""Converts records to the bytes of common files: PEER AT2, CSV of two columns, miniSEED with a StationXML."""

import io
import re
from collections.abc import Sequence
from datetime import timedelta
from decimal import Decimal
from typing import Any

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.readers.kit.direction import BRACKET, direction
from rockpulse.readers.kit.obspy_bridge import PROCESSED, contradicts_channel
from rockpulse.record.record import STANDARD_GRAVITY, Orientation, Record
from rockpulse.version import __version__

#: Pattern of words by which readers of AT2 recognise header lines; text of a record with such a word is omitted.
_TELLING = re.compile(
    r"NPTS|UNITS?\s*(?:OF|ARE|IN|IS|[:=])|\b(?:ACC(?:EL(?:ERATION)?)?|VEL(?:OCITY)?|DISPL?(?:ACEMENT)?)\b",
    re.IGNORECASE,
)
_DATED = re.compile(r"[^,]*,\s*\d+[/-]\d+[/-]\d+[^,]*")
_STATE = {True: "CORRECTED", False: "UNCORRECTED", None: "ACCELERATION"}
#: Smallest value written [g]; smaller ones have exponents of three digits, which exceed a field of 15 characters.
_SMALLEST = 1e-99
_SEED_CHANNEL = re.compile(r"[A-Z][HLGMN][A-Z0-9]", re.ASCII)
_SEED_OFF = 5.0  # largest deviation of a sensor named N or E from its axis, by the rules of SEED [degrees]


def _text(words: str) -> str:
    """Return free text on one line; empty if a reader would interpret it as a header statement."""
    return "" if _TELLING.search(words) else " ".join(_printable(words).split())


def azimuth_of(record: Record) -> float:
    """Return the azimuth of a record from 0 to below 360 degrees; NaN if it is unknown."""
    return record.azimuth % 360.0 % 360.0  # the remainder of a tiny negative azimuth is 360


def orientation_of(record: Record) -> Orientation:
    """Return the orientation to write in formats that cannot state that a sensor is on a structure."""
    if record.orientation == "vertical":
        return "vertical"
    if np.isfinite(record.azimuth):
        return "horizontal"
    if record.orientation == "structural":
        return direction(BRACKET.sub(" ", record.component)).orientation  # the location is in brackets
    return record.orientation


def _direction_word(record: Record) -> str:
    """Return a word for the direction: ``UP``, ``005``, or the record's own word; empty if it would be misread."""
    if orientation_of(record) == "vertical":
        return "UP"
    if np.isfinite(record.azimuth):
        return f"{azimuth_of(record):09.5f}".rstrip("0").rstrip(".")
    word = _text(record.component).replace(",", ";")
    read_as = direction(word.zfill(3) if word.isdecimal() else word)  # as the reader of AT2 interprets digits
    wrong = np.isfinite(read_as.azimuth) or read_as.orientation not in ("unknown", orientation_of(record))
    return "" if wrong else word


def at2_bytes(record: Record) -> bytes:
    """Return a record as a PEER AT2 file in g, with event, date, station and component in the header."""
    # The date of the event, from its name or its origin time, or else the date of the first sample.
    event = _text(record.event)
    if not _DATED.fullmatch(event):
        event = event.replace(",", ";")
        moment = record.origin_time or record.start_time
        if event and moment is not None:
            event = f"{event}, {moment.month}/{moment.day}/{moment.year}"
    station = _text(record.station_name or ".".join(filter(None, (record.network, record.station))))
    values = record.acceleration / STANDARD_GRAVITY
    fields = np.char.mod("%15.7E", np.where(np.abs(values) < _SMALLEST, 0.0, values)).tolist()
    place = " ON A STRUCTURE" if record.orientation == "structural" else ""
    lines = [
        f"{_STATE[record.processed]} RECORD{place}, WRITTEN BY ROCKPULSE {__version__}: {_text(record.id)}",
        ", ".join((event, station, _direction_word(record))),
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {record.npts:6d}, DT= {record.dt!r} SEC,",
        *("".join(fields[first : first + 5]) for first in range(0, record.npts, 5)),
    ]
    return ("\n".join(lines) + "\n").encode("utf-8", "replace")


def csv_bytes(record: Record) -> bytes:
    """Return a record as a CSV file: headings, then the times [s] and the accelerations [m/s2] with all digits."""
    facing = ""
    if orientation_of(record) == "vertical":
        facing = "up"
    elif azimuth_of(record).is_integer():
        facing = f"{_direction_word(record)} deg"
    heading = " ".join(filter(None, ("time [s],acceleration", facing, "[m/s2]")))
    step = Decimal(repr(record.dt))  # multiples of the interval without binary rounding errors
    rows = (f"{step * index:f},{value!r}" for index, value in enumerate(record.acceleration.tolist()))
    return ("\n".join((heading, *rows)) + "\n").encode()


def miniseed_bytes(
    records: Sequence[Record], beside: Sequence[tuple[str, bytes]] = ()
) -> tuple[bytes, bytes, list[str]]:
    """Return records as miniSEED in m/s2 (float64), their StationXML with a sensitivity of 1, and their codes."""
    import obspy

    codes = seed_codes(records, beside)
    stream = obspy.Stream()
    for record, (network, station, location, channel) in zip(records, codes, strict=True):
        header: dict[str, Any] = {"network": network, "station": station, "location": location, "channel": channel}
        header |= {"delta": record.dt, "starttime": obspy.UTCDateTime(record.start_time or 0)}
        stream.append(obspy.Trace(np.array(record.acceleration), header))
    content, metadata = io.BytesIO(), io.BytesIO()
    stream.write(content, format="MSEED", encoding="FLOAT64")
    _inventory(records, codes).write(metadata, format="STATIONXML")
    return content.getvalue(), metadata.getvalue(), [".".join(code) for code in codes]


def seed_codes(records: Sequence[Record], beside: Sequence[tuple[str, bytes]] = ()) -> list[tuple[str, str, str, str]]:
    """Return distinct SEED codes (network, station, location, channel) that no StationXML in `beside` contradicts."""
    taken: set[tuple[str, str, str, str]] = set()
    result = []
    for record in records:
        network, station, location = (_code(code) for code in (record.network, record.station, record.location))
        station = (station or _code(record.id) or "NONE")[:5]
        network, location = (code if len(code) <= 2 else "" for code in (network, location))
        tries = [(network, station, location, channel) for channel in _channel_codes(record)]
        tries += [(network, station, f"{number:02d}", tries[0][3]) for number in range(100)]
        for free in (code for code in tries if code not in taken):
            if not contradicts_channel(beside, *free[:2], _station_channel(record, *free[2:])):
                break
        else:
            found = f"more than 100 records share the codes {network}.{station}..{tries[0][3]} of miniSEED"
            raise RecordRefused(f"{record.id}: {found}; convert fewer at a time, or into another folder")
        taken.add(free)
        result.append(free)
    return result


def _code(text: str) -> str:
    return re.sub(r"[^A-Z0-9]", "", text.upper())


def _channel_codes(record: Record) -> list[str]:
    """Return the possible SEED codes of the channel, the best code first."""
    lies, azimuth = orientation_of(record), azimuth_of(record)
    if _SEED_CHANNEL.fullmatch(record.channel):
        named = direction(record.channel)
        # Without an azimuth in the file, N or E would be read as one.
        has_azimuth = np.isfinite(azimuth) or not np.isfinite(named.azimuth)
        if named.orientation == "unknown" or (named.orientation == lies and has_azimuth):
            return [record.channel]
    rate = 1.0 / record.dt
    bands = (("C", 250.0), ("H", 80.0), ("B", 10.0), ("M", 1.0), ("L", 0.0))
    band = next(letter for letter, least in bands if rate >= least)
    if lies == "vertical":
        return [f"{band}NZ"]
    for letter, axis in (("N", 0.0), ("E", 90.0)):
        if abs((azimuth - axis + 180.0) % 360.0 - 180.0) <= _SEED_OFF:
            return [f"{band}N{letter}"]
    # The code 3 means a direction that is not known to be horizontal.
    return [f"{band}N3"] if lies == "unknown" else [f"{band}N1", f"{band}N2"]


def _station_channel(record: Record, location: str, channel: str) -> Any:
    """Return the StationXML channel of a record, with a sensitivity of 1 and its state of processing."""
    from obspy import UTCDateTime
    from obspy.core.inventory import Channel
    from obspy.core.inventory.response import InstrumentSensitivity, Response

    lies, azimuth, start = orientation_of(record), azimuth_of(record), record.start_time
    # A second after the end: the time of the last sample is not exact in the binary fractions of a rate.
    ends = None if start is None else start + timedelta(seconds=record.duration + 1.0)
    gain = InstrumentSensitivity(1.0, 1.0, input_units="M/S**2", output_units="COUNTS")
    return Channel(
        channel,
        location,
        **_place(record),
        depth=record.sensor_depth if np.isfinite(record.sensor_depth) else 0.0,
        azimuth=0.0 if lies == "vertical" else azimuth if lies == "horizontal" and np.isfinite(azimuth) else None,
        dip={"vertical": -90.0, "horizontal": 0.0}.get(lies),
        sample_rate=1.0 / record.dt,
        start_date=None if start is None else UTCDateTime(start),
        end_date=None if ends is None else UTCDateTime(ends),
        description={processed: words for words, processed in PROCESSED.items()}[record.processed],
        response=Response(instrument_sensitivity=gain),
    )


def _inventory(records: Sequence[Record], codes: Sequence[tuple[str, str, str, str]]) -> Any:
    """Return the station metadata of all records; unknown coordinates and all elevations are written as 0."""
    from obspy.core.inventory import Inventory, Network, Site, Station

    networks: dict[str, dict[str, Any]] = {}
    for record, (network, station, location, channel) in zip(records, codes, strict=True):
        stations = networks.setdefault(network, {})
        site = Site(_printable(record.station_name) or station)
        place = stations.setdefault(station, Station(station, **_place(record), site=site))
        place.channels.append(_station_channel(record, location, channel))
    source = f"rockpulse {__version__}; unknown coordinates, and all elevations, are written as 0"
    return Inventory([Network(code, stations=list(one.values())) for code, one in networks.items()], source=source)


def _place(record: Record) -> dict[str, float]:
    """Return the coordinates of the station, which StationXML requires; 0 if they are unknown."""
    known = np.isfinite(record.station_latitude) and np.isfinite(record.station_longitude)
    latitude, longitude = (record.station_latitude, record.station_longitude) if known else (0.0, 0.0)
    return {"latitude": latitude, "longitude": longitude, "elevation": 0.0}


def _printable(text: str) -> str:
    """Replace control characters by blanks, as XML cannot contain them and readers would assume binary data."""
    return "".join(letter if letter.isprintable() else " " for letter in text)
