"""Comparison of intensity measures by how much they say about capacity: efficiency and sufficiency.

.. note:: A measure is efficient where the capacities of the records in it scatter little (beta), and sufficient where
   they depend on nothing else of the record (Luco & Cornell 2007, doi:10.1193/1.2723158). The likelihood is that of
   the curve with one covariate more, z = a + b ln x + c ln u, so that capacities that are not known count too. Where
   only some records have a quality, as a magnitude that their files state, it is that of these records alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from rockpulse.storage.variables.fragility import Status
from rockpulse.studies.fragility.curves import Curve, half_width, jackknife_error, standardised
from rockpulse.studies.fragility.likelihood import FAMILIES, maximise
from rockpulse.studies.fragility.observations import Observations
from rockpulse.studies.fragility.statements import FEWEST_EVENTS, missing

__all__ = ["Sufficiency", "dispersion_ratio", "sufficiency"]


@dataclass(frozen=True)
class Sufficiency:
    """The dependence of capacity on a quality u of the record beside the measure."""

    slope: float  # d ln median/d ln u [-]; NaN where there is no fit
    p_value: float  # of a slope of zero, two-sided, by the jackknife over events; NaN with too few of them


def dispersion_ratio(curve: Curve, reference: Curve) -> tuple[float, float, float]:
    """beta over that of a reference measure for the same records [-], and its lower and upper confidence limit.

    NaN where one of the curves has no beta, limits also where one has no band. Both are jackknifed over the same
    events, so that the scatter they have in common cancels.
    """
    difference = curve.log_beta - reference.log_beta
    half = np.nan if curve.events < FEWEST_EVENTS else half_width(difference, curve.confidence)
    ratio, low, high = np.exp(difference[0] + np.array([0.0, -half, half]))
    return float(ratio), float(low), float(high)


def sufficiency(rows: Observations, column: int, model: str = "lognormal") -> Sufficiency:
    """The dependence of capacity in a measure on one of the record's qualities, for observations that have a curve.

    Of the records that have the quality; NaN where these have no curve.
    """
    nothing = Sufficiency(np.nan, np.nan)
    known = rows.having(column)
    if not np.all(known):
        rows = rows.only(known)
        if missing(rows) != Status.FITTED:
            return nothing
    u = np.log(rows.qualities[:, column])
    if np.ptp(u) == 0.0:
        return nothing
    x, _, spread = standardised(np.log(rows.level))
    quality, _, quality_spread = standardised(u)
    design = np.stack([np.ones(x.size), x, quality], axis=1)
    theta = maximise(FAMILIES[model], design, rows.kind, rows.without_each_event())
    slopes = -theta[:, 2] / theta[:, 1] * spread / quality_spread
    if not theta[0, 1] > 0.0:
        return nothing
    events = len(rows.events)
    if events < FEWEST_EVENTS or not np.all(theta[:, 1] > 0.0):
        return Sufficiency(float(slopes[0]), np.nan)
    statistic = abs(slopes[0]) / jackknife_error(slopes)
    return Sufficiency(float(slopes[0]), float(2.0 * stdtr(events - 1, -statistic)))
