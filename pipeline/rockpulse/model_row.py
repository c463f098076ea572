"""Defines a row of the table of models, and the scene, which is the input of a model."""

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
