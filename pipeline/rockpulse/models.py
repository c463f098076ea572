"""Numerics of rocking blocks: the public names of the package :mod:`rocking`, loaded on first use."""

from typing import Any

import rocking

__all__ = rocking.__all__


def __getattr__(name: str) -> Any:
    """The public name of :mod:`rocking`; AttributeError where it has none."""
    return getattr(rocking, name)


def __dir__() -> list[str]:
    """The public names."""
    return rocking.__dir__()
