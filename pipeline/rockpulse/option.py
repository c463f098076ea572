"""The keys of a section of the configuration: dataclass fields that check their values in the same words everywhere."""

import dataclasses
import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from rockpulse.errors import ConfigError


@dataclass(frozen=True)
class KeyType:
    """The values that a key takes."""

    expected: str  # their wording for a message
    accepts: Callable[[Any], bool]
    convert: Callable[[Any], Any]  # to the stored value, of a list to a tuple, so that a section is immutable
    words: tuple[str, ...] = ()  # known ones, for "did you mean"
    finite: bool = False  # whether the value is a number, so that the error can name inf or nan


#: Numbers of a configuration are no larger, and no smaller than one over it unless they are 0.
LARGEST = 1e15


@dataclass(frozen=True)
class Section:
    """Base of the sections: checks every field against the values that it takes, and unpacks as keyword arguments.

    >>> from rockpulse import HalfWaveSettings
    >>> dict(**HalfWaveSettings(threshold=0.05))
    {'threshold': 0.05, 'min_duration_s': 0.0, 'merge': True}
    """

    heading: ClassVar[str] = ""

    @property
    def where(self) -> str:
        """The name of this section in messages."""
        return self.heading

    def __post_init__(self) -> None:
        for item in dataclasses.fields(self):
            value, allowed = getattr(self, item.name), item.metadata["values"]
            if value is None and item.default is None:
                continue
            if not allowed.accepts(value):
                wrong = next((word for word in _strings(value) if word not in allowed.words), "")
                advice = (_of_no_size(value) if allowed.finite else "") or hint(wrong, allowed.words)
                raise ConfigError(f"{self.where} {item.name}: expected {allowed.expected}, found {value!r}{advice}")
            object.__setattr__(self, item.name, allowed.convert(value))

    def keys(self) -> list[str]:
        """Names of the keys, in the order of the template."""
        return [item.name for item in dataclasses.fields(self)]

    def __getitem__(self, key: str) -> Any:
        return getattr(self, key)


def hint(wrong: str, known: Iterable[str], told: str = "") -> str:
    """``; did you mean "x"?`` where a known word is close to the wrong one, else nothing; then `told`, what there is.

    >>> hint("wdth", ["width"], "known are width"), hint("x", ["width"], "known are width")
    ('; did you mean "width"? Known are width', '; known are width')
    """
    close = difflib.get_close_matches(wrong, list(known), n=1)
    if not close:
        return told and f"; {told}"
    return f'; did you mean "{close[0]}"?' + (told and f" {told[0].upper()}{told[1:]}")


def is_number(value: Any) -> bool:
    """True for an int or a finite float; a bool is no number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    # TOML has integers of any length; a float holds them up to 2**1024.
    return abs(value) < 2**1024 if isinstance(value, int) else math.isfinite(value)


def _of_no_size(value: Any) -> str:
    """The advice on a number that is too large or too small for any formula; empty for others."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if isinstance(value, float) and not math.isfinite(value):
        return "; it must be finite"
    if value == 0 or 1.0 / LARGEST <= abs(value) <= LARGEST:
        return ""
    return f"; it must be 0, or between {1.0 / LARGEST:g} and {LARGEST:g} in size"


def text(default: str | None = "") -> Any:
    """A key that takes any text."""
    return key(default, KeyType("a text", lambda value: isinstance(value, str), str))


def texts(default: tuple[str, ...] = ()) -> Any:
    """A key that takes a list of texts."""
    return key(default, KeyType("a list of texts", _is_texts, tuple))


def boolean(default: bool) -> Any:
    """A key that takes true or false."""
    return key(default, KeyType("true or false", lambda value: isinstance(value, bool), bool))


def choice(default: str | None, words: tuple[str, ...], most: int = 0) -> Any:
    """A key that takes one of some words, or an integer from 1 to `most`."""
    expected = f"one of {_listed(words)}" + (f" or an integer from 1 to {most}" if most else "")

    def accepts(value: Any) -> bool:
        return value in words if isinstance(value, str) else _is_count(value, 1) and value <= most

    return key(default, KeyType(expected, accepts, lambda value: value, words))


def choices(default: tuple[str, ...], words: tuple[str, ...], empty: bool = False) -> Any:
    """A key that takes a list of different words out of some; it is stored in the order of `words`."""

    def accepts(value: Any) -> bool:
        return (
            _is_texts(value) and (bool(value) or empty) and set(value) <= set(words) and len(set(value)) == len(value)
        )

    def ordered(value: Any) -> tuple[str, ...]:
        return tuple(word for word in words if word in value)

    some = "any" if empty else "one or more"
    return key(default, KeyType(f"a list of {some} of {_listed(words)}, each once", accepts, ordered, words))


def number(default: Any, low: float = -math.inf, high: float = math.inf, above: bool = False, unit: str = "") -> Any:
    """A key that takes a finite number within limits in `unit`; `above` excludes `low` itself."""
    expected = f"a number in {unit}" if unit else "a number"
    if math.isfinite(low):
        expected += f" {'>' if above else '>='} {low:g}"
    if math.isfinite(high):
        expected += f" and <= {high:g}"

    def accepts(value: Any) -> bool:
        inside = is_number(value) and (value > low if above else value >= low) and value <= high
        return inside and not _of_no_size(value)

    return key(default, KeyType(expected, accepts, float, finite=True))


def count(default: int, low: int, high: int | None = None) -> Any:
    """A key that takes an integer from `low` to `high`."""
    expected = f"an integer >= {low}" + ("" if high is None else f" and <= {high}")
    return key(default, KeyType(expected, lambda value: _is_count(value, low) and (high is None or value <= high), int))


def entries(cls: type[Section]) -> Any:
    """A key that holds any number of sections; in TOML each of them stands under the heading of their class."""

    def accepts(value: Any) -> bool:
        return isinstance(value, (list, tuple)) and all(isinstance(item, cls) for item in value)

    made = KeyType(f"a list of {cls.__name__}, each of them {cls.heading}", accepts, tuple)
    return dataclasses.field(default=(), metadata={"values": made, "entries": cls})


def key(default: Any, values: KeyType) -> Any:
    """A dataclass field that carries its check; with ``dataclasses.MISSING`` for a default it must be given."""
    return dataclasses.field(default=default, metadata={"values": values})


def _listed(words: tuple[str, ...]) -> str:
    return ", ".join(f'"{word}"' for word in words)


def _strings(value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    return [item for item in value if isinstance(item, str)] if isinstance(value, (list, tuple)) else []


def _is_texts(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and all(isinstance(item, str) for item in value)


def _is_count(value: Any, low: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= low
