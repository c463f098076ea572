"""Reads files and tables that the user names, and writes several files atomically."""

from __future__ import annotations

import csv
import io
import math
import os
import re
import shutil
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockpulse.errors import ConfigError, ResultsError, RockpulseError
from rockpulse.foreign_text import first_line

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd


#: Largest table and largest configuration that can be read [bytes].
TABLE_LIMIT, TOML_LIMIT = 64 * 1024**2, 1024**2
#: Deepest nesting and largest integer of a TOML file.
DEEPEST, LARGEST = 8, 2**63
_KINDS = {stat.S_ISFIFO: "a pipe", stat.S_ISSOCK: "a socket", stat.S_ISCHR: "a device", stat.S_ISBLK: "a device"}


def check_regular(path: str | os.PathLike[str], error: type[RockpulseError] = ConfigError) -> None:
    """Raise `error` for a pipe, a socket or a device, which may be endless; a missing file is accepted."""
    if not os.path.exists(path):  # noqa: PTH110 - Path.exists raises for a name that is too long
        return
    mode = os.stat(path).st_mode  # noqa: PTH116 - as above
    for is_kind, kind in _KINDS.items():
        if is_kind(mode):
            raise error(f"{path}: expected a file, found {kind}; write its content to a file, and give that file")


def read_text(path: Path, limit: int = TABLE_LIMIT, what: str = "a text file") -> str:
    """Read a UTF-8 file; raise ConfigError ("expected `what`") for a pipe, a large file or another encoding."""
    check_regular(path)
    with path.open("rb") as file:
        content = file.read(limit + 1)
    if len(content) > limit:
        raise ConfigError(f"{path}: expected {what} of at most {limit:,} bytes, found more; is it the right file?")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(
            f"{path}: expected {what} in UTF-8, found an invalid byte at position {error.start}; is it the right file?"
        ) from None


def parse_toml(text: str, name: str, error: type[RockpulseError] = ConfigError) -> dict[str, Any]:
    """Parse a TOML text called `name`; raise `error` for invalid TOML, deep nesting and very large integers."""
    import tomllib  # imported late, as the help does not need it

    deep = f"{name}: sections and arrays are nested more than {DEEPEST} deep; flatten them"
    large = f"{name}: an integer is beyond the limit of 2^63; write a number with a decimal point"
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        raise error(f"{name}: not valid TOML: {fault}") from None
    except RecursionError:
        raise error(deep) from None
    except ValueError:  # Python refuses integers of more than 4300 digits
        raise error(large) from None
    level: list[Any] = [document]
    for _ in range(DEEPEST):
        if any(type(value) is int and abs(value) >= LARGEST for value in level):
            raise error(large)
        inside = (one.values() if isinstance(one, Mapping) else one if isinstance(one, list) else () for one in level)
        level = [value for values in inside for value in values]
    if level:
        raise error(deep)
    return document


#: Pattern of a number with a decimal comma, allowed between semicolons or tabs.
DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)")


def separator(text: str) -> str:
    """Return the delimiter of the first row of a table."""
    head = text.lstrip("\n").partition("\n")[0]
    return next((mark for mark in (";", "\t") if mark in head), ",")


def table_of(path: str, text: str, quoted: bool = True) -> pd.DataFrame:
    """Return the cells of a table as strings, without empty lines and comments (#); decimal commas become points.

    With `quoted`, cells may be in quotes, which must be closed; otherwise quotes are a part of the cells.
    """
    import pandas as pd

    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    between = separator("\n".join(lines[:1]))
    reader = csv.reader(
        io.StringIO("\n".join(lines)),
        delimiter=between,
        skipinitialspace=True,
        strict=True,
        quoting=csv.QUOTE_MINIMAL if quoted else csv.QUOTE_NONE,
    )
    try:
        rows = [[cell.strip() for cell in row] for row in reader]
    except csv.Error as error:
        raise ConfigError(f"{path}: cannot be read as a table: {first_line(error)}") from None
    for row in rows:  # spreadsheets write empty cells after the last one
        while row and not row[-1]:
            row.pop()
    heads, *cells = rows or [[]]
    if twice := [name for name in dict.fromkeys(heads) if heads.count(name) > 1]:
        raise ConfigError(f"{path}: expected each column once, found {twice[0]!r} {heads.count(twice[0])} times")
    for number, row in enumerate(cells, start=1):
        if len(row) > len(heads):
            raise ConfigError(
                f"{path}: row {number}: expected {len(heads)} cells, as in the heading, found {len(row)}: {row}; "
                f"a {between!r} within a cell needs quotes"
            )
    if between != ",":
        cells = [
            [DECIMAL_COMMA.sub(r"\1.\2", cell) if DECIMAL_COMMA.fullmatch(cell) else cell for cell in row]
            for row in cells
        ]
    return pd.DataFrame([row + [""] * (len(heads) - len(row)) for row in cells], columns=heads, dtype=str)


def read_table(path: Path, columns: Sequence[str], what: str, where: str = "") -> pd.DataFrame:
    """Return the cells of a table as strings; `what` describes it in messages, which begin with `where`.

    Raises ConfigError for a missing file, or if one of the `columns` is missing.
    """
    name = f"{where}: {path}" if where else str(path)
    if not path.exists() or path.is_dir():
        raise ConfigError(f"{name}: no such file; expected {what}")
    table = table_of(name, read_text(path, what=what))
    if missing := [column for column in columns if column not in table]:
        found = ", ".join(table.columns) or "none, as it is empty"
        raise ConfigError(f"{name}: expected {what}; missing: {', '.join(missing)}; found: {found}")
    return table


def column_numbers(path: str, table: pd.DataFrame, column: str, above: float = -math.inf) -> np.ndarray:
    """Return a column as finite numbers above `above`; raise ConfigError for any other cell."""
    import numpy as np
    import pandas as pd

    found = pd.to_numeric(table[column], errors="coerce").to_numpy(dtype=float)
    wrong = ~(np.isfinite(found) & (found > above))
    if wrong.any():
        row, expected = int(np.argmax(wrong)), "a number" if above == -math.inf else f"a number above {above:g}"
        raise ConfigError(
            f"{path}: row {row + 1} of column {column!r}: expected {expected}, found {table[column].iloc[row]!r}"
        )
    return found


def _hidden(target: Path) -> Path:
    """Return an unused temporary path in the folder of a file."""
    return target.with_name(f".rockpulse.{os.getpid()}.{os.urandom(4).hex()}.part")


def check_file(path: str | os.PathLike[str], overwrite: bool, suffixes: tuple[str, ...] = (".csv",)) -> Path:
    """Return the path of a file to write; raise ResultsError if it cannot be written or must not be overwritten."""
    target = Path(path)
    if not target.name.lower().endswith(suffixes):
        raise ResultsError(f"{path}: expected a name that ends in {', '.join(suffixes)}, got {target.suffix!r}")
    if target.exists() and not target.is_file():
        raise ResultsError(f"{path}: expected the name of a file, found a folder or a device")
    if target.exists() and not overwrite:
        raise ResultsError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
    if not target.absolute().parent.is_dir():
        raise ResultsError(f"{path}: there is no folder {target.absolute().parent}; create it first")
    try:
        with FileSet() as trial:
            trial.add(target, b"")
    except OSError as error:
        raise ResultsError(f"{path}: cannot write in {target.parent}: {error.strerror}; use another folder") from error
    return target


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write all files; if one cannot be written, leave all files unchanged."""
    with FileSet() as files:
        for path, content in contents.items():
            files.add(path, content)
        files.commit()


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Return a context manager that puts the path of the target, instead of the temporary path, into errors."""
    try:
        yield
    except OSError as fault:
        raise OSError(fault.errno, fault.strerror or str(fault), str(path)) from fault


class FileSet(ExitStack):
    """Files that are first written under temporary names; `commit` moves all of them to their targets."""

    def __init__(self) -> None:
        super().__init__()
        self._moves: list[tuple[Path, Path, Path]] = []

    def part(self, target: Path) -> Path:
        """Return the temporary path at which to write the content of a file."""
        place = Path(os.path.realpath(target))
        part = _hidden(place)
        self.callback(part.unlink, missing_ok=True)
        self._moves.append((target, part, place))
        return part

    def add(self, target: Path, content: bytes) -> None:
        """Write the content of a file to its temporary path; an OSError contains the name of `target`."""
        with _named(target):
            self.part(target).write_bytes(content)

    def commit(self) -> None:
        """Move every file to its target; if one cannot be moved, restore all previous files and raise the OSError."""
        with ExitStack() as copies, ExitStack() as undo:
            for target, part, place in self._moves:
                with _named(target):
                    if place.exists():
                        copy = _hidden(place)
                        copies.callback(copy.unlink, missing_ok=True)
                        shutil.copy2(place, copy)
                        shutil.copymode(place, part)
                        undo.callback(copy.replace, place)
                    else:
                        undo.callback(place.unlink, missing_ok=True)
                    part.replace(place)
            undo.pop_all()
