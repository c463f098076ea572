"""The header of a COSMOS channel, line by line and number by number."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.cosmos import cosmos
from source_files import raises_if

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.kit.cosmos_header import CosmosHeader, fortran_layout, held_series, read_cosmos_header

TEXT = [f"line {number}" for number in range(1, 14)]


def header(kind="Raw acceleration", comments=(), integers=None, reals=None, **lines):
    """A header with some integers and reals, by their numbers, and some lines of text, as ``line9``."""
    whole, part = np.full(100, np.nan), np.full(100, np.nan)
    for target, given in ((whole, integers), (part, reals)):
        for number, value in (given or {}).items():
            target[number - 1] = value
    text = [lines.get(f"line{number}", line) for number, line in enumerate(TEXT, 1)]
    return CosmosHeader(kind, text, whole, part, -999.0, comments, 0, 0)


def lines_of(*replaced, **how):
    """The lines of a channel, some words of them replaced."""
    content = cosmos(np.round(pulse(16), 6), end="\n", **how).decode()
    for old, new in replaced:
        assert old in content
        content = content.replace(old, new)
    return content.split("\n")


@pytest.mark.parametrize(
    ("known", "codes"),
    [
        ({"comments": ["none", "| <SCNL>ABC.HNZ.CE.01  <AUTH>"], "line5": "Code:XX-YY"}, ("CE", "ABC", "01", "HNZ")),
        ({"comments": ["|<SCNL>ABC.HNZ.--.--"]}, ("", "ABC", "", "HNZ")),
        ({"line5": "Statn No: 05- 23837 Code:CE-23837 CGS", "integers": {8: 7}}, ("CE", "23837", "", "")),
        ({"line5": "Code: __-AB"}, ("", "AB", "", "")),
        ({"line5": "Code:---", "integers": {8: 7}}, ("", "7", "", "")),
        ({"integers": {7: 6, 8: 7, 9: 8}}, ("", "7", "", "")),
        ({}, ("", "", "", "")),
    ],
)
def test_the_codes_of_a_channel(known, codes):
    assert header(**known).codes() == codes


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Sta Chan 12:  90 deg (Rcrdr Chan  3) Location: Roof, NE ", ("12", "90 deg", "Roof, NE")),
        ("Sta Chan  4: Up (Rcrdr Chan  3)", ("4", "Up", "")),
        ("Channel 4", ("", "", "")),
    ],
)
def test_the_words_of_a_channel(line, words):
    assert header(line9=line).channel() == words
    for recorder, count in (("Etna ( 3 chns of 12 at Sta)", 3), ("Etna", 0)):
        assert header(line9=line, line7=recorder).counted()[1:4] == (recorder, words[0], count)


@pytest.mark.parametrize(
    ("kind", "found"), [("Raw acceleration", ("0.7", "g")), ("Uncorrected", ("0.7", "g")), ("CORRECTED", ("", ""))]
)
def test_the_peak_of_a_channel(kind, found):
    raw, own = "Uncor max = 0.7 g, at 1.0 sec", "Max = -12.5 cm/sec2 at 1.0 sec"
    assert header(kind, line10=raw, line11=own).peak() == ("-12.5", "cm/sec2")
    assert header(kind, line10=raw).peak() == found
    assert header(kind).peak() == ("", "")


@pytest.mark.parametrize(
    ("words", "code", "orientation", "azimuth"),
    [
        *(("?", code, "unknown", np.nan) for code in (None, 361, -1)),
        *(("?", code, "horizontal", azimuth) for code, azimuth in ((0, 0.0), (1, 1.0), (360, 0.0))),
        *(("90 deg", code, "horizontal", 90.0) for code in (None, 91)),
        *((words, code, "unknown", np.nan) for words, code in (("90 deg", 92), ("0.5 deg", 359), ("359.5 deg", 1))),
        ("Long", 45, "horizontal", 45.0),
        ("Long", 600, "horizontal", np.nan),
        *(("Up", code, "unknown", np.nan) for code in (401, 90)),
    ],
)
def test_the_direction_of_a_channel(words, code, orientation, azimuth):
    integers = {53: 7, 55: 8} if code is None else {53: 7, 54: code, 55: 8}
    facing = header(line9=f"Sta Chan 1: {words} (Rcrdr Chan 1)", integers=integers).facing()
    assert facing.orientation == orientation
    assert facing.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert bool(facing.note) is (orientation == "unknown" and words != "?")


@pytest.mark.parametrize(("code", "sign", "noted"), [(400, 1.0, False), (401, -1.0, False), (402, 1.0, True)])
def test_a_vertical_channel_by_its_integer(code, sign, noted):
    facing = header(integers={54: code}).facing()
    assert (facing.orientation, facing.sign, bool(facing.note)) == ("vertical", sign, noted)


@pytest.mark.parametrize(
    ("site", "anywhere", "unnamed"),
    [
        *[(site, False, False) for site in (1, 2, 3, 4, 6, 7, 8, 9, 14, 50, 51)],
        *[(site, True, True) for site in (5, 10, 11, 12, 13, 15, 20)],
        *[(site, True, False) for site in (None, 0, 16, 21, 49, 52)],
    ],
)
def test_the_type_of_a_station_tells_whether_it_is_a_structure(site, anywhere, unnamed):
    integers = {18: 5, 20: 5} | ({} if site is None else {19: site})
    for place, expected in (("Courtyard", anywhere), ("", unnamed), ("Free field", False), ("Roof", True)):
        words = f"Sta Chan 1: Up (Rcrdr Chan 1) Location: {place}"
        assert header(line9=words, integers=integers).structural() is expected


MOMENT = {40: 2018, 41: 241, 42: 8, 43: 29, 44: 2, 45: 33, 46: 5}
CLOCK = "Rcrd start time: 8/29/2018, 02:33: 9.75"


@pytest.mark.parametrize(
    ("integers", "second", "line", "found"),
    [
        ({}, 7.5, f"{CLOCK} UTC (Q=5)", 7.5),
        ({}, 7.5, "Rcrd start time: unknown", 7.5),
        ({}, 7.5, f"{CLOCK} gmt", 7.5),
        ({}, np.nan, f"{CLOCK} (RcrdId)", 9.75),
        ({}, np.nan, "rcrd start time: 8/29/2018, 02:33: 9.75", 9.75),
        ({}, np.nan, "Rcrd start time: 8/29/2018, 02:33: . UTC", "the start time has no seconds"),
        ({}, np.nan, "Rcrd start time: unknown", "the start time has no seconds"),
        ({}, 7.5, f"{CLOCK} PDT", "in PDT, but the format requires UTC"),
        ({46: 0}, 7.5, CLOCK, "quality 0"),
        ({46: 1}, 7.5, CLOCK, 7.5),
        ({46: np.nan}, 7.5, CLOCK, 7.5),
        ({44: 24}, 7.5, CLOCK, "2018-8-29 24:33:7.5 (integers 40 to 45) is not a valid start time"),
        *[({number: np.nan}, 7.5, CLOCK, "") for number in (40, 42, 43, 44, 45)],
        ({41: np.nan}, 7.5, CLOCK, 7.5),
    ],
)
def test_the_start_of_a_channel(integers, second, line, found):
    moment, notes = header(integers=MOMENT | integers, reals={29: 1.0, 30: second, 31: 2.0}, line8=line).start_time()
    if isinstance(found, str):
        assert moment is None
        assert len(notes) == bool(found)
        assert found in "".join(notes)
    else:
        assert (moment, notes) == (datetime(2018, 8, 29, 2, 33, int(found), int(found % 1 * 1e6), tzinfo=UTC), [])


@pytest.mark.parametrize(
    ("line", "layout"),
    [
        ("Format=(8F9.6)", (8, 9)),
        ("format = ( 1P,5E15.7)", (5, 15)),
        ("FORMAT= (1I1)", (1, 1)),
        ("x" * 189 + "Format=(8F12.6)", (8, 1)),  # of a line 200 letters are looked at
        ("x" * 190 + "Format=(8F12.6)", None),
        ("x" * 188 + "Format=(8F12.6)", (8, 12)),
        ("Format=(0F9.6)", None),
        ("Format=(8F0.6)", None),
        ("8F9.6", None),
    ],
)
def test_the_layout_of_a_table(line, layout):
    with raises_if(not layout, RecordFormatError, "a:1: expected a format such as"):
        assert fortran_layout(line, "a:1") == layout


def test_a_header_may_begin_anywhere_in_a_file():
    lines = lines_of(comments=("one", " two"), integers={19: 12}, reals={64: 0.25})
    for before in (0, 5):
        found = read_cosmos_header("a", [*["before"] * before, *lines, "behind"], before, before + len(lines))
        assert (found.start, found.end) == (before, before + 45)
        assert (found.kind, found.unknown) == ("Uncorrected acceleration", -999.0)
        assert [line.rstrip() for line in found.text] == [line.rstrip() for line in lines[:13]]
        assert [line.rstrip() for line in found.comments] == ["|one", "| two"]
        assert (found.integer(19), found.integer(20), found.real(64)) == (12, None, 0.25)
        assert np.isnan(found.real(66))


def test_a_line_that_does_not_tell_what_is_unknown():
    lines = lines_of(integers={20: -9}, reals={66: -9.0})
    lines[12] = "Values"
    found = read_cosmos_header("a", lines, 0, len(lines))
    assert (found.unknown, found.integer(19), found.integer(21), found.integer(20)) == (-999.0, 4, None, -9)
    assert (np.isnan(found.real(67)), found.real(66)) == (True, -9.0)


def test_comments_begin_with_a_bar():
    lines = lines_of(comments=("one", "two", "three"))
    assert read_cosmos_header("a", lines, 0, 45).end == 45  # where the channel ends before its comments
    lines[44] = "  " + lines[44]
    found = read_cosmos_header("a", lines, 0, len(lines))
    assert (found.end, len(found.comments)) == (46, 3)
    lines[45] = "three"
    with pytest.raises(RecordFormatError, match=r"a:46: expected comment 3 of 3, .*, found 't"):
        read_cosmos_header("a", lines, 0, len(lines))
    lines = lines_of(comments=())
    assert read_cosmos_header("a", lines, 0, len(lines)).end == 43


def test_numbers_that_touch_are_read_by_their_columns():
    lines = lines_of(integers={1: 12345678, 2: 23456789}, reals={1: -12345.678901, 2: -23456.789012})
    found = read_cosmos_header("a", lines, 0, len(lines))
    assert [found.integer(number) for number in (1, 2, 3)] == [12345678, 23456789, 2]
    assert [found.real(number) for number in (1, 2)] == [-12345.678901, -23456.789012]


@pytest.mark.parametrize("row", [14, 17, 23, 25, 40])
def test_a_damaged_number_of_a_header_is_named_with_its_line(row):
    lines = lines_of()
    lines[row] = lines[row].replace("-999", "-9x9", 1)
    assert lines != lines_of()
    with pytest.raises(RecordFormatError, match=rf"a:{row + 4}: expected a finite number, found '-9x9"):
        read_cosmos_header("a", [*["before"] * 3, *lines], 3, 3 + len(lines))


@pytest.mark.parametrize(
    ("unit", "code"), [("g.", "(04)"), ("counts", "(02)"), ("volts", "(51)"), ("g.", "(99)"), ("furlong", "")]
)
def test_a_unit_that_name_and_code_do_not_agree_on(write, unit, code):
    with pytest.raises(UnitError, match=r"record.txt:45: .*unit"):
        read(write(cosmos(pulse(), unit=unit, code=code)))


@pytest.mark.parametrize(
    ("component", "azimuth", "orientation", "sign", "told"),
    [
        ("0 Deg", 0, "vertical", 1.0, "an azimuth of 0 degrees"),
        ("Up", 0, "vertical", 1.0, "'Up' and 0 (integer 54 of the header)"),
        ("0 Deg", 401, "vertical", -1.0, "'0 Deg' and 401 (integer 54 of the header)"),
        ("Up", 401, "unknown", 1.0, ""),
        ("Up", 400, "vertical", 1.0, ""),
    ],
)
def test_a_channel_code_of_seed_decides_between_vertical_and_horizontal(
    write, component, azimuth, orientation, sign, told
):
    content = cosmos(pulse(), component=component, azimuth=azimuth, comments=("<SCNL>AKBMR.BNZ.AK.--",))
    (record,) = read(write(content))
    strongest = np.argmax(np.abs(pulse()))
    assert (record.orientation, record.channel) == (orientation, "BNZ")
    assert np.sign(record.acceleration[strongest]) == sign * np.sign(pulse()[strongest])
    words = "the channel code BNZ means vertical, but the header states "
    said = [warning for warning in record.warnings if words in warning]
    assert len(said) == bool(told)
    assert told in " ".join(said)


STRONGEST = np.where(np.arange(1000) == 500, -2.0, 0.5)  # 10 s, the peak at 5 s
LENGTH = "Raw record length ={:8.3f} sec, Uncor max = 0.3 g, at {:8.3f} sec."
PEAK = "Processed: CGS . Max = 0.3 g at {:8.3f} sec"


@pytest.mark.parametrize(
    ("about", "length", "uncorrected", "peak", "real", "raw", "corrected"),
    [
        ("10", 10.0, 5.0, 5.0, 5.0, 0, 0),
        ("10.1", 10.06, 5.02, 4.98, 5.01, 0, 0),
        ("10.5", 10.0, 5.0, 5.0, 5.0, 1, 1),
        ("11", 10.0, 5.0, 5.0, 5.0, 1, 1),
        ("9", 10.0, 5.0, 5.0, np.nan, 1, 1),
        ("10", 10.5, 5.0, 5.0, 5.0, 1, 0),
        ("10", 10.0, 8.0, 5.0, 5.0, 1, 0),
        ("10", 10.0, 5.0, 8.0, 5.0, 1, 1),
        ("10", 10.0, 5.0, 5.0, 8.0, 1, 1),
        ("10", 10.0, 5.0, 8.0, 8.0, 1, 1),  # told once
        ("10", 10.0, 5.0, 7.0, 8.0, 2, 2),
        ("11", 10.5, 7.0, 8.0, 9.0, 5, 3),
    ],
)
def test_length_and_peak_of_a_series(about, length, uncorrected, peak, real, raw, corrected):
    text = ["words"] * 8 + [PEAK.format(1.0), LENGTH.format(length, uncorrected), PEAK.format(peak), PEAK.format(1.0)]
    reals = np.full(100, np.nan)
    reals[64] = real
    for kind, count in (("Raw acceleration", raw), ("Uncorrected", raw), ("CORRECTED acceleration", corrected)):
        header = CosmosHeader(kind, text, np.full(100, np.nan), reals, -999.0, [], 0, 0)
        heading = f"1000 acceleration pts, approx {about} secs, units=g"
        for words in (heading, heading.upper()):
            assert len(held_series(header, words, 0.01, STRONGEST)) == count
