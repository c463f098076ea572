"""The table of the accuracy report on bodies by kind."""

import numpy as np
import pytest

from rocking.march.recorded import recorded_response
from rockpulse.record.synthetic import synthetic_motion
from rockpulse.studies.accuracy.bodies import DT, PLAIN, SCALES, bodies_table, kinds


@pytest.fixture(scope="module")
def table():
    return bodies_table(seed=3, motions=2, repeats=1).set_index("kind")


def test_every_kind_is_there_and_judged(table):
    assert [*table.index] == [*kinds()] == [PLAIN, *[*kinds()][1:]]
    assert (table["cases"] == 2 * len(SCALES) * kinds()[PLAIN].shape[0]).all()
    assert (table["compared"] > 0).all()
    assert table.loc[PLAIN, "times_plain"] == 1.0


def test_shorter_steps_change_less_than_the_last_digits_of_the_record(table):
    # What is more than rounding is the sensitivity of the motion itself.
    assert (table["max"] < 10.0 * table["max_perturbed"] + 1e-12).all()
    assert (table["median"] < 1e-11).all()


def test_the_kinds_move_unlike_free_blocks():
    record = synthetic_motion(3, dt=DT)
    peaks = {kind: recorded_response(block, record, DT).peak_rotation_ratio for kind, block in kinds().items()}
    for kind, own in peaks.items():
        if kind != PLAIN:
            assert not np.array_equal(own, peaks[PLAIN]), kind
