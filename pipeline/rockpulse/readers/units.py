"""Units of acceleration that a file may use: the one table of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from difflib import get_close_matches

from rockpulse.errors import UnitError
from rockpulse.record.record import STANDARD_GRAVITY

__all__ = ["UNITS", "canonical_unit", "for_other_files", "mentioned_units", "other_readings", "quantity_of"]

#: Acceleration in m/s2 = value in the file x factor.
UNITS: dict[str, float] = {
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "gal": 0.01,
    "mm/s2": 0.001,
    "g": STANDARD_GRAVITY,
    "g/10": STANDARD_GRAVITY / 10.0,
}

_RAISED = str.maketrans("⁻²¹", "-21")
_SECOND = r"s(?:ec(?:ond)?s?)?"
#: Units of acceleration and velocity that are known wherever they stand; ``g`` and ``cm`` need a bracket.
_MENTIONED = re.compile(
    rf"(?<![a-z0-9])(?:(?:mm|cm|m)[ .·*]?{_SECOND}(?:\^|\*\*)?\(?-(?:(?P<squared>2)|1)\)?|"
    rf"(?:mm|cm|m)(?:/|p| per |/per/){_SECOND}(?P<again>[ /]?(?:\^|\*\*)?2| ?squared|[ /]{_SECOND})?|"
    rf"(?P<other>gals?|milli-?g|%g|(?:in|ft)/{_SECOND}(?:(?:\^|\*\*)?2|/{_SECOND}))|kines?)(?![a-z0-9])"
)
#: Spellings, as `_squeezed` leaves them, of the units that may head a column that is no acceleration.
_QUANTITIES = {
    "time": "s ms us µs min seg segundos sek sekunden secondi secondes sn saniye millis minutes minuten minuti",
    "velocity": "m/s cm/s mm/s in/s ft/s ms-1 cms-1 mms-1 m.s-1 cm.s-1 kine kines",
    "displacement": "m cm mm in ft",
    "frequency": "hz khz",
    # Not read, so that canonical_unit refuses them.
    "acceleration": "mg millig milli-g %g ft/s2 in/s2 ft/s/s in/s/s mgal count counts volt volts",
}
_QUANTITY = {spelling: quantity for quantity, spellings in _QUANTITIES.items() for spelling in spellings.split()}
_CREDIBLE_PGA_G = (1e-3, 3.0)


def canonical_unit(text: str, where: str) -> str:
    """The key of `UNITS` that a spelling means; UnitError, with `where` (``file:line`` or an option), if there is none.

    Case, blanks, a final dot, ``^``, ``**``, ``sec``, ``/s/s``, ``s-2`` and a raised 2 make no difference.

    Examples
    --------
    >>> canonical_unit("CM/SEC/SEC", "example.V2:46")
    'cm/s2'
    """
    unit = _accepted(text)
    if unit not in UNITS:
        quantity = quantity_of(text)
        of = f" ({quantity})" if quantity else ""
        advice = "" if where.startswith("option") else "; correct the file, or write columns and give their unit"
        near = "".join(f'; did you mean "{close}"?' for close in get_close_matches(unit, UNITS, n=1))
        raise UnitError(
            f"{where}: unknown unit of acceleration {text[:40]!r}{of}{near}; expected one of {', '.join(UNITS)}{advice}"
        )
    return unit


def for_other_files(option: str) -> str:
    """The advice where an option of the command line contradicts a statement in a file.

    Examples
    --------
    >>> for_other_files("--dt 0.01")[:57]
    'correct the wrong one; or, if --dt 0.01 is meant for othe'
    """
    return (
        f"correct the wrong one; or, if {option} is meant for other files, read these in a run of their own, or "
        f"convert them first, so that they state it (rockpulse convert FILE {option} -o FILE.csv)"
    )


def _squeezed(text: str) -> str:
    unit = re.sub(r"[\s^*]|\.$", "", text.strip().lower().translate(_RAISED))
    return re.sub(r"se[cg](?:ond|undo)?s?|(?<=/)sn", "s", unit)


def _accepted(text: str) -> str:
    unit = re.sub(r"(?:/s/s|[.·]?s-2|/?per/?s2|ps2|(?<=m)/s/2|/s?squared)$", "/s2", _squeezed(text).replace("_", "/"))
    return {"gals": "gal", "(g)": "g"}.get(unit, unit)


def quantity_of(text: str) -> str:
    """The quantity that a unit alone measures; empty where the text is no unit.

    One of "acceleration", "velocity", "displacement", "time", "frequency".

    Examples
    --------
    >>> quantity_of("cm/sec"), quantity_of("Gal"), quantity_of("east")
    ('velocity', 'acceleration', '')
    """
    return "acceleration" if _accepted(text) in UNITS else _QUANTITY.get(_squeezed(text), "")


def mentioned_units(text: str) -> Iterator[tuple[str, str, int]]:
    """Units of acceleration and velocity in running text, such as ``acc_cm_s2`` or ``acceleration in gal``.

    Yields "acceleration" or "velocity", the unit as written, and the index where it begins.
    """
    for match in _MENTIONED.finditer(text.lower().translate(_RAISED).replace("_", "/")):
        squared = match["again"] or match["squared"] or match["other"]
        wording = text[match.start() : match.end()] if text.isascii() else match[0]
        yield "acceleration" if squared else "velocity", wording, match.start()


def other_readings(peak: float, unit: str = "") -> str:
    """The units, in words, in which a peak in file units would be an ordinary acceleration, else the nearest to it.

    The file unit itself is left out.
    """
    low, high = _CREDIBLE_PGA_G
    own = UNITS.get(unit)
    others = {name: factor for name, factor in UNITS.items() if name != "gal" and factor != own}
    readings = {name: peak * factor / STANDARD_GRAVITY for name, factor in others.items()}
    fitting = [f"{value:.3g} g if it were {name}" for name, value in readings.items() if low <= value <= high]
    if fitting:
        return " or ".join(fitting)
    nearest = (max if max(readings.values()) < low else min)(readings, key=lambda name: readings[name])
    return f"{readings[nearest]:.3g} g if it were {nearest}, no ordinary acceleration either"
