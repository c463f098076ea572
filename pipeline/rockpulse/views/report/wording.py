"""The words of the report in one language, out of one table a language, and the form that its numbers have.

A language is one file of the folder `words`; a test compares its keys and fields with those of the English one.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
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

#: The point of a number; that of an id or a version stands beside letters or a second point.
_POINT = re.compile(r"(?<![\w.])([-−+~<>≤]?\d+)\.(\d+)(?![\w.]*\.\d)(?![A-Za-z_]*@)")


@dataclass(frozen=True)
class Words:
    """The words of one language by their keys, as ``words("grade.rocks")``, with named fields filled in.

    ``fixed`` has the short texts that tables share with the terminal, by their English form.
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
        """A text that tables and notes have in common with the terminal; as it is where it is a name or a number."""
        return self.fixed.get(english, english)

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
