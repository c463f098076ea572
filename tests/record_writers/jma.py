"""Acceleration files of JMA (CSV)."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import Record


def jma(
    columns: Sequence[Sequence[float]],
    start: str = "2024 01 01 16 10 10",
    rate: str = "100Hz",
    unit: str = "gal(cm/s/s)",
    names: str = "NS,EW,UD",
    code: str = "E0001",
    name: str = "輪島市鳳至町",
    place: tuple[float, float] = (37.3906, 136.8953),
) -> bytes:
    lines = [
        f"SITE CODE= {code}{name}          ,{place[0]:.1f},{place[1]:.1f}, 10.0,5.0",
        f" LAT.=   {place[0]:.4f}",
        f" LON.=  {place[1]:.4f}",
        f" SAMPLING RATE= {rate}",
        f" UNIT  = {unit}",
        f"INITIAL TIME = {start}",
        f" {names}",
        *(",".join(f"{value:.3f}" for value in row) for row in np.transpose(columns)),
    ]
    return ("\r\n".join(lines) + "\r\n").encode("shift-jis")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Times of Japan to the second; the name says what the file is."""
    east, north, up = channels
    columns = [100.0 * channel.acceleration for channel in (north, east, up)]
    return {
        "clc_jma.csv": jma(columns, start="2019 07 06 12 19 58", code="CLC ", name=NOTE, place=(35.8157, -117.5975))
    }
