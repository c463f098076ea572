"""CSMNC (China): both layouts of the lines, components, the time of the earthquake, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.csmnc import csmnc

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.source import NotAcceleration

VALUES = np.round(pulse(403, -950.0), 3)
NAME = "test.dat"


@pytest.mark.parametrize("mark", ["", "$", " $"])
@pytest.mark.parametrize("field", ["{:12.6E} ", "{:14.6E}"])
def test_a_channel(write, mark, field):
    (record,) = read(write(csmnc(VALUES, mark=mark, field=field)))
    assert record.acceleration == pytest.approx(0.01 * VALUES, rel=1e-6, abs=1e-9)
    assert (record.npts, record.dt, record.processed, record.source_unit) == (403, 0.005, False, "cm/s2")
    assert (record.orientation, record.azimuth, record.component) == ("horizontal", 90.0, "EW")
    assert (record.station, record.id, record.warnings) == ("051XXX", "test.EW", ())
    assert record.header_peak == pytest.approx(9.5, rel=1e-5)
    assert read(write(csmnc(VALUES, kind="CORRECTED ACCELERATION")))[0].processed is True
    points = ("GROUND", "FREE FIELD", "ROOF", "")
    found = [read(write(csmnc(VALUES[:9], point=point)))[0].orientation for point in points]
    assert found == ["horizontal", "horizontal", "structural", "horizontal"]


def test_the_time_of_the_earthquake_is_in_beijing_and_no_start_time(write):
    (record,) = read(write(csmnc(VALUES)))
    assert record.start_time is None
    assert record.event == "TEST EARTHQUAKE 2013-04-20 00:02:46 UTC M 7.1(Mw)"
    (record,) = read(write(csmnc(VALUES, origin="0130420000246 2013-04-20 0:2:46 UTC")))
    assert record.event == "TEST EARTHQUAKE 2013-04-20 00:02:46 UTC M 7.1(Mw)"
    (record,) = read(write(csmnc(VALUES, origin="0130420000246 2013-04-31 0:2:46 BJT")))
    assert record.event == "TEST EARTHQUAKE M 7.1(Mw)"


@pytest.mark.parametrize(
    ("component", "name", "orientation", "azimuth", "noted"),
    [
        ("NS", "a.dat", "horizontal", 0.0, False),
        ("UD", "a.dat", "vertical", np.nan, False),
        ("N45E", "a.dat", "horizontal", 45.0, False),
        ("", "051WCW080512142801.UD.dat", "vertical", np.nan, True),
        ("", "20080512142804_051WCW_ORIG_NS.dat", "horizontal", 0.0, True),
        ("", "051NSW080512142801.dat", "unknown", np.nan, False),
        ("EW", "051WCW080512142801.UD.dat", "unknown", np.nan, True),
        ("EW", "051WCW080512142801NS.dat", "unknown", np.nan, True),
    ],
)
def test_the_component_is_that_of_the_header_else_of_the_name(write, component, name, orientation, azimuth, noted):
    (record,) = read(write(csmnc(VALUES, component=component), name))
    assert record.orientation == orientation
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert bool(record.warnings) is noted
    assert record.channel == (record.component or "1")


def test_rows_behind_a_last_row_that_is_short(write):
    lines = csmnc(VALUES[:161]).split(b"\r\n")
    (record,) = read(write(b"\n".join([*lines[:37], *lines[16:20]])))
    assert record.npts == 161
    assert record.warnings == ("line 38: 4 rows beyond the declared count were left out",)


@pytest.mark.parametrize(("count", "told"), [(398, False), (396, True)])
def test_a_duration_in_whole_seconds_may_be_cut_off(write, count, told):
    content = csmnc(VALUES[:count]).replace(b"DURATION:   2 SEC", b"DURATION:   3 SEC")
    assert bool(read(write(content))[0].warnings) is told


@pytest.mark.parametrize(("more", "known"), [(5, True), (6, False)])
def test_the_numbers_begin_within_ten_lines(write, more, known):
    lines = csmnc(VALUES).split(b"\r\n")
    content = b"\n".join([*lines[:13], *[b"words"] * more, *lines[13:]])
    if known:
        assert read(write(content))[0].npts == 403
    else:
        with pytest.raises(RecordFormatError, match=r"expected 403 samples \(header\), found 0"):
            read(write(content))


def test_the_facts_of_the_header(write):
    lines = csmnc(VALUES).replace(b": UNKNOWN", b": ROCK").split(b"\r\n")
    for more in (0, 4, 5):
        (record,) = read(write(b"\n".join([lines[0], *[b"words"] * more, *lines[1:]])))
        origin = datetime(2013, 4, 20, 0, 2, 46, tzinfo=UTC) if more < 5 else None
        assert record.origin_time == origin
        assert record.event.startswith("TEST EARTHQUAKE 2013-04-20") is (more < 5)
        assert (record.magnitude, record.magnitude_type, record.hypocentre_depth) == (7.1, "Mw", 8_000.0)
        assert (record.hypocentre_latitude, record.hypocentre_longitude) == (35.77, -117.599)
        assert (record.station_latitude, record.station_longitude, record.site_class) == (35.816, -117.598, "ROCK")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (csmnc(VALUES, kind="CORRECTED VELOCITY", unit="CM/SEC"), "test.dat:11: expected acceleration, found velocity"),
        (csmnc(VALUES, count=4000), r"test.dat:67: expected 4000 samples \(header\), found 408"),
        (csmnc(VALUES, count=0), "expected a positive number of samples"),
        (csmnc(VALUES, count=405), r"test.dat:67: expected a row of 5"),
        (csmnc(VALUES, dt="0"), "expected a positive sampling interval"),
        (csmnc(VALUES).replace(b"UNCORRECTED", b"UNCORECTED"), "expected a line such as 'UNCORRECTED ACCELERATION"),
        (csmnc(VALUES).replace(b"NO. OF POINTS:", b"POINTS"), "expected a line such as 'NO. OF POINTS:  12000'"),
        (csmnc(VALUES).replace(b"E2 \r\n", b"F2 \r\n", 1), r"test.dat:\d+: expected a finite number, found '.*F2'"),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises((RecordFormatError, NotAcceleration), match=message):
        read(write(content))
