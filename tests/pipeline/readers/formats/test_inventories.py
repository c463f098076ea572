"""miniSEED with an inventory of ArcLink or dataless SEED, and full SEED, by obspy; none of them is StationXML."""

import io
from pathlib import Path

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.source import NoRecord

COUNTS = np.round(pulse(500, peak=300_000.0)).astype(np.int32)
GAIN = 330_000.0
ARCLINK = f"""<inventory xmlns="http://geofon.gfz-potsdam.de/ns/Inventory/1.0/">
 <network code="XX" description="A net" start="1980-01-01T00:00:00.0000Z" publicID="Network/1">
  <station code="ABC" description="A place" latitude="38.0" longitude="40.0" elevation="9.0"
    start="2000-01-01T00:00:00.0000Z" publicID="Station/1">
   <sensorLocation code="" latitude="38.0" longitude="40.0" elevation="9.0" start="2000-01-01T00:00:00.0000Z"
     publicID="SensorLocation/1">
    <stream code="HNE" azimuth="90.0" dip="0.0" depth="0.0" format="Steim2" gain="{GAIN}" gainFrequency="1.0"
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
 <responsePAZ name="S" publicID="ResponsePAZ/1" type="A" gain="{GAIN}" gainFrequency="1.0" normalizationFactor="1.0"
   normalizationFrequency="1.0" numberOfZeros="0" numberOfPoles="0"><zeros /><poles /></responsePAZ>
 <responseFIR name="F" publicID="ResponseFIR/1" gain="1.0" decimationFactor="1" delay="0.0" correction="0.0"
   numberOfCoefficients="1" symmetry="A"><coefficients>1.0</coefficients></responseFIR>
</inventory>
"""


def miniseed(network: str, station: str, location: str, channel: str, start: str) -> bytes:
    import obspy

    codes = {"network": network, "station": station, "location": location, "channel": channel}
    trace = obspy.Trace(COUNTS, {**codes, "sampling_rate": 100.0, "starttime": obspy.UTCDateTime(start)})
    buffer = io.BytesIO()
    trace.write(buffer, format="MSEED", reclen=4096)
    return buffer.getvalue()


@pytest.mark.sweep
def test_the_gain_of_an_inventory_of_arclink(tmp_path):
    (tmp_path / "a.mseed").write_bytes(miniseed("XX", "ABC", "", "HNE", "2020-01-01"))
    (tmp_path / "inventory.xml").write_text(ARCLINK, encoding="ascii")
    (record,), failures = read_all(tmp_path)
    assert failures == []
    assert record.acceleration == pytest.approx(COUNTS / GAIN)
    assert record.azimuth == 90.0


@pytest.mark.sweep
def test_full_seed_has_its_gain_within_and_dataless_seed_no_samples(tmp_path):
    import obspy

    dataless = Path(obspy.__file__).parent / "io" / "xseed" / "tests" / "data" / "bug165.dataless"
    if not dataless.is_file():
        pytest.skip("obspy without the data of its tests")
    samples = miniseed("NZ", "DCZ", "20", "HNZ", "2012-01-01")
    (tmp_path / "whole.seed").write_bytes(dataless.read_bytes() + samples)
    (tmp_path / "beside.dataless").write_bytes(dataless.read_bytes())
    (record,), _ = read_all(tmp_path)
    assert (record.orientation, record.npts, record.station) == ("vertical", 500, "DCZ")
    assert record.pga == pytest.approx(np.max(np.abs(COUNTS * record.unit_factor)))
    (tmp_path / "alone.mseed").write_bytes(samples)
    assert np.array_equal(read(tmp_path / "alone.mseed")[0].acceleration, record.acceleration)
    with pytest.raises(NoRecord, match="dataless SEED"):
        read(tmp_path / "beside.dataless")
