"""Finds the headings of the columns in the lines above a table of numbers."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from rockpulse.readers.kit.direction import BRACKET, direction, heading_direction
from rockpulse.readers.kit.motion_kinds import kinds_of
from rockpulse.readers.kit.number_table import LINE_LIMIT, NUMBER, Layout, split_row
from rockpulse.readers.kit.prose import stated_columns, stated_counts, stated_steps
from rockpulse.readers.kit.text import mentioned_units, quantity_of

#: Number of characters of a heading that are read; largest number of words of a short heading and letters of a unit.
_NAME, _SHORT = 80, 3
_COMMENT = " \t#%!*/"
_IN_G = re.compile(r"(?<![a-z])g$", re.IGNORECASE)
#: Pattern of volts in brackets; in round brackets V may be the vertical direction.
_VOLTS = re.compile(r"([\[(])\s*([mµu]?V)\s*[\])]")
_VOLT = re.compile(r"[mµu]?V")
#: Words for the raw output of a sensor, which cannot be converted to an acceleration.
_SIGNALS = frozenset({"counts", "count", "volts", "volt", "mv", "lsb", "adc"})
_TIME_UNIT = re.compile(r"(?:^|[\W_])(m(?:illi)?s(?:ec\w*)?|us|µs|min(?:s|ut\w*)?)(?=$|[\W_])", re.IGNORECASE)
#: Pattern of labels in the heading of a column that do not name a motion.
_LABEL = re.compile(
    r"(?:ch|chan|channel|sensor|sta|station|col|column|comp|no|nr|n|index|sample|row|[a-z#]|h)\.?[\s_]*\d{0,4}",
    re.IGNORECASE,
)
#: Pattern of words for an acceleration relative to the ground, or divided by its peak, which is no ground acceleration.
_NO_GROUND = re.compile(r"(?<![^\W\d_])(?:relativ|normali[sz]|normiert|normé)", re.IGNORECASE)
_LARGEST_AZIMUTH = 360
#: Quantities that single letters mean if one of the headings means acceleration.
_LETTERS = {"a": "acceleration", "v": "velocity", "d": "displacement", "u": "displacement"}


@dataclass(frozen=True)
class ColumnHeading:
    """The heading of a column: its name, its kind of motion and its unit."""

    name: str  # as written
    # "time", "acceleration", "relative acceleration", "velocity", "displacement", "spectrum"; empty if not stated
    kind: str = ""
    unit: str = ""  # as written; empty if none is stated
    others: tuple[str, ...] = ()  # further units in the heading, as written

    @property
    def known(self) -> bool:
        """Return whether the heading names a motion, a direction or a channel number; if not, it may be other text."""
        facing = len(self.name.split()) <= _SHORT and heading_direction(self.name).orientation != "unknown"
        return bool(self.kind or quantity_of(self.unit) or facing or _LABEL.fullmatch(self.name))


def column_headings(header: Sequence[str], layout: Layout) -> tuple[tuple[ColumnHeading, ...], int]:
    """Return the headings of all columns (empty if no line contains headings), and the number of lines above them."""
    rows = [index for index, line in enumerate(header) if _is_heading(line)]
    units: Sequence[str] = [""] * layout.width
    prose = len(header)
    for fields, _ in _splits(header[rows[-1]], layout) if rows else ():
        pieces = [field.strip("[]() ") for field in fields]
        quantities = [quantity_of(piece) for piece in pieces]
        if any(quantities):  # a V without any unit in the line is a direction
            quantities = [quantity_of(piece) or piece * bool(_VOLT.fullmatch(piece)) for piece in pieces]
        if len(fields) == layout.width and all(quantities) and {*quantities} - {"time"}:
            units, prose = pieces, rows.pop()
            break
    # A line that states an interval or a count contains no headings.
    line = [header[rows[-1]]] if rows else []
    states = bool(stated_steps(line) or stated_counts(line))
    for names, own in _splits(line[0], layout) if line else ():
        if states and (layout.width == 1 or not own):
            continue
        if layout.width == 1 and not own and not _names_a_column(names[0]):
            continue
        headings = _headings(names, units) if len(names) == layout.width else ()
        if headings and _are_headings(headings, own):
            return headings, rows[-1]
    stated = stated_columns(header, layout.width) if layout.width > 1 else []
    if stated:
        return _headings(stated, units), len(header)
    return (_headings([""] * layout.width, units), prose) if any(units) else ((), len(header))


def _names_a_column(line: str) -> bool:
    """Return whether the line above a single column is its heading rather than the title of the file."""
    words = BRACKET.sub(" ", line)
    in_brackets = any(quantity_of(text) == "acceleration" for text in BRACKET.findall(line))
    return len(words.split()) <= _SHORT and not re.search(r"[=:]", words) and (in_brackets or bool(kinds_of(words)))


def _is_heading(line: str) -> bool:
    """Return whether a line contains words, rather than only numbers or a ruled line."""
    fields = re.split(r"[\s,;]+", line.strip(_COMMENT)) if len(line) <= LINE_LIMIT else []
    return any(re.search(r"\w", field) and not NUMBER.fullmatch(field) for field in fields)


def _splits(line: str, layout: Layout) -> Iterator[tuple[list[str], bool]]:
    """Yield possible ways to split a line into headings, and for each whether the rows are split in the same way."""
    text = line.strip(_COMMENT) if "\t" not in line else line.strip("\r\n").lstrip("#%!*/ ")
    for delimiter in dict.fromkeys((layout.delimiter or "\t", "\t", ";", ",")):
        if delimiter in text:
            pieces = text.split('"')
            pieces[1::2] = [piece.replace(delimiter, " ") for piece in pieces[1::2]]
            fields, own = split_row("".join(pieces), delimiter), delimiter == (layout.delimiter or "\t")
            yield fields, own
            if text.startswith("\t"):  # a column of row numbers may have no heading, unless all rows begin with a tab
                yield ["", *fields], own
    words = text.split()
    if layout.width == 1:
        yield [text], len(words) == 1
        return
    yield re.split(r"\s\s+", text.strip()), False
    bracketed = re.findall(r"[^\[\]()]{1,80}[\[(][^\[\]()]{0,80}[\])]", text)
    if sum(map(len, bracketed)) == len(text):
        yield bracketed, False
    joined: list[str] = []
    for word in words:
        if joined and (word[0] in "([" or joined[-1].count("(") > joined[-1].count(")")):
            joined[-1] += f" {word}"
        else:
            joined.append(word)
    yield joined, False


def _headings(names: Sequence[str], units: Sequence[str]) -> tuple[ColumnHeading, ...]:
    found = [_heading(name.strip(_COMMENT)[:_NAME], unit[:_NAME]) for name, unit in zip(names, units, strict=True)]
    letters = [BRACKET.sub("", heading.name).strip() for heading in found]
    small = {letter.lower() for letter in letters}
    # In t, a, v, d the letters mean time and motions; in n, e, v they mean directions.
    named = "a" in small or any(heading.kind == "acceleration" for heading in found)
    if not (named or (letters[1:] and {*letters[1:]} <= {"v", "d", "u"})) or {"n", "e"} & small:
        return tuple(found)
    kinds = (heading.kind or _LETTERS.get(letter.lower(), "") for heading, letter in zip(found, letters, strict=True))
    return tuple(replace(heading, kind=kind) for heading, kind in zip(found, kinds, strict=True))


def _heading(name: str, unit: str) -> ColumnHeading:
    kinds = kinds_of(BRACKET.sub(" ", name))
    kind = kinds[0] if kinds else ""
    if kind == "acceleration" and _NO_GROUND.search(name):
        kind = "relative acceleration"
    brackets = [text.strip() for text in BRACKET.findall(name) if text.strip() and not _is_label(text)]
    volts = _VOLTS.search(name)
    if volts and (volts[1] == "[" or heading_direction(BRACKET.sub("", name)).orientation != "unknown"):
        brackets.insert(0, volts[2])
    measures = [text for text in brackets if quantity_of(text)]
    mentioned = [wording for _, wording, _ in mentioned_units(name)]
    if not unit:
        unit = next(iter((*measures, *brackets, *mentioned)), "")
    if not unit:
        unit = next((word for word in re.split(r"[\W_]+", name) if word.lower() in _SIGNALS), "")
    if not unit and kind == "acceleration" and _IN_G.search(name.replace("_", " ").strip()):
        unit = "g"
    if not unit and kind == "time":
        match = _TIME_UNIT.search(name)
        unit = match[1] if match else ""
    measured = quantity_of(unit)
    kind = kind or ("spectrum" if measured == "frequency" else measured)
    return ColumnHeading(name, kind, unit, tuple(text for text in (*measures, *mentioned) if text != unit))


def _is_label(text: str) -> bool:
    """Return whether text in brackets is a word, a direction or a channel number rather than a unit."""
    words = all(word.isalpha() and len(word) > _SHORT for word in text.split())
    return not quantity_of(text) and (words or direction(text).orientation != "unknown" or text.isdecimal())


def _are_headings(headings: Sequence[ColumnHeading], own: bool) -> bool:
    """Return whether the parts of a line are headings; `own` is true if the line is split like the rows."""
    if any(heading.name.isdecimal() and int(heading.name) > _LARGEST_AZIMUTH for heading in headings):
        return False
    names = [heading.name for heading in headings]
    if own:
        return any(heading.known for heading in headings) or all(len(name.split()) == 1 for name in names)
    # A title may happen to have as many words as there are columns.
    timed = headings[0].kind == "time"
    alike = len({bool(heading.kind) for heading in headings}) == 1
    short = all(len(name.split()) <= 2 * _SHORT for name in names)
    return short and (timed or (alike and all(heading.known for heading in headings)))
