"""One record made ready for the models, and the models of the fidelity ladder that answer for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rockpulse.calibration import calibrate
from rockpulse.components import align, uncovered
from rockpulse.conditioning import condition
from rockpulse.config import Config
from rockpulse.errors import RecordRefused
from rockpulse.half_wave import HalfWaves, half_waves
from rockpulse.intensity import IntensePhase, intense_phase
from rockpulse.models.block import Block
from rockpulse.models.impulsive import impulsive_response
from rockpulse.models.main_sequence import resonance
from rockpulse.models.recorded import recorded_response
from rockpulse.models.response import Outcome, Reason, Response
from rockpulse.models.sequence import ImpulseSequence, sequence_response
from rockpulse.record import Record

__all__ = ["MODELS", "SLENDER_MODELS", "Scene", "prepare"]

#: Models whose motion between events is the linear one (Eqs. 1-2), stated for slenderness of at least 3.
SLENDER_MODELS = frozenset({"resonance", "sequence", "impulsive", "linear"})


@dataclass(frozen=True, eq=False)
class Scene:
    """A conditioned record with what was extracted from it.

    Attributes
    ----------
    record : Record
        Conditioned.
    vertical : (n,) ndarray or None
        Vertical ground acceleration on the record's samples [m/s2], for the nonlinear model.
    waves : HalfWaves
        All half-waves of the record.
    phase : IntensePhase
        The stretch that the sequence is calibrated on.
    sequence : ImpulseSequence or None
        None where the intense phase holds too few half-waves.
    config : Config
        The options of the models.
    """

    record: Record
    vertical: np.ndarray | None
    waves: HalfWaves
    phase: IntensePhase
    sequence: ImpulseSequence | None
    config: Config


def prepare(record: Record, config: Config, vertical: Record | None = None) -> Scene:
    """Condition a record, extract its half-waves and calibrate its sequence.

    Parameters
    ----------
    record : Record
        As read.
    config : Config
        Sections conditioning, half_waves, intense_phase and sequence are used.
    vertical : Record, optional
        The vertical channel that belongs to it, as read; it is conditioned in the same way.

    Raises
    ------
    RockpulseError
        Where the record cannot be conditioned or has no intense phase. Too few half-waves for a sequence are not an
        error: `sequence` is None and the record carries a warning.
    """
    conditioned = condition(record, **config.conditioning)
    lift = None
    if vertical is not None:
        up = condition(vertical, **config.conditioning)
        lift = align(up, conditioned)
        conditioned = conditioned.with_note(f"vertical acceleration: {up.id}")
        for warning in up.warnings:
            conditioned = conditioned.with_warning(f"vertical channel: {warning}")
        if (missing := uncovered(up, conditioned)) > up.dt:
            conditioned = conditioned.with_warning(f"vertical channel: taken as zero for {missing:.4g} s without it")
    waves = half_waves(conditioned, **config.half_waves)
    phase = intense_phase(conditioned, **config.intense_phase)
    try:
        sequence = calibrate(waves, phase=phase, **config.sequence)
    except RecordRefused as error:
        sequence = None
        conditioned = conditioned.with_warning(f"no impulse sequence: {error}")
    return Scene(conditioned, lift, waves, phase, sequence, config)


def _resonance(block: Block, scene: Scene) -> Response:
    if scene.sequence is None:
        return no_sequence(block)
    sequence = scene.sequence
    return resonance(block, sequence.main, sequence.main_count, duration=sequence.duration)


def _sequence(block: Block, scene: Scene) -> Response:
    return no_sequence(block) if scene.sequence is None else sequence_response(block, scene.sequence)


def _impulsive(block: Block, scene: Scene) -> Response:
    waves = scene.waves
    return impulsive_response(
        block, waves.centroid, waves.impulse, duration=scene.record.duration, gain=scene.config.models.gain
    )


def _linear(block: Block, scene: Scene) -> Response:
    record = scene.record
    return recorded_response(
        block, record.acceleration, record.dt, equation="linear", history=scene.config.models.histories
    )


def _nonlinear(block: Block, scene: Scene) -> Response:
    record = scene.record
    return recorded_response(
        block,
        record.acceleration,
        record.dt,
        equation="nonlinear",
        vertical=scene.vertical,
        history=scene.config.models.histories,
    )


#: The models an assessment can use, from the cheapest to the dearest.
MODELS: dict[str, Callable[[Block, Scene], Response]] = {
    "resonance": _resonance,
    "sequence": _sequence,
    "impulsive": _impulsive,
    "linear": _linear,
    "nonlinear": _nonlinear,
}


def no_sequence(block: Block) -> Response:
    """The answer of the sequence models where the record gave no sequence: UNRESOLVED, with that reason."""
    lanes = block.shape
    return Response(
        peak_rotation_ratio=np.full(lanes, np.nan),
        outcome=np.full(lanes, int(Outcome.UNRESOLVED), dtype=np.int8),
        reason=np.full(lanes, int(Reason.NO_SEQUENCE), dtype=np.int8),
        overturning_time=np.full(lanes, np.nan),
        overturning_half_cycle=np.full(lanes, -1),
        impacts=np.full(lanes, -1),
    )
