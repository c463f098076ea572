"""The texts of the views and the decimal sign, in English or in the language set by :func:`writing`."""

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
    """Set the language in a ``with`` block, by its code; raise ConfigError for an unknown code."""
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
    """Return the texts of a language by key; the key of a text in a section is "section.key"."""
    if code not in LANGUAGES:
        available = f"expected one of {', '.join(LANGUAGES)}"
        raise ConfigError(f"language: unknown code {code!r}{hint(code, LANGUAGES, available)}")
    return dict(_flat(tomllib.loads(_FOLDER.joinpath(f"{code}.toml").read_text(encoding="utf-8"))))


def _flat(nested: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    for key, value in nested.items():
        if isinstance(value, str):
            yield f"{before}{key}", value
        else:
            yield from _flat(value, f"{before}{key}.")


def raw_text(key: str) -> str:
    """Return the text of a key in the current language, without filling in the fields in braces."""
    return table(language())[key]


def say(key: str, /, **fields: object) -> str:
    """Return the text of a key in the current language, with the fields in braces filled in."""
    return raw_text(key).format(**fields)


def section(name: str) -> dict[str, str]:
    """Return the texts of a section by key, without filling in the fields in braces."""
    texts = table(language()).items()
    return {key.removeprefix(f"{name}."): text for key, text in texts if key.startswith(f"{name}.")}


def translated(key: str, english: str) -> str:
    """Return the text of a key in the current language; return `english` in English or if the key is missing."""
    return english if language() == "en" else table(language()).get(key, english)


def counted_words(count: int, noun: str) -> str:
    """Return a count with its noun in the current language; `noun` is a key of the section [count]."""
    return say(f"count.{noun}.{'one' if count == 1 else 'more'}", count=count)


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return the first `most` names as a list in words, followed by the number of further names."""
    first = ", ".join(names[:most])
    return first if len(names) <= most else say("and_more", names=first, count=len(names) - most)


def numerals(number: str) -> str:
    """Replace the decimal point of a formatted number by the decimal sign of the current language."""
    return number if language() == "en" else number.replace(".", say("decimal"))


def in_numerals(text: str) -> str:
    """Replace the decimal points of all numbers in a text by the decimal sign of the current language."""
    return text if language() == "en" else _POINT.sub(rf"\1{say('decimal')}\2", text)


def in_dates(text: str) -> str:
    """Replace the ISO 8601 dates in a text by dates in the form of the current language."""

    def formatted(found: re.Match[str]) -> str:
        return say("date", year=found[1], month=found[2], day=found[3]) + found[4].replace("T", " ")

    return text if language() == "en" else _DATE.sub(formatted, text.removesuffix("+00:00"))


def body_name(name: str) -> str:
    """Return the name of a body; a restitution at its end is written with the decimal sign of the language."""
    return _RESTITUTION.sub(lambda found: numerals(found[0]), name)


def own_name(name: str) -> str:
    """Translate the name of a body or site of the sample files to the current language; keep any other name."""
    body, pedestal, number = name.partition(" with pedestal")
    return translated(f"names.{body}", body) + (
        translated("names.with pedestal", pedestal) + number if pedestal else ""
    )


class _Numerals(Formatter):
    """Fills in the fields of a text, with numbers and warnings in the current language."""

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """Return the value of a field; warnings and English texts are translated."""
        return _translated(super().get_value(key, args, kwargs))

    def format_field(self, value: Any, format_spec: str) -> Any:
        """Return the value of a field as text; numbers get the decimal sign of the current language."""
        if isinstance(value, str):
            return value
        text = super().format_field(value, format_spec)
        if isinstance(value, int | float):
            return numerals(text if language() == "en" else text.replace("%", " %"))
        return text


def _translated(value: Any) -> Any:
    if isinstance(value, WarningText):
        return warning_words(value)
    if isinstance(value, str):
        return result_text(value)
    return ", ".join(map(_translated, value)) if isinstance(value, list) else value


def warning_words(warning: WarningText) -> str:
    """Return the text of a warning in the current language."""
    words = translated(f"warnings.{warning.code.partition('/')[0]}", "")
    return _Numerals().vformat(words, (), warning.values) if words else str(warning)


def warnings_of(stored: str) -> list[str]:
    """Return the texts of stored warnings in the current language."""
    return [warning_words(one) for one in restored(stored)]


def result_text(text: str, code: str = "") -> str:
    """Translate an English text of the results to the current language; `code` is its warning code, if it has one."""
    if language() == "en":
        return text
    first, _, inner = code.partition("/")
    words = table(language()).get(f"warnings.{first}")
    return _filled(text, {TEMPLATES[first]: words} if words else section("phrases"), inner)


def error_words(text: str) -> str:
    """Return the error of a key of the configuration in plain words of the current language, if it has any."""
    return _filled(text, section("app.error"))


def _filled(text: str, templates: Mapping[str, str], inner: str = "") -> str:
    """Return the words of the first template that a text is made from, with the fields of the text."""
    for template, translation in templates.items():
        if found := _pattern(template).fullmatch(text):
            parts = {name: _part(name, part, inner) for name, part in found.groupdict().items()}
            return _Numerals().vformat(translation, (), parts)
    return text


def _part(name: str, part: str, code: str) -> str:
    if _NUMBER.fullmatch(part):
        return numerals(part.replace("%", " %"))
    return result_text(part, code if name == "warning" else "")


@cache
def _pattern(template: str) -> re.Pattern[str]:
    """Return a pattern that matches every text made from a template; the fields are named groups."""
    fields = Formatter().parse(template)
    return re.compile(
        "".join(
            re.escape(text) + (f"(?P<{name}>{_NUMBER.pattern if form else '.*?'})" if name else "")
            for text, name, form, _ in fields
        )
    )


def result_texts(texts: str, codes: str = "") -> str:
    """Translate the lines of an English text of the results; `codes` are the warning codes of the lines."""
    lines, of_lines = texts.split("\n"), codes.split(" ")
    return "\n".join(map(result_text, lines, of_lines if len(of_lines) == len(lines) else [""] * len(lines)))
