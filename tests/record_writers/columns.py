"""Columns of numbers: what spreadsheets, DEEPSOIL and analysis programs write."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import STANDARD_GRAVITY, Record

#: What the files do not say.
OPTIONS = {
    "clc_end_data.txt": {},  # states all, but obspy asks for the name of the format
    "clc_one_column.txt": {"units": "g", "dt": 0.01},
    "clc_deepsoil.txt": {"units": "g"},
    "clc_three_channels.csv": {"units": "cm/s2"},
    "clc_decimal_commas.csv": {"units": "m/s2"},
    "clc_tabs.txt": {"units": "g"},
    "clc_rows.g3": {"units": "g", "dt": 0.01},
}


def columns(
    values: np.ndarray, header: str = "", separator: str = " ", field: str = "{:.6f}", end: str = "\n"
) -> bytes:
    """Rows of a (n, columns) table."""
    rows = (separator.join(field.format(value) for value in row) for row in values)
    return (header + end.join(rows) + end).encode()


def table(*series: np.ndarray, header: str = "", delimiter: str = " ", number: str = "{:.6f}", end: str = "\n") -> str:
    """The text of a table whose columns are some series."""
    return columns(np.column_stack(series), header, delimiter, number, end).decode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """One column, DEEPSOIL, commas with headings, semicolons with decimal commas, tabs, series wrapped into rows."""
    east, north, up = (channel.acceleration for channel in channels)
    time = channels[0].time
    gal = 100.0 * np.column_stack([east, north, up])
    commas = columns(np.column_stack([time, north]), separator=";", field="{:.5f}", end="\r\n").replace(b".", b",")
    return {
        "clc_one_column.txt": columns(east[:, None] / STANDARD_GRAVITY, f"# {NOTE}\n", field="{:.8f}"),
        "clc_deepsoil.txt": columns(
            np.column_stack([time, east / STANDARD_GRAVITY]), f"{NOTE}\n{time.size} 0.01\n", field="{:.6E}"
        ),
        "clc_three_channels.csv": columns(
            np.column_stack([time, gal]),
            f"{NOTE}\ntime [s],acc E [cm/s2],acc N [cm/s2],acc Z [cm/s2]\n",
            separator=",",
            field="{:.4f}",
        ),
        "clc_decimal_commas.csv": f"{NOTE}\r\nZeit (s);Beschleunigung N\r\n".encode() + commas,
        # Rows of five without a word, as the examples of OpenSees have them; words around the numbers.
        "clc_rows.g3": wrapped(north / STANDARD_GRAVITY, 5, field="{:15.7E}"),
        "clc_end_data.txt": wrapped(
            east / STANDARD_GRAVITY,
            8,
            f"{NOTE}\n{east.size} points at equal spacing of 0.01 sec\n"
            "Points are listed in the format of 8F10.5, 8 points across in a row\nThe units are (g)\n\n"
            "*** Begin data ***\n",
            field="{:9.5f}",
        )
        + b"*** End data ***\n",
        "clc_tabs.txt": columns(np.column_stack([time, up / STANDARD_GRAVITY]), f"# {NOTE}\n# t\tup\n", separator="\t"),
    }


def wrapped(values: np.ndarray, per_row: int, header: str = "", field: str = "{:9.6f}") -> bytes:
    """One series, several values in a row."""
    rows = (values[at : at + per_row] for at in range(0, len(values), per_row))
    return (header + "".join(" ".join(field.format(value) for value in row) + "\n" for row in rows)).encode()
