"""Settings of ties, loads and thrusts of a body, and of the modes of the building under it."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rockpulse.option import Section, choice, number


@dataclass(frozen=True)
class _OfModel(Section):
    """Base class of settings whose keys are the arguments of a class of :mod:`rocking`."""

    def made(self) -> Any:
        """Return an object of the corresponding class of :mod:`rocking` with these values."""
        import rocking

        cls = getattr(rocking, type(self).__name__.removesuffix("Settings"))
        return cls(**{name: value for name, value in {**self}.items() if value is not None and name != "support"})


@dataclass(frozen=True)
class TieSettings(_OfModel):
    """A tie or restrainer (:class:`rocking.Tie`); yield force and ultimate elongation are optional.

    >>> rp.TieSettings(height=8.0, stiffness=6e6, side="left")
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [[block.tie]] side: expected one of "positive", "negative"...
    """

    heading = "[[block.tie]]"
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    stiffness: float = number(dataclasses.MISSING, low=0.0, above=True, unit="N/m")
    gap: float = number(0.0, low=0.0, unit="m")
    yield_force: float | None = number(None, low=0.0, above=True, unit="N")
    ultimate: float | None = number(None, low=0.0, above=True, unit="m")
    side: str = choice("positive", ("positive", "negative", "both"))
    distance: float = number(0.0, low=0.0, unit="m")


@dataclass(frozen=True)
class LoadSettings(_OfModel):
    """A roof or floor that rests on a body (:class:`rocking.Load`).

    `support` is the length over which its beams rest on the body [m], used in code checks.

    >>> rp.LoadSettings(weight=20e3, height=3.0, friction=0.4).made()
    Load(weight=20000.0, height=3.0, friction=0.4)
    """

    heading = "[[block.load]]"
    weight: float = number(dataclasses.MISSING, low=0.0, above=True, unit="N")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    friction: float | None = number(None, low=0.0, above=True)
    distance: float | None = number(None, low=0.0, unit="m")
    support: float | None = number(None, low=0.0, above=True, unit="m")


@dataclass(frozen=True)
class ThrustSettings(_OfModel):
    """A constant horizontal force on a body (:class:`rocking.Thrust`).

    >>> rp.ThrustSettings(force=5e3, height=2.5).made()
    Thrust(force=5000.0, height=2.5)
    """

    heading = "[[block.thrust]]"
    force: float = number(dataclasses.MISSING, unit="N")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    distance: float = number(0.0, low=0.0, unit="m")


@dataclass(frozen=True)
class FloorSettings(Section):
    """A mode of the building under a body (as in :func:`rocking.floor_motion`), and the mass of the floor.

    `level` is the height of the floor divided by the height of the building [-], needed for code checks.

    >>> rp.FloorSettings(period=0.4).damping, rp.FloorSettings(period=0.4).participation
    (0.05, 1.0)
    """

    heading = "[[block.floor]]"
    period: float = number(dataclasses.MISSING, low=0.01, high=20.0, unit="s")
    damping: float = number(0.05, low=0.0, high=0.99, above=True)
    participation: float = number(1.0)
    mass: float | None = number(None, low=0.0, above=True, unit="kg")
    level: float | None = number(None, low=0.0, high=1.0)


def floors_as_text(floors: Sequence[FloorSettings]) -> str:
    """Return the modes of a building as JSON text; an empty text for a body on the ground."""
    return json.dumps([vars(one) for one in floors]) if floors else ""


def floors_from_text(text: str) -> list[FloorSettings]:
    """Return the modes of a building from the text that :func:`floors_as_text` returns."""
    return [FloorSettings(**one) for one in json.loads(text)] if text else []
