"""Small format-faithful record files, written from numbers that the tests choose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def pulse(count: int = 400, peak: float = 0.3, dt: float = 0.01) -> np.ndarray:
    """(count,) A decaying 2 Hz sine with the given largest absolute value, in whatever unit the caller means."""
    time = dt * np.arange(count)
    wave = np.exp(-time) * np.sin(4.0 * np.pi * time)
    return peak * wave / np.max(np.abs(wave))


def rows(fields: Sequence[str], per_row: int) -> list[str]:
    return ["".join(fields[start : start + per_row]) for start in range(0, len(fields), per_row)]


def at2(
    values: Sequence[float],
    count_line: str = "NPTS= {n:6d}, DT= {dt:.4f} SEC,",
    dt: float = 0.01,
    field: str = "{:15.7E}",
    per_row: int = 5,
    series: str = "ACCELERATION TIME SERIES IN UNITS OF G",
    title: str = "Somewhere, 1/2/2003, Station One, 090",
    end: str = "\n",
) -> bytes:
    head = ["PEER NGA STRONG MOTION DATABASE RECORD", title, series, count_line.format(n=len(values), dt=dt)]
    return (end.join(head + rows([field.format(value) for value in values], per_row)) + end).encode()


def _csmip_header(number: int, component: str, place: str, count: int, unit_line: str, start: str) -> list[str]:
    location = f"  (STA CHN: {number:2d})     LOCATION: {place}" if place else ""
    return [
        "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 02/08/94, TEST",
        "TEST EARTHQUAKE",
        "JANUARY 17, 1994 04:31 PST",
        f"14403-S3492-94021.02               TRIGGER TIME: {start}",
        "STATION NO. 14403   33.929N, 118.260W     SMA-1  S/N 3492",
        "TEST STATION",
        f"CHAN {number:2d}: {component}{location}",
        "TEST EARTHQUAKE     JANUARY 17, 1994 04:31 PST",
        "HYPOCENTER: 34.215N, 118.538W, H=18KM.",
        "INSTR PERIOD =  .0397 SEC,  DAMPING =  .592,  SENSITIVITY = 1.77 CM/G.",
        f"NO. OF POINTS = {count:6d}  RECORD LENGTH = 59.998 SEC",
        unit_line,
        "RMS ACCEL OF COMPLETE RECORD =  .021 G.",
        *["    0" * 16] * 6,
        "    0" * 4,
        *["      .000" * 8] * 6,
        "      .000" * 2,
    ]


def csmip_pairs(
    times: Sequence[float],
    values: Sequence[float],
    number: int = 1,
    component: str = " 90 DEG",
    place: str = "",
    unit: str = "SEC AND G/10",
    peak_g: float | None = None,
    start: str = "01/17/94, 12:31:04.1 UTC",
    end: str = "\r\n",
) -> bytes:
    """One channel in the old layout: (time, acceleration in g/10) pairs of width 7."""
    peak = np.max(np.abs(values)) / 10.0 if peak_g is None else peak_g
    unit_line = f"UNITS OF UNCOR ACCEL ARE {unit}.     MAX  =  {peak:5.3f} G, AT   1.000 SEC."
    fields = [f"{number:7.3f}" for pair in zip(times, values, strict=True) for number in pair]
    lines = _csmip_header(number, component, place, len(values), unit_line, start) + rows(fields, 10)
    lines.append(f"/&  ----------  END OF DATA FOR CHANNEL {number:2d}  ----------")
    return (end.join(lines) + end).encode("latin-1")


def csmip_equal(
    values: Sequence[float],
    heading: str = "{n:6d} Accelerogram points at 100 pts/sec in units of g.       Format: (8f9.6)",
    field: str = "{:9.6f}",
    number: int = 1,
    component: str = " 90 DEG",
    place: str = "",
    peak_g: float | None = None,
    start: str = "7/06/19, 03:16: 8.5 UTC (GPS)",
    end: str = "\r\n",
) -> bytes:
    """One channel in the new layout: equal steps, in g unless the heading says otherwise."""
    peak = np.max(np.abs(values)) if peak_g is None else peak_g
    unit_line = f"UNITS OF UNCOR DATA ARE SEC AND G.         MAX  = {peak:6.3f} G, AT   1.000 SEC."
    lines = _csmip_header(number, component, place, len(values), unit_line, start)
    lines += [heading.format(n=len(values)), *rows([field.format(value) for value in values], 8)]
    lines.append(f"/&  ----------  END OF DATA FOR CHANNEL {number:2d}  ----------")
    return (end.join(lines) + end).encode("latin-1")


def _smc_field(value: float) -> str:
    mantissa, exponent = f"{value if abs(value) > 1e-9 else 0.0:.4E}".split("E")
    return f"{mantissa}E{int(exponent):+d}".rjust(10)


def smc(
    values: Sequence[float],
    kind: str = "2 CORRECTED ACCELEROGRAM",
    rate: float | None = 100.0,
    station: str = "CA: Somewhere; Fire Station",
    component: str = "360",
    azimuth: int = 360,
    vertical: int = -32768,
    count: int | None = None,
    moment: Sequence[int] = (2011, 235, 17, 50, 56, 250),
    end: str = "\n",
) -> bytes:
    null, null_real = -32768, 1.7e38
    integers = [null] * 48
    integers[1:7] = moment
    integers[12], integers[13], integers[15] = vertical, azimuth, 2
    integers[16] = len(values) if count is None else count
    integers[29] = 2555
    reals = [null_real] * 50
    reals[1] = null_real if rate is None else rate
    accelerations = values if rate is not None else values[1::2]
    lines = [
        kind,
        "*",
        "2555b",
        "     2011  08  23    1751 TEST EARTHQUAKE",
        "Moment Mag= 5.80     Ms=          Ml=",
        f"station = {station}   component= {component}",
        f"epicentral dist =    121.4       pk acc =  {np.max(np.abs(accelerations)):.2E}",
        "inst type=K2         data source = USGS",
        *"***",
        *rows([f"{number:10d}" for number in integers], 8),
        *rows([f"{number:15.7E}" for number in reals], 5),
        "|",
        "| written by a test",
        *rows([_smc_field(value) for value in values], 8),
    ]
    return (end.join(lines) + end).encode()


def knet(
    counts: Sequence[int],
    scale: str = "2000(gal)/8388608",
    peak_gal: float = 0.0,
    direction: str = "E-W",
    end: str = "\n",
) -> bytes:
    lines = [
        "Origin Time       1996/08/11 03:12:00",
        "Lat.              38.920",
        "Long.             140.630",
        "Depth. (km)       7",
        "Mag.              5.9",
        "Station Code      AKT013",
        "Station Lat.      39.6069",
        "Station Long.     140.3213",
        "Station Height(m) 34",
        "Record Time       1996/08/11 03:12:39",
        "Sampling Freq(Hz) 100Hz",
        f"Duration Time(s)  {len(counts) / 100:g}",
        f"Dir.              {direction}",
        f"Scale Factor      {scale}",
        f"Max. Acc. (gal)   {peak_gal:.3f}",
        "Last Correction   1996/08/11 03:00:00",
        "Memo.",
        *rows([f"{count:8d} " for count in counts], 8),
    ]
    return (end.join(lines) + end).encode()
