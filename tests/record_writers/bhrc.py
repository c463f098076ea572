"""BHRC volume 1 (Iran): three channels in g/10, ten numbers of 13 characters in a row."""

from collections.abc import Sequence

from record_writers._shared import NOTE, rows
from rockpulse.record.record import STANDARD_GRAVITY, Record


def exponent(value: float) -> str:
    """Fortran's E format, which begins with the point: .854257E-03."""
    mantissa, power = f"{value:.5E}".split("E")
    digits = mantissa.replace("-", "").replace(".", "")
    # 0.0 has no digit in front of which the point could move.
    shifted = 0 if float(mantissa) == 0.0 else int(power) + 1
    return f"{'-' if mantissa.startswith('-') else ''}.{digits}E{shifted:+03d}".rjust(13)


def bhrc(
    columns: Sequence[Sequence[float]],
    dt: float = 0.005,
    azimuths: str = "Azimuth L 352   T 82 ",
    note: str = "",
    station: str = "Ahar",
    unit: str = "UNITS ARE SECONDS AND G/10",
    count: int | None = None,
    rate: float | None = None,
) -> bytes:
    """The channels L, V and T, accelerations in g/10; `count` and `rate` are what the header declares."""
    lines: list[str] = []
    for number, (values, letter) in enumerate(zip(columns, "LVT", strict=False), start=1):
        points = len(values) if count is None else count
        integers = [0] * 27 + [points] + [0] * 72
        reals = [0.0188324, 0.64, points * dt, 0.0, 0.1, 0.0, 0.0, 0.0, rate or 1.0 / dt, *[0.0] * 41]
        lines += [
            "* VOL1DS FILE:  5520/01",
            "Inst Type = SSA-2",
            "Origin Time : 2019/07/06   03:19:53",
            "",
            letter,
            note.ljust(70),
            f"COMP {letter}{number}".ljust(70),
            f"{station:26s}Station   35.816 N 117.598 W   Altitude 1360m   {azimuths}",
            "Epicenter 35.770 N 117.599 W   FD 8 Km mb      Ms      Mw7.1   M        ML   (BHRC   )",
            "INSTR PERIOD =  .019 SEC   DAMPING =  .640".ljust(70),
            f"NO. OF POINTS = {points:6d}      DURATION ={points * dt:8.3f}".ljust(70),
            unit,
            " " * 70,
            # 16I5 and 8E13.6, cut after 70 characters, in the middle of a number.
            *[row[:70].ljust(70) for row in rows([f"{integer:5d}" for integer in integers], 16)],
            *[row[:70].ljust(70) for row in rows([exponent(real) for real in reals], 8)],
            *rows([exponent(value) for value in values], 10),
            "/&",
        ]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels."""
    east, north, up = (10.0 * channel.acceleration / STANDARD_GRAVITY for channel in channels)
    content = bhrc([east, up, north], channels[0].dt, "Azimuth L 90    T 360", NOTE, "CHINA LAKE")
    return {"clc_bhrc.V1": content}
