"""The facts of one record or one block as text, with a dash for those that are not known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rocking.block_limits import radius_of_rectangle
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.terminal import ABSENT, figure

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Known", "own_radius"]


def own_radius(radius: float, p: float, gravity: float | None) -> float | None:
    """The radius of a body [m] where it is its own; None where it is that of the rectangle with the same p [1/s].

    Results without the gravity of their bodies know no other radius than the rectangle's.
    """
    of_rectangle = gravity is None or math.isclose(radius, radius_of_rectangle(p, gravity), rel_tol=1e-9)
    return None if of_rectangle else radius


class Known:
    """The variables of one record or one block of the node /summary: ``Known(summary, record="a")``."""

    def __init__(self, summary: xr.Dataset, **labels: str) -> None:
        ((self._dim, label),) = labels.items()
        self._summary, self._place = summary, summary.get_index(self._dim).get_loc(label)

    def value(self, name: str) -> Any:
        """The value of a variable along the records or the blocks alone; None where the results lack it."""
        if name not in self._summary:
            return None
        return self._summary[name].variable[{self._dim: self._place}].values.item()

    def number(self, name: str, unit: str = "") -> str:
        """A number with its unit."""
        found = self.value(name)
        return ABSENT if found is None else figure(float(found), unit)

    def words(self, name: str) -> str:
        """A text."""
        return str(self.value(name) or ABSENT)

    def lines(self, name: str) -> tuple[str, ...]:
        """The lines of a text that are not empty."""
        return tuple(line for line in str(self.value(name) or "").split("\n") if line)

    @property
    def main_count(self) -> str:
        """The number of main impulses in the sequence of a record."""
        count = self.value("main_count")
        return "as many as fit into the duration" if count == -1 else str(count)

    @property
    def peak_velocity(self) -> str:
        """The PGV of a record in m/s, marked where the baseline of the record drifts."""
        shown = self.number("pgv", "m/s")
        return f"~{shown} (drift)" if self.value("pgv_drift") else shown

    @property
    def radius(self) -> str:
        """The radius of a block in m, with a note on what it is for a body that is no rectangle."""
        shown, width = self.number("radius", "m"), self.value("width")
        if shown == ABSENT or width is None or not math.isnan(width):
            return shown
        own = own_radius(*(self.value(name) for name in ("radius", "p", "gravity")))
        return f"{shown} ({'of the rectangle with this p' if own is None else 'from the corner to the centre of mass'})"

    @property
    def strength(self) -> list[str]:
        """PGA and PGV of a record."""
        return [f"PGA {figure(self.value('pga') / STANDARD_GRAVITY, 'g')}", f"PGV {self.peak_velocity}"]
