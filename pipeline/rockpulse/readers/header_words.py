"""Statements in the prose above plain columns: kind of motion, unit, interval, number of samples."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from rockpulse.readers.units import mentioned_units, quantity_of

__all__ = ["Statement", "kinds_of", "stated_counts", "stated_kinds", "stated_steps", "stated_units"]

#: Characters of a header line that are looked at.
_LINE = 1000

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


@dataclass(frozen=True)
class Statement:
    """A statement in a line of the header."""

    line: int  # number of the line, from 1
    wording: str  # as written
    value: float = 0.0  # interval [s] or count; 0 for a unit


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
    found = [
        (quantity, wording)
        for quantity, wording, at in mentioned_units(line)
        if not line[max(at - 2, 0) : at].strip(" ([").isdecimal()
    ]
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
    return [
        Statement(number, wording)
        for number, line in enumerate(header, 1)
        for quantity, wording in _units(line)
        if quantity == "acceleration"
    ]


def stated_steps(header: Sequence[str]) -> list[Statement]:
    """Sampling intervals [s] that the prose of a header states, as interval or as rate.

    A bare ``200 Hz`` counts only where no line names an interval or a rate, and the line speaks of no filter.
    """
    named, bare = [], []
    for number, line in enumerate(header, 1):
        text = _plain(line)
        if _PAST.search(text):
            continue
        for match in _STEP.finditer(text):
            factor = _TIMES.get(match["unit"] or match["before"] or "", 1.0)
            named.append(Statement(number, match[0].strip(), _value(match) * factor / float(match["divisor"] or 1.0)))
        named += [Statement(number, match[0], _inverse(_value(match))) for match in _RATE.finditer(text)]
        if not _FILTER.search(text):
            bare += [Statement(number, match[0], _inverse(_value(match))) for match in _PER_SECOND.finditer(text)]
    return named or bare


def _value(match: re.Match[str]) -> float:
    return float(match["value"].replace(",", ".") + "e" + (match["power"] or "0"))


def _inverse(rate: float) -> float:
    return 1.0 / rate if rate else float("inf")


def stated_counts(header: Sequence[str]) -> list[Statement]:
    """Numbers of samples that the prose of a header states."""
    return [
        Statement(number, match[0], float(match[1] or match[2]))
        for number, line in enumerate(header, 1)
        for match in _COUNT.finditer(_plain(line))
    ]
