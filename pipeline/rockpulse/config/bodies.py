"""The bodies of an assessment as the lanes of one :class:`rocking.Block`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rockpulse.config.block_settings import BlockSettings
from rockpulse.errors import ConfigError

__all__ = ["Bodies", "gather_bodies"]


@dataclass(frozen=True, eq=False)
class Bodies:
    """Named bodies in the order of the configuration, and the lanes that stand for them."""

    names: tuple[str, ...]
    #: len(names) x `cases` lanes, the cases of one body next to each other.
    lanes: Block
    #: Restitution values per body; 1 unless a list was given (a single value is then repeated).
    cases: int
    #: Full sizes of each body [m]; NaN for one given by p and alpha.
    width: np.ndarray
    height: np.ndarray
    #: Remarks on each body, one a line.
    warnings: tuple[str, ...]

    def per_case(self, values: np.ndarray) -> np.ndarray:
        """(..., b x cases) -> (..., b, cases)."""
        return values.reshape(*values.shape[:-1], len(self.names), self.cases)


def gather_bodies(blocks: Sequence[BlockSettings] | Mapping[str, Block]) -> Bodies:
    """Line up the bodies of a configuration, or of a mapping of name to Block.

    A Block of shape (c,) stands for c restitution values of one body. A ConfigError without any body, with restitution
    lists of different lengths, a Block whose sizes differ among its lanes, or bodies in different gravity.
    """
    named = dict(blocks) if isinstance(blocks, Mapping) else {block.name: block.block() for block in blocks}
    if not named:
        raise ConfigError(
            "no block to assess: give [[block]] entries in the configuration or --block NAME=WIDTHxHEIGHT"
        )
    lengths = {name: block.shape[0] for name, block in named.items() if block.shape}
    if len(set(lengths.values())) > 1:
        raise ConfigError(f"restitution: expected lists of one length in all blocks, found {lengths}")
    gravities = {block.gravity for block in named.values()}
    if len(gravities) > 1:
        raise ConfigError(f"gravity: expected one value for all blocks of an assessment, found {sorted(gravities)}")
    cases = next(iter(lengths.values()), 1)
    for name, block in named.items():
        if np.ptp(block.p) > 0.0 or np.ptp(block.alpha_c) > 0.0:
            raise ConfigError(
                f'block "{name}": its lanes may differ in restitution only; give other sizes another name'
            )

    return Bodies(
        names=tuple(named),
        lanes=Block.stack([block.lanes(cases) for block in named.values()]),
        cases=cases,
        width=np.array([2.0 * np.max(block.half_width) for block in named.values()]),
        height=np.array([2.0 * np.max(block.half_height) for block in named.values()]),
        warnings=tuple("\n".join(block.warnings) for block in named.values()),
    )
