"""CWB and CWA free field (Taiwan): the columns, the clock, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers._shared import pulse
from record_writers.cwb import cwb
from source_files import got

from rockpulse.errors import RockpulseError

THREE = tuple(np.round(pulse(400, peak, dt=0.02), 3) for peak in (7.1, 45.5, 50.2))


@pytest.mark.parametrize(
    ("sequence", "expected"),
    [
        ("Time U(+); N(+); E(+)", [("vertical", np.nan), ("horizontal", 0.0), ("horizontal", 90.0)]),
        ("Time E(+); N(-); U(+)", [("horizontal", 90.0), ("horizontal", 180.0), ("vertical", np.nan)]),
        ("time e(-); n(+); z(-)", [("horizontal", 270.0), ("horizontal", 0.0), ("vertical", np.nan)]),
    ],
)
def test_the_header_tells_the_order_and_the_sign_of_the_columns(sequence, expected):
    records = got(cwb(THREE, sequence=sequence))
    assert [record.orientation for record in records] == [orientation for orientation, _ in expected]
    assert [record.azimuth for record in records] == pytest.approx([azimuth for _, azimuth in expected], nan_ok=True)
    for record, values in zip(records, THREE, strict=True):
        turned = any("sign is changed" in note for note in record.warnings)
        assert turned is (record.component == "z(-)")
        assert record.acceleration == pytest.approx((-0.01 if turned else 0.01) * values, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        ("", ""),
        ("StartTime: 1999/ 9/20-17:47: 2.000", "names no time zone"),
        ("StartTime(GMT+08): 2018/02/30-23:50:29.000", "cannot be read"),
        ("StartTime(GMT+08): yesterday", "cannot be read"),
        ("StartTime(GMT+08): 2018/02/06-15:50:29.000", "lies 8.0 h from the earthquake of 2018-02-06 15:50:42"),
    ],
)
def test_a_doubtful_start_is_left_out_with_the_reason(start, reason):
    records = got(cwb(THREE, start=start))
    assert {record.start_time for record in records} == {None}
    assert all(reason in "".join(record.warnings) and bool(reason) is bool(record.warnings) for record in records)


def test_blanks_in_dates_and_a_first_row_later_than_the_start():
    start, origin = "StartTime(GMT+08): 1999/ 9/21- 1:47: 2.500", "Origin Time(GMT+08): 1999/ 9/21- 1:47:16"
    record = got(cwb(THREE, start=start, origin=origin, first=10.0))[0]
    assert record.start_time == datetime(1999, 9, 20, 17, 47, 12, 500000, tzinfo=UTC)


@pytest.mark.parametrize(("length", "told"), [("7.98", 0), ("7.96", 1), ("0.01", 1)])
def test_the_length_may_be_off_by_its_rounding_and_a_step(length, told):
    note = f"the header states {float(length):g} s at 50 samples per s, but the file has 400 rows"
    assert [record.warnings for record in got(cwb(THREE, length=length))] == [(note,) * told] * 3


def without_row(content: bytes, row: int) -> bytes:
    lines = content.split(b"\r\n")
    return b"\r\n".join(lines[: 22 + row] + lines[23 + row :])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (cwb(THREE)[:9000], r"stream:\d+: expected 375 rows .* found \d+"),
        (cwb(THREE)[:-7], r"stream:422: expected 4 fields of 10 characters"),
        (without_row(cwb(THREE), 100), r"stream:123: expected the time 2 s .* found 2.02 s"),
        (cwb(THREE).replace(b"Rate(Hz): 50", b"Rate(Hz): 40"), "stream:24: expected the time 0.025 s .* found 0.02 s"),
        (cwb(THREE).replace(b"Rate(Hz): 50", b"Rate(Hz): 0"), r"stream:16: expected .*above 0"),
        (
            cwb(THREE).replace(b"#SampleRate", b"#Sample"),
            r"stream:1: expected a line '#SampleRate.* above 0, found none;",
        ),
        (cwb(THREE, sequence="Time"), "stream:21: expected '#DataSequence: Time U"),
        (cwb(THREE, sequence="U(+); N(+); E(+)"), "stream:21: expected '#DataSequence: Time U"),
        (cwb(THREE, unit="stone. DC"), "stream:17: unknown unit of acceleration 'stone'"),
        (cwb(THREE, layout="3F10.3"), "stream:22: expected '#Data: 4F10.3'"),
        (cwb(THREE, layout="4F0.3"), "expected fields of at least 1 character"),
        (cwb(THREE).replace(b"     7.100", b"     7.1x0"), "stream:29: expected a finite number"),
    ],
)
def test_damage_is_named(content, message):
    with pytest.raises(RockpulseError, match=message):
        got(content)
