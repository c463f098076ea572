"""Common parts of the writers: test motions and rows of fields."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rockpulse.readers.kit.direction import direction

#: What a format sample says of itself in a free text of its header, cut where the field is shorter. The headers have
#: the earthquake as in the catalogue of the USGS (ci38457511): 2019-07-06 03:19:53.04 UTC, 35.770 N 117.599 W,
#: 8.0 km deep, Mw 7.1; the station CLC stands at 35.81574 N 117.59751 W.
NOTE = "FORMAT SAMPLE WRITTEN BY ROCKPULSE FROM CI.CLC"

FORMATS = Path(__file__).parents[2] / "data" / "samples" / "formats"


def shipped(name: str) -> bytes:
    """The content of a format sample as it is committed: the header that others have, too."""
    return (FORMATS / name).read_bytes()


def pulse(count: int = 400, peak: float = 0.3, dt: float = 0.01) -> np.ndarray:
    """(count,) A decaying 2 Hz sine with the given largest absolute value, in whatever unit the caller means."""
    time = dt * np.arange(count)
    wave = np.exp(-time) * np.sin(4.0 * np.pi * time)
    return peak * wave / np.max(np.abs(wave))


def peak_time(values: Sequence[float], dt: float = 1.0) -> float:
    """Time of the largest absolute value [s]; 0 of no values."""
    return dt * int(np.argmax(np.abs(values))) if len(values) else 0.0


def azimuth_code(component: str) -> int:
    """Integer 27 of the headers of CSMIP and USC: the azimuth, 500 for up, 600 for down, 0 where it is unknown."""
    facing = direction(component)
    if facing.orientation == "vertical":
        return 500 if facing.sign > 0.0 else 600
    return 0 if np.isnan(facing.azimuth) else round(facing.azimuth) or 360


def rows(fields: Sequence[str], per_row: int) -> list[str]:
    return ["".join(fields[start : start + per_row]) for start in range(0, len(fields), per_row)]
