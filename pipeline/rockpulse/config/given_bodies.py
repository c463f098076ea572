"""Bodies as Python gives them: by name a size, a model's block or settings, or settings in a row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import Any, TypeAlias

from rocking.block import Block
from rockpulse.config.block_settings import BlockSettings
from rockpulse.errors import ConfigError

#: Bodies: by their names full (width, height) in m, Blocks or BlockSettings; or BlockSettings in a row.
Blocks: TypeAlias = Mapping[str, tuple[float, float] | Block | BlockSettings] | Sequence[BlockSettings]

EXPECTED = (
    'blocks: expected a mapping of names to (width, height) in m, such as {"wall": (0.25, 2.2)}, to Block or to '
    "BlockSettings, or a sequence of BlockSettings"
)


def given_bodies(blocks: Blocks) -> Iterator[tuple[str, Block | BlockSettings]]:
    """Every body with its name, sizes as settings; a ConfigError for what is no body, in words that say what is.

    Examples
    --------
    >>> [(name, body.width, body.height) for name, body in given_bodies({"wall": (0.25, 2.2)})]
    [('wall', 0.25, 2.2)]
    """
    if isinstance(blocks, Mapping):
        for name, body in blocks.items():
            yield name, _named(name, body)
    elif isinstance(blocks, Sequence) and not isinstance(blocks, str):
        for body in blocks:
            if not isinstance(body, BlockSettings):
                raise ConfigError(f"{EXPECTED}; found a sequence with {_told(body)}")
            yield body.name, body
    else:
        raise ConfigError(f"{EXPECTED}; found {_told(blocks)}")


def _named(name: Any, body: Any) -> Block | BlockSettings:
    if not isinstance(name, str):
        raise ConfigError(f"blocks: expected texts as the names of bodies, found {_told(name)}")
    if isinstance(body, Block):
        return body
    if isinstance(body, BlockSettings):
        return replace(body, name=name)
    size = body if isinstance(body, (tuple, list)) else ()
    if len(size) != 2 or not all(isinstance(value, Real) and not isinstance(value, bool) for value in size):
        raise ConfigError(
            f'blocks "{name}": expected (width, height) in m, a Block or BlockSettings, found {_told(body)}'
        )
    return BlockSettings(name=name, width=float(size[0]), height=float(size[1]))


def _told(value: Any) -> str:
    """What was found, with its type and as much of it as fits a line."""
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) <= 60 else text[:57] + '...'}"
