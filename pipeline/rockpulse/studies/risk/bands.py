"""The band of an annual frequency over the earthquakes of its fragility, by the bootstrap-t.

.. note:: Records of one earthquake are no independent observations, so as many earthquakes are drawn again and again.
   Each draw has a frequency and, by leaving out one of its earthquakes after the other, a standard error; the quantiles
   of (ln lambda - its estimate)/standard error over the draws stand for those of the estimate itself. The hazard is
   taken as known. Efron, B., Tibshirani, R. (1993), An Introduction to the Bootstrap, chapter 12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp

from rockpulse.studies.fragility.curves import jackknife_error, standardised
from rockpulse.studies.fragility.likelihood import Family, maximise
from rockpulse.studies.fragility.observations import Observations
from rockpulse.studies.risk.hazard import Hazard

__all__ = ["FEWEST_EVENTS", "LEAST_EVENTS", "LOST", "Limits", "band_of", "fitted_lines", "quantiles"]

#: Fewest earthquakes from which a band covers what it says, and from which there is one.
LEAST_EVENTS, FEWEST_EVENTS = 14, 4

#: Largest share of the draws that may have no frequency, or none without one of their earthquakes.
LOST = 0.1

#: Capacities over which the frequencies of the draws are summed, as arguments of the family's distribution.
STEP = 0.1
CAPACITY = np.arange(-60.0, 40.0, STEP)


class Limits(NamedTuple):
    """The limits of a frequency, NaN where too many draws are lost, and the share of the draws that are."""

    low: float
    high: float
    lost: float


def fitted_lines(rows: Observations, family: Family) -> np.ndarray:
    """A and B (1 + events, 2) in ln of the level of the fits to all rows, and without each earthquake."""
    events = len(rows.events)
    return _lines(rows, family, np.vstack([np.ones(events), 1.0 - np.eye(events)]))


def _lines(rows: Observations, family: Family, weights: np.ndarray) -> np.ndarray:
    """A and B (q, 2) in ln of the level of the fits to q weightings (q, events) of the earthquakes; NaN without."""
    u, centre, spread = standardised(np.log(rows.level))
    theta = maximise(family, np.stack([np.ones(u.size), u], axis=1), rows.kind, weights[:, rows.cluster] * rows.weight)
    return np.stack([theta[:, 0] - theta[:, 1] * centre / spread, theta[:, 1] / spread], axis=1)


def _frequencies(family: Family, lines: np.ndarray, hazard: Hazard, floor: float) -> np.ndarray:
    """ln of the frequencies of q fits, to about 1e-4; NaN where there is no rising curve.

    As the mean of the hazard over the capacities, none below the floor: lambda = integral of H(exp((z - A)/B)) f(z) dz.
    """
    found = np.full(lines.shape[0], np.nan)
    rising = np.flatnonzero(lines[:, 1] > 0.0)
    density = family.log_density(CAPACITY)[0] + math.log(STEP)
    for part in np.array_split(rising, max(1, rising.size // 500)):
        a, b = lines[part, :1], lines[part, 1:]
        found[part] = logsumexp(hazard.log_rate(np.maximum((CAPACITY - a) / b, floor)) + density, axis=1)
    return found


def band_of(
    rows: Observations,
    family: Family,
    hazard: Hazard,
    lines: np.ndarray,
    estimate: float,
    confidence: float,
    resamples: int,
    seed: int,
    floor: float = -math.inf,
) -> Limits:
    """Limits of the frequency whose logarithm is the estimate; the lines are those of :func:`fitted_lines`.

    A draw is lost where it has no rising curve, or has none without one of its earthquakes: its standard error would
    miss what that earthquake does.
    """
    events = len(rows.events)
    error = jackknife_error(_frequencies(family, lines, hazard, floor)[:, np.newaxis])[0]
    counts = np.random.default_rng(seed).multinomial(events, np.full(events, 1.0 / events), size=resamples)
    fewer = np.maximum(counts[:, np.newaxis] - np.eye(events, dtype=int), 0)
    weights = np.concatenate([counts[:, np.newaxis], fewer], axis=1).reshape(-1, events)
    drawn = _frequencies(family, _lines(rows, family, weights), hazard, floor).reshape(resamples, -1)
    # What a draw would be without an earthquake that is not in it does not count.
    moved = np.where(counts > 0, drawn[:, 1:] - drawn[:, :1], 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.sqrt((events - 1) / events * np.sum(counts * moved**2, axis=1))
        return quantiles((drawn[:, 0] - estimate) / spread, estimate, error, confidence)


def quantiles(share: np.ndarray, estimate: float, error: float, confidence: float) -> Limits:
    """The limits exp(estimate - share error) by what (q,) draws say of (theirs - estimate)/error; NaN is a lost one."""
    known = share[np.isfinite(share)]
    lost = 1.0 - known.size / share.size
    if lost > LOST or not (np.isfinite(error) and error > 0.0):
        return Limits(math.nan, math.nan, lost)
    high, low = np.quantile(known, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
    return Limits(math.exp(estimate - low * error), math.exp(estimate - high * error), lost)
