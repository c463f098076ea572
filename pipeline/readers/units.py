"""Units of acceleration that a file may use: the one table of them."""

from __future__ import annotations

import re

from rockpulse.errors import UnitError
from rockpulse.record import STANDARD_GRAVITY

__all__ = ["UNITS", "canonical_unit", "other_readings"]

#: Acceleration in m/s2 = value in the file x factor.
UNITS: dict[str, float] = {
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "gal": 0.01,
    "mm/s2": 0.001,
    "g": STANDARD_GRAVITY,
    "g/10": STANDARD_GRAVITY / 10.0,
}

_RAISED = str.maketrans("⁻²", "-2")
_CREDIBLE_PGA_G = (1e-3, 3.0)


def canonical_unit(text: str, where: str) -> str:
    """The key of `UNITS` that a spelling means.

    Parameters
    ----------
    text : str
        Unit as written: case, blanks, a final dot, ``^``, ``**``, ``sec``, ``/s/s``, ``s-2`` and a raised 2 make no
        difference.
    where : str
        ``file:line`` or the name of the option, for the message.

    Raises
    ------
    UnitError
        If it is none of the accepted ones.

    Examples
    --------
    >>> canonical_unit("CM/SEC/SEC", "example.V2:46")
    'cm/s2'
    """
    unit = re.sub(r"[\s^*]|\.$", "", text.strip().lower().translate(_RAISED))
    unit = re.sub(r"sec(ond)?s?", "s", unit)
    unit = re.sub(r"/s/s$|[.·]?s-2$", "/s2", unit)
    unit = {"gals": "gal", "(g)": "g"}.get(unit, unit)
    if unit not in UNITS:
        raise UnitError(f"{where}: unknown unit of acceleration {text!r}; expected one of {', '.join(UNITS)}")
    return unit


def other_readings(peak: float) -> str:
    """The units, in words, in which a peak in file units would be an ordinary acceleration.

    Parameters
    ----------
    peak : float
        Largest absolute value as the file holds it [file unit].
    """
    low, high = _CREDIBLE_PGA_G
    readings = {unit: peak * factor / STANDARD_GRAVITY for unit, factor in UNITS.items() if unit != "gal"}
    fitting = [f"{value:.3g} g if it were {unit}" for unit, value in readings.items() if low <= value <= high]
    return " or ".join(fitting) if fitting else "not an ordinary acceleration in any unit that is read"
