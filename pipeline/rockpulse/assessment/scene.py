"""One record made ready for the models, and the models of the fidelity ladder that answer for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from rocking.block import Block
from rocking.fidelity import Rung, choose_response
from rocking.impulsive import impulsive_response
from rocking.main_sequence import resonance
from rocking.recorded import recorded_response
from rocking.response import Outcome, Reason, Response
from rocking.sequence import ImpulseSequence, sequence_response
from rockpulse.calibration.estimators import calibrate
from rockpulse.calibration.rule import load_rule, rule_sequence
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.record.components import align, uncovered
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.intensity import IntensePhase, intense_phase
from rockpulse.record.record import Record
from rockpulse.remark import Remark

__all__ = ["CHECKABLE", "MODELS", "SLENDER_MODELS", "USED", "Scene", "auto_response", "extract", "prepare"]

#: Models whose motion between events is the linear one (Eqs. 1-2), stated for slenderness of at least 3.
SLENDER_MODELS = frozenset({"resonance", "sequence", "balanced", "conservative", "impulsive", "linear"})


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
    return extract(condition(record, **config.conditioning), config, vertical)


def extract(conditioned: Record, config: Config, vertical: Record | None = None) -> Scene:
    """The half-waves and the sequence of a conditioned record.

    Parameters
    ----------
    conditioned : Record
        Conditioned already; it stays as it is.
    config, vertical
        As in :func:`prepare`.

    Raises
    ------
    RockpulseError
        As in :func:`prepare`.
    """
    lift = None
    if vertical is not None:
        up = condition(vertical, **config.conditioning)
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
    return Scene(conditioned, lift, waves, phase, sequence, config)


def _resonance(block: Block, scene: Scene) -> Response:
    if scene.sequence is None:
        return no_sequence(block)
    sequence = scene.sequence
    return resonance(block, sequence.main, sequence.main_count, duration=sequence.duration)


def _sequence(block: Block, scene: Scene) -> Response:
    return no_sequence(block) if scene.sequence is None else sequence_response(block, scene.sequence)


def _rule(block: Block, scene: Scene, *, point: str) -> Response:
    return sequence_response(block, rule_sequence(scene.waves, block, load_rule(point)), paired=True)


def _impulsive(block: Block, scene: Scene, scale: Any = 1.0) -> Response:
    waves = scene.waves
    return impulsive_response(
        block, waves.centroid, waves.impulse, duration=scene.record.duration, gain=scene.config.models.gain, scale=scale
    )


def _recorded(block: Block, scene: Scene, scale: Any = None, *, equation: Literal["linear", "nonlinear"]) -> Response:
    """With a factor, which a check asks for, the histories are left out."""
    record = scene.record
    return recorded_response(
        block,
        record.acceleration,
        record.dt,
        equation=equation,
        vertical=scene.vertical if equation == "nonlinear" else None,
        scale=1.0 if scale is None else scale,
        history=scene.config.models.histories and scale is None,
    )


_linear, _nonlinear = partial(_recorded, equation="linear"), partial(_recorded, equation="nonlinear")


def auto_response(block: Block, scene: Scene, scale: Any = 1.0) -> tuple[Response, np.ndarray]:
    """The cheapest model that answers, lane by lane, and which it was.

    Parameters
    ----------
    block : Block
        (m,) lanes.
    scene : Scene
        The record made ready; its configuration says which output has to be right, and to which tolerance.
    scale : float or (q,) array_like
        Factor on the record [-].

    Returns
    -------
    Response, (q, m) or (m,) ndarray of int
        The answer and the place of its model in :data:`USED`.
    """
    record, settings = scene.record, scene.config.models
    response, rungs = choose_response(
        block,
        record.acceleration,
        record.dt,
        scene.waves.centroid,
        scene.waves.impulse,
        scale=scale,
        vertical=scene.vertical,
        output=settings.output,
        tolerance=settings.tolerance,
    )
    return response, np.array([USED.index(rung.name.lower()) for rung in Rung], dtype=np.int8)[rungs]


def _auto(block: Block, scene: Scene, scale: Any = 1.0) -> Response:
    return auto_response(block, scene, scale)[0]


#: The models an assessment can use, from the cheapest to the dearest.
MODELS: dict[str, Callable[[Block, Scene], Response]] = {
    "resonance": _resonance,
    "sequence": _sequence,
    "balanced": partial(_rule, point="balanced"),
    "conservative": partial(_rule, point="conservative"),
    "impulsive": _impulsive,
    "linear": _linear,
    "nonlinear": _nonlinear,
}

#: What may have given an answer: the models, and what only `auto` knows.
USED = (*MODELS, "static", "settled")

#: Models whose answers can be checked for predictability; they take a factor on the record.
CHECKABLE: dict[str, Callable[[Block, Scene, Any], Response]] = {
    "impulsive": _impulsive,
    "linear": _linear,
    "nonlinear": _nonlinear,
    "auto": _auto,
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
