"""Equal spacing through the rounding of printed times, and gaps that do not pass for it."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from record_writers import pulse

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.kit.headings import ColumnHeading
from rockpulse.readers.kit.spacing import (
    agreed_step,
    climbs,
    counts_rows,
    even_step,
    long_step,
    make_even,
    pair_block,
    printed_at,
    time_column_step,
)

QUICK = settings(derandomize=True, deadline=None, max_examples=50)
STEPS = st.sampled_from([0.0014, 0.0025, 1 / 300, 0.005, 1 / 128, 0.01, 0.02, 1 / 3])


@pytest.mark.slow
@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(3, 7), start=st.sampled_from([0.0, 1.0, 12.5]))
def test_rounding_within_its_share_of_the_step_is_seen_through(step, count, decimals, start):
    assume(0.5 * 10.0**-decimals <= 0.2 * step)
    found = even_step(np.round(start + step * np.arange(count), decimals))
    # The end lies within its rounding and 1 % of a step of the grid found, and within its rounding of the true one.
    drift = 10.0**-decimals + 0.01 * step
    assert found == pytest.approx(step, abs=(1.0 + 1e-6) * drift / (count - 1))


@pytest.mark.sweep
@QUICK
@given(step=STEPS, count=st.integers(5, 400), decimals=st.integers(2, 7), data=st.data(), length=st.integers(1, 30))
def test_missing_rows_never_pass_as_even_spacing(step, count, decimals, data, length):
    times = np.round(step * np.arange(count + length), decimals)
    assume(0.5 * 10.0**-decimals <= 0.2 * step or (decimals == 2 and step == 0.01))
    at = data.draw(st.integers(1, count - 1))
    holed = np.delete(times, slice(at, at + length))
    assert even_step(holed) is None
    assert not printed_at(holed, step)


@pytest.mark.sweep
@QUICK
@given(step=STEPS, count=st.integers(20, 400), data=st.data(), length=st.floats(1.0, 500.0))
def test_a_hole_of_any_length_in_equal_steps_is_a_gap(step, count, data, length):
    times = step * np.arange(count)
    at = data.draw(st.integers(1, count - 1))
    times[at:] += length * step
    assert long_step(np.round(times, 7)) == at - 1


@pytest.mark.parametrize(
    ("begin", "step", "count", "at", "length"),
    [
        *((9e-4, 0.0083, 43, 27, 5), (8e-4, 0.0123, 45, 14, 1), (6e-4, 0.0123, 22, 21, 8)),
        *((1e-3, 0.0064, 19, 10, 1), (8e-4, 0.0047, 12, 6, 5)),
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


def test_even_samples_stay_as_they_are_and_uneven_ones_are_read_off_the_lines_between_them():
    samples = np.array([0.0, 1.0, -2.0, 0.5, 3.0])
    found, dt, notes = make_even(0.02 * np.arange(5), samples, "x.v1", 7, 5, 0.1)
    assert (found.tolist(), dt, notes) == (samples.tolist(), pytest.approx(0.02), [])
    found, dt, (note,) = make_even(np.array([0.0, 0.02, 0.04, 0.05, 0.07]), samples, "x.v1", 7, 5, 0.1)
    assert (found.tolist(), dt) == (pytest.approx([0.0, 1.0, -2.0, 1.75]), 0.02)
    assert note.endswith("median, 0.02 s; the peak changes from 0.3 to 0.2 g")


def test_rounding_explains_at_most_a_fifth_of_the_step():
    """Half a digit of 0.1 s is a third of a step of 0.15 s, and a fifth of one of 0.25 s."""
    coarse, fair = (np.round(step * np.arange(41) + 1e-9, 1) for step in (0.15, 0.25))
    assert np.all(np.diff(coarse) > 0.0)
    assert even_step(coarse) is None
    assert even_step(fair) == pytest.approx(0.25)


TIMES = 1.5 + 0.02 * np.arange(7)
VALUES = np.array([0.125, -0.5, 3.25, -4.5, 2.75, 1.0, -0.25])


def rows(times=TIMES, values=VALUES, margin=""):
    """Five pairs in a row, in fields of eight characters."""
    fields = [f"{time:8.3f}{value:8.3f}" for time, value in zip(times, values, strict=True)]
    return [margin + "".join(fields[at : at + 5]) for at in range(0, len(fields), 5)]


def block(lines, count=7, unit="g", end=None):
    return pair_block("x.v1", ["A TITLE", "another", *lines], 2, 2 + len(lines) if end is None else end, count, unit)


@pytest.mark.parametrize("count", [3, 5, 7])
@pytest.mark.parametrize("margin", ["", " "])
def test_the_declared_pairs_are_read(count, margin):
    found = block(rows(TIMES[:count], VALUES[:count], margin), count)
    assert found.samples.tolist() == found.values.tolist() == VALUES[:count].tolist()
    assert found.times == pytest.approx(TIMES[:count], abs=1e-12)
    assert (found.dt, found.unit, found.warnings) == (0.02, "g", ())
    assert found.peak == (3.25 if count == 3 else 4.5)
    assert found.duration == pytest.approx(0.02 * count)
    assert found.noting("a", "b").noting("c").warnings == ("a", "b", "c")


@pytest.mark.parametrize("margin", ["", " "])
def test_what_stands_behind_the_declared_pairs_is_told(margin):
    first, last = rows(margin=margin)
    numbers, further = ("line 4: numbers beyond the declared count were left out",), "beyond the declared count were"
    assert block([first, last + "7"]).warnings == numbers
    assert block([first, last + "  "]).warnings == ()
    assert block([first, last + "7", "", "8 9", "10"]).warnings == (*numbers, f"line 5: 2 rows {further} left out")
    assert block([first, last], 5).warnings == (f"line 4: 1 rows {further} left out",)
    assert block([first, last, "of the next"], end=4).warnings == ()


def test_a_block_that_is_cut_or_damaged_is_named_by_its_line():
    first, last = rows()
    for end in (1, 2):
        with pytest.raises(RecordFormatError, match=rf"^x.v1:{end}: expected 3 pairs \(header\), found 0;"):
            block([first, last], 3, end=end)
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: expected 7 pairs \(header\), found 5;"):
        block([first])
    with pytest.raises(RecordFormatError, match=r"^x.v1:4: expected a finite number, found '1.x00'"):
        block([first, last.replace("1.000", "1.x00")])
    with pytest.raises(RecordFormatError, match=r"^x.v1:4: expected increasing times, .* \(pair 7\)"):
        block(rows(np.append(TIMES[:6], 1.0)))
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: expected 10 fields of 1 characters, found a row of 3 "):
        block(["1 2", last])
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: "):
        block([f"1{first}", f" {last}"])  # one character more, and no carriage control


VALUES_TIME_COLUMN = np.round(pulse(200, peak=3.0), 6)
TIMES_TIME_COLUMN = np.arange(200) * 0.01


@pytest.mark.parametrize("header", ["", "No,Time,Acc\n", "sample,t [s],a [m/s2]\n"])
@pytest.mark.parametrize("begin", [0, 1])
def test_a_column_that_counts_the_rows_is_no_time(write, header, begin):
    counter = np.arange(200) + begin
    rows = "".join(
        f"{n},{t:.2f},{a:.6f}\n" for n, t, a in zip(counter, TIMES_TIME_COLUMN, VALUES_TIME_COLUMN, strict=True)
    )
    (record,) = read(write(header + rows), units="m/s2")
    assert record.dt == pytest.approx(0.01, rel=1e-12)
    assert record.acceleration == pytest.approx(VALUES_TIME_COLUMN, rel=1e-12)
    assert record.warnings == ("the first column counts the rows; it was left out",)
    path = write("".join(f"{n} {a:.6f}\n" for n, a in zip(counter, VALUES_TIME_COLUMN, strict=True)))
    with pytest.raises(RecordFormatError, match="option dt for the sampling interval"):
        read(path, units="m/s2")
    assert read(path, units="m/s2", dt=0.02)[0].dt == 0.02


@pytest.mark.parametrize("begin", [0.0, 0.005, 12.345])
@pytest.mark.parametrize("dt", [0.005, 0.004, 0.015, 1 / 128])
def test_times_rounded_more_coarsely_than_the_interval_are_time(write, begin, dt):
    rows = "".join(f"{begin + dt * i:.2f} {value:.6f}\n" for i, value in enumerate(VALUES_TIME_COLUMN))
    for content, option in [(f"200 {dt!r}\n{rows}", None), (rows, dt)]:
        (record,) = read(write(content), units="m/s2", dt=option)
        assert record.dt == pytest.approx(dt, rel=1e-12)
        assert record.acceleration == pytest.approx(VALUES_TIME_COLUMN, rel=1e-12)


@pytest.mark.parametrize("digits", [2, 3])
def test_a_first_column_that_runs_like_time_but_fits_nothing_is_no_acceleration(write, digits):
    rows = "".join(f"{0.004 * i:.{digits}f} {value:.6f}\n" for i, value in enumerate(VALUES_TIME_COLUMN))
    with pytest.raises(RecordFormatError, match=r"first column, which increases like times|intervals disagree"):
        read(write(rows), units="g", dt=0.01)
    damaged = rows.replace(f"\n{0.004 * 100:.{digits}f} ", f"\n{0.1:.{digits}f} ", 1)
    assert damaged != rows
    with pytest.raises(RecordFormatError, match=r"record.txt:1\d\d: expected increasing times in the first column"):
        read(write(damaged), units="g", dt=0.004)


def test_a_heading_of_time_leaves_no_room_for_count_and_step(write):
    with pytest.raises(RecordFormatError, match=r"record.txt:3: expected increasing times in the column 't', found 0"):
        read(write("t,a\n0,0.1\n0,0.2\n"), units="g")
    (record,) = read(write("t,a\n1,0.1\n2,0.25\n3,0.1\n"), units="m/s2")
    assert (record.dt, list(record.acceleration)) == (1.0, [0.1, 0.25, 0.1])


@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_times_may_count_from_1970(write, scale):
    rows = "".join(
        f"{scale * (1562383159.01 + 0.01 * i):.3f},{value:.6f}\n" for i, value in enumerate(VALUES_TIME_COLUMN)
    )
    heading = "time (ms),acc (g)\n" if scale > 1.0 else "time,acc (g)\n"
    (record,) = read(write(heading + rows), units="g")
    assert (record.npts, record.dt) == (len(VALUES_TIME_COLUMN), 0.01)


def step_of(times, *others, headings=(), declared=None):
    columns = others or (VALUES_TIME_COLUMN[: len(times)],)
    return time_column_step("x.txt", np.column_stack([times, *columns]), headings, 4, declared)[0]


@pytest.mark.parametrize(
    ("unit", "seconds"),
    [
        *(("", 1.0), ("s", 1.0), ("sec", 1.0)),
        *(("ms", 1e-3), ("MSec", 1e-3), ("millis", 1e-3), ("us", 1e-6), ("\u00b5s", 1e-6)),
        *(("min", 60.0), ("Minuten", 60.0)),
    ],
)
def test_times_are_in_the_unit_of_their_heading(unit, seconds):
    found = step_of(2.0 * np.arange(30), headings=[ColumnHeading("t", "time", unit)])
    assert found == pytest.approx(2.0 * seconds, rel=1e-12)
    with pytest.raises(RecordFormatError, match="expected a column of times in s, ms or min, found 't' in 's2'"):
        step_of(2.0 * np.arange(30), headings=[ColumnHeading("t", "time", "s2")])
    assert step_of(2.0 * np.arange(30), headings=[ColumnHeading("a", "acceleration", "s2")]) == 2.0


@pytest.mark.parametrize("still", [0, 3])
def test_a_column_that_falls_at_a_twentieth_of_its_changes_is_no_time(still):
    for changes in (20, 21):
        times = np.append(np.arange(changes + 1.0), np.full(still, changes))
        times[10] = 8.5
        if changes == 20:
            assert step_of(times) is None
            continue
        with pytest.raises(RecordFormatError, match=r"^x.txt:15: expected increasing times in the first .* 8.5"):
            step_of(times)
    with pytest.raises(RecordFormatError, match="in the column 't'"):
        step_of(times[:15], headings=[ColumnHeading("t", "time")])
    assert step_of(0.0 * times) is None


def test_a_table_of_one_column_or_one_row_has_no_times():
    headings = [ColumnHeading("t", "time")]
    assert time_column_step("x.txt", TIMES_TIME_COLUMN[:, None], headings, 4, None) == (None, None)
    assert step_of(TIMES_TIME_COLUMN[:1], headings=headings) is None
    assert step_of(TIMES_TIME_COLUMN[:2], headings=headings) == 0.01
    assert step_of(TIMES_TIME_COLUMN[:2]) == 0.01


def test_another_column_that_runs_like_time_is_named():
    with pytest.raises(RecordFormatError, match=r"^x.txt:5: .* columns 1 and 3 both increase like times"):
        step_of(TIMES_TIME_COLUMN, VALUES_TIME_COLUMN, 3.0 * TIMES_TIME_COLUMN)


def test_the_step_that_differs_most_is_named_though_it_is_short():
    times = TIMES_TIME_COLUMN.copy()
    times[10:] -= 0.006
    with pytest.raises(RecordFormatError, match=r"^x.txt:15: expected equally .* step of 0.004 s among .* 0.01"):
        step_of(times)
    with pytest.raises(RecordFormatError, match=r"^x.txt:15: .* at the declared interval of 0.01 s, found a step of"):
        step_of(times, declared=0.01)


def test_a_column_counts_the_rows_from_zero_or_one():
    for begin, counts in ((-1.0, False), (0.0, True), (1.0, True), (2.0, False)):
        rows = np.column_stack([begin + np.arange(5.0), VALUES_TIME_COLUMN[:5]])
        assert counts_rows(rows, []) is counts_rows(rows, [ColumnHeading("No")]) is counts
        assert not counts_rows(rows, [ColumnHeading("t", "time")])
    assert not counts_rows(np.column_stack([[0.0, 1.0, 3.0], VALUES_TIME_COLUMN[:3]]), [])


def test_twenty_equal_steps_upwards_are_no_acceleration():
    assert climbs(0.5 * np.arange(20.0))
    assert not climbs(0.5 * np.arange(19.0))
    assert not climbs(np.ones(20))
    assert not climbs(-0.01 * np.arange(20.0))
    assert not climbs(np.arange(30.0) ** 2)
    assert not climbs(np.append(np.arange(30.0), 29.0))


def test_all_sources_agree_on_one_positive_interval():
    assert agreed_step("x.txt", {"time column": None, "header": 0.02, "option": 0.02}, "x") == 0.02
    assert agreed_step("x.txt", {"header": 0.01}, "x") == 0.01
    for step in (0.0, -0.01, np.inf, np.nan):
        with pytest.raises(RecordFormatError, match=rf"^x.txt: expected a positive .* in s, found {step!r} \(header\)"):
            agreed_step("x.txt", {"time column": 0.01, "header": step}, "x")
    with pytest.raises(RecordFormatError, match=r"disagree: 0.01 s \(a\), 0.02 s \(header\); correct the wrong one$"):
        agreed_step("x.txt", {"a": 0.01, "header": 0.02}, "correct the wrong one")
