"""The space of sequences that a response calibration searches."""

import numpy as np
import pytest

from rockpulse.calibration.response_search import INTERVAL, RATIO, explore, search_space, start_point
from rockpulse.calibration.response_targets import ResponseTargets, block_family
from rockpulse.models import ImpulseSequence, sequence_response


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


def test_a_point_gives_back_its_sequence():
    given = ImpulseSequence(0.21, 0.084, 0.13, 12.0, main_count=5, spacing="middle")
    space = search_space(targets(given), given, "middle")
    back = space.sequence(start_point(space, given))
    assert (back.main, back.secondary, back.interval) == pytest.approx((0.21, 0.084, 0.13), rel=1e-12)
    assert (back.main_count, back.duration, back.spacing) == (5, 12.0, "middle")


def test_the_start_widens_the_limits():
    given = ImpulseSequence(0.21, 0.084, 0.2, 12.0, main_count=4)
    far = ImpulseSequence(9.0, 0.9, 0.011, 12.0, main_count=33)
    space = search_space(targets(given), far, "end")
    point = start_point(space, far)
    assert np.all((space.low <= point + 1e-12) & (point <= space.high + 1e-12))


def test_no_ratio_is_searched_at_which_the_block_would_touch_the_ground():
    given = ImpulseSequence(0.21, 0.084, 0.2, np.inf, main_count=4, spacing="start")
    space = search_space(targets(given), None, "start")
    edge = np.array([space.low, space.high])
    edge[:, RATIO], edge[:, INTERVAL] = space.high[RATIO], np.log([0.1, 0.5])
    for sequence in (space.sequence(point) for point in edge):
        assert not np.any(sequence_response(block_family(), sequence, table_rows=0, threads=1).ground_contact)


def test_the_likely_region_is_filled_with_candidates():
    data = targets(ImpulseSequence(0.3, 0.18, 0.2, np.inf, main_count=3))
    explored = explore(data, search_space(data, None, "end"), None, 10.0, np.random.default_rng(0), threads=1)
    deviance = 2.0 * (explored.likelihood.max() - explored.likelihood)
    assert np.count_nonzero(deviance <= 10.0) > 500
    assert np.count_nonzero(deviance <= 3.0) > 200


@pytest.mark.sweep
def test_every_candidate_is_inside_the_limits_and_the_start_is_the_first():
    given = ImpulseSequence(0.3, 0.18, 0.2, np.inf, main_count=3)
    data = targets(given)
    space = search_space(data, given, "end")
    point = start_point(space, given)
    explored = explore(data, space, point, 10.0, np.random.default_rng(0), threads=1)
    assert np.array_equal(explored.points[0], point)
    assert np.all((explored.points >= space.low - 1e-9) & (explored.points <= space.high + 1e-9))
    assert np.array_equal(explored.points[:, 3], np.rint(explored.points[:, 3]))
    # Censored targets leave room for a shade more than the truth.
    assert explored.likelihood.max() - explored.likelihood[0] < 0.1
