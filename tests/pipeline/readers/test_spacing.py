"""Equal spacing through the rounding of printed times, and gaps that do not pass for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rockpulse.errors import RecordFormatError
from rockpulse.readers.spacing import even_step, long_step, make_even, printed_at

QUICK = settings(derandomize=True, deadline=None, max_examples=100)
STEPS = st.sampled_from([0.0014, 0.0025, 1 / 300, 0.005, 1 / 128, 0.01, 0.02, 1 / 3])


@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(3, 7), start=st.sampled_from([0.0, 1.0, 12.5]))
def test_rounding_within_its_share_of_the_step_is_seen_through(step, count, decimals, start):
    assume(0.5 * 10.0**-decimals <= 0.2 * step)
    found = even_step(np.round(start + step * np.arange(count), decimals))
    # The end lies within its rounding and 1 % of a step of the grid found, and within its rounding of the true one.
    drift = 10.0**-decimals + 0.01 * step
    assert found == pytest.approx(step, abs=(1.0 + 1e-6) * drift / (count - 1))


@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(2, 7), data=st.data(), length=st.integers(1, 30))
def test_missing_rows_never_pass_as_even_spacing(step, count, decimals, data, length):
    times = np.round(step * np.arange(count + length), decimals)
    assume(0.5 * 10.0**-decimals <= 0.2 * step or (decimals == 2 and step == 0.01))
    at = data.draw(st.integers(1, count - 1))
    holed = np.delete(times, slice(at, at + length))
    assert even_step(holed) is None
    assert not printed_at(holed, step)


@QUICK
@given(step=STEPS, count=st.integers(20, 400), data=st.data(), length=st.floats(1.0, 500.0))
def test_a_hole_of_any_length_in_equal_steps_is_a_gap(step, count, data, length):
    times = step * np.arange(count)
    at = data.draw(st.integers(1, count - 1))
    times[at:] += length * step
    assert long_step(np.round(times, 7)) == at - 1


@pytest.mark.parametrize("length", [1.0, 1.5, 2.5, 3.25])
def test_a_hole_of_half_a_step_more_is_a_gap_too(length):
    times = 0.0014 * np.arange(20)
    times[1:] += length * 0.0014
    assert long_step(np.round(times, 7)) == 0


@pytest.mark.parametrize(
    ("begin", "step", "count", "at", "length"),
    [(9e-4, 0.0083, 43, 27, 5), (8e-4, 0.0123, 45, 14, 1), (6e-4, 0.0123, 22, 21, 8)],
)
def test_a_gap_in_coarsely_printed_times_has_the_rounding_of_its_ends(begin, step, count, at, length):
    times = begin + step * np.arange(count)
    times[at:] += length * step
    assert long_step(np.round(times, 3)) == at - 1


def test_a_trace_that_wanders_has_long_steps_but_no_gap():
    steps = np.random.default_rng(5).uniform(0.003, 0.007, 500)
    steps[[100, 300]] = 0.010
    assert long_step(np.round(np.cumsum(steps), 4)) is None


@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(1, 7), start=st.floats(0.0, 50.0))
def test_samples_of_a_known_interval_fit_however_coarse_their_times(step, count, decimals, start):
    assert printed_at(np.round(start + step * np.arange(count), decimals), step)


@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf])
def test_no_times_fit_an_interval_that_is_none(dt):
    assert not printed_at(np.array([0.0, 0.0, 0.01]), dt)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [[0.0, 0.1, 1e308], [-1e308, 0.0, 1e308], [0.0, 1e14, 2e14]])
def test_times_beyond_all_recordings_are_named_before_anything_overflows(times):
    times = np.array(times)
    assert even_step(times) is None
    assert long_step(times) is None
    assert not printed_at(times, 0.01)
    with pytest.raises(RecordFormatError, match=r"x\.v1:7: expected times in s of at most 1e\+13 s"):
        make_even(times, np.zeros(3), "x.v1", 7, 5, 0.1)


def test_even_samples_stay_as_they_are_and_uneven_ones_are_read_off_the_lines_between_them():
    samples = np.array([0.0, 1.0, -2.0, 0.5, 3.0])
    found, dt, notes = make_even(0.02 * np.arange(5), samples, "x.v1", 7, 5, 0.1)
    assert (found.tolist(), dt, notes) == (samples.tolist(), pytest.approx(0.02), [])
    found, dt, (note,) = make_even(np.array([0.0, 0.02, 0.04, 0.05, 0.07]), samples, "x.v1", 7, 5, 0.1)
    assert (found.tolist(), dt) == (pytest.approx([0.0, 1.0, -2.0, 1.75]), 0.02)
    assert note.endswith("median, 0.02 s; the peak goes from 0.3 to 0.2 g")


def test_rounding_explains_at_most_a_fifth_of_the_step():
    """Half a digit of 0.1 s is a third of a step of 0.15 s, and a fifth of one of 0.25 s."""
    coarse, fair = (np.round(step * np.arange(41) + 1e-9, 1) for step in (0.15, 0.25))
    assert np.all(np.diff(coarse) > 0.0)
    assert even_step(coarse) is None
    assert even_step(fair) == pytest.approx(0.25)
