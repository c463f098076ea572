"""A row of the table of models, and the scene that is the input of a model."""

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
    """A conditioned record prepared for the models, with the extracted quantities and the options."""

    record: Record
    vertical: np.ndarray | None  # (n,) on the samples of the record [m/s2], for models that use it
    waves: HalfWaves
    phase: IntensePhase  # phase on which the sequence is calibrated
    # None for too few half-waves in the phase; for a design spectrum (m,), one per block, for paired models only
    sequence: rocking.ImpulseSequence | None
    gain: str = "paper"  # from [models], as the next
    histories: bool = False
    factor_max: float = 10.0  # from [search], as the next two
    points: int = 256
    step: float = 1.005
    rule: str = ""  # working point of the rule for paired models; empty if they use the sequence


def loaded_rule(point: str) -> Rule:
    """Return the rule at one of its working points (cached)."""
    from rockpulse.sequences.rule import load_rule

    return load_rule(point)


@dataclass(frozen=True)
class Model:
    """A row of the table of models: functions, capabilities and texts of one model."""

    name: str
    #: Name in the legend of a picture, and description in a report.
    label: str
    words: str
    #: Functions of (m,) blocks and a scene that return the responses, and the factors at which the blocks overturn.
    respond: Callable[..., rocking.Response]
    search: Callable[[rocking.Block, Scene], rocking.ScaleIntervals]
    #: Style in pictures: a colour of the palette, a line and a marker of matplotlib.
    look: tuple[str, str | tuple[float, tuple[float, ...]], str]
    #: Input of the model: the calibrated sequence (with its own time), the half-waves, or the accelerogram.
    takes: Literal["sequence", "half-waves", "accelerogram"]
    #: Whether `respond` also accepts (q,) factors on the record, and then returns the history under each.
    follows: bool = False
    #: Impulses inside the stored half-cycles, from which the history is drawn; empty for none.
    cycles: Literal["", "main", "main and secondary"] = ""
    #: Equation of motion of :func:`rocking.recorded_response`; None for impulse models.
    equation: Equation | None = None
    #: Whether it is the full equation of motion: the reference of other models, and the model of the probability of
    #: overturning in results.
    full: bool = False
    #: Whether it is used by default.
    default: bool = False
    #: Whether it uses the vertical acceleration.
    vertical: bool = False
    #: Whether it holds only for a slenderness of at least 3 (the linear motion of Eqs. 1-2).
    slender: bool = True
    #: Features of bodies that it can treat, from :data:`rocking.body.block_lanes.FEATURES`.
    knows: tuple[str, ...] = ()
    #: Working point of the rule that the model represents; empty for other models.
    fitted: bool = False
    #: Whether it uses the sequence of `[sequence] method`, which may differ from body to body.
    paired: bool = False
    #: Whether its sequence must end, by a number of main impulses or a duration.
    needs_end: bool = False
    #: Key of [search] that sets the density of the scan of factors; empty for closed forms.
    grid: Literal["", "step", "points"] = ""
    #: Reason why its input is an upper bound, so that overturning only means that a body may be unsafe.
    upper_bound: str = ""

    @property
    def searched(self) -> bool:
        """Whether its factors need hundreds of runs, which `[search] intervals` requests."""
        return self.grid == "points"

    def rule(self, scene: Scene) -> Rule | None:
        """Return the working point of the rule that the model uses, or None."""
        point = self.name if self.fitted else scene.rule if self.paired else ""
        return loaded_rule(point) if point else None

    def vertical_of(self, scene: Scene) -> np.ndarray | None:
        """Return the vertical acceleration that this model uses."""
        return scene.vertical if self.vertical else None

    def answers(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """Mask (m,) of blocks whose features the model can treat."""
        return np.asarray(block.known_to(() if self.rule(scene) else self.knows))

    def applicable(self, block: rocking.Block, scene: Scene) -> np.ndarray:
        """Mask (m,) of blocks in the range of the model; for a rule, the range of its fit."""
        within = self.answers(block, scene) & (np.asarray(block.slender) | (not self.slender))
        rule = self.rule(scene)
        return within if rule is None else within & rule.applicable(block).reshape(block.shape)

    def response(self, block: rocking.Block, scene: Scene) -> rocking.Response:
        """Return the response of (m,) blocks; UNRESOLVED for blocks with features that the model cannot treat."""
        known = self.answers(block, scene)
        if np.all(known):
            return self.respond(block, scene)
        if not np.any(known):
            return Response.unresolved(block.shape, rocking.Reason.NOT_MODELLED)
        return self.respond(block.take(known), scene).among(known, rocking.Reason.NOT_MODELLED)

    def intervals(self, block: rocking.Block, scene: Scene) -> rocking.ScaleIntervals:
        """Return the factors on the input at which (m,) blocks overturn; NaN for blocks that the model cannot treat."""
        known = self.answers(block, scene)
        if not np.any(known):
            return rocking.ScaleIntervals.unknown(block.shape)
        return self.search(block if np.all(known) else block.take(known), scene).among(known)
