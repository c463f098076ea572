"""Reads strong-motion files. The import of this package does not load obspy, pandas, numba or xarray."""

import os
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from rockpulse.readers.arrays import read_tables, text_tables
from rockpulse.readers.file_pairs import PairSettings
from rockpulse.readers.format import FileSettings, Format, ReadOptions
from rockpulse.readers.formats import FORMATS
from rockpulse.readers.kit.text import UNITS
from rockpulse.readers.no_record import advice, is_table, may_be_record
from rockpulse.readers.source import NoRecord, SourceFile, TableOfResults, Unrecognised, open_source, open_stream
from rockpulse.record.record import Record

__all__ = ["FORMATS", "UNITS", "FileSettings", "Format", "PairSettings", "ReadOptions", "read", "read_source"]


def read_source(file: SourceFile, options: ReadOptions = ReadOptions()) -> list[Record]:  # noqa: B008
    """Read every channel of an open file, as `read` does for a path."""
    tables = text_tables(file)
    if tables is not None:
        return read_tables(file, tables, lambda table: _read_text(table, options))
    return _read_text(file, options)


def _read_text(file: SourceFile, options: ReadOptions) -> list[Record]:
    if is_table(file):
        raise TableOfResults(f"{file.name}: a table of results or of parameters, not a record")
    for row in FORMATS:
        if row.detect(file.head, file.name):
            options = options.of_file(file.name)
            records = row.read(file, options)
            options.check(records)
            for pair in options.pairs:  # at most one
                records = pair.directed(file.name, records)
            return records
    kind = Unrecognised if may_be_record(file) else NoRecord
    raise kind(f"{file.name}: no reader recognises the file; {advice(file)} ('rockpulse formats' lists the formats)")


def read(
    path: str | os.PathLike[str] | BinaryIO,
    units: str | None = None,
    dt: float | None = None,
    response: str = "sensitivity",
    stationxml: str | os.PathLike[str] | BinaryIO | None = None,
) -> list[Record]:
    """Read every channel of a strong-motion file as :func:`rockpulse.read` does; folders are not accepted."""
    options = ReadOptions(units, dt, response)
    file = _open(path)
    if stationxml is not None:
        metadata = _open(stationxml)
        file = replace(file, station_files=lambda: [(metadata.name, metadata.content)], chosen=True)
    return read_source(file, options)


def _open(path: str | os.PathLike[str] | BinaryIO) -> SourceFile:
    return open_source(Path(path)) if isinstance(path, str | os.PathLike) else open_stream(path)
