"""Settings of the modes of the building under a body, and their conversion to and from the text in the results."""

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass

from rockpulse.option import Section, number


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
