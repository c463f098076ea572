"""Times that a header writes out, with and without the zone of their clock."""

import math
from dataclasses import fields
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from rockpulse.readers import read
from rockpulse.readers.kit.facts import (
    clock_fault,
    coordinates,
    instant,
    later,
    magnitudes,
    near_event,
    preferred,
    stated,
    written,
)
from rockpulse.record.record import Record

TICK = timedelta(microseconds=1)


@pytest.mark.parametrize(
    ("hour", "behind"),
    [
        (12, ["", " UTC", " UT", "Z", " gmt", " GMT", " ML 5.8", ", Mw 6.3", " at depth", " km"]),
        (20, [" PST", " pst"]),
        (19, [" PDT"]),
        (14.5, ["-0230"]),
        (11, ["+01:00"]),
        (6.75, ["+05:15"]),
        (3, [".5+09:00"]),
    ],
)
def test_a_time_is_read_with_its_zone_and_whatever_else_stands_behind_it(hour, behind):
    expected = datetime(2009, 4, 6, 0, 32, 39, tzinfo=UTC) + timedelta(hours=hour)
    for date in ("2009-04-06 ", "2009-04-06T", "04/06/2009, "):
        found = {written(f"Origin: {date}12:32:39{words}").replace(microsecond=0) for words in behind}
        assert found == {expected}, date


@pytest.mark.parametrize("zone", ["JST", "EST", "NZST", "LT", "PM"])
def test_a_time_of_a_clock_that_is_not_known_is_left_out(zone):
    assert written(f"2009-04-06 01:32:39 {zone}") is None


@pytest.mark.parametrize("time", [(24, 0, 0), (-1, 0, 0), (23, 60, 0), (23, -1, 0), (23, 50, 61), (23, 50, -0.1)])
def test_a_time_that_no_day_has_is_none(time):
    assert instant((2018, 2, 6), time) is None


def test_a_leap_second_is_a_time():
    assert instant((2016, 12, 31), (23, 59, 60)) == datetime(2017, 1, 1, tzinfo=UTC)


@pytest.mark.parametrize("time", [(0, 0, 0), (0, 0, 0.25), (23, 59, 60.75)])
def test_the_first_and_the_last_time_of_a_day(time):
    hour, minute, second = time
    midnight = datetime(2018, 2, 6, tzinfo=UTC)
    assert instant((2018, 2, 6), time) == midnight + timedelta(seconds=3600 * hour + 60 * minute + second)


@pytest.mark.parametrize("day", [(2018, 13, 1), (2018, 2, 30), (0, 1, 1), (float("inf"), 1, 1), (9999, 12, 31)])
def test_a_day_that_the_calendar_does_not_have_is_none(day):
    assert instant(day, (23, 0, 0), zone_hours=-8.0) is None


@pytest.mark.parametrize(
    ("date", "year"),
    [("6/2/30", 1930), ("6/2/29", 2029), ("6/2/00", 2000), ("6/2/99", 1999), ("0099/6/2", 1999), ("0100/6/2", 100)],
)
def test_years_of_two_digits_begin_in_1930(date, year):
    assert written(f"{date} 1:2:3.5") == datetime(year, 6, 2, 1, 2, 3, 500000, tzinfo=UTC)


@pytest.mark.parametrize("origin", [(1970, 1, 1), (1980, 1, 1), (1980, 1, 6)])
def test_a_clock_that_was_never_set_is_known_within_its_first_hour(origin):
    start = datetime(*origin, tzinfo=UTC)
    hour = timedelta(hours=1)
    assert [bool(clock_fault(start + shift)) for shift in (-TICK, 0 * TICK, hour - TICK, hour)] == [0, 1, 1, 0]
    assert "is that of a clock that was never set" in clock_fault(start)


def test_accelerograms_begin_in_1933():
    first = datetime(1933, 1, 1, tzinfo=UTC)
    assert clock_fault(first) == ""
    assert "earlier than any accelerogram" in clock_fault(first - TICK)


def test_a_start_is_at_most_an_hour_from_its_earthquake():
    origin = datetime(2011, 3, 11, 5, 46, tzinfo=UTC)
    for side in (-1, 1):
        start = origin + side * timedelta(hours=1)
        assert near_event(start, origin) == (start, [])
        kept, (words,) = near_event(start + side * TICK, origin)
        assert kept is None
        assert "lies 1.0 h from the earthquake of 2011-03-11 05:46:00; it was left out" in words
    assert near_event(None, origin) == (None, [])
    assert near_event(origin, None) == (origin, [])


def test_a_later_time_ends_with_the_calendar():
    start = datetime(2011, 3, 11, tzinfo=UTC)
    assert later(start, 1.5) == start + timedelta(seconds=1.5)
    assert later(None, 1.5) is None
    assert later(start, 1e15) is None


NAN = math.nan


def when(*moment):
    return datetime(*moment, tzinfo=UTC)


def known(found):
    """The facts that a record, or a dictionary, knows, by their names."""
    values = found if isinstance(found, dict) else {name: getattr(found, name) for name in stated()}
    return {name: value for name, value in values.items() if value not in ("", None) and value == value}


def test_facts_are_fields_of_a_record_with_the_same_defaults():
    of_record = {field.name: field.default for field in fields(Record)}
    assert {name: str(of_record[name]) for name in stated()} == {name: str(value) for name, value in stated().items()}


@pytest.mark.parametrize(
    ("fact", "values"),
    [
        ("magnitude", [("0.00", "ML"), (-999.0, "Mw"), ("10.1", ""), (-1.1, "ML"), ("unknown", "Mw")]),
        ("hypocentre", [(37.0, 360.5), (37.0, -360.5), (90.5, 20.0), (-90.5, 20.0), (-999.0, -999.0), ("0.0", "0.0")]),
        ("station_place", [("37.76121", ""), ("", "37.76121"), (0.0, 0.0)]),
        ("depth_km", ["-3", 800.5, -0.5, "0.0"]),
        ("distance_km", [-0.5, 20_040.5, "0.", -999.0]),
        ("vs30", ["0", 29.5, 5000.5, "1e999"]),
        ("site_class", ["N/A", "---", ""]),
        ("event_id", ["---"]),
        ("origin_time", [when(1980, 1, 1), None]),
    ],
)
def test_what_cannot_be_true_is_left_out(fact, values):
    assert [known(stated(**{fact: value})) for value in values] == [{}] * len(values)


@pytest.mark.parametrize(
    ("told", "found"),
    [
        *((("7.7", "MW"), (7.7, "Mw")), ((4.6, "Ml"), (4.6, "ML")), (("5.9", "M"), (5.9, ""))),
        *((("5.1", "mbLg"), (5.1, "mbLg")), ((10.0, ""), (10.0, "")), ((-1.0, " mb "), (-1.0, "mb"))),
    ],
)
def test_a_magnitude_and_its_scale(told, found):
    facts = stated(magnitude=told)
    assert (facts["magnitude"], facts["magnitude_type"]) == found


@pytest.mark.parametrize(
    ("longitude", "found"),
    [(200.0, -160.0), (-359.5, 0.5), (360.0, 0.0), (180.0, 180.0), (180.5, -179.5), (-180.0, -180.0), (-360.0, 0.0)],
)
def test_longitudes_are_brought_within_half_a_turn(longitude, found):
    assert known(stated(hypocentre=(37.0, longitude))) == {"hypocentre_latitude": 37.0, "hypocentre_longitude": found}


@pytest.mark.parametrize(
    ("fact", "value", "found"),
    [
        ("hypocentre", ("-90.0", "20.0"), [-90.0, 20.0]),
        ("station_place", (0.0, 9.5), [0.0, 9.5]),
        ("depth_km", 800.0, [800_000.0]),
        *(("distance_km", stated, [found]) for stated, found in ((0.5, 500.0), ("20040", 20_040_000.0))),
        *(("vs30", stated, [found]) for stated, found in ((30.0, 30.0), ("5000", 5000.0))),
        ("site_class", " B ", ["B"]),
        ("origin_time", when(2009, 4, 6, 1, 32, 39), [when(2009, 4, 6, 1, 32, 39)]),
    ],
)
def test_what_can_be_true_is_known_in_the_units_of_a_record(fact, value, found):
    assert list(known(stated(**{fact: value})).values()) == found


def test_a_depth_of_zero_is_one_where_the_place_is_known():
    assert known(stated(hypocentre=(37.0, 37.0), depth_km="0.0"))["hypocentre_depth"] == 0.0
    assert known(stated(hypocentre=("91", "37"), depth_km="5")) == {"hypocentre_depth": 5000.0}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("STATION NO. 14403   33.929N, 118.260W     SMA-1  S/N 3492", (33.929, -118.26)),
        ("HYPOCENTER(CIT/USGS): 34.201N,116.826W, H=7KM.     MS=6.6(NEIC), MW=6.4(CIT)", (34.201, -116.826)),
        ("36.91980N-27.44350E", (36.9198, 27.4435)),
        ("Ahar                      Station   38.474 N 47.059 E   Altitude 1360m", (38.474, 47.059)),
        ("19.33024 LAT. N 99.181076 LONG. W", (19.33024, -99.181076)),
        ("EPICENTER -   34 03 29N, 118 04 30W", (34.058056, -118.075)),
        ("Site HSES      42 31 24S  172 49 50E     Basalt file:  20161113", (-42.523333, 172.830556)),
        ("Hypocenter:  To be determined.               ML:  To be determined.", (NAN, NAN)),
        ("12.5 NEAR 13.5 WEST", (NAN, NAN)),
        ("33.5n 118.25w, 40.0S 100.0E", (33.5, -118.25)),
        ("34 03 36s, 118 04 30e, 12 00 00N", (-34.06, 118.075)),
        ("33.5N", (33.5, NAN)),
    ],
)
def test_places_in_headers(text, place):
    np.testing.assert_array_equal(coordinates(text), place)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Hypocenter: 34.0580  -117.0110  H= 12km(SCSN) ML=4.9, Mw=4.8(CIT), Ms=4.2(NEIC)", (4.8, "Mw")),
        ("Hypocenter: To be determined    H=   km       ML=     Mw=", (NAN, "")),
        ("Epicenter 38.520 N 46.860 E   FD 12 Km mb      Ms      Mw6.1   M        ML   (BHRC   )", (6.1, "Mw")),
        ("/Mb=5.2/Ms=5.8/Mc=5.0/Ma=5.6/Me=5.7", (5.8, "Ms")),
        ("Depth    8km M  5.70", (5.7, "")),
        ("HYPOCENTER:   0.000N    0.000E  H=   0.0KM   ML= 0.00", (NAN, "")),
        ("H=12 KM. M=123.4", (NAN, "")),
    ],
)
def test_magnitudes_in_headers(text, found):
    np.testing.assert_equal(magnitudes(text), found)


def test_one_magnitude_of_several():
    assert preferred([("6.5", "ML"), ("-999", "Mw"), ("6.6", "Ms")]) == (6.6, "Ms")
    assert preferred([("5.0", "Md"), ("5.1", "Mc")]) == (5.0, "Md")
    order = [("5.3", "Md"), ("5.4", "mb"), ("5.5", "ML"), ("5.6", "Ms"), ("5.7", "Mw")]
    for count in range(1, 6):
        assert preferred(order[:count]) == (float(order[count - 1][0]), order[count - 1][1])
    assert preferred([("5.0", "m"), ("0.0", "Mw")]) == (5.0, "")
    np.testing.assert_equal(preferred([]), (NAN, ""))


#: Origin time, magnitude and depth [km] of real records, as their headers state them. Public catalogues agree to their
#: digits: M 7.8 Kaikoura 2016-11-13 11:02:56, M 6.7 Northridge 1994-01-17 12:30:55, M 7.1 Anchorage 2018-11-30
#: 17:29:29, M 6.6 Kos 2017-07-20 22:31:09, M 6.4 Hualien 2018-02-06 15:50:42, M 6.5 Ahar 2012-08-11 12:23, M 7.8
#: Kahramanmaras 2023-02-06 01:17:34, M 6.3 L'Aquila 2009-04-06 01:32:39.
REAL = {
    "dyna_asc/20101114230825_3104_ap_RawAcc_E.asc": (when(2010, 11, 14, 23, 8, 25, 750000), 5.1, "ML", 24.17),
    "dyna_asc_afad/20230206011732_0201_ap_AAD_Acc_E.asc": (when(2023, 2, 6, 1, 17, 32), 7.7, "Mw", 8.6),
    "sigma_itaca/16837_H2.cor.acc": (when(2009, 4, 6, 1, 32, 39), NAN, "", NAN),
    "afad_nsmn/20170720223109_0921.txt": (when(2017, 7, 20, 22, 31, 9), 6.5, "Mw", 19.44),
    "geonet/20161113_110300_HSES_20.V1A": (when(2016, 11, 13, 11, 2, 56), 7.82, "Mw", 15.0),
    "cosmos/NP8040-n.1000hyfh.HNE.01.V0c": (when(2018, 11, 30, 17, 29, 29), 7.0, "Mw", 46.7),
    "csmip_v1/LA116TH.RAW": (when(1994, 1, 17, 12, 30, 55, 400000), 6.7, "Mw", 18.0),
    "csmip_v2/ce36456p_CE36456.V2": (when(1983, 5, 2, 23, 42, 38, 500000), 6.5, "ML", 9.0),
    "smc/2516b_a.smc": (when(2011, 8, 23, 17, 51), 5.8, "Mw", 6.0),
    "usc_v1/017m30lw.e0a": (when(1994, 1, 17, 12, 30), 6.7, "", 18.4),
    "bhrc/5520-1.V1": (when(2012, 8, 11, 12, 23, 16), 6.1, "Mw", 12.0),
    "cwb/2-EGF.dat": (when(2018, 2, 6, 15, 50, 42), 6.0, "ML", 10.0),
    "unam_asa/CUP50401.012": (when(2004, 1, 1, 23, 58, 2, 700000), 5.8, "Ms", 14.0),
}


@pytest.mark.parametrize("name", REAL)
def test_facts_of_real_records(records_folder, name):
    one = read(records_folder / name)[0]
    origin, *numbers = REAL[name]
    assert one.origin_time == origin
    np.testing.assert_equal([one.magnitude, one.magnitude_type, one.hypocentre_depth / 1e3], numbers)
