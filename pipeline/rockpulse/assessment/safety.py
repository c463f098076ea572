"""Critical scales of a scene: how much stronger the input of each model may get before a body overturns."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from rocking.block import Block
from rocking.capacity import critical_scale, impulsive_critical_scale
from rocking.scale_search import ScaleIntervals
from rocking.sequence_safety import resonance_critical_scale, sequence_critical_scale
from rockpulse.assessment.scene import Scene
from rockpulse.calibration.rule import load_rule, rule_safety_factor

__all__ = ["critical_scales"]


def _resonance(block: Block, scene: Scene) -> ScaleIntervals:
    if scene.sequence is None:
        return _not_searched(block)
    return resonance_critical_scale(block, scene.sequence, scene.config.search.factor_max)


def _sequence(block: Block, scene: Scene) -> ScaleIntervals:
    search = scene.config.search
    if scene.sequence is None:
        return _not_searched(block)
    return sequence_critical_scale(block, scene.sequence, search.factor_max, search.step)


def _impulsive(block: Block, scene: Scene) -> ScaleIntervals:
    waves, search = scene.waves, scene.config.search
    gain = scene.config.models.gain
    return impulsive_critical_scale(block, waves.centroid, waves.impulse, gain, search.factor_max, search.points)


def _linear(block: Block, scene: Scene) -> ScaleIntervals:
    record, search = scene.record, scene.config.search
    return critical_scale(
        block, record.acceleration, record.dt, "linear", factor_max=search.factor_max, points=search.points
    )


def _nonlinear(block: Block, scene: Scene) -> ScaleIntervals:
    record, search = scene.record, scene.config.search
    return critical_scale(
        block,
        record.acceleration,
        record.dt,
        vertical=scene.vertical,
        factor_max=search.factor_max,
        points=search.points,
    )


def _rule(block: Block, scene: Scene, *, point: str) -> ScaleIntervals:
    """In closed form: the rule's demand is proportional to the factor, so every larger one overturns as well."""
    factor, end = rule_safety_factor(scene.waves, block, load_rule(point)), scene.config.search.factor_max
    lane = np.flatnonzero(factor <= end)
    return ScaleIntervals(
        safety_factor=np.where(factor <= end, factor, np.inf),
        safe_up_to=np.minimum(factor, end),
        lane=lane,
        lower=factor[lane],
        upper=np.full(lane.size, end),
        open=np.ones(lane.size, dtype=bool),
        step=np.ones(factor.size),
        resolved=np.ones(lane.size, dtype=bool),
    )


SEARCHES: dict[str, Callable[[Block, Scene], ScaleIntervals]] = {
    "resonance": _resonance,
    "sequence": _sequence,
    "balanced": partial(_rule, point="balanced"),
    "conservative": partial(_rule, point="conservative"),
    "impulsive": _impulsive,
    "linear": _linear,
    "nonlinear": _nonlinear,
}


def critical_scales(block: Block, scene: Scene) -> dict[str, ScaleIntervals]:
    """Factors on the input of every model at which each block overturns.

    Parameters
    ----------
    block : Block
        (m,) lanes.
    scene : Scene
        The record made ready; the section search of its configuration says which models are searched, and how.

    Returns
    -------
    dict of str to ScaleIntervals
        By answering model, of (m,) lanes: NaN and no interval where nothing was computed. `auto` has those of the
        nonlinear model, whose outcomes are its own. A model that cannot answer for the input as it is keeps what the
        search has found: a lower bound, where it stops answering.
    """
    searched = scene.config.search.models
    found: dict[str, ScaleIntervals] = {}
    for model in scene.config.models.answering:
        equation = "nonlinear" if model == "auto" else model
        if model == "auto" and "nonlinear" in found:
            found[model] = found["nonlinear"]
        else:
            found[model] = SEARCHES[equation](block, scene) if equation in searched else _not_searched(block)
    return found


def _not_searched(block: Block) -> ScaleIntervals:
    unknown, none = np.full(block.shape, np.nan), np.empty(0)
    no_flag = np.empty(0, dtype=bool)
    return ScaleIntervals(unknown, unknown, np.empty(0, dtype=np.int64), none, none, no_flag, unknown, no_flag)
