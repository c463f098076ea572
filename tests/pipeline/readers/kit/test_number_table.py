"""Where the numbers of a table stop: at words, at the end of the file, at another section."""

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import columns, wrapped

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.kit.number_table import (
    Layout,
    Numbered,
    as_float,
    check_decimals,
    end_of_numbers,
    find_layout,
    number_lines,
    read_table,
    row_width,
    runs_on,
    split_row,
)

VALUES = np.round(pulse(200, peak=3.0), 6)
TABLE = columns(np.column_stack([0.01 * np.arange(200), VALUES])).decode()


PEKNOLD = (
    "Data for El Centro 1940 North South Component (Peknold Version)\n"
    "{count} points at equal spacing of 0.02 sec\n"
    "Points are listed in the format of 8F10.5, i.e., 8 points across in a row with 5 decimal places\n"
    "The units are (g)\n\n*** Begin data ***\n"
)


def test_numbers_that_stop_at_a_line_of_words_are_read_to_the_stated_count(write):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    path = write((PEKNOLD.format(count=200) + rows + "*** End data ***\n").encode())
    (record,) = read(path, units="g")
    assert (record.npts, record.dt, record.warnings) == (200, 0.02, ())
    assert record.acceleration / record.unit_factor == pytest.approx(VALUES, abs=0.51e-5)
    assert read(path)[0].source_unit == "g"  # "The units are (g)"
    with pytest.raises(UnitError, match="the header says"):
        read(path, units="cm/s2")
    with pytest.raises(RecordFormatError, match="intervals disagree"):
        read(path, units="g", dt=0.01)


@pytest.mark.parametrize("words", ["PAGE 2", "Acceleration E-W", "Northridge, station 2", "missing"])
def test_numbers_that_go_on_behind_a_line_of_words_are_not_cut(write, words):
    lines = TABLE.split("\n")
    lines.insert(100, words)
    with pytest.raises(RecordFormatError, match=rf"record.txt:101: .* '{words}' and 100 rows of numbers after it"):
        read(write("\n".join(lines).encode()), units="g")


def test_fewer_numbers_before_the_words_than_the_header_states(write):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    for used in (rows, rows + "   0.00100\n"):
        path = write((PEKNOLD.format(count=300) + used + "*** End data ***\n").encode())
        with pytest.raises(RecordFormatError, match="rows of 8"):
            read(path)
        (record,) = read(path, units="g")
        notes = " ".join(record.warnings)
        assert all(words in notes for words in ("the numbers stop at", "mentions 300", "as one series"))


@pytest.mark.parametrize("number", ["0.02e-320", "0.02E+999"])
def test_an_interval_with_an_exponent_beyond_all_numbers_is_no_interval(write, number):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    path = write(PEKNOLD.format(count=200).replace("0.02", number).encode() + rows.encode())
    with pytest.raises(RecordFormatError, match="option dt for the sampling interval"):
        read(path, units="g")


def test_empty_fields_at_the_end_of_a_row_are_none_but_an_empty_row_is_one():
    assert split_row("1, 2,,", ",") == ["1", "2"]
    assert split_row("", ",") == split_row(",", ",") == [""]


def test_a_table_begins_where_the_row_and_the_five_behind_it_have_one_width():
    assert find_layout(["1 2", *["1 2 3"] * 6]).start == 1
    assert find_layout([*["1 2"] * 5, "1 2 3"]).start == 5
    assert find_layout([*["1 2"] * 6, "1 2 3"]).start == 0


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (["1,2", "3,4"], (",", ".", 2)),
        (["1, 2", "3, 4"], (",", ".", 2)),
        (["0,1 0,2", "0,3 0,4"], (None, ",", 2)),
        (["0,1 2", "3 4"], (None, ",", 2)),
        (["0,1 x", "3 4"], None),
        (["0,1;2", "3;4"], (";", ",", 2)),
        (["1 2", "3 4"], (None, ".", 2)),
        (["1.5;2", "3;4"], (";", ".", 2)),
        (["1"], (None, ".", 1)),
        ([""], None),
        ([], None),
    ],
)
def test_separator_and_decimal_mark(rows, expected):
    found = find_layout(["words", *rows])
    assert found == (None if expected is None else Layout(1, *expected)) or (rows[1:] == ["3 4"] and found.start == 2)


def test_the_numbers_begin_in_one_of_the_first_sixty_lines():
    assert find_layout(["words"] * 59 + ["1 2"]) == Layout(59, None, ".", 2)
    assert find_layout(["words"] * 60 + ["1 2"]) is None


def test_the_numbers_end_at_the_first_line_of_words_behind_their_begin():
    lines = ["ab", "1 2", "1x", "nan", "", "-- End", "of"]
    assert [end_of_numbers(lines, start) for start in (0, 1, 5, 6, 7)] == [0, 5, 5, 6, 7]
    assert end_of_numbers(lines[:5], 1) == 5


def test_numbers_that_are_not_finite_are_numbers_in_any_letters_and_digits_of_other_scripts_are_none():
    assert [row_width(row, None) for row in ("NaN -INF", "nan +inf 1D5", "\u0661 \u0662", "1 x")] == [2, 3, 0, 0]


def layout(delimiter=None, decimal=".", width=2):
    return Layout(0, delimiter, decimal, width)


@pytest.mark.parametrize(
    ("rows", "as_written"),
    [
        (["1 -2.5", "3e1 4D-1"], layout()),
        (["1 -2.5", "", "3e1 4D-1"], layout()),
        (["1 -2.5", "3e1 4D-1", ""], layout()),
        (["1,-2.5", "30, 0.4"], layout(",")),
        (["1,-2.5,", "30, 0.4"], layout(",")),
        (['"1" "-2.5"', "30 0.4"], layout()),
        (["1;-2,5", "30;0,4"], layout(";", ",")),
        (["1 -2,5 ", "\t30 0,4"], layout(None, ",")),
    ],
)
def test_rows_as_they_are_written(rows, as_written):
    assert read_table("x.txt", rows, as_written, 7).tolist() == [[1.0, -2.5], [30.0, 0.4]]
    assert as_float("-1,5D+1") == -15.0


@pytest.mark.parametrize("blank", [0, 1, 4500])
def test_a_long_table_with_and_without_blank_rows(blank):
    numbers = np.arange(9000.0).reshape(-1, 2)
    rows = [f"{one} {other}" for one, other in numbers]
    assert np.array_equal(read_table("x.txt", [*rows[:2500], *[""] * blank, *rows[2500:]], layout(), 1), numbers)
    assert read_table("x.txt", [""] * blank, layout(), 1).shape == (0, 2)


@pytest.mark.parametrize(
    ("row", "as_written"),
    [
        *((row, layout()) for row in ("1,5 2", "1 2 3", "1", "1 x", "1 nan", "1 1e999")),
        *((row, layout(",")) for row in ("1,,2", "1,", "1 2")),
        ("0" * 9999 + " 1", layout()),  # a character more than a line may have
    ],
)
def test_the_first_row_that_is_no_row_of_the_table_is_blamed(row, as_written):
    for at in (0, 3, 2100, 4999):
        rows = [f"1{as_written.delimiter or ' '}2"] * 5000
        rows[at] = row
        rows[1] = ""
        with pytest.raises(
            RecordFormatError, match=rf"^x.txt:{at + 7}: expected 2 finite numbers, found '{row.rstrip(',')[:80]}'"
        ):
            read_table("x.txt", [*rows, "words"], as_written, 7)


def test_of_a_table_that_cannot_be_read_a_row_of_the_other_decimal_mark_is_to_blame():
    with pytest.raises(RecordFormatError, match=r"^x.txt:8: expected 2 finite numbers, found '1.5 2'"):
        read_table("x.txt", ["1,5 2", "1.5 2", "x 2"], layout(None, ","), 7)


def test_rows_that_are_sound_one_by_one_only_are_refused_too():
    with pytest.raises(RecordFormatError, match=r"^x.txt:7: the rows cannot be read as 2 columns of numbers"):
        read_table("x.txt", ["1 2", "3\u00a04"], layout(), 7)


@pytest.mark.parametrize(
    ("rows", "as_written", "named", "line"),
    [
        (["0,12", "1,34"], layout(","), True, 7),
        (["0,12", "1,34"], layout(","), False, 7),
        (["0,1,2", "1,3,4"], layout(",", width=3), False, 7),
        (["0,1,2", "1,3,4"], layout(",", width=3), True, None),
        (["0,1.2", "1,3"], layout(","), False, None),
        (["0,", "1,"], layout(",", width=1), False, None),
        (["0;1", "1;3"], layout(";"), False, None),
        (["0,5;1", "", "0.5;1", "0.5;1"], layout(";", ","), False, 9),
        (["0,5;1", "0,5;1"], layout(";", ","), False, None),
    ],
)
def test_a_comma_has_one_meaning(rows, as_written, named, line):
    if line is None:
        check_decimals("x.txt", rows, as_written, 7, named)
        return
    with pytest.raises(RecordFormatError, match=rf"^x.txt:{line}: .*(comma|decimal)"):
        check_decimals("x.txt", rows, as_written, 7, named)


def found(*lines, width, start=0, timed=False):
    return number_lines("record.txt", lines, Layout(start, None, ".", width), timed)


def test_the_head_of_one_column_is_its_count_with_or_without_the_interval():
    assert found("3", "0.1", "0.2", "0.3", width=1) == Numbered(1, 3, None)
    assert found("", "3", "0.01", "0.1", "0.2", "0.3", width=1) == Numbered(3, 3, 0.01)
    assert found("words", "0.01", "", "3", "0.1", "0.2", "0.3", width=1, start=1) == Numbered(4, 3, 0.01)
    unstated = found("3", "0.01", "0.2", "0.3", width=1, timed=True)
    assert unstated == Numbered(0)


@pytest.mark.parametrize("count", [4, 5])
def test_a_count_above_fewer_values_is_a_truncation(count):
    with pytest.raises(RecordFormatError, match=rf"^record.txt:2: expected {count} rows \(header\), found 3;"):
        found("", str(count), "-0.1", "0,2", "0.3", width=1)
    with pytest.raises(RecordFormatError, match=r"found 2;"):
        found("3", "0.1", "0.2", width=1)


@pytest.mark.parametrize(
    "values",
    [
        ["2", "0.1"],  # too few to tell
        ["2", "-0.1", "0.2", "0.3"],  # fewer than follow
        ["5", "1", "0.2", "0.3"],  # a value without a point
        ["5", "0.1", "0.2", "3"],
        ["5", "0.1", "1 0.2", "0.3"],
        ["0.01", "0.1", "0.2"],
        ["60", *["0.1"] * 48, "7", "0.1"],  # the last of the fifty that are looked at
    ],
)
def test_a_first_value_that_may_be_a_sample_is_one(values):
    assert found(*values, width=1) == Numbered(0)


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        *(([line], (300, 0.02)) for line in ("300 0.02", "0.02;300", "# 300, 2.0E-2 %")),
        (["300"], (300, None)),
        (["300", "", "0.02", " "], (300, 0.02)),
        (["0.02", "300"], (300, 0.02)),
        (["7", "300", "0.02"], (300, 0.02)),  # no more than two lines
        *((["300 0.02", line], None) for line in ("7", "words", "#")),
        *(([line], None) for line in ("300 0.02 0.05", "300 400 0.02", "300 -5", "0.02", "0 0.02")),
        ([], None),
    ],
)
def test_lines_of_numbers_right_above_the_samples(header, expected):
    lines = ["words", *header]
    start = len(lines)
    for width in (1, 3):
        row = " ".join(["0.5"] * width)
        assert found(*lines, row, row, width=width, start=start) == (
            Numbered(start) if expected is None else Numbered(start, *expected)
        )


def test_two_numbers_above_times_that_would_run_backwards_are_count_and_interval():
    assert found("3 0.01", "0.00 1.5", "0.01 2.5", width=2) == Numbered(1, 3, 0.01)
    assert found("words", "3 0.01", "1.00 4.5", width=2, start=1) == Numbered(2, 3, 0.01)
    assert found("3 0.01", "3 1.5", "4 2.5", width=2) == Numbered(1, 3, 0.01)
    assert found("0.01 3", "0.00 1.5", width=2) == Numbered(1, 3, 0.01)


@pytest.mark.parametrize(
    "rows", [["3 0.01", "3.5 1.5"], ["0 0.01", "0 1.5"], ["3 0.0", "1 2"], ["0.0 3", "0.0 2"], ["3 0.01"]]
)
def test_two_numbers_that_are_no_count_and_interval_are_a_row(rows):
    assert found(*rows, width=2) == Numbered(0)


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
        f"rows of {per_row} numbers were read as one series of 200, because the values "
        "continue smoothly from row to row; nothing in the file says so",
    )


@pytest.mark.parametrize("width", [5, 6, 8])
@pytest.mark.parametrize("short", [False, True])
def test_channels_side_by_side_are_no_series_in_rows(write, width, short):
    random = np.random.default_rng(width)
    motion = [np.convolve(random.standard_normal(230), np.hanning(31), "valid") for _ in range(width)]
    rows = [" ".join(f"{value:.5f}" for value in row) for row in np.column_stack(motion)]
    path = write("\n".join([*rows, "0.1 0.2 0.3"] if short else rows).encode())
    with pytest.raises(RecordFormatError, match=r"do not continue smoothly .*Otherwise, write one value per line"):
        read(path, units="g", dt=0.01)


def test_a_short_last_row_of_narrow_rows_that_run_on_is_the_end_of_a_series(write):
    (record,) = read(write(wrapped(VALUES, 3)), units="m/s2", dt=0.01)
    assert record.acceleration == pytest.approx(VALUES, abs=0.51e-6)
    with pytest.raises(RecordFormatError, match=r"rows of 4\. Rows of up to 4 numbers .* may be channels of a station"):
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
        *(([2.0] * 21, [step] * 20, series) for step, series in ((2.6, True), (2.7, False))),
        *(([step] * 21, [2.0] * 20, series) for step, series in ((2.6, True), (2.7, False))),
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


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.1, 1.0])
@pytest.mark.parametrize("width", [3, 5, 10, 40])
def test_channels_that_move_together_are_no_series(noise, width):
    """A rigid floor: one motion with a little noise on each channel."""
    random = np.random.default_rng(width)
    common = np.convolve(random.standard_normal(430), np.hanning(31), "valid")[:, None]
    assert not runs_on(common + noise * random.standard_normal((400, width)))


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
