"""Readers of strong-motion files; importing them loads neither obspy, pandas, numba nor xarray."""

import os
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from rockpulse.readers.arrays import read_tables, text_tables
from rockpulse.readers.format import FileSettings, Format, ReadOptions
from rockpulse.readers.formats import FORMATS
from rockpulse.readers.kit.text import UNITS
from rockpulse.readers.no_record import advice, is_table, may_be_record
from rockpulse.readers.source import NoRecord, SourceFile, Table, Unrecognised, open_source, open_stream
from rockpulse.record.record import Record

__all__ = ["FORMATS", "UNITS", "FileSettings", "Format", "ReadOptions", "read", "read_source"]


def read_source(file: SourceFile, options: ReadOptions = ReadOptions()) -> list[Record]:  # noqa: B008
    """Read every channel of an opened file, as `read` does for a path."""
    tables = text_tables(file)
    if tables is not None:
        return read_tables(file, tables, lambda table: _read_text(table, options))
    return _read_text(file, options)


def _read_text(file: SourceFile, options: ReadOptions) -> list[Record]:
    if is_table(file):
        raise Table(f"{file.name}: a table of results or of parameters, no record")
    for row in FORMATS:
        if row.detect(file.head, file.name):
            options = options.of_file(file.name)
            records = row.read(file, options)
            options.check(records)
            return records
    kind = Unrecognised if may_be_record(file) else NoRecord
    raise kind(f"{file.name}: no reader recognises the file; {advice(file)} ('rockpulse formats' lists what is read)")


def read(
    path: str | os.PathLike[str] | BinaryIO,
    units: str | None = None,
    dt: float | None = None,
    response: str = "sensitivity",
    stationxml: str | os.PathLike[str] | BinaryIO | None = None,
) -> list[Record]:
    """Read every channel of a strong-motion file.

    Parameters
    ----------
    path : str, path or binary file
        A file, plain or compressed with gzip, or an open one, read from its position; folders: `rockpulse.read_all`.
    units : str, optional
        Unit of the accelerations, a key of `UNITS`, for files that do not state one (columns, SAC).
    dt : float, optional
        Sampling interval [s] for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts with a StationXML become m/s2; see `ReadOptions`.
    stationxml : str, path or binary file, optional
        Station metadata of miniSEED. Without it the StationXML files beside a file with a name are searched.

    Returns
    -------
    list of Record
        In m/s2, in the order of the file.

    Raises
    ------
    RecordFormatError
        No reader recognises the file, or it breaks the rules of its format.
    RecordRefused
        A sound file without usable acceleration: velocity, spectra, counts without a gain, gaps.
    UnitError
        The unit is missing or unknown.
    ConfigError
        `dt` or `response` is none that can be.
    OSError
        The file cannot be opened.
    """
    options = ReadOptions(units, dt, response)
    file = _open(path)
    if stationxml is not None:
        metadata = _open(stationxml)
        file = replace(file, station_files=lambda: [(metadata.name, metadata.content)], chosen=True)
    return read_source(file, options)


def _open(path: str | os.PathLike[str] | BinaryIO) -> SourceFile:
    return open_source(Path(path)) if isinstance(path, str | os.PathLike) else open_stream(path)
