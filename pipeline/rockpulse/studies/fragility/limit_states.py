"""Limit states of a block, and whether a scaled record reaches them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rocking.capacity import critical_scale, uplift_scale
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.config.fragility_settings import OVERTURNING, UPLIFT
from rockpulse.model_row import Equation, Scene
from rockpulse.model_table import MODELS

#: Stands for a motion that the model cannot resolve.
NOT_KNOWN = -1


@dataclass(frozen=True, eq=False)
class Capacities:
    """The result of an incremental dynamic analysis of one record.

    `factors` (s, m) are the first factors on the record found to reach each limit state [-], inf where none does up to
    the end of the search. Rotation need not grow with the factor: above the first one the limit state may be left
    again.

    `step` (m,) is the ratio of neighbouring factors of the scan [-]: where a limit state is reached in a narrower
    interval only, the factor is one that lies higher. One where nothing can be missed: uplift alone, or uplift beyond
    the search.
    """

    factors: np.ndarray
    step: np.ndarray


def limit_state_names(states: Sequence[str | float]) -> list[str]:
    """Names in the results of the limit states of ``[fragility] limit_states``.

    Examples
    --------
    >>> limit_state_names(["uplift", 0.1, 1.0, "overturning"])
    ['uplift', '0.1', '1', 'overturning']
    """
    return [state if isinstance(state, str) else f"{state:g}" for state in states]


def scale_capacities(
    scene: Scene, block: Block, states: Sequence[str | float], equation: str, factor_max: float, points: int
) -> Capacities:
    """Incremental dynamic analysis of one record: the first factor at which each limit state is reached.

    The `states` are "uplift", values of theta_max/alpha_c, and "overturning"; `equation` is the model by that equation;
    each of the (m,) lanes of the block is scanned at `points` factors up to `factor_max`. Uplift is known in closed
    form. A factor that the model cannot resolve (free flight) counts as reached.
    """
    record = scene.record
    solved, vertical = _acting(scene, equation)
    capacities, step = np.empty((len(states), *block.shape)), np.ones(block.shape)
    for row, state in enumerate(states):
        if state == UPLIFT:
            factor = uplift_scale(block, record.acceleration, solved, vertical)
        else:
            found = critical_scale(
                block,
                record.acceleration,
                record.dt,
                equation=solved,
                vertical=vertical,
                level=None if state == OVERTURNING else float(state),
                factor_max=factor_max,
                points=points,
            )
            factor, step = found.safety_factor, found.step
        capacities[row] = np.where(factor <= factor_max, factor, np.inf)
    return Capacities(capacities, step)


def reached_at(
    scene: Scene, block: Block, states: Sequence[str | float], equation: str, factors: np.ndarray
) -> np.ndarray:
    """Whether a record reaches the states of :func:`scale_capacities` at given factors (r, m), r for each lane.

    The answer (s, r, m) is 1 for reached, 0 for not, :data:`NOT_KNOWN` where the model cannot say.
    """
    record = scene.record
    solved, vertical = _acting(scene, equation)
    lifted = uplift_scale(block, record.acceleration, solved, vertical)
    reached = np.empty((len(states), *factors.shape), dtype=np.int8)
    for column, own in enumerate(factors):
        response = recorded_response(
            block,
            record.acceleration,
            record.dt,
            equation=solved,
            vertical=vertical,
            block_scale=own,
        )
        overturned = np.equal(response.outcome, Outcome.OVERTURNS)
        known = np.not_equal(response.outcome, Outcome.UNRESOLVED)
        for row, state in enumerate(states):
            if state == UPLIFT:
                reached[row, column] = own > lifted
            else:
                over = overturned if state == OVERTURNING else np.asarray(response.peak_rotation_ratio) >= float(state)
                reached[row, column] = np.where(known, over, NOT_KNOWN)
    return reached


def _acting(scene: Scene, model: str) -> tuple[Equation, np.ndarray | None]:
    """The equation of motion of a model, and the vertical acceleration that acts by it."""
    equation = MODELS[model].equation
    assert equation is not None
    return equation, MODELS[model].vertical_of(scene)
