"""Factors off the lanes of a body: against sums lane by lane, and where all agree against the binomial."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.special import ndtr

from rocking.spectrum.body_lanes import BodyLanes
from rocking.spectrum.body_probability import _counts, lane_factors
from rocking.spectrum.probability import Uncertainty, factor_at, mean_capacity, rising

#: Shift of ln f with a standard deviation of 0.1.
NORMAL = Uncertainty(factor=0.1, geometry=0.0)


@pytest.mark.parametrize("over", [False, True])
def test_lanes_that_agree_leave_a_twentieth_to_the_other_answer(over):
    """n like answers have 0.05^(1/n) as the lower end of their share, and n is the effective number of lanes.

    The lanes lie between -1 and 1 standard deviations: what is above them overturns, what is below them stands.
    """
    logs = np.linspace(-0.1, 0.1, 41)
    every = np.full(41, over)
    lanes = BodyLanes(logs, np.full(41, 0.005), every, np.zeros(41, dtype=bool), -0.1, 0.1, open=False)
    found = lane_factors(lanes, NORMAL, 0.6, 10.0).found
    above, inside = ndtr(-1.0), ndtr(1.0) - ndtr(-1.0)
    bells = np.exp(-0.5 * (logs / 0.1) ** 2)
    sure = 0.05 ** (np.sum(bells**2) / np.sum(bells) ** 2)
    if over:
        expected = (above + inside * sure, above + inside, above + inside)
    else:
        expected = (above, above, above + inside * (1.0 - sure))
    assert [found[f"at_one{end}"] for end in ("_low", "", "_high")] == pytest.approx(expected, abs=1e-9)


#: Lanes between these ln f, of an uneven weight; verdicts are mixed from -0.3 to 0.4.
BOTTOM, TOP, REACH = -0.85, 0.95, 0.35


def mixed_lanes(still_open=False):
    rng = np.random.default_rng(4)
    logs, weight = rng.uniform(BOTTOM, TOP, 50), rng.uniform(0.4, 1.6, 50) * (TOP - BOTTOM) / 50
    over = rng.random(50) < np.clip((logs + 0.3) / 0.7, 0.0, 1.0)
    return BodyLanes(logs, weight, over, np.zeros(50, dtype=bool), BOTTOM, TOP, still_open)


def lane_by_lane(lanes, times, level):
    """P at one ln f, where lane i is counted so many times."""
    counts = lanes.weight * NORMAL.density(lanes.log_factor - level) * times
    share = sum(counts[lanes.over]) / sum(counts)
    above = 1.0 - NORMAL.below(TOP - level)
    return (1.0 - above - NORMAL.below(BOTTOM - level)) * share + above


def ends(name, values):
    """The first one, and the 10th from below and from above of the 200 others: a twentieth lies outside of each."""
    low, high = np.sort(values[1:])[[9, 190]]
    return {name: values[0], f"{name}_low": low, f"{name}_high": high}


def test_lanes_are_drawn_as_often_as_there_are_lanes():
    counts = _counts(50)
    assert counts.shape == (201, 50)
    assert np.all(counts[0] == 1.0)
    assert np.all(np.sum(counts, axis=1) == 50)
    # With replacement: a lane is left out with (1 - 1/50)^50 = 0.364, and its times have a variance of 1 - 1/50.
    assert np.mean(counts[1:] == 0.0) == pytest.approx(0.364, abs=0.01)
    assert np.mean(np.var(counts[1:], axis=0)) == pytest.approx(0.98, abs=0.05)


@pytest.mark.parametrize("still_open", [False, True])
def test_the_factors_of_a_body_are_those_of_its_lanes_added_one_by_one(still_open):
    lanes = mixed_lanes(still_open)
    read = lane_factors(lanes, NORMAL, REACH, 1e3)
    lowest, highest = min(lanes.log_factor[lanes.over]), max(lanes.log_factor[~lanes.over])
    end = TOP - REACH if still_open else highest + REACH
    # The levels next to where nothing has overturned yet and where all have, multiples of 0.04.
    assert 0.04 * read.first <= lowest - REACH < 0.04 * (read.first + 1)
    assert 0.04 * (read.first + read.probability.size - 2) < end <= 0.04 * (read.first + read.probability.size - 1)
    logs = 0.04 * np.arange(read.first, read.first + read.probability.size)
    rows = np.array([[lane_by_lane(lanes, times, level) for level in logs] for times in _counts(50)])
    rows = rising(rows)
    assert read.probability == pytest.approx(rows[0], abs=1e-12)
    expected = ends("at_one", rows[:, -read.first])
    expected |= ends("factor_10", factor_at(0.1, np.exp(logs), rows))
    expected |= ends("factor_50", factor_at(0.5, np.exp(logs), rows))
    if still_open:
        areas = [sum(0.04 * (1.0 - 0.5 * (a + b)) for a, b in pairwise(row)) for row in rows]
        least = ends("least", np.exp(logs[0] + np.array(areas)))["least_low"]
        expected |= {"capacity_mean": np.inf, "capacity_mean_low": least, "capacity_mean_high": np.inf}
    else:
        expected |= ends("capacity_mean", mean_capacity(np.exp(logs), rows))
    assert read.found == pytest.approx(expected, rel=1e-9)
    shown = read.at(np.array([read.first - 3, read.first - 1, read.first, read.first + 5, read.first + 500]))
    assert shown.tolist() == [0.0, 0.0, read.probability[0], read.probability[5], read.probability[-1]]


def test_factors_above_the_largest_one_are_not_reached():
    lanes = mixed_lanes()
    free = lane_factors(lanes, NORMAL, REACH, 1e3).found
    limit = free["factor_50"]
    found = lane_factors(lanes, NORMAL, REACH, limit).found
    assert found["factor_50"] == limit
    assert found["factor_50_low"] == free["factor_50_low"] < limit
    assert found["factor_50_high"] == np.inf
    assert [found[name] for name in free if "10" in name or "at_one" in name] == [
        free[name] for name in free if "10" in name or "at_one" in name
    ]
    less = lane_factors(lanes, NORMAL, REACH, 0.9 * free["factor_10_low"]).found
    assert (less["factor_10"], less["factor_10_low"]) == (np.inf, 0.9 * free["factor_10_low"])


def test_a_body_that_nothing_lifts_never_overturns():
    found = lane_factors(None, NORMAL, REACH, 7.0)
    assert [found.found[f"at_one{end}"] for end in ("", "_low", "_high")] == [0.0, 0.0, 0.0]
    for name in ("factor_10", "factor_50", "capacity_mean"):
        assert [found.found[f"{name}{end}"] for end in ("", "_low", "_high")] == [np.inf, 7.0, np.inf]
    assert found.at(np.array([-3, 0, 3])).tolist() == [0.0, 0.0, 0.0]


def edge_lanes(edge, bottom, top):
    """41 lanes that overturn above an edge."""
    logs = np.linspace(bottom, top, 41)
    return BodyLanes(logs, np.full(41, (top - bottom) / 41), logs > edge, np.zeros(41, dtype=bool), bottom, top, False)


@pytest.mark.parametrize(("edge", "first"), [(0.125, 0), (0.165, 1), (0.085, -1)])
def test_the_probability_at_one_is_zero_below_the_first_level(edge, first):
    """The first lane that overturns lies less than 0.01 above the edge, the first level 0.1 below it or more."""
    lanes = edge_lanes(edge, 0.0, 0.4)
    found = lane_factors(lanes, NORMAL, 0.1, 10.0)
    assert found.first == first
    assert (found.found["at_one"] > 0.0) == (first <= 0)
    assert found.found["at_one"] == (0.0 if first > 0 else found.probability[-first])
    assert (found.found["at_one_high"] > 0.0) == (first <= 0)


def test_the_probability_at_one_is_the_last_one_where_levels_end_below_it():
    lanes = edge_lanes(-0.7, -0.9, -0.5)
    found = lane_factors(lanes, NORMAL, 0.1, 10.0)
    assert found.first + found.probability.size - 1 < 0
    assert found.found["at_one"] == found.probability[-1]


@pytest.mark.parametrize(("apart", "alone"), [(0.32, True), (0.29, False)])
@pytest.mark.parametrize("over", [False, True])
def test_lanes_that_count_less_than_a_hundredth_of_the_most_do_not_disagree(apart, alone, over):
    """exp(-x^2/2) is 0.01 at x = 3.03 standard deviations."""
    logs = np.append(np.linspace(-0.1, 0.1, 21), -apart if over else apart)
    verdicts = np.append(np.full(21, over), not over)
    lanes = BodyLanes(logs, np.full(22, 0.01), verdicts, np.zeros(22, dtype=bool), -0.5, 0.5, open=False)
    found = lane_factors(lanes, NORMAL, 0.6, 10.0).found
    bells = np.exp(-0.5 * (logs / 0.1) ** 2)
    sure = 0.05 ** (np.sum(bells**2) / np.sum(bells) ** 2)
    above = ndtr(-5.0)
    inside = 1.0 - 2.0 * above
    bound = inside * sure + above if over else inside * (1.0 - sure) + above
    assert (found["at_one_low" if over else "at_one_high"] == pytest.approx(bound, abs=1e-12)) == alone


@pytest.mark.parametrize("over", [False, True])
def test_levels_where_all_lanes_agree_begin_at_an_end_of_them(over):
    lanes = edge_lanes(-5.0 if over else 5.0, -0.41, 0.37)
    found = lane_factors(lanes, NORMAL, 0.2, 10.0)
    last = found.first + found.probability.size - 1
    assert (found.first, last) == ((-16, -5) if over else (4, 15))
