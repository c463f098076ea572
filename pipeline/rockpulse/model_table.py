"""Table of models, one row per model, from the simplest to the full equation of motion, and the input of a model.

A new model is added only here. The solvers are imported when a function is called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import rocking
from rocking.response import Response
from rockpulse.option import Section, boolean, choice, choices, count, number
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record

if TYPE_CHECKING:
    from rockpulse.sequences.rule import Rule

#: The equations of motion of :func:`rocking.recorded_response`.
Equation = Literal["linear", "nonlinear"]


@dataclass(frozen=True, eq=False)
class Scene:
    """The input of the models: a conditioned record, the quantities extracted from it, and the models' options."""

    record: Record
    vertical: np.ndarray | None  # (n,) vertical acceleration at the samples of the record [m/s2]
    waves: HalfWaves
    phase: IntensePhase  # phase on which the sequence is calibrated
    # None if the phase has too few half-waves; from a design spectrum one sequence per block, for paired models only
    sequence: rocking.ImpulseSequence | None
    gain: str = "paper"  # key of [models]
    histories: bool = False  # key of [models]
    factor_max: float = 10.0  # key of [search]
    points: int = 256  # key of [search]
    step: float = 1.005  # key of [search]
    rule: str = ""  # variant of the rule for paired models; empty if these use the sequence


@cache
def loaded_rule(point: str) -> Rule:
    """Return a variant of the rule by its name, "balanced" or "conservative"."""
    from rockpulse.sequences.rule import load_rule

    return load_rule(point)


@dataclass(frozen=True)
class Model:
    """A row of the table of models: functions, capabilities and descriptions of one model."""

    name: str
    #: Label in the legend of a picture, and description in a report.
    label: str
    words: str
    #: Functions of (m,) blocks and a scene: one returns the responses, the other the scale factors of overturning.
    respond: Callable[..., rocking.Response]
    search: Callable[[rocking.Block, Scene], rocking.ScaleIntervals]
    #: Style in pictures: colour of the palette, line style and marker of matplotlib.
    look: tuple[str, str | tuple[float, tuple[float, ...]], str]
    #: Input of the model: the calibrated sequence (with its own time axis), the half-waves, or the accelerogram.
    takes: Literal["sequence", "half-waves", "accelerogram"]
    #: Whether `respond` also accepts (q,) scale factors, and then returns the history for each.
    follows: bool = False
    #: Kind of impulses in the stored half-cycles, from which a rotation history is drawn; empty without half-cycles.
    cycles: Literal["", "main", "main and secondary"] = ""
    #: Equation of motion of :func:`rocking.recorded_response`; None for impulse models.
    equation: Equation | None = None
    #: Whether the model is the full equation of motion, which is the reference for other models and gives the
    #: probability of overturning.
    full: bool = False
    #: Whether the model is used by default.
    default: bool = False
    #: Whether the model uses the vertical acceleration.
    vertical: bool = False
    #: Whether the model is valid only for a slenderness of at least 3 (the linear motion of Eqs. 1-2).
    slender: bool = True
    #: Features of bodies that the model can treat, from :data:`rocking.body.block_lanes.FEATURES`.
    knows: tuple[str, ...] = ()
    #: Whether the model applies the variant of the rule that has the name of the model.
    fitted: bool = False
    #: Whether the model uses the sequence from `[sequence] method`, which may differ from body to body.
    paired: bool = False
    #: Whether the sequence must be finite, with a number of main impulses or a duration.
    needs_end: bool = False
    #: Key of [search] that sets how densely scale factors are scanned; empty for closed forms.
    grid: Literal["", "step", "points"] = ""
    #: Reason why the input is an upper bound, in which case overturning only means that a body may be unsafe; otherwise
    #: empty.
    upper_bound: str = ""

    @property
    def searched(self) -> bool:
        """Whether the scale factors need hundreds of runs, and are only computed with `[search] intervals`."""
        return self.grid == "points"

    def rule(self, scene: Scene) -> Rule | None:
        """Return the variant of the rule that the model uses for a scene; None if it uses no rule."""
        point = self.name if self.fitted else scene.rule if self.paired else ""
        return loaded_rule(point) if point else None

    def vertical_of(self, scene: Scene) -> np.ndarray | None:
        """Return the vertical acceleration of the scene; None if the model does not use it."""
        return scene.vertical if self.vertical else None

    def answers(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """Return whether the model can treat the features of each block, (m,)."""
        return np.asarray(block.known_to(() if self.rule(scene) else self.knows))

    def applicable(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """Return whether the model is valid for each block, (m,); a rule is valid only in the range of its fit."""
        within = self.answers(block, scene) & (np.asarray(block.slender) | (not self.slender))
        rule = self.rule(scene)
        return within if rule is None else within & rule.applicable(block).reshape(block.shape)

    def response(self, block: rocking.Block, scene: Scene) -> rocking.Response:
        """Return the response of (m,) blocks; the outcome is UNRESOLVED for features that the model cannot treat."""
        known = self.answers(block, scene)
        if np.all(known):
            return self.respond(block, scene)
        if not np.any(known):
            return Response.unresolved(block.shape, rocking.Reason.NOT_MODELLED)
        return self.respond(block.take(known), scene).among(known, rocking.Reason.NOT_MODELLED)

    def intervals(self, block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
        """Return the scale factors at which (m,) blocks overturn; NaN for blocks that the model cannot treat."""
        known = self.answers(block, scene)
        if not np.any(known):
            return rocking.ScaleIntervals.unknown(block.shape)
        return self.search(block if np.all(known) else block.take(known), scene).among(known)


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
