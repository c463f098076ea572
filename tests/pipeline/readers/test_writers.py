"""AT2, CSV and miniSEED: exact to the written digits, and every name that fits."""

import io
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import obspy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from record_writers import pulse

from rockpulse.errors import RecordRefused
from rockpulse.readers import read
from rockpulse.readers.conversion import write
from rockpulse.readers.writers import at2_bytes, azimuth_of, csv_bytes, miniseed_bytes, seed_codes
from rockpulse.record.record import STANDARD_GRAVITY, Record

START = datetime(2019, 7, 6, 3, 16, 8, 500001, tzinfo=UTC)
TEXT = st.text(max_size=20)
STEPS = st.sampled_from([0.001, 0.0025, 0.004, 0.005, 0.01, 0.0125, 0.02, 1.0 / 128.0, 1.0 / 60.0, 1.0 / 256.0])
RECORDS = st.builds(
    Record,
    acceleration=st.lists(st.floats(-1e9, 1e9), min_size=120, max_size=140),
    dt=STEPS,
    id=st.just("plain.1"),
    azimuth=st.integers(-720, 720).map(float),
    orientation=st.just("horizontal"),
    start_time=st.none() | st.datetimes(datetime(1934, 1, 1), datetime(2100, 1, 1), timezones=st.just(UTC)),
    processed=st.sampled_from([True, False, None]),
    **dict.fromkeys(("network", "station", "channel", "component", "station_name", "event"), TEXT),
)


@pytest.fixture
def record():
    return Record(
        pulse(500, 3.0),
        0.01,
        "CI.CLC..90@20190706T031608",
        "CI",
        "CLC",
        channel="90",
        component="90 Deg",
        orientation="horizontal",
        azimuth=90.0,
        start_time=START,
        station_name="China Lake, G2 Tower Rd.",
        event="Ridgecrest",
        processed=False,
        warnings=("a",),
    )


def test_the_lines_of_an_at2_file(record):
    lines = at2_bytes(record).decode().splitlines()
    assert lines[0].startswith("UNCORRECTED RECORD, WRITTEN BY ROCKPULSE")
    assert lines[1:4] == [
        "Ridgecrest, 7/6/2019, China Lake, G2 Tower Rd., 090",
        "ACCELERATION TIME SERIES IN UNITS OF G",
        "NPTS=    500, DT= 0.01 SEC,",
    ]
    assert {len(line) for line in lines[4:]} == {75}
    assert lines[4][:30] == f"{0.0:15.7E}{record.acceleration[1] / STANDARD_GRAVITY:15.7E}"


def come_back(folder, record, name, **options):
    write([record], folder / name, overwrite=True)
    (back,) = read(folder / name, **options)
    return back


@pytest.mark.sweep
@settings(derandomize=True, max_examples=6, deadline=None)
@given(record=RECORDS)
def test_at2_is_exact_to_its_digits(tmp_path_factory, record):
    back = come_back(tmp_path_factory.getbasetemp(), record, "a.AT2")
    written = [float(f"{value:.7E}") for value in record.acceleration / STANDARD_GRAVITY]
    assert np.array_equal(back.acceleration, np.where(np.abs(written) < 1e-99, 0.0, written) * STANDARD_GRAVITY)
    assert (back.dt, back.azimuth, back.processed) == (record.dt, record.azimuth % 360.0, record.processed)


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "step"), [("a.csv", 1e-12), ("a.mseed", 1e-7)])
@settings(derandomize=True, max_examples=6, deadline=None)
@given(record=RECORDS)
def test_csv_and_miniseed_are_exact_in_every_bit(tmp_path_factory, name, step, record):
    back = come_back(tmp_path_factory.getbasetemp(), record, name, units="m/s2")
    assert np.array_equal(back.acceleration, record.acceleration)
    assert back.dt == pytest.approx(record.dt, rel=step)
    assert (back.azimuth, back.orientation) == (record.azimuth % 360.0, "horizontal")
    if name == "a.mseed":
        assert (back.processed, back.start_time) == (record.processed, record.start_time)


def test_at2_gives_back_event_date_station_and_direction(tmp_path, record):
    back = come_back(tmp_path, record, "a.AT2")
    assert (back.event, back.station_name) == ("Ridgecrest, 7/6/2019", "China Lake, G2 Tower Rd.")
    assert (back.component, back.azimuth, back.processed) == ("090", 90.0, False)
    again = come_back(tmp_path, back, "b.AT2")  # from AT2 to AT2 nothing is lost any more
    assert (again.event, again.station_name, again.component) == (back.event, back.station_name, back.component)
    assert np.array_equal(again.acceleration, back.acceleration)
    assert come_back(tmp_path, replace(record, event="Rcrd of Fri, Jul 5"), "c.AT2").event == (
        "Rcrd of Fri; Jul 5, 7/6/2019"
    )
    unnamed = come_back(tmp_path, replace(record, event="", station_name=""), "d.AT2")
    assert (unnamed.event, unnamed.station_name) == ("", "CI.CLC")


@pytest.mark.parametrize("name", ["a.AT2", "a.csv", "a.mseed"])
def test_directions_come_back(tmp_path, record, name):
    vertical = replace(record, orientation="vertical", azimuth=float("nan"), component="Up", channel="Up")
    assert come_back(tmp_path, vertical, name, units="m/s2").orientation == "vertical"
    unknown = replace(record, orientation="unknown", azimuth=float("nan"), component="3", channel="3")
    assert come_back(tmp_path, unknown, name, units="m/s2").orientation == "unknown"
    numbered = replace(unknown, component="12")  # the number of a channel, no azimuth
    assert come_back(tmp_path, numbered, name, units="m/s2").orientation == "unknown"
    oblique = replace(record, azimuth=92.5)
    back = come_back(tmp_path, oblique, name, units="m/s2")
    assert back.azimuth == 92.5 or (name == "a.csv" and np.isnan(back.azimuth))


NAN = float("nan")


@pytest.mark.parametrize("name", ["a.AT2", "a.csv", "a.mseed"])
@pytest.mark.parametrize("azimuth", [-45.0, 315.0, 675.0, 360.0, -1e-20])
def test_azimuths_are_turned_into_one_round(tmp_path, record, name, azimuth):
    turned = replace(record, azimuth=azimuth, orientation="unknown")
    back = come_back(tmp_path, turned, name, units="m/s2")
    assert (back.azimuth, back.orientation) == (azimuth % 360.0 % 360.0, "horizontal")
    assert 0.0 <= azimuth_of(turned) < 360.0


@pytest.mark.parametrize("name", ["a.AT2", "a.csv", "a.mseed"])
@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        # A code of SEED that says what the record does not.
        ({"channel": "HNE", "component": "HNE", "orientation": "unknown", "azimuth": NAN}, ("unknown", NAN)),
        ({"channel": "HNZ", "component": "HNZ", "orientation": "unknown", "azimuth": NAN}, ("unknown", NAN)),
        ({"channel": "HNE", "component": "", "orientation": "horizontal", "azimuth": NAN}, ("horizontal", NAN)),
        ({"channel": "HNR", "component": "", "orientation": "horizontal", "azimuth": NAN}, ("horizontal", NAN)),
        ({"channel": "HNZ", "component": "", "orientation": "horizontal", "azimuth": 30.0}, ("horizontal", 30.0)),
        # Channels on a structure, of which some are vertical.
        ({"channel": "1", "component": "Up", "orientation": "structural", "azimuth": NAN}, ("vertical", NAN)),
        ({"channel": "1", "component": "Down", "orientation": "structural", "azimuth": NAN}, ("vertical", NAN)),
        ({"channel": "1", "component": "", "orientation": "structural", "azimuth": NAN}, ("unknown", NAN)),
        ({"channel": "1", "component": "", "orientation": "structural", "azimuth": 30.0}, ("horizontal", 30.0)),
    ],
)
def test_no_direction_comes_back_that_the_record_does_not_have(tmp_path, record, name, changes, expected):
    back = come_back(tmp_path, replace(record, **changes), name, units="m/s2")
    orientation, azimuth = expected
    if changes["orientation"] == "structural" and name == "a.AT2":  # the one format with a word for it
        orientation = "structural"
    assert back.orientation == orientation or (back.orientation, name != "a.mseed") == ("unknown", True)
    assert back.azimuth == azimuth or (np.isnan(back.azimuth) and np.isnan(azimuth))


DECEIVING = ["NPTS= 3, DT= 1", "Velocity Creek", "UNITS OF M", "a, b\nc", "Ωmega ü", "VEL TIME HISTORY", "ACC (M/S2)"]


@pytest.mark.parametrize("words", DECEIVING)
def test_no_name_deceives_a_reader(tmp_path, record, words):
    named = replace(
        record, event=words, station_name=words, component=words, azimuth=float("nan"), orientation="unknown"
    )
    for name in ("a.AT2", "a.csv", "a.mseed"):
        assert come_back(tmp_path, named, name, units="m/s2").npts == record.npts


@pytest.mark.parametrize("words", ["Community Hospital", "Unit 2, Diablo Canyon", "United Nations", "Velarde"])
def test_a_name_that_only_looks_like_a_header_is_kept(tmp_path, record, words):
    assert come_back(tmp_path, replace(record, station_name=words), "a.AT2").station_name == words


def test_a_csv_file_has_one_line_of_headings_and_no_noise_in_its_times(record):
    lines = csv_bytes(replace(record, dt=0.005)).decode().splitlines()
    assert lines[0] == "time [s],acceleration 090 deg [m/s2]"
    assert [line.partition(",")[0] for line in lines[1:5]] == ["0.000", "0.005", "0.010", "0.015"]
    assert lines[2].partition(",")[2] == repr(float(record.acceleration[1]))


def test_codes_that_seed_has_no_room_for(record):
    east, north = record, replace(record, azimuth=4.0, id="b")
    oblique = replace(record, azimuth=120.0, channel="120", id="c")
    assert seed_codes([east, north, oblique, replace(oblique, azimuth=210.0)]) == [
        ("CI", "CLC", "", "HNE"),
        ("CI", "CLC", "", "HNN"),
        ("CI", "CLC", "", "HN1"),
        ("CI", "CLC", "", "HN2"),
    ]
    assert seed_codes([east, east, east]) == [("CI", "CLC", location, "HNE") for location in ("", "00", "01")]
    plain = Record([0.0, 1.0], 0.02, "RSN763_LOMAP.1")
    assert seed_codes([plain]) == [("", "RSN76", "", "BN3")]
    vertical = replace(plain, channel="HGZ", network="TOOLONG", orientation="vertical")
    assert seed_codes([vertical]) == [("", "RSN76", "", "HGZ")]


def test_the_place_of_the_station_goes_into_the_station_metadata(tmp_path, record):
    placed = replace(record, station_latitude=35.81574, station_longitude=-117.59751)
    back = come_back(tmp_path, placed, "a.mseed")
    assert (back.station_latitude, back.station_longitude) == (35.81574, -117.59751)
    back = come_back(tmp_path, replace(record, station_latitude=float("nan")), "b.mseed")
    assert np.isnan([back.station_latitude, back.station_longitude]).all()


def test_the_date_in_an_at2_file_is_that_of_the_earthquake(record):
    """The record of a station far away may begin on the next day."""
    late = replace(record, event="Alaska", start_time=datetime(1964, 3, 28, 0, 1, tzinfo=UTC))
    assert at2_bytes(late).splitlines()[1].startswith(b"Alaska, 3/28/1964,")
    told = replace(late, origin_time=datetime(1964, 3, 27, 23, 59, tzinfo=UTC))
    assert at2_bytes(told).splitlines()[1].startswith(b"Alaska, 3/27/1964,")


@pytest.mark.parametrize(
    ("azimuth", "codes"),
    [
        *((azimuth, ["HNN"]) for azimuth in (0.0, 5.0, 355.0)),
        *((azimuth, ["HNE"]) for azimuth in (90.0, 85.0, 95.0)),
        *((azimuth, ["HN1", "HN2"]) for azimuth in (5.5, 354.5, 84.5, 95.5, 180.0)),
    ],
)
def test_a_channel_within_five_degrees_of_north_or_east_has_the_letter_of_it(azimuth, codes):
    record = Record(np.zeros(3), dt=0.01, id="x", azimuth=azimuth, orientation="horizontal")
    assert [code[3] for code in seed_codes([record] * len(codes))] == codes


@pytest.mark.parametrize(
    ("band", "rates"),
    [("C", (500.0, 250.0)), ("H", (249.5, 80.0)), ("B", (79.5, 10.0)), ("M", (9.5, 1.0)), ("L", (0.75, 0.5))],
)
def test_the_band_of_a_channel_is_that_of_its_rate(band, rates):
    for rate in rates:
        record = Record(np.zeros(3), dt=1.0 / rate, id="x", orientation="vertical")
        assert seed_codes([record])[0][3] == f"{band}NZ"


def test_the_location_counts_up_to_99_beside_the_one_of_the_record(record):
    oblique = replace(record, azimuth=120.0, channel="120", location="07")
    codes = seed_codes([oblique] * 101)
    assert [code[2:] for code in codes[:4]] == [("07", "HN1"), ("07", "HN2"), ("00", "HN1"), ("01", "HN1")]
    assert codes[-1] == ("CI", "CLC", "99", "HN1")
    assert len(set(codes)) == 101
    with pytest.raises(RecordRefused, match=r"more than 100 records share the codes CI.CLC..HN1"):
        seed_codes([oblique] * 102)


def test_the_channels_of_a_station_stand_in_one_of_it(record):
    north = replace(record, azimuth=0.0, channel="HNN")
    other = replace(record, station="WCS", station_name="", location="10")
    abroad = replace(record, network="TU", station_name="D\u00fc\x07zce")
    content, metadata, names = miniseed_bytes([record, north, other, abroad])
    inventory = obspy.read_inventory(io.BytesIO(metadata))
    assert inventory.get_contents()["channels"] == names
    sites = {f"{net.code}.{place.code}": place.site.name for net in inventory for place in net}
    assert sites == {"CI.CLC": record.station_name, "CI.WCS": "WCS", "TU.CLC": "D\u00fc zce"}
    assert [trace.id for trace in obspy.read(io.BytesIO(content))] == names
    undated = obspy.read(io.BytesIO(miniseed_bytes([replace(record, start_time=None)])[0]))
    assert undated[0].stats.starttime == obspy.UTCDateTime(0)


def test_values_that_no_field_of_at2_has_room_for_are_zero(record):
    small = STANDARD_GRAVITY * np.array([1e-99, 9.9e-100, -9.9e-100, -2e-99, 1e-98, 1.5])
    values = at2_bytes(replace(record, acceleration=small)).decode().split("SEC,\n")[1].split()
    assert [float(value) for value in values] == [1e-99, 0.0, 0.0, -2e-99, 1e-98, 1.5]


def test_the_title_of_an_at2_file_without_a_date_or_an_event(record):
    def title(**changes):
        return at2_bytes(replace(record, **changes)).decode().splitlines()[1]

    assert title(event="") == ", China Lake, G2 Tower Rd., 090"
    assert title(start_time=None) == "Ridgecrest, China Lake, G2 Tower Rd., 090"
    assert title(event="A, 1/2/1999", azimuth=NAN, component="N, S") == "A, 1/2/1999, China Lake, G2 Tower Rd., N; S"
    assert title(orientation="vertical", azimuth=NAN).endswith(", UP")
    assert title(azimuth=5.25).endswith(", 005.25")


def test_the_heading_of_a_csv_file_tells_whole_degrees(record):
    def heading(**changes):
        return csv_bytes(replace(record, **changes)).decode().splitlines()[0]

    assert heading(azimuth=5.0) == "time [s],acceleration 005 deg [m/s2]"
    assert heading(azimuth=5.5) == heading(azimuth=NAN) == "time [s],acceleration [m/s2]"
    assert heading(orientation="vertical", azimuth=NAN) == "time [s],acceleration up [m/s2]"
