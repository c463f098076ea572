"""Likelihood of a sequence given a set of targets, and search for the most likely sequence and similar ones.

.. note:: ln(target/peak) is normal with mean 0 and spread s; censored targets enter with the normal distribution
   function. With h = 1/s, n numbers of residuals r_j and censored ones with margins c_j (positive where satisfied)

       l(h) = n ln h - h^2/2 sum r_j^2 + sum ln Phi(h c_j) - n/2 ln(2 pi),

   which is concave in h (Olsen 1978), so that Newton's iteration finds its only maximum. In the parameters of the
   sequence the likelihood jumps, so the search takes no derivative: differential evolution and a survey of the whole
   space, then rounds of candidates from the best of every cell of the space. All are kept for the profiles.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution
from scipy.special import log_ndtr
from scipy.stats import qmc

from laboratory.site.response_targets import ResponseTargets
from rocking.impulses.impulse_sequence import ImpulseSequence

#: No sequence is taken to be better than this [-], 1 % of a peak; rounds of Newton's iteration, which converges
#: quadratically from the spread of the numbers alone.
SMALLEST_SPREAD, NEWTON_ROUNDS = 0.01, 12


def log_likelihood(peaks: np.ndarray, targets: ResponseTargets) -> tuple[np.ndarray, np.ndarray]:
    """Log-likelihood (q,) of the peaks (q, m) [-] of sequences, maximal over the spread s, and that spread (q,) [-].

    A block that a sequence overturns (inf) reaches at least 1: a target takes the value from there up that suits it
    best (Olsen 1978, doi:10.2307/1911445).
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
    for _ in range(NEWTON_ROUNDS if margins.shape[1] else 0):
        z = h[:, np.newaxis] * margins
        ratio = np.exp(-0.5 * z**2 - 0.5 * math.log(2.0 * math.pi) - log_ndtr(z))
        slope = count / h - h * squares + np.sum(margins * ratio, axis=1)
        curvature = -count / h**2 - squares - np.sum(margins**2 * ratio * (ratio + z), axis=1)
        h = np.clip(h - slope / curvature, 0.5 * h, np.minimum(2.0 * h, sharpest))
    likelihood = count * (np.log(h) - 0.5 * math.log(2.0 * math.pi)) - 0.5 * h**2 * squares
    likelihood += np.sum(log_ndtr(h[:, np.newaxis] * margins), axis=1)
    return likelihood, 1.0 / h


#: Columns of a point: ln of I over what the targets ask for, I_s/I [-], ln dT [s], number of main impulses.
OFFSET, RATIO, INTERVAL, MAIN_COUNT = range(4)
#: Largest number of main impulses [-], and secondary intervals [s] (half-waves of 10 Hz to 0.25 Hz), unless the start
#: widens them; and range in which I is searched about the value that the targets ask for, as ln.
MOST_MAIN, INTERVALS, OFFSETS = 20, (0.05, 2.0), (-1.0, 1.0)
#: Largest I_s/I by spacing: above it the closed form stands for no motion of the block (ground contact).
LARGEST_RATIO = {"start": 2.0 / 3.0, "middle": 6.0 / 7.0}
#: Differential evolution: candidates a generation for each parameter, most generations, spread of ln L to stop at.
POPULATION, GENERATIONS, SETTLED = 10, 15, 0.05
#: Candidates of the survey of the whole space, of each later round, and rounds.
SURVEY, CANDIDATES, ROUNDS = 512, 256, 20
#: Parents of the first round: points less likely than the best by this deviance; it falls in equal ratios to the last.
#: The best of every cell of I_s/I and dT, for each main count, is a parent. Steps of a candidate from it, as shares of
#: the difference of two other points and of the likely range.
WIDEST, CELLS, STEPS = 300.0, (16.0, 12.0), (0.1, 0.3, 1.0)


@dataclass(frozen=True, eq=False)
class SearchSpace:
    """The space of the sequences that are searched."""

    low: np.ndarray  # (4,) lower limits of a point
    high: np.ndarray  # (4,) upper limits of a point
    duration: float  # of every sequence [s]
    spacing: str  # of every sequence
    demands: np.ndarray  # (k,) v I_1c of the blocks whose peak is a number [m/s]
    restitutions: np.ndarray  # (k,) C of the same blocks [-]

    def asked_for(self, points: np.ndarray) -> np.ndarray:
        """I (q,) [m/s] that the targets ask for at the I_s/I and main count of (q, 4) points, in closed form.

        With many secondary impulses the N-th half-cycle peaks as if it had started with v = (I/I_1c) [1 - sigma/2 + (1
        - sigma) (C + ... + C^(N-1))], so a target v I_1c asks for that I; here the median of all.
        """
        ratio, count = points[:, RATIO, np.newaxis], points[:, MAIN_COUNT, np.newaxis]
        c = np.minimum(self.restitutions, 1.0 - 1e-9)
        powers = c * (1.0 - c ** (count - 1.0)) / (1.0 - c)
        return np.exp(np.median(np.log(self.demands / (1.0 - 0.5 * ratio + (1.0 - ratio) * powers)), axis=1))

    def main(self, points: np.ndarray) -> np.ndarray:
        """(q,) I [m/s] of (q, 4) points."""
        return np.asarray(np.exp(points[:, OFFSET]) * self.asked_for(points))

    def sequences(self, points: np.ndarray) -> ImpulseSequence:
        """(q,) sequences of (q, 4) points."""
        main = self.main(points)
        return ImpulseSequence(
            main=main,
            secondary=np.minimum(points[:, RATIO] * main, main),
            interval=np.nan if self.spacing == "continuous" else np.exp(points[:, INTERVAL]),
            duration=self.duration,
            main_count=np.rint(points[:, MAIN_COUNT]).astype(np.int64),
            spacing=self.spacing,
        )

    def sequence(self, point: np.ndarray) -> ImpulseSequence:
        """One sequence of a (4,) point."""
        many = self.sequences(point[np.newaxis])
        numbers = {
            name: np.ravel(getattr(many, name)).item() for name in ("main", "secondary", "interval", "main_count")
        }
        return ImpulseSequence(**numbers, duration=self.duration, spacing=self.spacing)

    def point(self, main: float, ratio: float, interval: float, main_count: int) -> np.ndarray:
        """The (4,) point of a sequence."""
        point = np.array([np.nan, ratio, np.log(interval), main_count])
        point[OFFSET] = np.log(main / self.asked_for(point[np.newaxis]).item())
        return point


def search_space(targets: ResponseTargets, start: ImpulseSequence | None, spacing: str) -> SearchSpace:
    """The space for targets and the duration of a start, whose other parameters widen the limits.

    A peak x is reached by the velocity v = sqrt(1 - (1 - x)^2) (Eq. 6), so the demand on a block is v I_1c.
    """
    peak = np.minimum(targets.peaks[targets.number], 1.0)
    demands = np.sqrt(1.0 - (1.0 - peak) ** 2) * np.asarray(targets.blocks.critical_impulse)[targets.number]
    (shortest, longest), most = INTERVALS, MOST_MAIN
    if start is not None:
        if np.isfinite(interval := float(start.interval)):
            shortest, longest = min(shortest, interval), max(longest, interval)
        most = max(most, int(start.main_count or 0))
    low = np.array([OFFSETS[0], 0.0, np.log(shortest), 1.0])
    high = np.array([OFFSETS[1], LARGEST_RATIO.get(spacing, 1.0), np.log(longest), float(most)])
    if spacing == "continuous":
        low[INTERVAL] = high[INTERVAL] = 0.0
    duration = np.inf if start is None else float(start.duration)
    restitutions = np.asarray(targets.blocks.restitution)[targets.number]
    space = SearchSpace(low, high, duration, spacing, demands, restitutions)
    if start is not None and start.main > 0.0:
        offset = start_point(space, start)[OFFSET]
        low[OFFSET], high[OFFSET] = min(low[OFFSET], offset), max(high[OFFSET], offset)
    return space


def start_point(space: SearchSpace, start: ImpulseSequence) -> np.ndarray:
    """The point nearest to a start: without a main count it has the largest, without an interval the middle one."""
    main = float(start.main)
    ratio = min(float(start.secondary) / main, float(space.high[RATIO]))
    middle = float(np.exp(0.5 * (space.low[INTERVAL] + space.high[INTERVAL])))
    known = np.isfinite(start.interval) and space.spacing != "continuous"
    interval = float(start.interval) if known else middle
    return space.point(main, ratio, interval, int(start.main_count or space.high[MAIN_COUNT]))


class Explored:
    """All k candidates of a space that were tried: points (k, 4), log-likelihoods (k,) and likeliest spreads (k,)."""

    def __init__(self, targets: ResponseTargets, space: SearchSpace, threads: int | None) -> None:
        self.targets, self.space, self.threads = targets, space, threads
        self.points, self.likelihood, self.spread = np.empty((0, 4)), np.empty(0), np.empty(0)

    def peaks(self, points: np.ndarray) -> np.ndarray:
        """(q, m) peaks of (q, 4) points [-]."""
        return self.targets.reached(self.space.sequences(points), self.threads)

    def try_points(self, points: np.ndarray) -> np.ndarray:
        """(q,) log-likelihoods of (q, 4) points, which are kept."""
        likelihood, spread = log_likelihood(self.peaks(points), self.targets)
        self.points = np.concatenate([self.points, points])
        self.likelihood = np.concatenate([self.likelihood, likelihood])
        self.spread = np.concatenate([self.spread, spread])
        return likelihood

    def best(self, limits: dict[str, tuple[float, float]], values: dict[str, np.ndarray]) -> int:
        """Index of the likeliest candidate within limits, or of the first one, the start, where that is likelier."""
        inside = np.ones(len(self.likelihood), dtype=bool)
        for name, (low, high) in limits.items():
            inside &= np.isnan(values[name]) | ((values[name] >= low) & (values[name] <= high))
        inside[0] = True
        return int(np.argmax(np.where(inside, self.likelihood, -np.inf)))


def explore(
    targets: ResponseTargets,
    space: SearchSpace,
    start: np.ndarray | None,
    enough: float,
    rng: np.random.Generator,
    threads: int | None = None,
) -> Explored:
    """Find the likeliest sequence, from a `start` (4,), and those within the deviance `enough` of it."""
    explored = Explored(targets, space, threads)
    # The start itself first: differential evolution maps it to the unit cube and back, which costs a bit.
    if start is not None:
        explored.try_points(start[np.newaxis])
    differential_evolution(
        lambda columns: -explored.try_points(np.ascontiguousarray(columns.T)),
        list(zip(space.low, space.high, strict=True)),
        x0=None if start is None else np.clip(start, space.low, space.high),
        integrality=[False, False, False, True],
        popsize=POPULATION,
        maxiter=GENERATIONS,
        tol=0.0,
        atol=SETTLED,
        mutation=(0.4, 0.9),
        recombination=0.9,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=rng,
    )
    survey = space.low + qmc.Sobol(4, rng=rng).random(SURVEY) * (space.high - space.low)
    # Few main impulses differ more from one another than many do: equal shares of the logarithm.
    share = (survey[:, MAIN_COUNT] - 1.0) / (space.high[MAIN_COUNT] - 1.0)
    survey[:, MAIN_COUNT] = np.minimum(np.floor((space.high[MAIN_COUNT] + 1.0) ** share), space.high[MAIN_COUNT])
    explored.try_points(survey)
    for cut in np.geomspace(WIDEST, enough, ROUNDS):
        explored.try_points(_offspring(explored, cut, rng))
    return explored


def _offspring(explored: Explored, cut: float, rng: np.random.Generator) -> np.ndarray:
    space = explored.space
    points, likelihood = explored.points, explored.likelihood
    deviance = 2.0 * (likelihood.max() - likelihood)
    order = np.argsort(deviance, kind="stable")
    order = order[: max(np.count_nonzero(deviance <= cut), 24)]
    points = points[order]
    # The best of every cell of the space, and as many of all that are likely: the whole likely region has parents.
    width = np.where(space.high > space.low, space.high - space.low, 1.0) * (1.0 + 1e-12)
    places = ((points - space.low) / width)[:, [RATIO, INTERVAL]]
    cells = np.column_stack([np.floor(places * CELLS), points[:, MAIN_COUNT]])
    _, firsts = np.unique(cells, axis=0, return_index=True)
    parents = np.concatenate([rng.choice(firsts, CANDIDATES // 2), rng.integers(len(points), size=CANDIDATES // 2)])
    one, other = rng.integers(len(points), size=(2, CANDIDATES))
    step = rng.choice(STEPS, size=(CANDIDATES, 1))
    drawn = points[parents] + step * (points[one] - points[other])
    drawn += step * 0.1 * np.std(points, axis=0) * rng.standard_normal(drawn.shape)
    drawn[:, MAIN_COUNT] = points[parents, MAIN_COUNT] + rng.choice([-1, 0, 0, 0, 1], size=CANDIDATES)
    # Points that leave the space are reflected at its edge.
    drawn = np.where(drawn < space.low, 2.0 * space.low - drawn, drawn)
    drawn = np.where(drawn > space.high, 2.0 * space.high - drawn, drawn)
    return np.clip(drawn, space.low, space.high)
