"""What stands above plain columns: the prose, which may state motion, unit, interval and count, and the headings."""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from rockpulse.readers.kit.direction import BRACKET, direction, heading_direction
from rockpulse.readers.kit.table import LINE_LIMIT, NUMBER, Layout, split_row
from rockpulse.readers.kit.text import mentioned_units, quantity_of

_LINE = 1000  # characters of a header line that are looked at
#: English, Spanish, Italian, German, French, Portuguese, Turkish, without accents; short forms may end in a direction.
_AXIS = r"(?:x|y|z|n|e|v|h|ns|ew|ud|up|s)?"
_KINDS = {
    "velocity": rf"vel{_AXIS}|velocity|velocit(?:a|ies)|velocidad(?:e|es)?|vitesses?|geschwindigkeit(?:en)?|h[iy]z",
    "displacement": rf"disp{_AXIS}|displ|displacements?|desplazamientos?|spostament[io]|deplacements?|"
    r"verschiebung(?:en)?|auslenkung|deslocamentos?|deplasman|yerdegistirme",
    "spectrum": r"p?s[av]|sd|spectr(?:um|al|a|e|es)|espectros?|spettr[oi]|spektr(?:um|en)|fas|fft|fourier|"
    r"period[oes]?|periodos|freq|frequency|frecuencia|frequenza|frequenz|frequence|frequencia|frekans",
    "acceleration": rf"acc{_AXIS}|accn|accel{_AXIS}|accelerations?|aceleracion(?:es)?|accelerazion[ei]|"
    r"beschleunigung(?:en)?|aceleracao|aceleracoes|ivme",
    "time": r"t|time|times|tiempo|tempo|zeit|temps|zaman|sec|secs|seconds?",
}
_WORDS = {kind: re.compile(words) for kind, words in _KINDS.items()}
#: In prose a period or a frequency is one of many things; so is the velocity of shear waves or in a pulse.
_PROSE_SPECTRUM = re.compile(r"ps[av]|spectr(?:um|a|es|e)|espectros?|spettr[oi]|spektr(?:um|en)|fourier")
#: Beside these words a spectrum is the target for which an accelerogram was made.
_MATCHED = re.compile(
    r"match|compatib|compativ|target|design|accelero|artificial|synthetic|simulat|filter|uyumlu|angepas"
)
#: Words for the past of a record, whose numbers are not those of the file.
_PAST = re.compile(r"\b(?:convert|resampl|original|decimat|interpolat)")
_SHEAR_WAVES = re.compile(r"wave[s ]{1,2}velocit\w{1,3}|velocity[- ]pulses?\b|\bvs_?30\b")
_PEAK = re.compile(r"\b(?:pg[avd]|peaks?|max\w{0,6}|pic[co]o?)\b")
_NUMBER = r"(?P<value>\d{1,9}(?:[.,]\d{1,12})?|[.,]\d{1,12})(?:e(?P<power>[+-]?\d{1,2}))?(?![.,]?\d|e[+-]?\d)"
_STEP = re.compile(
    r"(?<![a-z])(?:dt|delta ?t|δt|delta|time ?step|time interval|sampl(?:e|ing) (?:interval|period|time|step)|"
    r"equal(?:ly)? (?:spacing|spaced|intervals?)|"
    r"intervalo(?: de muestreo)?|intervallo(?: di campionamento)?|pas de temps|zeitschritt|abtastintervall)"
    r"(?: ?[(\[](?P<before>[a-z]{1,12})[)\]])? ?(?:[=:]|is|of|at)? ?" + _NUMBER + r"(?: ?/ ?(?P<divisor>\d{1,5}))?"
    r"(?: ?[(\[]?(?P<unit>[a-z]{1,12}))?"
)
_RATE = re.compile(
    r"(?<![a-z])(?:sampl(?:e|ing)[ _](?:rate|frequency)|samplerate|sps|fs|frecuencia de muestreo|"
    r"abtast(?:rate|frequenz)|frequenza di campionamento|frequence d.echantillonnage|ornekleme (?:frekansi|hizi))"
    r"(?: ?[(\[][a-z/]{1,12}[)\]])? ?(?:[=:]|is|of)? ?" + _NUMBER + r"(?! ?m?s(?:ec)?\b)"
)
_PER_SECOND = re.compile(
    r"(?<![\w.,])" + _NUMBER + r" ?(?:hz|sps|samples?/s(?:ec)?|samples per second|p(?:oin)?ts/s(?:ec)?)\b"
)
_FILTER = re.compile(r"filt|pass|cut|corner|band|natural|range|damp|butter|\bto\b|resonan")
_TIMES = {"ms": 1e-3, "msec": 1e-3, "millisec": 1e-3, "milliseconds": 1e-3, "us": 1e-6, "min": 60.0, "minutes": 60.0}

_COUNT = re.compile(
    r"(?<![a-z])(?:npts|nsamp|(?:no|nr|number|num)\.? (?:of )?(?:samples|points|values|data)|samples|points|n) ?[=:]? ?"
    r"(\d{1,9})\b(?![.,/]\d)|"
    r"(?<![\w.,])(\d{1,9}) (?:samples|points|pts|values|data points|muestras|puntos|punti|campioni|punkte|werte)\b"
    r"(?! ?/| per| (?:across|wide|(?:to|in|on) (?:a|each|one) (?:row|line)))"
)
_UNIT = re.compile(
    r"(?<![a-z])(?:in|units?|unidad(?:es)?|unita|einheit|unites?|birim|unidade)\b[ =:]{0,4}(?:of|are|is)? ?"
)
_BRACKET = re.compile(r"[\[(]([^\[\]()]{1,20})[\])]")
_ONE_UNIT = re.compile(r"[^\s,;)\]]{1,12}")


class Statement(NamedTuple):
    """A statement in a line of the header, from 1, as worded: an interval [s], a count, or 0 for a unit."""

    line: int
    wording: str
    value: float = 0.0


def _plain(text: str) -> str:
    """The beginning of a line in small letters without accents, runs of blanks as one."""
    decomposed = unicodedata.normalize("NFKD", text[:_LINE].replace("ı", "i"))
    letters = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    return " ".join(letters.lower().split())


def kinds_of(text: str) -> list[str]:
    """Kinds of motion, and time, that the words of a heading name; those that make it no acceleration come first."""
    plain = _plain(text)
    words = re.findall(r"[a-z]+", plain)
    kinds = [kind for kind, known in _WORDS.items() if any(known.fullmatch(word) for word in words)]
    return [kind for kind in kinds if kind != "spectrum" or not _MATCHED.search(plain)]


def stated_kinds(header: Sequence[str]) -> dict[str, int]:
    """Kinds of motion that the prose of a header names, by word or by unit, with the first line of each, from 1."""
    found: dict[str, int] = {}
    for number, line in enumerate(header, 1):
        text = _SHEAR_WAVES.sub(" ", _plain(line))
        kinds = [kind for kind in kinds_of(text) if kind not in ("spectrum", "time")]
        spectrum = any(_PROSE_SPECTRUM.fullmatch(word) for word in re.findall(r"[a-z]+", text))
        kinds += ["spectrum"] if spectrum and not _MATCHED.search(text) else []
        kinds += [quantity for quantity, _ in _units(line)]
        found = {**dict.fromkeys(kinds, number), **found}
    return found


def _units(line: str) -> list[tuple[str, str]]:
    """Quantity and unit that a line of prose states for the numbers; not those of a value or of a peak."""
    line = line[:_LINE]
    text = _plain(line)
    if _PEAK.search(text) or _PAST.search(text):
        return []
    named = ((unit[:2], line[max(unit[2] - 2, 0) : unit[2]]) for unit in mentioned_units(line))
    found = [unit for unit, before in named if not before.strip(" ([").isdecimal()]
    alone = line.strip(" \t#%!*/")
    words = [(alone, True), *((match[1], False) for match in _BRACKET.finditer(line))]
    for match in _UNIT.finditer(text):
        word = _ONE_UNIT.match(text, match.end())
        words += [(word[0].strip("([").split("(")[0], match[0].startswith("u"))] if word else []
    for unit, lengths in words:
        quantity = quantity_of(unit)
        if quantity in ("acceleration", "velocity") or (lengths and quantity == "displacement"):
            found.append((quantity, unit))
    return found


def stated_units(header: Sequence[str]) -> list[Statement]:
    """Units of acceleration that the prose of a header states."""
    units = ((number, *unit) for number, line in enumerate(header, 1) for unit in _units(line))
    return [Statement(number, wording) for number, quantity, wording in units if quantity == "acceleration"]


def stated_steps(header: Sequence[str]) -> list[Statement]:
    """Sampling intervals [s] that the prose of a header states; a bare ``200 Hz`` only if nothing else does."""
    named, bare = [], []
    for number, line in enumerate(header, 1):
        text = _plain(line)
        if _PAST.search(text):
            continue
        for match in _STEP.finditer(text):
            factor = _TIMES.get(match["unit"] or match["before"] or "", 1.0)
            named.append(Statement(number, match[0].strip(), _value(match) * factor / float(match["divisor"] or 1.0)))
        named += [Statement(number, match[0], _step_of_rate(match)) for match in _RATE.finditer(text)]
        if not _FILTER.search(text):
            bare += [Statement(number, match[0], _step_of_rate(match)) for match in _PER_SECOND.finditer(text)]
    return named or bare


def _value(match: re.Match[str]) -> float:
    return float(match["value"].replace(",", ".") + "e" + (match["power"] or "0"))


def _step_of_rate(match: re.Match[str]) -> float:
    rate = _value(match)
    return 1.0 / rate if rate else float("inf")


def stated_counts(header: Sequence[str]) -> list[Statement]:
    """Numbers of samples that the prose of a header states."""
    counts = ((number, match) for number, line in enumerate(header, 1) for match in _COUNT.finditer(_plain(line)))
    return [Statement(number, match[0], float(match[1] or match[2])) for number, match in counts]


#: Characters of a heading that are looked at; words of a short one, letters of a unit.
_NAME, _SHORT = 80, 3
_COMMENT = " \t#%!*/"
_IN_G = re.compile(r"(?<![a-z])g$", re.IGNORECASE)
_TIME_UNIT = re.compile(r"(?:^|[\W_])(m(?:illi)?s(?:ec\w*)?|us|µs|min(?:s|ut\w*)?)(?=$|[\W_])", re.IGNORECASE)
#: Labels that may stand in one column of a heading and name no motion.
_LABEL = re.compile(
    r"(?:ch|chan|channel|sensor|sta|station|col|column|comp|no|nr|n|index|sample|row|[a-z#]|h)\.?[\s_]*\d{0,4}",
    re.IGNORECASE,
)
_LARGEST_AZIMUTH = 360
#: Quantities by their letters, which mean them where an acceleration is named by its letter.
_LETTERS = {"a": "acceleration", "v": "velocity", "d": "displacement", "u": "displacement"}


@dataclass(frozen=True)
class Heading:
    """The words above one column."""

    name: str  # as written
    # "time", "acceleration", "velocity", "displacement", "spectrum"; empty where neither name nor unit tells
    kind: str = ""
    unit: str = ""  # as written; empty where none is

    @property
    def known(self) -> bool:
        """Whether the words name a motion, a direction or the number of a channel; otherwise they may be prose."""
        facing = len(self.name.split()) <= _SHORT and heading_direction(self.name).orientation != "unknown"
        return bool(self.kind or quantity_of(self.unit) or facing or _LABEL.fullmatch(self.name))


def column_headings(header: Sequence[str], layout: Layout) -> tuple[tuple[Heading, ...], int]:
    """The heading of each column, none where the words there are prose, and the number of lines above them."""
    rows = [index for index, line in enumerate(header) if _is_heading(line)]
    units: Sequence[str] = [""] * layout.width
    prose = len(header)
    for fields, _ in _splits(header[rows[-1]], layout) if rows else ():
        quantities = [quantity_of(field.strip("[]() ")) for field in fields]
        if len(fields) == layout.width and all(quantities) and {*quantities} - {"time"}:
            units, prose = [field.strip("[]() ") for field in fields], rows.pop()
            break
    # A line that states an interval or a count is prose.
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
    return (_headings([""] * layout.width, units), prose) if any(units) else ((), len(header))


def _names_a_column(line: str) -> bool:
    """Whether the words above a single column are its heading rather than a title, which may speak of anything."""
    words = BRACKET.sub(" ", line)
    in_brackets = any(quantity_of(text) == "acceleration" for text in BRACKET.findall(line))
    return len(words.split()) <= _SHORT and not re.search(r"[=:]", words) and (in_brackets or bool(kinds_of(words)))


def _is_heading(line: str) -> bool:
    """Whether a line, in a length that a table may have, holds more than numbers and rules."""
    fields = re.split(r"[\s,;]+", line.strip(_COMMENT)) if len(line) <= LINE_LIMIT else []
    return any(re.search(r"\w", field) and not NUMBER.fullmatch(field) for field in fields)


def _splits(line: str, layout: Layout) -> Iterator[tuple[list[str], bool]]:
    """Ways to split a line into headings, the clearest first; True marks the way in which the rows are split."""
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


def _headings(names: Sequence[str], units: Sequence[str]) -> tuple[Heading, ...]:
    found = [_heading(name.strip(_COMMENT)[:_NAME], unit[:_NAME]) for name, unit in zip(names, units, strict=True)]
    letters = [BRACKET.sub("", heading.name).strip() for heading in found]
    small = {letter.lower() for letter in letters}
    # In t, a, v, d the letters are motions; in n, e, v they are directions.
    named = "a" in small or any(heading.kind == "acceleration" for heading in found)
    if not (named or (letters[1:] and {*letters[1:]} <= {"v", "d", "u"})) or {"n", "e"} & small:
        return tuple(found)
    kinds = (heading.kind or _LETTERS.get(letter.lower(), "") for heading, letter in zip(found, letters, strict=True))
    return tuple(replace(heading, kind=kind) for heading, kind in zip(found, kinds, strict=True))


def _heading(name: str, unit: str) -> Heading:
    """Heading with the kind that its words tell, or else its unit; a unit in brackets may be any, also a wrong one."""
    kinds = kinds_of(BRACKET.sub(" ", name))
    kind = kinds[0] if kinds else ""
    if not unit:
        brackets = [text.strip() for text in BRACKET.findall(name) if text.strip() and not _is_label(text)]
        unit = next((text for text in brackets if quantity_of(text)), brackets[0] if brackets else "")
    if not unit:
        unit = next((wording for _, wording, _ in mentioned_units(name)), "")
    if not unit and kind == "acceleration" and _IN_G.search(name.replace("_", " ").strip()):
        unit = "g"
    if not unit and kind == "time":
        match = _TIME_UNIT.search(name)
        unit = match[1] if match else ""
    measured = quantity_of(unit)
    return Heading(name, kind or ("spectrum" if measured == "frequency" else measured), unit)


def _is_label(text: str) -> bool:
    """Whether brackets hold words, a direction or the number of a channel rather than a unit."""
    words = all(word.isalpha() and len(word) > _SHORT for word in text.split())
    return not quantity_of(text) and (words or direction(text).orientation != "unknown" or text.isdecimal())


def _are_headings(headings: Sequence[Heading], own: bool) -> bool:
    """Whether the pieces of a line are headings rather than prose; `own` tells that they are split as the rows are."""
    if any(heading.name.isdecimal() and int(heading.name) > _LARGEST_AZIMUTH for heading in headings):
        return False
    names = [heading.name for heading in headings]
    if own:
        return any(heading.known for heading in headings) or all(len(name.split()) == 1 for name in names)
    # A title may have as many words as a series in rows has columns.
    timed = headings[0].kind == "time"
    alike = len({bool(heading.kind) for heading in headings}) == 1
    short = all(len(name.split()) <= 2 * _SHORT for name in names)
    return short and (timed or (alike and all(heading.known for heading in headings)))
