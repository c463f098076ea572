"""The section [hazard] of the configuration: how often the ground at the site exceeds a level of a measure."""

from __future__ import annotations

from dataclasses import dataclass

from rockpulse.errors import ConfigError
from rockpulse.option import Section, choice, number, text
from rockpulse.record.measures import HAZARD, MEASURES, PGA

#: Units of the levels of the measures that a hazard is given in.
HAZARD_UNITS = tuple(dict.fromkeys(unit for name in HAZARD for unit in MEASURES[name].known_units))


@dataclass(frozen=True)
class HazardSettings(Section):
    """The hazard of the site: the file of a curve, or the power law k0 x^-k; and the time that is asked about.

    `longitude` and `latitude` choose the site in a file of several. `measure` and `unit` are those of the power law,
    the unit that in SI without; a file names its own. `soil_factor` brings the levels of a hazard on rock to the ground
    of the site.

    Raises
    ------
    ConfigError
        For both a file and a power law, half of a power law, or half of a site.
    """

    heading = "[hazard]"
    file: str | None = text(None)
    longitude: float | None = number(None, low=-180.0, high=360.0, unit="degrees")
    latitude: float | None = number(None, low=-90.0, high=90.0, unit="degrees")
    k0: float | None = number(None, low=0.0, above=True, unit="1/year")
    k: float | None = number(None, low=0.0, above=True)
    measure: str = choice(PGA, HAZARD)
    unit: str | None = choice(None, HAZARD_UNITS)
    soil_factor: float = number(1.0, low=0.0, above=True)
    years: float = number(50.0, low=0.0, above=True, unit="years")

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.k0 is None) != (self.k is None):
            raise ConfigError("[hazard] k0, k: expected both of the power law k0 x^-k, found one")
        if self.file is not None and self.k0 is not None:
            raise ConfigError("[hazard]: expected a file or the power law k0, k, found both")
        if (self.longitude is None) != (self.latitude is None):
            raise ConfigError("[hazard] longitude, latitude: expected both or neither, found one")
