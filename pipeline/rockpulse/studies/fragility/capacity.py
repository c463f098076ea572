"""What one record says of the capacities of the bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rockpulse.config.configuration import Config
from rockpulse.ladder import Scene
from rockpulse.studies.fragility.limit_states import reached_at, scale_capacities
from rockpulse.studies.fragility.measures import record_measures, record_qualities

__all__ = ["RecordCapacity", "record_capacity"]


@dataclass(frozen=True, eq=False)
class RecordCapacity:
    """What one record says of the capacities of m lanes.

    Attributes
    ----------
    record_id, source : str
        Which record.
    measures : (k, m) ndarray
        Its measures as recorded, in the order of ``[fragility] measures``.
    qualities : dict of str to float
        By the names of :data:`rockpulse.studies.fragility.measures.QUALITIES`.
    factors : (s, m) or (r, m) ndarray
        Incremental analysis: first factor that reaches each limit state, inf where none does [-]. Stripes: the factors
        that were looked at.
    step : (m,) ndarray or None
        Ratio of neighbouring factors of the scan of an incremental analysis [-]; None for stripes.
    reached : (s, r, m) ndarray of int or None
        Stripes: whether the limit state was reached; None for an incremental analysis.
    """

    record_id: str
    source: str
    measures: np.ndarray
    qualities: dict[str, float]
    factors: np.ndarray
    step: np.ndarray | None
    reached: np.ndarray | None


def record_capacity(scene: Scene, block: Block, config: Config) -> RecordCapacity:
    """What one record says of the capacities of (m,) bodies; a ValueError where the model refuses its numbers."""
    settings = config.fragility
    step = reached = None
    if settings.data == "ida":
        found = scale_capacities(
            scene,
            block,
            settings.limit_states,
            settings.equation,
            config.search.factor_max,
            config.search.points,
        )
        factors, step = found.factors, found.step
    else:
        factors = np.ones((1, *block.shape))
        if settings.data == "stripes":
            own = record_measures(scene, block, (settings.stripe_measure,))
            factors = np.asarray(settings.stripe_levels)[:, None] / own
        reached = reached_at(scene, block, settings.limit_states, settings.equation, factors)
    return RecordCapacity(
        record_id=scene.record.id,
        source=scene.record.source,
        measures=record_measures(scene, block, settings.measures),
        qualities=record_qualities(scene),
        factors=factors,
        step=step,
        reached=reached,
    )
