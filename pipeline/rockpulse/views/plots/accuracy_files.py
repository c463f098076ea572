"""Tables and pictures as files: refused before any work is done where they exist, written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.errors import ResultsError

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

__all__ = ["PICTURES", "check_file", "csv_files", "write_csv", "write_picture"]

#: Suffixes of pictures, which choose the format.
PICTURES = (".svg", ".png", ".pdf")


def csv_files(folder: str | Path, names: tuple[str, ...], overwrite: bool) -> dict[str, Path]:
    """The paths of the files `name.csv` of some tables in a folder, checked before any work.

    :func:`write_csv` makes the folder if its parent exists. Raises ResultsError for a file that exists, unless it may
    be overwritten, and for a folder that cannot be one.
    """
    folder = Path(folder)
    if not folder.is_dir():
        if folder.exists():
            raise ResultsError(f"{folder}: expected a folder for the CSV files, found a file; choose another name")
        if not folder.absolute().parent.is_dir():
            raise ResultsError(f"{folder}: there is no folder {folder.absolute().parent}; create it first")
        return {name: folder / f"{name}.csv" for name in names}
    return {name: check_file(folder / f"{name}.csv", overwrite) for name in names}


def check_file(path: str | Path, overwrite: bool, suffixes: tuple[str, ...] = (".csv",)) -> Path:
    """The path, if a file can be written there.

    Raises ResultsError for another suffix, a file that exists (unless it may be overwritten), or a folder that does not
    exist or cannot be written to.
    """
    target = Path(path)
    if target.suffix.lower() not in suffixes:
        raise ResultsError(f"{path}: expected a name that ends in {', '.join(suffixes)}, got {target.suffix!r}")
    if target.exists() and not target.is_file():
        raise ResultsError(f"{path}: expected the name of a file, found something that is no regular file")
    if target.exists() and not overwrite:
        raise ResultsError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
    if not target.absolute().parent.is_dir():
        raise ResultsError(f"{path}: there is no folder {target.absolute().parent}; create it first")
    part = _part(target)
    try:
        part.touch(exist_ok=False)
        part.unlink()
    except OSError as error:
        raise ResultsError(f"{path}: cannot write into the folder {target.parent}: {error.strerror}") from error
    return target


def write_csv(tables: Mapping[Path, pd.DataFrame]) -> None:
    """Write tables as CSV into their files, one header line each, numbers with all digits; a missing folder is made."""
    for path, table in tables.items():
        path.parent.mkdir(exist_ok=True)
        _write(path, partial(table.to_csv, index=False))


def write_picture(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the suffix, one of :data:`PICTURES`: the same bytes for the same figure."""
    from rockpulse.views.plots.picture import picture_bytes

    content = picture_bytes(figure, path.suffix[1:].lower())
    _write(path, lambda part: part.write_bytes(content))


def _write(target: Path, fill: Callable[[Path], object]) -> None:
    part = _part(target)
    try:
        fill(part)
        part.replace(target)
    except OSError as error:
        raise ResultsError(f"{target}: cannot write the file: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)


def _part(target: Path) -> Path:
    return target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}.part")
