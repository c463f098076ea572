"""Numbers in text: lines of any kind, fixed widths, blanks, and the messages when they are wrong."""

import numpy as np
import pytest

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers.kit.text import (
    UNITS,
    canonical_unit,
    check_count,
    fixed_width,
    free_numbers,
    free_rows,
    mentioned_units,
    other_readings,
    printed_number,
    quantity_of,
    text_lines,
)


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r", b"\r\r\n"])
def test_lines_end_in_any_way(end):
    assert text_lines(end.join([b"one", b"", b" two ", b"three"])) == ["one", "", " two ", "three"]


@pytest.mark.parametrize("tail", [b"", b"\n", b"\r\n\r\n", b"\x1a", b"\r\n\x1a", b"\x1a\x00\x00", b"\n  \n\t\n"])
def test_what_follows_the_last_line_is_left_out(tail):
    assert text_lines(b"one\n two" + tail) == ["one", " two"]


def test_any_byte_is_a_character():
    assert text_lines("Düzce 12°\n".encode()) == text_lines("Düzce 12°\n".encode("latin-1")) == ["Düzce 12°"]
    assert len(text_lines(bytes(byte for byte in range(256) if byte not in b"\r\n"))[0]) == 254


@pytest.mark.parametrize(
    ("text", "value", "half"),
    [
        ("7.25e-100", 7.25e-100, 5e-103),
        (" 2.E+100", 2e100, 5e99),
        ("3.91E+1", 39.1, 0.05),
        (" -.344 ", -0.344, 5e-4),
        ("12", 12.0, 0.5),
        ("1D-2", 0.01, 5e-3),
    ],
)
def test_printed_numbers_know_their_rounding(text, value, half):
    assert printed_number(text) == (pytest.approx(value, rel=1e-12), pytest.approx(half, rel=1e-12))


def test_a_count_is_held_against_what_is_there():
    check_count("a.V1:3", 5, 5)
    check_count("a.V1:3", 1, 2)
    with pytest.raises(RecordFormatError, match=r"a.V1:3: expected 6 samples \(header\), found 5"):
        check_count("a.V1:3", 6, 5)
    with pytest.raises(RecordFormatError, match="expected a positive number of rows in the header, found -6"):
        check_count("a.V1:3", -6, 5, "rows")


def test_fields_that_touch_are_split_by_width():
    rows = ["-1.00000-2.00000 3.00000", "-1.00E-2  .5D+01"]
    assert list(fixed_width(rows, 1, 8, 3, 5, "a")) == [-1.0, -2.0, 3.0, -0.01, 5.0]


@pytest.mark.parametrize(
    "rows", [["   1   2   3", "   4"], ["   1   2   3  ", "   4   "], ["   1   2   3", "   4   5   6"]]
)
def test_blanks_at_the_end_and_fields_beyond_the_count_do_not_matter(rows):
    assert list(fixed_width([*rows, "no number"], 1, 4, 3, 4, "a")) == [1.0, 2.0, 3.0, 4.0]


@pytest.mark.parametrize(
    ("rows", "count", "message"),
    [
        ([], 4, "a:7: expected 4 numbers .*found 0"),
        (["   1   2   3", "   4   5   6"], 7, "a:9: expected 7 numbers .*found 6"),
        (["   1   2   3", "   4   5", "   7"], 7, "a:8: expected 3 fields of 4 characters, found a row of 8"),
        (["   1   2   3", "   4   5"], 6, "a:9: expected 6 numbers .*found 5"),
        (["   1   2   3", "   4   5   6   7"], 5, "a:8: expected 2 fields of 4 characters, found a row of 16"),
        (["   1   2   3   4"], 2, "a:7: expected 2 fields of 4 characters, found a row of 16"),
        (["   1   2   3", "   4       6", "   7"], 7, "a:8: expected a finite number, found 'a blank field'"),
        *(
            (["   1   2   3", f"   4 {word}   6", "   7"], 7, f"a:8: expected a finite number, found '{word.strip()}'")
            for word in ("x.5", "nan", "1 2", "1_2", "  ²", "  ٣")
        ),
        (["   1   2   3", "   4   \0   6", "   7"], 7, "a:8: expected a finite number"),
    ],
)
def test_the_line_of_a_fault_is_named(rows, count, message):
    assert fixed_width(["   1   2   3", "   41e99 1e9", "1999"], 7, 4, 3, 7, "a")[4] == 1e99
    with pytest.raises(RecordFormatError, match=message):
        fixed_width(rows, 7, 4, 3, count, "a")


@pytest.mark.parametrize(("width", "per_row", "count"), [(0, 3, 1), (4, 0, 1), (-1, 3, 1), (4, 3, 0), (4, 3, -5)])
def test_a_layout_that_is_none_is_refused(width, per_row, count):
    with pytest.raises(RecordFormatError, match=r"at least 1 character|a positive number of numbers"):
        fixed_width(["   1   2   3"], 1, width, per_row, count, "a")


def test_rows_of_numbers_between_blanks():
    assert np.array_equal(free_rows(["1 2 3", " 4  5 6"], 1, 3, "a"), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    with pytest.raises(RecordFormatError, match="a:6: expected a row of 2, found '3'; correct the line"):
        free_rows(["1 2", "3", "4"], 5, 2, "a")
    with pytest.raises(RecordFormatError, match="a:6: expected a finite number, found 'x'"):
        free_rows(["1 2", "3 x"], 5, 2, "a")


@pytest.mark.parametrize("count", [10**9, 10**18])
def test_a_huge_count_allocates_nothing(count):
    with pytest.raises(RecordFormatError, match="found 3"):
        fixed_width(["   1   2   3"], 1, 4, 3, count, "a")
    with pytest.raises(RecordFormatError, match="found"):
        fixed_width(["   1   2   3"], 1, count, count, count, "a")


def test_numbers_between_blanks():
    assert list(free_numbers(["1 -2.5E+1\t3.D0", "", " .5"], 1, "a")) == [1.0, -25.0, 3.0, 0.5]
    assert free_numbers([], 1, "a").size == 0


@pytest.mark.parametrize("word", ["x", "1.2.3", "1e999", "--1", "1_0", "٣", "nan", "1,5", "\0"])
def test_what_is_no_number_is_named_with_its_line(word):
    with pytest.raises(RecordFormatError, match=r"a:4: expected a finite number, found '"):
        free_numbers(["1 2", f"3 {word} 4"], 3, "a")


def test_random_numbers_come_back_to_the_last_bit():
    values = np.random.default_rng(2).standard_normal(1000) * 10.0 ** np.arange(-50, 50).repeat(10)
    fields = [f"{value:25.17E}" for value in values]
    rows = ["".join(fields[start : start + 3]) for start in range(0, 1000, 3)]
    assert np.array_equal(fixed_width(rows, 1, 25, 3, 1000, "a"), values)
    assert np.array_equal(free_numbers(rows, 1, "a"), values)


@pytest.mark.parametrize("text", ["1E" + "1" * 5000, "1E999", "1" * 5000, "1E-" + "1" * 5000, "1E+0001"])
def test_a_number_beyond_all_numbers_is_none(text):
    value, half = printed_number(text)
    assert np.isnan(value)
    assert half == 0.0


@pytest.mark.parametrize(
    ("unit", "spellings"),
    [
        ("m/s2", "m/s2 M/S^2 m/s**2 m/sec2 m/s/s m/s² ms-2 m·s⁻² m.s^-2"),
        ("cm/s2", "cm/s2 CM/SEC/SEC cm/sec^2 cm/second2 cm/s² cms-2"),
        ("mm/s2", "mm/s2 mm/s/s"),
        ("gal", "gal Gals GAL."),
        ("g", "g G g. (g)"),
        ("g/10", "g/10 G/10."),
    ],
)
def test_spellings(unit, spellings):
    for text in spellings.split():
        assert canonical_unit(f" {text} ", "a:1") == unit


@pytest.mark.parametrize("text", ["", "counts", "m/s", "cm", "m/s3", "s-2", "kg", "gg", "1"])
def test_what_is_no_unit_of_acceleration(text):
    with pytest.raises(UnitError, match=r"a:1: unknown unit of acceleration .* expected one of m/s2, "):
        canonical_unit(text, "a:1")


def test_the_nearest_unit_is_named():
    with pytest.raises(UnitError, match=r"^option --units: unknown .* 'gg' \(did you mean \"g\"\?\); .*, g, g/10$"):
        canonical_unit("gg", "option --units")


def test_other_readings_are_ordinary_accelerations():
    assert other_readings(300.0) == "0.306 g if it is cm/s2 or 0.0306 g if it is mm/s2"
    assert other_readings(20.0, "cm/s2") == "2.04 g if it is m/s2 or 0.00204 g if it is mm/s2 or 2 g if it is g/10"
    assert other_readings(1e9) == "1.02e+05 g if it is mm/s2, which is not an ordinary acceleration either"
    assert other_readings(1e-4, "g") == "1.02e-05 g if it is m/s2, which is not an ordinary acceleration either"


@pytest.mark.parametrize(("share", "ordinary"), [(0.0009, False), (0.001, True), (3.0, True), (3.5, False)])
def test_an_ordinary_acceleration_is_from_a_thousandth_of_gravity_to_three_times_it(share, ordinary):
    assert other_readings(share * UNITS["g"]).startswith(f"{share:g} g if it is m/s2") is ordinary


@pytest.mark.parametrize(
    ("quantity", "units"),
    [
        ("acceleration", "cm/s2;Gal;mg"),
        ("velocity", "cm/sec;kine"),
        ("displacement", "mm"),
        ("time", "msec"),
        ("frequency", "Hz"),
        ("", "NS;"),
    ],
)
def test_what_a_unit_measures(quantity, units):
    assert {quantity_of(unit) for unit in units.split(";")} == {quantity}


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("acc_cm_s2", [("acceleration", "cm/s2")]),
        ("acc_cm_per_s2", [("acceleration", "cm/s2")]),
        ("a in mps2", [("acceleration", "m/s2")]),
        ("acceleration m s-2", [("acceleration", "m/s2")]),
        ("m·s⁻²", [("acceleration", "m/s2")]),
        ("UNIT = gal(cm/s/s)", [("acceleration", "gal"), ("acceleration", "cm/s2")]),
        ("cm/sec squared, cm/sec", [("acceleration", "cm/s2"), ("velocity", "")]),
        ("time_in_s, 5 m south, comms", []),
    ],
)
def test_units_in_running_text(text, units):
    found = [
        (quantity, canonical_unit(wording, "a:1") if quantity == "acceleration" else "")
        for quantity, wording, _ in mentioned_units(text)
    ]
    assert found == units


def test_units_in_running_text_as_they_are_written_and_where():
    assert list(mentioned_units("Acc. (Gal), vel_cm_s")) == [("acceleration", "Gal", 6), ("velocity", "cm_s", 16)]
    assert list(mentioned_units("Größe in M·s⁻²")) == [("acceleration", "m·s-2", 9)]
