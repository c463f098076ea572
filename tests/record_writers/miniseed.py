"""miniSEED and SAC through obspy; the StationXML of the miniSEED file is kept as it is."""

import io
from collections.abc import Sequence

import numpy as np

from record_writers._shared import shipped
from rockpulse.record.record import Record

#: Counts per m/s2 of the samples, which their StationXML states.
GAIN = 2.0e5
#: What the files do not say.
OPTIONS = {"CI.CLC..HNE.sac": {"units": "cm/s2"}}


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels in one miniSEED file with their StationXML, and one channel as SAC."""
    import obspy

    header = {"network": "CI", "station": "CLC", "sampling_rate": 100.0}
    header["starttime"] = obspy.UTCDateTime(channels[0].start_time)
    traces = [
        obspy.Trace(np.rint(GAIN * channel.acceleration).astype(np.int32), {**header, "channel": code})
        for channel, code in zip(channels, ("HNE", "HNN", "HNZ"), strict=True)
    ]
    miniseed, sac = io.BytesIO(), io.BytesIO()
    obspy.Stream(traces).write(miniseed, format="MSEED", encoding="STEIM2", reclen=512, byteorder=">")
    values = (100.0 * channels[0].acceleration).astype(np.float32)
    trace = obspy.Trace(values, {**header, "channel": "HNE"})
    trace.stats.sac = {"cmpaz": 90.0, "cmpinc": 90.0, "kevnm": "ROCKPULSE SAMPLE", "kuser0": "CI.CLC"}
    trace.write(sac, format="SAC")
    return {"CI.CLC.mseed": miniseed.getvalue(), "CI.CLC.xml": shipped("CI.CLC.xml"), "CI.CLC..HNE.sac": sac.getvalue()}
