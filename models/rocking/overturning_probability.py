"""The probability of overturning of any body under a record, by nonlinear marches of its own.

.. note:: P(f) is the probability that a body overturns under the record times f, its restitution, its angle and the
   factor being known as an :class:`rocking.uncertainty.Uncertainty` tells. Its lanes (:mod:`rocking.probability_lanes`)
   need no similarity: the body may be squat, and the vertical may act. The intervals draw the lanes again, with
   replacement and as if they were independent; lanes of a Sobol set scatter less than that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from rocking.arguments import numbers, positive
from rocking.block import Block
from rocking.lane_factors import LEVEL_STEP, lane_factors
from rocking.lane_march import REACH, LaneMarch
from rocking.overturning_spectrum import OverturningFactors
from rocking.probability_lanes import probability_lanes
from rocking.quantities import ArrayLike
from rocking.recorded import recorded_response
from rocking.uncertainty import Uncertainty

__all__ = ["OverturningProbability", "overturning_probability"]

#: A largest factor that is a level counts as one, and a share of a C of 1 as no more than 1, however they are rounded.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class OverturningProbability(OverturningFactors):
    """Probability of overturning of (m,) bodies over the factor on a record, by lanes of their own.

    Attributes
    ----------
    level : (k,) ndarray
        Factors on the record, ascending, from where the weakest draw lifts off; 1 is one of them.
    probability : (m, k) ndarray
        Probability of overturning at the levels, fitted so that it never falls [-].
    unresolved : (m,) ndarray
        Share of the lanes that the equation cannot answer (free flight); they count as overturning [-].
    """

    level: np.ndarray
    probability: np.ndarray
    unresolved: np.ndarray

    def overturning(self, factor: ArrayLike) -> np.ndarray:
        """Probability of overturning at some factors (m, d) on the record, linear in ln f between the levels [-]."""
        rows = zip(np.log(np.asarray(factor, dtype=float)), self.probability, strict=True)
        return np.array([np.interp(one, np.log(self.level), own) for one, own in rows])


def overturning_probability(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    uncertainty: Uncertainty | None = None,
    vertical: ArrayLike | None = None,
    factor_max: float = 10.0,
    *,
    least: ArrayLike | None = None,
    most: ArrayLike | None = None,
    guess: ArrayLike | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> OverturningProbability:
    """Probability that bodies overturn under a record times a factor, by the nonlinear equation.

    Parameters
    ----------
    block : Block
        One body, which counts as (1,), or (m,) of them: the nominal ones.
    acceleration : (n,) array_like
        Horizontal ground acceleration a_g [m/s2], as for :func:`~rocking.recorded_response`.
    dt : float
        Sampling interval [s].
    uncertainty : Uncertainty, optional
        Of factor, restitution and geometry; the default one without.
    vertical : (n,) array_like, optional
        Vertical ground acceleration a_v [m/s2], positive up. The factor is on both.
    factor_max : float
        Largest factor that is asked for [-].
    least, most : (m,) array_like, optional
        C between which that of a draw is uniform [-], where a body has a range of its own; the shares of its nominal
        C that the uncertainty tells without. A draw is at most 0.999.
    guess : (m,) array_like, optional
        Factor near which a body may overturn [-]. It saves lanes where it is good and costs some where it is not.
    seed : int
        Of the draws, not negative.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The answer does not depend on it.

    Returns
    -------
    OverturningProbability
        Of (m,) bodies. A factor that is not reached by `factor_max` is inf with a `_low` of `factor_max`, or, of
        `capacity_mean`, of what it is at least.

    Raises
    ------
    ValueError
        For a range of C outside 0 to 1, a guess or a factor_max that is not positive, a negative seed, and what
        :func:`~rocking.recorded_response` refuses.

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> found = overturning_probability(block, sine, 0.01)
    >>> found.factor_10.round(1).tolist(), found.factor_50.round(1).tolist()  # the exact block overturns from 3.21 on
    ([2.7], [3.1])
    """
    uncertainty = uncertainty or Uncertainty()
    blocks = block if block.shape else block.lanes(1)
    # A record at factor zero lifts nothing: this has the arguments checked before anything is made of them.
    recorded_response(blocks, acceleration, dt, scale=0.0, vertical=vertical, threads=threads)
    ground = np.ascontiguousarray(acceleration, dtype=float)
    up = None if vertical is None else np.ascontiguousarray(vertical, dtype=float)
    limit = float(positive("factor_max", factor_max, "of the record", lanes=False))
    nominal = np.asarray(blocks.restitution)
    low, high = (
        np.broadcast_to(share * nominal if given is None else numbers(name, given, "a C from 0 to 1"), nominal.shape)
        for name, given, share in zip(("least", "most"), (least, most), uncertainty.restitution, strict=True)
    )
    if not (np.all(low >= 0.0) and np.all(low <= high) and np.all(high <= 1.0 + ROUNDING)):
        raise ValueError(f"least, most: expected 0 <= least <= most <= 1, got {least!r:.80} and {most!r:.80}")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed: expected a whole number of at least 0, got {seed!r}")
    near = None if guess is None else np.broadcast_to(positive("guess", guess, "of the record"), nominal.shape)
    # P at the largest factor, and at 1, takes lanes beyond it, as far as a draw of the factor reaches.
    log_max = max(math.log(limit), 0.0)
    reach = REACH * uncertainty.factor
    march = LaneMarch(blocks, ground, float(dt), up, uncertainty, low, high, int(seed), threads)
    bottom, lanes = probability_lanes(march, log_max + reach, near)
    shift = Uncertainty(factor=uncertainty.factor, geometry=0.0)
    rows = [lane_factors(one, shift, reach, limit) for one in lanes]
    highest = min(max((one.top + reach for one in lanes if one is not None), default=0.0), log_max)
    first = math.floor(min(float(np.min(bottom)) - reach, 0.0) / LEVEL_STEP)
    places = np.arange(first, max(math.floor(highest / LEVEL_STEP + ROUNDING), 0) + 1)
    return OverturningProbability(
        **{one.name: np.array([row.found[one.name] for row in rows]) for one in fields(OverturningFactors)},
        level=np.exp(LEVEL_STEP * places),
        probability=np.array([row.at(places) for row in rows]),
        unresolved=np.array([0.0 if one is None else float(np.mean(one.unresolved)) for one in lanes]),
    )
