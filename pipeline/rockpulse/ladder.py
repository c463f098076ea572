"""The ladder of models, from the cheapest to the dearest: one row a model, with all that the program knows of it.

A model is added here and nowhere else: its functions, and a row of :data:`MODELS` that names them. The solvers are
loaded when a function is called, for the configuration takes the names of the models from here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import rocking
from rocking.response import spread, unresolved
from rockpulse.option import Section, boolean, choice, choices, count, number
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record

if TYPE_CHECKING:
    from rockpulse.sequences.rule import Rule

__all__ = [
    "ALL_MODELS",
    "DEFAULT_MODELS",
    "MODELS",
    "NAMES",
    "SEQUENCE_MODELS",
    "UPPER_BOUND",
    "USED",
    "Model",
    "ModelSettings",
    "Scene",
    "SearchSettings",
    "auto_response",
    "critical_scales",
    "is_upper_bound",
]

#: What a model with an upper bound for its input is called, wherever it is shown.
UPPER_BOUND = "upper-bound type input"


def _no_sequence(block: rocking.Block) -> rocking.Response:
    return unresolved(block.shape, rocking.Reason.NO_SEQUENCE)


def _not_searched(block: rocking.Block) -> rocking.ScaleIntervals:
    return rocking.ScaleIntervals.unknown(block.shape)


def _resonance(block: rocking.Block, scene: Scene) -> rocking.Response:
    one = scene.sequence
    return _no_sequence(block) if one is None else rocking.resonance(block, one.main, one.main_count, one.duration)


def _search_resonance(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    one, most = scene.sequence, scene.search.factor_max
    return _not_searched(block) if one is None else rocking.resonance_critical_scale(block, one, most)


def _sequence(block: rocking.Block, scene: Scene) -> rocking.Response:
    one = scene.sequence
    if scene.rule:
        return _rule(block, scene, point=scene.rule)
    return _no_sequence(block) if one is None else rocking.sequence_response(block, one, paired=one.shape != ())


def _search_sequence(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    one, search = scene.sequence, scene.search
    if scene.rule:
        return _search_rule(block, scene, point=scene.rule)
    if one is None:
        return _not_searched(block)
    return rocking.sequence_critical_scale(block, one, search.factor_max, search.step, paired=one.shape != ())


def _rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.Response:
    return rocking.sequence_response(block, _loaded(point).sequence(scene.waves, block), paired=True)


def _search_rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.ScaleIntervals:
    return _loaded(point).intervals(scene.waves, block, scene.search.factor_max)


def _loaded(point: str) -> Rule:
    from rockpulse.sequences.rule import load_rule

    return load_rule(point)


def _impulsive(block: rocking.Block, scene: Scene, scale: Any = 1.0) -> rocking.Response:
    waves, gain = scene.waves, scene.models.gain
    return rocking.impulsive_response(
        block, waves.centroid, waves.impulse, duration=scene.record.duration, gain=gain, scale=scale
    )


def _search_impulsive(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    waves, search = scene.waves, scene.search
    return rocking.impulsive_critical_scale(
        block, waves.centroid, waves.impulse, scene.models.gain, search.factor_max, search.points
    )


def _recorded(
    block: rocking.Block, scene: Scene, scale: Any = None, *, equation: Literal["linear", "nonlinear"]
) -> rocking.Response:
    return rocking.recorded_response(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation=equation,
        vertical=scene.vertical if equation == "nonlinear" else None,
        scale=1.0 if scale is None else scale,
        history=scene.models.histories and scale is None,
    )


def _search_recorded(
    block: rocking.Block, scene: Scene, *, equation: Literal["linear", "nonlinear"]
) -> rocking.ScaleIntervals:
    return rocking.critical_scale(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation,
        vertical=scene.vertical if equation == "nonlinear" else None,
        factor_max=scene.search.factor_max,
        points=scene.search.points,
    )


def auto_response(block: rocking.Block, scene: Scene, scale: Any = 1.0) -> tuple[rocking.Response, np.ndarray]:
    """The cheapest model that answers (m,) or (q, m) lanes, and which it was, as its place in :data:`USED`."""
    record, settings = scene.record, scene.models
    response, rungs = rocking.choose_response(
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
    return response, np.array([USED.index(rung.name.lower()) for rung in rocking.Rung], dtype=np.int8)[rungs]


def _auto(block: rocking.Block, scene: Scene, scale: Any = 1.0) -> rocking.Response:
    return auto_response(block, scene, scale)[0]


@dataclass(frozen=True)
class Model:
    """A row of the table of models."""

    name: str
    #: What the legend of a picture calls it, and what a report says of it.
    label: str
    words: str
    #: From (m,) blocks and a record made ready to the answers, and to the factors at which they overturn.
    respond: Callable[..., rocking.Response]
    search: Callable[[rocking.Block, Scene], rocking.ScaleIntervals]
    #: How it is drawn: a colour of the palette of the pictures, a line and a marker as matplotlib takes them.
    look: tuple[str, str | tuple[float, tuple[float, ...]], str]
    #: Whether it is stated for slender blocks only, a slenderness of at least 3 (the linear motion of Eqs. 1-2).
    slender: bool = True
    #: Whether it is the working point of that name of the rule.
    fitted: bool = False
    #: Whether its input is the calibrated sequence, with a time of its own and without any record; else the record.
    of_sequence: bool = False
    #: Whether `respond` takes factors on the record as well, with which predictability is checked.
    checkable: bool = False
    #: Whether its factors are searched for by hundreds of runs, which `[search] intervals` asks for; those of the other
    #: models cost as good as nothing and are always told.
    searched: bool = False
    #: What it knows of bodies beside free-standing symmetric ones, as :meth:`rocking.Block.known_to` has it.
    knows: str = ""
    #: How its input is an upper bound, so that its overturning says no more than that a body may be unsafe.
    upper_bound: str = ""

    def rule(self, scene: Scene) -> Rule | None:
        """The working point of the rule by which the model answers; None where it does not."""
        point = self.name if self.fitted else scene.rule if self.name == "sequence" else ""
        return _loaded(point) if point else None

    def answers(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """True for those of (m,) blocks of which the model knows everything that they have."""
        return np.asarray(block.known_to("" if self.rule(scene) else self.knows))

    def applicable(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """True for those of (m,) blocks that lie in the range of the model; a rule holds for those like its fit's."""
        within = self.answers(block, scene) & (np.asarray(block.slender) | (not self.slender))
        rule = self.rule(scene)
        return within if rule is None else within & rule.applicable(block).reshape(block.shape)

    def response(self, block: rocking.Block, scene: Scene, scale: Any = None) -> rocking.Response:
        """The answer for (m,) blocks; UNRESOLVED for those of which the model does not know everything."""
        more = {} if scale is None else {"scale": scale}
        known = self.answers(block, scene)
        if np.all(known):
            return self.respond(block, scene, **more)
        if not np.any(known):
            return unresolved((*np.shape(scale), *block.shape), rocking.Reason.NOT_MODELLED)
        return spread(self.respond(block.chosen(known), scene, **more), known, rocking.Reason.NOT_MODELLED)

    def intervals(self, block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
        """The factors at which (m,) blocks overturn; NaN for those of which the model does not know everything."""
        known = self.answers(block, scene)
        if not np.any(known):
            return _not_searched(block)
        return self.search(block if np.all(known) else block.chosen(known), scene).among(known)


_ROWS = (
    Model(
        name="resonance",
        label=f"resonance ({UPPER_BOUND})",
        words=f"{UPPER_BOUND}, no prediction: the main impulse of the record arrives at the worst moment of every "
        "half-cycle (closed form). Its overturning says that the body may be unsafe, nothing more.",
        respond=_resonance,
        search=_search_resonance,
        look=("purple", (0, (1, 1.2)), "v"),
        of_sequence=True,
        knows="wall",
        upper_bound="every main impulse at the worst moment",
    ),
    Model(
        name="sequence",
        label="sequence",
        words="main impulses at the start of each half-cycle and smaller ones of alternating sign between them, from "
        "the half-waves of the record alone; between impulses the natural motion of the block. By [sequence] method: "
        "the conservative rule below, one sequence for each record and body, unless another one is asked for.",
        respond=_sequence,
        search=_search_sequence,
        look=("orange", (0, (6, 1.5, 1, 1.5)), "s"),
        of_sequence=True,
        knows="wall",
    ),
    Model(
        name="balanced",
        label="balanced rule",
        words="an impulse sequence for each record and body by a rule that predicts the mean capacity by the nonlinear "
        "model under uncertainty: about even odds of overturning.",
        respond=partial(_rule, point="balanced"),
        search=partial(_search_rule, point="balanced"),
        look=("sky", (0, (3, 1, 1, 1, 1, 1)), "<"),
        fitted=True,
    ),
    Model(
        name="conservative",
        label="conservative rule",
        words="the same for the factor at which the nonlinear model overturns with a probability of 10 %.",
        respond=partial(_rule, point="conservative"),
        search=partial(_search_rule, point="conservative"),
        look=("grey", (0, (8, 2)), ">"),
        fitted=True,
    ),
    Model(
        name="impulsive",
        label="impulsive",
        words="every half-wave of the record as an impulse at its centroid; between them the natural motion of the "
        "block. It knows no threshold of uplift.",
        respond=_impulsive,
        search=_search_impulsive,
        look=("green", (0, (2, 1)), "^"),
        checkable=True,
        searched=True,
    ),
    Model(
        name="linear",
        label="linear",
        words="the equation of motion for small rotations, under the accelerogram itself.",
        respond=partial(_recorded, equation="linear"),
        search=partial(_search_recorded, equation="linear"),
        look=("red", (0, (4, 1.2)), "D"),
        knows="linear",
        checkable=True,
        searched=True,
    ),
    Model(
        name="nonlinear",
        label="nonlinear",
        words="the full equation of motion under the accelerogram itself: "
        "θ″ = −p² [(1 + a_v/g) sin(±α_c − θ) + (a_g/g) cos(±α_c − θ)].",
        respond=partial(_recorded, equation="nonlinear"),
        search=partial(_search_recorded, equation="nonlinear"),
        look=("blue", "-", "o"),
        knows="all",
        slender=False,
        checkable=True,
        searched=True,
    ),
    Model(
        name="auto",
        label="auto",
        words="the cheapest model whose verdict is that of the nonlinear one. Peaks written ~0.06 are estimates from "
        "impulses, those written >0.12 the peak so far when the verdict was certain.",
        respond=_auto,
        search=partial(_search_recorded, equation="nonlinear"),
        look=("black", "-", "P"),
        knows="all",
        slender=False,
        checkable=True,
        searched=True,
    ),
)

#: The models that answer unless others are asked for, and those that stand side by side where all are.
DEFAULT_MODELS = ("sequence", "nonlinear")
ALL_MODELS = ("resonance", "sequence", "impulsive", "linear", "nonlinear")

#: Every model by its name.
MODELS = {row.name: row for row in _ROWS}

#: The models that [models] use and [search] models may name; `auto` has a key of its own.
NAMES = tuple(name for name in MODELS if name != "auto")

#: The models whose input is a sequence; the others need the accelerogram or its half-waves.
SEQUENCE_MODELS = tuple(row.name for row in _ROWS if row.of_sequence)

#: What may have given an answer: the models, and what only `auto` knows.
USED = (*NAMES, "static", "settled")


def is_upper_bound(name: str) -> bool:
    """Whether the overturning by a model says no more than that a body may be unsafe."""
    return name in MODELS and MODELS[name].upper_bound != ""


@dataclass(frozen=True)
class ModelSettings(Section):
    """The models that answer, and their exactness."""

    heading = "[models]"
    use: tuple[str, ...] = choices(DEFAULT_MODELS, NAMES)
    auto: bool = boolean(False)
    output: str = choice("outcome", ("outcome", "peak"))
    tolerance: float = number(1e-4, low=0.0, above=True)
    predictability: bool = boolean(False)
    gain: str = choice("paper", ("paper", "linear", "exact"))
    histories: bool = boolean(False)

    @property
    def answering(self) -> tuple[str, ...]:
        """The models of the results: those in use, and `auto` where it is asked for."""
        return (*self.use, "auto") if self.auto else self.use


@dataclass(frozen=True)
class SearchSettings(Section):
    """The models whose factors of overturning are told, and the grid of factors on which they are searched."""

    heading = "[search]"
    models: tuple[str, ...] = choices(NAMES, NAMES, empty=True)
    intervals: bool = boolean(False)
    factor_max: float = number(10.0, low=1.0, high=1e6)
    points: int = count(256, low=2, high=100_000)
    step: float = number(1.005, low=1.0001)


@dataclass(frozen=True, eq=False)
class Scene:
    """A conditioned record made ready for the models: what was extracted from it, and the options of the models.

    `vertical` is the vertical ground acceleration on the samples of the record, (n,) [m/s2], for the nonlinear model,
    `phase` the stretch that the sequence is calibrated on. The sequence is None where the phase holds too few
    half-waves; by a design spectrum it is (m,), one a block, for the sequence model alone. `rule` is the working point
    of the rule by which it answers; empty where that is the sequence.
    """

    record: Record
    vertical: np.ndarray | None
    waves: HalfWaves
    phase: IntensePhase
    sequence: rocking.ImpulseSequence | None
    models: ModelSettings
    search: SearchSettings
    rule: str = ""


def critical_scales(block: rocking.Block, scene: Scene) -> dict[str, rocking.ScaleIntervals]:
    """Factors on the input at which each of (m,) blocks overturns, by model; NaN without a search.

    `auto` has those of the nonlinear model, whose outcomes are its own; where a model stops answering is a lower bound.
    """
    found: dict[str, rocking.ScaleIntervals] = {}
    for model in scene.models.answering:
        searched = "nonlinear" if model == "auto" else model
        asked = searched in scene.search.models and (scene.search.intervals or not MODELS[model].searched)
        if searched in found:
            found[model] = found[searched]
        else:
            found[model] = MODELS[model].intervals(block, scene) if asked else _not_searched(block)
    return found
