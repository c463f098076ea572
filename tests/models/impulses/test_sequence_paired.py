"""A sequence of its own for every block."""

import numpy as np
import pytest
from test_sequence_lanes import FIELDS, bodies, one, sequences

from rocking.impulses.sequence import sequence_response


@pytest.mark.parametrize("spacing", ["end", "continuous"])
def test_pairs_answer_as_one_by_one(spacing):
    blocks, many = bodies(40), sequences(40, spacing=spacing)
    response = sequence_response(blocks, many, paired=True, threads=2)
    assert response.outcome.shape == (40,)
    for lane in range(0, 40, 7):
        alone = sequence_response(blocks.lane(lane), one(many, lane))
        for name in FIELDS:
            assert np.array_equal(getattr(response, name)[lane], getattr(alone, name), equal_nan=True), name
        rows = alone.half_cycles.peak.shape[0]
        assert np.array_equal(response.half_cycles.peak[:rows, lane], alone.half_cycles.peak, equal_nan=True)


def test_one_of_either_goes_with_all_of_the_other():
    blocks, many = bodies(6), sequences(6)
    assert np.array_equal(
        sequence_response(blocks, one(many, 2), paired=True).outcome, sequence_response(blocks, one(many, 2)).outcome
    )
    assert np.array_equal(
        sequence_response(blocks.lane(1), many, paired=True).outcome, sequence_response(blocks.lane(1), many).outcome
    )
    assert np.ndim(sequence_response(blocks.lane(1), one(many, 2), paired=True).outcome) == 0


def test_pairs_of_different_numbers_are_refused():
    with pytest.raises(ValueError, match="one sequence for each block, got 5 for 6"):
        sequence_response(bodies(6), sequences(5), paired=True)
