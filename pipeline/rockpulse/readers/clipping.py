"""Clipping: whether a recorder stayed at the end of its range."""

from __future__ import annotations

import numpy as np

from rockpulse.remark import Remark

__all__ = ["clipping_warning"]

#: Equal samples in a row at the extreme that are taken for the end of a range.
RUN = 5
#: The extreme lies this many of the smallest steps from the middle of the trace, or rounding makes equal samples.
STEPS_TO_EXTREME = 100
#: Half a run beyond the run, the trace is this many of the smallest steps away. A smooth crest that rounding made flat
#: is a parabola that has fallen by about 4 there.
STEPS_BESIDE = 10
#: Counts at which a 24-bit recorder ends, and the share of them from which a peak is reported: a recorder driven beyond
#: its range need not stay at one value, and some fold over.
FULL_SCALE, NEAR_FULL_SCALE = 2**23, 0.99


def _longest_run(at: np.ndarray) -> tuple[int, int]:
    """First index and length of the longest run of consecutive indices."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(at) != 1) + 1])
    lengths = np.diff(np.append(starts, at.size))
    longest = int(np.argmax(lengths))
    return int(at[starts[longest]]), int(lengths[longest])


def clipping_warning(samples: np.ndarray, unit: str = "counts") -> list[Remark]:
    """A warning where a raw record stays at its largest or smallest value, or reaches the end of 24 bits.

    The samples are those before any filter. Only values in the unit "counts" are compared with the range of a recorder.

    Examples
    --------
    >>> wave = np.round(1000.0 * np.sin(0.2 * np.arange(100)))
    >>> clipping_warning(wave, 'g')
    []
    >>> clipping_warning(np.minimum(wave, 700.0), 'g')
    ['8 samples in a row at the largest value: the record may be clipped']
    """
    warnings: list[Remark] = []
    step = None
    for end, edge in (("largest", np.max(samples)), ("smallest", np.min(samples))):
        at = np.flatnonzero(samples == edge)
        if not RUN <= at.size < samples.size:
            continue
        first, length = _longest_run(at)
        if length < RUN:
            continue
        step = float(np.min(np.diff(np.unique(samples)))) if step is None else step
        # Where the recorder begins or ends within the run, the other side has to tell.
        beside = samples[[max(first - 1 - length // 2, 0), min(first + length + length // 2, samples.size - 1)]]
        away = 0.5 * float(np.ptp(samples))
        fall = float(np.max(np.abs(edge - beside.astype(float))))
        if away >= STEPS_TO_EXTREME * step and fall >= STEPS_BESIDE * step:
            warnings.append(Remark("clipped", count=length, end=end))
    peak = float(np.max(np.abs(samples.astype(float))))
    if unit == "counts" and NEAR_FULL_SCALE * FULL_SCALE <= peak <= FULL_SCALE:
        warnings.append(Remark("full_scale", counts=FULL_SCALE))
    return warnings
