"""The texts of a language by their keys (English, or that of :func:`writing`), and the form of its numbers."""

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
from rockpulse.warning_text import WarningText, restored

_FOLDER = files("rockpulse.views").joinpath("words")
#: Codes of the languages that there is a file of.
LANGUAGES = tuple(sorted(one.name.removesuffix(".toml") for one in _FOLDER.iterdir() if one.name.endswith(".toml")))
_LANGUAGE = ContextVar("language", default="en")
#: The point of a number; that of an id or a version stands beside letters or a second point.
_POINT = re.compile(r"(?<![\w.])([-−+~<>≤]?\d+)\.(\d+)(?![\w.]*\.\d)(?![A-Za-z_]*@)")


@contextmanager
def writing(code: str) -> Iterator[None]:
    """Write in a language, by its code; a ConfigError for one that there is no file of."""
    table(code)
    before = _LANGUAGE.set(code)
    try:
        yield
    finally:
        _LANGUAGE.reset(before)


def language() -> str:
    """The code of the language that is written."""
    return _LANGUAGE.get()


@cache
def table(code: str) -> Mapping[str, str]:
    """The texts of a language by their keys, those of nested tables joined with points."""
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
    """The text of a key in the language that is written, with its fields as they stand."""
    return table(language())[key]


def say(key: str, /, **fields: object) -> str:
    """The text of a key in the language that is written, its fields filled in."""
    return raw_text(key).format(**fields)


def section(name: str) -> dict[str, str]:
    """The texts whose keys begin with the name of a section, as they stand in the file."""
    texts = table(language()).items()
    return {key.removeprefix(f"{name}."): text for key, text in texts if key.startswith(f"{name}.")}


def translated(key: str, english: str) -> str:
    """The words for a text declared in English below the views, by its key in the other languages."""
    return english if language() == "en" else table(language()).get(key, english)


def counted_words(count: int, noun: str) -> str:
    """A number and what is counted, by a key of [count] that has a form for one and one for more."""
    return say(f"count.{noun}.{'one' if count == 1 else 'more'}", count=count)


def listed(names: Sequence[str], most: int = 6) -> str:
    """The first of some names, and how many more there are."""
    told = ", ".join(names[:most])
    return told if len(names) <= most else say("and_more", names=told, count=len(names) - most)


def numerals(shown: str) -> str:
    """A number in English form in the form of the language that is written."""
    return shown if language() == "en" else shown.replace(".", say("decimal"))


def in_numerals(text: str) -> str:
    """A text with its numbers in the form of the language that is written."""
    return text if language() == "en" else _POINT.sub(rf"\1{say('decimal')}\2", text)


class _Numerals(Formatter):
    """Fills in fields, numbers in the form of the language that is written, warnings in its words."""

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """A value, a warning in the words of the language."""
        return _told(super().get_value(key, args, kwargs))

    def format_field(self, value: Any, format_spec: str) -> Any:
        """A value as text."""
        shown = super().format_field(value, format_spec)
        return numerals(shown) if isinstance(value, int | float) else shown


def _told(value: Any) -> Any:
    if isinstance(value, WarningText):
        return warning_words(value)
    return ", ".join(map(_told, value)) if isinstance(value, list) else value


def warning_words(warning: WarningText) -> str:
    """A warning in the language that is written."""
    words = translated(f"warnings.{warning.code.partition('/')[0]}", "")
    return _Numerals().vformat(words, (), warning.values) if words else str(warning)


def warnings_of(stored: str) -> list[str]:
    """Warnings as they are stored by codes and values, in the language that is written."""
    return [warning_words(one) for one in restored(stored)]
