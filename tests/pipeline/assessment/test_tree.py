"""Median, largest and smallest over the directions of a pair."""

import numpy as np
import pytest
import xarray as xr

from rockpulse.assessment.tree import MEAN, direction_statistics, largest_over, median_over, smallest_over

INF, NAN = np.inf, np.nan


@pytest.mark.parametrize(
    ("values", "median", "largest", "place"),
    [
        ([0.1, 0.4, 0.2], 0.2, 0.4, 1),
        ([0.1, 0.4, 0.2, 0.3], 0.25, 0.4, 1),
        ([0.1, INF, 0.2], 0.2, INF, 1),
        ([INF, 0.1, INF], INF, INF, 0),
        ([INF, 0.1], INF, INF, 0),
        ([0.0, 0.0, 0.0], 0.0, 0.0, 0),
        ([0.1, NAN, 0.2], NAN, NAN, -1),
        ([0.2, NAN, 0.2], 0.2, NAN, -1),
        ([INF, NAN, INF, INF], INF, INF, 0),
        ([NAN, NAN], NAN, NAN, -1),
    ],
)
def test_median_and_largest_with_overturning_and_without_an_answer(values, median, largest, place):
    row = np.array([values])
    assert median_over(row) == pytest.approx([median], nan_ok=True)
    found, at = largest_over(row)
    assert found == pytest.approx([largest], nan_ok=True)
    assert at == [place]


@pytest.mark.parametrize(
    ("values", "smallest", "place"),
    [([2.0, 0.5, 1.0], 0.5, 1), ([INF, 3.0], 3.0, 1), ([INF, INF], INF, -1), ([NAN, 0.5], NAN, -1)],
)
def test_smallest_safety_factor(values, smallest, place):
    found, at = smallest_over(np.array([values]))
    assert found == pytest.approx([smallest], nan_ok=True)
    assert at == [place]


def test_of_directions_that_overturn_the_one_that_does_it_first_is_the_worst():
    values = np.array([[INF, 0.4, INF, INF], [0.1, 0.7, 0.2, 0.3], [NAN, INF, 0.1, INF]])
    first = np.array([[9.0, 1.0, 4.0, 4.0], [1.0, 2.0, 3.0, 4.0], [1.0, INF, 2.0, INF]])
    largest, at = largest_over(values, first)
    assert (largest.tolist(), at.tolist()) == ([INF, 0.7, INF], [2, 1, 1])
    largest, at = largest_over(np.moveaxis(np.stack([values, values[::-1]]), 2, 1))
    assert at.tolist() == [[0, 1, 1], [1, 1, 0]]


@pytest.mark.parametrize("with_probability", [False, True])
def test_every_body_and_model_has_the_statistics_of_its_own(with_probability):
    """Three directions, two bodies, two models; the first direction is not among the records of the second pair."""
    rng = np.random.default_rng(1)
    of = ("record", "block", "model")
    peaks = rng.uniform(0.1, 0.9, (5, 2, 2))
    peaks[[0, 2], 0, 1] = INF
    factors = rng.uniform(1.0, 9.0, (5, 2, 2))
    times = np.full(peaks.shape, NAN)
    times[[0, 2], 0, 1] = [7.0, 3.0]
    pga, main, share = rng.uniform(1.0, 5.0, 5), rng.uniform(0.1, 0.5, 5), rng.uniform(0.0, 1.0, (5, 2))
    summary = xr.Dataset(
        {"peak_rotation_ratio": (of, peaks), "safety_factor": (of, factors), "overturning_time": (of, times)}
        | {"outcome": (of, np.where(np.isinf(peaks), 2, 1)), "pga": ("record", pga), "main_impulse": ("record", main)}
        | {"overturning_probability": (("record", "block"), share)},
        {"record": list("uvwxy"), "block": ["a", "b"], "model": ["linear", "nonlinear"]},
    )
    turns = [0.0, 60.0, 120.0]
    pairs = {"one": list("uvw"), "two": ["none", "x", "y"]}
    if with_probability:
        found = direction_statistics(summary, turns, pairs, with_probability=True)
        assert found[MEAN].values[0] == pytest.approx(share[:3].mean(axis=0))
        assert np.isnan(found[MEAN].values[1]).all()
    else:
        found = direction_statistics(summary, turns, pairs)
        assert MEAN not in found
    assert found["record_index"].values.tolist() == [[0, 1, 2], [-1, 3, 4]]
    for name, own in (("pga", pga), ("main_impulse", main)):
        first = [found[f"{name}_{what}"].values[0] for what in ("median", "largest", "azimuth")]
        assert first == [np.median(own[:3]), own[:3].max(), turns[own[:3].argmax()]]
        assert np.isnan([found[f"{name}_{what}"].values[1] for what in ("median", "largest", "azimuth")]).all()
    for block, model in np.ndindex(2, 2):
        cell = found.isel(block=block, model=model)
        own, factor = peaks[:3, block, model], factors[:3, block, model]
        expected = [np.median(own), own.max(), 120.0 if np.isinf(own).any() else turns[own.argmax()]]
        expected += [np.isinf(own).mean(), 0, factor.min(), turns[factor.argmin()]]
        names = ("median_rotation_ratio", "largest_rotation_ratio", "largest_azimuth", "overturning_share")
        names += ("unanswered_count", "smallest_safety_factor", "safety_factor_azimuth")
        assert [cell[name].values[0] for name in names] == pytest.approx(expected)
        assert cell["unanswered_count"].values[1] == 1
        assert np.isnan([cell[name].values[1] for name in names[1:3] + names[5:]]).all()
