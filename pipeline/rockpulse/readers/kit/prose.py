"""Finds statements in the text above plain columns: motion, unit, interval, count, peak, duration, components."""

import math
import re
from collections.abc import Iterator, Sequence
from datetime import datetime
from typing import NamedTuple

from rockpulse.readers.kit.direction import Direction, direction, heading_direction
from rockpulse.readers.kit.facts import written
from rockpulse.readers.kit.motion_kinds import folded_text, prose_kinds
from rockpulse.readers.kit.text import mentioned_units, quantity_of

_LINE = 1000  # number of characters of a header line that are read
#: Pattern of words for earlier processing of a record; numbers next to them do not describe the file.
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
_NO_RATE = re.compile(f"{_PAST.pattern}|{_FILTER.pattern}")
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


#: Pattern of units of other quantities than acceleration, or of the raw output of a sensor.
_NO_UNIT = re.compile(
    r"[muµ]?v|(?:milli|micro)?volts?|counts?|cts|lsb|bits?|digits?|raw|adc|mm|cm|m|in|inch(?:es)?|ft|feet|k?n|[kmg]?pa|"
    r"bar|rad(?:/s2?)?|deg(?:/s)?|(?:micro)?strain|mm/s|cm/s|m/s|kine"
)
#: Pattern of words before "unit" that show that it is the unit of the samples.
_OF_SAMPLES = re.compile(r"(?:acc\w*|data|samples?|values?|amplitude|physical|the|of|y|ordinates?|engineering|\W)*")
_PEAKS = re.compile(
    r"(?<![a-z])(?:pga|peak(?: ground)? acc\w*|peak(?: value)?|a_?max|acc\.? ?max|max(?:imum|\.)? ?(?:abs\w* )?"
    r"(?:ground )?acc\w*|aceleracion maxima|accelerazione massima|acceleration maximale|maximale beschleunigung|"
    r"en buyuk ivme)\.? ?(?:[(\[](?P<before>[^)\]]{1,12})[)\]])? ?(?P<sign>[=:]|is)? ?-?"
    + _NUMBER
    + r" ?[(\[]?(?P<unit>[a-z/^*0-9]{1,12})?"
)
_DURATIONS = re.compile(
    r"(?<![a-z])(?:duration|durata|duracion|duree|dauer|sure|record length|length of (?:the )?record)"
    r"(?: ?[(\[](?:s|sec|seconds?)[)\]])? ?[=:] ?" + _NUMBER + r" ?(?P<unit>s|sec|seconds?|segundos|secondi)?(?![a-z])"
)
_PART = re.compile(r"significant|strong|bracket|effective|uniform|5 ?%? ?-|d5|arias|rise|event|rupture|source")
_SCALES = re.compile(
    r"(?<![a-z])(?:(?:scale|scaling|multiplication|multiplying|conversion|amplitude)[ _]?factor|scaled by|"
    r"multipl(?:y|ied)(?: \w+)? by|factor de escala|fattore di scala|skalierungsfaktor|facteur d.echelle|olcek faktoru)"
    r" ?(?:[=:]|is|of)? ?" + _NUMBER
)
_FEWEST_SAMPLES = 50  # a smaller number may be the points of a filter or of a row
_REVERSED = re.compile(r"polarity ?[=:]? ?(?:is )?(?:reversed|inverted|negative|-1?\b)|(?:reversed|inverted) polarity")
_ONE_COMPONENT = re.compile(
    r"(?:component|componente|composante|komponente|direction|direccion|direzione|richtung|orientation|orientacion|"
    r"bilesen|yon|comp|dir) ?[=:] ?(.{1,30})|(\S{1,20})[ -](?:component|componente|komponente|bilesen|acc\w*|motion)\b"
)
_OF_DATA = re.compile(r"\b(?:data|values?|samples?|acc\w*|amplitudes?|records?|series|history|given)(?: is| are)?\s*$")
_START = re.compile(
    r"(?:first sample|start(?:ing)? ?time|record start|start of record|initial time|begin\w* (?:of record|time)|"
    r"hora de inicio|ora di inizio)(.{8,60})"
)
_STATION = re.compile(r"(?i)\s*\W{0,3}station(?:[ _](?:name|code|id))?\s*[:=]\s*(\S.{0,40}?)\s*$")
_DOWNWARDS = re.compile(
    r"positive (?:is |= ?)?down|down(?:wards?)? (?:is |= ?)?(?:positive|\+)|positiv[oa] (?:hacia )?abajo|"
    r"positiv[oa] verso il basso|positiv nach unten|positif vers le bas"
)
_LISTED = re.compile(
    r"(?:components?|componentes?|componenti|composantes?|komponenten|channels?|canales|canali|kanale|directions?|"
    r"orientations?|bilesenler|columns?|order)(?: order)?[ :=]{1,3}(.+)"
)
_NUMBERED = re.compile(
    r"(?:columns?|col|channel|chan|ch|canal|canale|kanal|colonna|columna|spalte|sutun|kolon)[ .#_]{0,2}(\d{1,2})"
    r" ?(?:[:=)]|-|is) ?"
)


class Statement(NamedTuple):
    """A statement of the header: the number of its line (from 1), its words, and its value.

    The value of a unit is 1 if the word "unit" precedes the unit, else 0. Intervals and durations are in s.
    """

    line: int
    wording: str
    value: float = 0.0


class Peak(NamedTuple):
    """A peak stated in the header: its number and its unit, both as texts; the unit may be empty."""

    text: str
    unit: str = ""


def _found(
    pattern: re.Pattern[str], header: Sequence[str], unless: re.Pattern[str] | None = None
) -> Iterator[tuple[int, re.Match[str]]]:
    """Yield line number and match of each occurrence of a pattern in lines in which `unless` does not occur."""
    for number, line in enumerate(header, 1):
        text = folded_text(line)
        if not (unless and unless.search(text)):
            yield from ((number, match) for match in pattern.finditer(text))


def stated_kinds(header: Sequence[str]) -> dict[str, int]:
    """Return the kinds of motion that a header names, each with the number (from 1) of the first such line."""
    found: dict[str, int] = {}
    for number, line in enumerate(header, 1):
        text = _SHEAR_WAVES.sub(" ", folded_text(line))
        kinds = prose_kinds(text)
        kinds += [quantity for quantity, _ in _units(line)]
        found = {**dict.fromkeys(kinds, number), **found}
    return found


def _units(line: str) -> list[tuple[str, str]]:
    """Return quantity and unit of each unit that a line states for the samples; units of single values are ignored."""
    line = line[:_LINE]
    text = folded_text(line)
    if _PEAK.search(text) or _PAST.search(text):
        return []
    named = ((unit[:2], line[max(unit[2] - 2, 0) : unit[2]]) for unit in mentioned_units(line))
    found = [unit for unit, before in named if not before.strip(" ([").isdecimal()]
    alone = line.strip(" \t#%!*/")
    words = [(alone, True), *((match[1], False) for match in _BRACKET.finditer(line)), *_unit_words(text)]
    for unit, lengths in words:
        quantity = quantity_of(unit)
        if quantity in ("acceleration", "velocity") or (lengths and quantity == "displacement"):
            found.append((quantity, unit))
    return found


def _unit_words(text: str) -> list[tuple[str, bool]]:
    """Return the words after "in" or "unit" (in several languages), and for each whether it follows "unit"."""
    found = []
    for match in _UNIT.finditer(text):
        word = _ONE_UNIT.match(text, match.end())
        found += [(word[0].strip("([").split("(")[0], not match[0].startswith("in"))] if word else []
    return found


def stated_units(header: Sequence[str]) -> list[Statement]:
    """Return the units of acceleration in a header; the value is 1 if the word "unit" precedes the unit, else 0."""
    found = []
    for number, line in enumerate(header, 1):
        named = {word for word, with_word in _unit_words(folded_text(line)) if with_word}
        units = [wording for quantity, wording in _units(line) if quantity == "acceleration"]
        found += [Statement(number, wording, float(wording.lower() in named)) for wording in units]
    return found


def other_units(header: Sequence[str]) -> list[Statement]:
    """Return the units that a header states for the samples and that are not units of acceleration, such as V or mm."""
    found = []
    for number, match in _found(_UNIT, header):
        word, before = _ONE_UNIT.match(match.string, match.end()), match.string[: match.start()]
        of_samples = _OF_DATA.search(before) if match[0].startswith("in") else _OF_SAMPLES.fullmatch(before)
        wording = word[0].strip("([])") if word and of_samples else ""
        found += [Statement(number, wording)] if _NO_UNIT.fullmatch(wording) else []
    return found


def stated_steps(header: Sequence[str]) -> list[Statement]:
    """Return the sampling intervals [s] that a header states; a bare ``200 Hz`` is used only if there is no other."""
    named = []
    for number, match in _found(_STEP, header, _PAST):
        factor = _TIMES.get(match["unit"] or match["before"] or "", 1.0)
        named.append(Statement(number, match[0].strip(), _value(match) * factor / float(match["divisor"] or 1.0)))
    rates, bare = (
        [Statement(at, match[0], 1.0 / rate if (rate := _value(match)) else math.inf) for at, match in found]
        for found in (_found(_RATE, header, _PAST), _found(_PER_SECOND, header, _NO_RATE))
    )
    return sorted([*named, *rates], key=lambda one: one.line) or bare


def _value(match: re.Match[str]) -> float:
    return float(match["value"].replace(",", ".") + "e" + (match["power"] or "0"))


def stated_counts(header: Sequence[str]) -> list[Statement]:
    """Return the numbers of samples that a header states."""
    return [Statement(number, match[0], float(match[1] or match[2])) for number, match in _found(_COUNT, header)]


def surely_counts(said: Statement) -> bool:
    """Return whether a statement certainly gives the number of samples: its words are clear and the number is large."""
    return said.value >= _FEWEST_SAMPLES and not re.match(r"n ?[=:]? ?\d", said.wording)


def stated_peaks(header: Sequence[str]) -> list[Peak]:
    """Return the peaks of acceleration that a header states."""
    found = []
    for _, match in _found(_PEAKS, header):
        unit = next((word for word in match.group("before", "unit") if word and quantity_of(word)), "")
        if match["power"] is None and (match["sign"] or unit):
            found.append(Peak(match["value"].replace(",", "."), unit))
    return found


def stated_durations(header: Sequence[str]) -> list[Statement]:
    """Return the durations [s] of the record that a header states; durations of the strong part are ignored."""
    found = _found(_DURATIONS, header, _PART)
    return [Statement(number, match["value"].replace(",", "."), _value(match)) for number, match in found]


def stated_scales(header: Sequence[str]) -> list[Statement]:
    """Return the scale factors that a header states."""
    return [Statement(number, match[0], _value(match)) for number, match in _found(_SCALES, header)]


def positive_downwards(header: Sequence[str]) -> bool:
    """Return whether a header states that vertical motion is positive downwards."""
    return any(_DOWNWARDS.search(folded_text(line)) for line in header)


def reversed_polarity(header: Sequence[str]) -> list[str]:
    """Return a warning if a header states that the polarity is reversed."""
    lines = [number for number, line in enumerate(header, 1) if _REVERSED.search(folded_text(line))]
    return [f"line {number} mentions a reversed polarity; the sign is that of the file" for number in lines]


def stated_direction(header: Sequence[str]) -> Direction:
    """Return the direction that the header states, as in "component: N-S"; unknown if it states several."""
    found = [heading_direction((match[1] or match[2]).upper()) for _, match in _found(_ONE_COMPONENT, header)]
    known = {(one.orientation, one.azimuth, one.sign): one for one in found if one.orientation != "unknown"}
    return next(iter(known.values())) if len(known) == 1 else Direction()


def stated_start(header: Sequence[str]) -> datetime | None:
    """Return the UTC time of the first sample that a header states; None if it is missing or in an unknown zone."""
    texts = (match[1].upper() for line in header if (match := _START.search(folded_text(line))))
    return next((moment for text in texts if (moment := written(text))), None)


def stated_station(header: Sequence[str]) -> str:
    """Return the station name that a header states; empty if it states none."""
    return next((match[1] for line in header if (match := _STATION.match(line[:_LINE]))), "")


def stated_columns(header: Sequence[str], width: int) -> list[str]:
    """Return the words for each column from a line such as "components: E N Z"; empty if there is none.

    If the line has one word fewer than there are columns, the first column contains the times.
    """
    numbered: dict[int, str] = {}
    for line in header:
        text = " ".join(line[:_LINE].split())
        matches = list(_NUMBERED.finditer(text.lower()))
        ends = [*(match.start() for match in matches[1:]), len(text)][: len(matches)]
        for match, end in zip(matches, ends, strict=True):
            numbered.setdefault(int(match[1]), text[match.end() : end].strip(" ,;|"))
        listed = _LISTED.search(text.lower())
        words = re.split(r"[ ,;|/]+", text[listed.start(1) :].strip(" .*-#")) if listed else []
        if len(words) > 1 and len(words) in (width, width - 1):
            facing = [direction(word).orientation != "unknown" for word in words]
            timed = facing[0] or folded_text(words[0]) in ("t", "time")
            if timed and all(facing[1:]):
                return ["time"] * (width - len(words)) + words
    if numbered and set(numbered) == set(range(1, width + 1)):
        return [numbered[number] for number in range(1, width + 1)]
    if width > 1 and set(numbered) == set(range(2, width + 1)):
        return ["time", *(numbered[number] for number in range(2, width + 1))]
    return []
