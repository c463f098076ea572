"""Motions of several directions and earthquakes: what is kept, where something is so, and means over earthquakes."""

import numpy as np
import pytest

from rockpulse.assessment.answers import Motions
from rockpulse.selection.events import UNKNOWN

NAN = np.nan
#: Three motions of two directions from five records; of the last one a direction was not assessed.
INDEX = np.array([[0, 1], [2, 3], [4, -1]])
PAIRS = Motions(["x", "y", "z"], INDEX, ["a", "b", "a"], "pair")


@pytest.mark.parametrize(
    ("events", "count"), [(["a", "b", "a", UNKNOWN], 2), ([UNKNOWN] * 3, 1), (["a"], 1), ([], 0), ([UNKNOWN, "a"], 1)]
)
def test_earthquakes_that_are_known_are_counted_or_one(events, count):
    assert Motions(["x"] * len(events), np.zeros((len(events), 1), int), events, "record").event_count == count


def test_a_motion_is_kept_for_a_body_where_a_direction_is():
    left_out = np.array([[True, True], [True, False], [False, True], [True, True], [True, False]])
    kept = PAIRS.kept(left_out)
    assert kept.tolist() == [[False, True], [True, False], [False, True]]
    assert PAIRS.event_counts(kept).tolist() == [1, 1]
    assert PAIRS.event_counts(np.array([[True, True, False], [True, False, False], [False, True, False]])).tolist() == [
        2,
        1,
        0,
    ]


def test_values_are_taken_by_motion_and_direction():
    values = np.array([1, 2, 3, 4, 5])
    assert PAIRS.over(values, -9).tolist() == [[1, 2], [3, 4], [5, -9]]
    over = PAIRS.over(np.stack([values, 10.0 * values], axis=1), NAN)
    assert over.shape == (3, 2, 2)
    np.testing.assert_array_equal(over[:, :, 1], [[10.0, 20.0], [30.0, 40.0], [50.0, NAN]])


def test_something_is_so_in_one_direction_or_in_a_missing_one():
    so = np.array([[False, True], [True, True], [False, False], [False, False], [False, True]])
    assert PAIRS.anywhere(so).tolist() == [[True, True], [False, False], [False, True]]
    assert PAIRS.anywhere(so, missing=True).tolist() == [[True, True], [False, False], [True, True]]


def test_earthquakes_weigh_alike_and_what_is_not_known_is_left_out():
    values = np.array([[0.2, NAN, NAN], [0.6, 0.5, NAN], [0.4, 0.1, NAN]])
    assert PAIRS.mean(values) == pytest.approx([(0.3 + 0.6) / 2, (0.1 + 0.5) / 2, NAN], nan_ok=True)
    assert PAIRS.mean(np.array([NAN, 0.5, NAN])) == pytest.approx(0.5)


@pytest.mark.parametrize("any_azimuth", [False, True])
def test_the_share_of_each_body_is_over_its_motions(any_azimuth):
    """The worst direction, or the mean over them; a missing one may be 0 or 1."""
    probability = np.array([[0.2, 1.0], [0.4, 0.5], [0.1, 0.0], [0.3, NAN], [0.6, 1.0]])
    of = Motions(PAIRS.names, INDEX, PAIRS.events, "pair", any_azimuth)
    first, second = of.shares(probability)
    if any_azimuth:  # 0.3, 0.2 and 0.3 to 0.8; 0.75, 0 to 0.5 and 0.5 to 1
        expected = [((0.3 + 0.2) / 2, (0.3 + 0.2) / 2, (0.55 + 0.2) / 2, 1), (0.75, 0.625 / 2, (0.875 + 0.5) / 2, 2)]
    else:  # 0.4, 0.3 and 0.6 to 1; 1, 0 to 1 and 1
        expected = [((0.4 + 0.3) / 2, (0.5 + 0.3) / 2, (0.7 + 0.3) / 2, 1), (1.0, 0.5, 1.0, 1)]
    for share, (value, least, most, unknown) in zip((first, second), expected, strict=True):
        assert (share.value, share.least, share.most, share.unknown) == pytest.approx((value, least, most, unknown))
        assert share.low < share.value <= share.high
    left_out = np.array([[True, False]] * 2 + [[False, False]] * 3)
    first, _ = of.shares(probability, left_out)
    assert first.unknown == 1
    assert first.least == pytest.approx((0.2 + 0.3) / 2 if any_azimuth else (0.3 + 0.6) / 2)
