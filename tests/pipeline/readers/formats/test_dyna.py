"""DYNA 1.x (ESM, ITACA, AFAD): the keys, the styles of dates, what is no acceleration, damaged files."""

import re
from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers._shared import pulse
from record_writers.dyna import CORRECTED, TADAS, dyna
from source_files import got_one

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.formats.dyna import DYNA

VALUES = np.round(pulse(300, peak=98.0), 6)
OTHER = dyna(0.5 * VALUES, STREAM="HNN")
START = "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS"


def test_values_are_read_from_the_first_line_that_is_no_key():
    record = got_one(dyna(VALUES))
    assert record.acceleration == pytest.approx(0.01 * VALUES, rel=1e-12)
    assert (record.dt, record.source_unit, record.warnings) == (0.01, "cm/s2", ())
    more = got_one(dyna(VALUES, USER6="", USER7="", USER8="a b", USER9="1.5", USER10="c:d"))
    assert np.array_equal(more.acceleration, record.acceleration)


@pytest.mark.parametrize("day", ["20190728_1609", "2019/07/28 16:09:", "2019-07-28T16:09:", "28/7/2019 16:09:"])
def test_styles_of_dates(day):
    assert got_one(dyna(VALUES, **{START: f"{day}19.870"})).start_time == datetime(
        2019, 7, 28, 16, 9, 19, 870000, tzinfo=UTC
    )


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({START: "20190728_190919.870"}, "lies 3.0 h from the earthquake of 2019-07-28 16:09:08"),
        ({START: "07/28/2019 16:09:19"}, "cannot be read"),
        ({START: "20190728_2509"}, "cannot be read"),
        ({START: "20190728_160961.000"}, "cannot be read"),
        ({START: "19800101_000012.000", "EVENT_DATE_YYYYMMDD": ""}, "never set"),
    ],
)
def test_a_doubtful_start_is_left_out_with_the_reason(changes, reason):
    record = got_one(dyna(VALUES, **changes))
    assert record.start_time is None
    assert reason in record.warnings[0]


def test_no_start_is_no_news_and_a_rough_one_is():
    assert got_one(dyna(VALUES, **{START: ""})).warnings == ()
    rough = got_one(dyna(VALUES, DATE_TIME_FIRST_SAMPLE_PRECISION="minute"))
    assert rough.start_time is not None
    assert "known to the minute only" in rough.warnings[0]


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        ({"LATE/NORMAL_TRIGGERED": "LT"}, "triggered late"),
        (CORRECTED | {"BASELINE_CORRECTION": "BASELINE NOT REMOVED"}, "the baseline was not removed"),
        ({"SENSOR_DEPTH_M": "30.0"}, "30 m below the ground"),
        ({"DURATION_S": "30.0"}, "the header states a duration of 30 s, but 300 samples at 0.01 s last 3 s"),
        ({"PGA_CM/S^2": "-120.5"}, "the header states a peak of 0.1229 g"),
        ({"NETWORK": "HI\nNETWORK: XX"}, "states NETWORK as 'HI' (line 14) and 'XX'; the first value is used"),
        *(
            ({key: "1E308"}, f"{key} is not a valid number: '1E308'")
            for key in ("PGA_CM/S^2", "TIME_PGA_S", "DURATION_S", "HIGH_CUT_FREQUENCY_HZ")
        ),
    ],
)
def test_what_the_header_says_against_the_record(changes, warning):
    (note,) = got_one(dyna(VALUES, **changes)).warnings
    assert warning in note


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (dyna(VALUES)[:-500], r"stream:\d+: expected 300 samples .* found 2\d\d"),
        (dyna(VALUES, NDATA=0), "stream:30: expected a number of samples above 0, found '0'"),
        (dyna(VALUES, NDATA="9" * 5000), f"stream:30: expected a number of samples above 0, found '{'9' * 5000}'"),
        (dyna(VALUES, SAMPLING_INTERVAL_S="0.0"), "stream:29: expected a sampling interval"),
        (
            dyna(VALUES, without=["SAMPLING_INTERVAL_S"]),
            "stream:63: expected a sampling interval in s above 0, found none",
        ),
        (dyna(VALUES, without=["DATA_TYPE"]), "stream:63: expected 'DATA_TYPE: ACCELERATION' in"),
        (dyna(VALUES, UNITS="furlong"), "stream:33: unknown unit of acceleration 'furlong'"),
        (
            dyna(VALUES, DATA_TYPE="VELOCITY"),
            "stream:50: expected 'DATA_TYPE: ACCELERATION', found 'VELOCITY'; read the",
        ),
        (dyna(VALUES) + OTHER, "found 'EVENT_NAME: GREECE', the beginning of another record"),
        (TADAS.encode() + dyna(VALUES) + TADAS.encode() + OTHER, "the beginning of another record"),
        (dyna(VALUES).replace(b"\n98.0000", b"\n98.0x00"), "stream:77: expected a finite number"),
        (dyna(VALUES).replace(b"\n98.0000", b"\n98.0 00"), "stream:77: expected one number on"),
        (dyna(VALUES).replace(b"STREAM:", b"STREAM "), "stream:31: expected 'DATA_TYPE"),
    ],
)
def test_damage_is_named(content, message):
    with pytest.raises(RockpulseError, match=message):
        got_one(content)


#: AFAD's portal of today: the corners stand before the first key, the header of old has none.
NO_CORNERS = CORRECTED | {"LOW_CUT_FREQUENCY_HZ": "", "HIGH_CUT_FREQUENCY_HZ": ""}
FILTERED = ("file: Butterworth order 1, 0.025-40 Hz (AAD lines)", "file: baseline removed (AAD lines)")


def test_the_lines_of_afad_before_the_title_are_the_processing():
    plain, record = got_one(dyna(VALUES, **NO_CORNERS)), got_one(TADAS.encode() + dyna(VALUES, **NO_CORNERS))
    assert np.array_equal(plain.acceleration, record.acceleration)
    assert (record.processed, record.processing, record.warnings) == (True, FILTERED, ())
    assert plain.processed is None
    both = got_one(TADAS.encode() + dyna(VALUES, **CORRECTED))
    assert both.processing == ("file: Butterworth, 0.1-30 Hz", *FILTERED)
    assert both.warnings == ("the file states two filters: 0.1-30 Hz and 0.025-40 Hz",)


CORNERS = CORRECTED | {"FILTER_TYPE": ""}
OPEN = NO_CORNERS | {"FILTER_TYPE": ""}


def corners(low: str, high: str) -> dict[str, str]:
    return CORNERS | {"LOW_CUT_FREQUENCY_HZ": low, "HIGH_CUT_FREQUENCY_HZ": high}


@pytest.mark.parametrize(
    ("lines", "changes", "processed", "processing"),
    [
        ("", {}, False, ""),
        ("", {"PROCESSING": "None"}, False, ""),
        ("", {"PROCESSING": ""}, None, ""),
        ("", CORRECTED, True, "file: Butterworth, 0.1-30 Hz"),
        ("", corners("0.1", "0.5"), True, "file: filtered, 0.1-0.5 Hz"),
        ("", corners("0.1", "0"), True, "file: filtered, above 0.1 Hz"),
        ("", corners("0", "0.5"), True, "file: filtered, below 0.5 Hz"),
        ("", corners("0", "0"), None, ""),
        ("", corners("-1", ""), None, ""),
        ("", corners("", "-1"), None, ""),
        ("AAD_LOW_CUT_FREQUENCY_HZ: 0.05\n", OPEN, True, "file: filtered, above 0.05 Hz (AAD lines)"),
        ("AAD_HIGH_CUT_FREQUENCY_HZ: 25\n", OPEN, True, "file: filtered, below 25 Hz (AAD lines)"),
        ("AAD_LOW_CUT_FREQUENCY_HZ:\nAAD_HIGH_CUT_FREQUENCY_HZ:\n", OPEN, None, ""),
        ("AAD_Filtered_TADAS_FILE\n", OPEN, True, ""),
    ],
)
def test_a_record_is_corrected_if_the_header_states_a_filter(lines, changes, processed, processing):
    record = got_one(lines.encode() + dyna(VALUES, **changes))
    assert (record.processed, "".join(record.processing)) == (processed, processing)


def test_other_lines_before_the_title_are_told_and_not_used():
    content = b"\n# exported by hand\nAAD_LOW_CUT_FREQUENCY_HZ: five\nNDATA: 7\n" + dyna(VALUES)
    record = got_one(content)
    assert record.npts == VALUES.size
    assert [note.partition(" is unknown")[0] for note in record.warnings] == [
        f"line {line}, before EVENT_NAME," for line in (2, 3, 4)
    ]
    assert "'# exported by hand'" in record.warnings[0]


def test_a_text_that_quotes_a_header_is_no_dyna_file():
    header = dyna(VALUES)[: dyna(VALUES).index(b"USER5:") + 8]
    row = DYNA
    assert row.detect(b'HEADER = """\n' + header + b'"""\n', "writer.py") is False
    assert row.detect(b"title\n" + header + b"-1.5\n", "x.asc") is True
    assert row.detect(b"title\n" + header, "cut.asc") is True
    assert row.detect(b"title\nEVENT_NAME: GREECE\n1.0\n", "x.txt") is False
    keys, title = b"STATION_CODE: A\nNDATA: 2\nUNITS: g\n", b"EVENT_NAME: GREECE\n"
    assert row.detect(b"title\n" + title + keys[keys.index(b"N") :] + b"1.0\n", "x.txt") is False
    for words, known in ((2, True), (3, False)):  # a number among the three lines behind
        assert row.detect(b"title\n" + title + keys + b"words\n" * words + b"1.0\n", "x.txt") is known
    for before, known in ((199, True), (200, False)):
        assert row.detect(b"title\n" * before + title + keys + b"1.0\n", "x.txt") is known


@pytest.mark.parametrize(("key", "other"), [("SAMPLING_INTERVAL_S", "0.02"), ("NDATA", "299"), ("UNITS", "m/s^2")])
def test_a_key_with_two_values_that_decides_is_refused(key, other):
    content = dyna(VALUES)
    at = content.index(f"{key}:".encode())
    line = content[at : content.index(b"\n", at) + 1]
    assert got_one(content[:at] + line + content[at:]).warnings == ()
    with pytest.raises(RecordFormatError, match=rf"expected one value of {key}, .* and '{re.escape(other)}'"):
        got_one(content[:at] + line + f"{key}: {other}\n".encode() + content[at + len(line) :])


def test_the_facts_of_the_header():
    facts = {"VS30_M/S": "450", "SITE_CLASSIFICATION_EC8": "B", "MAGNITUDE_W": "4.7"}
    record = got_one(dyna(VALUES, **facts))
    assert (record.event_id, record.event) == ("EMSC-20190728_0000106", "GREECE")
    assert record.origin_time == datetime(2019, 7, 28, 16, 9, 8, tzinfo=UTC)
    assert (record.magnitude, record.magnitude_type) == (4.7, "Mw")
    assert (got_one(dyna(VALUES)).magnitude, got_one(dyna(VALUES)).magnitude_type) == (4.6, "ML")
    assert (record.hypocentre_latitude, record.hypocentre_longitude, record.hypocentre_depth) == (38.1, 23.54, 9000.0)
    assert (record.station_latitude, record.station_longitude) == (37.6349, 22.7293)
    assert (record.epicentral_distance, record.vs30, record.site_class) == (88_100.0, 450.0, "B")


@pytest.mark.parametrize(
    ("name", "azimuth"),
    [
        ("HI.ARS1..HNE.D.20190728.ASC", 90.0),
        ("HI.ARS1..HNN.D.20190728.ASC", None),
        ("20190728_3104_ap_RawAcc_E.asc", 90.0),
        ("20190728_3104_ap_Acc_N.asc", None),
        ("record.asc", 90.0),
    ],
)
def test_the_name_of_the_file_has_the_component_too(tmp_path, name, azimuth):
    (tmp_path / name).write_bytes(dyna(VALUES))
    (record,) = read(tmp_path / name)
    assert record.azimuth == pytest.approx(np.nan if azimuth is None else azimuth, nan_ok=True)
    word = "HNN" if "HNN" in name else "N"
    note = f"the header says HNE, but the file name says {word}: the direction is unknown"
    assert record.warnings == ((note,) if azimuth is None else ())


def test_a_place_in_the_line_of_the_location():
    record = got_one(dyna(VALUES, LOCATION="OLD_TOWN", STATION_NAME="", STREAM=""))
    assert (record.location, record.station_name, record.event, record.channel) == ("", "OLD_TOWN", "GREECE", "1")
    assert got_one(dyna(VALUES, LOCATION="OLD_TOWN")).station_name == "Town Hall,Argos,Argolis,Peloponnese"
    portal = got_one(TADAS.encode() + dyna(VALUES, LOCATION="OLD_TOWN", STATION_NAME=""))
    assert (portal.station_name, portal.event) == ("", "OLD TOWN")
    assert got_one(dyna(VALUES, LOCATION="--")).location == ""
