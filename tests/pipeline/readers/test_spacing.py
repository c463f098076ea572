"""Equal spacing through the rounding of printed times, and gaps that do not pass for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.spacing import _half_digit, even_step, long_step, make_even, printed_at

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
    [
        (9e-4, 0.0083, 43, 27, 5),
        (8e-4, 0.0123, 45, 14, 1),
        (6e-4, 0.0123, 22, 21, 8),
        (7e-4, 0.0123, 38, 9, 7),
        (1e-3, 0.0064, 19, 10, 1),
        (8e-4, 0.0047, 12, 6, 5),
        (9e-4, 0.0083, 13, 3, 5),
    ],
)
def test_a_gap_in_coarsely_printed_times_has_the_rounding_of_its_ends(begin, step, count, at, length):
    times = begin + step * np.arange(count)
    times[at:] += length * step
    assert long_step(np.round(times, 3)) == at - 1


def test_a_trace_that_wanders_has_long_steps_but_no_gap():
    steps = np.random.default_rng(5).uniform(0.003, 0.007, 500)
    steps[[100, 300]] = 0.010
    assert long_step(np.round(np.cumsum(steps), 4)) is None


@pytest.mark.parametrize("begin", [0.0, 1.5e9])
def test_the_digits_of_large_times_explain_nothing(begin):
    """A time that is off by 15 % of the interval, in seconds from 1970 as from the first sample."""
    assert even_step(begin + np.array([0.0, 0.01, 0.0215, 0.03, 0.04])) is None
    assert long_step(begin + np.array([0.0, 0.01, 0.0215, 0.03, 0.04, 0.06, 0.07])) is None


@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(1, 7), start=st.floats(0.0, 50.0))
def test_samples_of_a_known_interval_fit_however_coarse_their_times(step, count, decimals, start):
    assert printed_at(np.round(start + step * np.arange(count), decimals), step)


@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf])
@pytest.mark.parametrize("times", [[0.0, 0.0, 0.01], [0.0, 0.0, 0.0]])
def test_no_times_fit_an_interval_that_is_none(dt, times):
    assert not printed_at(np.array(times), dt)


@pytest.mark.parametrize(
    ("times", "half"),
    [
        ([0.0, 1.0, 2.0], 0.5),
        ([0.0, 0.5], 0.05),
        ([0.25, 0.125], 0.0005),
        ([0.12345678], 0.5e-8),
        ([0.1234567815], 0.0),  # off eight decimals by 1.5e-9
        ([1e-9], 0.0),  # the noise of binary fractions is smaller
        ([1e6 + 0.0005], 0.5),  # a billionth of a large time is such noise
    ],
)
def test_half_a_unit_of_the_last_decimal(times, half):
    assert _half_digit(np.array(times)) == pytest.approx(half, rel=1e-12, abs=0.0)


def test_times_of_whole_seconds_hide_no_row_of_a_finer_interval():
    """Samples at 0.4 s, their times rounded to 1 s; a row that stands a second too low is off by more than rounding."""
    assert printed_at(np.array([0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0]), 0.4)
    assert not printed_at(np.array([0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]), 0.4)


@pytest.mark.parametrize(
    ("times", "dt"),
    [
        ([0.0, 1.0], 2.0 + 2e-6),  # off by a second and 2e-6 s, a millionth of the interval; then by 0.5e-9 s more
        ([0.0, 0.1], 0.2 + 2e-7),
        ([0.0, 10.0], 11.0 + 1.1e-5 + 9e-9),  # a billionth of 10 s
        ([5.0, 15.0, 25.0], 10.5 + 0.5 * (1.05e-5 + 19e-9)),
    ],
)
def test_beyond_their_rounding_times_may_be_off_by_the_noise_of_binary_fractions(times, dt):
    times = np.array(times)
    assert printed_at(times, dt + 0.5e-9 / (times.size - 1))
    assert not printed_at(times, dt + 1.5e-9 / (times.size - 1))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [[0.0, 0.1, 1e308], [-1e308, 0.0, 1e308], [0.0, 1e14, 2e14]])
def test_times_beyond_all_recordings_are_named_before_anything_overflows(times):
    times = np.array(times)
    assert even_step(times) is None
    assert long_step(times) is None
    assert not printed_at(times, 0.01)
    with pytest.raises(RecordFormatError, match=r"x\.v1:7: expected times in s of at most 1e\+13 s"):
        make_even(times, np.zeros(3), "x.v1", 7, 5, 0.1)


def test_the_latest_time_is_still_one():
    assert even_step(np.array([0.0, 1e13])) == 1e13
    assert even_step(np.array([0.0, 1e13 + 1.0])) is None
    assert not printed_at(np.array([0.0, 1e14]), 1e14)


@pytest.mark.parametrize(
    ("step", "count", "decimals", "expected"),
    [
        (0.01234, 42, 4, 0.01234),  # four digits: neither two nor a whole rate fit
        (1.0 / 81.0, 400, 5, 1.0 / 81.0),  # a whole rate before four digits
        (0.0122345, 400, 7, 0.0122345),  # as printed
        (3.0, 5, 0, 3.0),
        (12.34, 50, 2, 12.34),
    ],
)
def test_a_round_interval_or_rate_is_preferred(step, count, decimals, expected):
    assert even_step(7.0 + np.round(step * np.arange(count), decimals)) == pytest.approx(expected, rel=1e-13)


def test_a_step_of_one_and_a_half_is_no_gap():
    assert long_step(np.array([0.0, 1.0, 2.0, 3.5, 4.5])) is None
    assert long_step(np.array([0.0, 1.0, 2.0, 3.6, 4.6])) == 2


def make(times, samples=None):
    times = np.array(times)
    return make_even(times, np.ones(times.size) if samples is None else np.array(samples), "x.v1", 7, 2, 0.1)


def test_the_line_of_a_wrong_time_is_named():
    with pytest.raises(RecordFormatError, match=r"^x.v1:7: expected at least 2 samples, found 1;"):
        make([0.0])
    with pytest.raises(RecordFormatError, match=r"^x.v1:8: expected times in s of at most .* \(pair 4\)"):
        make([0.0, 1.0, 2.0, 2e13, 3e13])
    with pytest.raises(RecordFormatError, match=r"^x.v1:8: expected increasing times, found 2 s after 2 s \(pair 4\)"):
        make([0.0, 1.0, 2.0, 2.0, 3.0, 2.5])
    with pytest.raises(RecordFormatError, match=r"^x.v1:8: a step of 2 s after 1 s among steps of 1 s"):
        make([0.0, 1.0, 3.0, 4.0, 5.0])
    assert make([3.0, 3.5])[1] == 0.5


def test_a_jump_is_filled_up_to_ten_times_the_samples():
    """Steps of 0.75, 1, 1 and 47.25 s, of which nothing makes equal ones: 51 samples from 5."""
    found, dt, (note,) = make([2.0, 2.75, 3.75, 4.75, 52.0], [0.0, 3.0, 7.0, 7.0, 0.5 * 7.0])
    assert (found.size, dt) == (51, 1.0)
    assert found[:3].tolist() == [0.0, 4.0, 7.0]
    assert found[-2:] == pytest.approx([3.5 + 3.5 / 47.25, 3.5])
    assert "steps of 0.75 to 47.25 s" in note
    with pytest.raises(RecordFormatError, match=r"^x.v1:9: a step of 47.5 s after 4.75 s among steps of 1 s"):
        make([2.0, 2.75, 3.75, 4.75, 52.25])


def test_the_last_of_the_resampled_values_is_at_the_last_time_where_the_steps_come_out():
    """Steps of 0.5, 1, 1 and 1.5 s, at their median: 4 s are four of 1 s."""
    found, dt, _ = make([1.0, 1.5, 2.5, 3.5, 5.0], [0.0, 1.0, 3.0, 4.0, 1.0])
    assert (dt, found.tolist()) == (1.0, [0.0, 2.0, 3.5, 3.0, 1.0])


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
