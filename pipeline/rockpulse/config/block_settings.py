"""The bodies of a configuration: names and full sizes as the user gives them, and the model's block made of them."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rockpulse.errors import ConfigError
from rockpulse.option import KeyType, Section, is_number, key, number
from rockpulse.record.record import STANDARD_GRAVITY

if TYPE_CHECKING:
    from rocking import Block

__all__ = ["BlockSettings", "parse_block_option"]


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip()) and "/" not in value and value.isprintable()


def _is_ratio(value: Any) -> bool:
    return is_number(value) and 0.0 <= value <= 1.0


def _is_restitution(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return bool(value) and all(_is_ratio(item) for item in value)
    return value == "housner" or _is_ratio(value)


def _restitution(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return tuple(float(item) for item in value)
    return value if isinstance(value, str) else float(value)


_NAME = KeyType('a printable text without "/"', _is_name, str)
_RESTITUTION = KeyType(
    'a velocity ratio in [0, 1], "housner", or a list of such numbers', _is_restitution, _restitution, ("housner",)
)


@dataclass(frozen=True)
class BlockSettings(Section):
    """One free-standing body, by its full width and height or by p and alpha.

    Attributes
    ----------
    name : str
        Unique in a configuration.
    width, height : float or None
        Full size in the plane of rocking [m].
    p, alpha : float or None
        Frequency parameter [1/s] and critical angle [rad] of a body that is no rectangle.
    restitution : float, str or tuple of float
        Velocity ratio of an impact [-], "housner", or several values to be assessed side by side.
    gravity : float
        Acceleration of gravity at the block [m/s2].

    Raises
    ------
    ConfigError
        Unless exactly one of the two pairs is given, with sizes that are positive.

    Examples
    --------
    >>> BlockSettings(name="pier", width=1.0, height=3.873).block().half_width
    0.5
    """

    heading = "[[block]]"
    name: str = key(dataclasses.MISSING, _NAME)
    width: float | None = number(None, low=0.0, above=True, unit="m")
    height: float | None = number(None, low=0.0, above=True, unit="m")
    p: float | None = number(None, low=0.0, above=True, unit="1/s")
    alpha: float | None = number(None, low=0.0, above=True, unit="rad")
    restitution: float | str | tuple[float, ...] = key("housner", _RESTITUTION)
    gravity: float = number(STANDARD_GRAVITY, low=0.0, above=True, unit="m/s2")

    @property
    def where(self) -> str:
        """The name of this block in messages."""
        return f'[[block]] "{self.name}"' if _is_name(self.name) else self.heading

    def __post_init__(self) -> None:
        super().__post_init__()
        given = {name for name in ("width", "height", "p", "alpha") if self[name] is not None}
        if given not in ({"width", "height"}, {"p", "alpha"}):
            found = " and ".join(sorted(given)) if given else "neither"
            raise ConfigError(f"{self.where}: expected width and height [m], or p [1/s] and alpha [rad]; found {found}")
        if self.alpha is not None and self.alpha >= math.pi / 2:
            raise ConfigError(
                f"{self.where} alpha: expected an angle below pi/2 rad, found {self.alpha:g}; is it in degrees?"
            )

    def block(self) -> Block:
        """The model's block, with half sizes; one lane, or one per restitution of a list.

        Raises
        ------
        ConfigError
            Where the model refuses it (Housner's restitution for a body squatter than 0.707).
        """
        from rocking.block import Block

        restitution: Any = list(self.restitution) if isinstance(self.restitution, tuple) else self.restitution
        try:
            if self.width is not None and self.height is not None:
                return Block(self.width / 2, self.height / 2, restitution=restitution, gravity=self.gravity)
            return Block.from_parameters(self.p, self.alpha, restitution=restitution, gravity=self.gravity)
        except ValueError as error:
            swapped = ""
            if self.width is not None and self.height is not None and self.width > self.height:
                swapped = f": it is {self.width:g} m wide and {self.height:g} m high, are the two swapped?"
            raise ConfigError(f"{self.where}{swapped} {error}") from None


def parse_block_option(option: str) -> BlockSettings:
    """A block from the command line, ``NAME=WIDTHxHEIGHT`` with full sizes in m; a ConfigError for any other text.

    Examples
    --------
    >>> block = parse_block_option("pier=0.8x3.2")
    >>> block.name, block.width, block.height
    ('pier', 0.8, 3.2)
    """
    name, equals, size = option.rpartition("=")
    width, times, height = size.lower().partition("x")
    if not (equals and times):
        raise ConfigError(
            f'--block: expected NAME=WIDTHxHEIGHT with sizes in m, such as "pier=0.8x3.2", found "{option}"'
        )
    try:
        return BlockSettings(name=name, width=float(width), height=float(height))
    except ConfigError as error:
        raise ConfigError(f'--block "{option}": {error}') from None
    except ValueError:
        raise ConfigError(f'--block "{option}": expected two numbers in m, found "{width}" and "{height}"') from None
