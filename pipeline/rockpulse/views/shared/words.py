"""The texts of the current language by key (English, or the language set by :func:`writing`), and its numbers."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib.resources import files
from string import Formatter
from typing import Any

from rockpulse.errors import ConfigError
from rockpulse.option import hint
from rockpulse.warning_text import TEMPLATES, WarningText, restored

_FOLDER = files("rockpulse.views").joinpath("words")
#: Codes of the available languages.
LANGUAGES = tuple(sorted(one.name.removesuffix(".toml") for one in _FOLDER.iterdir() if one.name.endswith(".toml")))
_LANGUAGE = ContextVar("language", default="en")
#: Pattern of the decimal point of a number, but not of an id or a version.
_POINT = re.compile(r"(?<![\w.])([-−+~<>≤]?\d+)\.(\d+)(?![\w.]*\.\d)(?![A-Za-z_]*@)")
#: A number in the English text of a result.
_NUMBER = re.compile(r"[-+]?(?:\d[\d.]*(?:e[-+]?\d+)?|inf|nan)%?")
#: Pattern of a date, with the T before a time.
_DATE = re.compile(r"\b(\d{4})-(\d\d)-(\d\d)(T(?=\d)|\b)")
#: Restitution at the end of the name of a body.
_RESTITUTION = re.compile(r"(?<=, C = )\d\.\d+$")


@contextmanager
def writing(code: str) -> Iterator[None]:
    """Set the current language by its code in a ``with`` block; ConfigError if it is not available."""
    table(code)
    before = _LANGUAGE.set(code)
    try:
        yield
    finally:
        _LANGUAGE.reset(before)


def language() -> str:
    """Return the code of the current language."""
    return _LANGUAGE.get()


@cache
def table(code: str) -> Mapping[str, str]:
    """Return the texts of a language by keys, with nested keys joined by points."""
    if code not in LANGUAGES:
        told = f"there are {', '.join(LANGUAGES)}"
        raise ConfigError(f"language: no words for {code!r}{hint(code, LANGUAGES, told)}")
    return dict(_flat(tomllib.loads(_FOLDER.joinpath(f"{code}.toml").read_text(encoding="utf-8"))))


def _flat(nested: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    for key, value in nested.items():
        if isinstance(value, str):
            yield f"{before}{key}", value
        else:
            yield from _flat(value, f"{before}{key}.")


def raw_text(key: str) -> str:
    """Return the text of a key in the current language, without filling in its fields."""
    return table(language())[key]


def say(key: str, /, **fields: object) -> str:
    """Return the text of a key in the current language with its fields filled in."""
    return raw_text(key).format(**fields)


def section(name: str) -> dict[str, str]:
    """Return the texts of a section, without filling in their fields."""
    texts = table(language()).items()
    return {key.removeprefix(f"{name}."): text for key, text in texts if key.startswith(f"{name}.")}


def translated(key: str, english: str) -> str:
    """Return the translation of an English text that is defined outside the views, from its key."""
    return english if language() == "en" else table(language()).get(key, english)


def counted_words(count: int, noun: str) -> str:
    """Return a number with its noun, in singular or plural, from a key of [count] in the texts."""
    return say(f"count.{noun}.{'one' if count == 1 else 'more'}", count=count)


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return the first names, and the number of the others."""
    told = ", ".join(names[:most])
    return told if len(names) <= most else say("and_more", names=told, count=len(names) - most)


def numerals(shown: str) -> str:
    """Convert a number from English form to the form of the current language."""
    return shown if language() == "en" else shown.replace(".", say("decimal"))


def in_numerals(text: str) -> str:
    """Convert all numbers of a text to the form of the current language."""
    return text if language() == "en" else _POINT.sub(rf"\1{say('decimal')}\2", text)


def in_dates(text: str) -> str:
    """Convert the dates of a text, stored in ISO 8601, to the form of the current language."""

    def shown(found: re.Match[str]) -> str:
        return say("date", year=found[1], month=found[2], day=found[3]) + found[4].replace("T", " ")

    return text if language() == "en" else _DATE.sub(shown, text.removesuffix("+00:00"))


def body_name(name: str) -> str:
    """Return the name of a body with its restitution, if any, in the form of the current language."""
    return _RESTITUTION.sub(lambda found: numerals(found[0]), name)


def own_name(name: str) -> str:
    """Return the name of a body (alone or with its pedestal) or site of the samples in the current language."""
    body, pedestal, number = name.partition(" with pedestal")
    return translated(f"names.{body}", body) + (
        translated("names.with pedestal", pedestal) + number if pedestal else ""
    )


class _Numerals(Formatter):
    """Formatter that fills in fields; numbers and warnings are written in the current language."""

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """Return the value of a field; a warning is translated."""
        return _translated(super().get_value(key, args, kwargs))

    def format_field(self, value: Any, format_spec: str) -> Any:
        """Format a value as text."""
        if isinstance(value, str):
            return value
        shown = super().format_field(value, format_spec)
        if isinstance(value, int | float):
            return numerals(shown if language() == "en" else shown.replace("%", " %"))
        return shown


def _translated(value: Any) -> Any:
    if isinstance(value, WarningText):
        return warning_words(value)
    if isinstance(value, str):
        return result_text(value)
    return ", ".join(map(_translated, value)) if isinstance(value, list) else value


def warning_words(warning: WarningText) -> str:
    """Return a warning in the current language."""
    words = translated(f"warnings.{warning.code.partition('/')[0]}", "")
    return _Numerals().vformat(words, (), warning.values) if words else str(warning)


def warnings_of(stored: str) -> list[str]:
    """Return stored warnings (codes and values) in the current language."""
    return [warning_words(one) for one in restored(stored)]


def result_text(text: str, code: str = "") -> str:
    """Return an English text of the results in the current language, by the code of a warning or by [phrases]."""
    if language() == "en":
        return text
    first, _, inner = code.partition("/")
    words = table(language()).get(f"warnings.{first}")
    for template, told in ({TEMPLATES[first]: words} if words else section("phrases")).items():
        if found := _pattern(template).fullmatch(text):
            parts = {name: _part(name, part, inner) for name, part in found.groupdict().items()}
            return _Numerals().vformat(told, (), parts)
    return text


def _part(name: str, part: str, code: str) -> str:
    if _NUMBER.fullmatch(part):
        return numerals(part.replace("%", " %"))
    return result_text(part, code if name == "warning" else "")


@cache
def _pattern(template: str) -> re.Pattern[str]:
    """Return the pattern of the texts made from a template; a field with a format is a number."""
    fields = Formatter().parse(template)
    return re.compile(
        "".join(
            re.escape(text) + (f"(?P<{name}>{_NUMBER.pattern if form else '.*?'})" if name else "")
            for text, name, form, _ in fields
        )
    )


def result_texts(texts: str, codes: str = "") -> str:
    """Return English texts of the results, one per line, in the current language; `codes` are those of warnings."""
    lines, of_lines = texts.split("\n"), codes.split(" ")
    return "\n".join(map(result_text, lines, of_lines if len(of_lines) == len(lines) else [""] * len(lines)))
