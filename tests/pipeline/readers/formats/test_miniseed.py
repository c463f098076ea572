"""miniSEED with StationXML beside it, or ArcLink or dataless SEED: synthesised and real files; what obspy says."""

import re
import shutil
import threading
import warnings
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.formats.obspy_formats import _held_rate, is_miniseed
from rockpulse.readers.kit.obspy_bridge import contradicts_channel, obspy_notes
from rockpulse.readers.source import NoRecord, NotAcceleration

COUNTS = np.round(pulse(1000, peak=500_000.0)).astype(np.int32)
START = "2020-01-02T03:04:05.5"


def trace(channel="HNE", counts=COUNTS, start=START, codes="XX.ABC.00"):
    import obspy

    network, station, location = codes.split(".")
    header = {"network": network, "station": station, "location": location, "channel": channel, "sampling_rate": 100.0}
    return obspy.Trace(counts, {**header, "starttime": obspy.UTCDateTime(start)})


def write_miniseed(folder, *traces, name="record.mseed"):
    import obspy

    path = folder / name
    obspy.Stream(list(traces)).write(str(path), format="MSEED")
    return path


def write_station_xml(folder, *epochs, name="XX.ABC.xml"):
    """Each epoch is (channel, sensitivity, unit, azimuth, dip, first and last day)."""
    import obspy
    from obspy.core.inventory import Channel, Inventory, Network, Site, Station
    from obspy.core.inventory.response import InstrumentSensitivity, Response

    channels = []
    for code, value, unit, azimuth, dip, first, last in epochs:
        known = InstrumentSensitivity(value, 1.0, input_units=unit, output_units="COUNTS")
        response = None if value is None else Response(instrument_sensitivity=known)
        times = {"start_date": obspy.UTCDateTime(first), "end_date": obspy.UTCDateTime(last)}
        channels.append(Channel(code, "00", 0.0, 0.0, 0.0, 0.0, azimuth=azimuth, dip=dip, response=response, **times))
    site = Site(name=" Town Hall ")
    station = Station(code="ABC", latitude=0.0, longitude=0.0, elevation=0.0, channels=channels, site=site)
    inventory = Inventory(networks=[Network(code="XX", stations=[station])], source="test")
    inventory.write(str(folder / name), format="STATIONXML")


def epoch(code="HNE", value=2.0e5, unit="M/S**2", azimuth=90.0, dip=0.0, first="2019-01-01", last="2030-01-01"):
    return (code, value, unit, azimuth, dip, first, last)


@pytest.mark.parametrize(
    ("head", "known"),
    [
        (b"000001D " + 40 * b"x", True),
        (b"000001D " + 39 * b"x", False),
        (b" 0\x00123M\x00" + 40 * b"x", True),
        (b"00000XD " + 40 * b"x", False),
        (b"X00001D " + 40 * b"x", False),
        (b"000001X " + 40 * b"x", False),
        (b"000001Dx" + 40 * b"x", False),
    ],
)
def test_a_data_record_is_known_by_its_first_letters(head, known):
    assert is_miniseed(head, "x") is known


@pytest.mark.parametrize(
    ("stated", "noted"), [(None, False), (1001.0, False), (1002.0, True), (999.0, False), (998.0, True)]
)
def test_the_rate_of_the_station_xml_may_be_off_by_a_thousandth(stated, noted):
    note = f"the StationXML states {stated} samples per s, but the data have 1000; the interval of the data is used"
    found = _held_rate(1000.0, SimpleNamespace(sample_rate=stated))
    assert found == ([note.replace(".0 ", " ")] if noted else [])


def test_counts_are_divided_by_the_sensitivity(tmp_path):
    write_station_xml(tmp_path, epoch())
    (record,) = read(write_miniseed(tmp_path, trace()))
    assert record.acceleration == pytest.approx(COUNTS / 2.0e5, rel=1e-12)
    assert (record.dt, record.source_unit, record.unit_factor) == (0.01, "counts", 1.0 / 2.0e5)
    assert record.id == "XX.ABC.00.HNE@20200102T030405"
    assert record.station_name == "Town Hall"
    assert record.start_time == datetime(2020, 1, 2, 3, 4, 5, 500000, tzinfo=UTC)
    assert (record.orientation, record.azimuth, record.processed) == ("horizontal", 90.0, False)
    assert record.sensor_depth == 0.0


def test_the_depth_of_the_sensor_is_that_of_the_station_xml(tmp_path):
    write_station_xml(tmp_path, epoch())
    metadata = tmp_path / "XX.ABC.xml"
    metadata.write_text(re.sub(r"(<Depth[^>]*>)0\.0<", r"\g<1>120.0<", metadata.read_text()))
    (record,) = read(write_miniseed(tmp_path, trace()))
    assert record.sensor_depth == 120.0
    assert record.warnings == ("the sensor lies 120 m below the ground: motion at depth, not at the ground surface",)


def test_the_epoch_of_the_record_counts(tmp_path):
    write_station_xml(tmp_path, epoch(value=1.0, last="2019-12-31"), epoch(value=4.0e5, first="2019-12-31"))
    (record,) = read(write_miniseed(tmp_path, trace()))
    assert record.unit_factor == 1.0 / 4.0e5
    write_station_xml(tmp_path, epoch(value=7.0, last="2019-12-31"), name="record.xml")  # of the name, of another time
    assert read(tmp_path / "record.mseed")[0].unit_factor == 1.0 / 4.0e5


@pytest.mark.parametrize(("dip", "sign"), [(-90.0, 1.0), (90.0, -1.0)])
def test_vertical_motion_is_positive_up(tmp_path, dip, sign):
    write_station_xml(tmp_path, epoch("HNZ", azimuth=0.0, dip=dip))
    (record,) = read(write_miniseed(tmp_path, trace("HNZ")))
    assert record.orientation == "vertical"
    assert record.acceleration == pytest.approx(sign * COUNTS / 2.0e5, rel=1e-12)


@pytest.mark.parametrize(
    ("epochs", "error", "message"),
    [
        ([], RecordRefused, "no StationXML file of the station"),
        ([epoch("HNN")], RecordRefused, "is in counts and no sensitivity"),
        ([epoch(value=None)], RecordRefused, "is in counts and no sensitivity"),
        ([epoch(last="2019-06-01")], RecordRefused, "is in counts and no sensitivity"),
        ([epoch(last=START[:-1] + "9")], RecordRefused, "is in counts and no sensitivity"),
        ([epoch(), epoch(value=3.0)], RecordRefused, "2 different sensitivities"),
        (
            [epoch(), epoch(value=3.0), epoch(azimuth=0.0)],
            RecordRefused,
            r"has 3 different sensitivities .* \(200000.0 per M/S\*\*2; 3.0 per M/S",
        ),
        ([epoch(unit="M/S")], NotAcceleration, "records M/S, expected an acceleration"),
        ([epoch(unit="PA")], NotAcceleration, "records PA, expected ground motion"),
        ([epoch(unit="V")], RecordRefused, "unknown input unit 'V'"),
    ],
)
def test_counts_without_a_clear_gain_of_acceleration_are_refused(tmp_path, epochs, error, message):
    if epochs:
        write_station_xml(tmp_path, *epochs)
    with pytest.raises(error, match=message):
        read(write_miniseed(tmp_path, trace()))


def write_stages(folder, poles, name="XX.ABC.xml"):
    """A StationXML whose only stage is an accelerometer of 2e5 counts per m/s2 at 1 Hz."""
    import obspy
    from obspy.core.inventory.response import Response

    write_station_xml(folder, epoch(), name=name)
    inventory = obspy.read_inventory(str(folder / name))
    response = Response.from_paz(
        [], poles, 2.0e5, 1.0, input_units="M/S**2", output_units="COUNTS", normalization_frequency=1.0
    )
    response.response_stages[0].normalization_factor = float(np.abs(np.prod([2j * np.pi - pole for pole in poles])))
    response.instrument_sensitivity.value = 2.0e5
    inventory[0][0][0].response = response
    inventory.write(str(folder / name), format="STATIONXML")


def test_two_responses_for_one_time_are_refused_where_they_matter(tmp_path):
    write_stages(tmp_path, [-300.0 + 300.0j, -300.0 - 300.0j])
    write_stages(tmp_path, [-900.0 + 900.0j, -900.0 - 900.0j], name="XX.ABC.other.xml")
    path = write_miniseed(tmp_path, trace())
    with pytest.raises(RecordRefused, match="2 different responses for one time"):
        read(path, response="remove")
    assert read(path)[0].unit_factor == 1.0 / 2.0e5


@pytest.mark.parametrize(
    ("other", "what"),
    [
        (epoch(value=3.0), "sensitivities"),
        (epoch(azimuth=270.0), "directions"),
        (epoch(azimuth=None, dip=None), "directions"),
        (epoch(dip=-90.0), "directions"),
    ],
)
def test_station_files_that_tell_different_things_are_refused_unless_one_has_the_name_of_the_record(
    tmp_path, other, what
):
    path = write_miniseed(tmp_path, trace())
    write_station_xml(tmp_path, epoch(azimuth=60.0), name="a.xml")
    write_station_xml(tmp_path, epoch(azimuth=60.0), name="b.xml")
    assert read(path)[0].azimuth == 60.0
    write_station_xml(tmp_path, other, name="z.xml")
    with pytest.raises(RecordRefused, match=rf"XX\.ABC\.00\.HNE has 2 different {what} for one time in .*record\.xml"):
        read(path)
    write_station_xml(tmp_path, epoch(azimuth=60.0), name="record.xml")
    (record,) = read(path)
    assert (record.azimuth, record.unit_factor) == (60.0, 1.0 / 2.0e5)


def test_the_station_file_that_was_looked_in_is_named(tmp_path):
    path = write_miniseed(tmp_path, trace())
    write_station_xml(tmp_path, epoch(last="2019-06-01"))
    with pytest.raises(RecordRefused, match=r"\(looked in \S*XX.ABC.xml\); put the station's StationXML"):
        read(path)


def test_a_gap_is_refused(tmp_path):
    write_station_xml(tmp_path, epoch())
    path = write_miniseed(tmp_path, trace(), trace(start="2020-01-02T03:05:05"))
    with pytest.raises(RecordRefused, match=r"1 gaps or overlaps, the first at 2020-01-02T03:04:15\.49"):
        read(path)
    (record,) = read(write_miniseed(tmp_path, trace(), trace(start="2020-01-02T03:04:15.5")))
    assert record.acceleration == pytest.approx(np.tile(COUNTS, 2) / 2.0e5)


def test_a_velocity_channel_beside_an_acceleration_is_left_out_and_said_so(tmp_path):
    write_station_xml(tmp_path, epoch(), epoch("HHE", unit="M/S"))
    (record,) = read(write_miniseed(tmp_path, trace(), trace("HHE")))
    assert record.channel == "HNE"
    assert "HHE records M/S" in record.warnings[0]


def test_damaged_miniseed_and_station_files_are_named(tmp_path):
    write_station_xml(tmp_path, epoch())
    noise = np.random.default_rng(5).integers(-30_000, 30_000, 5000).astype(np.int32)
    path = write_miniseed(tmp_path, trace(counts=noise))
    xml = tmp_path / "XX.ABC.xml"
    xml.write_bytes(xml.read_bytes()[:-200])
    with pytest.raises(RecordFormatError, match=r"XX.ABC.xml: cannot be read as StationXML"):
        read(path)
    write_station_xml(tmp_path, epoch())
    content = path.read_bytes()
    path.write_bytes(content[:-100])
    with pytest.raises(RecordFormatError, match="expected whole data records of 4096 bytes, found 3996"):
        read(path)
    path.write_bytes(content[:100])
    with pytest.raises(RecordFormatError, match=r"obspy cannot read it as MSEED"):
        read(path)


@pytest.mark.sweep
def test_warnings_of_the_process_survive_two_threads_that_use_obspy():
    inside, before = threading.Event(), (warnings.filters[:], warnings._showwarnmsg_impl)
    first_in, first_out = threading.Event(), threading.Event()

    def first():
        with obspy_notes():
            first_in.set()
            inside.wait(0.3)  # the other never comes in where blocks exclude each other
        first_out.set()

    def second():
        first_in.wait()
        with obspy_notes():
            inside.set()
            first_out.wait(5.0)

    threads = [threading.Thread(target=work) for work in (first, second)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    after = (warnings.filters[:], warnings._showwarnmsg_impl)
    warnings.filters[:], warnings._showwarnmsg_impl = before
    assert after == before


@pytest.mark.parametrize(
    ("old", "new"), [(b"<SampleRate>100.0<", b"<SampleRate>NaN<"), (b"<Depth>0.0<", b"<Depth>NaN<")]
)
def test_a_fault_of_the_station_metadata_that_obspy_warns_of_is_named(samples, tmp_path, old, new):
    formats = samples.parent / "formats"
    shutil.copy(formats / "CI.CLC.mseed", tmp_path)
    metadata = (formats / "CI.CLC.xml").read_bytes()
    assert old in metadata
    (tmp_path / "CI.CLC.xml").write_bytes(metadata.replace(old, new))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if b"Depth" in old:  # obspy leaves the channels out
            with pytest.raises(RecordRefused, match=r"no sensitivity .*CI\.CLC\.xml: obspy: .*depth"):
                read(tmp_path / "CI.CLC.mseed")
        else:
            records = read(tmp_path / "CI.CLC.mseed")
            assert len(records) == 3
            assert all(re.search("CI.CLC.xml: obspy: .*NaN", "".join(record.warnings)) for record in records)


#: An inventory that is no StationXML.
ARCLINK = """<inventory xmlns="http://geofon.gfz-potsdam.de/ns/Inventory/1.0/">
 <network code="XX" description="A net" start="1980-01-01T00:00:00.0000Z" publicID="Network/1">
  <station code="ABC" description="A place" latitude="38.0" longitude="40.0" elevation="9.0"
    start="2000-01-01T00:00:00.0000Z" publicID="Station/1">
   <sensorLocation code="" latitude="38.0" longitude="40.0" elevation="9.0" start="2000-01-01T00:00:00.0000Z"
     publicID="SensorLocation/1">
    <stream code="HNE" azimuth="90.0" dip="0.0" depth="0.0" format="Steim2" gain="200000.0" gainFrequency="1.0"
      gainUnit="M/S**2" sampleRateNumerator="100" sampleRateDenominator="1" sensor="Sensor/1" sensorChannel="0"
      datalogger="Datalogger/1" dataloggerChannel="0" maxClockDrift="0.0" start="2000-01-01T00:00:00.0000Z"
      publicID="Stream/1" />
   </sensorLocation>
  </station>
 </network>
 <sensor name="S" publicID="Sensor/1" response="ResponsePAZ/1" unit="M/S**2" />
 <datalogger name="D" publicID="Datalogger/1" gain="1.0" maxClockDrift="0.0"><decimation sampleRateNumerator="100"
   sampleRateDenominator="1"><analogueFilterChain /><digitalFilterChain>ResponseFIR/1</digitalFilterChain></decimation>
 </datalogger>
 <responsePAZ name="S" publicID="ResponsePAZ/1" type="A" gain="200000.0" gainFrequency="1.0" normalizationFactor="1.0"
   normalizationFrequency="1.0" numberOfZeros="0" numberOfPoles="0"><zeros /><poles /></responsePAZ>
 <responseFIR name="F" publicID="ResponseFIR/1" gain="1.0" decimationFactor="1" delay="0.0" correction="0.0"
   numberOfCoefficients="1" symmetry="A"><coefficients>1.0</coefficients></responseFIR>
</inventory>
"""


@pytest.mark.sweep
def test_the_gain_of_an_inventory_of_arclink(tmp_path):
    write_miniseed(tmp_path, trace(codes="XX.ABC."))
    (tmp_path / "inventory.xml").write_text(ARCLINK, encoding="ascii")
    (record,), failures = read_all(tmp_path)
    assert failures == []
    assert record.acceleration == pytest.approx(COUNTS / 2.0e5)
    assert record.azimuth == 90.0


@pytest.mark.sweep
def test_full_seed_has_its_gain_within_and_dataless_seed_no_samples(tmp_path):
    import obspy

    dataless = Path(obspy.__file__).parent / "io" / "xseed" / "tests" / "data" / "bug165.dataless"
    if not dataless.is_file():
        pytest.skip("obspy without the data of its tests")
    alone = write_miniseed(tmp_path, trace("HNZ", start="2012-01-01", codes="NZ.DCZ.20"), name="alone.mseed")
    folder = tmp_path / "whole"
    folder.mkdir()
    (folder / "whole.seed").write_bytes(dataless.read_bytes() + alone.read_bytes())
    (folder / "beside.dataless").write_bytes(dataless.read_bytes())
    (record,), _ = read_all(folder)
    assert (record.orientation, record.npts, record.station) == ("vertical", 1000, "DCZ")
    assert record.pga == pytest.approx(np.max(np.abs(COUNTS * record.unit_factor)))
    shutil.copy(alone, folder)
    assert np.array_equal(read(folder / "alone.mseed")[0].acceleration, record.acceleration)
    with pytest.raises(NoRecord, match="dataless SEED"):
        read(folder / "beside.dataless")


def test_station_metadata_contradict_a_channel_by_what_it_tells_at_its_time(tmp_path):
    import obspy

    for name, corner in (("a.xml", 300.0), ("b.xml", 900.0)):
        write_stages(tmp_path, [corner * (-1.0 + 1.0j), corner * (-1.0 - 1.0j)], name=name)
    files = [("a.xml", (tmp_path / "a.xml").read_bytes())]
    channel = obspy.read_inventory(str(tmp_path / "b.xml"))[0][0][0]
    assert not contradicts_channel(files, "XX", "ABC", channel)  # other stages of the same sensitivity
    channel.azimuth = 0.0
    assert contradicts_channel(files, "XX", "ABC", channel)
    assert not contradicts_channel(files, "XX", "DEF", channel)
    channel.start_date, channel.end_date = obspy.UTCDateTime("2031-01-01"), None
    assert not contradicts_channel(files, "XX", "ABC", channel)
