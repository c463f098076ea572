"""Prepares a record for the models: on the ground or a floor, and in the direction of a body."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.body.supports import floor_motion
from rocking.response import Outcome, Response
from rocking.search.factors import ScaleIntervals
from rockpulse.config.bodies import Bodies, FeltMotion
from rockpulse.config.configuration import Config
from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.errors import RecordRefused
from rockpulse.model_table import RULE_POINT, Scene
from rockpulse.record.components import Pair, align, uncovered
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.record.rotation import rotate
from rockpulse.selection.directions import FACING_WITHIN
from rockpulse.sequences.estimators import record_sequence
from rockpulse.warning_text import WarningText


def extract(conditioned: Record, config: Config, up: Record | None = None) -> Scene:
    """Return the input of the models: a conditioned record, its half-waves, intense phase and sequence, and options."""
    lift = None
    if up is not None:
        lift = align(up, conditioned)
        warnings = (*conditioned.warnings, *(WarningText("of_vertical", warning=warning) for warning in up.warnings))
        conditioned = replace(conditioned, warnings=warnings).with_note(
            WarningText("vertical_acceleration", record=up.id)
        )
        if (missing := uncovered(up, conditioned)) > up.dt:
            conditioned = conditioned.with_warning(WarningText("vertical_short", missing=missing))
    waves = half_waves(conditioned, **config.half_waves)
    phase = intense_phase(conditioned, **config.intense_phase)
    try:
        sequence = record_sequence(waves, phase=phase, **config.sequence.statistics)
    except RecordRefused as error:
        sequence = None
        conditioned = conditioned.with_warning(WarningText("no_sequence", reason=str(error)))
    rule = RULE_POINT if config.sequence.method == "rule" else ""
    return Scene(conditioned, lift, waves, phase, sequence, rule=rule, **solver_options(config))


def solver_options(config: Config) -> dict[str, Any]:
    """Return the solver options of the configuration, as fields of a scene."""
    models, search = config.models, config.search
    own = {"gain": models.gain, "histories": models.histories}
    return own | {"factor_max": search.factor_max, "points": search.points, "step": search.step}


#: The motion of a floor ends when its acceleration is below this share of gravity, a thousandth of the acceleration
#: that lifts a body of slenderness 10.
QUIET = 1e-4


def places_of(bodies: Bodies, record: Record, pair: Pair | None, config: Config) -> list[tuple[FeltMotion, np.ndarray]]:
    """Return each floor and direction with the indices of its bodies; RecordRefused if a channel is missing."""
    if config.records.components == "horizontal":
        return bodies.places(None)
    azimuth = math.nan if record.azimuth is None else float(record.azimuth)
    found = bodies.places(azimuth, 1e-6 if pair is not None else FACING_WITHIN)
    others = [place for place, _ in found if place.azimuth is not None]
    if others and pair is None:
        raise RecordRefused(
            f"{record.id}: it has no second horizontal channel, and its azimuth is {azimuth:g} degrees: it cannot be "
            f"rotated to the direction of a body, {others[0].azimuth:g} degrees; give both channels"
        )
    return found


def turned(scene: Scene, place: FeltMotion, pair: Pair | None, config: Config) -> Scene:
    """Return the scene with the record rotated to the direction of a body, from both channels of the pair."""
    if place.azimuth is None:
        return scene
    assert pair is not None
    return replace(extract(rotate(pair, place.azimuth), config), vertical=scene.vertical)


def floor_scene(scene: Scene, place: FeltMotion, config: Config) -> Scene:
    """Return the scene with the motion of the floor below a body, and the vertical motion of the ground."""
    if not place.floors:
        return scene
    record, found = scene.record, floor_record(scene.record, place.floors)
    there = extract(found, config)
    if scene.vertical is None:
        return there
    times = found.dt * np.arange(found.npts)
    lift = np.interp(times, record.dt * np.arange(scene.vertical.size), scene.vertical, right=0.0)
    return replace(there, vertical=lift)


def floor_record(record: Record, floors: Sequence[FloorSettings]) -> Record:
    """Return the motion of a floor of a building under a conditioned record, from the modes of the building."""
    period, damping, share = ([getattr(one, name) for one in floors] for name in ("period", "damping", "participation"))
    found = floor_motion(record.acceleration, record.dt, period, damping, share, quiet=QUIET * STANDARD_GRAVITY)
    return replace(record, acceleration=found.acceleration, dt=found.dt)


def joined_responses(
    parts: Sequence[Response], lanes: Sequence[np.ndarray], samples: int, steps: Sequence[int]
) -> Response:
    """Join the responses of groups of bodies; only every `steps[i]`-th sample of the histories of group i is kept."""
    whole = []
    for part, step in zip(parts, steps, strict=True):
        motion = (None if one is None else one[:, ::step][:, :samples] for one in (part.rotation, part.velocity))
        whole.append(part.changed(time=None, **dict(zip(("rotation", "velocity"), motion, strict=True))))
    return Response.join(whole, lanes, sum(places.size for places in lanes))


#: Largest angle between the direction of a record and the direction in which a body can fall, or its opposite
#: [degrees]; at larger angles a body beside a wall is assessed in both senses, and the worse result is used.
SAME_DIRECTION = 30.0


@dataclass(frozen=True, eq=False)
class Senses:
    """Blocks with the side to which each may fall under a record; a block that may fall to both has a mirror image."""

    block: Block  # the blocks, followed by the mirrored ones
    both: np.ndarray  # indices of the blocks that are also mirrored

    @property
    def count(self) -> int:
        """Number of blocks, without mirror images."""
        return int(self.block.shape[0] - self.both.size)

    def worse(self, response: Response) -> Response:
        """Return the response of each block or its mirror image, whichever is worse (unknown is worse than rocking)."""
        return response if self.both.size == 0 else response.take(self.worse_places(response))

    def worse_places(self, response: Response) -> np.ndarray:
        """Return, for each block, the index in ``block`` of the block or its mirror image with the worse response."""
        rank = np.where(response.outcome == Outcome.OVERTURNS, np.inf, response.peak_rotation_ratio)
        rank = np.where(response.outcome == Outcome.UNRESOLVED, np.finfo(float).max, rank)
        return self._chosen(rank)

    def smaller(self, found: ScaleIntervals) -> ScaleIntervals:
        """Return, for each block, the intervals of the block or mirror image with the smaller safety factor."""
        rank = -np.where(np.isnan(found.safety_factor), np.inf, found.safety_factor)
        return found if self.both.size == 0 else found.take(self._chosen(rank))

    def higher_probability(self, probability: np.ndarray, factor: np.ndarray) -> np.ndarray:
        """Return, for each block, the index of the block or its mirror image, whichever is more likely to overturn."""
        return self._chosen(np.argsort(np.lexsort((-factor, probability))))

    def _chosen(self, rank: np.ndarray) -> np.ndarray:
        """Return, for each block, the index in ``block`` of the block or its mirror image with the higher rank."""
        places = np.arange(self.count)
        second = self.count + np.arange(self.both.size)
        places[self.both] = np.where(rank[second] > rank[self.both], second, self.both)
        return places


def acting(azimuth: float, facing: float) -> tuple[int, ...]:
    """Return (1,) if the direction of a record is `facing`, (-1,) if it is opposite, (1, -1) if it is in between."""
    along, least = math.cos(math.radians(azimuth - facing)), math.cos(math.radians(SAME_DIRECTION))
    return (1,) if along >= least else (-1,) if along <= -least else (1, -1)


def senses(bodies: Bodies, record: Record, step: int = 1) -> Senses:
    """Return the blocks of bodies, or every `step`-th block, with the sides to which they may fall under a record."""
    lanes = bodies.lanes.take(slice(None, None, step))
    leaning = np.asarray(lanes.side) != 0
    if not np.any(leaning):
        return Senses(lanes, np.zeros(0, dtype=np.int64))
    azimuth = np.nan if record.azimuth is None else float(record.azimuth)
    every = [acting(azimuth, facing) for facing in np.repeat(bodies.facing, bodies.cases)[::step].tolist()]
    against = leaning & np.array([found == (-1,) for found in every])
    both = np.flatnonzero(leaning & np.array([len(found) > 1 for found in every]))
    mirror = lanes.mirrored()
    own = [(mirror if turned else lanes).lane(place) for place, turned in enumerate(against)]
    first = Block.stack(own) if np.any(against) else lanes
    return Senses(Block.stack([first, mirror.take(both)]) if both.size else first, both)
