"""COSMOS 1.20."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.record.record import STANDARD_GRAVITY, Record

NULL = -999
_START = datetime(2018, 8, 29, 2, 33, 7, 250000, tzinfo=UTC)


def series(
    values: Sequence[float],
    dt: float = 0.005,
    what: str = "acceleration",
    unit: str = "g.",
    code: str = "(02)",
    layout: str = "(8f9.6)",
    field: str = "{:9.6f}",
    per_row: int = 8,
    count: int | None = None,
) -> list[str]:
    """A heading and its rows."""
    number = len(values) if count is None else count
    heading = f"{number:8d} {what} pts, approx {number * dt:3.0f} secs, units={unit:<7}{code}Format={layout}"
    return [f"{heading:<80}", *(f"{row:<80}" for row in rows([field.format(value) for value in values], per_row))]


def cosmos(
    values: Sequence[float],
    kind: str = "Uncorrected acceleration",
    number: int = 1,
    component: str = "360 deg",
    azimuth: int = 360,
    place: str = "",
    site: int = 4,
    dt: float = 0.005,
    start: datetime = _START,
    event: str = "Rcrd of Tue Aug 28, 2018 19:33:00.0 PDT",
    station_code: str = "CE-23837",
    station: str = "Pomona - Orange Grove & Fairplex",
    unknown: str = "   -999, -999.0",
    comments: Sequence[str] = ("<SCNL>23837.HNN.CE.--   <AUTH>CE 2018/08/29 14:56:15 PDT",),
    integers: Mapping[int, int] = {},
    reals: Mapping[int, float] = {},
    wide_reals: bool = False,
    sections: Sequence[Sequence[str]] | None = None,
    close: str = "End-of-data for Chan {:2d} acceleration",
    end: str = "\r\n",
    **how: object,
) -> bytes:
    """One channel; `integers` and `reals` are numbered from 1, `how` goes to `series`."""
    across, width = (5, 15) if wide_reals else (6, 13)
    whole, part = [NULL] * 100, [float(NULL)] * 100
    peak = int(np.argmax(np.abs(values)))
    data = [series(values, dt, **how)] if sections is None else sections
    peak_unit = data[0][0].partition("units=")[2].partition("(")[0].strip(" .") if data else "g"
    for given, target in (
        ({1: 1, 2: 1, 3: 2, 4: 120, 8: 23837, 11: 5, 19: site, 40: start.year, 41: 241, 42: start.month}, whole),
        ({43: start.day, 44: start.hour, 45: start.minute, 46: 5, 50: number, 54: azimuth}, whole),
        ({1: 35.81574, 2: -117.59751, 30: start.second + 1e-6 * start.microsecond, 32: -8.0, 34: dt}, part),
        ({62: 1e3 * dt, 63: len(values) * dt, 64: values[peak], 65: peak * dt}, part),
        (integers, whole),
        (reals, part),
    ):
        for index, value in given.items():
            target[index - 1] = value
    text = [
        f"{kind:<25} (Format v01.20 with 13 text lines) Src: test",
        event,
        "Hypocenter: To be determined    H=   km       ML=     Mw=",
        "Origin: To be determined",
        f"Statn No: 05- 23837 Code:{station_code:<9} CGS  {station}",
        "Coords: 35.816  -117.598   Site geology:",
        "Recorder: Etna   s/n 1193 ( 3 Chns of   3 at Sta) Sensor: FBA",
        f"Rcrd start time: {start.month}/{start.day}/{start.year}, {start:%H:%M}:{start.second:5.2f} UTC (Q=5)",
        f"Sta Chan {number:2d}: {component} (Rcrdr Chan {number:2d})" + (f" Location: {place}" if place else ""),
        f"Raw record length ={len(values) * dt:8.3f} sec, Uncor max ={values[peak]:8.3f} {peak_unit}, "
        f"at {peak * dt:8.3f} sec.",
        f"Processed:                         CGS . Max ={values[peak]:9.3f} {peak_unit:<7} at {peak * dt:8.3f} sec",
        "Record not filtered.",
        f"Values used when parameter or data value is unknown/unspecified:{unknown}",
        " 100 Integer-header values follow on  10 lines, Format= (10I8)",
        *rows([f"{number:8d}" for number in whole], 10),
        f" 100 Real-header values follow on  {-(-100 // across)} lines, Format= ({across}F{width}.6)",
        *rows([f"{number:{width}.6f}" for number in part], across),
        f'{len(comments):4d} Comment line(s) follow, each starting with a "|":',
        *(f"|{comment}" for comment in comments),
    ]
    lines = [*(f"{line:<80}" for line in text), *(line for section in data for line in section), close.format(number)]
    return (end.join(lines) + end).encode("latin-1")


def counts(values: Sequence[int], reals: Mapping[int, float] = {}, **how: object) -> bytes:
    """Volume 0 with every factor of the gain: 0.298024 microvolts per count, 1.25 V/g."""
    gain = {22: 0.298024, 42: 1.25, 43: 2.5, 44: 2.0, 47: 1.0}
    section = series(values, how.get("dt", 0.005), "raw accel.  ", " counts", "(50),", "(10I8)", "{:8d}", 10)
    given = {"kind": "Raw acceleration counts", "wide_reals": True, "integers": {52: 20}, "sections": [section]} | how
    return cosmos(values, reals=gain | dict(reals), **given)


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Volume 1 with three channels, volume 2 with velocity and displacement, volume 0 with a gain."""
    start = channels[0].start_time
    common = {"start": start, "event": NOTE, "station_code": "CI-CLC", "station": "China Lake", "dt": 0.01}
    directions = (("90 deg", 90, "HNE"), ("360 deg", 360, "HNN"), (" Up    ", 400, "HNZ"))
    volume1 = b"".join(
        cosmos(
            channel.acceleration / STANDARD_GRAVITY,
            number=number,
            component=component,
            azimuth=azimuth,
            comments=(f"<SCNL>CLC.{code}.CI.--", NOTE),
            **common,
        )
        for number, (channel, (component, azimuth, code)) in enumerate(zip(channels, directions, strict=True), start=1)
    )
    east = 100.0 * channels[0].acceleration
    velocity = 0.01 * np.cumsum(east)
    displacement = 0.01 * np.cumsum(velocity - velocity.mean())
    names = (
        ("acceleration", "cm/sec2", "(04),", east),
        ("velocity", "cm/sec", "(05),", velocity),
        ("displacement", "cm", "(06),", displacement),
    )
    sections = [series(v, 0.01, what, unit, code, "(8f10.4)", "{:10.4f}") for what, unit, code, v in names]
    comments = ("<SCNL>CLC.HNE.CI.--", NOTE)
    east_of = {"component": "90 deg", "azimuth": 90, "comments": comments, **common}
    volume2 = cosmos(east, kind="Corrected acceleration", sections=sections, **east_of)
    raw = np.round(channels[0].acceleration / STANDARD_GRAVITY * 1.25 / 0.298024e-6).astype(int)
    volume0 = counts(raw, **east_of)
    return {"clc_cosmos.V1C": volume1, "clc_cosmos.V2": volume2, "clc_cosmos.V0C": volume0}
