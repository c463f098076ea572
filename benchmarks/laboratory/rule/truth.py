"""The target of the rule: capacity of bodies under a record by the nonlinear equation, with the stated uncertainty.

.. note:: Every body has separate marches: a scrambled Sobol set over restitution, reduction of the angle and ln f, each
   with its exact scale factor. The uncertainty of the scale factor is a normal kernel in ln f
   (:mod:`rocking.spectrum.probability`). Similarity is not assumed.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rocking.spectrum.probability import (
    Uncertainty,
    factor_at,
    lane_bells,
    lane_probability,
    mean_capacity,
    rising,
    tail_masses,
)

#: Lanes of a body. Against 4096 others the mean capacity scatters by 2 %, the factor of 10 % by 3 % (67 channels).
LANES = 1024
#: Largest factor on a record that is asked for [-].
FACTOR_MAX = 10.0
#: Ratio of neighbouring levels of the factor, as its logarithm.
LEVEL_STEP = 0.02
#: Standard deviations of the factor that the lanes reach beyond the first and the last level.
REACH = 4.0
SEED = 2017


class Marches(NamedTuple):
    """Marches of one body by the nonlinear equation with random restitution, angle and scale factor."""

    log_factor: np.ndarray  # (n,) ln of the scale factor, uniform from `bottom` to `top`
    over: np.ndarray  # (n,) bool: the march overturns
    bottom: float
    top: float

    @property
    def safe_length(self) -> float:
        """The scale factor exp(bottom + length of ln f in which marches survive) [-]."""
        return math.exp(self.bottom + (self.top - self.bottom) * float(np.mean(~self.over)))


def exact_marches(
    body: Block, ground: np.ndarray, dt: float, uncertainty: Uncertainty, count: int = LANES, seed: int = SEED
) -> Marches:
    """March one body by the nonlinear equation, from below its uplift to above :data:`FACTOR_MAX`."""
    draws = qmc.Sobol(3, seed=seed).random(count)
    reach, last = REACH * uncertainty.factor, math.log(FACTOR_MAX)
    alpha = body.alpha_c * np.exp(-uncertainty.geometry * ndtri(0.5 + 0.5 * draws[:, 1]))
    uplift = math.log(body.gravity * np.min(np.tan(alpha)) / np.max(np.abs(ground)))
    bottom, top = min(uplift, last) - reach, last + reach
    log_factor = bottom + (top - bottom) * draws[:, 2]
    lanes = Block.from_parameters(
        p=np.full(count, body.p),
        alpha=alpha,
        restitution=uncertainty.restitutions(body.restitution, draws[:, 0]),
        gravity=body.gravity,
        log=False,
    )
    outcome = recorded_response(lanes, ground, dt, block_scale=np.exp(log_factor)).outcome
    return Marches(log_factor, (outcome == Outcome.OVERTURNS) | (outcome == Outcome.UNRESOLVED), bottom, top)


def nonlinear_capacity(
    bodies: Block, acceleration: np.ndarray, dt: float, uncertainty: Uncertainty | None = None
) -> dict[str, np.ndarray]:
    """Capacities (m,) of bodies [-], as factors on a record, under the default uncertainty or a given one.

    `factor_mean`, `factor_10` and `factor_50`, inf where not reached by :data:`FACTOR_MAX`; `factor_mean_low`, what
    the mean capacity is at least; `probability_half`, `probability_one`: of overturning at factors of 0.5 and 1. P is
    the weighted share of marches that overturn; only `factor_10` and `factor_50` use an isotonic fit of it.
    """
    uncertainty = uncertainty or Uncertainty()
    kernel = replace(uncertainty, geometry=0.0)
    ground = np.asarray(acceleration, dtype=float)
    last = math.log(FACTOR_MAX)
    rows = []
    for one in range(bodies.shape[0]):
        log_factor, over, bottom, top = exact_marches(bodies.lane(one), ground, dt, uncertainty)
        logs = np.append(np.arange(bottom, last, LEVEL_STEP), last)
        bells = lane_bells(log_factor, np.full(log_factor.size, (top - bottom) / log_factor.size), logs, kernel)
        share = lane_probability(over @ bells, np.sum(bells, axis=0), *tail_masses(bottom, top, logs, kernel))
        level, fitted = np.exp(logs), rising(share)
        rows.append(
            {
                "factor_mean": float(mean_capacity(level, share)),
                "factor_mean_low": math.exp(logs[0] + float(np.trapezoid(1.0 - share, logs))),
                "factor_10": float(factor_at(0.1, level, fitted)),
                "factor_50": float(factor_at(0.5, level, fitted)),
                "probability_half": float(np.interp(math.log(0.5), logs, share)),
                "probability_one": float(np.interp(0.0, logs, share)),
            }
        )
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
