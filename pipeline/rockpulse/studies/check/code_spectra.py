"""Elastic response spectra from codes and tables.

.. note:: F_0 is the plateau (2.5 in EN 1998-1), T_B, T_C and T_D are the corner periods, S is the soil factor and eta =
   sqrt(10/(5 + xi)), at least 0.55, with the damping xi in percent. S_e = a_g S [1 + T/T_B (eta F_0 - 1)] up to T_B,
   and a_g S eta F_0 up to T_C; it is multiplied by T_C/T up to T_D, and by T_C T_D/T^2 beyond (EN 1998-1, 3.2.2.2,
   (3.2)-(3.6); NTC 2018, 3.2.3.2.1). NTC: S = S_S S_T, T_C = C_C T_C*, T_B = T_C/3, T_D = 4 a_g/g + 1.6 s.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from rockpulse.config.ground_types import EN_1998, NTC, soil_factor
from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError
from rockpulse.files import column_numbers, read_table
from rockpulse.record.record import STANDARD_GRAVITY

#: Number of periods in the search for the largest displacement of a table.
PERIODS = 401


def damping_factor(damping: float) -> float:
    """Return the damping correction factor eta of EN 1998-1 (3.6) and NTC 2018 (3.2.4) for a damping ratio [-]."""
    return max(0.55, math.sqrt(10.0 / (5.0 + 100.0 * damping)))


def displacement_of(period: float, acceleration: float) -> float:
    """Convert a spectral acceleration [m/s2] at a period [s] to a spectral displacement [m]."""
    return acceleration * (period / (2.0 * math.pi)) ** 2


class TableEnds(ConfigError):
    """Error: a period is beyond the last period of a tabulated spectrum."""


@dataclass(frozen=True)
class CodeSpectrum:
    """The elastic response spectrum of EN 1998-1 or NTC 2018."""

    ground: float  # a_g S [m/s2]
    plateau: float  # F_0 [-]
    corners: tuple[float, float, float]  # T_B, T_C, T_D [s]
    words: str = "spectrum"

    def __call__(self, period: float, damping: float = 0.05) -> float:
        """Return S_e [m/s2] at a period [s]; beyond T_D the displacement is constant."""
        first, second, third = self.corners
        most = damping_factor(damping) * self.plateau
        if period < first:
            return self.ground * (1.0 + period / first * (most - 1.0))
        return self.ground * most * min(1.0, second / period) * min(1.0, third / period)

    def displacement(self, period: float, damping: float = 0.05) -> float:
        """Return the spectral displacement S_De [m] at a period [s]; it is never larger at a shorter period."""
        return displacement_of(period, self(period, damping))


@dataclass(frozen=True, eq=False)
class TabledSpectrum:
    """A spectrum for 5 % damping, interpolated in a table; the factor eta converts it to other damping ratios."""

    period: np.ndarray  # (n,) T [s] from 0, ascending
    acceleration: np.ndarray  # (n,) S_e [m/s2], positive
    words: str = "spectrum"  # name of its source in messages

    def __post_init__(self) -> None:
        if self.period.size < 2:
            raise ConfigError(f"{self.words}: expected two or more periods, found {self.period.size}")
        if self.period[0] != 0.0:
            found = f"found {self.period[0]:g} s"
            raise ConfigError(
                f"{self.words}: expected 0 s as the first period, for the peak ground acceleration, {found}"
            )

    @property
    def ground(self) -> float:
        """Peak ground acceleration [m/s2]: S_e at the period 0."""
        return float(self.acceleration[0])

    def __call__(self, period: float, damping: float = 0.05) -> float:
        """Return S_e [m/s2] at a period [s]; raise TableEnds if the period is beyond the last row of the table."""
        if period > self.period[-1]:
            raise TableEnds(
                f"{self.words}: the table ends at {self.period[-1]:g} s, but {period:.3g} s is needed: extend it"
            )
        value = float(np.interp(period, self.period, self.acceleration))
        return value * damping_factor(damping) if period > 0.0 else value

    def displacement(self, period: float, damping: float = 0.05) -> float:
        """Return the largest spectral displacement S_De [m] at periods up to a given period [s]."""
        periods = np.linspace(period, 0.0, PERIODS).tolist()  # the longest period first, as it may be beyond the table
        return max(displacement_of(one, self(one, damping)) for one in periods)


DemandSpectrum: TypeAlias = CodeSpectrum | TabledSpectrum


def spectrum_of(settings: CheckSettings, folder: Path = Path()) -> DemandSpectrum:
    """Return the spectrum given in [check], whose file names are relative to `folder`; ConfigError if none is given."""
    if settings.file is not None:
        return TabledSpectrum(*read_spectrum(folder / settings.file), str(folder / settings.file))
    if settings.ag is None:
        raise ConfigError(
            "[check]: no design spectrum is given; state ag [g], f0 and tc_star [s] for NTC, ag [g] for en_1998_1 or "
            "en_1998_2, or file, a CSV table of the spectrum"
        )
    ag, words = settings.ag * STANDARD_GRAVITY, f"a_g {settings.ag:g} g, ground {settings.ground}"
    soil = soil_factor(settings, settings.ag, settings.ground)
    if settings.spectrum != "ntc":
        _, first, second, third = EN_1998[settings.spectrum][settings.ground]
        return CodeSpectrum(ag * soil, 2.5, (first, second, third), f"EN 1998-1 type {settings.spectrum[-1]}, {words}")
    assert settings.f0 is not None
    assert settings.tc_star is not None
    factor, power = NTC[settings.ground][1]
    fall = factor * settings.tc_star**power * settings.tc_star
    return CodeSpectrum(
        ag * soil,
        settings.f0,
        (fall / 3.0, fall, 4.0 * settings.ag + 1.6),
        f"NTC 2018, {words}, {settings.topography}, F_0 {settings.f0:g}, T_C* {settings.tc_star:g} s",
    )


def read_spectrum(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read a table "period [s],sa [g]" or "sa [m/s2]"; return ascending periods [s] and positive accelerations [m/s2].

    Raises ConfigError, with the row, for invalid numbers.
    """
    table = read_table(path, (), "a table of a spectrum")
    heads = [str(name).lower() for name in table.columns]
    units = {"sa [g]": STANDARD_GRAVITY, "sa [m/s2]": 1.0}
    if len(heads) != 2 or heads[0] != "period [s]" or heads[1] not in units:
        found = ", ".join(map(str, table.columns))
        raise ConfigError(f'{path}: expected the columns "period [s]" and "sa [g]" or "sa [m/s2]", found {found}')
    period, acceleration = (column_numbers(str(path), table, name) for name in table.columns)
    for row in range(period.size):
        before = period[row - 1] if row else -math.inf
        if not (period[row] > before and period[row] >= 0.0):
            raise ConfigError(
                f"{path}: row {row + 1}: expected periods in ascending order, from 0 s, found {period[row]:g} s"
            )
        if acceleration[row] <= 0.0:
            raise ConfigError(f"{path}: row {row + 1}: expected an acceleration above 0, found {acceleration[row]:g}")
    return period, units[heads[1]] * acceleration
