"""One series in rows of several values, and channels side by side that look like one."""

from __future__ import annotations

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import wrapped

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.kit.table import runs_on

VALUES = np.round(pulse(200, peak=3.0), 6)
LONG, STEP = np.round(pulse(1000, peak=3.0) + 0.01 * np.sin(1.5 * np.arange(1000)), 6), 0.005


@pytest.mark.parametrize("per_row", [5, 6, 8])
def test_a_series_in_rows_that_run_on_is_read_where_unit_and_interval_are_given(write, per_row):
    path = write(wrapped(VALUES, per_row))
    interval, unit = r"the interval too \(option dt, --dt\)", r"the unit too \(option units, --units\)"
    for given, asked in (({"units": "g"}, interval), ({"dt": 0.01}, unit), ({}, f"{unit} and {interval}")):
        with pytest.raises(RecordFormatError, match=rf"record.txt:\d+: .* in rows of \d\. Give {asked}: then"):
            read(path, **given)
    (record,) = read(path, units="g", dt=0.01)
    assert record.acceleration / record.unit_factor == pytest.approx(VALUES, abs=0.51e-6)
    assert record.warnings == (
        f"rows of {per_row} numbers were read as one series of 200, because the values run on from row to row; nothing "
        "in the file says so",
    )


@pytest.mark.parametrize("width", [5, 6, 8])
@pytest.mark.parametrize("short", [False, True])
def test_channels_side_by_side_are_no_series_in_rows(write, width, short):
    random = np.random.default_rng(width)
    motion = [np.convolve(random.standard_normal(230), np.hanning(31), "valid") for _ in range(width)]
    rows = [" ".join(f"{value:.5f}" for value in row) for row in np.column_stack(motion)]
    path = write("\n".join([*rows, "0.1 0.2 0.3"] if short else rows).encode())
    with pytest.raises(RecordFormatError, match=r"do not run on from row to row .*Or write one value to a line"):
        read(path, units="g", dt=0.01)


def test_a_short_last_row_of_narrow_rows_that_run_on_is_the_end_of_a_series(write):
    (record,) = read(write(wrapped(VALUES, 3)), units="m/s2", dt=0.01)
    assert record.acceleration == pytest.approx(VALUES, abs=0.51e-6)
    with pytest.raises(RecordFormatError, match=r"rows of 4\. Rows of up to 4 numbers .* may be those of a station"):
        read(write(wrapped(VALUES, 4)), units="m/s2", dt=0.01)


@pytest.mark.filterwarnings("error")
def test_runs_on_asks_for_enough_rows_and_for_motion():
    rows = VALUES.reshape(-1, 5)
    assert runs_on(rows)
    assert runs_on(rows[:20])
    assert not runs_on(rows[:19])
    assert not runs_on(VALUES[:, None])
    assert not runs_on(0.0 * rows)
    assert not runs_on(np.full((30, 5), 1e300) * np.arange(5))


def stepped(inside, behind):
    """Rows (n, columns) of one series: its steps in each row (n, columns - 1), and that from each row to the next."""
    steps = np.column_stack([inside, [*behind, 0.0]]).ravel()[:-1]
    return np.append(0.0, np.cumsum(steps)).reshape(len(inside), -1)


@pytest.mark.parametrize(
    ("inside", "behind", "series"),
    [
        # Ratios of the mean squares 1.69, 1.82 and just 1.8 = 9/5, either way.
        ([2.0] * 21, [2.6] * 20, True),
        ([2.0] * 21, [2.7] * 20, False),
        ([2.6] * 21, [2.0] * 20, True),
        ([2.7] * 21, [2.0] * 20, False),
        ([3.0] * 21, [1.0, 3.0] * 10, False),
        ([1.0, 3.0] * 11, [3.0] * 21, False),
        # The step behind a row turns back in so many of 20: down a column four times that share to one.
        ([3.0] * 21, [3.0] * 11 + [-3.0] * 9, True),
        ([3.0] * 21, [3.0] * 10 + [-3.0] * 10, False),
    ],
)
def test_the_limits_of_what_is_a_series_in_rows_of_two(inside, behind, series):
    assert runs_on(stepped(np.array(inside)[:, None], behind)) is series
    assert runs_on(0.125 * stepped(np.array(inside)[:, None], behind)) is series


@pytest.mark.parametrize(("middle", "series"), [(1.2, True), (1.5, False)])
def test_of_longer_rows_the_usual_step_counts(middle, series):
    """Steps of 1, `middle` and 30 in rows of four, of 1 behind them."""
    assert runs_on(stepped(np.tile([1.0, middle, 30.0], (20, 1)), [1.0] * 19)) is series


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.1, 1.0])
@pytest.mark.parametrize("width", [3, 5, 10, 40])
def test_channels_that_move_together_are_no_series(noise, width):
    """A rigid floor: one motion with a little noise on each channel."""
    random = np.random.default_rng(width)
    common = np.convolve(random.standard_normal(430), np.hanning(31), "valid")[:, None]
    assert not runs_on(common + noise * random.standard_normal((400, width)))


@pytest.mark.parametrize(
    ("header", "per_row"),
    [
        ("El Centro 1940 NS component\n", 5),
        ("Acceleration time history in units of g dt=0.005\n", 8),
        ("Acceleration time history units of g dt=0.005\n", 8),
        ("", 2),
        ("Acceleration NS\n", 2),
        ("El Centro\n", 7),
    ],
)
def test_prose_above_a_wrapped_series_names_no_columns(write, header, per_row):
    path = write(wrapped(LONG, per_row, header))
    with pytest.raises(RecordFormatError, match=rf"record.txt:\d+: .* one series in rows of {per_row}\. .*NPTS"):
        read(path, dt=STEP)
    if per_row == 2:  # one more than time, or two components
        with pytest.raises(RecordFormatError, match=r"one series in rows of 2\. Rows of up to 4 numbers"):
            read(path, units="g", dt=STEP)
        return
    (record,) = read(path, units="g", dt=STEP)
    assert record.acceleration / record.unit_factor == pytest.approx(LONG, abs=1e-12)
    assert f"rows of {per_row} numbers were read as one series of {len(LONG)}" in record.warnings[0]


@pytest.mark.parametrize("per_row", [2, 5, 7, 8])
@pytest.mark.parametrize("header", ["El Centro, NPTS = 1000, in g\n", "1000 points of El Centro\n", "1000 0.005\n"])
def test_a_wrapped_series_is_read_where_the_header_states_its_length(write, header, per_row):
    (record,) = read(write(wrapped(LONG, per_row, header)), units="g", dt=STEP)
    assert record.acceleration / record.unit_factor == pytest.approx(LONG, abs=1e-12)


@pytest.mark.parametrize("end", ["\n\n", "\n"])
def test_a_wrapped_series_with_blank_rows(write, end):
    content = wrapped(LONG[:998], 5, "998 0.005\n").decode().replace("\n", f"\n{end}")
    (record,) = read(write(content.encode()), units="m/s2")
    assert record.acceleration == pytest.approx(LONG[:998], abs=1e-12)
    assert read(write(b"2 0.005\n0.1 0.2\n"), units="m/s2")[0].npts == 2


def test_a_wrapped_series_shorter_than_the_header_states_is_a_truncation(write):
    with pytest.raises(RecordFormatError, match=r"expected 1100 values \(header\), found 1000"):
        read(write(wrapped(LONG, 8, "1100 0.005\n")), units="g")
