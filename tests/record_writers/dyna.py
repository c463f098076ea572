"""DYNA 1.2 (ESM, ITACA, AFAD): 64 lines ``KEY: value``, then one acceleration in cm/s2 on each line."""

from collections.abc import Mapping, Sequence

import numpy as np

from record_writers._shared import shipped
from rockpulse.record.record import Record

#: The sample whose header all files have, and what the tests state in it.
SAMPLE = "CI.CLC..HNE.D.20190706.031958.X.ACC.ASC"
_ESM = {
    "EVENT_NAME": "GREECE",
    "EVENT_ID": "EMSC-20190728_0000106",
    "EVENT_DATE_YYYYMMDD": "20190728",
    "EVENT_TIME_HHMMSS": "160908",
    "EVENT_LATITUDE_DEGREE": "38.1000",
    "EVENT_LONGITUDE_DEGREE": "23.5400",
    "EVENT_DEPTH_KM": "9.0",
    "MAGNITUDE_W": "",
    "MAGNITUDE_L": "4.6",
    "NETWORK": "HI",
    "STATION_CODE": "ARS1",
    "STATION_NAME": "Town Hall,Argos,Argolis,Peloponnese",
    "STATION_LATITUDE_DEGREE": "37.634900",
    "STATION_LONGITUDE_DEGREE": "22.729300",
    "EPICENTRAL_DISTANCE_KM": "88.1",
    "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "20190728_160919.870",
}

#: What a corrected volume says instead.
CORRECTED = {
    "PROCESSING": "manual (Paolucci et al., 2011)",
    "BASELINE_CORRECTION": "BASELINE REMOVED",
    "FILTER_TYPE": "BUTTERWORTH",
    "LOW_CUT_FREQUENCY_HZ": "0.100",
    "HIGH_CUT_FREQUENCY_HZ": "30.000",
}


#: What AFAD (TADAS) writes before the first key of a corrected file.
TADAS = """\
AAD_Filtered_TADAS_FILE
AAD_BASELINE_CORRECTION: BASELINE REMOVED
AAD_FILTER_TYPE: BUTTERWORTH
AAD_FILTER_ORDER: 1
AAD_LOW_CUT_FREQUENCY_HZ: 0.025
AAD_HIGH_CUT_FREQUENCY_HZ: 40.0
"""


def dyna(values: Sequence[float], dt=0.01, without=(), facts: Mapping[str, str] = _ESM, **changes: object) -> bytes:
    """One channel, accelerations in cm/s2, under the 64 lines of the sample but for `without`, `facts`, `changes`."""
    header = dict(line.split(":", 1) for line in shipped(SAMPLE).decode().splitlines()[:64])
    at = int(np.argmax(np.abs(values)))
    header |= {
        "SAMPLING_INTERVAL_S": f"{dt:.6f}",
        "NDATA": f"{len(values)}",
        "DURATION_S": f"{len(values) * dt:.3f}",
        "PGA_CM/S^2": f"{values[at]:.6f}",
        "TIME_PGA_S": f"{at * dt:.6f}",
    }
    header |= {key: str(value) for key, value in {**facts, **changes}.items()}
    lines = [f"{key}: {value.strip()}" for key, value in header.items() if key not in without]
    return ("\n".join([*lines, *(f"{value:.6f}" for value in values)]) + "\n").encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels in the manner of ESM, the first again in those of AFAD, before TADAS and since."""
    series = [100.0 * channel.acceleration for channel in channels]
    streams = zip(("HNE", "HNN", "HNZ"), series, strict=True)
    afad = {
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "06/07/2019 03:19:58.000",
        "DATE_TIME_FIRST_SAMPLE_PRECISION": "millisecond",
        "EVENT_DATE_YYYYMMDD": "2019/07/06",
        "EVENT_TIME_HHMMSS": "03:19:53.04",
        "STATION_NAME": "",
        "LOCATION": "CHINA_LAKE",
        "DATA_TYPE": "Acceleration",
    }
    corrected = afad | CORRECTED | dict.fromkeys(("LOW_CUT_FREQUENCY_HZ", "HIGH_CUT_FREQUENCY_HZ"), "")
    corrected["LOCATION"] = "RIDGECREST"
    return {
        **{SAMPLE.replace("HNE", stream): dyna(one, facts={}, STREAM=stream) for stream, one in streams},
        "20190706031958_CLC_RawAcc_E.asc": dyna(series[0], facts=afad),
        "20190706031958_CLC_ap_AAD_Acc_E.asc": TADAS.encode() + dyna(series[0], facts=corrected),
    }
