"""The design sequence of samples in which the answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from rockpulse.earthquakes import draw_earthquakes
from rockpulse.errors import RecordRefused
from rockpulse.models import Block, ImpulseSequence, sequence_response
from rockpulse.studies.site.design import (
    BEYOND,
    SiteSample,
    correlation,
    covered_rotations,
    design_sequence,
    main_impulse_interval,
    overturning_limit,
)
from rockpulse.studies.site.sequence_design import counted_pairs, coverage_of, leave_one_event_out, untested_events

BLOCKS = Block(half_width=[0.25, 0.4, 0.6], half_height=[1.2, 1.6, 1.8], restitution=0.9)


def rotations(mains, ratio=0.3, count=2):
    """Peaks under sequences that differ in their size alone: the motion of record r is that of main impulse r."""
    sequences = ImpulseSequence(np.asarray(mains), ratio * np.asarray(mains), 0.1, 20.0, count)
    return np.asarray(sequence_response(BLOCKS, sequences).peak_rotation_ratio)


def sample_of(mains, events=None, weights=None, peaks=None):
    mains = np.asarray(mains, dtype=float)
    values = np.column_stack(
        [mains, np.full(mains.size, 0.3), np.full(mains.size, 0.1), np.full(mains.size, 2.0), np.full(mains.size, 20.0)]
    )
    return SiteSample(
        values=values,
        peaks=rotations(mains) if peaks is None else peaks,
        weights=np.ones(mains.size) if weights is None else np.asarray(weights, dtype=float),
        events=np.arange(mains.size) if events is None else np.asarray(events),
        blocks=BLOCKS,
        spacing="end",
    )


MAINS = 0.05 * 1.1 ** np.arange(10)  # none of them overturns a block


@pytest.mark.parametrize(("quantile", "record"), [(0.05, 0), (0.1, 0), (0.5, 4), (0.84, 8), (0.95, 9)])
def test_the_design_is_the_record_that_has_the_share_at_or_below_it(quantile, record):
    design = design_sequence(sample_of(MAINS), quantile)
    assert design.main == pytest.approx(MAINS[record], rel=2e-4)
    assert (design.secondary / design.main, design.interval) == (pytest.approx(0.3), pytest.approx(0.1))
    assert (design.main_count, design.duration, design.spacing) == (2, pytest.approx(20.0), "end")


def test_a_motion_twice_as_strong_gives_the_design_of_the_stronger_motion():
    weak = design_sequence(sample_of(MAINS), 0.84)
    strong = design_sequence(sample_of(1.5 * MAINS), 0.84)
    assert strong.main == pytest.approx(1.5 * weak.main, rel=4e-4)


def test_blocks_that_the_design_overturns_do_not_buy_the_quantile_for_the_others():
    # The first block is overturned by most records, which any strong sequence covers; the others rock as recorded.
    peaks = rotations(MAINS)
    peaks[2:, 0] = np.inf
    design = design_sequence(sample_of(MAINS, peaks=peaks), 0.9)
    marks = covered_rotations(sample_of(MAINS, peaks=peaks), design)
    standing = marks != BEYOND
    assert not standing[:, 0].any()
    assert np.mean(marks[standing]) >= 0.9 - 1e-12


def test_pairs_at_rest_do_not_count():
    peaks = rotations(MAINS)
    peaks[:5] = np.nan
    design = design_sequence(sample_of(MAINS, peaks=peaks), 0.5)
    assert design.main == pytest.approx(MAINS[7], rel=2e-4)  # the third of the five that count
    marks = covered_rotations(sample_of(MAINS, peaks=peaks), design)
    assert np.isnan(marks[:5]).all()
    assert not np.isnan(marks[5:]).any()


def test_a_sample_in_which_nothing_rocks_has_no_design():
    with pytest.raises(RecordRefused, match="no record lifts a block"):
        design_sequence(sample_of(MAINS, peaks=np.full((10, 3), np.nan)), 0.5)


def test_a_shape_that_no_size_makes_strong_enough_is_refused():
    # With "start" the first secondary impulse takes all of an equal main one away.
    sample = replace(sample_of(MAINS), spacing="start")
    values = sample.values.copy()
    values[:, 1] = 1.0
    with pytest.raises(RecordRefused, match="take another spacing"):
        design_sequence(replace(sample, values=values), 0.84)


def test_the_count_of_the_design_is_a_whole_number_that_occurs():
    sample = sample_of(MAINS)
    values = sample.values.copy()
    values[:, 3] = [1, 1, 1, 1, 3, 3, 8, 8, 8, 8]
    assert design_sequence(replace(sample, values=values), 0.5).main_count == 3
    values[:, 3] = np.nan  # none has a limit
    assert design_sequence(replace(sample, values=values), 0.5).main_count is None


def test_left_out_events_are_covered_where_all_events_are_alike():
    events = np.repeat(np.arange(5), 2)
    mains = np.tile([0.06, 0.08], 5)
    found = leave_one_event_out(sample_of(mains, events), 0.9)
    assert (found.covered == 1.0).all()
    np.testing.assert_allclose(found.main, 0.08, rtol=2e-4)


def test_an_event_stronger_than_all_others_is_not_covered_without_it():
    mains = np.array([0.05, 0.05, 0.05, 0.05, 0.09])
    sample = sample_of(mains)
    found = leave_one_event_out(sample, 0.95)
    np.testing.assert_array_equal(found.covered[-1], 0.0)
    np.testing.assert_array_equal(found.covered[:-1], 1.0)
    share, lower, upper = coverage_of(found.covered, sample, 0.9)
    assert share == pytest.approx(0.8)
    assert lower < 0.5 < 0.95 < upper  # five events say little
    assert covered_rotations(sample, design_sequence(sample, 0.95)).mean() == 1.0  # in sample it looks perfect


def test_a_single_event_leaves_nothing_to_judge():
    sample = sample_of(MAINS, events=np.zeros(10, dtype=int))
    found = leave_one_event_out(sample, 0.84)
    assert np.isnan(found.covered).all()
    assert np.isnan(found.main).all()
    assert np.isnan(coverage_of(found.covered, sample, 0.9)).all()


def test_the_interval_of_the_design_holds_it_and_narrows_with_events():
    widths = []
    for repeats in (1, 6):
        sample = sample_of(np.tile(MAINS, repeats))
        design = design_sequence(sample, 0.7)
        lower, upper = main_impulse_interval(sample, design, 0.7, draw_earthquakes(10 * repeats, 400, 0), 0.9)
        assert lower < design.main < upper
        widths.append(np.log(upper / lower))
    assert widths[1] < 0.6 * widths[0]


def test_a_block_that_leaves_the_count_sets_the_design_and_is_named():
    # Half of the records overturn the first block: no rotation covers them, so I rises until it overturns.
    peaks = rotations(MAINS)
    peaks[5:, 0] = np.inf
    sample = sample_of(MAINS, peaks=peaks)
    design = design_sequence(sample, 0.84)
    fallen, below = overturning_limit(sample, design, 0.84)
    assert fallen.tolist() == [True, False, False]
    assert below == pytest.approx(25.0 / 30.0)
    ends = main_impulse_interval(sample, design, 0.84, draw_earthquakes(10, 400, 0), 0.9)
    assert np.isnan(ends[0])
    assert np.isinf(ends[1])
    reached = [sequence_response(sample.blocks, design.scaled(factor)).peak_rotation_ratio[0] for factor in (0.9999, 1)]
    assert np.isinf(reached).tolist() == [False, True]


def test_a_design_reached_by_rotations_is_set_by_no_block():
    sample = sample_of(MAINS)
    fallen, below = overturning_limit(sample, design_sequence(sample, 0.84), 0.84)
    assert not fallen.any()
    assert below == pytest.approx(0.8)


def test_a_design_that_overturns_everything_has_no_certainty():
    sample = sample_of(MAINS, peaks=np.full((10, 3), np.inf))
    design = design_sequence(sample, 0.84)
    ends = main_impulse_interval(sample, design, 0.84, draw_earthquakes(10, 400, 0), 0.9)
    assert np.isnan(ends[0])
    assert np.isinf(ends[1])


def test_resamples_that_agree_leave_a_step_of_their_grid():
    sample = sample_of(np.full(10, 0.07))
    design = design_sequence(sample, 0.84)
    lower, upper = main_impulse_interval(sample, design, 0.84, draw_earthquakes(10, 400, 0), 0.9)
    assert 0.97 < lower / design.main < 0.985
    assert 1.015 < upper / design.main < 1.03


def test_records_without_weight_judge_nothing():
    events, weights = np.repeat(np.arange(5), 2), np.repeat([1.0, 1.0, 1.0, 1.0, 0.0], 2)
    with_them = leave_one_event_out(sample_of(MAINS, events, weights), 0.5)
    without = leave_one_event_out(sample_of(MAINS[:8], events[:8]), 0.5)
    np.testing.assert_array_equal(with_them.main[:8], without.main)
    np.testing.assert_array_equal(with_them.covered[:8], without.covered)


def test_events_that_are_not_judged_are_told_with_the_reason():
    peaks = rotations(MAINS[:4])
    peaks[0] = np.nan  # lifts nothing
    peaks[1:3] = np.inf  # without the last one the others overturn all
    sample = sample_of(MAINS[:4], peaks=peaks)
    found = leave_one_event_out(sample, 0.84)
    assert untested_events(found, sample)[0] == "unlifted"
    assert untested_events(found, sample)[3] == "overturning_design"
    assert not counted_pairs(found.covered, sample)[[0, 3]].any()
    lone = sample_of(MAINS[:2], peaks=np.vstack([np.full(3, np.nan), rotations(MAINS[1:2])]))
    reasons = untested_events(leave_one_event_out(lone, 0.5), lone)
    assert reasons == {0: "unlifted", 1: "no_design"}


def test_correlation_of_weighted_records_in_closed_form():
    x, y, w = np.array([0.0, 1.0, 2.0, 5.0]), np.array([1.0, 0.0, 4.0, 2.0]), np.array([1.0, 2.0, 3.0, 1.0])
    mean = (np.average(x, weights=w), np.average(y, weights=w))
    covariance = np.average((x - mean[0]) * (y - mean[1]), weights=w)
    expected = covariance / np.sqrt(
        np.average((x - mean[0]) ** 2, weights=w) * np.average((y - mean[1]) ** 2, weights=w)
    )
    found = correlation(np.column_stack([x, y, np.full(4, 3.0)]), w)
    assert found[0, 1] == found[1, 0] == pytest.approx(expected, rel=1e-12)
    assert found[0, 0] == pytest.approx(1.0)
    assert np.isnan(found[2]).all()  # it does not vary
