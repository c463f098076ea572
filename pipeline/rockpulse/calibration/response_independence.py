"""The number of independent observations for which the blocks of a family stand.

.. note:: The response of a block to a record differs from that to a sequence in the same way as that of a similar
   block: residuals are alike along p, alpha_c and C, and a finer family adds peaks but no information. A likelihood
   that takes them as independent makes intervals too narrow; its logarithm is multiplied by the share found here.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from rockpulse.calibration.response_targets import ResponseTargets

__all__ = ["independent_share"]

#: One-sided level of the test on the correlation, as normal deviate.
SIGNIFICANT = 1.645

#: Largest correlation that is taken at its word.
LARGEST = 0.9


def independent_share(targets: ResponseTargets, peaks: np.ndarray) -> tuple[float, float]:
    """Share of the numbers that are independent observations, from the likeness of neighbours, and their correlation r.

    `peaks` (m,) are theta_max/alpha_c of a sequence on the blocks of the targets [-]. The share is (1 - r)/(1 + r), at
    most 1, and 1 where r is not significant at 5 %. r is that of the residuals of each block with those of the block
    nearest to it in (ln p, ln alpha_c, C), each over its standard deviation; about zero, which is where they should be.

    Notes
    -----
    (1 - r)/(1 + r) is the ratio of effective to nominal sample size of a chain with correlation r between neighbours.
    A family has neighbours in three directions, so the true share is smaller still.

    References
    ----------
    Clifford, P., Richardson, S., Hémon, D. (1989), Biometrics 45(1), 123-134, doi:10.2307/2532039.
    """
    number = targets.number
    residuals = targets.residuals(peaks[np.newaxis])[0, number]
    blocks = targets.blocks
    place = np.column_stack([np.log(blocks.p), np.log(blocks.alpha_c), blocks.restitution])[number]
    deviation = np.std(place, axis=0)
    place = place / np.where(deviation > 0.0, deviation, 1.0)
    _, order = cKDTree(place).query(place, k=2)
    # Where two blocks lie in one place, either may be found as the nearest to itself.
    itself = np.arange(len(place))
    neighbour = np.where(order[:, 0] == itself, order[:, 1], order[:, 0])
    near = residuals[neighbour]
    scale = float(np.sqrt(np.sum(residuals**2) * np.sum(near**2)))
    correlation = float(np.sum(residuals * near)) / scale if scale > 0.0 else 0.0
    # A pair in which each is the other's neighbour stands twice in the sum.
    twice = np.count_nonzero(neighbour[neighbour] == itself)
    if correlation < SIGNIFICANT * np.sqrt(residuals.size + twice) / residuals.size:
        return 1.0, correlation
    taken = min(correlation, LARGEST)
    return (1.0 - taken) / (1.0 + taken), correlation
