"""DYNA 1.x text files of ESM, ITACA and AFAD.

A file has 64 or more lines ``KEY: value``, of which the first is ``EVENT_NAME:``, then one number in cm/s2 per line.
Agencies write dates in three styles; AFAD (TADAS) describes the filter in lines before the title that begin with
``AAD_``.
"""

import re
from collections.abc import Sequence
from datetime import datetime
from itertools import takewhile

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions

_FIRST = "EVENT_NAME"
_TITLE = re.compile(rf"\ufeff?{_FIRST}:")
#: Keys, some of which a file must contain if other lines precede the title; largest number of such lines.
_TELLING = ("EVENT_DATE_YYYYMMDD", "STATION_CODE", "SAMPLING_INTERVAL_S", "NDATA", "UNITS", "DATA_TYPE", "STREAM")
_FEWEST_KEYS, _LINES_BEFORE = 3, 200
#: Keys on which the reading of samples depends: two values of one key are an error, of other keys a warning.
_DECISIVE = frozenset({"SAMPLING_INTERVAL_S", "NDATA", "UNITS", "DATA_TYPE"})
#: Keys that are compared with the samples; a value that is not a number gives a warning.
_HELD = ("DURATION_S", "PGA_CM/S^2", "TIME_PGA_S", "LOW_CUT_FREQUENCY_HZ", "HIGH_CUT_FREQUENCY_HZ")
#: Known keys of AFAD before the title, and the title of its corrected files.
_AAD = "AAD_"
_AAD_KEY = re.compile(r"AAD_(?:BASELINE_CORRECTION|FILTER_TYPE|FILTER_ORDER|(?:LOW|HIGH)_CUT_FREQUENCY_HZ)")
_AAD_TITLE = re.compile(r"AAD_(\w+)_TADAS_FILE")
_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*):(.*)")
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_DECIMAL = re.compile(r"-?\d{1,9}(?:\.\d{0,12})?(?:[eE][+-]?\d{1,2})?", re.ASCII)
_YEAR_FIRST = re.compile(r"(\d{4})([/-]?)(\d\d?)\2(\d\d?)", re.ASCII)
_YEAR_LAST = re.compile(r"(\d\d?)([/.-])(\d\d?)\2(\d{4})", re.ASCII)
_TIME = re.compile(r"(\d\d?)(:?)(\d\d)\2(\d\d(?:\.\d{0,9})?)", re.ASCII)
_PRECISION = re.compile(r"(?:milli|micro)?seconds?", re.IGNORECASE)
#: Pattern of the component in the file names of ESM and AFAD.
_NAMED = re.compile(r"^\w{1,2}\.\w{1,6}\.\w{0,2}\.(\w{3})\.|_(?:Raw)?Acc_([ENUZ])$", re.ASCII)


class _Header(kit.Entries):
    """The entries of the header by key; `end` is the number of lines above the values."""

    def number(self, key: str) -> float:
        """Return the value of a key as a number; NaN if it is blank or not a number."""
        return float(self.text(key)) if _DECIMAL.fullmatch(self.text(key)) else float("nan")


def is_dyna(head: bytes, name: str) -> bool:
    """Return whether a file has the line ``EVENT_NAME:`` and other keys of the format near its start."""
    if b"EVENT_NAME:" not in head:
        return False
    lines = kit.text_lines(head)
    at = _title(lines)
    if at is None:
        return False
    keys, end = _keys(lines, at)
    if at == 0:
        return True
    behind = list(filter(None, map(str.strip, lines[end : end + _FEWEST_KEYS])))
    numbers = not behind or any(map(_DECIMAL.match, behind))
    return numbers and sum(key in _TELLING for key, _, _ in keys) >= _FEWEST_KEYS


def _title(lines: Sequence[str]) -> int | None:
    """Return the index of the line ``EVENT_NAME:``; None if it is not among the first lines."""
    return next((at for at, line in enumerate(lines[:_LINES_BEFORE]) if _TITLE.match(line)), None)


def _keys(lines: Sequence[str], start: int) -> tuple[list[tuple[str, str, int]], int]:
    """Return key, value and line number of the entries from index `start`, and the index of the line after them."""
    matches = takewhile(bool, (_KEY.match(line.lstrip("\ufeff")) for line in lines[start:]))
    found = [(match[1], match[2].strip(), at) for at, match in enumerate(filter(None, matches), start + 1)]
    return found, start + len(found)


def read_dyna(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file; raise kit.NotAcceleration for velocity, displacement and spectra."""
    lines = kit.text_lines(file.content)
    header, header_notes = _header(file.name, lines)
    kind = header.text("DATA_TYPE")
    if not kind:
        expected = f"'DATA_TYPE: ACCELERATION' in the {header.end} lines of the header"
        raise kit.unexpected(header.where("DATA_TYPE"), expected, "none")
    if kind.upper() != "ACCELERATION":
        raise kit.no_acceleration(header.where("DATA_TYPE"), "'DATA_TYPE: ACCELERATION'", repr(kind))
    unit = kit.canonical_unit(header.text("UNITS"), header.where("UNITS"))
    step = float(header.positive("SAMPLING_INTERVAL_S", _DECIMAL, "a sampling interval in s above 0"))
    first, declared = header.end, int(header.positive("NDATA", _COUNT, "a number of samples above 0"))
    kit.check_count(f"{file.name}:{len(lines)}", declared, len(lines) - first)
    samples = kit.free_numbers(lines[first : first + declared], first + 1, file.name)
    if samples.size != declared:
        row = next(row for row in range(first, first + declared) if len(lines[row].split()) != 1)
        found, advice = repr(lines[row][:40]), kit.LINE_DAMAGED
        raise kit.unexpected(f"{file.name}:{row + 1}", "one number on the line", found, advice)
    processed, processing, notes = _processed(header)
    origin = _moment(f"{header.text('EVENT_DATE_YYYYMMDD')} {header.text('EVENT_TIME_HHMMSS')}")
    start_time, time_notes = _start_time(header, origin)
    peak = header.text("PGA_CM/S^2")
    location = header.text("LOCATION").strip("-")
    is_code = bool(re.fullmatch(r"\w{0,2}", location))
    # AFAD writes a place name instead of a code: of the earthquake in files with AAD lines, else of the station.
    place = "" if is_code else location
    of_event = any(key.startswith(_AAD) for key in header)
    return [
        kit.build_record(
            file,
            samples,
            step,
            unit,
            processed=processed,
            component=header.text("STREAM"),
            facing=_facing(header.text("STREAM"), file.path.stem),
            network=header.text("NETWORK"),
            station=header.text("STATION_CODE"),
            location=location if is_code else "",
            station_name=header.text("STATION_NAME") or ("" if of_event else place),
            event=(place.replace("_", " ") if of_event else "") or header.text("EVENT_NAME"),
            start_time=start_time,
            sensor_depth=header.number("SENSOR_DEPTH_M"),
            event_id=header.text("EVENT_ID"),
            origin_time=origin,
            magnitude=kit.preferred([(header.text("MAGNITUDE_W"), "Mw"), (header.text("MAGNITUDE_L"), "ML")]),
            hypocentre=(header.text("EVENT_LATITUDE_DEGREE"), header.text("EVENT_LONGITUDE_DEGREE")),
            depth_km=header.text("EVENT_DEPTH_KM"),
            distance_km=header.text("EPICENTRAL_DISTANCE_KM"),
            station_place=(header.text("STATION_LATITUDE_DEGREE"), header.text("STATION_LONGITUDE_DEGREE")),
            vs30=header.text("VS30_M/S"),
            site_class=header.text("SITE_CLASSIFICATION_EC8"),
            header_peak=kit.printed_number(peak if _DECIMAL.fullmatch(peak) else ""),
            peak_factor=kit.UNITS["cm/s2"],
            warnings=[
                *header_notes,
                *notes,
                *time_notes,
                *_warnings(header, step, samples),
                *kit.surplus(lines, first + declared, len(lines), file.name, _TITLE),
            ],
            processing=processing,
        )
    ]


def _header(name: str, lines: Sequence[str]) -> tuple[_Header, list[str]]:
    """Return the header and warnings; raise an error if the title is missing or an essential key has two values."""
    start = _title(lines)
    if start is None:
        expected = f"a line '{_FIRST}:' among the first {_LINES_BEFORE}"
        raise kit.unexpected(f"{name}:1", expected, repr(lines[0][:40]), "is it a DYNA file?")
    keys, end = _keys(lines, start)
    before, unknown = _before(lines[:start])
    header = _Header(name, end)
    notes = [f"line {line}, before {_FIRST}, is unknown and was not used: {text[:80]!r}" for line, text in unknown]
    for key, value, line in [*before, *keys]:
        known = header.setdefault(key, kit.Entry(value, line=line))
        if known.text != value:
            both = f"{known.text[:40]!r} (line {known.line}) and {value[:40]!r}"
            if key in _DECISIVE:
                advice = "find out which is right and remove the other line"
                raise kit.unexpected(f"{name}:{line}", f"one value of {key}", both, advice)
            notes.append(f"line {line}: the header states {key} as {both}; the first value is used")
    return header, notes


def _before(lines: Sequence[str]) -> tuple[list[tuple[str, str, int]], list[tuple[int, str]]]:
    """Return the known entries above the title (key, value, line number), and other lines with their line numbers."""
    known, unknown = [], []
    for line, text in enumerate((text.lstrip("\ufeff").strip() for text in lines), 1):
        key, _, value = (part.strip() for part in text.partition(":"))
        title = _AAD_TITLE.fullmatch(text)
        if title:
            known.append((_AAD, title[1], line))
        elif _AAD_KEY.fullmatch(key) and (not value or not key.endswith("_HZ") or _DECIMAL.fullmatch(value)):
            known.append((key, value, line))
        elif text:
            unknown.append((line, text))
    return known, unknown


def _processed(header: _Header) -> tuple[bool | None, list[str], list[str]]:
    """Return whether the record is corrected (None: unknown), the processing that the header states, and warnings."""
    done, notes = {}, []
    for prefix, source in (("", ""), (_AAD, " (AAD lines)")):
        low, high = (header.number(f"{prefix}{end}_CUT_FREQUENCY_HZ") for end in ("LOW", "HIGH"))
        if low > 0.0 or high > 0.0:
            band = f"{low:g}-{high:g} Hz" if low > 0.0 else f"below {high:g} Hz"
            band = band if high > 0.0 else f"above {low:g} Hz"
            kind, order = header.text(f"{prefix}FILTER_TYPE"), header.text(f"{prefix}FILTER_ORDER")
            words = (kind.capitalize() or "filtered") + (f" order {order}" if order else "")
            done[band] = f"file: {words}, {band}{source}"
    removed = header.text(f"{_AAD}BASELINE_CORRECTION")
    baseline = [f"file: {removed.lower()} (AAD lines)"] if removed else []
    if len(done) > 1:
        notes.append(f"the file states two filters: {' and '.join(done)}")
    if done or header.text(_AAD).lower() == "filtered":
        return True, [*done.values(), *baseline], notes
    wording = header.text("PROCESSING")
    if not wording or wording.lower() == "none":
        return (False if wording else None), baseline, notes
    note = f"the header says {wording!r} but states no corner frequency: whether the record was filtered is not known"
    return None, baseline, [note]


def _warnings(header: _Header, step: float, samples: np.ndarray) -> list[str]:
    count = samples.size
    notes = [
        f"line {header[key].line}: {key} is not a valid number: {header.text(key)[:40]!r}"
        for key in _HELD
        if header.text(key) and not _DECIMAL.fullmatch(header.text(key))
    ]
    if header.text("LATE/NORMAL_TRIGGERED").upper().startswith("L"):
        notes.append("triggered late (header): the beginning of the motion is missing")
    if "NOT REMOVED" in header.text("BASELINE_CORRECTION").upper() and header.text("PROCESSING").lower() != "none":
        notes.append("the baseline was not removed (header)")
    notes += kit.held_length(header.text("DURATION_S"), count, step)
    return notes + kit.held_peak_time(header.text("TIME_PGA_S"), step * np.arange(count), samples)


def _facing(stream: str, stem: str) -> kit.Direction:
    """Return the direction of the channel; unknown, with a warning, if header and file name disagree."""
    named = _NAMED.search(stem)
    word = (named[1] or named[2]) if named else ""
    note = f"the header says {stream}, but the file name says {word}: the direction is unknown"
    return kit.held_direction(kit.direction(stream), kit.direction(word), note)


def _start_time(header: _Header, origin: datetime | None) -> tuple[datetime | None, list[str]]:
    written = header.text("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS")
    start = _moment(written)
    if start is None:
        return None, [f"the start time {written!r} cannot be read"] if written else []
    start, notes = kit.near_event(start, origin)
    precision = header.text("DATE_TIME_FIRST_SAMPLE_PRECISION")
    if precision and start is not None and not _PRECISION.fullmatch(precision):
        notes.append(f"the start time is known to the {precision} only (header)")
    return start, notes


def _moment(text: str) -> datetime | None:
    """Return the UTC time from a text in one of three styles, such as 20190728_160919.870; None for other text."""
    date, _, time = re.sub(r"[\s_T]+", " ", text.strip()).partition(" ")
    clock, forward, backward = _TIME.fullmatch(time), _YEAR_FIRST.fullmatch(date), _YEAR_LAST.fullmatch(date)
    day = forward.group(1, 3, 4) if forward else backward.group(4, 3, 1) if backward else None
    if not clock or day is None:
        return None
    return kit.instant([int(part) for part in day], (int(clock[1]), int(clock[3]), float(clock[4])))


DYNA = Format(
    name="dyna",
    what="DYNA 1.x (ESM, ITACA, AFAD)",
    recognised="a line 'EVENT_NAME:' and other keys of the format, at the top or below other lines",
    unit="cm/s2, from the header",
    processed="by type",
    example="HI.ARS1..HNE.D.20190728.160908.C.ACC.ASC",
    detect=is_dyna,
    parse=read_dyna,
)
