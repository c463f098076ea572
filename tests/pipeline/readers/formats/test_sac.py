"""SAC: files synthesised with obspy, and a real one."""

import struct
from datetime import timedelta

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.formats.obspy_formats import SAC
from rockpulse.readers.source import NotAcceleration

COUNTS = np.round(pulse(1000, peak=500_000.0)).astype(np.int32)


def write_sac(folder, values=COUNTS / 1e4, channel="HNE", **header):
    import obspy

    path = folder / "record.sac"
    names = {"network": "XX", "station": "ABC", "location": "00", "channel": channel}
    start = obspy.UTCDateTime("2020-01-02T03:04:05.5")
    sac = obspy.Trace(np.asarray(values, dtype=np.float32), {**names, "sampling_rate": 100.0, "starttime": start})
    sac.stats.sac = {"cmpaz": 135.0, "cmpinc": 90.0, **header}
    sac.write(str(path), format="SAC")
    return path


def test_sac_with_a_unit(tmp_path):
    (record,) = read(write_sac(tmp_path), units="cm/s2")
    assert record.acceleration == pytest.approx(COUNTS / 1e6, rel=1e-6, abs=1e-9)
    assert (record.dt, record.azimuth, record.orientation) == (0.01, 135.0, "horizontal")
    assert record.id == "XX.ABC.00.HNE@20200102T030405"


def test_the_peak_and_the_times_that_a_header_states_are_held_against_the_samples(tmp_path):
    path = write_sac(tmp_path, b=10.0)
    (record,) = read(path, units="cm/s2")
    assert record.header_peak == pytest.approx(record.pga, rel=1e-6)
    assert record.warnings == ()
    (record,) = read(changed(path, 5, 15.0), units="cm/s2")  # B
    assert "1000 samples at 0.01 s from 15 s (B) end at 24.99 s" in record.warnings[0]


def test_sac_without_a_unit_asks_for_it(tmp_path):
    with pytest.raises(UnitError, match="does not state the unit of acceleration"):
        read(write_sac(tmp_path))


@pytest.mark.parametrize(("idep", "series"), [(6, "displacement"), (7, "velocity")])
def test_sac_of_another_motion_is_refused(tmp_path, idep, series):
    with pytest.raises(NotAcceleration, match=series):
        read(write_sac(tmp_path, idep=idep), units="g")


def changed(path, word: int, value: float, kind: str = "f"):
    """The file with another value in a word of its header, counted from 0."""
    content = bytearray(path.read_bytes())
    struct.pack_into(f"<{kind}", content, 4 * word, value)
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("word", "value", "message"),
    [
        (79, 1026, r"expected 1026 samples \(header NPTS\), found room for 1000;"),
        (79, 0, r"expected 0 samples \(header NPTS\), found room for 1000"),
        (85, 4, "expected an equally spaced time series"),
        (105, 0, "expected an equally spaced time series"),
    ],
)
def test_damage_is_named(tmp_path, word, value, message):
    with pytest.raises(RecordFormatError, match=message):
        read(changed(write_sac(tmp_path), word, value, "i"), units="g")


@pytest.mark.parametrize(("name", "word"), [("STLA", 31), ("STLO", 32), ("EVLA", 35), ("EVLO", 36)])
def test_sac_with_a_longitude_that_is_none_is_refused_at_once(tmp_path, name, word):
    for value in (1e20, 360.5, -361.0):
        with pytest.raises(RecordFormatError, match=f"header word {name}, found {value:g}".replace("+", r"\+")):
            read(changed(write_sac(tmp_path), word, value), units="g")


@pytest.mark.parametrize(
    ("start", "end", "told"),
    [
        (10.0, 20.009, False),
        (10.0, 19.971, False),
        (10.0, 20.011, True),
        (10.0, 19.969, True),
        (5000.0, 5010.014, False),
        (5000.0, 5010.017, True),
    ],
)
def test_the_last_sample_may_be_off_by_two_steps_and_a_millionth(tmp_path, start, end, told):
    (record,) = read(changed(write_sac(tmp_path, b=start), 6, end), units="cm/s2")
    assert bool(record.warnings) is told


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_stated_peak_is_the_larger_of_both_extremes(tmp_path, sign):
    values = sign * np.array([0.0, 7.0, -3.0, 1.0])
    assert read(write_sac(tmp_path, values), units="cm/s2")[0].header_peak == pytest.approx(0.07, rel=1e-6)
    for word in (1, 2):
        assert np.isnan(read(changed(write_sac(tmp_path, values), word, -12345.0), units="cm/s2")[0].header_peak)


def test_the_facts_of_the_header(tmp_path):
    told = {
        "mag": 5.1,
        "evla": 35.5,
        "evlo": -117.25,
        "evdp": 8.0,
        "dist": 21.5,
        "stla": 35.75,
        "stlo": -117.5,
        "stdp": 55.0,
    }
    (record,) = read(write_sac(tmp_path, channel="", b=10.0, o=4.5, kevnm="RIDGE", **told), units="g")
    assert record.origin_time == record.start_time - timedelta(seconds=5.5)
    assert (record.magnitude, record.hypocentre_depth, record.epicentral_distance) == (5.1, 8000.0, 21_500.0)
    assert (record.hypocentre_latitude, record.hypocentre_longitude) == (35.5, -117.25)
    assert (record.station_latitude, record.station_longitude, record.sensor_depth) == (35.75, -117.5, 55.0)
    assert (record.event, record.channel, record.id) == ("RIDGE", "1", "XX.ABC.00.1@20200102T030405")
    (record,) = read(write_sac(tmp_path, b=10.0, o=10.0), units="g")
    assert (record.origin_time, np.isnan(record.sensor_depth)) == (None, True)


def test_a_scale_is_told_and_words_that_are_not_set_are_not(tmp_path):
    assert read(write_sac(tmp_path, scale=3.0), units="cm/s2")[0].warnings == (
        "the header word SCALE = 3 is not applied",
    )
    assert read(changed(write_sac(tmp_path), 3, -12345.0), units="cm/s2")[0].warnings == ()
    assert read(changed(write_sac(tmp_path), 85, -12345, "i"), units="cm/s2")[0].warnings == ()


@pytest.mark.parametrize(("version", "known"), [(5, False), (6, True), (7, True), (8, False)])
@pytest.mark.parametrize("order", ["<", ">"])
def test_the_version_of_the_header_tells_the_format(order, version, known):
    head = bytearray(632)
    struct.pack_into(f"{order}i", head, 4 * 76, version)
    assert SAC.detect(bytes(head), "x") is known
    assert not SAC.detect(bytes(head[:631]), "x")
