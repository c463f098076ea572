"""One key of the configuration: which values it takes and how that is worded in a message.

A section of the configuration is a frozen dataclass whose fields are made here. The check travels with the field, so a
value is refused in the same words whether it comes from a TOML file, the command line or Python.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from rockpulse.errors import ConfigError

__all__ = [
    "Kind",
    "Section",
    "choice",
    "choices",
    "count",
    "flag",
    "hint",
    "is_number",
    "key",
    "number",
    "text",
    "texts",
]


@dataclass(frozen=True)
class Kind:
    """What a key takes.

    Attributes
    ----------
    expected : str
        Wording for the message.
    accepts : callable
        The test: value -> bool.
    convert : callable
        From an accepted value to the stored one (lists become tuples, so that a section is immutable).
    words : tuple of str
        The words it knows, for "did you mean".
    finite : bool
        Whether it is a number, so that the message on inf or nan has to say what is wrong with it.
    """

    expected: str
    accepts: Callable[[Any], bool]
    convert: Callable[[Any], Any]
    words: tuple[str, ...] = ()
    finite: bool = False


class Section:
    """Base of the sections: checks every field against its kind, and unpacks as keyword arguments.

    Examples
    --------
    >>> from rockpulse.config.settings import HalfWaveSettings
    >>> dict(**HalfWaveSettings(threshold=0.05))
    {'threshold': 0.05, 'min_duration_s': 0.0, 'merge': True}
    """

    heading: ClassVar[str] = ""

    @property
    def where(self) -> str:
        """How a message names this section."""
        return self.heading

    def __post_init__(self) -> None:
        for item in dataclasses.fields(self):  # type: ignore[arg-type]
            value, kind = getattr(self, item.name), item.metadata["kind"]
            if value is None and item.default is None:
                continue
            if not kind.accepts(value):
                wrong = next((word for word in _strings(value) if word not in kind.words), "")
                unbounded = kind.finite and isinstance(value, float) and not math.isfinite(value)
                remark = "; it must be finite" if unbounded else hint(wrong, kind.words)
                raise ConfigError(f"{self.where} {item.name}: expected {kind.expected}, found {value!r}{remark}")
            object.__setattr__(self, item.name, kind.convert(value))

    def keys(self) -> list[str]:
        """Names of the keys, in the order of the template."""
        return [item.name for item in dataclasses.fields(self)]  # type: ignore[arg-type]

    def __getitem__(self, key: str) -> Any:
        return getattr(self, key)


def hint(wrong: str, known: Iterable[str], told: str = "") -> str:
    """``; did you mean "x"?`` where a known word is close to the wrong one, else nothing; then what there is.

    Parameters
    ----------
    wrong : str
        What was found.
    known : iterable of str
        What would have been right.
    told : str, optional
        What follows, such as "known are ..."; behind the question it begins a sentence.

    Examples
    --------
    >>> hint("wdth", ["width"], "known are width"), hint("x", ["width"], "known are width")
    ('; did you mean "width"? Known are width', '; known are width')
    """
    close = difflib.get_close_matches(wrong, list(known), n=1)
    if not close:
        return told and f"; {told}"
    return f'; did you mean "{close[0]}"?' + (told and f" {told[0].upper()}{told[1:]}")


def is_number(value: Any) -> bool:
    """True for an int or a finite float; a bool is no number.

    Parameters
    ----------
    value : object
        Anything.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    # TOML has integers of any length; a float holds them up to 2**1024.
    return abs(value) < 2**1024 if isinstance(value, int) else math.isfinite(value)


def text(default: str | None = "") -> Any:
    """A key that takes any text.

    Parameters
    ----------
    default : str or None
        Value where the key is omitted.
    """
    return key(default, Kind("a text", lambda value: isinstance(value, str), str))


def texts(default: tuple[str, ...] = ()) -> Any:
    """A key that takes a list of texts.

    Parameters
    ----------
    default : tuple of str
        Value where the key is omitted.
    """
    return key(default, Kind("a list of texts", _is_texts, tuple))


def flag(default: bool) -> Any:
    """A key that takes true or false.

    Parameters
    ----------
    default : bool
        Value where the key is omitted.
    """
    return key(default, Kind("true or false", lambda value: isinstance(value, bool), bool))


def choice(default: str, words: tuple[str, ...], or_count: bool = False) -> Any:
    """A key that takes one of some words, or also an integer >= 1.

    Parameters
    ----------
    default : str
        Value where the key is omitted.
    words : tuple of str
        Allowed words.
    or_count : bool
        Whether an integer >= 1 is allowed too.
    """
    expected = f"one of {_listed(words)}" + (" or an integer >= 1" if or_count else "")

    def accepts(value: Any) -> bool:
        return value in words if isinstance(value, str) else or_count and _is_count(value, 1)

    return key(default, Kind(expected, accepts, lambda value: value, words))


def choices(default: tuple[str, ...], words: tuple[str, ...], empty: bool = False) -> Any:
    """A key that takes a list of different words out of some; it is stored in the order of `words`.

    Parameters
    ----------
    default : tuple of str
        Value where the key is omitted.
    words : tuple of str
        Allowed words.
    empty : bool
        Whether the list may be empty.
    """

    def accepts(value: Any) -> bool:
        return (
            _is_texts(value) and (bool(value) or empty) and set(value) <= set(words) and len(set(value)) == len(value)
        )

    def ordered(value: Any) -> tuple[str, ...]:
        return tuple(word for word in words if word in value)

    some = "any" if empty else "one or more"
    return key(default, Kind(f"a list of {some} of {_listed(words)}, each once", accepts, ordered, words))


def number(default: Any, low: float = -math.inf, high: float = math.inf, above: bool = False, unit: str = "") -> Any:
    """A key that takes a finite number within limits.

    Parameters
    ----------
    default : float or None
        Value where the key is omitted; ``dataclasses.MISSING`` for a key that must be given.
    low, high : float
        Limits, in the unit of the key.
    above : bool
        Whether `low` itself is excluded.
    unit : str
        Unit for the message.
    """
    expected = f"a number in {unit}" if unit else "a number"
    if math.isfinite(low):
        expected += f" {'>' if above else '>='} {low:g}"
    if math.isfinite(high):
        expected += f" and <= {high:g}"

    def accepts(value: Any) -> bool:
        return is_number(value) and (value > low if above else value >= low) and value <= high

    return key(default, Kind(expected, accepts, float, finite=True))


def count(default: int, low: int, high: int | None = None) -> Any:
    """A key that takes an integer within limits.

    Parameters
    ----------
    default : int
        Value where the key is omitted.
    low : int
        Smallest allowed value.
    high : int, optional
        Largest allowed value.
    """
    expected = f"an integer >= {low}" + ("" if high is None else f" and <= {high}")
    return key(default, Kind(expected, lambda value: _is_count(value, low) and (high is None or value <= high), int))


def key(default: Any, kind: Kind) -> Any:
    """A dataclass field that carries its check.

    Parameters
    ----------
    default : object
        Value where the key is omitted; ``dataclasses.MISSING`` for a key that must be given.
    kind : Kind
        What the key takes.
    """
    return dataclasses.field(default=default, metadata={"kind": kind})


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
