"""Times that a header writes out, with and without the zone of their clock."""

from datetime import UTC, datetime, timedelta

import pytest

from rockpulse.readers.kit.facts import clock_fault, instant, later, near_event, written

TICK = timedelta(microseconds=1)


@pytest.mark.parametrize(
    ("behind", "hour"),
    [
        *(
            ("", 12),
            (" UTC", 12),
            (" UT", 12),
            ("Z", 12),
            (" gmt", 12),
            (" PST", 20),
            (" PDT", 19),
            (" pst", 20),
            (" GMT", 12),
        ),
        *((" ML 5.8", 12), (", Mw 6.3", 12), (" at depth", 12), (" km", 12)),
        *(("+01:00", 11), ("-0230", 14.5), ("+05:15", 6.75), ("+10:30", 1.5), (".5+09:00", 3)),
    ],
)
@pytest.mark.parametrize("date", ["2009-04-06 ", "2009-04-06T", "04/06/2009, "])
def test_a_time_is_read_with_its_zone_and_whatever_else_stands_behind_it(date, behind, hour):
    found = written(f"Origin: {date}12:32:39{behind}")
    minute, second = 32 + round(60 * (hour % 1)), 39
    expected = datetime(2009, 4, 6, int(hour) + minute // 60, minute % 60, second, tzinfo=UTC)
    assert found.replace(microsecond=0) == expected


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
    assert "before the first accelerograms" in clock_fault(first - TICK)


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
