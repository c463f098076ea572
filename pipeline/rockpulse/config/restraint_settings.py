"""Settings of ties, loads and thrusts of a body, whose keys are the arguments of the classes in :mod:`rocking`."""

from __future__ import annotations

import dataclasses
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
