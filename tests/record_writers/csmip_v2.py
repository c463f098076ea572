"""CSMIP volume 2: the layout since about 1990, whose headings name a Fortran format, and that of 1983."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, azimuth_code, peak_time, rows
from rockpulse.record.record import Record


def fortran(value: float, width: int = 10, decimals: int = 3) -> str:
    """A number in Fw.d, without the zero in front of the point."""
    text = f"{value:.{decimals}f}"
    text = text.replace("-0.", "-.") if text.startswith("-0.") else text.removeprefix("0")
    return (text if float(text) else text.lstrip("-")).rjust(width)


def integral(values: np.ndarray, dt: float) -> np.ndarray:
    """From 0, of values that are linear in between."""
    return np.concatenate([[0.0], np.cumsum(0.5 * dt * (values[1:] + values[:-1]))])


def number_lines(count: int, dt: float, peaks: Sequence[float], times: Sequence[float], component: str) -> list[str]:
    """100 integers and 100 reals, nearly all zero."""
    integers, reals = [0] * 100, [0.0] * 100
    integers[26] = azimuth_code(component)
    integers[52], integers[63], integers[65] = count, count, count
    reals[59], reals[60] = (count - 1) * dt, dt
    reals[64], reals[66], reals[68] = times
    reals[65], reals[67], reals[69] = peaks
    return rows([f"{number:5d}" for number in integers], 16) + rows([fortran(number) for number in reals], 8)


def correction_lines(series: Sequence[np.ndarray], dt: float, count: str, band: str, units: Sequence[str]) -> list[str]:
    """Filter, count, interval, peaks and initial values of acceleration, velocity and displacement."""
    at = [int(np.argmax(np.abs(values))) for values in series]
    peaks = [f"{values[index]:10.3f}" for values, index in zip(series, at, strict=True)]
    times = [fortran(index * dt, 9) for index in at]
    return [
        band,
        f"{len(series[0]):6d}{count}",
        f"AT EQUALLY-SPACED INTERVALS OF {fortran(dt, 7)}  SEC.",
        f"PEAK ACCELERATION ={peaks[0]}    {units[0]}  AT{times[0]}   SEC.",
        f"PEAK   VELOCITY   ={peaks[1]}      {units[1]}    AT{times[1]}   SEC.",
        f"PEAK DISPLACEMENT ={peaks[2]}        {units[2]}      AT{times[2]}   SEC.",
        f"INITIAL VELOCITY  =      .000   {units[1]};   INITIAL DISPLACEMENT =     .000   {units[2]}",
    ]


#: Behind the count of points and the interval [s]: as now and as in 1983.
NEW = " points of {kind} data equally spaced at {dt} sec, in {unit}. (8f10.{decimals})"
OLD = " POINTS OF {kind} DATA EQUALLY SPACED AT {dt} SEC.  (UNITS: {unit})"
_UNITS = {NEW: ("cm/sec2", "cm/sec", "cm"), OLD: ("CM/SEC/SEC", "CM/SEC", "CM")}


def csmip_v2(
    values, dt=0.01, heading=NEW, decimals=5, blocks="avd", number=1, component=" 90 DEG", end="\r\n"
) -> bytes:
    """One channel: acceleration [cm/s2] and what it integrates to; `blocks` says which of the three are written."""
    acceleration = np.asarray(values, dtype=float)
    velocity = integral(acceleration, dt)
    series = (acceleration, velocity, integral(velocity, dt))
    channel = f"CHAN {number:2d}: {component}"
    text = [
        f"CORRECTED ACCELEROGRAM   00000-L2866-14236.52       {channel:<22} FROM",
        "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 08/24/14",
        NOTE,
        f"{NOTE[:40]:<40}(ORIGIN:  TO BE DETERMINED)",
        "00000-L2866-14236.52                 START TIME:  07/06/19, 03:19:58.0 UTC",
        "STATION NO. 00000   35.816N, 117.598W    ETNA    S/N 2866  (3 CHNS OF  3 AT STA)",
        f"{'CHINA LAKE':<42}CGS   DATA: ACCELERATION",
        channel,
        NOTE,
        "HYPOCENTER:  TO BE DETERMINED.",
        "INSTR PERIOD =  .0102 SEC,  DAMPING =  .640,  SENSITIVITY =  .62 V/G",
        f"                        RECORD LENGTH ={fortran((len(acceleration) - 1) * dt, 7)} SEC.",
        "                                     UNCOR MAX  =        G, AT         SEC",
        "RMS ACCEL OF (UNCOR) RECORD  =  .000 G.",
        *correction_lines(
            series,
            dt,
            " POINTS OF INSTRUMENT- AND BASELINE-CORRECTED ACCEL, VELOC AND DISPL DATA",
            "ACCELEROGRAM BANDPASS FILTERED WITH RAMPS AT  .050- .100 AND 23.00-25.00 CYC/SEC",
            _UNITS[OLD],
        ),
        NOTE,
        "",
        f"00000-L2866-14236.52      CHINA LAKE   {channel}",
        "",
    ]
    peaks = [float(one[np.argmax(np.abs(one))]) for one in series]
    times = [peak_time(one, dt) for one in series]
    lines = [f"{line:<80}" for line in text] + number_lines(len(acceleration), dt, peaks, times, component)
    units = _UNITS.get(heading, _UNITS[NEW])
    for kind, unit, one in zip(("accel", "veloc", "displ"), units, series, strict=True):
        if kind[0] in blocks:
            words = heading.format(
                kind=kind.upper() if heading is OLD else kind, dt=fortran(dt, 5), unit=unit, decimals=decimals
            )
            lines += [f"{len(one):6d}{words}", *rows([fortran(sample, 10, decimals) for sample in one], 8)]
    lines.append(f"/&  ----------  END OF DATA FOR CHANNEL {number:2d}  ----------")
    return (end.join(lines) + end).encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """One channel of either layout; three blocks of three channels would be too large."""
    east, _, up = channels
    old = csmip_v2(100.0 * up.acceleration, heading=OLD, decimals=3, number=3, component="UP")
    return {"clc_90.v2": csmip_v2(100.0 * east.acceleration), "clc_up_1983.v2": old}
