"""The posterior probability of sequences given the targets: weighted samples by adaptive importance sampling.

.. note:: The likelihood jumps wherever the number of secondary impulses of a block changes, so a deviance is not
   chi-squared distributed and the interval that it would cut off is too narrow (docs/decisions/010). The posterior
   needs no smoothness. The prior is flat in ln I, I_s/I, ln dT and the number of main impulses, within the limits of
   the search, and in ln of the spread.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from rockpulse.calibration.response_search import MAIN_COUNT, Explored

__all__ = ["Posterior", "sample_posterior"]

#: Powers of the likelihood from round to round: the first proposals are wider than the posterior.
TEMPERED = (0.2, 0.4, 0.7, 1.0, 1.0, 1.0)

#: Effective samples from which on the sampling ends, and most rounds that are added to reach them. With fewer than 50
#: a narrow mode had been met by one or two candidates, which then were the whole posterior.
ENOUGH, ADDED = 200.0, 12

#: Candidates a round, and centres of the kernels they are drawn from.
DRAWN, CENTRES = 512, 192

#: Probability of the steps in the number of main impulses; 0 at last.
STEPS = {-1: 0.15, 0: 0.7, 1: 0.15}

#: Widths of the kernels over the standard deviations of the cloud of their number of main impulses. Silverman's 0.45
#: for three dimensions is for smooth densities: narrow ones follow the edges, wide ones leave no holes.
WIDTHS = (0.25, 0.75)

#: Share of a kernel's width that is never gone below, of the searched range.
NARROWEST = 1e-4


@dataclass(frozen=True, eq=False)
class Posterior:
    """Weighted samples of the posterior."""

    points: np.ndarray  # (k, 4), as in :class:`rockpulse.calibration.response_search.SearchSpace`
    weights: np.ndarray  # (k,) that sum to 1

    @property
    def effective(self) -> float:
        """Effective number of samples 1/sum of the squared weights [-]."""
        return float(1.0 / np.sum(self.weights**2))

    def quantiles(self, values: np.ndarray, levels: np.ndarray) -> np.ndarray:
        """Weighted quantiles of a quantity with one value for each sample: (l,) for (k,) values and (l,) levels."""
        order = np.argsort(values, kind="stable")
        reached = np.cumsum(self.weights[order])
        return np.asarray(values[order][np.searchsorted(reached, np.asarray(levels) * reached[-1])])


class _Kernels:
    """A mixture of normal kernels in the continuous parameters, with steps of the number of main impulses."""

    def __init__(self, points: np.ndarray, weights: np.ndarray, explored: Explored, rng: np.random.Generator) -> None:
        space = explored.space
        self.space = space
        self.free = np.flatnonzero((space.high > space.low)[:MAIN_COUNT])
        self.centres = points[rng.choice(len(points), size=CENTRES, p=weights)]
        self.widths = rng.choice(WIDTHS, size=CENTRES)
        self.factors: dict[float, np.ndarray] = {}
        least = np.diag((NARROWEST * (space.high - space.low)[self.free]) ** 2)
        whole = np.atleast_2d(np.cov(points[:, self.free].T, aweights=weights))
        for count in np.unique(self.centres[:, MAIN_COUNT]):
            here = points[:, MAIN_COUNT] == count
            share = weights[here] / weights[here].sum()
            enough = 1.0 / np.sum(share**2) > 2.0 * self.free.size
            own = np.atleast_2d(np.cov(points[here][:, self.free].T, aweights=share)) if enough else 0.25 * whole
            self.factors[count] = np.linalg.cholesky(own + least)

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """(DRAWN, 4) points, those outside of the space left in."""
        kernels = rng.integers(CENTRES, size=DRAWN)
        drawn = self.centres[kernels]
        factors = np.stack([self.factors[count] for count in drawn[:, MAIN_COUNT]])
        steps = self.widths[kernels, np.newaxis] * rng.standard_normal((DRAWN, self.free.size))
        drawn[:, self.free] += np.einsum("kij,kj->ki", factors, steps)
        drawn[:, MAIN_COUNT] += rng.choice(list(STEPS), size=DRAWN, p=list(STEPS.values()))
        return drawn

    def log_density(self, points: np.ndarray) -> np.ndarray:
        """(k,) ln of the density of (k, 4) points, but for a constant that all mixtures share."""
        terms = np.full((len(points), CENTRES), -np.inf)
        for count, factor in self.factors.items():
            kernels = np.flatnonzero(self.centres[:, MAIN_COUNT] == count)
            inverse = np.linalg.inv(factor)
            scaled, centres = points[:, self.free] @ inverse.T, self.centres[kernels][:, self.free] @ inverse.T
            square = np.sum((scaled[:, np.newaxis] - centres) ** 2, axis=2) / self.widths[kernels] ** 2
            steps = points[:, MAIN_COUNT] - count
            probability = sum(np.where(steps == step, share, 0.0) for step, share in STEPS.items())
            level = -np.sum(np.log(np.diag(factor))) - self.free.size * np.log(self.widths[kernels])
            with np.errstate(divide="ignore"):
                terms[:, kernels] = np.log(probability)[:, np.newaxis] + level - 0.5 * square
        return np.asarray(logsumexp(terms, axis=1))


def sample_posterior(explored: Explored, rng: np.random.Generator, share: float = 1.0) -> Posterior:
    """Sample the posterior, starting from a finished search; the samples are added to it.

    `share` is the factor on ln of the likelihood [-]. Only samples inside the space are returned.

    Notes
    -----
    Population Monte Carlo: each round draws from normal kernels about the points that the rounds before found likely,
    and all rounds share one weight, likelihood over the mean of all their densities (the balance heuristic). Rounds
    are added while fewer than 200 samples are effective, at most 12.

    References
    ----------
    Cappé, O., Guillin, A., Marin, J.-M., Robert, C. P. (2004), J. Comput. Graph. Stat. 13(4), 907-929.
    Veach, E., Guibas, L. J. (1995), SIGGRAPH '95, 419-428.
    """
    space = explored.space
    points = explored.points
    log_weights = share * explored.likelihood
    kernels: list[_Kernels] = []
    drawn, likelihood, densities = np.empty((0, points.shape[1])), np.empty(0), np.empty(0)
    for power in (*TEMPERED, *[1.0] * ADDED):
        kernels.append(_Kernels(points, _normal(power * log_weights), explored, rng))
        candidates = kernels[-1].draw(rng)
        candidates = candidates[np.all((candidates >= space.low) & (candidates <= space.high), axis=1)]
        densities = np.concatenate(
            [
                np.logaddexp(densities, kernels[-1].log_density(drawn)),
                logsumexp([one.log_density(candidates) for one in kernels], axis=0),
            ]
        )
        drawn = np.concatenate([drawn, candidates])
        likelihood = np.concatenate([likelihood, explored.try_points(candidates)])
        points, log_weights = drawn, share * likelihood - densities
        posterior = Posterior(drawn, _normal(log_weights))
        if len(kernels) >= len(TEMPERED) and posterior.effective >= ENOUGH:
            break
    return posterior


def _normal(log_weights: np.ndarray) -> np.ndarray:
    return np.asarray(np.exp(log_weights - logsumexp(log_weights)))
