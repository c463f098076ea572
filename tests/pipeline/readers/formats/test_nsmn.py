"""NSMN (Turkey, before AFAD): the columns, Turkish letters, times, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.nsmn import nsmn

from rockpulse.errors import RockpulseError
from rockpulse.readers import read

TABLE = np.round(np.column_stack([pulse(400, 13.0), pulse(400, -12.0), pulse(400, 9.0)]), 6)
NAME = "test.txt"


@pytest.mark.parametrize("name", [b"N-S", b"n-s"])
def test_the_three_columns(write, name):
    records = read(write(nsmn(TABLE).replace(b"N-S", name)))
    for record, column in zip(records, TABLE.T, strict=True):
        assert record.acceleration == pytest.approx(0.01 * column, abs=1e-12)
        assert (record.dt, record.processed, record.source_unit) == (0.01, False, "gal")
        assert record.start_time == datetime(2017, 7, 20, 22, 30, 58, 250000, tzinfo=UTC)
        assert record.header_peak == pytest.approx(record.pga, abs=1e-8)
        assert record.warnings == ()
    assert [record.component for record in records] == ["N-S", "E-W", "U-D"]
    assert [record.orientation for record in records] == ["horizontal", "horizontal", "vertical"]
    assert (records[0].azimuth, records[1].azimuth) == (0.0, 90.0)
    assert records[1].id == ".0921..EW@20170720T223058"
    assert records[0].event == "2017/07/20 22:31:09 (GMT) M 7.1 Mw"


def test_turkish_letters(write):
    content = nsmn(TABLE, place="DÜZCE İŞĞı")
    assert b"D\xdcZCE \xdd\xde\xd0\xfd" in content
    assert read(write(content))[0].station_name == "DÜZCE İŞĞı"
    assert read(write(content.decode("iso8859-9").encode("utf-8")))[0].station_name == "DÜZCE İŞĞı"


@pytest.mark.parametrize(
    ("start", "note"),
    [
        ("20/07/2017 22:30:58 (LOCAL)", "is in the unknown zone 'LOCAL'"),
        ("20/07/2017", "cannot be read"),
        ("20/07/2017 25:30:58 (GMT)", "cannot be read"),
        ("31/02/2017 22:30:58 (GMT)", "cannot be read"),
        ("20/07/2016 22:30:58 (GMT)", "h from the earthquake"),
        ("", ""),
    ],
)
def test_a_start_time_that_is_none(write, start, note):
    record = read(write(nsmn(TABLE, start=start)))[0]
    assert record.start_time is None
    assert note in "".join(record.warnings)


def without(line: int) -> bytes:
    lines = nsmn(TABLE).split(b"\r\n")
    return b"\n".join([*lines[: line - 1], *lines[line:]])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (without(13), "test.txt:17: expected 'NUMBER OF DATA : '"),
        (without(14), "test.txt:17: expected 'SAMPLING INTERVAL : ' .*, found none;"),
        (without(15), "test.txt:17: unknown unit of acceleration ''"),
        (nsmn(TABLE, count=4000), r"test.txt:418: expected 4000 rows \(header\), found 400"),
        (nsmn(TABLE, count="9" * 30), r"test.txt:13: expected 'NUMBER OF DATA : ' and a number above 0"),
        (nsmn(TABLE, dt="0"), r"test.txt:14: expected 'SAMPLING INTERVAL"),
        (nsmn(TABLE)[:400], "expected a line 'N-S  E-W  U-D' above the values"),
        (nsmn(TABLE).replace(b"0.000000\r\n", b"0.000000 1.0\r\n", 1), r"test.txt:19: expected a row of 3"),
        (
            nsmn(TABLE).replace(b" 0.000000\r\n", b" 0.00O000\r\n", 1),
            "test.txt:19: expected a finite number, found '0.0",
        ),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises(RockpulseError, match=message):
        read(write(content))
