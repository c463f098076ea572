"""One record made ready for the models."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.model_row import Scene
from rockpulse.model_table import MODELS, RULE_POINT
from rockpulse.record.components import align, uncovered
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import Record
from rockpulse.remark import Remark
from rockpulse.sequences.estimators import calibrate


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
        sequence = calibrate(waves, phase=phase, **config.sequence.statistics)
    except RecordRefused as error:
        sequence = None
        conditioned = conditioned.with_warning(Remark("no_sequence", reason=str(error)))
    rule = RULE_POINT if config.sequence.method == "rule" else ""
    return Scene(conditioned, lift, waves, phase, sequence, rule=rule, **solver_options(config))


def solver_options(config: Config) -> dict[str, Any]:
    """The options of a scene that the configuration has for all models."""
    models, search = config.models, config.search
    return {name: getattr(models, name) for name in ("gain", "histories")} | {
        name: getattr(search, name) for name in ("factor_max", "points", "step")
    }


def matched(scene: Scene, config: Config) -> Scene:
    """The scene with the sequence that its record is assessed by: with the method "response" one that is matched to it.

    A record that moves too few bodies for that has no sequence, and a warning that says so.
    """
    wanted = config.sequence.method == "response" and any(MODELS[name].paired for name in config.models.use)
    if not wanted or scene.sequence is None:
        return scene
    from rockpulse.sequences.response import calibrate_response  # a second, and rarely asked for

    try:
        found = calibrate_response(
            scene.record,
            vertical=scene.vertical,
            start=scene.sequence,
            spacing=config.sequence.spacing,
            seed=config.run.seed,
        )
    except RecordRefused as error:
        record = scene.record.with_warning(Remark("no_sequence", reason=str(error)))
        return replace(scene, record=record, sequence=None)
    record = scene.record
    for remark in found.remarks:
        record = record.with_note(remark)
    return replace(scene, record=record, sequence=found.sequence)
