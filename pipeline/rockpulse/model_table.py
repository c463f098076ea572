"""Table of models, one row per model, from the simplest to the full equation of motion.

A new model is added only here. The solvers are imported when a function is called.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import rocking
from rocking.response import Response
from rockpulse.model_row import Equation, Model, Scene, loaded_rule
from rockpulse.option import Section, boolean, choice, choices, count, number

#: Label of a model whose input is an upper bound.
UPPER_BOUND = "upper-bound input"


def _resonance(block: rocking.Block, scene: Scene) -> rocking.Response:
    one = scene.sequence
    if one is None:
        return Response.unresolved(block.shape, rocking.Reason.NO_SEQUENCE)
    return rocking.resonance(block, one.main, one.main_count, one.duration)


def _search_resonance(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    if scene.sequence is None:
        return rocking.ScaleIntervals.unknown(block.shape)
    return rocking.resonance_critical_scale(block, scene.sequence, scene.factor_max)


def _sequence(block: rocking.Block, scene: Scene) -> rocking.Response:
    if scene.rule:
        return _rule(block, scene, point=scene.rule)
    one = scene.sequence
    if one is None:
        return Response.unresolved(block.shape, rocking.Reason.NO_SEQUENCE)
    return rocking.sequence_response(block, one, paired=one.shape != ())


def _search_sequence(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    if scene.rule:
        return _search_rule(block, scene, point=scene.rule)
    one = scene.sequence
    if one is None:
        return rocking.ScaleIntervals.unknown(block.shape)
    return rocking.sequence_critical_scale(block, one, scene.factor_max, scene.step, paired=one.shape != ())


def _rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.Response:
    return rocking.sequence_response(block, loaded_rule(point).sequence(scene.waves, block), paired=True)


def _search_rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.ScaleIntervals:
    return loaded_rule(point).intervals(scene.waves, block, scene.factor_max)


def _impulsive(block: rocking.Block, scene: Scene, scale: Any = None) -> rocking.Response:
    return rocking.impulsive_response(
        block,
        scene.waves.centroid,
        scene.waves.impulse,
        duration=scene.record.duration,
        gain=scene.gain,
        scale=1.0 if scale is None else scale,
        history_dt=None if scale is None else scene.record.dt,
    )


def _search_impulsive(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    waves = scene.waves
    return rocking.impulsive_critical_scale(
        block, waves.centroid, waves.impulse, scene.gain, scene.factor_max, scene.points
    )


def _recorded(block: rocking.Block, scene: Scene, scale: Any = None, *, equation: Equation) -> rocking.Response:
    return rocking.recorded_response(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation=equation,
        vertical=MODELS[equation].vertical_of(scene),
        scale=1.0 if scale is None else scale,
        history=scene.histories if scale is None else True,
    )


def _search_recorded(block: rocking.Block, scene: Scene, *, equation: Equation) -> rocking.ScaleIntervals:
    return rocking.critical_scale(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation,
        vertical=MODELS[equation].vertical_of(scene),
        factor_max=scene.factor_max,
        points=scene.points,
    )


#: Models in the order of results, from the simplest: the verdict uses the last one that the results contain.
_ROWS = (
    Model(
        name="resonance",
        label=f"resonance ({UPPER_BOUND})",
        words=f"{UPPER_BOUND}, no prediction: the main impulse of the record arrives at the worst moment of every "
        "half-cycle (closed form). Overturning by this model only means that the body may be unsafe.",
        respond=_resonance,
        search=_search_resonance,
        look=("purple", (0, (1, 1.2)), "v"),
        takes="sequence",
        cycles="main",
        needs_end=True,
        knows=("wall",),
        upper_bound="every main impulse at the worst moment",
    ),
    Model(
        name="sequence",
        label="sequence",
        words="main impulses at the start of each half-cycle and smaller ones of alternating sign between them, from "
        "the half-waves of the record alone; between impulses the natural motion of the block. Its "
        "sequence is that of [sequence] method, by default of the conservative rule below for each record and body.",
        respond=_sequence,
        search=_search_sequence,
        look=("orange", (0, (6, 1.5, 1, 1.5)), "s"),
        takes="sequence",
        cycles="main and secondary",
        default=True,
        paired=True,
        grid="step",
        knows=("wall",),
    ),
    Model(
        name="balanced",
        label="balanced rule",
        words="an impulse sequence for each record and body by a rule that predicts the mean capacity by the nonlinear "
        "model under uncertainty: about even odds of overturning.",
        respond=partial(_rule, point="balanced"),
        search=partial(_search_rule, point="balanced"),
        look=("sky", (0, (3, 1, 1, 1, 1, 1)), "<"),
        takes="half-waves",
        fitted=True,
    ),
    Model(
        name="conservative",
        label="conservative rule",
        words="an impulse sequence for each record and body by a rule that predicts the scale factor at which the "
        "nonlinear model overturns with a probability of 10 %.",
        respond=partial(_rule, point="conservative"),
        search=partial(_search_rule, point="conservative"),
        look=("grey", (0, (8, 2)), ">"),
        takes="half-waves",
        fitted=True,
    ),
    Model(
        name="impulsive",
        label="impulsive",
        words="every half-wave of the record as an impulse at its centroid; between them the natural motion of the "
        "block. It has no threshold of uplift.",
        respond=_impulsive,
        search=_search_impulsive,
        look=("green", (0, (2, 1)), "^"),
        takes="half-waves",
        follows=True,
        grid="points",
    ),
    Model(
        name="linear",
        label="linear",
        words="the equation of motion for small rotations, under the accelerogram itself.",
        respond=partial(_recorded, equation="linear"),
        search=partial(_search_recorded, equation="linear"),
        look=("red", (0, (4, 1.2)), "D"),
        takes="accelerogram",
        equation="linear",
        knows=("corners", "wall"),
        follows=True,
        grid="points",
    ),
    Model(
        name="nonlinear",
        label="nonlinear",
        words="the full equation of motion under the accelerogram itself: θ″ = −p² [(1 + a_v/g) sin(±α_c − θ) + "
        "(a_g/g) cos(±α_c − θ)].",
        respond=partial(_recorded, equation="nonlinear"),
        search=partial(_search_recorded, equation="nonlinear"),
        look=("blue", "-", "o"),
        takes="accelerogram",
        equation="nonlinear",
        full=True,
        default=True,
        vertical=True,
        slender=False,
        knows=("corners", "wall", "restraints"),
        follows=True,
        grid="points",
    ),
)

#: All models by name, and their names.
MODELS = {row.name: row for row in _ROWS}
NAMES = tuple(MODELS)
#: Models used by default, and models used for the word "all".
DEFAULT_MODELS = tuple(row.name for row in _ROWS if row.default)
ALL_MODELS = tuple(row.name for row in _ROWS if not row.fitted)
#: Variant of the rule that models with `paired` use if `[sequence] method = "rule"`.
RULE_POINT = "conservative"
#: Models whose input is a sequence; the others need the accelerogram or its half-waves.
SEQUENCE_MODELS = tuple(row.name for row in _ROWS if row.takes == "sequence")
#: Models from the most complete to the simplest: models with a history, models that accept a scale factor, and
#: equations of motion under the accelerogram.
DRAWN = tuple(row.name for row in reversed(_ROWS) if row.follows or row.cycles)
FOLLOWING = tuple(row.name for row in reversed(_ROWS) if row.follows)
EQUATIONS = tuple(row.name for row in reversed(_ROWS) if row.equation)


def is_upper_bound(name: str) -> bool:
    """Return whether the input of a model is an upper bound; overturning then means that a body may be unsafe."""
    return name in MODELS and MODELS[name].upper_bound != ""


def is_full(name: str) -> bool:
    """Return whether a model is the full equation of motion."""
    return name in MODELS and MODELS[name].full


def fullest(names: Iterable[str]) -> str:
    """Return the name of the model that is closest to the full equation of motion; unknown names rank lowest."""
    return max(names, key=lambda name: NAMES.index(name) if name in MODELS else -1)


@dataclass(frozen=True)
class ModelSettings(Section):
    """The models in use, and their options.

    >>> rp.ModelSettings(use=["nonlinear", "liner"])
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [models] use: expected a list of one or more of "resonance"...
    """

    heading = "[models]"
    use: tuple[str, ...] = choices(DEFAULT_MODELS, NAMES)
    gain: str = choice(Scene.gain, ("paper", "linear", "exact"))
    histories: bool = boolean(False)


@dataclass(frozen=True)
class SearchSettings(Section):
    """The models for which scale factors of overturning are computed, and the grid of the search.

    >>> rp.SearchSettings(models=["linear"], intervals=True).asks_for("linear")
    True
    """

    heading = "[search]"
    models: tuple[str, ...] = choices(NAMES, NAMES, empty=True)
    intervals: bool = boolean(False)
    factor_max: float = number(Scene.factor_max, low=1.0, high=1e6)
    points: int = count(Scene.points, low=2, high=100_000)
    step: float = number(Scene.step, low=1.0001)

    def asks_for(self, model: str) -> bool:
        """Return whether scale factors of a model are requested; models that need many runs also need `intervals`."""
        return model in self.models and (self.intervals or not MODELS[model].searched)
