"""Table of models, from the cheapest to the full equation of motion: one row a model, with all that is known of it.

A model is added here and nowhere else: its functions, and a row of :data:`MODELS`. Whatever asks what a model can do
asks its row; a test finds the name of a model outside this table. The solvers are loaded when a function is called, for
the configuration takes the names of the models from here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import rocking
from rocking.response import Response
from rockpulse.option import Section, boolean, choice, choices, count, number
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record

if TYPE_CHECKING:
    from rockpulse.calibration.rule import Rule

#: What a model with an upper bound for its input is called, wherever it is shown.
UPPER_BOUND = "upper-bound type input"

#: The equations of motion under an accelerogram, by the words of :func:`rocking.recorded_response`.
Equation = Literal["linear", "nonlinear"]


def _resonance(block: rocking.Block, scene: Scene) -> rocking.Response:
    one = scene.sequence
    if one is None:
        return Response.unresolved(block.shape, rocking.Reason.NO_SEQUENCE)
    return rocking.resonance(block, one.main, one.main_count, one.duration)


def _search_resonance(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    if scene.sequence is None:
        return rocking.ScaleIntervals.unknown(block.shape)
    return rocking.resonance_critical_scale(block, scene.sequence, scene.search.factor_max)


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
    one, search = scene.sequence, scene.search
    if one is None:
        return rocking.ScaleIntervals.unknown(block.shape)
    return rocking.sequence_critical_scale(block, one, search.factor_max, search.step, paired=one.shape != ())


def _rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.Response:
    return rocking.sequence_response(block, _loaded(point).sequence(scene.waves, block), paired=True)


def _search_rule(block: rocking.Block, scene: Scene, *, point: str) -> rocking.ScaleIntervals:
    return _loaded(point).intervals(scene.waves, block, scene.search.factor_max)


def _loaded(point: str) -> Rule:
    from rockpulse.calibration.rule import load_rule

    return load_rule(point)


def _impulsive(block: rocking.Block, scene: Scene, scale: Any = None) -> rocking.Response:
    return rocking.impulsive_response(
        block,
        scene.waves.centroid,
        scene.waves.impulse,
        duration=scene.record.duration,
        gain=scene.models.gain,
        scale=1.0 if scale is None else scale,
        history_dt=None if scale is None else scene.record.dt,
    )


def _search_impulsive(block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
    waves, search = scene.waves, scene.search
    return rocking.impulsive_critical_scale(
        block, waves.centroid, waves.impulse, scene.models.gain, search.factor_max, search.points
    )


def _recorded(block: rocking.Block, scene: Scene, scale: Any = None, *, equation: Equation) -> rocking.Response:
    return rocking.recorded_response(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation=equation,
        vertical=MODELS[equation].vertical_of(scene),
        scale=1.0 if scale is None else scale,
        history=scene.models.histories if scale is None else True,
    )


def _search_recorded(block: rocking.Block, scene: Scene, *, equation: Equation) -> rocking.ScaleIntervals:
    return rocking.critical_scale(
        block,
        scene.record.acceleration,
        scene.record.dt,
        equation,
        vertical=MODELS[equation].vertical_of(scene),
        factor_max=scene.search.factor_max,
        points=scene.search.points,
    )


@dataclass(frozen=True)
class Model:
    """A row of the table of models: functions, capabilities and words of one model."""

    name: str
    #: What the legend of a picture calls it, and what a report says of it.
    label: str
    words: str
    #: From (m,) blocks and a record made ready to the answers, and to the factors at which they overturn.
    respond: Callable[..., rocking.Response]
    search: Callable[[rocking.Block, Scene], rocking.ScaleIntervals]
    #: How it is drawn: a colour of the palette of the pictures, a line and a marker as matplotlib takes them.
    look: tuple[str, str | tuple[float, tuple[float, ...]], str]
    #: The input: the calibrated sequence, with a time of its own and without any record; the half-waves of the record;
    #: or its accelerogram.
    takes: Literal["sequence", "half-waves", "accelerogram"]
    #: Whether `respond` also takes (q,) factors on the record, and then gives the motion in time under each.
    follows: bool = False
    #: The impulses inside the half-cycles that results hold, from which the motion in time is drawn; empty for none.
    cycles: Literal["", "main", "main and secondary"] = ""
    #: The equation of motion of :func:`rocking.recorded_response`; None for a model of impulses.
    equation: Equation | None = None
    #: Whether it is the full equation of motion: other models are judged by it, and where it is in use results hold its
    #: probability of overturning.
    full: bool = False
    #: Whether it answers unless other models are asked for.
    default: bool = False
    #: Whether the vertical acceleration acts.
    vertical: bool = False
    #: Whether it is stated for slender blocks only, a slenderness of at least 3 (the linear motion of Eqs. 1-2).
    slender: bool = True
    #: What it knows of bodies beside free-standing symmetric ones: some of :data:`rocking.body.block_lanes.FEATURES`.
    knows: tuple[str, ...] = ()
    #: Whether it is the working point of that name of the rule.
    fitted: bool = False
    #: Whether its sequence is that of `[sequence] method`, and may be another one for each body.
    paired: bool = False
    #: Whether its sequence has to end, by a number of main impulses or a duration.
    needs_end: bool = False
    #: The key of [search] that sets how finely factors are tried; empty where the factor is known at once.
    grid: Literal["", "step", "points"] = ""
    #: How its input is an upper bound, so that its overturning says no more than that a body may be unsafe.
    upper_bound: str = ""

    @property
    def searched(self) -> bool:
        """Whether its factors are found by hundreds of runs, which `[search] intervals` asks for."""
        return self.grid == "points"

    def rule(self, scene: Scene) -> Rule | None:
        """The working point of the rule by which the model answers; None where it does not."""
        point = self.name if self.fitted else scene.rule if self.paired else ""
        return _loaded(point) if point else None

    def vertical_of(self, scene: Scene) -> np.ndarray | None:
        """The vertical acceleration that acts by this model."""
        return scene.vertical if self.vertical else None

    def answers(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """True for those of (m,) blocks of which the model knows everything that they have."""
        return np.asarray(block.known_to(() if self.rule(scene) else self.knows))

    def applicable(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """True for those of (m,) blocks that lie in the range of the model; a rule holds for those like its fit's."""
        within = self.answers(block, scene) & (np.asarray(block.slender) | (not self.slender))
        rule = self.rule(scene)
        return within if rule is None else within & rule.applicable(block).reshape(block.shape)

    def response(self, block: rocking.Block, scene: Scene) -> rocking.Response:
        """The answer for (m,) blocks; UNRESOLVED for those of which the model does not know everything."""
        known = self.answers(block, scene)
        if np.all(known):
            return self.respond(block, scene)
        if not np.any(known):
            return Response.unresolved(block.shape, rocking.Reason.NOT_MODELLED)
        return self.respond(block.take(known), scene).among(known, rocking.Reason.NOT_MODELLED)

    def intervals(self, block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
        """The factors on the input at which (m,) blocks overturn, where [search] asks for them.

        NaN without a search, and for those blocks of which the model does not know everything. A factor at which the
        model stops answering is a lower bound.
        """
        asked = self.name in scene.search.models and (scene.search.intervals or not self.searched)
        known = self.answers(block, scene) & asked
        if not np.any(known):
            return rocking.ScaleIntervals.unknown(block.shape)
        return self.search(block if np.all(known) else block.take(known), scene).among(known)


#: The order is that of results, and the rank: of the models that results hold, the verdict counts the last one.
_ROWS = (
    Model(
        name="resonance",
        label=f"resonance ({UPPER_BOUND})",
        words=f"{UPPER_BOUND}, no prediction: the main impulse of the record arrives at the worst moment of every "
        "half-cycle (closed form). Its overturning says that the body may be unsafe, nothing more.",
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
        "the half-waves of the record alone; between impulses the natural motion of the block. By [sequence] method: "
        "the conservative rule below, one sequence for each record and body, unless another one is asked for.",
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
        words="the same for the factor at which the nonlinear model overturns with a probability of 10 %.",
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
        "block. It knows no threshold of uplift.",
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
        words="the full equation of motion under the accelerogram itself: "
        "θ″ = −p² [(1 + a_v/g) sin(±α_c − θ) + (a_g/g) cos(±α_c − θ)].",
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

#: Every model by its name, and their names.
MODELS = {row.name: row for row in _ROWS}
NAMES = tuple(MODELS)

#: The models that answer unless others are asked for, and those that stand side by side where all are.
DEFAULT_MODELS = tuple(row.name for row in _ROWS if row.default)
ALL_MODELS = tuple(row.name for row in _ROWS if not row.fitted)

#: The working point of the rule by which the paired models answer with `[sequence] method = "rule"`.
RULE_POINT = "conservative"

#: The models whose input is a sequence; the others need the accelerogram or its half-waves.
SEQUENCE_MODELS = tuple(row.name for row in _ROWS if row.takes == "sequence")

#: The fullest first: those with a motion in time, those that follow the record to a factor on it, and those that are an
#: equation of motion under the accelerogram.
DRAWN = tuple(row.name for row in reversed(_ROWS) if row.follows or row.cycles)
FOLLOWING = tuple(row.name for row in reversed(_ROWS) if row.follows)
EQUATIONS = tuple(row.name for row in reversed(_ROWS) if row.equation)


def is_upper_bound(name: str) -> bool:
    """Whether the overturning by a model says no more than that a body may be unsafe."""
    return name in MODELS and MODELS[name].upper_bound != ""


def is_full(name: str) -> bool:
    """Whether a model is the full equation of motion."""
    return name in MODELS and MODELS[name].full


def fullest(names: Iterable[str]) -> str:
    """The model nearest to the full equation of motion; names that are not in the table come before all others."""
    return max(names, key=lambda name: NAMES.index(name) if name in MODELS else -1)


@dataclass(frozen=True)
class ModelSettings(Section):
    """The models that answer, and their options."""

    heading = "[models]"
    use: tuple[str, ...] = choices(DEFAULT_MODELS, NAMES)
    gain: str = choice("paper", ("paper", "linear", "exact"))
    histories: bool = boolean(False)


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

    `vertical` is the vertical ground acceleration on the samples of the record, (n,) [m/s2], for the models in which it
    acts, `phase` the stretch that the sequence is calibrated on. The sequence is None where the phase holds too few
    half-waves; by a design spectrum it is (m,), one a block, for the paired models alone. `rule` is the working point
    of the rule by which these answer; empty where they take the sequence.
    """

    record: Record
    vertical: np.ndarray | None
    waves: HalfWaves
    phase: IntensePhase
    sequence: rocking.ImpulseSequence | None
    models: ModelSettings
    search: SearchSettings
    rule: str = ""
