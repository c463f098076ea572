"""What the header of a COSMOS channel states of length and time of the peak, held against its series."""

from __future__ import annotations

import re

import numpy as np

from rockpulse.readers.cosmos_header import Header
from rockpulse.readers.held import held_length, held_peak_time

__all__ = ["held_series"]

_PEAK_TIME = re.compile(r"\bmax\s*=.{0,60}?\bat\s+(\d{0,6}\.\d{0,6})\s*sec", re.ASCII | re.IGNORECASE)
_RAW_LENGTH = re.compile(r"\s*raw record length\s*=\s*(\d{0,6}\.\d{0,6})\s*sec", re.ASCII | re.IGNORECASE)
_ABOUT = re.compile(r".{0,80}?\bapprox\.?\s+(\d{1,6}(?:\.\d{0,6})?)\s*secs?\b", re.ASCII | re.IGNORECASE)
#: A stated length may be off by this share.
_LENGTH_SHARE = 5e-3


def held_series(header: Header, heading: str, step: float, samples: np.ndarray) -> list[str]:
    """Warnings where the heading of the series, the text or real 65 contradicts samples (n,) at a step [s].

    The length of the raw record, and the peak in the line that states it, are held against raw records only.
    """
    raw = not header.kind.lower().startswith("corrected")
    spare = _LENGTH_SHARE * step * samples.size
    about, length = _ABOUT.match(heading[:200]), _RAW_LENGTH.match(header.text[9]) if raw else None
    notes = held_length(about[1], samples.size, step, spare) if about else []
    notes += held_length(length[1], samples.size, step, spare) if length else []
    lines = header.text[9:11] if raw else header.text[10:11]
    stated = [match[1] for line in lines if (match := _PEAK_TIME.search(line))]
    if not np.isnan(header.real(65)):
        stated.append(f"{header.real(65):.6f}")
    times = step * np.arange(samples.size)
    return list(dict.fromkeys([*notes, *(note for text in stated for note in held_peak_time(text, times, samples))]))
