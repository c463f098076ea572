"""miniSEED with its StationXML, and SAC, through obspy."""

import io
from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import Record

#: Counts per m/s2 of the samples.
GAIN = 2.0e5
#: Volts per m/s2 of the sensor in front of the recorder.
VOLTS = 0.5
#: What the files do not say.
OPTIONS = {"CI.CLC..HNE.sac": {"units": "cm/s2"}}

_CHANNEL = """
      <Channel code="{code}" locationCode="" startDate="2010-01-01T00:00:00">
        <Latitude>35.816</Latitude>
        <Longitude>-117.598</Longitude>
        <Elevation>775.0</Elevation>
        <Depth>0.0</Depth>
        <Azimuth>{azimuth}</Azimuth>
        <Dip>{dip}</Dip>
        <SampleRate>100.0</SampleRate>
        <Response>
          <InstrumentSensitivity>
            <Value>{gain}</Value>
            <Frequency>1.0</Frequency>
            <InputUnits>
              <Name>M/S**2</Name>
            </InputUnits>
            <OutputUnits>
              <Name>COUNTS</Name>
            </OutputUnits>
          </InstrumentSensitivity>
          <Stage number="1">
            <PolesZeros>
              <InputUnits>
                <Name>M/S**2</Name>
              </InputUnits>
              <OutputUnits>
                <Name>V</Name>
              </OutputUnits>
              <PzTransferFunctionType>LAPLACE (RADIANS/SECOND)</PzTransferFunctionType>
              <NormalizationFactor>1.0</NormalizationFactor>
              <NormalizationFrequency>1.0</NormalizationFrequency>
            </PolesZeros>
            <StageGain>
              <Value>{volts}</Value>
              <Frequency>1.0</Frequency>
            </StageGain>
          </Stage>
          <Stage number="2">
            <Coefficients>
              <InputUnits>
                <Name>V</Name>
              </InputUnits>
              <OutputUnits>
                <Name>COUNTS</Name>
              </OutputUnits>
              <CfTransferFunctionType>DIGITAL</CfTransferFunctionType>
              <Numerator>1.0</Numerator>
            </Coefficients>
            <Decimation>
              <InputSampleRate>100.0</InputSampleRate>
              <Factor>1</Factor>
              <Offset>0</Offset>
              <Delay>0.0</Delay>
              <Correction>0.0</Correction>
            </Decimation>
            <StageGain>
              <Value>{counts}</Value>
              <Frequency>1.0</Frequency>
            </StageGain>
          </Stage>
        </Response>
      </Channel>"""

_STATION = """<?xml version="1.0" encoding="UTF-8"?>
<FDSNStationXML xmlns="http://www.fdsn.org/xml/station/1" schemaVersion="1.1">
  <Source>{note}</Source>
  <Created>2019-07-06T00:00:00</Created>
  <Network code="CI">
    <Station code="CLC">
      <Latitude>35.816</Latitude>
      <Longitude>-117.598</Longitude>
      <Elevation>775.0</Elevation>
      <Site>
        <Name>{note}</Name>
      </Site>{channels}
    </Station>
  </Network>
</FDSNStationXML>
"""


def station_xml(note: str, channels: Sequence[tuple[str, float, float]], gain: float = GAIN) -> bytes:
    """StationXML of CI.CLC with an acceleration sensitivity for each (code, azimuth, dip)."""
    listed = "".join(
        _CHANNEL.format(code=code, azimuth=azimuth, dip=dip, gain=gain, volts=VOLTS, counts=gain / VOLTS)
        for code, azimuth, dip in channels
    )
    return _STATION.format(note=note, channels=listed).encode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels in one miniSEED file with their StationXML, and one channel as SAC."""
    import obspy

    header = {"network": "CI", "station": "CLC", "sampling_rate": 100.0}
    header["starttime"] = obspy.UTCDateTime(channels[0].start_time)
    places = [("HNE", 90.0, 0.0), ("HNN", 0.0, 0.0), ("HNZ", 0.0, -90.0)]
    traces = [
        obspy.Trace(np.rint(GAIN * channel.acceleration).astype(np.int32), {**header, "channel": place[0]})
        for channel, place in zip(channels, places, strict=True)
    ]
    miniseed, sac = io.BytesIO(), io.BytesIO()
    obspy.Stream(traces).write(miniseed, format="MSEED", encoding="STEIM2", reclen=512, byteorder=">")
    values = (100.0 * channels[0].acceleration).astype(np.float32)
    trace = obspy.Trace(values, {**header, "channel": "HNE"})
    trace.stats.sac = {"cmpaz": 90.0, "cmpinc": 90.0, "kevnm": "ROCKPULSE SAMPLE", "kuser0": "CI.CLC"}
    trace.write(sac, format="SAC")
    return {
        "CI.CLC.mseed": miniseed.getvalue(),
        "CI.CLC.xml": station_xml(NOTE, places),
        "CI.CLC..HNE.sac": sac.getvalue(),
    }
