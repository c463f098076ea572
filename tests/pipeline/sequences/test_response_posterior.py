"""The sampler on a density whose quantiles are known, with a jump in it."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, norm

from rockpulse.sequences import response_posterior
from rockpulse.sequences.response_posterior import Posterior, sample_posterior

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


def test_kernels_lie_about_likely_points_and_are_as_wide_as_their_cloud():
    """A cloud of few points has the half of the deviation of all; a width that is zero has 1e-4 of the range."""
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.normal(0.0, [1.0, 0.05, 0.5], (1000, 3)), np.full(1000, 3.0)])
    points[:, 1] += 0.5 + 0.03 * points[:, 0]
    points[:6, 3], points[6:13, 3] = 4.0, 5.0
    weights = rng.random(1000)
    weights /= weights.sum()
    weights[:13] = 0.02
    weights /= weights.sum()
    explored = SimpleNamespace(space=SimpleNamespace(low=LOW, high=HIGH))
    found = response_posterior._Kernels(points, weights, explored, rng)
    least = np.diag(1e-8 * (HIGH - LOW)[:3] ** 2)

    def covariance(own):
        share = weights[own] / weights[own].sum()
        away = points[own, :3] - share @ points[own, :3]
        return (away.T * share) @ away / (1.0 - np.sum(share**2)) + least  # of a sample with weights

    # Six points of equal weight are no more than twice three, seven are.
    expected = {3.0: covariance(points[:, 3] == 3.0), 5.0: covariance(points[:, 3] == 5.0)}
    expected[4.0] = 0.25 * (covariance(np.full(1000, True)) - least) + least
    assert found.factors.keys() == expected.keys()
    for count, factor in found.factors.items():
        assert factor @ factor.T == pytest.approx(expected[count], rel=1e-9, abs=1e-15)
    assert found.centres.shape == (192, 4)
    assert np.mean(found.centres[:, 3] != 3.0) == pytest.approx(weights[:13].sum(), abs=0.1)
    assert [np.mean(found.widths == width) for width in (0.25, 0.75)] == pytest.approx([0.5, 0.5], abs=0.15)

    at = np.array([[0.3, 0.5, 0.1, 3.0], [-0.5, 0.45, -0.2, 4.0], [0.1, 0.5, 0.0, 6.0], [0.0, 0.5, 0.0, 9.0]])
    step = {-1.0: 0.15, 0.0: 0.7, 1.0: 0.15}
    direct = [
        sum(
            step.get(point[3] - centre[3], 0.0)
            * multivariate_normal(centre[:3], width**2 * expected[centre[3]]).pdf(point[:3])
            for centre, width in zip(found.centres, found.widths, strict=True)
        )
        for point in at
    ]
    assert direct[3] == 0.0
    density = found.log_density(at)
    assert density[3] == -np.inf
    # But for a constant that all kernels share.
    assert density[:3] - density[0] == pytest.approx(np.log(direct[:3]) - np.log(direct[0]), rel=1e-9)

    drawn = np.concatenate([found.draw(rng) for _ in range(40)])
    assert drawn.shape == (40 * 512, 4)
    # What is drawn has the density that is told: the mean of another density over it is one for every N.
    constant = np.log(192.0) + 1.5 * np.log(2.0 * np.pi)
    for count, mixed in ((2.0, 0.15), (3.0, 1.0), (4.0, 0.15)):
        own = drawn[:, 3] == count
        narrow = multivariate_normal([0.0, 0.5, 0.0], 0.3 * expected[3.0])
        ratio = narrow.pdf(drawn[own, :3]) / np.exp(found.log_density(drawn[own]) - constant)
        assert np.sum(ratio) / len(drawn) == pytest.approx(1.0, abs=0.06 / np.sqrt(mixed)), count


def test_a_parameter_without_a_range_stays_and_has_no_kernel():
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.normal(0.0, 0.2, (300, 3)), np.full(300, 3.0)])
    points[:, 2] = 0.0
    low, high = LOW.copy(), HIGH.copy()
    low[2] = high[2] = 0.0
    explored = SimpleNamespace(space=SimpleNamespace(low=low, high=high))
    found = response_posterior._Kernels(points, np.full(300, 1.0 / 300.0), explored, rng)
    assert found.factors[3.0].shape == (2, 2)
    assert np.all(found.draw(rng)[:, 2] == 0.0)


@pytest.mark.parametrize("share", [1.0, 0.4])
def test_every_round_draws_from_what_the_rounds_before_found_likely(monkeypatch, share):
    """Powers of the weights rise to one, and the weight of a sample is likelihood over the sum of all densities."""
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


def test_rounds_are_added_until_two_hundred_samples_are_effective_and_no_more_than_twelve(monkeypatch):
    """Of a likelihood that is wild, all densities taken as one, the effective number grows with the samples alone."""
    monkeypatch.setattr(
        response_posterior._Kernels, "log_density", lambda kernels, points: np.zeros(len(points), dtype=float)
    )
    monkeypatch.setattr(response_posterior, "_Kernels", Recorded)
    calls = []
    for wild in (1.0, 2.0, 50.0):
        made = Made(lambda points, wild=wild: wild * norm.ppf(np.modf(1e4 * np.abs(points[:, 0]) + 1e-9)[0]))
        Recorded.rounds = []
        found = sample_posterior(made, np.random.default_rng(2))
        assert (found.effective >= 200.0) == (made.calls < 18)
        for points, weights, _ in Recorded.rounds[3:]:
            assert np.log(weights) == pytest.approx(made.made(points) - logsumexp(made.made(points)), abs=1e-8)
        calls.append(made.calls)
    assert calls[0] == 6 < calls[1] < calls[2] == 18


@pytest.mark.parametrize(("effective", "rounds"), [(200.0, 6), (199.9, 18)])
def test_two_hundred_effective_samples_are_enough(monkeypatch, effective, rounds):
    monkeypatch.setattr(response_posterior.Posterior, "effective", property(lambda posterior: effective))
    made = Made(lambda points: np.zeros(len(points)))
    sample_posterior(made, np.random.default_rng(2))
    assert made.calls == rounds
