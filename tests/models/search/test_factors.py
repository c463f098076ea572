"""Intervals of exceedance on functions whose edges are known."""

import numpy as np
import pytest

from rocking import exceedance_intervals
from rocking.search.factors import CASES_AT_ONCE, ScaleIntervals


def bands(*edges):
    """exceeds() of one lane or more that exceed from each first to each second edge."""
    return lambda lanes, factors: np.any([(factors >= low) & (factors <= high) for low, high in edges], axis=0)


def test_every_edge_is_found_to_its_tolerance():
    found = exceedance_intervals(bands((1.3, 1.5), (4.0, 6.0)), [0.1], 10.0, 64)
    assert found.lower == pytest.approx([1.3, 4.0], rel=1e-6)
    assert found.upper == pytest.approx([1.5, 6.0], rel=1e-6)
    assert np.all((found.lower >= [1.3, 4.0]) & (found.upper <= [1.5, 6.0]))  # exceeded at both ends
    assert found.safety_factor == found.lower[0]
    assert 0.0 < found.safety_factor[0] / found.safe_up_to[0] - 1.0 <= 1.0001e-6
    assert found.safe_up_to[0] < 1.3
    assert list(found.lane) == [0, 0]
    assert not found.open.any()
    assert found.resolved.all()
    assert list(found.count) == [2]
    assert found.step == pytest.approx(100.0 ** (1.0 / 63.0))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-9, 1e-12])
def test_a_bracket_is_as_narrow_as_asked_for(tolerance):
    found = exceedance_intervals(bands((np.e, 99.0)), [0.1], 10.0, 16, tolerance)
    assert found.safety_factor[0] / found.safe_up_to[0] - 1.0 <= tolerance * 1.001
    assert found.safety_factor[0] / found.safe_up_to[0] - 1.0 > tolerance * 0.47
    assert found.safe_up_to[0] < np.e <= found.safety_factor[0]


def test_exceedance_at_the_end_of_the_search_is_open():
    found = exceedance_intervals(bands((2.0, 3.0), (7.0, 99.0)), [0.5], 10.0, 64)
    assert list(found.open) == [False, True]
    assert found.upper[1] == 10.0


def test_nothing_up_to_the_end_of_the_search_is_infinity():
    found = exceedance_intervals(bands((11.0, 12.0)), [0.1], 10.0, 64)
    assert (found.safety_factor[0], found.safe_up_to[0]) == (np.inf, 10.0)
    assert found.lane.size == found.lower.size == found.upper.size == found.open.size == 0


@pytest.mark.parametrize("start", [12.0, np.inf])
def test_a_start_beyond_the_search_is_not_asked_for(start):
    def never(lanes, factors):
        raise AssertionError

    found = exceedance_intervals(never, [start], 10.0, 64)
    assert (found.safety_factor[0], found.safe_up_to[0]) == (np.inf, 10.0)
    assert found.step[0] == 1.0  # known without a search: nothing is missed


def test_a_lane_that_exceeds_from_the_start_has_that_edge():
    found = exceedance_intervals(bands((0.5, 99.0)), [0.5], 10.0, 64)
    assert found.safety_factor[0] == found.safe_up_to[0] == found.lower[0] == 0.5
    assert found.open[0]


def test_what_has_no_answer_counts_as_exceeding():
    def answers(lanes, factors):
        return np.where((factors > 1.234) & (factors < 5.0), np.nan, np.where(factors > 7.0, 2.0, 0.5))

    found = exceedance_intervals(answers, [0.1], 10.0, 64)
    assert found.lower == pytest.approx([1.234, 7.0], rel=1e-6)
    assert found.upper == pytest.approx([5.0, 10.0], rel=1e-6)


def test_a_factor_is_resolved_unless_the_first_interval_of_its_lane_is_not():
    found = exceedance_intervals(bands((1.0, 2.0), (4.0, 5.0)), [20.0, 0.1, 0.2, 20.0, 0.3], 10.0, 64)
    assert list(found.lane) == [1, 1, 2, 2, 4, 4]
    assert found.factor_resolved.all()
    found = found.changed(resolved=np.array([False, True, True, False, False, False]))
    assert list(found.factor_resolved) == [True, False, True, True, False]


def test_a_lane_may_be_the_first_that_exceeds():
    def exceeds(lanes, factors):
        return np.where((lanes == 1) & (factors > 2.0), 2.0, 0.5)

    found = exceedance_intervals(exceeds, [0.1, 0.1, 0.1], 10.0, 64)
    assert list(found.lane) == [1]
    assert found.safety_factor == pytest.approx([np.inf, 2.0, np.inf], rel=1e-6)
    assert found.safe_up_to == pytest.approx([10.0, 2.0, 10.0], rel=1e-6)


def test_no_lane_has_no_interval():
    found = exceedance_intervals(bands((1.0, 2.0)), [], 10.0, 64)
    assert found.safety_factor.size == found.lane.size == found.count.size == 0


@pytest.mark.parametrize("points", [2, 3, 17])
def test_lanes_may_have_numbers_of_factors_of_their_own(points):
    found = exceedance_intervals(bands((3.0, 99.0)), [0.1, 0.2], 10.0, [points, 40])
    alone = exceedance_intervals(bands((3.0, 99.0)), [0.1], 10.0, points)
    assert found.safety_factor[0] == alone.safety_factor[0]
    assert found.step[0] == alone.step[0]
    assert found.safety_factor == pytest.approx([3.0, 3.0], rel=1e-6)


def test_a_narrow_band_is_found_where_the_lane_comes_near_it():
    def near(lanes, factors):
        return np.where(np.abs(factors - 1.234) < 4e-4, np.inf, np.exp(-(((factors - 1.234) / 0.1) ** 2)) * 0.95)

    def blind(lanes, factors):
        return near(lanes, factors) > 1.0

    assert exceedance_intervals(near, [0.1], 10.0, 64).safety_factor == pytest.approx([1.234], rel=4e-4)
    assert exceedance_intervals(blind, [0.1], 10.0, 64).safety_factor[0] == np.inf


def test_a_narrow_band_is_found_where_the_reach_changes_abruptly():
    # The lane stays as far from its limit in both; that the reach jumps next to the band is all that tells.
    def beside(low):
        return lambda lanes, factors: np.where(
            np.abs(factors - 1.206) < 2e-3, np.inf, np.where(factors > 1.2, 0.6, low)
        )

    assert exceedance_intervals(beside(0.0), [0.1], 10.0, 64).safety_factor == pytest.approx([1.204], rel=1e-6)
    assert exceedance_intervals(beside(0.6), [0.1], 10.0, 64).safety_factor[0] == np.inf


def test_many_lanes_give_what_each_alone_gives():
    rng = np.random.default_rng(5)
    points = 48
    count = 2 * (CASES_AT_ONCE // points) + 7
    begin = np.geomspace(0.02, 30.0, count)
    length = rng.uniform(0.05, 0.5, count)
    start = rng.uniform(0.01, 0.9, count) * np.minimum(begin, 12.0)

    def exceeds(lanes, factors):
        return ((factors >= begin[lanes]) & (factors < begin[lanes] * (1.0 + length[lanes]))) | (factors > 9.9)

    found = exceedance_intervals(exceeds, start, 10.0, points)
    assert np.all(np.diff(found.lane) >= 0)
    for lane in range(0, count, 61):
        alone = exceedance_intervals(
            lambda _, f, k=lane: exceeds(np.full(f.shape[1], k), f), [start[lane]], 10.0, points
        )
        mine = found.lane == lane
        assert found.safety_factor[lane] == alone.safety_factor[0]
        assert np.array_equal(found.lower[mine], alone.lower)
        assert np.array_equal(found.upper[mine], alone.upper)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0.0], 10.0, 64), "start: expected positive"),
        (([np.nan], 10.0, 64), "start: expected positive"),
        (([0.5], np.inf, 64), "factor_max: expected a positive number"),
        (([0.5], 0.0, 64), "factor_max: expected a positive number"),
        ((0.5, 10.0, 64), "start: expected a scale factor for each block, .* got shape"),
        (([0.5], 10.0, 1), "points: expected whole numbers from 2"),
        (([0.5], 10.0, 64.5), "points: expected whole numbers from 2"),
        (([0.5], 10.0, np.nan), "points: expected whole numbers from 2"),
        (([0.5], 10.0, 1e11), "points: expected whole numbers from 2"),
        (([0.5], 10.0, 64, 0.0), "tolerance: expected at least 1e-12"),
        (([0.5], 10.0, 64, 1.0), "tolerance: expected at least 1e-12 and below 1"),
        (([0.5], 10.0, 64, 1.5), "tolerance: expected at least 1e-12 and below 1"),
    ],
)
def test_what_is_out_of_range_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        exceedance_intervals(bands((1.0, 2.0)), *arguments)


def step_by_step(reach, start, points):
    """One lane of the search up to 10, as its notes tell it: all factors asked for, and the edges found."""
    grid = [start * (10.0 / start) ** (k / (points - 1)) for k in range(points - 1)] + [10.0]
    rows = [(x, reach(x), 0) for x in sorted({*grid, min(max(1.0, start), 10.0)})]
    while True:
        first = min((x for x, one, _ in rows if one >= 1.0), default=np.inf)
        near, last = [min(one, 1.0) for _, one, _ in rows], len(rows) - 1
        bend = [abs(near[k + 1] - 2.0 * near[k] + near[k - 1]) if 0 < k < last else 0.0 for k in range(last + 1)]
        due = [
            k
            for k in range(last)
            if rows[k][0] < first
            and max(near[k : k + 2]) + max(bend[k : k + 2]) >= (0.2, 0.45, 0.7, 0.95, 1.2, 1.45, np.inf)[rows[k][2]]
        ]
        if not due:
            break
        for k in reversed([k for place, k in enumerate(due) if place < max(4, len(due) / 2)]):
            (low, one, times), middle = rows[k], (rows[k][0] * rows[k + 1][0]) ** 0.5
            rows[k : k + 1] = [(low, one, times + 1), (middle, reach(middle), times + 1)]
    asked = [x for x, _, _ in rows]
    over, edges = [one >= 1.0 for _, one, _ in rows], []
    for k in range(1, len(rows)):
        if over[k] != over[k - 1]:
            low, high = asked[k - 1 : k + 1]
            while high - low > 1e-6 * high:
                middle = 0.5 * (low + high)
                asked.append(middle)
                low, high = (low, middle) if (reach(middle) >= 1.0) == over[k] else (middle, high)
            edges.append(high if over[k] else low)
    return np.unique(asked), edges


@pytest.mark.parametrize("seed", range(2))
def test_the_search_is_the_one_that_its_notes_tell(seed):
    """Four lanes whose reach has several peaks, against the search of each alone and step by step."""
    rng = np.random.default_rng(seed)
    at, height = rng.uniform(np.log(0.2), np.log(12.0), (4, 5)), rng.uniform(0.1, 1.15, (4, 5))
    height[3] *= 0.8
    start, points = np.array([0.1, 0.35, 1.2, 0.1]), np.array([40, 9, 24, 33])

    def reach(lane, factor):
        return np.max(height[lane] * np.exp(-(((np.log(factor) - at[lane]) / 0.08) ** 2)))

    asked = [[] for _ in start]

    def ask(lanes, factors):
        for column, lane in enumerate(lanes):
            asked[lane].extend(factors[:, column])
        return np.array([[reach(lane, one) for lane, one in zip(lanes, row, strict=True)] for row in factors])

    found = exceedance_intervals(ask, start, 10.0, points)
    for lane in range(4):
        expected, edges = step_by_step(lambda factor, lane=lane: reach(lane, factor), start[lane], points[lane])
        assert np.unique(np.round(asked[lane], 9)) == pytest.approx(np.unique(np.round(expected, 9)))
        mine = np.sort(np.concatenate([found.lower[found.lane == lane], found.upper[found.lane == lane]]))
        assert mine[mine < 10.0] == pytest.approx(edges, rel=1e-9)


def test_a_search_that_starts_at_its_end_looks_there():
    found = exceedance_intervals(bands((5.0, 20.0)), [10.0, 10.1], 10.0, 64)
    assert found.safety_factor.tolist() == [10.0, np.inf]
    assert found.safe_up_to.tolist() == [10.0, 10.0]
    assert (found.lane.tolist(), found.open.tolist()) == ([0], [True])
    assert found.step.tolist() == [1.0, 1.0]


def test_lanes_that_were_not_searched_stand_among_the_others():
    some = exceedance_intervals(bands((1.0, 2.0), (4.0, 5.0)), [0.1, 20.0], 10.0, 64)
    whole = some.among(np.array([False, True, False, True]))
    for name in ("safety_factor", "safe_up_to", "step"):
        values = getattr(whole, name)
        assert values[[1, 3]].tolist() == getattr(some, name).tolist()
        assert np.isnan(values[[0, 2]]).all()
    assert whole.lane.tolist() == [1, 1]
    assert whole.count.tolist() == [0, 2, 0, 0]
    assert (whole.lower.tolist(), whole.upper.tolist()) == (some.lower.tolist(), some.upper.tolist())
    unknown = ScaleIntervals.unknown((3,))
    assert unknown.count.tolist() == [0, 0, 0]
    assert np.isnan([unknown.safety_factor, unknown.safe_up_to, unknown.step]).all()
    assert [getattr(unknown, name).size for name in ("lower", "upper", "open", "resolved")] == [0, 0, 0, 0]
