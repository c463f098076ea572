"""Columns of numbers: layouts, delimiters, time columns; nothing is guessed."""

import itertools
import re

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import table

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.formats.columns import is_columns
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

VALUES = np.round(pulse(200, peak=3.0), 6)
TIMES = np.arange(200) * 0.01


def test_the_unit_is_never_guessed(write):
    with pytest.raises(UnitError, match=r"record.txt: plain columns do not state their unit; .*--units g.* units='g'"):
        read(write(table(TIMES, VALUES)))


@pytest.mark.parametrize(
    ("units", "factor"),
    [("m/s2", 1.0), ("cm/s2", 0.01), ("gal", 0.01), ("mm/s^2", 0.001), ("g", STANDARD_GRAVITY), ("G/10", 0.980665)],
)
def test_units(write, units, factor):
    (record,) = read(write(table(TIMES, VALUES)), units=units)
    assert record.acceleration == pytest.approx(VALUES * factor, rel=1e-12)
    assert record.unit_factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.sweep
@pytest.mark.parametrize("delimiter", [" ", "   ", "\t", ",", ", ", ";"])
def test_delimiters_headers_and_line_ends(write, delimiter):
    headers = ("", "time acc\n", "# a comment\n# another, with 2 numbers\n\n")
    for header, end in itertools.product(headers, ("\n", "\r\n")):
        (record,) = read(write(table(TIMES, VALUES, delimiter=delimiter, header=header, end=end)), units="m/s2")
        assert record.dt == pytest.approx(0.01, rel=1e-12), (header, end)
        assert record.acceleration == pytest.approx(VALUES, rel=1e-12), (header, end)


@pytest.mark.parametrize("delimiter", [";", " ", "\t"])
def test_decimal_commas(write, delimiter):
    text = table(TIMES, VALUES, delimiter=delimiter).replace(".", ",")
    (record,) = read(write(text), units="m/s2")
    assert record.acceleration == pytest.approx(VALUES, rel=1e-12)


def test_blank_rows_quotes_and_separators_at_the_end_do_no_harm(write):
    rows = [f'{time:.2f}, "{value:.6f}",' for time, value in zip(TIMES, VALUES, strict=True)]
    (record,) = read(write("\n".join([*rows[:50], "", "  ", *rows[50:], ""])), units="m/s2")
    assert record.acceleration == pytest.approx(VALUES, rel=1e-12)


@pytest.mark.parametrize(("damaged", "cell"), [(0, "abc"), (1, ""), (2, "1.2.3"), (4, "abc")])
def test_a_damaged_cell_in_a_first_row_is_named_with_its_line(write, damaged, cell):
    rows = [f"{time:.2f},{value:.6f}" for time, value in zip(TIMES, VALUES, strict=True)]
    rows[damaged] = f"{TIMES[damaged]:.2f},{cell}"
    found = re.escape(f"record.txt:{damaged + 2}: expected a number in column 2, found {cell!r}; repair the cell")
    with pytest.raises(RecordFormatError, match=found):
        read(write("\n".join(["time [s],acc [g]", *rows])))


def test_a_single_column_needs_an_interval(write):
    path = write(table(VALUES))
    with pytest.raises(RecordFormatError, match=r"found none; .*--dt 0.01.*\[records\].*read\(path, .*dt=0.01\)"):
        read(path, units="m/s2")
    (record,) = read(path, units="m/s2", dt=0.02)
    assert (record.dt, record.npts) == (0.02, 200)


@pytest.mark.parametrize("columns", [(VALUES,), (TIMES + 0.01, VALUES)])
def test_a_first_line_with_count_and_step(write, columns):
    (record,) = read(write(table(*columns, header=" 200  0.01\n")), units="m/s2")
    assert record.acceleration == pytest.approx(VALUES, rel=1e-12)
    assert record.dt == pytest.approx(0.01, rel=1e-12)
    (record,) = read(write(table(*columns, header="150 0.01\n")), units="m/s2")
    assert record.npts == 150
    assert record.warnings == ("50 rows beyond the 150 of the first line were left out",)
    with pytest.raises(RecordFormatError, match=r"expected 300 rows \(header\), found 200"):
        read(write(table(*columns, header=" 300  0.01\n")), units="m/s2")


def test_half_of_the_rows_make_a_table_and_a_zero_byte_none():
    rows = b"1.0 2.0\n" * 10
    assert is_columns(rows + b"1.0 2.0 3.0\n" * 10, "x.txt")
    assert not is_columns(rows + b"1.0 2.0 3.0\n" * 11, "x.txt")
    assert not is_columns(rows + b"\x00", "x.txt")


def test_several_channels_with_headings(write):
    text = table(TIMES, VALUES, 2 * VALUES, 3 * VALUES, delimiter=",", header='"Time (s)",acc_NS,acc_EW,acc_UD\n')
    records = read(write(text), units="m/s2")
    assert [record.orientation for record in records] == ["horizontal", "horizontal", "vertical"]
    assert [record.azimuth for record in records[:2]] == [0.0, 90.0]
    assert [record.id for record in records] == ["record.acc_NS", "record.acc_EW", "record.acc_UD"]
    assert records[2].acceleration == pytest.approx(3 * VALUES, rel=1e-12)


def test_a_column_that_is_the_integral_of_the_one_before_it_is_no_acceleration(write):
    noise = np.random.default_rng(3).normal(size=200)
    velocity = np.append(0.0, np.cumsum(0.005 * (noise[1:] + noise[:-1])))
    with pytest.raises(RecordFormatError, match="column 3, which is the integral of column 2"):
        read(write(table(TIMES, noise, velocity, number="{:.9f}")), units="g")
    for first, second in ((0.005, 0.001), (0.001, 0.005)):
        other = np.append(0.0, np.cumsum(first * noise[1:] + second * noise[:-1]))
        assert len(read(write(table(TIMES, noise, other, number="{:.9f}")), units="g")) == 2
    velocity = np.append(0.0, np.cumsum(0.005 * (VALUES[1:] + VALUES[:-1])))
    with pytest.raises(RecordFormatError, match="column 3, which is the integral of column 2"):
        read(write(table(TIMES, VALUES, velocity, number="{:.9f}")), units="g")


def test_accelerations_that_run_like_time_are_named_by_their_own_heading(write):
    with pytest.raises(RecordFormatError, match=r"expected acceleration in the column 'acc \(g\)', found that it inc"):
        read(write(table(TIMES, VALUES, header="acc (g)  wind (m)\n")), units="g")


@pytest.mark.parametrize("count", [50, 51])
def test_a_spectrum_that_falls_is_refused_and_a_column_that_goes_up_and_down_is_left_out(write, count):
    steps = np.arange(count)

    def spectrum(first, quantity, **options):
        return read(write(table(first, VALUES[:count], header=f"{quantity}  acc (g)\n")), units="g", **options)

    with pytest.raises(NotAcceleration, match=r"found columns over 'period \(s\)', a spectrum"):
        spectrum(6.0 - 0.1 * steps, "period (s)")
    (record,) = spectrum(0.1 * (steps % 7), "frequency (Hz)", dt=0.01)
    assert record.acceleration == pytest.approx(VALUES[:count] * STANDARD_GRAVITY, rel=1e-12)
    assert record.warnings == ("columns left out because they are no accelerations: frequency (Hz)",)
    (record,) = spectrum(5.0 - 0.1 * (steps // 2), "period (s)", dt=0.01)
    assert record.warnings == ("columns left out because they are no accelerations: period (s)",)
    with pytest.raises(RecordFormatError, match="expected equally spaced times in the first column"):
        spectrum(0.1 * (steps // 2), "frequency (Hz)", dt=0.01)
    with pytest.raises(RecordFormatError, match="expected accelerations, found column 1, which increases like times"):
        read(write(table(0.1 * steps, header="frequency (Hz)\n")), units="g", dt=0.01)


@pytest.mark.parametrize(
    ("header", "behind", "told"),
    [
        ("", "end\n", "line 201: the numbers stop at 'end', and the header does not state how many there are"),
        ("NPTS = 200\n", "end\n", ""),
        ("NPTS = 200\n", "end\n1.0 2.0\n3.0 4.0\n", "line 202: the numbers stop at 'end'; 2 rows of numbers after"),
        ("", "velocity\n1.0 2.0\n", "line 201: the numbers stop at 'velocity'; 1 rows of numbers after it were left"),
        ("", "\n \n", ""),
    ],
)
def test_words_behind_the_numbers(write, header, behind, told):
    (record,) = read(write(table(TIMES, VALUES, header=header) + behind), units="g")
    assert record.npts == 200
    assert len(record.warnings) == bool(told)
    assert "".join(record.warnings).startswith(told)


def test_a_dead_first_channel_is_no_time(write):
    records = read(write(table(0.0 * VALUES, VALUES, header="ch1 ch2\n")), units="m/s2", dt=0.01)
    assert "dead channel" in records[0].warnings[0]
    assert records[1].acceleration == pytest.approx(VALUES)


@pytest.mark.parametrize("header", ["dt = 0.0\n", "sampling rate 0 Hz\n", "dt = 1e99\n"])
def test_an_interval_that_is_not_positive_is_refused(write, header):
    with pytest.raises(RecordFormatError, match=r"positive sampling interval|intervals disagree"):
        read(write(table(VALUES, header=header)), units="g", dt=None if "0" in header[:8] else 0.01)


TITLES = [
    *("Vs30: 360 m/s", "PGV = 25 cm/s", "Soil V", "Rate: 100", "Station 123", "Northridge 94", "Site class E"),
    *("Zone N", "velocity pulse Tp 4.2 s", "Spectrum-matched accelerogram, EC8 soil B", "Fourier filtered"),
    *("Spectrum-matched accelerogram", "Artificial accelerogram (spectrum-compatible)", "converted from cm/s2 to g"),
]


@pytest.mark.parametrize(
    ("heading", "orientation", "azimuth"),
    [("East [g]", "horizontal", 90.0), ("acc N-S (g)", "horizontal", 0.0), ("Up", "vertical", np.nan)],
)
def test_a_heading_above_one_column_still_counts(write, heading, orientation, azimuth):
    (record,) = read(write(table(VALUES, header=f"{heading}\n")), units="g", dt=0.01)
    assert (record.orientation, record.azimuth) == (orientation, pytest.approx(azimuth, nan_ok=True))


@pytest.mark.parametrize("title", ["Acceleration (g) vs Time (s)", "Original dt = 0.005 s, resampled", *TITLES])
def test_a_title_above_time_and_acceleration_is_no_heading(write, title):
    (record,) = read(write(table(TIMES, VALUES, header=f"{title}\n")), units="g")
    assert (record.npts, record.dt) == (len(VALUES), 0.01)
    assert record.acceleration == pytest.approx(VALUES * STANDARD_GRAVITY, abs=1e-5)
    if title in TITLES:
        (record,) = read(write(table(VALUES, header=f"{title}\n")), units="g", dt=0.01)
        assert (record.npts, record.orientation, record.channel) == (len(VALUES), "unknown", "1")
        assert np.isnan(record.azimuth)


def rows(*columns, layout="{:9.4f}"):
    return "".join("".join(map(layout.format, row)) + "\n" for row in zip(*columns, strict=True))


@pytest.mark.parametrize("offset", [0.0, -300.0])
def test_decimals_that_touch_at_a_sign_are_read_apart(write, offset):
    strong = 100.0 * VALUES + offset
    records = read(write(rows(TIMES, strong, -strong, strong)), units="cm/s2")
    assert len(records) == 3
    assert records[0].acceleration == pytest.approx(strong / 100.0, abs=1e-6)
    assert records[1].acceleration == pytest.approx(-strong / 100.0, abs=1e-6)


def test_decimals_that_touch_without_a_sign_are_refused(write):
    apart, touching = rows(TIMES, VALUES, VALUES), "100.0000103.2500\n" * 9
    with pytest.raises(RecordFormatError, match="txt:1: expected blanks between numbers, found numbers that touch in"):
        read(write(touching + apart), units="cm/s2", dt=0.01)
    with pytest.raises(RecordFormatError, match=r"txt:201: expected 3 finite numbers, found '100\.0000103\.2500'"):
        read(write(apart + touching), units="cm/s2", dt=0.01)
