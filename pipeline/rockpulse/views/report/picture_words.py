"""The texts of pictures in the language of the report, by their English form."""

import re
import tomllib
from functools import cache, lru_cache
from importlib.resources import files

from rockpulse.views.shared.words import in_numerals, language

#: The end of a part of a sentence, what may follow a part of one, and parts of the longest that is known as a whole.
_PART, _STOPS, _LONGEST = re.compile(r"(?<=[.,;:])\s+"), ".,;:", 12

#: A field of a text in English form, and what fields of some names stand for.
_FIELD = re.compile(r"\\{(\w+)\\}")
_FIELDS = dict.fromkeys(("count", "total"), "[0-9]+") | dict.fromkeys(("low", "high"), r"\S*[0-9]\S*(?: [%\w/]+)?")

#: Fields of names, in which numbers stay as they are.
_GIVEN = ("event", "list", "name", "names")


def in_language(english: str) -> str:
    """The text in the language that is written."""
    return english if language() == "en" or not english else _told(language(), english)


@lru_cache(16384)
def _told(code: str, english: str) -> str:
    """A text by its English form: as a whole, else the longest parts between stops that are known, one by one."""
    if (whole := _whole(code, english)) is not None:
        return whole
    parts, told, first = _PART.split(english), [], 0
    while first < len(parts):
        for last in range(min(len(parts), first + _LONGEST), first, -1):
            part = " ".join(parts[first:last])
            bare = part.rstrip(_STOPS)
            found = _whole(code, part)
            if found is None and (found := _whole(code, bare)) is not None:
                found += part[len(bare) :]
            if found is not None or last == first + 1:
                break
        told.append(part if found is None else found)
        first = last
    return " ".join(told) if len(parts) > 1 else told[0]


def _whole(code: str, english: str) -> str | None:
    if english in _texts(code):
        return _texts(code)[english]
    for pattern, text in _patterns(code):
        if found := pattern.fullmatch(english):
            fields = {name: _told(code, field) for name, field in found.groupdict().items()}
            shown = {name: field if name in _GIVEN else in_numerals(field) for name, field in fields.items()}
            told = text.format(**shown)
            return told[:1].upper() + told[1:] if english[:1].isupper() and pattern.pattern[:1].islower() else told
    return None


@cache
def _texts(code: str) -> dict[str, str]:
    text = files("rockpulse.views").joinpath("words", f"pictures_{code}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


@cache
def _patterns(code: str) -> list[tuple[re.Pattern[str], str]]:
    known = {english: text for english, text in _texts(code).items() if " " in english or "{" in english}
    longest = sorted(known, key=lambda english: -len(_FIELD.sub("", re.escape(english))))
    return [(re.compile(_FIELD.sub(_field, re.escape(english)), re.IGNORECASE), known[english]) for english in longest]


def _field(name: re.Match[str]) -> str:
    return f"(?P<{name[1]}>{_FIELDS.get(name[1], '(?:(?![.;:] ).)+?')})"
