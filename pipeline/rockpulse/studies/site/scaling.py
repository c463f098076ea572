"""Scaling of records to a target value of one of their measures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record

__all__ = ["MEASURE", "largest_impulse", "scale_factor", "scaled"]


def largest_impulse(record: Record, config: Config) -> float:
    """Largest half-wave impulse of a conditioned record [m/s], wherever in the record it is."""
    impulses = half_waves(record, **config.half_waves).impulse
    return float(np.max(np.abs(impulses), initial=0.0))


#: Measure of a conditioned record by the word of ``[calibration] scale_to``; all are proportional to the record.
MEASURE: dict[str, Callable[[Record, Config], float]] = {
    "pga": lambda record, config: record.pga,
    "pgv": lambda record, config: pgv(record),
    "impulse": largest_impulse,
}


def scale_factor(record: Record, config: Config) -> float:
    """Factor [-] that takes a conditioned record to the configured target; RecordRefused for a record of zeros.

    Examples
    --------
    >>> from rockpulse import CalibrationSettings
    >>> config = Config(calibration=CalibrationSettings(scale_to="pga", target=3.0))
    >>> scale_factor(Record([0.0, 1.5, 0.0], dt=0.01, id="a"), config)
    2.0
    """
    settings = config.calibration
    if settings.scale_to == "none" or settings.target is None:
        return 1.0
    measure = MEASURE[settings.scale_to](record, config)
    if not (math.isfinite(measure) and measure > 0.0):
        raise RecordRefused(f"{record.id}: its {settings.scale_to} is {measure:g}: it cannot be scaled to a target")
    return settings.target / measure


def scaled(record: Record, factor: float) -> Record:
    """A record times a positive factor [-], with a note of it."""
    if factor == 1.0:
        return record
    return replace(record, acceleration=factor * record.acceleration).with_note(f"scaled by {factor:.6g}")
