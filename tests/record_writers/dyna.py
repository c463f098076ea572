"""DYNA 1.2 (ESM, ITACA, AFAD): 64 lines ``KEY: value``, then one acceleration in cm/s2 on each line."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import Record

_ESM = """\
EVENT_NAME: GREECE
EVENT_ID: EMSC-20190728_0000106
EVENT_DATE_YYYYMMDD: 20190728
EVENT_TIME_HHMMSS: 160908
EVENT_LATITUDE_DEGREE: 38.1000
EVENT_LONGITUDE_DEGREE: 23.5400
EVENT_DEPTH_KM: 9.0
HYPOCENTER_REFERENCE: EMSC-CSEM
MAGNITUDE_W:
MAGNITUDE_W_REFERENCE:
MAGNITUDE_L: 4.6
MAGNITUDE_L_REFERENCE: EMSC-CSEM
FOCAL_MECHANISM:
NETWORK: HI
STATION_CODE: ARS1
STATION_NAME: Town Hall,Argos,Argolis,Peloponnese
STATION_LATITUDE_DEGREE: 37.634900
STATION_LONGITUDE_DEGREE: 22.729300
STATION_ELEVATION_M: 34
LOCATION:
SENSOR_DEPTH_M: 0.0
VS30_M/S:
SITE_CLASSIFICATION_EC8:
MORPHOLOGIC_CLASSIFICATION:
EPICENTRAL_DISTANCE_KM: 88.1
EARTHQUAKE_BACKAZIMUTH_DEGREE: 53.9
DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 20190728_160919.870
DATE_TIME_FIRST_SAMPLE_PRECISION: milliseconds
SAMPLING_INTERVAL_S: 0.005000
NDATA: 0
DURATION_S:
STREAM: HNE
UNITS: cm/s^2
INSTRUMENT: sensor = Unknown [Unknown] | digitizer = Unknown [Unknown]
INSTRUMENT_ANALOG/DIGITAL: D
INSTRUMENTAL_FREQUENCY_HZ:
INSTRUMENTAL_DAMPING:
FULL_SCALE_G:
N_BIT_DIGITAL_CONVERTER:
PGA_CM/S^2:
TIME_PGA_S:
BASELINE_CORRECTION: BASELINE NOT REMOVED
FILTER_TYPE:
FILTER_ORDER:
LOW_CUT_FREQUENCY_HZ:
HIGH_CUT_FREQUENCY_HZ:
LATE/NORMAL_TRIGGERED: NT
DATABASE_VERSION: DYNA 1.0
HEADER_FORMAT: DYNA 1.2
DATA_TYPE: ACCELERATION
PROCESSING: none
DATA_TIMESTAMP_YYYYMMDD_HHMMSS: 20190730_115604.782
DATA_LICENSE:
DATA_CITATION:
DATA_CREATOR:
ORIGINAL_DATA_MEDIATOR_CITATION:
ORIGINAL_DATA_MEDIATOR: http://eida.gein.noa.gr/
ORIGINAL_DATA_CREATOR_CITATION:
ORIGINAL_DATA_CREATOR:
USER1:
USER2:
USER3:
USER4:
USER5:
"""

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


def dyna(
    values: Sequence[float], dt: float = 0.01, end: str = "\n", without: Sequence[str] = (), **changes: object
) -> bytes:
    """One channel, accelerations in cm/s2, under a header of 64 lines, those of ESM but for `without` and `changes`."""
    header = dict(line.split(":", 1) for line in _ESM.splitlines())
    at = int(np.argmax(np.abs(values)))
    header |= {
        "SAMPLING_INTERVAL_S": f"{dt:.6f}",
        "NDATA": f"{len(values)}",
        "DURATION_S": f"{len(values) * dt:.3f}",
        "PGA_CM/S^2": f"{values[at]:.6f}",
        "TIME_PGA_S": f"{at * dt:.6f}",
    }
    header |= {key: str(value) for key, value in changes.items()}
    lines = [f"{key}: {value.strip()}" for key, value in header.items() if key not in without]
    return (end.join([*lines, *(f"{value:.6f}" for value in values)]) + end).encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels in the manner of ESM, the first again in those of AFAD, before TADAS and since."""
    moment = channels[0].start_time
    assert moment is not None
    files = {}
    for channel, stream in zip(channels, ("HNE", "HNN", "HNZ"), strict=True):
        common = {
            "EVENT_NAME": NOTE,
            "EVENT_ID": "38457511",
            "EVENT_LATITUDE_DEGREE": "35.7700",
            "EVENT_LONGITUDE_DEGREE": "-117.5990",
            "EVENT_DEPTH_KM": "8.0",
            "HYPOCENTER_REFERENCE": "USGS",
            "MAGNITUDE_W": "7.1",
            "MAGNITUDE_W_REFERENCE": "USGS",
            "MAGNITUDE_L": "",
            "MAGNITUDE_L_REFERENCE": "",
            "EPICENTRAL_DISTANCE_KM": "5.1",
            "STATION_LATITUDE_DEGREE": "35.815740",
            "STATION_LONGITUDE_DEGREE": "-117.597510",
            "NETWORK": "CI",
            "STATION_CODE": "CLC",
            "STATION_NAME": "China Lake",
            "STREAM": stream,
            "EVENT_DATE_YYYYMMDD": f"{moment:%Y%m%d}",
            "EVENT_TIME_HHMMSS": "031953",
        }
        values = 100.0 * channel.acceleration
        first = f"{moment:%Y%m%d_%H%M%S}.{moment.microsecond // 1000:03d}"
        files[f"CI.CLC..{stream}.D.{moment:%Y%m%d.%H%M%S}.X.ACC.ASC"] = dyna(
            values, channel.dt, **common, DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS=first
        )
        afad = {
            "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": f"{moment:%d/%m/%Y %H:%M:%S}.{moment.microsecond // 1000:03d}",
            "DATE_TIME_FIRST_SAMPLE_PRECISION": "millisecond",
            "EVENT_DATE_YYYYMMDD": f"{moment:%Y/%m/%d}",
            "EVENT_TIME_HHMMSS": "03:19:53.04",
            "STATION_NAME": "",
            "LOCATION": "CHINA_LAKE",
            "DATA_TYPE": "Acceleration",
        }
        files.setdefault(f"{moment:%Y%m%d%H%M%S}_CLC_RawAcc_E.asc", dyna(values, channel.dt, **common | afad))
        corrected = CORRECTED | {"LOW_CUT_FREQUENCY_HZ": "", "HIGH_CUT_FREQUENCY_HZ": "", "LOCATION": "RIDGECREST"}
        files.setdefault(
            f"{moment:%Y%m%d%H%M%S}_CLC_ap_AAD_Acc_E.asc",
            TADAS.encode() + dyna(values, channel.dt, **common | afad | corrected),
        )
    return files
