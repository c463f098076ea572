"""Lanes of a half-cycle kernel and its table, with a kernel that writes numbers known beforehand."""

import numpy as np
import pytest

from rocking.impulses.sequence_kernel import combined, empty_table, tabulated_response


def test_every_combination_of_inputs_and_blocks_has_the_blocks_running_fastest():
    shape, drop, flat = combined(([1.0, 2.0], 5.0), ([10.0, 20.0, 30.0], [7.0, 8.0, 9.0]))
    assert (shape, drop) == ((2, 3), (False, False))
    assert [values.tolist() for values in flat] == [
        [1.0, 1.0, 1.0, 2.0, 2.0, 2.0],
        [5.0] * 6,
        [10.0, 20.0, 30.0] * 2,
        [7.0, 8.0, 9.0] * 2,
    ]
    assert combined((1.0, 2.0), ([3.0, 4.0], 0.0))[:2] == ((1, 2), (True, False))
    assert combined(([1.0, 2.0], 2.0), (3.0, 0.0))[:2] == ((2, 1), (False, True))
    assert combined((1.0,), (3.0,))[:2] == ((1, 1), (True, True))


def test_pairs_are_one_input_for_each_block():
    shape, drop, flat = combined(([1.0, 2.0], 5.0), ([10.0, 20.0], [7.0, 8.0]), paired=True)
    assert (shape, drop) == ((1, 2), (True, False))
    assert [values.tolist() for values in flat] == [[1.0, 2.0], [5.0, 5.0], [10.0, 20.0], [7.0, 8.0]]
    for inputs, blocks in ((([1.0, 2.0],), (3.0,)), ((1.0,), ([3.0, 3.0],))):
        shape, drop, flat = combined(inputs, blocks, paired=True)
        assert (shape, drop) == ((1, 2), (True, False))
        assert [values.size for values in flat] == [2, 2]
    assert combined((1.0,), (3.0,), paired=True)[:2] == ((1, 1), (True, True))
    assert all(values.flags.writeable for values in flat)
    with pytest.raises(ValueError, match="expected one sequence for each block, got 1 for 2 blocks"):
        combined(([1.0],), ([1.0, 2.0],), paired=True)


def test_an_empty_table_says_of_no_half_cycle_how_many_impulses_it_had():
    table = empty_table(2, 3)
    assert table.columns.shape == (6, 2, 3)
    assert np.all(table.columns[3] == -1.0)
    assert np.isnan(np.delete(table.columns, 3, axis=0)).all()
    assert (table.lowest.shape, table.followed.shape, table.followed.dtype) == ((3,), (3,), np.int64)


def answered(rows, followed=(2, 4, 0, 1, 3, 2), shape=(2, 3), drop=(False, False), **options):
    """The response of a kernel that numbers column, row and lane; lane 0 is at the limit of a contact, 1 beyond it."""
    runs = []

    def kernel(first, last, lanes, results, table):
        runs.append((first, last, lanes, table.columns.shape[1]))
        for lane in range(first, last):
            for values in results:
                values[lane] = lane
            table.followed[lane] = followed[lane]
            table.lowest[lane] = (-1e-12, -1.01e-12, 0.0, 1.0, -1.0, -1e-13)[lane]
            for row in range(min(table.columns.shape[1], followed[lane])):
                table.columns[:, row, lane] = 100.0 * np.arange(6) + 10.0 * row + lane

    return tabulated_response(kernel, ("lanes",), shape, drop, rows, **options), runs


@pytest.mark.parametrize(("rows", "kept"), [(1000, 4), (4, 4), (3, 3), (1, 1)])
def test_a_table_is_as_long_as_the_longest_motion_or_as_it_may_be(rows, kept):
    response, runs = answered(rows)
    assert runs == [(0, 6, ("lanes",), 0), (0, 6, ("lanes",), kept)]
    table = response.half_cycles
    assert table.peak.shape == (kept, 2, 3)
    assert np.array_equal(table.start_velocity[0], [[0.0, 1.0, np.nan], [3.0, 4.0, 5.0]], equal_nan=True)
    assert table.impulse_count.dtype == np.int64
    assert table.impulse_count[0].tolist() == [[300, 301, -1], [303, 304, 305]]
    assert np.array_equal(table.impact_speed[kept - 1, 0, 1], 500.0 + 10.0 * (kept - 1) + 1.0)
    assert response.peak_rotation_ratio.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert response.ground_contact.tolist() == [[False, True, False], [False, True, False]]


def test_no_table_is_made_where_none_is_asked_for_and_none_is_negative():
    response, runs = answered(0)
    assert response.half_cycles is None
    assert [run[3] for run in runs] == [0]
    assert response.outcome.tolist() == [[0, 1, 2], [3, 4, 5]]
    with pytest.raises(ValueError, match="table_rows: expected 0"):
        answered(-1)


def test_a_table_of_no_motion_or_of_no_lane_has_no_rows():
    response, runs = answered(5, followed=(0,) * 6, shape=(1, 6), drop=(True, False))
    assert response.half_cycles.peak.shape == (0, 6)
    assert [run[3] for run in runs] == [0, 0]
    assert response.peak_rotation_ratio.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    empty, _ = answered(5, shape=(2, 0))
    assert empty.half_cycles.peak.shape == (0, 2, 0)
