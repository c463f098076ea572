"""The sampler on densities whose quantiles are known, and profiles, intervals and correlations of the parameters."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import chi2, f, norm

from rockpulse.models import Block, Outcome
from rockpulse.sequences import response_posterior
from rockpulse.sequences.response_posterior import (
    Posterior,
    correlations,
    deviance_threshold,
    flat_ends,
    independent_share,
    intervals,
    likeliest_counts,
    main_counts,
    parameter_values,
    profiles,
    sample_posterior,
)
from rockpulse.sequences.response_targets import ResponseTargets, block_family

LOW, HIGH = np.array([-5.0, 0.0, -5.0, 1.0]), np.array([5.0, 1.0, 5.0, 9.0])


class Known:
    """Independent: normal, triangular from 0 to 1, a normal cut at its median, and 3 or 4 main impulses as 1 to 3."""

    def __init__(self, rng):
        self.space = SimpleNamespace(low=LOW, high=HIGH)
        self.points = LOW + rng.random((6000, 4)) * (HIGH - LOW)
        self.points[:, 3] = rng.integers(1, 10, size=6000)
        self.likelihood = self.density(self.points)

    def density(self, points):
        count = {3.0: np.log(0.25), 4.0: np.log(0.75)}
        found = norm(1.0, 0.3).logpdf(points[:, 0]) + np.log(points[:, 1]) + norm(0.0, 0.5).logpdf(points[:, 2])
        found += [count.get(value, -50.0) for value in points[:, 3]]
        return np.where(points[:, 2] > 0.0, found - 20.0, found)

    def try_points(self, points):
        return self.density(points)


def test_quantiles_of_a_known_density():
    rng = np.random.default_rng(3)
    found = sample_posterior(Known(rng), rng)
    levels = np.array([0.05, 0.5, 0.95])
    assert found.effective > 300.0
    assert found.quantiles(found.points[:, 0], levels) == pytest.approx(norm(1.0, 0.3).ppf(levels), abs=0.08)
    assert found.quantiles(found.points[:, 1], levels) == pytest.approx(np.sqrt(levels), abs=0.06)
    assert found.quantiles(found.points[:, 2], levels) == pytest.approx(norm(0.0, 0.5).ppf(0.5 * levels), abs=0.1)
    assert found.weights[found.points[:, 3] == 4.0].sum() == pytest.approx(0.75, abs=0.07)


def test_weighted_quantiles_by_hand():
    posterior = Posterior(np.zeros((4, 4)), np.array([0.1, 0.2, 0.3, 0.4]))
    values = np.array([40.0, 30.0, 20.0, 10.0])
    assert posterior.quantiles(values, np.array([0.05, 0.5, 0.95])).tolist() == [10.0, 20.0, 40.0]
    assert posterior.effective == pytest.approx(1.0 / 0.3)
    assert Posterior(np.zeros((3, 4)), np.array([0.2, 0.2, 0.2])).quantiles(np.arange(3.0), np.array([1.0])) == [2.0]


class Recorded(response_posterior._Kernels):
    """The kernels of every round, with the points and weights that they are made of."""

    rounds: list

    def __init__(self, points, weights, explored, rng):
        super().__init__(points, weights, explored, rng)
        self.rounds.append((points, weights, self))


class Made:
    """Candidates with a likelihood that is made up, the number of calls in hand."""

    def __init__(self, likelihood):
        self.space, self.made, self.calls = SimpleNamespace(low=LOW, high=HIGH), likelihood, 0
        rng = np.random.default_rng(1)
        self.points = np.column_stack([LOW[:3] + rng.random((900, 3)) * (HIGH - LOW)[:3], rng.integers(3, 7, 900)])
        self.likelihood = likelihood(self.points)

    def try_points(self, points):
        self.calls += 1
        return self.made(points)


def test_every_round_draws_from_what_the_rounds_before_found_likely(monkeypatch):
    """Powers of the weights rise to one, and the weight of a sample is likelihood over the sum of all densities."""
    share = 0.4
    monkeypatch.setattr(response_posterior, "_Kernels", Recorded)
    Recorded.rounds = []
    made = Made(lambda points: -0.5 * (points[:, 0] ** 2 + 30.0 * (points[:, 1] - 0.4) ** 2 + points[:, 2] ** 2))
    found = sample_posterior(made, np.random.default_rng(2), share)
    rounds = Recorded.rounds
    assert (made.calls, len(rounds)) == (6, 6)
    assert found.effective >= 200.0
    assert np.all((found.points >= LOW) & (found.points <= HIGH))
    kernels = [one for _, _, one in rounds]
    ended = (found.points, found.weights, None)
    for number, power, (points, weights, _) in zip(
        range(7), (0.2, 0.4, 0.7, 1.0, 1.0, 1.0, 1.0), [*rounds, ended], strict=True
    ):
        expected = share * made.made(points)
        if number:
            expected = expected - logsumexp([one.log_density(points) for one in kernels[:number]], axis=0)
        expected = power * expected
        assert np.log(weights) == pytest.approx(expected - logsumexp(expected), abs=1e-8), number
    assert len(rounds[1][0]) < 512 < len(rounds[2][0]) <= 1024


LEAST, MOST = np.array([0.1, 0.2, 0.2, 1.0]), np.array([1.0, 1.0, 2.0, 20.0])
CENTRE = np.array([0.5, 0.5, 1.0, 6.0])


@pytest.mark.parametrize(
    ("column", "name", "at", "inside"),
    [(1, "ratio", 0.79 / 24.0, 0.81 / 24.0), (2, "interval", 1.79 / 24.0, 1.81 / 24.0), (3, "main_count", 0.0, 1.0)],
)
def test_likely_values_at_a_limit_of_the_search_reach_it(column, name, at, inside):
    """Within a twenty-fourth of the range, or at the very number of main impulses."""
    for low, high in ((False, False), (True, False), (False, True), (True, True)):
        points = np.tile(CENTRE, (5, 1))
        points[1, column] = LEAST[column] + (at if low else inside)
        points[2, column] = MOST[column] - (at if high else inside)
        points[3:] = LEAST, MOST  # which are not likely
        explored = SimpleNamespace(
            space=SimpleNamespace(low=LEAST, high=MOST),
            points=points,
            likelihood=np.array([0.0, -1.0, -1.0, -2.0, -2.0]),
        )
        expected = dict.fromkeys(("ratio", "interval", "main_count"), (False, False)) | {name: (low, high)}
        assert flat_ends(explored, 3.0) == expected


def test_a_parameter_that_is_known_goes_with_no_other():
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    points = np.array([[-1.0, 0.5, 0.1, 3.0], [0.0, 0.5, 0.2, 3.0], [1.0, 0.5, 0.3, 3.0]])
    found = correlations(space, Posterior(points, np.full(3, 1.0 / 3.0)))
    assert found["main", "interval"] == pytest.approx(1.0)
    others = {pair: value for pair, value in found.items() if pair != ("main", "interval")}
    assert len(others) == 5
    assert set(others.values()) == {0.0}
    point = np.array([[0.3, 0.7, 0.2, 3.0]] * 3)
    assert set(correlations(space, Posterior(point, np.full(3, 1.0 / 3.0))).values()) == {0.0}


def test_correlations_are_weighted_and_of_logarithms():
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.normal(size=(40, 3)), rng.integers(3, 9, 40)])
    weights = rng.random(40)
    weights /= weights.sum()
    away = points - weights @ points
    covariance = (away.T * weights) @ away
    expected = covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    found = correlations(space, Posterior(points, weights))
    names = ("main", "ratio", "interval", "main_count")
    assert found == {
        (names[i], names[j]): pytest.approx(expected[i, j]) for i, j in zip(*np.triu_indices(4, 1), strict=True)
    }
    space.spacing = "continuous"
    assert set(correlations(space, Posterior(points, weights))) == {
        ("main", "ratio"),
        ("main", "main_count"),
        ("ratio", "main_count"),
    }


def test_values_of_the_parameters():
    space = SimpleNamespace(spacing="end", main=lambda points: 3.0 * np.exp(points[:, 0]))
    points = np.array([[0.0, 0.2, np.log(0.3), 4.4], [1.0, 0.5, np.log(0.7), 6.6]])
    found = parameter_values(space, points)
    assert found["main"] == pytest.approx([3.0, 3.0 * np.e])
    assert found["ratio"].tolist() == [0.2, 0.5]
    assert found["interval"] == pytest.approx([0.3, 0.7])
    assert found["main_count"].tolist() == [4.0, 7.0]
    space.spacing = "continuous"
    assert np.isnan(parameter_values(space, points)["interval"]).tolist() == [True, True]


@pytest.mark.parametrize("count", [6, 9, 40])
def test_the_threshold_is_that_of_the_test_of_one_coefficient_of_four(count):
    # t^2 with n - 4 degrees of freedom is F with 1 and n - 4; the deviance of a linear model is n ln(1 + F/(n - 4)).
    for confidence in (0.5, 0.95):
        quantile = f(1, count - 4).ppf(confidence)
        assert deviance_threshold(count, confidence) == pytest.approx(count * np.log(1.0 + quantile / (count - 4)))
    assert deviance_threshold(10**6, 0.8) == pytest.approx(chi2(1).ppf(0.8), rel=1e-4)


def test_a_profile_is_the_smallest_deviance_in_each_of_24_parts():
    """Parts of the logarithm of I and dT, of I_s/I, and single numbers of main impulses; the unlikely is no part."""
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    place = np.append(np.repeat(np.arange(24.0), 2) + np.tile([0.2, 0.7], 24), [24.0])  # two in each part, and the end
    place[0] = 0.0
    points = np.column_stack([place / 8.0, place / 24.0, place / 6.0, 3.0 + np.floor(place / 4.0)])
    deviance = np.where(np.arange(49) % 2, 1.0 + place / 100.0, 3.0 - place / 100.0)
    deviance[5], deviance[10], deviance[11] = 0.0, 30.0, 20.0
    beyond = points[:1] + np.array([[-9.0, -9.0, -9.0, 1.0], [9.0, 9.0, 9.0, 9.0]])
    for share in (1.0, 0.5):
        explored = SimpleNamespace(
            space=space,
            points=np.concatenate([points, beyond]),
            likelihood=7.0 - 0.5 * np.append(deviance, [20.001, 90.0]) / share,
        )
        found = profiles(explored, share)
        best = [*range(1, 48, 2), 48]  # the second of each part, and the end alone
        for name, column in (
            ("main", np.exp(points[:, 0])),
            ("ratio", points[:, 1]),
            ("interval", np.exp(points[:, 2])),
        ):
            values, smallest = found[name]
            assert values == pytest.approx(column[best])
            assert smallest == pytest.approx(deviance[best], abs=1e-12)
        numbers, smallest = found["main_count"]
        assert numbers.tolist() == [3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
        own = [np.min(deviance[points[:, 3] == number]) for number in numbers]
        assert smallest == pytest.approx(own, abs=1e-12)
    space.spacing = "continuous"
    assert [array.size for array in profiles(explored)["interval"]] == [0, 0]
    assert list(profiles(explored)) == ["main", "ratio", "interval", "main_count"]


def test_the_interval_is_central_and_that_of_a_number_the_likeliest():
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    points = np.column_stack([np.linspace(0.0, 1.0, 1001)] * 3 + [np.repeat([3.0, 4.0, 6.0], [101, 700, 200])])
    posterior = Posterior(points, np.full(1001, 1.0 / 1001.0))
    for confidence in (0.9, 0.6):
        found = intervals(space, posterior, confidence)
        low, high = 0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence
        assert found["ratio"] == pytest.approx((low, high), abs=0.0021)
        assert found["main"] == pytest.approx((np.exp(low), np.exp(high)), abs=0.006)
        assert found["interval"] == pytest.approx((np.exp(low), np.exp(high)), abs=0.006)
        assert found["main_count"] == ((4.0, 6.0) if confidence == 0.9 else (4.0, 4.0))
    assert main_counts(posterior) == pytest.approx({3: 101 / 1001, 4: 700 / 1001, 6: 200 / 1001})
    space.spacing = "continuous"
    assert np.isnan(intervals(space, posterior, 0.9)["interval"]).all()


@pytest.mark.parametrize(
    ("shares", "confidence", "expected"),
    [
        ({3: 0.05, 4: 0.70, 5: 0.23, 6: 0.02}, 0.9, (4.0, 5.0)),
        ({8: 0.14, 9: 0.86}, 0.9, (9.0, 9.0)),
        ({2: 0.6, 3: 0.1, 7: 0.3}, 0.9, (2.0, 7.0)),  # the numbers between them are no likelier for that
        ({2: 0.5, 3: 0.2, 7: 0.2, 8: 0.1}, 0.7, (2.0, 3.0)),  # of two alike the first
        ({2: 0.5, 3: 0.3, 4: 0.2}, 0.95, (2.0, 4.0)),
    ],
)
def test_the_likeliest_numbers_hold_about_the_level(shares, confidence, expected):
    assert likeliest_counts(shares, confidence) == expected


FAMILY = block_family()


def share(residuals):
    targets = ResponseTargets(FAMILY, 0.3 * np.exp(residuals), np.full(100, Outcome.ROCKS))
    return independent_share(targets, np.full(100, 0.3))


def test_the_share_is_that_of_a_chain():
    rng = np.random.default_rng(4)
    found, correlation = share(0.2 * (FAMILY.alpha_c - 0.18) / 0.08 + 0.2 * rng.standard_normal(100))
    assert found == pytest.approx((1.0 - correlation) / (1.0 + correlation))
    certain = share(0.5 * np.log(FAMILY.alpha_c / 0.16))
    assert certain[1] > 0.9
    assert certain[0] == pytest.approx(0.1 / 1.9)  # no correlation above 0.9 is believed
    assert share(np.zeros(100)) == (1.0, 0.0)


def directly(blocks, residuals):
    """The share and the correlation by looking at every pair of blocks."""
    place = np.column_stack([np.log(blocks.p), np.log(blocks.alpha_c), blocks.restitution])
    deviation = np.sqrt(np.mean((place - place.mean(axis=0)) ** 2, axis=0))
    place = place / np.where(deviation > 0.0, deviation, 1.0)
    distance = np.sum((place[:, np.newaxis] - place) ** 2, axis=2)
    np.fill_diagonal(distance, np.inf)
    near = np.argmin(distance, axis=1)
    found = np.sum(residuals * residuals[near]) / np.sqrt(np.sum(residuals**2) * np.sum(residuals[near] ** 2))
    mutual = np.sum(near[near] == np.arange(near.size))
    # Under independence the sum of n products, of which some stand twice, has the variance n + their number.
    if found < 1.645 * np.sqrt(near.size + mutual) / near.size:
        return 1.0, found
    return (1.0 - min(found, 0.9)) / (1.0 + min(found, 0.9)), found


@pytest.mark.parametrize("same", [(), ("restitution",), ("p", "alpha")])
def test_the_correlation_is_that_with_the_nearest_of_the_blocks_that_are_numbers(same):
    shares = set()
    for seed in range(40):
        rng = np.random.default_rng(seed)
        known = {"p": rng.uniform(1.0, 5.0, 60), "alpha": rng.uniform(0.08, 0.32, 60)}
        known["restitution"] = rng.uniform(0.4, 0.9, 60)
        known |= {name: np.full(60, known[name][0]) for name in same}
        blocks = Block.from_parameters(**known)
        residuals = rng.normal(0.03, 0.1, 60) + (0.003 * seed) * np.sin(3.0 * np.log(known["p"]) + 5.0 * known["alpha"])
        peaks, outcomes = 0.3 * np.exp(residuals), np.full(60, Outcome.ROCKS)
        silent = rng.random(60) < 0.2
        outcomes[silent] = Outcome.AT_REST
        spoken = np.flatnonzero(~silent)
        found = independent_share(ResponseTargets(blocks, peaks, outcomes), np.full(60, 0.3))
        expected = directly(
            Block.from_parameters(**{name: values[spoken] for name, values in known.items()}), residuals[spoken]
        )
        assert found == pytest.approx(expected, rel=1e-9)
        shares.add(found[0])
    assert 1.0 in shares
    assert same or len(shares) > 5


def test_of_two_blocks_in_one_place_each_is_the_others_neighbour():
    blocks = Block.from_parameters(np.repeat(np.linspace(1.0, 3.0, 6), 2), 0.2, 0.9)
    residuals = np.repeat([0.1, -0.2, 0.3, -0.1, 0.2, -0.3], 2) + np.tile([0.01, -0.01], 6)
    targets = ResponseTargets(blocks, 0.3 * np.exp(residuals), np.full(12, Outcome.ROCKS))
    products = 2.0 * np.sum(residuals[::2] * residuals[1::2]) / np.sum(residuals**2)
    assert independent_share(targets, np.full(12, 0.3))[1] == pytest.approx(products, rel=1e-9)
