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


def columns(values: np.ndarray, header="", separator=" ", field="{:.6f}", end="\n") -> bytes:
    """Rows of a (n, columns) table."""
    rows = (separator.join(field.format(value) for value in row) for row in values)
    return (header + end.join(rows) + end).encode()


def table(*series: np.ndarray, header: str = "", delimiter: str = " ", number: str = "{:.6f}", end: str = "\n") -> str:
    """The text of a table whose columns are some series."""
    return columns(np.column_stack(series), header, delimiter, number, end).decode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """One column, DEEPSOIL, commas with headings, semicolons with decimal commas, tabs, series wrapped into rows."""
    east, north, up = (channel.acceleration for channel in channels)
    of_g = [channel.acceleration / STANDARD_GRAVITY for channel in channels]
    time, cm = channels[0].time, [100.0 * values for values in (east, north, up)]
    heads = f"{NOTE}\ntime [s],acc E [cm/s2],acc N [cm/s2],acc Z [cm/s2]\n"
    rows = "Points are listed in the format of 8F10.5, 8 points across in a row\nThe units are (g)\n\n"
    words = f"{NOTE}\n{east.size} points at equal spacing of 0.01 sec\n{rows}*** Begin data ***\n"
    commas = table(time, north, delimiter=";", number="{:.5f}", end="\r\n").replace(".", ",")
    files = {
        "clc_one_column.txt": table(of_g[0], header=f"# {NOTE}\n", number="{:.8f}"),
        "clc_deepsoil.txt": table(time, of_g[0], header=f"{NOTE}\n{time.size} 0.01\n", number="{:.6E}"),
        "clc_three_channels.csv": table(time, *cm, header=heads, delimiter=",", number="{:.4f}"),
        "clc_decimal_commas.csv": f"{NOTE}\r\nZeit (s);Beschleunigung N\r\n{commas}",
        # Rows of five without a word, as the examples of OpenSees have them; words around the numbers.
        "clc_rows.g3": wrapped(of_g[1], 5, field="{:15.7E}"),
        "clc_end_data.txt": wrapped(of_g[0], 8, words, "{:9.5f}") + b"*** End data ***\n",
        "clc_tabs.txt": table(time, of_g[2], header=f"# {NOTE}\n# t\tup\n", delimiter="\t"),
    }
    return {name: text if isinstance(text, bytes) else text.encode() for name, text in files.items()}


def wrapped(values: np.ndarray, per_row: int, header: str = "", field: str = "{:9.6f}") -> bytes:
    """One series, several values in a row."""
    rows = (values[at : at + per_row] for at in range(0, len(values), per_row))
    return (header + "".join(" ".join(field.format(value) for value in row) + "\n" for row in rows)).encode()
