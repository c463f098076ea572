"""DYNA 1.x text files of ESM, ITACA and AFAD.

Lines ``KEY: value`` up to the first line that is none, 64 or more of them, then one number in cm/s2 on each line.
Agencies write dates in three styles and leave most keys blank.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import instant, near_event
from rockpulse.readers.facts import Facts, preferred, stated
from rockpulse.readers.fields import check_count, free_numbers, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.pairs import surplus
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_dyna", "read_dyna"]

_TITLE = re.compile(rb"(?:\xef\xbb\xbf)?EVENT_NAME:")
_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*):(.*)")
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_DECIMAL = re.compile(r"-?\d{1,9}(?:\.\d{0,12})?(?:[eE][+-]?\d{1,2})?", re.ASCII)
_YEAR_FIRST = re.compile(r"(\d{4})([/-]?)(\d\d?)\2(\d\d?)", re.ASCII)
_YEAR_LAST = re.compile(r"(\d\d?)([/.-])(\d\d?)\2(\d{4})", re.ASCII)
_TIME = re.compile(r"(\d\d?)(:?)(\d\d)\2(\d\d(?:\.\d{0,9})?)", re.ASCII)
_PRECISION = re.compile(r"(?:milli|micro)?seconds?", re.IGNORECASE)
#: The stated duration, of the samples or of the steps between them, may be off by this many steps.
_DURATION_STEPS = 2.0


@dataclass(frozen=True)
class _Header:
    """Values by key, the line of each key, and where the values begin."""

    name: str
    values: dict[str, str]
    lines: dict[str, int]
    end: int

    def text(self, key: str) -> str:
        """The value of a key; empty where it is blank or missing."""
        return self.values.get(key, "")

    def number(self, key: str) -> float:
        """The value of a key that may be blank; NaN where it is no number."""
        return float(self.text(key)) if _DECIMAL.fullmatch(self.text(key)) else float("nan")

    def where(self, key: str) -> str:
        """``file:line`` of a key, or of the end of the header where it is missing."""
        return f"{self.name}:{self.lines.get(key, self.end)}"


def is_dyna(head: bytes, name: str) -> bool:
    """Whether the first line is ``EVENT_NAME:``."""
    return bool(_TITLE.match(head))


def read_dyna(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the one channel of the file; raises NotAcceleration for velocity, displacement and spectra."""
    lines = text_lines(file.content)
    header = _header(file.name, lines)
    kind = header.text("DATA_TYPE")
    if not kind:
        raise RecordFormatError(
            f"{header.where('DATA_TYPE')}: expected 'DATA_TYPE: ACCELERATION' in the {header.end} lines of the header, "
            "found none; the header is damaged: download the file again"
        )
    if kind.upper() != "ACCELERATION":
        raise NotAcceleration(
            f"{header.where('DATA_TYPE')}: expected 'DATA_TYPE: ACCELERATION', found {kind!r}; "
            "read the acceleration file of the same record"
        )
    unit = canonical_unit(header.text("UNITS"), header.where("UNITS"))
    step, count = header.number("SAMPLING_INTERVAL_S"), header.text("NDATA")
    if not step > 0.0:
        raise RecordFormatError(
            f"{header.where('SAMPLING_INTERVAL_S')}: expected a sampling interval in s above 0, "
            f"found {header.text('SAMPLING_INTERVAL_S')!r}; the header is damaged: download the file again"
        )
    if not _COUNT.fullmatch(count):
        raise RecordFormatError(
            f"{header.where('NDATA')}: expected the number of samples, found {count!r}; "
            "the header is damaged: download the file again"
        )
    first, declared = header.end, int(count)
    check_count(f"{file.name}:{len(lines)}", declared, len(lines) - first)
    samples = free_numbers(lines[first : first + declared], first + 1, file.name)
    if samples.size != declared:
        row = next(row for row in range(first, first + declared) if len(lines[row].split()) != 1)
        raise RecordFormatError(
            f"{file.name}:{row + 1}: expected one number on the line, found {lines[row][:40]!r}; "
            "the line is damaged: download the file again"
        )
    processed, notes = _processed(header)
    start_time, time_notes = _start_time(header)
    stated = header.text("PGA_CM/S^2")
    peak, rounding = printed_number(stated) if _DECIMAL.fullmatch(stated) else (float("nan"), 0.0)
    location = header.text("LOCATION").strip("-")
    is_code = bool(re.fullmatch(r"\w{0,2}", location))
    return [
        build_record(
            file,
            1,
            samples,
            step,
            unit,
            format="dyna",
            processed=processed,
            component=header.text("STREAM"),
            network=header.text("NETWORK"),
            station=header.text("STATION_CODE"),
            location=location if is_code else "",
            # AFAD writes the place where ESM has a code.
            station_name=header.text("STATION_NAME") or ("" if is_code else location),
            event=header.text("EVENT_NAME"),
            start_time=start_time,
            sensor_depth=header.number("SENSOR_DEPTH_M"),
            facts=_facts(header),
            header_peak=peak * UNITS["cm/s2"],
            peak_rounding=rounding * UNITS["cm/s2"],
            warnings=[
                *notes,
                *time_notes,
                *_remarks(header, step, declared),
                *surplus(lines, first + declared, len(lines)),
            ],
        )
    ]


def _header(name: str, lines: Sequence[str]) -> _Header:
    values, places = {}, {}
    end = 0
    for end, line in enumerate(lines):
        match = _KEY.match(line.lstrip("\ufeff"))
        if not match:
            break
        values[match[1]], places[match[1]] = match[2].strip(), end + 1
    else:
        end = len(lines)
    return _Header(name, values, places, end)


def _processed(header: _Header) -> tuple[bool | None, list[str]]:
    """Whether the volume is a corrected one.

    Unprocessed files of AFAD name the processing of their corrected companions; what tells them apart is that they
    state no corner frequency.
    """
    stated = header.text("PROCESSING")
    if not stated or stated.lower() == "none":
        return (False if stated else None), []
    if header.number("LOW_CUT_FREQUENCY_HZ") > 0.0 or header.number("HIGH_CUT_FREQUENCY_HZ") > 0.0:
        return True, []
    note = f"the header says {stated!r} but states no corner frequency: whether the record was filtered is not known"
    return None, [note]


def _remarks(header: _Header, step: float, count: int) -> list[str]:
    """Warnings where the header contradicts the samples."""
    notes = []
    if header.text("LATE/NORMAL_TRIGGERED").upper().startswith("L"):
        notes.append("late triggered (header): the beginning of the motion is missing")
    if "NOT REMOVED" in header.text("BASELINE_CORRECTION").upper() and header.text("PROCESSING").lower() != "none":
        notes.append("the baseline was not removed (header)")
    duration = header.number("DURATION_S")
    if abs(duration - step * count) > _DURATION_STEPS * step:
        notes.append(f"the header states {duration:g} s, {count} samples at {step:g} s last {step * count:g} s")
    return notes


def _start_time(header: _Header) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample, and warnings about it."""
    stated = header.text("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS")
    if not stated:
        return None, []
    start = _moment(stated)
    if start is None:
        return None, [f"the start time {stated!r} cannot be read"]
    start, notes = near_event(start, _origin(header))
    precision = header.text("DATE_TIME_FIRST_SAMPLE_PRECISION")
    if precision and start is not None and not _PRECISION.fullmatch(precision):
        notes.append(f"the start time is known to the {precision} only (header)")
    return start, notes


def _origin(header: _Header) -> datetime | None:
    return _moment(f"{header.text('EVENT_DATE_YYYYMMDD')} {header.text('EVENT_TIME_HHMMSS')}")


def _facts(header: _Header) -> Facts:
    return stated(
        event_id=header.text("EVENT_ID"),
        origin_time=_origin(header),
        magnitude=preferred([(header.text("MAGNITUDE_W"), "Mw"), (header.text("MAGNITUDE_L"), "ML")]),
        hypocentre=(header.text("EVENT_LATITUDE_DEGREE"), header.text("EVENT_LONGITUDE_DEGREE")),
        depth_km=header.text("EVENT_DEPTH_KM"),
        distance_km=header.text("EPICENTRAL_DISTANCE_KM"),
        station=(header.text("STATION_LATITUDE_DEGREE"), header.text("STATION_LONGITUDE_DEGREE")),
        vs30=header.text("VS30_M/S"),
        site_class=header.text("SITE_CLASSIFICATION_EC8"),
    )


def _moment(text: str) -> datetime | None:
    """UTC time from 20190728_160919.870, 2010/11/14 23:09:19.300 or 14/11/2010 23:09:19.300; None from others."""
    date, _, time = re.sub(r"[\s_T]+", " ", text.strip()).partition(" ")
    clock, forward, backward = _TIME.fullmatch(time), _YEAR_FIRST.fullmatch(date), _YEAR_LAST.fullmatch(date)
    if forward:
        day = [int(forward[1]), int(forward[3]), int(forward[4])]
    elif backward:
        day = [int(backward[4]), int(backward[3]), int(backward[1])]
    else:
        return None
    if not clock:
        return None
    return instant(day, (int(clock[1]), int(clock[3]), float(clock[4])))


FORMATS = (
    Format(
        name="dyna",
        what="DYNA 1.x (ESM, ITACA, AFAD)",
        recognised="first line 'EVENT_NAME:'",
        unit="cm/s2, from the header",
        processed="by type",
        example="HI.ARS1..HNE.D.20190728.160908.C.ACC.ASC",
        detect=is_dyna,
        parse=read_dyna,
    ),
)
