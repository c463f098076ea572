"""Standard acceleration files of Mexico (ASA: Instituto de Ingeniería UNAM, CIRES, other members of the SMIS).

109 lines of header, ``KEY : value``, in Spanish with or without accents in any encoding; what belongs to channels is a
list such as ``/V/N90E/N00E``. Then a line of channel numbers, one of directions, and rows of accelerations [gal] in
fields of 10 characters. The values are those of the recorder, without the offset.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import instant, later, near_event
from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.facts import Facts, coordinates, magnitudes, stated
from rockpulse.readers.fields import check_count, fixed_width, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import held_length, held_peak_time
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_asa", "read_asa"]

# The accents come in one byte, in two, or not at all.
_TITLE = re.compile(rb"[^\0]{0,2000}?ARCHIVO EST.{0,2}NDAR DE ACELERACI", re.IGNORECASE)
_VALUES = re.compile(r"\s*DATOS DE ACELERACI", re.IGNORECASE)
_CHANNELS = re.compile(r"CANAL-?\s*(\d{1,2})", re.ASCII | re.IGNORECASE)
_LAYOUT = re.compile(r"\(?\s*(\d{1,2})\s*F\s*(\d{1,2})\.\d{1,2}", re.ASCII | re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,9}|\.\d{1,9})", re.ASCII)
_DATE = re.compile(r"(\d{4})[/-]\s*(\d{1,2})[/-]\s*(\d{1,2})", re.ASCII)
_TIME = re.compile(r"(\d{1,2}):\s*(\d{1,2}):\s*(\d{1,2}(?:[.,]\d{0,9})?)", re.ASCII)
_UTC = re.compile(r"GMT|UTC|TMG", re.IGNORECASE)
_ON_STRUCTURE = re.compile(r"\b(?:azotea|s.{1,2}tano|entrepiso|cortina|corona|piso\s+\d+|nivel\s+\d+)\b", re.IGNORECASE)
_FIELD = 10
#: Lines of the header, and characters of one; a damaged one may be longer.
_LONGEST_HEADER, _LONGEST_LINE = 300, 200


@dataclass(frozen=True)
class _Entry:
    """Key, value and line number of one line of the header."""

    key: str = ""
    value: str = ""
    line: int = 1

    def items(self) -> list[str]:
        """The parts of a value such as ``/V/N90E/N00E``."""
        parts = [part.strip() for part in self.value.split("/")]
        return parts[1:] if self.value.startswith("/") else [part for part in parts if part]


@dataclass(frozen=True)
class _Header:
    """The lines in front of the values."""

    name: str
    entries: Sequence[_Entry]
    lines: Sequence[str]

    def entry(self, key: str) -> _Entry:
        """The line whose key begins with `key`, with or without accents; an empty entry if there is no such line."""
        wanted = _consonants(key)
        return next((entry for entry in self.entries if _consonants(entry.key).startswith(wanted)), _Entry())

    def per_channel(self, key: str) -> list[str]:
        """The values of a list in the header, those of channels 1 to 6 followed by those of 7 to 12."""
        return [item for part in ("C1-C6", "C7-C12") for item in self.entry(f"{key} {part}").items()]

    def numbers(self, key: str) -> list[str]:
        """The values of `per_channel`, blank where a value is no number."""
        return [item if _NUMBER.fullmatch(item) else "" for item in self.per_channel(key)]

    def continued(self, key: str, more: int) -> str:
        """The value of a line and of up to `more` lines without a key behind it, in one line."""
        first = self.entry(key)
        behind = [one.value for one in self.entries if first.line < one.line <= first.line + more and not one.key]
        return " ".join([first.value, *behind])

    def below(self, title: str) -> str:
        """The text under a heading, up to the next rule or key, in one line."""
        wanted = _consonants(title)
        at = next((i for i, line in enumerate(self.lines) if _consonants(line).startswith(wanted)), len(self.lines))
        found = []
        for line in self.lines[at + 1 : at + 8]:
            if line.startswith("==="):
                break
            found.append(line.strip())
        return " ".join(" ".join(found).split())


def _consonants(text: str) -> str:
    """The consonants and digits of a text, which no accent and no encoding changes."""
    return re.sub(r"[^B-DF-HJ-NP-TV-Z0-9]", "", text[:80].upper())


def is_asa(head: bytes, name: str) -> bool:
    """Whether ``ARCHIVO ESTANDAR DE ACELERACION`` stands near the beginning."""
    return bool(_TITLE.match(head))


def read_asa(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel; the options are not used, because the format states everything."""
    lines = text_lines(file.content)
    header, numbers, words, first = _header(file.name, lines)
    stated = header.entry("UNIDADES DE LOS DATOS")
    unit = canonical_unit(stated.value.partition("(")[0], f"{file.name}:{stated.line}")
    layout = header.entry("FORMATO DATOS")
    fields = _LAYOUT.match(layout.value)
    if layout.value and (not fields or int(fields[1]) != len(numbers)):
        raise RecordFormatError(
            f"{file.name}:{layout.line}: expected the format {len(numbers)}F10.3, one field for each channel, "
            f"found {layout.value!r}; the header is damaged: download the file again"
        )
    width = int(fields[2]) if fields else _FIELD
    counts = [int(float(text)) for text in _each(header, "NUM. TOTAL DE MUESTRAS,", numbers, required=True)]
    columns, notes = _columns(file.name, lines, first, width, counts)
    steps = _steps(header, numbers)
    peaks = _each(header, "ACEL. MAX.(Gal),", numbers)
    held, counted = _held(header, numbers, columns, steps), _held_count(header, len(numbers))
    (start_time, time_notes), facts = _start_time(header), _facts(header)
    place = f"{header.entry('NOMBRE DE LA ESTACION').value} {_location(header)}"
    records = []
    for index, samples in enumerate(columns):
        peak, rounding = printed_number(peaks[index]) if peaks[index] else (float("nan"), 0.0)
        records.append(
            build_record(
                file,
                index + 1,
                samples,
                steps[index],
                unit,
                format="asa",
                processed=False,
                component=words[index],
                facing=_facing(words[index]),
                structural=bool(_ON_STRUCTURE.search(place)),
                channel=_base(words[index]) if words.count(words[index]) == 1 else str(numbers[index]),
                station=header.entry("CLAVE DE LA ESTACION").value,
                station_name=header.entry("NOMBRE DE LA ESTACION").value,
                event=_event(header),
                start_time=start_time,
                facts=facts,
                header_peak=peak * UNITS["gal"],
                peak_rounding=rounding * UNITS["gal"],
                warnings=[*notes, *counted, *held[index], *time_notes, *_quality(header)],
            )
        )
    return records


def _header(name: str, lines: Sequence[str]) -> tuple[_Header, list[int], list[str], int]:
    """The header, the numbers and the directions of the channels, and the index of the first row of values."""
    head = [line[:_LONGEST_LINE] for line in lines[:_LONGEST_HEADER]]
    title = next((i for i, line in enumerate(head) if _VALUES.match(line)), len(head))
    at = next((i for i in range(title + 1, min(title + 4, len(head))) if _CHANNELS.search(head[i])), 0)
    if not at or at + 3 > len(lines):
        raise RecordFormatError(
            f"{name}:{min(title + 1, len(lines))}: expected 'DATOS DE ACELERACION:' and a line 'CANAL-1   CANAL-2', "
            "found none; the file is damaged or cut off: download it again"
        )
    entries = []
    for index, line in enumerate(head[:title]):
        key, colon, value = line.partition(":")
        if colon:
            entries.append(_Entry(key.strip(), value.strip(), index + 1))
    header = _Header(name, entries, head[:title])
    numbers = [int(number) for number in _CHANNELS.findall(head[at])]
    words, listed = lines[at + 1][:_LONGEST_LINE].split(), header.entry("ORIENTACION C1-C6")
    stated = _each(header, "ORIENTACION", numbers)
    pairs = zip(stated, words, strict=False)
    if len(words) != len(numbers) or any(said and _base(said) != _base(word) for said, word in pairs):
        raise RecordFormatError(
            f"{name}:{at + 2}: expected the directions of {len(numbers)} channels as in line {listed.line}, "
            f"{listed.value!r}, found {' '.join(words)[:60]!r}; the header is damaged: download the file again"
        )
    first = at + 3 if lines[at + 2].startswith("-----") else at + 2
    return header, numbers, [said or word for said, word in zip(stated, words, strict=True)], first


def _each(header: _Header, key: str, numbers: Sequence[int], required: bool = False) -> list[str]:
    """The value that a list of the header gives for each channel; blank where it gives none."""
    listed = header.per_channel(key) if key == "ORIENTACION" else header.numbers(key)
    found = [listed[number - 1] if 1 <= number <= len(listed) else "" for number in numbers]
    if required and not all(text and float(text) > 0.0 for text in found):
        entry = header.entry(f"{key} C1-C6")
        raise RecordFormatError(
            f"{header.name}:{entry.line}: expected '{key} C1-C6 : ' and {len(numbers)} numbers above 0, "
            f"found {entry.value!r}; the header is damaged: download the file again"
        )
    return found


def _columns(
    name: str, lines: Sequence[str], first: int, width: int, counts: Sequence[int]
) -> tuple[list[np.ndarray], list[str]]:
    """Samples of each channel, and warnings; the rows after the end of a shorter channel are padding."""
    rows = len(lines) - first
    check_count(f"{name}:{len(lines)}", max(counts), rows, "rows")
    if len(set(counts)) == 1:
        table = fixed_width(lines[first:], first + 1, width, len(counts), rows * len(counts), name)
        surplus = rows - counts[0]
        notes = [f"the header states {counts[0]} samples, the file has {rows} rows; all are kept"] if surplus else []
        return list(table.reshape(rows, len(counts)).T), notes
    columns = []
    for index, count in enumerate(counts):
        place = slice(index * width, (index + 1) * width)
        fields = [line[place].ljust(width) for line in lines[first : first + count]]
        columns.append(fixed_width(fields, first + 1, width, 1, count, name))
    return columns, [f"channels of different lengths, {', '.join(map(str, counts))} samples (header)"]


def _steps(header: _Header, numbers: Sequence[int]) -> list[float]:
    """Sampling interval of each channel [s]; the stated sampling rates must agree with it."""
    steps = [float(text or "nan") for text in _each(header, "INTERVALO DE MUESTREO,", numbers)]
    rates = [float(text or "nan") for text in _each(header, "VEL. DE MUESTREO,", numbers)]
    entry = header.entry("INTERVALO DE MUESTREO, C1-C6")
    found = [step if step > 0.0 else 1.0 / rate if rate > 0.0 else 0.0 for step, rate in zip(steps, rates, strict=True)]
    for step, rate in zip(found, rates, strict=True):
        if not step > 0.0 or abs(step * rate - 1.0) > 0.01:
            raise RecordFormatError(
                f"{header.name}:{entry.line}: expected intervals [s] that fit the rates [1/s], found {entry.value!r} "
                f"and {header.entry('VEL. DE MUESTREO, C1-C6').value!r}; find out which are right and repair the line"
            )
    return found


def _held(
    header: _Header, numbers: Sequence[int], columns: Sequence[np.ndarray], steps: Sequence[float]
) -> list[list[str]]:
    """Warnings for each channel where its duration, or the number of its largest sample, contradicts the samples."""
    lasting = [item.strip() for item in _each(header, "DURACION DEL REGISTRO (s),", numbers)]
    largest = _each(header, "ACEL. MAX.,", numbers)
    notes = []
    for samples, step, duration, at in zip(columns, steps, lasting, largest, strict=True):
        time = f"{step * (float(at) - 1.0):.10g}" if at else ""
        found = held_peak_time(time, step * np.arange(samples.size), samples)
        notes.append(held_length(duration, samples.size, step) + found)
    return notes


def _held_count(header: _Header, columns: int) -> list[str]:
    """A warning where the number of channels in the header is not that of the columns."""
    said = header.entry("NUMERO DE CANALES").value.strip()
    if not said.isdecimal() or int(said) == columns:
        return []
    return [f"the header states {said[:9]} channels, the file has {columns} columns"]


def _base(word: str) -> str:
    """A direction without its sense, which follows a semicolon."""
    return word.partition(";")[0].strip().upper()


def _facing(word: str) -> Direction:
    """Direction of a channel; ``N00E;-`` and ``V;-`` are positive in the opposite sense."""
    base, sense = _base(word), word.partition(";")[2].strip()
    facing = direction(base)
    if sense in ("", "+"):
        return facing
    note = f"the component {word!r} is taken as positive against {base}"
    if sense != "-":
        return replace(facing, note=f"the sense {sense!r} of the component is not known; the sign is that of the file")
    if facing.orientation == "vertical":
        return replace(facing, sign=-facing.sign)
    return replace(facing, azimuth=(facing.azimuth + 180.0) % 360.0, note=note)


def _facts(header: _Header) -> Facts:
    date, time = _DATE.search(header.entry("FECHA DEL SISMO").value), _TIME.search(header.entry("HORA EPICENTRO").value)
    utc = all(_UTC.search(header.entry(key).key) for key in ("FECHA DEL SISMO", "HORA EPICENTRO"))
    origin = None
    if date and time and utc:
        clock = (int(time[1]), int(time[2]), float(time[3].replace(",", ".")))
        origin = instant([int(part) for part in date.groups()], clock)
    return stated(
        origin_time=origin,
        magnitude=magnitudes(header.entry("MAGNITUD").value),
        hypocentre=coordinates(header.continued("COORDENADAS DEL EPICENTRO", 1)),
        depth_km=header.entry("PROFUNDIDAD FOCAL").value,
        station=coordinates(header.continued("COORDENADAS DE LA ESTACION", 1)),
        site_class=header.continued("TIPO DE SUELO", 2),
    )


def _location(header: _Header) -> str:
    """The place of the station, which may run over lines without a key."""
    return header.continued("LOCALIZACION DE LA ESTACION", 4)


def _event(header: _Header) -> str:
    date, time = header.entry("FECHA DEL SISMO").value, header.entry("HORA EPICENTRO").value
    return " ".join(f"{date} {time} {header.entry('MAGNITUD').value.strip('/')}".split())


def _quality(header: _Header) -> list[str]:
    text = header.below("CALIDAD DEL ACELEROGRAMA")
    doubtful = re.search(r"incomplet|incorrect|sin tiempo|falla|no\s", text, re.IGNORECASE)
    return [f"quality of the record (header): {text[:200]}"] if doubtful else []


def _moment(date: re.Match[str] | None, text: str) -> datetime | None:
    time = _TIME.match(text)
    if not date or not time:
        return None
    clock = (int(time[1]), int(time[2]), float(time[3].replace(",", ".")))
    return instant([int(part) for part in date.groups()], clock)


def _start_time(header: _Header) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample: its time of day, on the day that is nearest to the earthquake."""
    entry, date = header.entry("HORA DE LA PRIMERA MUESTRA"), _DATE.match(header.entry("FECHA DEL SISMO").value)
    if not entry.value:
        return None, []
    start = _moment(date, entry.value)
    if start is None:
        return None, [f"the start time {entry.value!r} cannot be read; it was left out"]
    if not _UTC.search(entry.key):
        return None, [f"the header does not say that the start time {entry.value} is GMT; it was left out"]
    if re.search(r"sin tiempo|incorrect", header.below("CALIDAD DEL ACELEROGRAMA"), re.IGNORECASE):
        return None, ["the clock of the recorder was not right; the start time was left out"]
    origin = _moment(date, header.entry("HORA EPICENTRO").value)
    if origin is not None:
        start = later(start, 86_400.0 * round((origin - start) / timedelta(days=1)))
    return near_event(start, origin)


FORMATS = (
    Format(
        name="asa",
        what="ASA 2.0 (Mexico: UNAM, CIRES)",
        recognised="'ARCHIVO ESTANDAR DE ACELERACION' in the header",
        unit="gal, from the header",
        processed="no",
        example="CUP50401.012",
        detect=is_asa,
        parse=read_asa,
    ),
)
