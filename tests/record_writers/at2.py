"""PEER AT2."""

from collections.abc import Sequence

from record_writers._shared import NOTE, rows
from rockpulse.record.record import STANDARD_GRAVITY, Record


def at2(
    values: Sequence[float],
    count_line: str = "NPTS= {n:6d}, DT= {dt:.4f} SEC,",
    dt: float = 0.01,
    field: str = "{:15.7E}",
    per_row: int = 5,
    series: str = "ACCELERATION TIME SERIES IN UNITS OF G",
    title: str = "Somewhere, 1/2/2003, Station One, 090",
    end: str = "\n",
    first_line: str = "PEER NGA STRONG MOTION DATABASE RECORD",
) -> bytes:
    head = [first_line, title, series, count_line.format(n=len(values), dt=dt)]
    return (end.join(head + rows([field.format(value) for value in values], per_row)) + end).encode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """NGA-West2 layout, the older one with 8F10.5 on CRLF lines, and one value to a line."""
    east, north, up = (channel.acceleration / STANDARD_GRAVITY for channel in channels)
    title = "Ridgecrest, 07/06/2019, China Lake"
    return {
        "CLC090.AT2": at2(east, first_line=NOTE, title=f"{title}, 90"),
        "CLC360.AT2": at2(
            north,
            "{n:4d}    {dt:.4f}    NPTS, DT",
            field="{:10.5f}",
            per_row=8,
            series="ACCELERATION TIME HISTORY IN UNITS OF G",
            title=f"{title}, 360 (CLC)",
            end="\r\n",
            first_line=NOTE,
        ),
        "CLC-UP.AT2": at2(up, field="  {:.8f}", per_row=1, title=f"{title}, UP", first_line=NOTE),
    }
