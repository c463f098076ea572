"""The parametric study of Casapulla & Maione (2017), section 4.

The names are those of :mod:`rockpulse.studies.paper`, which is loaded on first use.
"""

from typing import Any

import rockpulse.studies.paper

__all__ = rockpulse.studies.paper.__all__


def __getattr__(name: str) -> Any:
    """The public name of :mod:`rockpulse.studies.paper`; AttributeError where it has none."""
    return getattr(rockpulse.studies.paper, name)


def __dir__() -> list[str]:
    """The public names."""
    return rockpulse.studies.paper.__dir__()
