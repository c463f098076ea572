"""What the writers share: test motions and rows of fields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

#: What a format sample says of itself in a free text of its header, cut where the field is shorter.
NOTE = "FORMAT SAMPLE WRITTEN BY ROCKPULSE FROM CI.CLC"


def pulse(count: int = 400, peak: float = 0.3, dt: float = 0.01) -> np.ndarray:
    """(count,) A decaying 2 Hz sine with the given largest absolute value, in whatever unit the caller means."""
    time = dt * np.arange(count)
    wave = np.exp(-time) * np.sin(4.0 * np.pi * time)
    return peak * wave / np.max(np.abs(wave))


def rows(fields: Sequence[str], per_row: int) -> list[str]:
    return ["".join(fields[start : start + per_row]) for start in range(0, len(fields), per_row)]
