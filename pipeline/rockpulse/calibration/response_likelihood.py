"""Likelihood of censored peaks, lognormal about those of a sequence, at the most likely spread.

.. note:: ln(target/peak) is normal with mean 0 and spread s; what is censored enters with the normal distribution
   function. With h = 1/s, n numbers of residuals r_j and censored ones with margins c_j (positive where satisfied)

       l(h) = n ln h - h^2/2 sum r_j^2 + sum ln Phi(h c_j) - n/2 ln(2 pi),

   which is concave in h (Olsen 1978), so that Newton's iteration finds its only maximum.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import log_ndtr

from rockpulse.calibration.response_targets import ResponseTargets

__all__ = ["SMALLEST_SPREAD", "log_likelihood"]

#: No sequence is taken to be better than this [-]: 1 % of a peak.
SMALLEST_SPREAD = 0.01

#: Rounds of Newton's iteration; it converges quadratically from the spread of the numbers alone.
ROUNDS = 12


def log_likelihood(peaks: np.ndarray, targets: ResponseTargets) -> tuple[np.ndarray, np.ndarray]:
    """Log-likelihood (q,) of sequences by their peaks (q, m) [-], maximal over the spread s, and that spread (q,) [-].

    The peaks are theta_max/alpha_c on the m blocks of the targets, inf where overturned; s is at least
    :data:`SMALLEST_SPREAD`. Of a block that a sequence overturns only "at least 1" is known; a target takes the value
    from there up that suits it best.

    References
    ----------
    Olsen, R. J. (1978), Econometrica 46(5), 1211-1215, doi:10.2307/1911445.
    """
    number = targets.residuals(peaks)[:, targets.number]
    with np.errstate(divide="ignore"):
        reached = np.log(np.maximum(peaks[:, targets.overturned], 1e-300))
        below = math.log(targets.smallest) - np.log(np.clip(peaks[:, targets.small], 1e-300, 1.0))
    # Certain at any spread; inf would make NaN of 0 times inf.
    margins = np.minimum(np.concatenate([reached, below], axis=1), 1e6)
    count, squares = number.shape[1], np.sum(number**2, axis=1)
    sharpest = 1.0 / SMALLEST_SPREAD
    h = np.minimum(np.sqrt(count / np.maximum(squares, count * SMALLEST_SPREAD**2)), sharpest)
    for _ in range(ROUNDS if margins.shape[1] else 0):
        z = h[:, np.newaxis] * margins
        ratio = np.exp(-0.5 * z**2 - 0.5 * math.log(2.0 * math.pi) - log_ndtr(z))
        slope = count / h - h * squares + np.sum(margins * ratio, axis=1)
        curvature = -count / h**2 - squares - np.sum(margins**2 * ratio * (ratio + z), axis=1)
        h = np.clip(h - slope / curvature, 0.5 * h, np.minimum(2.0 * h, sharpest))
    likelihood = count * (np.log(h) - 0.5 * math.log(2.0 * math.pi)) - 0.5 * h**2 * squares
    likelihood += np.sum(log_ndtr(h[:, np.newaxis] * margins), axis=1)
    return likelihood, 1.0 / h
