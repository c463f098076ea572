"""The texts of the views and the decimal sign, in English or in the language set by :func:`writing`."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, lru_cache
from importlib.resources import files
from string import Formatter
from typing import Any

from rockpulse.errors import ConfigError
from rockpulse.option import hint
from rockpulse.warning_text import PLAIN, TEMPLATES, WarningText, restored

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
#: A quotation from a file.
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")
#: One of the parts of a text between semicolons; those in quotations do not count. Each group is atomic, as the time of
#: a failing match would otherwise grow exponentially with the number of quotations.
_SENTENCE = re.compile(r"(?>(?<!\w)'[^']*'|(?<!\w)\"[^\"]*\"|(?!; ).)+", re.DOTALL)
#: Patterns of fields of a text: names without blanks, asides with colons, texts with several sentences; by default a
#: field is a part without colon and semicolon.
_FIELDS = (
    {"id": r"[^\s'\"]+?", "of": r"(?! (?:is|are)\b)[^;:]*?"}
    | dict.fromkeys(("aside", "beside"), f"{_SENTENCE.pattern[:-1]}*?")
    | dict.fromkeys(
        ("reason", "why", "cause", "more", "error", "note", "differences", "readings", "stated", "warning", "lines"),
        ".*?",
    )
)
_FIELD = f"{_SENTENCE.pattern[:-1].replace('; ', '[:;] ')}*?"
#: Templates with a warning or a text of any form, which match texts without a code by mistake.
_ANY_FORM = frozenset({PLAIN, "of_channel"})
#: Words between blanks that mark a text as English; a note of the user in another language stays as it is.
_ENGLISH = re.compile(
    r"(?<![^\s(])(?:the|of|is|are|was|were|not|and|it|that|which|with|from|under|has|have|says|by|expected|found)(?![^\s,:;])"
)


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
    """Return the first `most` names as a list in words, followed by the number of the other names."""
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
    """Fills in the fields of a text; numbers get the decimal sign of the current language."""

    def format_field(self, value: Any, format_spec: str) -> Any:
        """Return the value of a field as text; numbers get the decimal sign of the current language."""
        if isinstance(value, str):
            return value
        text = super().format_field(value, format_spec)
        if isinstance(value, int | float):
            return numerals(text if language() == "en" else text.replace("%", " %"))
        return text


def _translated(name: str, value: Any) -> Any:
    """Return the value of a field of a warning; warnings and English texts are translated."""
    if isinstance(value, WarningText):
        return warning_words(value)
    if isinstance(value, str):
        return _text(name, value)
    return ", ".join(_translated(name, one) for one in value) if isinstance(value, list) else value


def warning_words(warning: WarningText) -> str:
    """Return the text of a warning in the current language."""
    words = translated(f"warnings.{warning.code.partition('/')[0]}", "")
    values = {name: _translated(name, value) for name, value in warning.values.items()}
    return _Numerals().vformat(words, (), values) if words else result_text(warning, PLAIN)


def warnings_of(stored: str) -> list[str]:
    """Return the texts of stored warnings in the current language."""
    return [warning_words(one) for one in restored(stored)]


def result_text(text: str, code: str = "") -> str:
    """Translate an English text of the results to the current language; `code` is its warning code, if it has one.

    The user's names and notes stay unchanged. An English warning without a translation is replaced by the statement
    that the results contain it.
    """
    found = _result(language(), str(text), code)
    return reason_words(text, "note") if found is None and code and _ENGLISH.search(text) else found or text


def reason_words(text: str, field: str = "reason") -> str:
    """Translate a reason to the current language, as a whole if possible, otherwise in its parts between semicolons.

    Parts without a translation are replaced by the words for `field`, or for advice, in the section [other].
    """
    whole = _result(language(), text, "")
    if whole is not None:
        return whole
    first, *others = (one.strip() for one in _SENTENCE.findall(text))
    words = [_result(language(), first, "") or say(f"other.{field}")]
    return "; ".join(dict.fromkeys([*words, *(_result(language(), one, "") or say("other.advice") for one in others)]))


def error_words(text: str) -> str:
    """Return an error in plain words of the current language; an error without a translation is quoted in English."""
    found = _filled(text, section("app.error")) or _result(language(), text, "")
    return say("other.message", text=text) if found is None and _ENGLISH.search(text) else found or text


@lru_cache(maxsize=4096)
def _result(of: str, text: str, code: str) -> str | None:
    """Translate a text of the results to the current language, `of`; None if the text has no translation."""
    if of == "en" or not text:
        return text
    first, _, inner = code.partition("/")
    words = table(of).get(f"warnings.{first}")
    return _filled(text, {TEMPLATES[first]: words}, inner) if words else _filled(text, _templates(of), strict=True)


@cache
def _templates(of: str) -> dict[str, str]:
    """Return the translations of texts without a code, by their English template."""
    coded = {code: table(of).get(f"warnings.{code}", "") for code in TEMPLATES if code not in _ANY_FORM}
    return {TEMPLATES[code]: words for code, words in coded.items() if words} | section("phrases")


def _filled(text: str, templates: Mapping[str, str], inner: str = "", strict: bool = False) -> str | None:
    """Return the translation of the first template that matches a text, with the fields of the text, or None.

    With `strict`, a template whose fields would contain English is left out.
    """
    for template, translation in templates.items():
        if all(part in text for part in _fixed(template)) and (found := _pattern(template, strict).fullmatch(text)):
            parts = {name: _part(name, part, inner) for name, part in found.groupdict().items()}
            kept = [
                _QUOTED.sub("", part) for name, part in parts.items() if re.search(rf"(?<!«){{{name}\b", translation)
            ]
            if not (strict and any(map(_ENGLISH.search, kept))):
                return _Numerals().vformat(translation, (), parts)
    return None


def _part(name: str, part: str, code: str) -> str:
    """Return a field of an English text in the current language; `code` is the code of a nested warning."""
    if _NUMBER.fullmatch(part):
        return numerals(part.replace("%", " %"))
    return result_text(part, code) if name == "warning" else _text(name, part)


def _text(name: str, text: str) -> str:
    """Translate the text of a field; the text of a field that has a key in [other] is never left in English."""
    if _QUOTED.fullmatch(text):
        return text
    return reason_words(text, name) if f"other.{name}" in table(language()) else result_text(text)


@cache
def _fixed(template: str) -> tuple[str, ...]:
    """Return the parts of a template between its fields."""
    return tuple(text for text, *_ in Formatter().parse(template))


@cache
def _pattern(template: str, strict: bool) -> re.Pattern[str]:
    """Return a pattern for all texts made from a template; its named groups are the fields, restricted if `strict`."""
    pattern = ""
    for text, name, form, _ in Formatter().parse(template):
        field = _NUMBER.pattern if form else _FIELDS.get(name or "", _FIELD) if strict else ".*?"
        pattern += re.escape(text) + (f"(?P<{name}>{field})" if name else "")
    return re.compile(pattern, re.DOTALL)


def result_texts(texts: str, codes: str = "") -> str:
    """Translate the lines of an English text of the results; `codes` are the warning codes of the lines."""
    lines, of_lines = texts.split("\n"), [code or PLAIN for code in codes.split(" ")]
    return "\n".join(map(result_text, lines, of_lines if len(of_lines) == len(lines) else [PLAIN] * len(lines)))
