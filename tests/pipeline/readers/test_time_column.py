"""Times in the columns of a table: what counts as time, and what is missing, repeated or rounded in it."""

from __future__ import annotations

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import table

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.kit.headings import Heading
from rockpulse.readers.kit.spacing import agreed_step, climbs, counts_rows, time_column_step

VALUES = np.round(pulse(200, peak=3.0), 6)
TIMES = np.arange(200) * 0.01


@pytest.mark.parametrize("header", ["", "No,Time,Acc\n", "sample,t [s],a [m/s2]\n"])
@pytest.mark.parametrize("begin", [0, 1])
def test_a_column_that_counts_the_rows_is_no_time(write, header, begin):
    counter = np.arange(200) + begin
    rows = "".join(f"{n},{t:.2f},{a:.6f}\n" for n, t, a in zip(counter, TIMES, VALUES, strict=True))
    (record,) = read(write(header + rows), units="m/s2")
    assert record.dt == pytest.approx(0.01, rel=1e-12)
    assert record.acceleration == pytest.approx(VALUES, rel=1e-12)
    assert record.warnings == ("the first column counts the rows; it was left out",)
    path = write("".join(f"{n} {a:.6f}\n" for n, a in zip(counter, VALUES, strict=True)))
    with pytest.raises(RecordFormatError, match="option dt for the sampling interval"):
        read(path, units="m/s2")
    assert read(path, units="m/s2", dt=0.02)[0].dt == 0.02


def test_two_columns_that_run_like_time_are_refused(write):
    with pytest.raises(RecordFormatError, match=r"record.txt:1: .* columns 1 and 2 both run like time"):
        read(write(table(TIMES, 1000 * TIMES, VALUES)), units="m/s2")


@pytest.mark.parametrize("heading", ["time (ms)", "t_ms", "Time [msec]", "t [milliseconds]"])
def test_times_headed_in_milliseconds(write, heading):
    (record,) = read(write(table(1000 * TIMES, VALUES, delimiter=",", header=f"{heading},acc\n")), units="m/s2")
    assert record.dt == pytest.approx(0.01, rel=1e-12)


def test_a_long_interval_is_reported(write):
    (record,) = read(write(table(1000 * TIMES, VALUES)), units="m/s2")
    assert record.warnings == ("a sampling interval of 10 s is long for an accelerogram; is it in s?",)


def test_unequal_steps_are_refused(write):
    times = TIMES.copy()
    times[120:] += 0.5
    with pytest.raises(
        RecordFormatError, match=r"record.txt:121: expected equally spaced times .* found a step of 0.51"
    ):
        read(write(table(times, VALUES)), units="g")


def test_a_time_heading_over_times_that_run_back_is_refused(write):
    times = TIMES.copy()
    times[50] = 0.1
    with pytest.raises(RecordFormatError, match=r"expected increasing times in the column 'time'"):
        read(write(table(times, VALUES, delimiter=",", header="time,acc\n")), units="g")


@pytest.mark.parametrize("row", [1, 57, 100, 198])
@pytest.mark.parametrize(("step", "number"), [(0.01, "{:.2f}"), (0.005, "{:.3f}"), (1 / 128, "{:.6f}"), (1.0, "{:g}")])
def test_a_missing_row_is_named_whatever_the_digits(write, row, step, number):
    times = np.delete(np.arange(200) * step, row)
    rows = [f"{number.format(time)} {value:.6f}" for time, value in zip(times, VALUES[1:], strict=True)]
    with pytest.raises(RecordFormatError, match=rf"record.txt:{row + 1}: expected equally spaced .* rows are missing"):
        read(write("\n".join(rows)), units="g")


def test_a_missing_row_does_not_pass_under_a_stated_interval_either(write):
    rows = [f"{0.01 * i:.2f} {value:.6f}" for i, value in enumerate(VALUES) if i != 100]
    with pytest.raises(RecordFormatError, match=r"record.txt:101: .* at the declared interval of 0.01 s"):
        read(write("\n".join(rows)), units="g", dt=0.01)


def test_five_times_with_a_hole_are_not_even(write):
    with pytest.raises(RecordFormatError, match=r"record.txt:4: .* found a step of 0.02 s among steps of 0.01 s"):
        read(write("0 .1\n.01 .2\n.02 .1\n.04 .3\n.05 .1\n"), units="g")


@pytest.mark.parametrize("begin", [0.0, 0.005, 12.345])
@pytest.mark.parametrize("dt", [0.005, 0.004, 0.015, 1 / 128])
def test_times_rounded_more_coarsely_than_the_interval_are_time(write, begin, dt):
    rows = "".join(f"{begin + dt * i:.2f} {value:.6f}\n" for i, value in enumerate(VALUES))
    for content, option in [(f"200 {dt!r}\n{rows}", None), (rows, dt)]:
        (record,) = read(write(content), units="m/s2", dt=option)
        assert record.dt == pytest.approx(dt, rel=1e-12)
        assert record.acceleration == pytest.approx(VALUES, rel=1e-12)


@pytest.mark.parametrize("digits", [2, 3])
def test_a_first_column_that_runs_like_time_but_fits_nothing_is_no_acceleration(write, digits):
    rows = "".join(f"{0.004 * i:.{digits}f} {value:.6f}\n" for i, value in enumerate(VALUES))
    with pytest.raises(RecordFormatError, match=r"first column, which runs like time|intervals disagree"):
        read(write(rows), units="g", dt=0.01)
    damaged = rows.replace(f"\n{0.004 * 100:.{digits}f} ", f"\n{0.1:.{digits}f} ", 1)
    assert damaged != rows
    with pytest.raises(RecordFormatError, match=r"record.txt:1\d\d: expected increasing times in the first column"):
        read(write(damaged), units="g", dt=0.004)


def test_one_repeated_time_without_a_declared_interval_is_named(write):
    times = TIMES.copy()
    times[50] = times[49]
    with pytest.raises(RecordFormatError, match=r"record.txt:51: expected increasing times .* found 0.49 after 0.49"):
        read(write(table(times, VALUES)), units="g")


def test_a_heading_of_time_leaves_no_room_for_count_and_step(write):
    with pytest.raises(RecordFormatError, match=r"record.txt:3: expected increasing times in the column 't', found 0"):
        read(write("t,a\n0,0.1\n0,0.2\n"), units="g")
    (record,) = read(write("t,a\n1,0.1\n2,0.25\n3,0.1\n"), units="m/s2")
    assert (record.dt, list(record.acceleration)) == (1.0, [0.1, 0.25, 0.1])


def test_intervals_that_disagree_are_refused(write):
    with pytest.raises(
        RecordFormatError, match=r"the sampling intervals disagree: .* if --dt 0.02 is meant for other files"
    ):
        read(write(table(TIMES, VALUES)), units="g", dt=0.02)


@pytest.mark.parametrize(("dt", "number"), [(1 / 128, "{:.4f}"), (0.005, "{:.3f}"), (1 / 3, "{:.2f}"), (0.02, "{:g}")])
def test_the_interval_is_recovered_from_rounded_times(write, dt, number):
    (record,) = read(write(table(np.arange(200) * dt, VALUES, number=number)), units="g")
    assert record.dt == pytest.approx(dt, rel=1e-12)


@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_times_may_count_from_1970(write, scale):
    rows = "".join(f"{scale * (1562383159.01 + 0.01 * i):.3f},{value:.6f}\n" for i, value in enumerate(VALUES))
    heading = "time (ms),acc (g)\n" if scale > 1.0 else "time,acc (g)\n"
    (record,) = read(write(heading + rows), units="g")
    assert (record.npts, record.dt) == (len(VALUES), 0.01)


def test_a_missing_row_among_times_from_1970_is_seen(write):
    rows = [f"{1562383159.01 + 0.01 * index:.3f},{value:.6f}\n" for index, value in enumerate(VALUES)]
    with pytest.raises(RecordFormatError, match="rows are missing"):
        read(write("time,acc (g)\n" + "".join(rows[:50] + rows[51:])), units="g")


def step_of(times, *others, headings=(), declared=None):
    columns = others or (VALUES[: len(times)],)
    return time_column_step("x.txt", np.column_stack([times, *columns]), headings, 4, declared)


@pytest.mark.parametrize(
    ("unit", "seconds"),
    [
        *(("", 1.0), ("s", 1.0), ("sec", 1.0)),
        *(("ms", 1e-3), ("MSec", 1e-3), ("millis", 1e-3), ("us", 1e-6), ("\u00b5s", 1e-6)),
        *(("min", 60.0), ("Minuten", 60.0)),
    ],
)
def test_times_are_in_the_unit_of_their_heading(unit, seconds):
    found = step_of(2.0 * np.arange(30), headings=[Heading("t", "time", unit)])
    assert found == pytest.approx(2.0 * seconds, rel=1e-12)
    with pytest.raises(RecordFormatError, match="expected a column of times in s, ms or min, found 't' in 's2'"):
        step_of(2.0 * np.arange(30), headings=[Heading("t", "time", "s2")])
    assert step_of(2.0 * np.arange(30), headings=[Heading("a", "acceleration", "s2")]) == 2.0


@pytest.mark.parametrize("still", [0, 3])
def test_a_column_that_falls_at_a_twentieth_of_its_changes_is_no_time(still):
    for changes in (20, 21):
        times = np.append(np.arange(changes + 1.0), np.full(still, changes))
        times[10] = 8.5
        if changes == 20:
            assert step_of(times) is None
            continue
        with pytest.raises(
            RecordFormatError, match=r"^x.txt:15: expected increasing times in the first column, .* 8.5"
        ):
            step_of(times)
    with pytest.raises(RecordFormatError, match="in the column 't'"):
        step_of(times[:15], headings=[Heading("t", "time")])
    assert step_of(0.0 * times) is None


def test_a_table_of_one_column_or_one_row_has_no_times():
    headings = [Heading("t", "time")]
    assert time_column_step("x.txt", TIMES[:, None], headings, 4, None) is None
    assert step_of(TIMES[:1], headings=headings) is None
    assert step_of(TIMES[:2], headings=headings) == 0.01
    assert step_of(TIMES[:2]) == 0.01


def test_another_column_that_runs_like_time_is_named():
    with pytest.raises(RecordFormatError, match=r"^x.txt:5: .* columns 1 and 3 both run like time"):
        step_of(TIMES, VALUES, 3.0 * TIMES)


def test_the_step_that_differs_most_is_named_though_it_is_short():
    times = TIMES.copy()
    times[10:] -= 0.006
    with pytest.raises(
        RecordFormatError, match=r"^x.txt:15: expected equally .* a step of 0.004 s among steps of 0.01"
    ):
        step_of(times)
    with pytest.raises(RecordFormatError, match=r"^x.txt:15: .* at the declared interval of 0.01 s, found a step of"):
        step_of(times, declared=0.01)


def test_a_column_counts_the_rows_from_zero_or_one():
    for begin, counts in ((-1.0, False), (0.0, True), (1.0, True), (2.0, False)):
        rows = np.column_stack([begin + np.arange(5.0), VALUES[:5]])
        assert counts_rows(rows, []) is counts_rows(rows, [Heading("No")]) is counts
        assert not counts_rows(rows, [Heading("t", "time")])
    assert not counts_rows(np.column_stack([[0.0, 1.0, 3.0], VALUES[:3]]), [])


def test_twenty_equal_steps_upwards_are_no_acceleration():
    assert climbs(0.5 * np.arange(20.0))
    assert not climbs(0.5 * np.arange(19.0))
    assert not climbs(np.ones(20))
    assert not climbs(-0.01 * np.arange(20.0))
    assert not climbs(np.arange(30.0) ** 2)
    assert not climbs(np.append(np.arange(30.0), 29.0))


def test_all_sources_agree_on_one_positive_interval():
    assert agreed_step("x.txt", {"time column": None, "header": 0.02}, ReadOptions(dt=0.02)) == 0.02
    assert agreed_step("x.txt", {"header": 0.01}, ReadOptions()) == 0.01
    for step in (0.0, -0.01, np.inf, np.nan):
        with pytest.raises(RecordFormatError, match=rf"^x.txt: expected a positive .* in s, found {step!r} \(header\)"):
            agreed_step("x.txt", {"time column": 0.01, "header": step}, ReadOptions())
    with pytest.raises(RecordFormatError, match=r"disagree: 0.01 s \(a\), 0.02 s \(header\); correct the wrong one$"):
        agreed_step("x.txt", {"a": 0.01, "header": 0.02}, ReadOptions())
