"""One record made ready for the models."""

from __future__ import annotations

from rockpulse.calibration.estimators import calibrate
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.ladder import Scene
from rockpulse.record.components import align, uncovered
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import Record
from rockpulse.remark import Remark

__all__ = ["extract", "prepare"]


def prepare(record: Record, config: Config, vertical: Record | None = None) -> Scene:
    """Condition a record as it was read, extract its half-waves and calibrate its sequence.

    The vertical channel that belongs to it, as read too, is conditioned in the same way. A RockpulseError where the
    record cannot be conditioned or has no intense phase. Too few half-waves for a sequence are not an error: the
    record carries a warning then.
    """
    up = None if vertical is None else condition(vertical, **config.conditioning)
    return extract(condition(record, **config.conditioning), config, up)


def extract(conditioned: Record, config: Config, up: Record | None = None) -> Scene:
    """The half-waves and the sequence of a record, it and its vertical channel conditioned; else as :func:`prepare`."""
    lift = None
    if up is not None:
        lift = align(up, conditioned)
        conditioned = conditioned.with_note(Remark("vertical_acceleration", record=up.id))
        for warning in up.warnings:
            conditioned = conditioned.with_warning(Remark("of_vertical", remark=warning))
        if (missing := uncovered(up, conditioned)) > up.dt:
            conditioned = conditioned.with_warning(Remark("vertical_short", missing=missing))
    waves = half_waves(conditioned, **config.half_waves)
    phase = intense_phase(conditioned, **config.intense_phase)
    try:
        sequence = calibrate(waves, phase=phase, **config.sequence)
    except RecordRefused as error:
        sequence = None
        conditioned = conditioned.with_warning(Remark("no_sequence", reason=str(error)))
    return Scene(conditioned, lift, waves, phase, sequence, config.models, config.search)
