"""Profiles, intervals and correlations of the parameters, and what likely points say of the limits of a search."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2, f

from rockpulse.sequences.response_posterior import (
    Posterior,
    correlations,
    deviance_threshold,
    flat_ends,
    intervals,
    likeliest_counts,
    main_counts,
    parameter_values,
    profiles,
)

LOW, HIGH = np.array([0.1, 0.2, 0.2, 1.0]), np.array([1.0, 1.0, 2.0, 20.0])
MIDDLE = np.array([0.5, 0.5, 1.0, 6.0])


@pytest.mark.parametrize(
    ("column", "name", "at", "inside"),
    [(1, "ratio", 0.79 / 24.0, 0.81 / 24.0), (2, "interval", 1.79 / 24.0, 1.81 / 24.0), (3, "main_count", 0.0, 1.0)],
)
def test_likely_values_at_a_limit_of_the_search_reach_it(column, name, at, inside):
    """Within a twenty-fourth of the range, or at the very number of main impulses."""
    for low, high in ((False, False), (True, False), (False, True), (True, True)):
        points = np.tile(MIDDLE, (5, 1))
        points[1, column] = LOW[column] + (at if low else inside)
        points[2, column] = HIGH[column] - (at if high else inside)
        points[3:] = LOW, HIGH  # which are not likely
        explored = SimpleNamespace(
            space=SimpleNamespace(low=LOW, high=HIGH), points=points, likelihood=np.array([0.0, -1.0, -1.0, -2.0, -2.0])
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
    assert np.array_equal(profiles(explored)["ratio"], profiles(explored, 1.0)["ratio"])
    space.spacing = "continuous"
    assert [array.size for array in profiles(explored)["interval"]] == [0, 0]
    assert list(profiles(explored)) == ["main", "ratio", "interval", "main_count"]


def test_a_parameter_of_one_value_has_a_profile_of_one_part():
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    explored = SimpleNamespace(space=space, points=np.tile(MIDDLE, (3, 1)), likelihood=np.array([-1.0, 0.0, -2.0]))
    for values, deviance in profiles(explored).values():
        assert values.size == 1
        assert deviance.tolist() == [0.0]


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


def test_what_is_as_likely_as_the_threshold_reaches_a_limit_of_the_search():
    points = np.tile(MIDDLE, (3, 1))
    points[1], points[2] = LOW, HIGH
    for share, likelihood in ((1.0, [0.0, -1.5, -1.500001]), (0.5, [0.0, -3.0, -3.000001])):
        explored = SimpleNamespace(
            space=SimpleNamespace(low=LOW, high=HIGH), points=points, likelihood=np.array(likelihood)
        )
        assert flat_ends(explored, 3.0, share) == dict.fromkeys(("ratio", "interval", "main_count"), (True, False))
        if share == 1.0:
            assert flat_ends(explored, 3.0) == flat_ends(explored, 3.0, 1.0)
