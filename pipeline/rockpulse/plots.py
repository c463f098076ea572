"""Pictures of results: each takes Axes or makes its own, and returns them; loaded on first use."""

from typing import Any

import rockpulse.views.plots

__all__ = rockpulse.views.plots.__all__


def __getattr__(name: str) -> Any:
    """The public name of :mod:`rockpulse.views.plots`; AttributeError where it has none."""
    return getattr(rockpulse.views.plots, name)


def __dir__() -> list[str]:
    """The public names."""
    return rockpulse.views.plots.__dir__()
