"""The likelihood of censored peaks, the space of sequences that is searched, and the rounds of the search."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import norm

from rockpulse.models import Block, ImpulseSequence, Outcome, sequence_response
from rockpulse.sequences import response_search
from rockpulse.sequences.response_search import (
    INTERVAL,
    RATIO,
    SMALLEST_SPREAD,
    Explored,
    SearchSpace,
    explore,
    log_likelihood,
    search_space,
    start_point,
)
from rockpulse.sequences.response_targets import ResponseTargets, block_family


def observed(numbers, overturned=0, small=0):
    peaks = np.concatenate([numbers, np.full(overturned, np.inf), np.full(small, 0.01)])
    outcomes = np.full(peaks.size, Outcome.ROCKS)
    outcomes[len(numbers) : len(numbers) + overturned] = Outcome.OVERTURNS
    return ResponseTargets(Block.from_parameters(np.full(peaks.size, 2.0), 0.2, 0.9), peaks, outcomes)


def test_without_censoring_the_spread_is_the_rms_residual():
    rng = np.random.default_rng(1)
    numbers = 0.3 * np.exp(0.2 * rng.standard_normal(20))
    residuals = np.log(numbers / 0.3)
    found, spread = log_likelihood(np.full((1, 20), 0.3), observed(numbers))
    assert spread[0] == pytest.approx(np.sqrt(np.mean(residuals**2)), rel=1e-12)
    assert found[0] == pytest.approx(norm(scale=spread[0]).logpdf(residuals).sum(), rel=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_with_censoring_the_spread_is_that_of_a_plain_maximisation(seed):
    rng = np.random.default_rng(seed)
    data = observed(np.exp(rng.uniform(-2.5, -0.1, 10)), overturned=6, small=5)
    peaks = np.exp(rng.uniform(-4.0, -0.05, (1, 21)))
    peaks[0, [2, 11, 18]] = np.inf
    residuals = data.residuals(peaks)[0, :10]
    margins = np.concatenate([np.log(peaks[0, 10:16]), np.log(0.05 / np.minimum(peaks[0, 16:], 1.0))])

    def negative(logarithm):
        spread = np.exp(logarithm)
        return -norm(scale=spread).logpdf(residuals).sum() - norm.logcdf(margins / spread).sum()

    best = minimize_scalar(negative, bounds=(-3.0, 3.0), method="bounded", options={"xatol": 1e-10})
    found, spread = log_likelihood(np.concatenate([peaks, peaks[:, ::-1]]), data)  # each sequence has its own spread
    assert found[0] == pytest.approx(-best.fun, abs=1e-8)
    assert spread[0] == pytest.approx(np.exp(best.x), rel=1e-4)


@pytest.mark.parametrize(("noise", "reached"), [(0.02, 0.97), (0.002, 0.985), (0.02, 0.02), (0.0, 0.05)])
def test_a_spread_far_from_that_of_the_numbers_alone_is_found(noise, reached):
    """Blocks that should overturn reach less than 1, be it by little or by far."""
    numbers = np.linspace(0.1, 0.8, 8)
    signs = noise * np.where(np.arange(8) % 2, 1.0, -1.0)
    data = observed(numbers, overturned=2, small=1)
    peaks = np.concatenate([numbers * np.exp(signs), [reached, reached, 0.01]])[np.newaxis]

    def negative(logarithm):
        spread = np.exp(logarithm)
        parts = norm.logcdf(np.array([np.log(reached), np.log(reached), np.log(5.0)]) / spread)
        return -norm(scale=spread).logpdf(signs).sum() - parts.sum()

    best = minimize_scalar(negative, bounds=(np.log(0.01), 3.0), method="bounded", options={"xatol": 1e-12})
    found, spread = log_likelihood(peaks, data)
    assert found[0] == pytest.approx(-best.fun, abs=1e-6)
    assert spread[0] == pytest.approx(np.exp(best.x), rel=1e-4)


@pytest.mark.parametrize("overturned", [0, 1])
def test_a_perfect_fit_stops_at_the_smallest_spread(overturned):
    numbers = np.linspace(0.1, 0.8, 8)
    peaks = np.append(numbers, [np.inf] * overturned)[np.newaxis]
    found, spread = log_likelihood(peaks, observed(numbers, overturned))
    assert spread[0] == SMALLEST_SPREAD == 0.01  # one per cent of a peak
    assert found[0] == pytest.approx(8.0 * norm(scale=0.01).logpdf(0.0))


def test_a_sequence_that_moves_no_block_has_a_likelihood_all_the_same():
    numbers = np.linspace(0.1, 0.8, 8)
    found, spread = log_likelihood(np.zeros((1, 11)), observed(numbers, overturned=2, small=1))
    assert np.isfinite(found[0])
    assert spread[0] > 1.0


def test_an_overturned_target_likes_larger_peaks_and_is_indifferent_once_certain():
    numbers = np.linspace(0.1, 0.8, 8)
    peaks = np.tile(np.append(1.2 * numbers, 0.0), (4, 1))
    peaks[:, -1] = [0.2, 0.8, 1e9, np.inf]
    found, _ = log_likelihood(peaks, observed(numbers, overturned=1))
    assert np.all(np.diff(found[:3]) > 0.0)
    assert found[2] == found[3]


def targets(sequence):
    family = block_family()
    response = sequence_response(family, sequence, table_rows=0, threads=1)
    return ResponseTargets(family, response.peak_rotation_ratio, response.outcome)


@pytest.mark.parametrize("main_count", [1, 2, 7])
def test_what_the_targets_ask_for_is_the_impulse_of_the_continuous_limit(main_count):
    # v_N = (I/I_1c) [1 - sigma/2 + (1 - sigma) (C + ... + C^(N-1))], from the recurrence of F3 and the limit F4.
    sequence = ImpulseSequence(0.21, 0.4 * 0.21, np.nan, np.inf, main_count=main_count, spacing="continuous")
    space = search_space(targets(sequence), None, "continuous")
    point = space.point(1.0, 0.4, 0.1, main_count)
    assert space.asked_for(point[np.newaxis])[0] == pytest.approx(0.21, rel=1e-9)


def test_what_is_asked_for_is_the_median_over_the_blocks_and_main_impulses_add_up_where_none_is_lost():
    space = SearchSpace(*np.zeros((2, 4)), 9.0, "end", np.array([0.4, 0.5, 2.0]), np.array([1.0, 1.0, 0.5]))
    points = np.array([[0.0, 0.2, 0.0, 4.0], [-0.7, 0.6, 0.0, 1.0], [0.3, 0.0, 0.0, 3.0]])
    # Of N = 4 and C = 1: 1 - 0.1 + 0.8 x 3 = 3.3; of C = 0.5: 0.9 + 0.8 (0.5 + 0.25 + 0.125) = 1.6.
    by_hand = [np.median([0.4 / 3.3, 0.5 / 3.3, 2.0 / 1.6]), 0.5 / 0.7, np.median([0.4 / 3.0, 0.5 / 3.0, 2.0 / 1.75])]
    assert space.asked_for(points) == pytest.approx(by_hand, rel=1e-6)
    assert space.main(points) == pytest.approx(np.exp([0.0, -0.7, 0.3]) * by_hand, rel=1e-6)


def test_points_are_the_sequences_of_their_columns():
    given = ImpulseSequence(0.21, 0.084, 0.13, 12.0, main_count=5)
    space = search_space(targets(given), given, "end")
    points = np.array([[0.1, 0.4, np.log(0.2), 6.9], [-0.2, 1.0, np.log(0.7), 2.2]])
    found = space.sequences(points)
    assert found.main == pytest.approx(np.exp(points[:, 0]) * space.asked_for(points))
    assert found.secondary / found.main == pytest.approx([0.4, 1.0])
    assert found.interval == pytest.approx([0.2, 0.7])
    assert found.main_count.tolist() == [7, 2]
    assert found.duration == pytest.approx([12.0, 12.0])
    assert found.spacing == "end"
    without = search_space(targets(given), given, "continuous").sequences(points)
    assert np.all(np.isnan(without.interval))


def test_a_point_gives_back_its_sequence():
    given = ImpulseSequence(0.21, 0.084, 0.13, 12.0, main_count=5, spacing="middle")
    space = search_space(targets(given), given, "middle")
    back = space.sequence(start_point(space, given))
    assert (back.main, back.secondary, back.interval) == pytest.approx((0.21, 0.084, 0.13), rel=1e-12)
    assert (back.main_count, back.duration, back.spacing) == (5, 12.0, "middle")


def test_the_start_widens_the_limits():
    given = ImpulseSequence(0.21, 0.084, 0.2, 12.0, main_count=4)
    data = targets(given)
    usual = search_space(data, None, "end")
    # I within a factor of e of what the targets ask for, every I_s/I, dT of 0.05 to 2 s, 1 to 20 main impulses.
    assert usual.low == pytest.approx([-1.0, 0.0, np.log(0.05), 1.0])
    assert usual.high == pytest.approx([1.0, 1.0, np.log(2.0), 20.0])
    assert usual.duration == np.inf
    for far, column, side in (
        (ImpulseSequence(9.0, 0.9, 0.2, 12.0, main_count=4), 0, "high"),
        (ImpulseSequence(0.01, 0.001, 0.2, 12.0, main_count=4), 0, "low"),
        (ImpulseSequence(0.21, 0.084, 0.011, 12.0, main_count=4), 2, "low"),
        (ImpulseSequence(0.21, 0.084, 5.0, 12.0, main_count=4), 2, "high"),
        (ImpulseSequence(0.21, 0.084, 0.2, 12.0, main_count=33), 3, "high"),
    ):
        space, expected = search_space(data, far, "end"), {"low": usual.low.copy(), "high": usual.high.copy()}
        expected[side][column] = start_point(space, far)[column]
        assert abs(expected[side][column]) > abs(getattr(usual, side)[column])
        assert space.low == pytest.approx(expected["low"])
        assert space.high == pytest.approx(expected["high"])
        assert space.duration == 12.0
    for inside in (
        given,
        ImpulseSequence(0.0, 0.0, 0.2, 12.0, main_count=4),  # a motion without a half-wave widens nothing
        ImpulseSequence(0.21, 0.084, np.nan, 12.0, spacing="continuous"),
    ):
        space = search_space(data, inside, "end")
        assert np.array_equal([space.low, space.high], [usual.low, usual.high])
    none = search_space(data, given, "continuous")
    assert (none.low[INTERVAL], none.high[INTERVAL]) == (0.0, 0.0)


def test_a_start_without_a_number_or_an_interval_has_the_largest_and_the_middle_one():
    given = ImpulseSequence(0.21, 0.084, 0.2, 12.0, main_count=4)
    start = ImpulseSequence(0.4, 0.36, np.nan, 12.0, spacing="continuous")
    space = search_space(targets(given), start, "start")
    found = space.sequence(start_point(space, start))
    # I_s/I is 0.9, of which no more than 2/3 is searched; the middle of 0.05 to 2 s in equal ratios is sqrt(0.1).
    assert (found.main, found.secondary, found.interval) == pytest.approx((0.4, 0.4 * 2.0 / 3.0, np.sqrt(0.1)))
    assert found.main_count == 20
    many = search_space(targets(given), given, "continuous")
    assert start_point(many, given)[INTERVAL] == 0.0


def test_a_peak_beyond_alpha_c_that_comes_back_asks_for_the_critical_impulse():
    blocks = Block.from_parameters(np.linspace(1.0, 3.0, 8), 0.2, 0.9)
    peaks = np.array([0.2, 0.4, 0.5, 0.6, 0.7, 1.0, 1.3, np.inf])
    outcomes = [*[Outcome.ROCKS] * 7, Outcome.OVERTURNS]
    space = search_space(ResponseTargets(blocks, peaks, outcomes), None, "end")
    # v^2 = 1 - (1 - x)^2: of 0.2 it is 0.36, of 0.4 0.64, of 0.5 0.75, of 0.6 0.84, of 0.7 0.91.
    velocities = np.sqrt([0.36, 0.64, 0.75, 0.84, 0.91, 1.0, 1.0])
    assert space.demands == pytest.approx(velocities * blocks.critical_impulse[:7])
    assert space.restitutions.tolist() == [0.9] * 7


@pytest.mark.parametrize("spacing", ["start", "middle"])
def test_no_ratio_is_searched_at_which_the_block_would_touch_the_ground(spacing):
    given = ImpulseSequence(0.21, 0.084, 0.2, np.inf, main_count=4, spacing=spacing)
    space = search_space(targets(given), None, spacing)
    edge = np.array([space.low, space.high])
    edge[:, RATIO], edge[:, INTERVAL] = space.high[RATIO], np.log([0.1, 0.5])
    touched = []
    for point in edge:
        for share in (1.0, 1.01):
            point[RATIO] = share * space.high[RATIO]
            sequence = space.sequence(point)
            contact = sequence_response(block_family(), sequence, table_rows=0, threads=1).ground_contact
            touched.append(bool(np.any(contact)))
    assert touched[0] is touched[2] is False
    assert touched[1] or touched[3]


def test_the_likeliest_within_the_limits_is_the_best_unless_the_start_is_likelier():
    explored = SimpleNamespace(likelihood=np.array([-9.0, -1.0, -2.0, -3.0, -4.0]))
    values = {
        "main": np.array([9.0, 5.0, 2.0, 1.0, 1.5]),
        "ratio": np.array([0.9, 0.1, 0.3, 0.2, 0.2]),
        "interval": np.full(5, np.nan),
    }
    limits = {"main": (1.0, 2.0), "ratio": (0.1, 0.9), "interval": (0.1, 0.2)}
    assert Explored.best(explored, limits, values) == 2
    assert Explored.best(explored, limits | {"main": (1.0, 1.99)}, values) == 3
    assert Explored.best(explored, limits | {"main": (1.01, 1.99)}, values) == 4
    assert Explored.best(explored, limits | {"ratio": (0.31, 0.9)}, values) == 0
    explored.likelihood[0] = -0.5
    assert Explored.best(explored, limits, values) == 0


class Tried:
    """The batches of points that a search tries, with a likelihood that is made up."""

    def __init__(self, monkeypatch, likelihood):
        self.batches = []

        def try_points(explored, points):
            value = np.asarray(likelihood(len(self.batches), points), dtype=float)
            self.batches.append(points.copy())
            explored.points = np.concatenate([explored.points, points])
            explored.likelihood = np.concatenate([explored.likelihood, value])
            return value

        monkeypatch.setattr(Explored, "try_points", try_points)


LOW, HIGH = np.array([-1.0, 0.1, -3.0, 1.0]), np.array([1.0, 0.9, 0.7, 20.0])
SPACE = SearchSpace(LOW, HIGH, 9.0, "end", np.ones(1), np.ones(1))


@pytest.mark.parametrize(
    ("spread", "generations"),
    [(0.04, 2), (0.06, 16)],  # ln L of a generation that spreads by less than 0.05 ends the search
)
def test_start_generations_survey_and_twenty_rounds(monkeypatch, spread, generations):
    def likelihood(batch, points):
        """Each generation is likelier than the one before, and spreads as it did."""
        return 50.0 + batch + spread * np.where(np.arange(len(points)) % 2, 1.0, -1.0)

    tried = Tried(monkeypatch, likelihood)
    cuts, offspring = [], response_search._offspring

    def bred(explored, cut, rng):
        cuts.append(cut)
        return offspring(explored, cut, rng)

    monkeypatch.setattr(response_search, "_offspring", bred)
    start = np.array([0.25, 0.5, -1.0, 7.0])
    explored = explore(None, SPACE, start, 12.0, np.random.default_rng(0))
    sizes = [len(batch) for batch in tried.batches]
    assert sizes == [1, *[40] * generations, 512, *[256] * 20]
    assert np.array_equal(explored.points[0], start)
    # The start is a member of the first generation, too, and numbers of main impulses are whole ones.
    assert np.min(np.max(np.abs(tried.batches[1] - start), axis=1)) < 1e-9
    assert np.array_equal(explored.points[:, 3], np.rint(explored.points[:, 3]))
    assert np.all((explored.points >= LOW - 1e-9) & (explored.points <= HIGH + 1e-9))
    # docs/decisions/010: the deviance shrinks from 300 to four times the threshold, in equal ratios.
    assert (cuts[0], cuts[-1], len(cuts)) == (pytest.approx(300.0), pytest.approx(12.0), 20)
    assert np.diff(np.log(cuts)) == pytest.approx(np.log(12.0 / 300.0) / 19.0)
    survey = tried.batches[generations + 1]
    for column in range(3):  # one in each of 512 strata of every column
        places = (survey[:, column] - LOW[column]) / (HIGH - LOW)[column]
        assert np.array_equal(np.sort(np.floor(512.0 * places)), np.arange(512.0))
    # Equal shares of the logarithm of N + 1, from 1 to 21.
    shares = np.log((np.arange(1, 21) + 1.0) / np.arange(1, 21)) / np.log(21.0)
    assert np.max(np.abs(np.bincount(survey[:, 3].astype(int), minlength=21)[1:] - 512.0 * shares)) < 2.0
    alone = Tried(monkeypatch, likelihood)
    explore(None, SPACE, None, 12.0, np.random.default_rng(0))
    assert len(alone.batches[0]) == 40


def test_generations_come_nearer_to_what_is_likely(monkeypatch):
    best = np.array([0.4, 0.3, -1.0, 6.0])

    def likelihood(batch, points):
        return -50.0 * np.sum(((points - best) / (HIGH - LOW)) ** 2, axis=1)

    tried = Tried(monkeypatch, likelihood)
    explored = explore(None, SPACE, None, 12.0, np.random.default_rng(0))
    last = tried.batches[[len(batch) for batch in tried.batches].index(512) - 1]
    assert np.mean(likelihood(0, last)) > 0.3 * np.mean(likelihood(0, tried.batches[0]))
    found = explored.points[np.argmax(explored.likelihood)]
    assert found == pytest.approx(best, abs=0.05)


@pytest.mark.sweep
def test_the_likely_region_is_filled_with_candidates():
    data = targets(ImpulseSequence(0.3, 0.18, 0.2, np.inf, main_count=3))
    explored = explore(data, search_space(data, None, "end"), None, 10.0, np.random.default_rng(0), threads=1)
    deviance = 2.0 * (explored.likelihood.max() - explored.likelihood)
    assert np.count_nonzero(deviance <= 10.0) > 500
    assert np.count_nonzero(deviance <= 3.0) > 200
