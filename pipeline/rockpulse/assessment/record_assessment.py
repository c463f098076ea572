"""What one record does to every body, before it becomes rows of the results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rocking.response import Response
from rocking.scale_search import ScaleIntervals
from rockpulse.ladder import Scene

__all__ = ["RecordAssessment"]


@dataclass(frozen=True, eq=False)
class RecordAssessment:
    """What one record does to every body: numbers only, small enough to be sent between processes.

    Attributes
    ----------
    scene : Scene
        The conditioned record and what was extracted from it.
    record : dict
        Scalars of the record, by the names of docs/schema.md. The earthquake, `event`, is empty: it is told by all
        records together.
    per_block : dict of (b, c) ndarray
        Demand of the record on each body and restitution case.
    per_model : dict of (b, c, k) ndarray
        Answer of each of the k models, and which one gave it.
    responses : dict of str to Response
        By model, lanes (b x c,): the half-cycle tables and histories are taken from here.
    scales : dict of str to ScaleIntervals
        By model, lanes (b x c,): the intervals of overturning are taken from here.
    """

    scene: Scene
    record: dict[str, Any]
    per_block: dict[str, np.ndarray]
    per_model: dict[str, np.ndarray]
    responses: dict[str, Response]
    scales: dict[str, ScaleIntervals]
