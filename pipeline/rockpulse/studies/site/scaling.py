"""Scaling of records to a target value of one of their measures."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.record.half_wave import half_waves
from rockpulse.record.measures import MEASURES, RecordOnBodies
from rockpulse.record.record import Record

__all__ = ["measured", "scale_factor", "scaled"]


def measured(name: str, record: Record, config: Config) -> float:
    """A measure of a conditioned record."""
    return float(MEASURES[name].value(RecordOnBodies(record, partial(half_waves, record, **config.half_waves))))


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
    measure = measured(settings.scale_to, record, config)
    if not (math.isfinite(measure) and measure > 0.0):
        raise RecordRefused(f"{record.id}: its {settings.scale_to} is {measure:g}: it cannot be scaled to a target")
    return settings.target / measure


def scaled(record: Record, factor: float) -> Record:
    """A record times a positive factor [-], with a note of it."""
    if factor == 1.0:
        return record
    return replace(record, acceleration=factor * record.acceleration).with_note(f"scaled by {factor:.6g}")
