"""The keys of a section of the configuration: dataclass fields that check their values, with uniform messages."""

import dataclasses
import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from rockpulse.errors import ConfigError


def _short_repr(section: Any) -> str:
    """Return the repr of a section; the late import keeps help texts from loading numpy."""
    from rocking.pictures import short_repr

    return short_repr(section)


@dataclass(frozen=True)
class KeyType:
    """The type of a key: the values that it accepts, and their conversion."""

    expected: str  # description of the values in a message
    accepts: Callable[[Any], bool]
    convert: Callable[[Any], Any]  # makes the stored value, such as a tuple from a list, as sections are immutable
    words: tuple[str, ...] = ()  # known values, for "did you mean"
    finite: bool = False  # whether the value is a number, so that the error can name inf or nan
    unit: str = ""  # unit of a number; empty if it has none


#: Names of units in messages; other units are written as symbols.
_UNIT_NAMES = {"s": "seconds", "m": "metres", "Hz": "hertz", "N": "newtons", "kg": "kilograms", "rad": "radians"} | {
    word: word for word in ("degrees", "years")
}
#: Largest number in a configuration; the smallest positive number is its reciprocal.
LARGEST = 1e15


@dataclass(frozen=True)
class Section:
    """Base class of the sections: it checks the value of every field, and can be unpacked as keyword arguments.

    >>> dict(**rp.HalfWaveSettings(threshold=0.05))
    {'threshold': 0.05, 'min_duration_s': 0.0, 'merge': True}
    """

    heading: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        cls.__repr__ = _short_repr  # type: ignore[method-assign]

    @property
    def where(self) -> str:
        """Name of this section in messages."""
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
        """Return the names of the keys, in the order of the template."""
        return [item.name for item in dataclasses.fields(self)]

    def __getitem__(self, key: str) -> Any:
        return getattr(self, key)


def hint(wrong: str, known: Iterable[str], advice: str = "") -> str:
    """Return ``; did you mean "x"?`` if a known word resembles the wrong one, ignoring case; then the text `advice`.

    >>> hint("wdth", ["width"], "known keys: width"), hint("x", ["width"], "known keys: width")
    ('; did you mean "width"? Known keys: width', '; known keys: width')
    """
    spelt = {word.lower(): word for word in known}
    close = [spelt[word] for word in difflib.get_close_matches(wrong.lower(), list(spelt), n=1)]
    if not close:
        return advice and f"; {advice}"
    return f'; did you mean "{close[0]}"?' + (advice and f" {advice[0].upper()}{advice[1:]}")


def is_number(value: Any) -> bool:
    """Return True for an int or a finite float; False for a bool."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    # TOML allows integers of any length; a float only up to 2**1024.
    return abs(value) < 2**1024 if isinstance(value, int) else math.isfinite(value)


def _of_no_size(value: Any) -> str:
    """Return advice on a number that is too large or too small to compute with; empty for other numbers."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if isinstance(value, float) and not math.isfinite(value):
        return "; it must be finite"
    if value == 0 or 1.0 / LARGEST <= abs(value) <= LARGEST:
        return ""
    return f"; it must be 0, or between {1.0 / LARGEST:g} and {LARGEST:g} in absolute value"


def text(default: str | None = "") -> Any:
    """Declare a key that accepts any text."""
    return key(default, KeyType("a text", lambda value: isinstance(value, str), str))


def texts() -> Any:
    """Declare a key that accepts a list of texts, by default an empty one."""
    return key((), KeyType("a list of texts", _is_texts, tuple))


def boolean(default: bool) -> Any:
    """Declare a key that accepts true or false."""
    return key(default, KeyType("true or false", lambda value: isinstance(value, bool), bool))


def choice(default: str | None, words: tuple[str, ...], most: int = 0) -> Any:
    """Declare a key that accepts one of `words`, or an integer from 1 to `most`."""
    expected = f"{_listed(words)} or an integer from 1 to {most}" if most else f"one of {_listed(words)}"

    def accepts(value: Any) -> bool:
        return value in words if isinstance(value, str) else _is_count(value, 1) and value <= most

    return key(default, KeyType(expected, accepts, lambda value: value, words))


def choices(default: tuple[str, ...], words: tuple[str, ...], empty: bool = False) -> Any:
    """Declare a key that accepts a list of `words`, each at most once; they are stored in the order of `words`."""

    def accepts(value: Any) -> bool:
        return (
            _is_texts(value) and (bool(value) or empty) and set(value) <= set(words) and len(set(value)) == len(value)
        )

    def ordered(value: Any) -> tuple[str, ...]:
        return tuple(word for word in words if word in value)

    some = "any" if empty else "one or more"
    return key(default, KeyType(f"a list of {some} of {_listed(words)}, each once", accepts, ordered, words))


def number(default: Any, low: float = -math.inf, high: float = math.inf, above: bool = False, unit: str = "") -> Any:
    """Declare a key that accepts a finite number [`unit`] from `low` (above `low` if `above` is true) to `high`."""
    positive = bool(unit) and above and low == 0.0
    expected = "a positive number" if positive else "a number"
    expected += f" of {_UNIT_NAMES[unit]}" if unit in _UNIT_NAMES else f" in {unit}" * bool(unit)
    if math.isfinite(low) and not positive:
        expected += f" {'>' if above else '>='} {low:g}"
    if math.isfinite(high):
        expected += f"{',' if positive else ' and'} <= {high:g}"

    def accepts(value: Any) -> bool:
        inside = is_number(value) and (value > low if above else value >= low) and value <= high
        return inside and not _of_no_size(value)

    return key(default, KeyType(expected, accepts, float, finite=True, unit=unit))


def count(default: int, low: int, high: int | None = None) -> Any:
    """Declare a key that accepts an integer from `low` to `high`."""
    expected = f"an integer >= {low}" + ("" if high is None else f" and <= {high}")
    return key(default, KeyType(expected, lambda value: _is_count(value, low) and (high is None or value <= high), int))


def entries(cls: type[Section]) -> Any:
    """Declare a key that contains a list of sections; in TOML each of them begins with the heading of its class."""

    def accepts(value: Any) -> bool:
        return isinstance(value, (list, tuple)) and all(isinstance(item, cls) for item in value)

    made = KeyType(f"a list of {cls.__name__}, in TOML {cls.heading}", accepts, tuple)
    return dataclasses.field(default=(), metadata={"values": made, "entries": cls})


def key(default: Any, values: KeyType) -> Any:
    """Make a dataclass field that checks its value; with the default ``dataclasses.MISSING`` the key is required."""
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
