"""Tables and pictures as files: refused before any work is done where they exist, written together or not at all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.errors import ResultsError
from rockpulse.files import FileSet
from rockpulse.storage.export.table_file import safe_texts

if TYPE_CHECKING:
    import pandas as pd

#: Suffixes of pictures, which choose the format.
PICTURES = (".svg", ".png", ".pdf")


def csv_files(folder: str | Path, names: tuple[str, ...], overwrite: bool) -> dict[str, Path]:
    """The paths of the files `name.csv` in a folder, which :func:`write_files` may make, checked before any work."""
    folder = Path(folder)
    if not folder.is_dir():
        if folder.exists():
            raise ResultsError(f"{folder}: expected a folder for the CSV files, found a file; choose another name")
        if not folder.absolute().parent.is_dir():
            raise ResultsError(f"{folder}: there is no folder {folder.absolute().parent}; create it first")
        return {name: folder / f"{name}.csv" for name in names}
    return {name: check_file(folder / f"{name}.csv", overwrite) for name in names}


def check_file(path: str | Path, overwrite: bool, suffixes: tuple[str, ...] = (".csv",)) -> Path:
    """The path; a ResultsError where no file can be written there, or one exists that must not be overwritten."""
    target = Path(path)
    if target.suffix.lower() not in suffixes:
        raise ResultsError(f"{path}: expected a name that ends in {', '.join(suffixes)}, got {target.suffix!r}")
    if target.exists() and not target.is_file():
        raise ResultsError(f"{path}: expected the name of a file, found something that is no regular file")
    if target.exists() and not overwrite:
        raise ResultsError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
    if not target.absolute().parent.is_dir():
        raise ResultsError(f"{path}: there is no folder {target.absolute().parent}; create it first")
    try:
        with FileSet() as trial:
            trial.add(target, b"")
    except OSError as error:
        raise ResultsError(f"{path}: cannot write into the folder {target.parent}: {error.strerror}") from error
    return target


def csv_bytes(table: pd.DataFrame) -> bytes:
    """A table as CSV, one header line, numbers with all digits, texts as of :func:`safe_texts`."""
    return safe_texts(table).to_csv(index=False).encode()


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write all files or none; a missing folder is made."""
    with FileSet() as files:
        for path, content in contents.items():
            path.parent.mkdir(exist_ok=True)
            files.add(path, content)
        files.commit()
