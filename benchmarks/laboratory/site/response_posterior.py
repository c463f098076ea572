"""The posterior probability of sequences given the targets, by adaptive importance sampling, and its summary.

The likelihood changes abruptly with the numbers of secondary impulses, so a deviance does not have a chi-squared
distribution (docs/decisions/010). The prior is flat in ln I, I_s/I, ln dT, the number of main impulses and ln of the
spread.
"""

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy import stats
from scipy.spatial import cKDTree
from scipy.special import logsumexp

from laboratory.site.response_search import INTERVAL, MAIN_COUNT, RATIO, Explored, SearchSpace
from laboratory.site.response_targets import ResponseTargets

#: Powers of the likelihood from round to round: the first proposals are wider than the posterior.
TEMPERED = (0.2, 0.4, 0.7, 1.0, 1.0, 1.0)
#: Effective samples that end the sampling (with fewer than 50 one or two candidates were the whole posterior), and most
#: rounds that are added to reach them; candidates a round, and centres of the kernels they are drawn from.
ENOUGH, ADDED, DRAWN, CENTRES = 200.0, 12, 512, 192
#: Probability of the steps in the number of main impulses; 0 at last.
COUNT_STEPS = {-1: 0.15, 0: 0.7, 1: 0.15}
#: Widths of the kernels over the standard deviations of the cloud of their number of main impulses (Silverman's 0.45 is
#: for smooth densities: narrow ones follow the edges, wide ones leave no holes), and the least share of the range.
WIDTHS, NARROWEST = (0.25, 0.75), 1e-4
#: Names, units and words of the parameters.
PARAMETERS = {
    "main": ("m/s", "main impulse"),
    "ratio": ("", "I_s/I"),
    "interval": ("s", "interval dT of the secondary impulses"),
    "main_count": ("", "number of main impulses"),
}
#: Parts into which the range of a profile is divided, and the deviance up to which it shows candidates.
PARTS, SHOWN = 24, 20.0
#: One-sided level of the test on a correlation, as normal deviate, and the largest correlation that is believed.
SIGNIFICANT, LARGEST = 1.645, 0.9


@dataclass(frozen=True, eq=False)
class Posterior:
    """Weighted samples of the posterior."""

    points: np.ndarray  # (k, 4), as in :class:`laboratory.site.response_search.SearchSpace`
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
        drawn[:, MAIN_COUNT] += rng.choice(list(COUNT_STEPS), size=DRAWN, p=list(COUNT_STEPS.values()))
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
            probability = sum(np.where(steps == step, share, 0.0) for step, share in COUNT_STEPS.items())
            level = -np.sum(np.log(np.diag(factor))) - self.free.size * np.log(self.widths[kernels])
            with np.errstate(divide="ignore"):
                terms[:, kernels] = np.log(probability)[:, np.newaxis] + level - 0.5 * square
        return np.asarray(logsumexp(terms, axis=1))


def sample_posterior(explored: Explored, rng: np.random.Generator, share: float = 1.0) -> Posterior:
    """Sample the posterior, ln L times `share`, from a finished search, to which the samples are added.

    Population Monte Carlo (Cappé et al. 2004, J. Comput. Graph. Stat. 13(4), 907-929): each round draws from kernels
    about likely points; the weight is likelihood over the mean of all densities (balance heuristic, Veach & Guibas
    1995).
    """
    space, points, log_weights = explored.space, explored.points, share * explored.likelihood
    kernels: list[_Kernels] = []
    drawn, likelihood, densities = np.empty((0, points.shape[1])), np.empty(0), np.empty(0)
    for power in (*TEMPERED, *[1.0] * ADDED):
        kernels.append(_Kernels(points, _normal(power * log_weights), explored, rng))
        candidates = kernels[-1].draw(rng)
        candidates = candidates[np.all((candidates >= space.low) & (candidates <= space.high), axis=1)]
        here = logsumexp([one.log_density(candidates) for one in kernels], axis=0)
        densities = np.concatenate([np.logaddexp(densities, kernels[-1].log_density(drawn)), here])
        drawn = np.concatenate([drawn, candidates])
        likelihood = np.concatenate([likelihood, explored.try_points(candidates)])
        points, log_weights = drawn, share * likelihood - densities
        posterior = Posterior(drawn, _normal(log_weights))
        if len(kernels) >= len(TEMPERED) and posterior.effective >= ENOUGH:
            break
    return posterior


def _normal(log_weights: np.ndarray) -> np.ndarray:
    return np.asarray(np.exp(log_weights - logsumexp(log_weights)))


def parameter_values(space: SearchSpace, points: np.ndarray) -> dict[str, np.ndarray]:
    """(q,) values of each parameter of (q, 4) points; dT is NaN where the spacing has none."""
    interval = np.exp(points[:, INTERVAL]) if space.spacing != "continuous" else np.full(len(points), np.nan)
    values = space.main(points), points[:, RATIO], interval, np.rint(points[:, MAIN_COUNT])
    return dict(zip(PARAMETERS, values, strict=True))


def _scale(name: str, values: np.ndarray) -> np.ndarray:
    """Values of a parameter on the scale that it is compared on: the logarithm of I and dT."""
    return np.log(values) if name in ("main", "interval") else values


def deviance_threshold(count: int, confidence: float) -> float:
    """Deviance within which one parameter is believed, for n peaks that are numbers and a confidence level [-].

    n ln(1 + t^2/(n - 4)), t two-sided of n - 4 degrees of freedom: exact for a linear model of four parameters and a
    spread.
    """
    free = count - len(PARAMETERS)
    return float(count * math.log1p(stats.t.ppf(0.5 * (1.0 + confidence), free) ** 2 / free))


def profiles(explored: Explored, share: float = 1.0) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Of each parameter rising values (k,) and the smallest deviance (k,) of a candidate there [-]."""
    points, likelihood = explored.points, explored.likelihood
    deviance = 2.0 * share * (likelihood.max() - likelihood)
    near = deviance <= SHOWN
    found = {}
    for name, values in parameter_values(explored.space, points[near]).items():
        if np.any(np.isnan(values)):
            found[name] = (np.empty(0), np.empty(0))
            continue
        scale = _scale(name, values)
        width = 1.0 if name == "main_count" else max(np.ptp(scale) / PARTS, 1e-12)
        part = np.floor((scale - scale.min()) / width)
        order = np.lexsort((deviance[near], part))
        best = order[np.unique(part[order], return_index=True)[1]]
        found[name] = (values[best], deviance[near][best])
    return found


def intervals(space: SearchSpace, posterior: Posterior, confidence: float) -> dict[str, tuple[float, float]]:
    """Central posterior interval of each parameter; NaN without dT, :func:`likeliest_counts` of the main count."""
    levels = np.array([0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)])
    values = parameter_values(space, posterior.points)
    found = {name: tuple(posterior.quantiles(one, levels).tolist()) for name, one in values.items()}
    return {**found, "main_count": likeliest_counts(main_counts(posterior), confidence)}


def likeliest_counts(shares: dict[int, float], confidence: float) -> tuple[float, float]:
    """Lowest and highest of the likeliest numbers whose joint probability is nearest to a level."""
    numbers, probabilities = np.array(list(shares)), np.array(list(shares.values()))
    order = np.argsort(-probabilities, kind="stable")
    nearest = np.argmin(np.abs(np.cumsum(probabilities[order]) - confidence))
    inside = numbers[order[: nearest + 1]]
    return float(inside.min()), float(inside.max())


def main_counts(posterior: Posterior) -> dict[int, float]:
    """Posterior probability of each number of main impulses that was sampled, the number rising."""
    numbers = np.rint(posterior.points[:, MAIN_COUNT]).astype(np.int64)
    shares = np.bincount(numbers, weights=posterior.weights)
    return {int(number): float(shares[number]) for number in np.unique(numbers)}


def flat_ends(explored: Explored, threshold: float, share: float = 1.0) -> dict[str, tuple[bool, bool]]:
    """Whether the likely values of I_s/I, dT and the main count reach the lower and the upper limit of the search."""
    space, points = explored.space, explored.points
    likely = points[2.0 * share * (explored.likelihood.max() - explored.likelihood) <= threshold]
    ends = {}
    for name, column in (("ratio", RATIO), ("interval", INTERVAL), ("main_count", MAIN_COUNT)):
        margin = 0.0 if column == MAIN_COUNT else (space.high[column] - space.low[column]) / PARTS
        low, high = space.low[column] + margin, space.high[column] - margin
        ends[name] = (bool(likely[:, column].min() <= low), bool(likely[:, column].max() >= high))
    return ends


def correlations(space: SearchSpace, posterior: Posterior) -> dict[tuple[str, str], float]:
    """Correlation of every two parameters in the posterior, of the logarithms of I and dT [-]."""
    values = parameter_values(space, posterior.points)
    columns = {name: _scale(name, value) for name, value in values.items() if not np.any(np.isnan(value))}
    matrix = np.cov(np.array(list(columns.values())), aweights=posterior.weights)
    deviation = np.sqrt(np.diag(matrix))
    found = {}
    for (i, one), (j, other) in combinations(enumerate(columns), 2):
        scale = deviation[j] * deviation[i]
        found[one, other] = float(matrix[j, i] / scale) if scale > 0.0 else 0.0
    return found


def independent_share(targets: ResponseTargets, peaks: np.ndarray) -> tuple[float, float]:
    """Share of the numbers that are independent observations, and the correlation r of neighbours.

    (1 - r)/(1 + r), or 1 where r is not significant at 5 % (Clifford et al. 1989, doi:10.2307/2532039). r is that of
    the residuals, about zero, of `peaks` (m,) with those of the nearest block in (ln p, ln alpha_c, C), each
    standardised.
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
