"""The words of the report in one language, out of one table a language, and the form that its numbers have.

A language is one file of the folder `words`; a test compares its keys and fields with those of the English one.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

from rockpulse.errors import ConfigError
from rockpulse.option import hint
from rockpulse.views.shared.table import Cell
from rockpulse.views.shared.terminal import ABSENT, figure, ratio, share

__all__ = ["LANGUAGES", "Words", "words_of"]

_FOLDER = files("rockpulse.views.report").joinpath("words")

#: Codes of the languages that there is a file of.
LANGUAGES = tuple(sorted(one.name.removesuffix(".toml") for one in _FOLDER.iterdir() if one.name.endswith(".toml")))

#: The end of a part of a sentence, and what may follow a part of one.
_PART, _STOPS = re.compile(r"(?<=[.,;:])\s+"), ".,;:"

#: Parts of the longest sentence that is looked up as a whole.
_LONGEST = 12

#: A field of a text in English form, as it stands in a pattern.
_FIELD = re.compile(r"\\{(\w+)\\}")

#: What fields of these names stand for.
_FIELDS = dict.fromkeys(("count", "total"), "[0-9]+") | dict.fromkeys(("low", "high"), r"\S*[0-9]\S*(?: [%\w/]+)?")

#: Fields of names, in which numbers stay as they are.
_GIVEN = ("event", "list", "name", "names")

#: The point of a number; that of an id or a version stands beside letters or a second point.
_POINT = re.compile(r"(?<![\w.])([-−+~<>≤]?\d+)\.(\d+)(?![\w.]*\.\d)(?![A-Za-z_]*@)")


@dataclass(frozen=True, eq=False)
class Words:
    """The words of one language by their keys, as ``words("grade.rocks")``, with named fields filled in.

    ``fixed`` has the texts that tables and pictures share with the terminal, by their English form with named fields.
    """

    language: str
    table: Mapping[str, str]
    fixed: Mapping[str, str]

    def __call__(self, key: str, **fields: Any) -> str:
        """The text of a key with its fields filled in."""
        return self.table[key].format(**fields)

    def section(self, name: str) -> dict[str, str]:
        """The texts whose keys begin with the name of a section, as they stand in the file."""
        return {key.removeprefix(f"{name}."): text for key, text in self.table.items() if key.startswith(f"{name}.")}

    def shared(self, english: str) -> str:
        """A text that tables, notes and pictures share with the terminal; what is a name or a number stays.

        Examples
        --------
        >>> words_of("it").shared("4 records of 3 earthquakes, data: ida. uplift: no curve: no record.")
        '4 registrazioni di 3 terremoti, dati: ida. sollevamento: nessuna curva: nessuna registrazione.'
        """
        return _shared(self, english) if self.fixed and english else english

    def number(self, shown: str) -> str:
        """Text with numbers in English form with the decimal sign of the language."""
        sign = self.table["decimal"]
        return shown if sign == "." else _POINT.sub(rf"\1{sign}\2", shown)

    def cell(self, cell: Cell) -> str:
        """The text of a cell with its marks: a number in the form of the language, a shared word in its words."""
        after = "".join(self.shared(mark.sign) for mark in cell.marks if not mark.before)
        shown = f"{cell.before}{self.shared(cell.text)}{after}"
        return shown if cell.value is None else self.number(shown)

    def ratio(self, value: float) -> str:
        """A ratio around one."""
        return self.number(ratio(value))

    def share(self, value: float) -> str:
        """A share in whole percent."""
        return share(value)

    def figure(self, value: float, unit: str = "") -> str:
        """A number with three digits and its unit."""
        return self.number(figure(value, unit))

    def between(self, low: float, high: float) -> str:
        """An interval of ratios; a dash where neither end is known."""
        shown = self.ratio(low), self.ratio(high)
        return ABSENT if shown == (ABSENT, ABSENT) else self("between", low=shown[0], high=shown[1])

    def several(self, count: int, noun: str) -> str:
        """A number and what is counted, by a key of the words that has a form for one and one for more."""
        return self(f"count.{noun}.{'one' if count == 1 else 'more'}", count=count)

    def listed(self, names: list[str], most: int = 6) -> str:
        """The first of some names, and how many more there are."""
        told = ", ".join(names[:most])
        return told if len(names) <= most else self("and_more", names=told, count=len(names) - most)


@lru_cache(16384)
def _shared(words: Words, english: str) -> str:
    """A text by its English form: as a whole, else the longest parts between stops that are known, one by one."""
    if (whole := _whole(words, english)) is not None:
        return whole
    parts, told, first = _PART.split(english), [], 0
    while first < len(parts):
        for last in range(min(len(parts), first + _LONGEST), first, -1):
            part = " ".join(parts[first:last])
            bare = part.rstrip(_STOPS)
            found = _whole(words, part)
            if found is None and (found := _whole(words, bare)) is not None:
                found += part[len(bare) :]
            if found is not None or last == first + 1:
                break
        told.append(part if found is None else found)
        first = last
    return " ".join(told) if len(parts) > 1 else told[0]


def _whole(words: Words, english: str) -> str | None:
    """A text that is known as a whole, its fields filled in and its first letter as large; None for one that is not."""
    if english in words.fixed:
        return words.fixed[english]
    for pattern, text in _patterns(words.language):
        if found := pattern.fullmatch(english):
            fields = {name: _shared(words, field) for name, field in found.groupdict().items()}
            told = text.format(
                **{name: field if name in _GIVEN else words.number(field) for name, field in fields.items()}
            )
            return told[:1].upper() + told[1:] if english[:1].isupper() and pattern.pattern[:1].islower() else told
    return None


@cache
def _patterns(language: str) -> list[tuple[re.Pattern[str], str]]:
    """What to look for in English, with its text in a language: all with fields or of several words, longest first."""
    known = {english: text for english, text in words_of(language).fixed.items() if " " in english or "{" in english}
    longest = sorted(known, key=lambda english: -len(_FIELD.sub("", re.escape(english))))
    return [(re.compile(_FIELD.sub(_field, re.escape(english)), re.IGNORECASE), known[english]) for english in longest]


def _field(name: re.Match[str]) -> str:
    """What a field stands for, by its name: a count, an end of an interval, or anything within a part of a sentence."""
    return f"(?P<{name[1]}>{_FIELDS.get(name[1], '(?:(?![.;:] ).)+?')})"


@cache
def words_of(language: str) -> Words:
    """The words of a language; a ConfigError for one that there is no file of."""
    if language not in LANGUAGES:
        told = f"there are {', '.join(LANGUAGES)}"
        raise ConfigError(f"language: no words for {language!r}{hint(language, LANGUAGES, told)}")
    tables = tomllib.loads(_FOLDER.joinpath(f"{language}.toml").read_text(encoding="utf-8"))
    fixed = tables.pop("fixed", {})  # English has none
    return Words(language, dict(_flat(tables)), fixed)


def _flat(tables: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    """The texts of nested tables by their keys, joined with points."""
    for key, value in tables.items():
        if isinstance(value, str):
            yield f"{before}{key}", value
        else:
            yield from _flat(value, f"{before}{key}.")
