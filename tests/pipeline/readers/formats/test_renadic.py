"""RENADIC volume 1 (Chile): pairs, dead channels, parts of one record."""

import hashlib
from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers._shared import pulse
from record_writers.renadic import renadic
from source_files import got

from rockpulse.errors import RecordRefused
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.parts import Part
from rockpulse.record.record import STANDARD_GRAVITY, Record

TENTH = STANDARD_GRAVITY / 10.0
THREE = tuple(np.round(pulse(400, peak), 3) for peak in (1.5, 0.8, 1.2))
NEVER_SET = "1/1/1980 0:00:00.000 GMT"


def part(begin: int, last: int, **changes) -> bytes:
    """Samples `begin` to `last` of the three channels and a dead one, on the recorder's column of times."""
    columns = [*(values[begin:last] for values in THREE), np.zeros(last - begin)]
    given = {"components": ("NS", "V", "EW", "INTC"), "first": 0.01 * begin} | changes
    return renadic(columns, **given)


def put(folder, **files: bytes):
    for name, content in files.items():
        (folder / f"{name}.v1").write_bytes(content)
    return folder


def test_channels_l_v_t():
    records = got(renadic(THREE))
    for record, values in zip(records, THREE, strict=True):
        assert record.acceleration == pytest.approx(values * TENTH, rel=1e-12)
        assert type(record) is Record
    assert [record.channel for record in records] == ["L", "V", "T"]
    assert [record.orientation for record in records] == ["horizontal", "vertical", "horizontal"]
    assert np.isnan(records[0].azimuth)
    assert (records[0].station_name, records[0].event) == ("CURICO", "MAULE 2010")


def test_a_file_without_any_sensor_is_refused():
    with pytest.raises(RecordRefused, match="stream: all samples of all channels are zero"):
        got(renadic([np.zeros(50)] * 3))


@pytest.mark.parametrize("trigger", ["2/27/2010 3:55:14.000 GMT", NEVER_SET])
def test_two_parts_are_joined(tmp_path, trigger):
    one, two = part(0, 250, trigger=trigger), part(250, 400, trigger=trigger)
    put(tmp_path, curicoparte1=one, curicoparte2=two)
    records, failures = read_all(tmp_path)
    assert failures == []
    assert [record.id for record in records] == ["curico.EW", "curico.NS", "curico.V"]
    for record, values in zip(records, (THREE[2], THREE[0], THREE[1]), strict=True):
        assert type(record) is Record
        assert record.acceleration == pytest.approx(values * TENTH, rel=1e-12)
        assert record.dt == 0.01
        assert record.processing == ("parts 1, 2 joined",)
        assert record.warnings[-1] == "channel 4 (INTC) is dead, all samples are zero; it was left out"
        assert not any("split into several files" in note for note in record.warnings)
        assert record.header_peak == pytest.approx(record.pga, abs=0.005)
        assert record.source == f"{tmp_path}/curicoparte1.v1; {tmp_path}/curicoparte2.v1"
        assert record.source_sha256 == "; ".join(hashlib.sha256(content).hexdigest() for content in (one, two))
    expected = None if trigger == NEVER_SET else datetime(2010, 2, 27, 3, 55, 14, tzinfo=UTC)
    assert {record.start_time for record in records} == {expected}


def test_parts_keep_what_is_known_of_the_station(tmp_path):
    """The time that the header calls that of the earthquake is of the clock of the recorder, and is left out."""
    placed = [part(*cut).replace(b"   0.000N    0.000E  QDR", b"  34.983N   71.239W  QDR") for cut in ((0, 9), (9, 99))]
    put(tmp_path, curicoparte1=placed[0], curicoparte2=placed[1])
    records, _ = read_all(tmp_path)
    assert {(record.npts, record.station_latitude, record.station_longitude) for record in records} == {
        (99, 34.983, -71.239)
    }
    assert {record.origin_time for record in records} == {None}


def test_parts_whose_times_begin_anew_are_joined_by_their_clocks(tmp_path):
    put(
        tmp_path,
        a_parte1=part(0, 200, trigger="2/27/2010 3:55:14.000 GMT"),
        a_parte2=part(200, 400, first=0.0, trigger="2/27/2010 3:55:16.000 GMT"),
    )
    records, _ = read_all(tmp_path)
    assert [(record.id, record.npts) for record in records] == [("a.EW", 400), ("a.NS", 400), ("a.V", 400)]


def test_parts_whose_times_run_on_are_joined_whatever_their_clocks_say(tmp_path):
    clocks = ("2/27/2010 3:55:14.000 GMT", "2/27/2010 4:55:16.000 GMT")
    put(tmp_path, a_parte1=part(0, 200, trigger=clocks[0]), a_parte2=part(200, 400, trigger=clocks[1]))
    records, _ = read_all(tmp_path)
    assert [record.npts for record in records] == [400] * 3


@pytest.mark.parametrize(("begin", "count"), [(2.002, 3), (1.998, 3), (2.003, 6), (1.997, 6)])
def test_printed_times_of_parts_may_be_off_by_a_quarter_of_a_step(tmp_path, begin, count):
    put(tmp_path, a_parte1=part(0, 200), a_parte2=part(200, 400, first=begin))
    assert len(read_all(tmp_path)[0]) == count


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        ({"xparte1": part(0, 200), "xparte2": part(201, 400)}, "part 2 begins 2.01 s after part 1 .* expected 2 s"),
        ({"xparte1": part(0, 200), "xparte2": part(200, 400, first=0.0)}, "part 2 begins 0 s after part 1"),
        ({"xparte1": part(0, 200), "xparte3": part(200, 400)}, "found 1, 3"),
        ({"xparte2": part(0, 200), "xparte3": part(200, 400)}, "found 2, 3"),
        (
            {"xparte1": part(0, 200), "xparte2": part(200, 400, components=("L", "V", "T", "INTC"))},
            "parts 1 and 2 differ in their channels",
        ),
        ({"xparte1": part(0, 200), "Xparte1": part(0, 190), "xparte2": part(200, 400)}, "found 1, 1, 2"),
    ],
)
def test_parts_that_do_not_fit_stay_apart_with_the_reason(tmp_path, parts, reason):
    records, failures = read_all(put(tmp_path, **parts))
    assert failures == []
    assert len(records) == 3 * len(parts)
    for record in records:
        assert isinstance(record, Part)
        assert any("split into several files" in note for note in record.warnings)
        with pytest.raises(AssertionError, match=f"not joined: .*{reason}"):
            raise AssertionError(record.warnings[-1])


def test_parts_of_different_stations_are_no_matter_of_each_other(tmp_path):
    put(tmp_path, xparte1=part(0, 200, name="CURICO"), xparte2=part(200, 400, name="TALCA"))
    records, _ = read_all(tmp_path)
    assert [record.npts for record in records] == [200] * 6
    assert not any("not joined" in note for record in records for note in record.warnings)
    assert all(isinstance(record, Part) for record in records)


def test_a_part_alone_starts_at_its_first_time(tmp_path):
    put(tmp_path, xparte2=part(200, 400))
    records = read(tmp_path / "xparte2.v1")
    assert {record.start_time for record in records} == {datetime(2010, 2, 27, 3, 55, 16, tzinfo=UTC)}
    assert [record.id for record in records] == ["xparte2.NS", "xparte2.V", "xparte2.EW"]


def test_copies_of_the_parts_are_duplicates(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        put(tmp_path / folder, xparte1=part(0, 200), xparte2=part(200, 400))
    records, failures = read_all(tmp_path)
    assert [record.npts for record in records] == [400] * 3
    assert [failure.kind for failure in failures] == ["duplicate"] * 6
