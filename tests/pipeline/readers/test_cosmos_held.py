"""COSMOS: what the header states twice is held against each other, and against the channels of the file."""

from __future__ import annotations

import numpy as np
import pytest
from record_writers import pulse
from record_writers.cosmos import cosmos

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.kit.cosmos_header import Header, held_series
from rockpulse.record.record import STANDARD_GRAVITY

G = STANDARD_GRAVITY


@pytest.mark.parametrize(
    ("unit", "code"), [("g.", "(04)"), ("counts", "(02)"), ("volts", "(51)"), ("g.", "(99)"), ("furlong", "")]
)
def test_a_unit_that_name_and_code_do_not_agree_on(write, unit, code):
    with pytest.raises(UnitError, match=r"record.txt:45: .*unit"):
        read(write(cosmos(pulse(), unit=unit, code=code)))


def channels_of_three(*numbers: int) -> bytes:
    directions = {1: ("360 deg", 360), 2: ("Up", 400), 3: (" 90 deg", 90)}
    return b"".join(
        cosmos(pulse(), number=number, component=directions[number][0], azimuth=directions[number][1])
        for number in numbers
    )


@pytest.mark.parametrize(("numbers", "lacking"), [((1, 2, 3), False), ((1, 2), True), ((1, 3), True), ((2,), False)])
def test_channels_that_the_header_counts_and_the_file_lacks(write, numbers, lacking):
    for record in read(write(channels_of_three(*numbers))):
        assert any("the header counts 3 channels of this recorder" in note for note in record.warnings) is lacking


def test_a_file_of_one_channel_without_its_last_line_says_so(write):
    content = channels_of_three(1)
    (record,) = read(write(content[: content.index(b"End-of-data")]))
    assert "the file holds 1; it may be truncated" in record.warnings[0]


def test_a_channel_of_one_number_with_other_samples_is_damage(write):
    with pytest.raises(
        RecordFormatError, match=r"record.txt:97: expected another channel, found that of line 1 a second"
    ):
        read(write(channels_of_three(1) + cosmos(pulse(peak=0.2), number=1, component="360 deg", azimuth=360)))


@pytest.mark.parametrize(
    ("old", "new", "warned"),
    [
        (b"units=g.     (02)", b"units=cm/s2. (04)", True),
        (b"units=g.     (02)", b"units=mg.    (11)", True),
        (b"units=g.     (02)", b"units=g.     (02)", False),
    ],
)
def test_the_peak_of_the_text_has_a_unit_of_its_own(write, old, new, warned):
    content = cosmos(pulse())
    assert old in content
    (record,) = read(write(content.replace(old, new)))
    assert any("the header states a peak of 0.3 g" in note for note in record.warnings) is warned


def test_the_quantity_of_title_and_integer(write):
    with pytest.raises(RecordFormatError, match=r"record.txt:1: the title says .* integer header 2 says 2, velocity"):
        read(write(cosmos(pulse(), integers={2: 2})))
    assert read(write(cosmos(pulse(), integers={2: -999})))[0].warnings == ()


@pytest.mark.parametrize("place", ["West wall 4th level", "10th-floor", "Subbasement"])
def test_a_free_field_code_does_not_hide_a_structure(write, place):
    assert read(write(cosmos(pulse(), site=4, place=place)))[0].orientation == "structural"


@pytest.mark.parametrize(
    ("component", "azimuth", "orientation", "sign", "told"),
    [
        ("0 Deg", 0, "vertical", 1.0, "an azimuth of 0 degrees"),
        ("Up", 0, "vertical", 1.0, "'Up' and 0 (integer header 54)"),
        ("0 Deg", 401, "vertical", -1.0, "'0 Deg' and 401 (integer header 54)"),
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
    said = [warning for warning in record.warnings if "the channel code BNZ says vertical, the header " in warning]
    assert len(said) == bool(told)
    assert told in " ".join(said)


@pytest.mark.parametrize(("code", "azimuth"), [(359, 0.0), (1, 0.0), (358, np.nan), (2, np.nan), (178, np.nan)])
def test_words_and_integer_of_a_direction_may_differ_by_a_degree(write, code, azimuth):
    (record,) = read(write(cosmos(pulse(), component="360 deg", azimuth=code)))
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)


def test_the_peak_is_that_of_the_series_and_not_of_the_uncorrected_one(write):
    content = cosmos(pulse())
    assert content.count(b"Uncor max =   0.300") == 1
    (record,) = read(write(content.replace(b"Uncor max =   0.300", b"Uncor max =   0.700")))
    assert record.header_peak == pytest.approx(0.3 * G, abs=1e-6)


def test_recorders_are_told_apart_by_their_words(write):
    one = cosmos(pulse(), number=1, recorder="Etna   s/n 1193 ( 1 Chns of   2 at Sta)")
    other = cosmos(pulse(), number=2, recorder="Etna   s/n 1194 ( 1 Chns of   2 at Sta)")
    for record in read(write(one + other)):
        assert not any("the header counts" in note for note in record.warnings)
    with pytest.raises(RecordFormatError, match="expected another channel"):
        read(write(one + cosmos(2.0 * pulse(), number=1, recorder="Etna   s/n 1193 ( 1 Chns of   2 at Sta)")))
    other = cosmos(pulse(), number=1, recorder="Etna   s/n 1194 ( 1 Chns of   2 at Sta)", place="Roof")
    assert len(read(write(one + other))) == 2


def test_the_last_number_of_a_header_is_read_and_none_beyond_it():
    header = Header("", [], np.array([7.0, 8.0]), np.array([0.5, 1.5]), -999.0, [], 0, 0)
    assert [header.integer(number) for number in (1, 2, 3)] == [7, 8, None]
    assert [header.real(number) for number in (1, 2)] == [0.5, 1.5]
    assert np.isnan(header.real(3))


def test_two_channels_of_one_direction_are_two(write):
    one, other = (
        cosmos(size * pulse(), number=number, component="Up", azimuth=400, place=place)
        for size, number, place in ((1.0, 1, "Roof"), (2.0, 2, "Basement"))
    )
    assert [record.orientation for record in read(write(one + other))] == ["structural", "structural"]


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
        header = Header(kind, text, np.full(100, np.nan), reals, -999.0, [], 0, 0)
        heading = f"1000 acceleration pts, approx {about} secs, units=g"
        for words in (heading, heading.upper()):
            assert len(held_series(header, words, 0.01, STRONGEST)) == count


@pytest.mark.parametrize(("letters", "told"), [(200, 1), (201, 0)])
def test_of_a_heading_two_hundred_letters_are_looked_at(letters, told):
    header = Header("Raw", ["words"] * 12, np.full(100, np.nan), np.full(100, np.nan), -999.0, [], 0, 0)
    heading = "1000 pts, approx".ljust(letters - 6) + "12 sec"
    assert len(held_series(header, heading, 0.01, STRONGEST)) == told
