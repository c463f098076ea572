"""The senses of a record for bodies before a wall: which way the ground has to move to lift them.

.. note:: A body that leans on a wall falls away from it only. Where the azimuths of the record and of the body's fall
   are known and lie within SAME_DIRECTION of each other, or of opposite ones, the sense is known; otherwise the record
   is taken in both, and the worse answer counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rocking.body.block import Block
from rocking.response import Outcome, Response
from rocking.search.factors import ScaleIntervals
from rockpulse.config.bodies import Bodies
from rockpulse.record.record import Record

#: Degrees between the azimuths of a record and of a body's fall up to which the record tells the sense.
SAME_DIRECTION = 30.0


@dataclass(frozen=True, eq=False)
class Senses:
    """Lanes (m,) of bodies, each in the sense of the record, with a second lane where that is not known.

    ``block`` holds the m lanes and, after them, the other sense of those at the places ``both``.
    """

    block: Block
    both: np.ndarray

    @property
    def count(self) -> int:
        """Number of lanes, m."""
        return int(self.block.shape[0] - self.both.size)

    def worse(self, response: Response) -> Response:
        """The worse of both answers of each lane: overturning, no answer, then the larger rotation."""
        return response if self.both.size == 0 else response.take(self.worst(response))

    def worst(self, response: Response) -> np.ndarray:
        """Places in ``block``, of each lane, of the worse of both answers."""
        rank = np.where(response.outcome == Outcome.OVERTURNS, np.inf, response.peak_rotation_ratio)
        return self._chosen(np.where(response.outcome == Outcome.UNRESOLVED, np.finfo(float).max, rank))

    def smaller(self, found: ScaleIntervals) -> ScaleIntervals:
        """The intervals of the sense with the smaller factor."""
        if self.both.size == 0:
            return found
        places = self._chosen(-np.where(np.isnan(found.safety_factor), np.inf, found.safety_factor))
        return found.take(places)

    def likelier(self, probability: np.ndarray, factor: np.ndarray) -> np.ndarray:
        """Places in ``block``, of each lane, of the higher probability; of two alike that of the smaller factor."""
        order = np.lexsort((-factor, probability))
        rank = np.empty(order.size)
        rank[order] = np.arange(order.size)
        return self._chosen(rank)

    def _chosen(self, rank: np.ndarray) -> np.ndarray:
        """Of each lane the one of its two, by place in ``block``, whose rank is higher."""
        places = np.arange(self.count)
        second = self.count + np.arange(self.both.size)
        places[self.both] = np.where(rank[second] > rank[self.both], second, self.both)
        return places


def acting(azimuth: float, facing: float) -> tuple[int, ...]:
    """The senses in which a record may act on a body before a wall, by both azimuths [degrees]; NaN if not known.

    1 where it acts towards the fall, -1 against it, both where that is not known.
    """
    along, least = math.cos(math.radians(azimuth - facing)), math.cos(math.radians(SAME_DIRECTION))
    return (1,) if along >= least else (-1,) if along <= -least else (1, -1)


def senses(bodies: Bodies, record: Record, step: int = 1) -> Senses:
    """The lanes of bodies in the senses of a record; every `step`-th lane only."""
    lanes = bodies.lanes.take(slice(None, None, step))
    leaning = np.asarray(lanes.side) != 0
    if not np.any(leaning):
        return Senses(lanes, np.zeros(0, dtype=np.int64))
    azimuth = np.nan if record.azimuth is None else float(record.azimuth)
    every = [acting(azimuth, facing) for facing in np.repeat(bodies.facing, bodies.cases)[::step].tolist()]
    against = leaning & np.array([found == (-1,) for found in every])
    both = np.flatnonzero(leaning & np.array([len(found) > 1 for found in every]))
    mirror = lanes.mirrored()
    own = [mirror.lane(place) if turned else lanes.lane(place) for place, turned in enumerate(against)]
    first = Block.stack(own) if np.any(against) else lanes
    return Senses(Block.stack([first, mirror.take(both)]) if both.size else first, both)
