"""A row of the table of models, and the scene that a model answers for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

import rocking
from rocking.response import Response
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record

if TYPE_CHECKING:
    from rockpulse.sequences.rule import Rule

#: The equations of motion under an accelerogram, by the words of :func:`rocking.recorded_response`.
Equation = Literal["linear", "nonlinear"]


@dataclass(frozen=True, eq=False)
class Scene:
    """A conditioned record made ready for the models: what was extracted from it, and their options."""

    record: Record
    vertical: np.ndarray | None  # (n,) acceleration on the samples of the record [m/s2], for models in which it acts
    waves: HalfWaves
    phase: IntensePhase  # that the sequence is calibrated on
    # None if the phase holds too few half-waves; by a design spectrum (m,), one a block, for the paired models alone
    sequence: rocking.ImpulseSequence | None
    gain: str = "paper"  # of [models], and so is the next
    histories: bool = False
    factor_max: float = 10.0  # of [search], and so are the next two
    points: int = 256
    step: float = 1.005
    rule: str = ""  # working point of the rule by which paired models answer; empty where they take the sequence


def loaded_rule(point: str) -> Rule:
    """The rule at one of its working points."""
    from rockpulse.sequences.rule import load_rule

    return load_rule(point)


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
        return loaded_rule(point) if point else None

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
        """The factors on the input at which (m,) blocks overturn; NaN for blocks with what the model does not know."""
        known = self.answers(block, scene)
        if not np.any(known):
            return rocking.ScaleIntervals.unknown(block.shape)
        return self.search(block if np.all(known) else block.take(known), scene).among(known)
