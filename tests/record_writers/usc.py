"""USC volumes 1 and 2."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, azimuth_code, peak_time, rows
from record_writers.csmip_v2 import correction_lines, fortran, integral, number_lines
from rockpulse.record.record import Record


def _text(count, duration, component, station, note, moment, site, square=0.211) -> list[str]:
    return [
        "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:",
        "TEST EARTHQUAKE",
        moment,
        "IBB102  94.170.0 N",
        f"STATION USC# {site}",
        station,
        f"COMP {component}",
        f"{note}   {moment}",
        "EPICENTER -   35 46 12N, 117 35 56W",
        "INSTR PERIOD =  .037 SEC  DAMPING =   .568  SENSITIVITY =   1.69CM/G",
        f"NO. OF POINTS ={count:7d}      DURATION ={duration:8.3f} SEC",
        "UNITS ARE SEC AND G/10",
        f"RMS ACCLN. OF COMPLETE RECORD = {fortran(square, 8)} G/10",
    ]


def usc_v1(
    times: Sequence[float],
    values: Sequence[float],
    component: str = "S05W",
    station: str = "8510 SOME AVENUE, LOS ANGELES, CA",
    note: str = "TEST EARTHQUAKE",
    moment: str = "JAN 17, 1994 -1230 GMT",
    site: str = "0017   34 06 52N, 118 22 47W",
    end: str = "\r\n",
) -> bytes:
    """One channel: pairs of time [s] and acceleration [g/10], a blank and ten fields of 7 characters in a row."""
    square = float(np.sqrt(np.mean(np.square(values))))
    text = _text(len(values), times[-1], component, station, note, moment, site, square)
    fields = [fortran(number, 7) for pair in zip(times, values, strict=True) for number in pair]
    lines = [
        *(f"{line:<72}{len(line):<8d}" for line in text),
        *rows([*["    0"] * 26, f"{azimuth_code(component):5d}{len(values):5d}", *["    0"] * 72], 16),
        *rows([*["      .000"] * 2, fortran(times[-1]), *["      .000"] * 47], 8),
        *(f" {row}" for row in rows(fields, 10)),
    ]
    return (end.join(lines) + end).encode("latin-1")


def usc_v2(
    values: Sequence[float],
    dt: float = 0.02,
    blocks: str = "avd",
    component: str = "S58W",
    station: str = "2161 SOME VIEW, PALOS VERDES ESTATES, CA",
    peak_unit: str = "CMS/SEC/SEC",
    note: str = "TEST EARTHQUAKE",
    moment: str = "JAN 17, 1994 -1230 GMT",
    site: str = "0017   34 06 52N, 118 22 47W",
) -> bytes:
    """One channel: acceleration [cm/s2] and what it integrates to; `blocks` says which of the three are written."""
    acceleration = np.asarray(values, dtype=float)
    velocity = integral(acceleration, dt)
    series = (acceleration, velocity, integral(velocity, dt))
    text = _text(len(acceleration), (len(acceleration) - 1) * dt, component, station, note, moment, site)
    title = f"CORRECTED ACCELEROGRAM  IIBA338  87.420.0 COMP {component:<7}FILE   0  CORRESPONDING T"
    correction = correction_lines(
        series,
        dt,
        "  INSTRUMENT AND BASELINE CORRECTED DATA",
        "ACCELEROGRAM IS BAND-PASS FILTERED BETWEEN  .600-1.100 AND 25.00-27.00 CYC/SEC.",
        (peak_unit, "CMS/SEC", "CMS"),
    )
    closing = [
        f"{note}   {moment}",
        "MAGNITUDE =  5.9    EPICENTRAL DISTANCE =  44.15 KM    M.M.I. =  0.",
        f"IIBA338  87.420.0   {station}    COMP {component}",
        "",
    ]
    lines = [title, *(f"{line:<72}{len(line):<3d}VOL1" for line in text), *correction, *closing]
    peaks = [float(one[np.argmax(np.abs(one))]) for one in series]
    lines += number_lines(len(acceleration), dt, peaks, [peak_time(one, dt) for one in series], component)
    for kind, one in zip(("ACC", "VEL", "DISP"), series, strict=True):
        if kind[0].lower() in blocks:
            lines.append(f"{len(one):6d} POINTS OF {kind} DATA EQUALLY SPACED AT {fortran(dt, 6)} SEC.")
            lines += rows([fortran(sample) for sample in one], 8)
    return ("\n".join(f"{line:<80}" for line in lines) + "\n").encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """One channel of each volume."""
    east, north, _ = channels
    common = {
        "station": "CHINA LAKE",
        "note": NOTE,
        "moment": "JUL 06, 2019 -0319 GMT",
        "site": "0000   35 48 57N, 117 35 53W",
    }
    tenths = north.acceleration / 0.980665
    return {
        "clc_usc.v1": usc_v1(north.time, tenths, component="N00E", **common),
        "clc_usc.v2": usc_v2(100.0 * east.acceleration, east.dt, component="N90E", **common),
    }
