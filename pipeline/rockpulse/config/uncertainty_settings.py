"""The section [uncertainty] of the configuration: what is not known of the bodies and the strength of the motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rockpulse.option import KeyType, Section, boolean, choice, is_number, key, number

if TYPE_CHECKING:
    from rocking.uncertainty import Uncertainty


#: Least and largest standard deviation of the factor, and largest loss of the angle, as the solver takes them; a test
#: compares these with its own.
LEAST_SPREAD, LARGEST_SPREAD = 0.02, 1.0

#: Frequency parameters at which the overturning spectrum of a record is marched: those next to the bodies', or all.
SPECTRA = ("bodies", "all")


def _is_range(value: Any) -> bool:
    two = isinstance(value, (list, tuple)) and len(value) == 2 and all(is_number(item) for item in value)
    return two and 0.0 < value[0] <= value[1] <= 1.0


_RANGE = KeyType(
    "[least, most], shares of the nominal C above 0 and at most 1",
    _is_range,
    lambda value: tuple(map(float, value)),
)


@dataclass(frozen=True)
class UncertaintySettings(Section):
    """The uncertainty under which the probability of overturning is stated, and whether there is one.

    It is of the nonlinear model: without `nonlinear` among the models there is none. A body whose restitution
    is a list has the range from its least to its largest value in place of `restitution`.
    """

    heading = "[uncertainty]"
    probability: bool = boolean(True)
    factor: float = number(0.10, low=LEAST_SPREAD, high=LARGEST_SPREAD)
    restitution: tuple[float, float] = key((0.9, 1.0), _RANGE)
    geometry: float = number(0.05, low=0.0, high=LARGEST_SPREAD)
    azimuth: bool = boolean(False)
    spectrum: str = choice("bodies", SPECTRA)

    def of_draws(self) -> Uncertainty:
        """The same for the solver."""
        from rocking.uncertainty import Uncertainty

        return Uncertainty(factor=self.factor, restitution=self.restitution, geometry=self.geometry)
