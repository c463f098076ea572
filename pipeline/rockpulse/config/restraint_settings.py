"""What a body of the configuration stands on and is held by: [[block.floor]], .pedestal, .tie, .load and .thrust."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rockpulse.option import Section, choice, number

if TYPE_CHECKING:
    from rocking.restraint import Load, Thrust, Tie


@dataclass(frozen=True)
class TieSettings(Section):
    """A tie or restrainer, as :class:`rocking.Tie` has it; without a yield force or ultimate elongation it has none."""

    heading = "[[block.tie]]"
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    stiffness: float = number(dataclasses.MISSING, low=0.0, above=True, unit="N/m")
    gap: float = number(0.0, low=0.0, unit="m")
    yield_force: float | None = number(None, low=0.0, above=True, unit="N")
    ultimate: float | None = number(None, low=0.0, above=True, unit="m")
    side: str = choice("positive", ("positive", "negative", "both"))
    distance: float = number(0.0, low=0.0, unit="m")

    def made(self) -> Tie:
        """The tie of the model."""
        from rocking.restraint import Tie

        found: dict[str, Any] = {name: self[name] for name in self.keys()}
        found |= {name: math.inf for name in ("yield_force", "ultimate") if found[name] is None}
        return Tie(**found)


@dataclass(frozen=True)
class FloorSettings(Section):
    """A mode of the building that a body stands on, as :func:`rocking.floor_motion` has it; `mass` is of the floor.

    `level` is its height over that of the building [-], which a check of codes asks for.
    """

    heading = "[[block.floor]]"
    period: float = number(dataclasses.MISSING, low=0.01, high=20.0, unit="s")
    damping: float = number(0.05, low=0.0, high=0.99, above=True)
    participation: float = number(1.0)
    mass: float | None = number(None, low=0.0, above=True, unit="kg")
    level: float | None = number(None, low=0.0, high=1.0)


@dataclass(frozen=True)
class LoadSettings(Section):
    """A roof or floor that rests on a body, as :class:`rocking.Load` has it."""

    heading = "[[block.load]]"
    weight: float = number(dataclasses.MISSING, low=0.0, above=True, unit="N")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    friction: float | None = number(None, low=0.0, above=True)
    distance: float | None = number(None, low=0.0, unit="m")

    def made(self) -> Load:
        """The load of the model."""
        from rocking.restraint import Load

        return Load(**{name: self[name] for name in self.keys()})


@dataclass(frozen=True)
class ThrustSettings(Section):
    """A constant horizontal force, as :class:`rocking.Thrust` has it."""

    heading = "[[block.thrust]]"
    force: float = number(dataclasses.MISSING, unit="N")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    distance: float = number(0.0, low=0.0, unit="m")

    def made(self) -> Thrust:
        """The thrust of the model."""
        from rocking.restraint import Thrust

        return Thrust(self.force, self.height, self.distance)


@dataclass(frozen=True)
class PedestalSettings(Section):
    """A rectangular part that a body stands on, in the middle of its top, and that may rock with it as one body.

    `friction` is that at its own base, by which sliding of the whole is checked.
    """

    heading = "[[block.pedestal]]"
    width: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    mass: float = number(dataclasses.MISSING, low=0.0, above=True, unit="kg")
    friction: float | None = number(None, low=0.0, above=True)


def floors_as_text(floors: Sequence[FloorSettings]) -> str:
    """Modes of a building as a text of JSON; empty for the ground."""
    return json.dumps([vars(one) for one in floors]) if floors else ""


def floors_from_text(told: str) -> list[FloorSettings]:
    """Modes from :func:`floors_as_text`."""
    return [FloorSettings(**one) for one in json.loads(told)] if told else []
