"""Standard acceleration files of Mexico (ASA: Instituto de Ingeniería UNAM, CIRES, other members of the SMIS).

A file has 109 lines ``KEY : value`` in any encoding, with values per channel as a list such as ``/V/N90E/N00E``, then
numbers and directions of the channels, and rows of accelerations [gal], without offset, in fields of 10 characters.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import takewhile

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

# Accented letters have one byte, two bytes, or no accent.
_TITLE = re.compile(r"[^\0]{0,2000}?ARCHIVO EST.{0,2}NDAR DE ACELERACI", re.ASCII | re.IGNORECASE)
_VALUES = re.compile(r"\s*DATOS DE ACELERACI", re.IGNORECASE)
_CHANNELS = re.compile(r"CANAL-?\s*(\d{1,2})", re.ASCII | re.IGNORECASE)
_LAYOUT = re.compile(r"\(?\s*(\d{1,2})\s*\(?\s*(?:\dP)?\s*[FEDG]S?\s*(\d{1,2})\.\d{1,2}", re.ASCII | re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,9}|\.\d{1,9})", re.ASCII)
#: Pattern of a date with the year first, or the day first and the month as number or word (21/JUL/2000).
_DATE = re.compile(
    r"(\d{4})[/-]\s*(\d{1,2})[/-]\s*(\d{1,2})|(\d{1,2})[/ -]\s*(\d{1,2}|[A-Z]{3,10})[/ -]\s*(\d{4})", re.I
)
_MONTHS = ["ENE", "FEB", "MAR", "ABR", "MAY", "JUN", "JUL", "AGO", "SEP", "OCT", "NOV", "DIC"]
_ENGLISH = {"JAN": 1, "APR": 4, "AUG": 8, "SET": 9, "DEC": 12}
_TIME = re.compile(r"(\d{1,2}):\s*(\d{1,2}):\s*(\d{1,2}(?:[.,]\d{0,9})?)", re.ASCII)
_UTC = re.compile(r"GMT|UTC|TMG", re.IGNORECASE)
_ON_STRUCTURE = re.compile(r"\b(?:azotea|s.{1,2}tano|entrepiso|cortina|corona|piso\s+\d+|nivel\s+\d+)\b", re.IGNORECASE)
_DOUBTFUL = re.compile(r"incomplet|incorrect|sin tiempo|falla|no\s", re.IGNORECASE)
_FIELD, _LOOK_AT = 10, 3  # number of characters of a field, and number of rows in which this is checked
_LONGEST_HEADER = 300  # largest number of lines of the header


class _Header(kit.Entries):
    """The header of a file: its lines, and the entries ``KEY : value`` by the consonants of their keys."""

    def __init__(self, name: str, lines: Sequence[str]) -> None:
        super().__init__(name)
        self.lines = lines
        self.ruler = 0  # number of channels in the line above the values, whether they exist or not
        for at, line in enumerate(lines, 1):
            key, colon, value = line.partition(":")
            if colon:
                self.setdefault(_consonants(key), kit.Entry(value.strip(), key.strip(), at))

    def __missing__(self, key: str) -> kit.Entry:
        """Return the first entry whose key begins with `key`; accents are ignored."""
        wanted = _consonants(key)
        return next((entry for known, entry in self.items() if known.startswith(wanted)), kit.Entry())

    def per_channel(self, key: str, numbers: Sequence[int]) -> list[str]:
        """Return the values for the channels `numbers` from two lists such as ``/V/N90E/N00E``; blank if missing."""
        found: list[str] = []
        for value in (self.text(f"{key} C1-C6"), self.text(f"{key} C7-C12")):
            items = [part.strip() for part in value.split("/")]
            found += items[1:] if value.startswith("/") else filter(None, items)
        return [found[number - 1] if 1 <= number <= len(found) else "" for number in numbers]

    def each(self, key: str, numbers: Sequence[int], required: bool = False) -> list[str]:
        """Return the values of a key for the channels `numbers` as texts; a value that is not a number is blank."""
        found = [item if _NUMBER.fullmatch(item) else "" for item in self.per_channel(key, numbers)]
        if required and not all(text and float(text) > 0.0 for text in found):
            expected = f"'{key} C1-C6 : ' and {len(numbers)} numbers above 0"
            raise kit.unexpected(self.where(f"{key} C1-C6"), expected, repr(self.text(f"{key} C1-C6")))
        return found

    def continued(self, key: str, more: int) -> str:
        """Return the value of a key, together with up to `more` lines that continue it."""
        value, _, first = self[key]
        parts = (line.partition(":") for line in self.lines[first : first + more])
        return " ".join([value, *(text.strip() for blank, colon, text in parts if colon and not blank.strip())])

    def below(self, title: str) -> str:
        """Return the text between a heading and the next ruled line, as one line."""
        wanted = _consonants(title)
        at = next((i for i, line in enumerate(self.lines) if _consonants(line).startswith(wanted)), len(self.lines))
        found = takewhile(lambda line: not line.startswith("==="), self.lines[at + 1 : at + 8])
        return " ".join(" ".join(found).split())


def _consonants(text: str) -> str:
    """Return the consonants and digits of a text, because accents and encodings affect only vowels."""
    return re.sub(r"[^B-DF-HJ-NP-TV-Z0-9]", "", text[:80].upper())


def read_asa(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every channel; `options` is not used, because the file states unit and interval."""
    lines = kit.text_lines(file.content)
    header, numbers, words, first = _header(file.name, lines)
    unit_words, layout = header.text("UNIDADES DE LOS DATOS").partition("(")[0], header.text("FORMATO DATOS")
    unit = kit.canonical_unit(unit_words, header.where("UNIDADES DE LOS DATOS"))
    fields = _LAYOUT.match(layout)
    if layout and (not fields or int(fields[1]) not in (len(numbers), header.ruler)):
        expected = f"the format {len(numbers)}F10.3, one field for each channel"
        raise kit.unexpected(header.where("FORMATO DATOS"), expected, repr(layout))
    width = int(fields[2]) if fields else _FIELD
    counts = [int(float(text)) for text in header.each("NUM. TOTAL DE MUESTRAS,", numbers, required=True)]
    columns, notes = _columns(file.name, lines, first, width, counts)
    steps = _steps(header, numbers)
    peaks = header.each("ACEL. MAX.(Gal),", numbers)
    lasting, largest = header.each("DURACION DEL REGISTRO (s),", numbers), header.each("ACEL. MAX.,", numbers)
    held = []
    for samples, step, duration, at in zip(columns, steps, lasting, largest, strict=True):
        time = f"{step * (float(at) - 1.0):.10g}" if at else ""
        found = kit.held_peak_time(time, step * np.arange(samples.size), samples)
        held.append(kit.held_length(duration, samples.size, step) + found)
    declared = header.text("NUMERO DE CANALES").strip()
    if declared.isdecimal() and int(declared) != len(numbers):
        notes.append(f"the header states {declared[:9]} channels, but the file has {len(numbers)} columns")
    start_time, time_notes = _start_time(header)
    quality = header.below("CALIDAD DEL ACELEROGRAMA")
    if _DOUBTFUL.search(quality):
        time_notes.append(f"quality of the record (header): {quality[:200]}")
    date, name = header.text("FECHA DEL SISMO"), header.text("NOMBRE DE LA ESTACION")
    place = f"{name} {header.continued('LOCALIZACION DE LA ESTACION', 4)}"
    origin = _moment(_DATE.search(date), _TIME.search(header.text("HORA EPICENTRO")))
    utc = all(_UTC.search(header[key].aside) for key in ("FECHA DEL SISMO", "HORA EPICENTRO"))
    return [
        kit.build_record(
            file,
            samples,
            steps[index],
            unit,
            number=index + 1,
            processed=False,
            component=words[index],
            facing=_facing(words[index]),
            structural=bool(_ON_STRUCTURE.search(place)),
            channel=_base(words[index]) if words.count(words[index]) == 1 else str(numbers[index]),
            station=header.text("CLAVE DE LA ESTACION"),
            station_name=name,
            event=" ".join(f"{date} {header.text('HORA EPICENTRO')} {header.text('MAGNITUD').strip('/')}".split()),
            start_time=start_time,
            origin_time=origin if utc else None,
            magnitude=kit.magnitudes(header.text("MAGNITUD")),
            hypocentre=kit.coordinates(header.continued("COORDENADAS DEL EPICENTRO", 1)),
            depth_km=header.text("PROFUNDIDAD FOCAL"),
            station_place=kit.coordinates(header.continued("COORDENADAS DE LA ESTACION", 1)),
            site_class=header.continued("TIPO DE SUELO", 2),
            header_peak=kit.printed_number(peaks[index]),
            peak_factor=kit.UNITS["gal"],
            warnings=[*notes, *held[index], *time_notes],
        )
        for index, samples in enumerate(columns)
    ]


def _header(name: str, lines: Sequence[str]) -> tuple[_Header, list[int], list[str], int]:
    """Return the header, the numbers and directions of the channels, and the index of the first row of values."""
    head = [line[: kit.LONGEST_LINE] for line in lines[:_LONGEST_HEADER]]
    title = next((i for i, line in enumerate(head) if _VALUES.match(line)), len(head))
    at = next((i for i in range(title + 1, min(title + 4, len(head))) if _CHANNELS.search(head[i])), 0)
    if not at or at + 3 > len(lines):
        expected = "'DATOS DE ACELERACION:' and a line 'CANAL-1   CANAL-2'"
        advice = "the file is damaged or cut off: download it again"
        raise kit.unexpected(f"{name}:{min(title + 1, len(lines))}", expected, "none", advice)
    header = _Header(name, head[:title])
    numbers = [int(number) for number in _CHANNELS.findall(head[at])]
    words, (listed, _, line) = lines[at + 1][: kit.LONGEST_LINE].split(), header["ORIENTACION C1-C6"]
    header.ruler = len(numbers)
    # The line may always number eight channels, even if fewer exist.
    if header.text("NUMERO DE CANALES").strip() == str(len(words)):
        numbers = numbers[: len(words)]
    stated = header.per_channel("ORIENTACION", numbers)
    pairs = zip(stated, words, strict=False)
    if len(words) != len(numbers) or any(said and _base(said) != _base(word) for said, word in pairs):
        expected = f"the directions of {len(numbers)} channels as in line {line}, {listed!r}"
        raise kit.unexpected(f"{name}:{at + 2}", expected, repr(" ".join(words)[:60]))
    first = at + 3 if lines[at + 2].startswith("-----") else at + 2
    return header, numbers, [said or word for said, word in zip(stated, words, strict=True)], first


def _columns(
    name: str, lines: Sequence[str], first: int, width: int, counts: Sequence[int]
) -> tuple[list[np.ndarray], list[str]]:
    """Return the samples of each channel, and warnings; the padding of shorter channels is left out."""
    rows = len(lines) - first
    kit.check_count(f"{name}:{len(lines)}", max(counts), rows, "rows")
    if len(set(counts)) > 1:
        columns = []
        for index, count in enumerate(counts):
            place = slice(index * width, (index + 1) * width)
            fields = [line[place].ljust(width) for line in lines[first : first + count]]
            columns.append(kit.fixed_width(fields, first + 1, width, 1, count, name))
        return columns, [f"the channels have different lengths: {', '.join(map(str, counts))} samples (header)"]
    if any(len(line.rstrip()) == width * len(counts) for line in lines[first : first + _LOOK_AT]):
        table = kit.fixed_width(lines[first:], first + 1, width, len(counts), rows * len(counts), name)
    else:
        table = kit.free_rows(lines[first:], first + 1, len(counts), name)
    note = f"the header states {counts[0]} samples, but the file has {rows} rows; all are kept"
    return list(table.reshape(rows, len(counts)).T), [note] if rows > counts[0] else []


def _steps(header: _Header, numbers: Sequence[int]) -> list[float]:
    """Return the sampling interval of each channel [s]; raise an error if a stated rate contradicts the interval."""
    steps = [float(text or "nan") for text in header.each("INTERVALO DE MUESTREO,", numbers)]
    rates = [float(text or "nan") for text in header.each("VEL. DE MUESTREO,", numbers)]
    found = [step if step > 0.0 else 1.0 / rate if rate > 0.0 else 0.0 for step, rate in zip(steps, rates, strict=True)]
    for step, rate in zip(found, rates, strict=True):
        if not step > 0.0 or abs(step * rate - 1.0) > 0.01:
            both = (header.text(f"{key} DE MUESTREO, C1-C6") for key in ("INTERVALO", "VEL."))
            where, advice = header.where("INTERVALO DE MUESTREO, C1-C6"), "find out which are right and repair the line"
            raise kit.unexpected(where, "intervals [s] that fit the rates [1/s]", " and ".join(map(repr, both)), advice)
    return found


def _base(word: str) -> str:
    """Return a direction such as ``N00E;-`` without the sign after the semicolon."""
    return word.partition(";")[0].strip().upper()


def _facing(word: str) -> kit.Direction:
    """Return the direction of a channel from a word such as ``N00E``; ``N00E;-`` is the opposite direction."""
    base, sense = _base(word), word.partition(";")[2].strip()
    facing = kit.direction(base)
    if sense not in ("", "+", "-"):
        return replace(facing, note=f"the sense {sense!r} of the component is not known; the sign is that of the file")
    if sense != "-" or facing.orientation == "vertical":
        return facing.opposite if sense == "-" else facing
    return replace(facing.opposite, note=f"the component {word!r} is used as the direction opposite to {base}")


def _moment(date: re.Match[str] | None, time: re.Match[str] | None) -> datetime | None:
    if not date or not time:
        return None
    clock = (int(time[1]), int(time[2]), float(time[3].replace(",", ".")))
    year, month, day = date.groups()[:3] if date[1] else (date[6], date[5], date[4])
    short = month[:3].upper()
    named = _MONTHS.index(short) + 1 if short in _MONTHS else _ENGLISH.get(short, 0)
    return kit.instant([int(year), int(month) if month.isdecimal() else named, int(day)], clock)


def _start_time(header: _Header) -> tuple[datetime | None, list[str]]:
    """Return the UTC time of the first sample, on the day nearest to the earthquake, and warnings."""
    (text, key, _), date = header["HORA DE LA PRIMERA MUESTRA"], _DATE.match(header.text("FECHA DEL SISMO"))
    if not text:
        return None, []
    start = _moment(date, _TIME.match(text))
    if start is None:
        return None, [f"the start time {text!r} cannot be read; it was left out"]
    if not _UTC.search(key):
        return None, [f"the header does not say that the start time {text} is GMT; it was left out"]
    if re.search(r"sin tiempo|incorrect", header.below("CALIDAD DEL ACELEROGRAMA"), re.IGNORECASE):
        return None, ["the clock of the recorder was not right; the start time was left out"]
    origin = _moment(date, _TIME.match(header.text("HORA EPICENTRO")))
    if origin is not None:
        start = kit.later(start, 86_400.0 * round((origin - start) / timedelta(days=1)))
    return kit.near_event(start, origin)


ASA = Format(
    name="asa",
    what="ASA 2.0 (Mexico: UNAM, CIRES)",
    recognised="'ARCHIVO ESTANDAR DE ACELERACION' in the header",
    unit="gal, from the header",
    example="CUP50401.012",
    detect=begins_with(_TITLE, 2100),
    parse=read_asa,
)
