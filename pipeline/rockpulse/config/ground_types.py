"""The ground types of EN 1998-1 and NTC 2018, and the soil factor S."""

from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError

#: S, T_B, T_C, T_D [s] of the ground types of EN 1998-1: Tables 3.2 and 3.3.
EN_1998 = {
    "en_1998_1": {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.2, 0.6, 2.0),
        "D": (1.35, 0.2, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    "en_1998_2": {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.1, 0.25, 1.2),
        "D": (1.8, 0.1, 0.3, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}

#: Ground types of NTC 2018 (Table 3.2.IV): limits of S_S, the numbers c and d in S_S = c - d F_0 a_g/g,
#: and factor and power in C_C = factor (T_C*)^power.
NTC = {
    "A": ((1.0, 1.0, 1.0, 0.0), (1.0, 0.0)),
    "B": ((1.0, 1.2, 1.4, 0.4), (1.1, -0.2)),
    "C": ((1.0, 1.5, 1.7, 0.6), (1.05, -0.33)),
    "D": ((0.9, 1.8, 2.4, 1.5), (1.25, -0.5)),
    "E": ((1.0, 1.6, 2.0, 1.1), (1.15, -0.4)),
}

#: S_T of the topographic categories of NTC 2018 (Table 3.2.V), at the top of the slope.
TOPOGRAPHY = {"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4}


def soil_factor(check: CheckSettings, ag: float, ground: str) -> float:
    """Return the soil factor S by the code of [check] (NTC: S_S S_T) for a_g on rock [g]; ConfigError if unknown."""
    if check.spectrum in EN_1998:
        return EN_1998[check.spectrum][ground][0]
    if check.spectrum != "ntc":
        raise ConfigError(
            f'[site] ag: S of ground {ground} is not known with [check] spectrum = "{check.spectrum}"; remove ag, and '
            "state the PGA on the ground of the site in [[demand]]"
        )
    least, most, start, slope = NTC[ground][0]
    if slope > 0.0 and check.f0 is None:
        raise ConfigError(
            f"[site] ground: S of ground {ground} by NTC 2018 depends on F_0; give f0 and tc_star in [check], or "
            '[check] spectrum = "en_1998_1"'
        )
    return min(most, max(least, start - slope * (check.f0 or 0.0) * ag)) * TOPOGRAPHY[check.topography]
