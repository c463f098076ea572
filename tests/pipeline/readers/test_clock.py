"""Times that a header writes out, with and without the zone of their clock."""

from datetime import UTC, datetime

import pytest

from rockpulse.readers.clock import instant, written


@pytest.mark.parametrize(
    ("behind", "hour"),
    [
        *(("", 12), (" UTC", 12), (" UT", 12), ("Z", 12), (" gmt", 12), (" PST", 20), (" PDT", 19)),
        *((" ML 5.8", 12), (", Mw 6.3", 12), (" at depth", 12), (" km", 12)),
        *(("+01:00", 11), ("-0230", 14.5), (".5+09:00", 3)),
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
