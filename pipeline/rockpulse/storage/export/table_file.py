"""Writes a long table to a CSV, Excel or Parquet file, with a README that describes its columns."""

from __future__ import annotations

import gzip
import shutil
from codecs import BOM_UTF8
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockpulse.errors import ResultsError
from rockpulse.files import FileSet, check_file
from rockpulse.foreign_text import escaped, not_a_formula
from rockpulse.storage.export.long_table import LongTable

if TYPE_CHECKING:
    import pandas as pd


#: Largest number of rows of a worksheet, including the headings.
SHEET_ROWS = 1_048_576
#: For each suffix of an Excel or Parquet file, the library that writes it; "rockpulse[tables]" installs both.
TYPED = {".xlsx": "openpyxl", ".parquet": "pyarrow"}


def write_typed(table: LongTable, part: Path, kind: str, seen: Callable[[pd.DataFrame], None]) -> None:
    """Write all rows to the Excel or Parquet file `part`; call `seen` with each data frame of rows."""
    import pandas as pd

    if kind == ".parquet":
        frame = table.frame()
        seen(frame)
        frame.to_parquet(part, index=False, engine="pyarrow")
        return
    if len(table) >= SHEET_ROWS:
        raise ResultsError(
            f"{len(table)} rows, but a sheet has at most {SHEET_ROWS - 1}: select fewer rows (--where, --limit), or "
            "choose a name that ends in .csv or .parquet"
        )
    with part.open("wb") as file, pd.ExcelWriter(file, engine="openpyxl") as writer:
        written = 0
        for frame in table.frames():
            seen(frame)
            shown = frame.map(lambda value: escaped(value) if isinstance(value, str) else value)
            shown.to_excel(writer, sheet_name=table.group[:31], index=False, header=not written, startrow=written)
            written += len(frame) + (not written)
        for cells in writer.sheets[table.group[:31]].iter_rows():
            for cell in cells:
                if cell.data_type == "f":
                    cell.data_type = "s"


#: Suffixes of CSV tables; the second is compressed.
SUFFIXES = (".csv", ".csv.gz", *TYPED)
#: Text that replaces each line break inside a string, and the pattern of line breaks.
LINE = " | "
LINE_ENDS = "\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"


def readme_of(path: Path) -> Path:
    """Return the path of the README of a table: table.csv.README.md for table.csv."""
    return path.with_name(f"{path.name}.README.md")


def check_table_target(path: str | Path, overwrite: bool = False) -> Path:
    """Return the path of a table to be written; raise ResultsError if the table or its README cannot be written."""
    if not Path(path).name.endswith(SUFFIXES):
        raise ResultsError(f"{path}: expected a name that ends in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    target = check_file(path, overwrite, SUFFIXES)
    library = TYPED.get(target.suffix)
    if library is not None and find_spec(library) is None:
        raise ResultsError(
            f"{path}: a table of this kind is written by {library}, which is not installed: "
            "pip install 'rockpulse[tables]', or choose a name that ends in .csv"
        )
    check_file(readme_of(target), overwrite, (".md",))
    return target


def write_table(
    table: LongTable,
    path: str | Path,
    about: str,
    overwrite: bool = False,
    on_rows: Callable[[int], object] | None = None,
    decimal_comma: bool = False,
    raw: bool = False,
) -> tuple[Path, Path]:
    """Write a table and its README, both or none, and return their paths; CSV files are written piece by piece.

    `about` states in the README where the table comes from. `on_rows` is called with the number of rows of each piece.
    `decimal_comma` selects semicolons, decimal commas and a byte order mark. With `raw`, only line breaks in strings
    are changed.
    """
    target = check_table_target(path, overwrite)
    readme = readme_of(target)
    empty = {column.name: 0 for column in table.columns}
    if decimal_comma and target.suffix in TYPED:
        raise ResultsError(
            f"{path}: --decimal-comma: expected a CSV file, found a format that stores numbers; remove the option"
        )

    def seen(frame: pd.DataFrame) -> None:
        for name in empty:
            empty[name] += int((frame[name].isna() | (frame[name].astype(object) == "")).sum())
        if on_rows is not None:
            on_rows(len(frame))

    try:
        with FileSet() as files:
            part = files.part(target)
            if target.suffix in TYPED:
                write_typed(table, part, target.suffix, seen)
            else:
                sep, decimal = (";", ",") if decimal_comma else (",", ".")
                encoding = "utf-8-sig" if decimal_comma else "utf-8"
                opened = partial(gzip.open, compresslevel=4) if target.suffix == ".gz" else open
                with opened(part, "wt", encoding=encoding, newline="") as file:
                    for number, frame in enumerate(table.frames()):
                        shown = one_line(frame) if raw else safe_texts(frame)
                        shown.to_csv(file, index=False, header=number == 0, sep=sep, decimal=decimal)
                        seen(frame)
                if not raw and encoding == "utf-8":
                    _mark_encoding(part, opened)
            files.add(readme, _readme(table, target.name, about, empty, decimal_comma).encode())
            files.commit()
    except OSError as error:
        if error.errno is None:  # raised by HDF5 while the rows are read
            raise
        raise ResultsError(f"{path}: cannot write the table: {error.strerror or error}") from error
    return target, readme


def _mark_encoding(path: Path, opened: Callable[..., Any]) -> None:
    """Add a byte order mark to a file with non-ASCII characters, by which spreadsheets recognise UTF-8."""
    marked = path.with_name(f"{path.name}.marked")
    with ExitStack() as stack:
        stack.callback(marked.unlink, missing_ok=True)
        with opened(path, "rb") as text:
            if all(line.isascii() for line in text):
                return
            text.seek(0)
            with opened(marked, "wb") as file:
                file.write(BOM_UTF8)
                shutil.copyfileobj(text, file)
        marked.replace(path)


def one_line(frame: pd.DataFrame) -> pd.DataFrame:
    """Replace line breaks in strings, so that each row is one line of the file."""
    return frame.assign(**{name: frame[name].str.replace(LINE_ENDS, LINE, regex=True) for name in _texts(frame)})


def safe_texts(frame: pd.DataFrame) -> pd.DataFrame:
    """Replace line breaks, escape control characters, and put an apostrophe before strings that look like formulas."""
    frame = one_line(frame)
    texts = frame[_texts(frame)]
    return frame.assign(**texts.map(lambda text: not_a_formula(escaped(text)), na_action="ignore"))


def table_csv(table: pd.DataFrame) -> bytes:
    """Return a table as a CSV file with one header line, all digits of numbers, and the strings of :func:`safe_texts`.

    If the text contains non-ASCII characters, it begins with a byte order mark, by which spreadsheets recognise UTF-8.
    """
    text = safe_texts(table).to_csv(index=False)
    return text.encode("utf-8" if text.isascii() else "utf-8-sig")


def _texts(frame: pd.DataFrame) -> list[str]:
    return [str(name) for name, kind in frame.dtypes.items() if kind.kind in "OU" or str(kind) == "str"]


def _readme(table: LongTable, name: str, about: str, empty: dict[str, int], decimal_comma: bool) -> str:
    written, options = "UTF-8, comma-separated, one line of headings", ""
    if decimal_comma:
        written = "UTF-8 with a byte order mark, semicolons between columns, decimal commas, one line of headings"
        options = 'sep=";", decimal=",", '
    in_pandas = (
        f'In pandas: `pandas.read_csv(name, {options}keep_default_na=False, na_values=[""])`, so that a network "NA" '
        "is kept."
    )
    digits, line_ends = "all", f" `{LINE.strip()}` separates the lines of a text."
    if name.endswith(tuple(TYPED)):
        line_ends = ""
    if name.endswith(".parquet"):
        written, in_pandas = "Parquet", "In pandas: `pandas.read_parquet(name)`."
    elif name.endswith(".xlsx"):
        written, digits = "A workbook of one sheet, one row of headings", "16"
        in_pandas = 'In pandas: `pandas.read_excel(name, keep_default_na=False, na_values=[""])`.'
    lines = [
        f"# {name}",
        "",
        f"{about} Group `/{table.group}`, {len(table)} rows{table.per}.",
        "",
        f"{written}, SI units, numbers with {digits} digits. Empty cell: unknown, not computed, or an empty text; "
        "their number in each column is given below. `inf`: no limit, such as the scale factor of a body that no scale "
        "factor overturned, or the peak rotation of a body that overturned. -1 in an integer column: none or unknown, "
        f"see its meaning.{line_ends}",
        "",
        in_pandas,
        "",
        f"| column | unit | empty cells of {len(table)} | meaning |",
        "|---|---|---|---|",
    ]
    for column in table.columns:
        meaning = column.long_name
        if column.words:
            meaning += f" ({', '.join(column.words.values())})"
        unit = "" if column.units == "1" else column.units
        lines.append(f"| `{column.name}` | {unit} | {empty[column.name]} | {meaning.replace('|', '/')} |")
    if table.left_out:
        names = ", ".join(f"`{name}`" for name in table.left_out)
        why = "because their dimensions differ"
        lines += ["", f"Not in this table, {why}: {names} (`--rows` selects other dimensions)."]
    return "\n".join(lines) + "\n"
