"""Converts workbooks (XLSX), MATLAB and numpy files to tables of text, which the reader of columns reads."""

import io
import zipfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused, RockpulseError
from rockpulse.readers.no_record import advice
from rockpulse.readers.source import HEAD, SourceFile, TableOfResults, Unrecognised
from rockpulse.record.record import Record

_WORKBOOKS = (".xlsx", ".xlsm")
_SAVE = "save it with save(name, '-v7'), or write columns of time and acceleration as text"
_DELIMITER = ";"  # delimiter of the cells in the text; not a comma, which a cell may contain
#: Smallest number of rows of a sheet with samples (a shorter one may be a list), and smallest size of an array.
_FEWEST_SAMPLES, _FEWEST_ROWS = 50, 3
#: Names of single numbers (in lower case), each with the word that the reader of columns knows.
_NUMBERS = dict.fromkeys(("dt", "delta", "deltat", "step", "time_step", "timestep", "sampling_interval"), "dt")
_NUMBERS |= dict.fromkeys(("fs", "sps", "sampling_rate", "samplerate", "sample_rate", "rate"), "sampling rate")
_NUMBERS |= dict.fromkeys(("npts", "nsamples"), "npts") | dict.fromkeys(("pga",), "pga")
_UNITS = ("unit", "units", "acc_unit", "acc_units")
_SAMPLES = ("data", "samples", "values", "signal", "x", "y", "arr_0")


def text_tables(file: SourceFile) -> list[SourceFile] | None:
    """Return the tables of a workbook, or of a MATLAB or numpy file, as text; None for other files."""
    suffix, packed = file.path.suffix.lower(), file.head.startswith(b"PK")
    if file.head.startswith(b"\x93NUMPY") or (packed and suffix == ".npz"):
        found = _numpy(file)
    elif packed and suffix in _WORKBOOKS:
        found = _workbook(file)
    elif suffix == ".mat":
        found = _matlab(file)
    else:
        return None
    texts = [text.encode() for text in found]
    return [replace(file, head=text[:HEAD], load=lambda text=text: text) for text in texts]  # type: ignore[misc]


def read_tables(file: SourceFile, tables: list[SourceFile], read: Callable[[SourceFile], list[Record]]) -> list[Record]:
    """Return the records of all tables of a file; raise the first error if no table contains records."""
    records: list[Record] = []
    faults: list[RockpulseError] = []
    for table in tables:
        try:
            records += read(table)
        except RockpulseError as fault:
            faults.append(fault)
    if not records:
        named = [fault for fault in faults if not isinstance(fault, Unrecognised)]
        beside = "no columns of samples in the file; it is treated as a table that accompanies the records"
        raise (named or [TableOfResults(f"{file.name}: {beside}")])[0]
    return [replace(record, source_sha256=file.sha256) for record in records]


def _workbook(file: SourceFile) -> Iterable[str]:
    """Yield each sheet of a workbook as text, except sheets with too few rows for samples."""
    try:
        sheets = sheet_texts(file.content)
    except ImportError as fault:
        found = "a workbook needs the package openpyxl (pip install openpyxl)"
        raise RecordRefused(f"{file.name}: {found}; or save it as CSV, with headings and units") from fault
    except Exception as fault:  # openpyxl may raise any error for a damaged part
        found = f"cannot be read as a workbook ({fault}); {advice(file)}"
        raise RecordFormatError(f"{file.name}: {found}") from fault
    yield from (sheet for sheet in sheets if sheet.count("\n") + 1 >= _FEWEST_SAMPLES)


def sheet_texts(content: bytes) -> list[str]:
    """Return each sheet of a workbook as rows of text, without empty rows and columns."""
    import pandas

    sheets = pandas.read_excel(io.BytesIO(content), sheet_name=None, header=None, dtype=object)
    filled = [sheet.dropna(how="all").dropna(axis=1, how="all") for sheet in sheets.values()]
    rows = ((_DELIMITER.join(map(_cell, row)).rstrip(_DELIMITER) for row in one.values.tolist()) for one in filled)
    return ["\n".join(of_sheet) for of_sheet in rows]


def _cell(value: Any) -> str:
    """Return the value of a cell as text without the delimiter; times are in ISO 8601."""
    if value is None or value != value:
        return ""
    text = value.isoformat() if hasattr(value, "isoformat") else str(value)
    return text.replace(_DELIMITER, ",").replace("\n", " ").strip()


def _numpy(file: SourceFile) -> Iterable[str]:
    """Return the arrays of an NPY or NPZ file as text; arrays of Python objects are rejected, as they can run code."""
    try:
        found = np.load(io.BytesIO(file.content), allow_pickle=False)
        arrays = {"": found} if isinstance(found, np.ndarray) else {name: found[name] for name in found.files}
    except (ValueError, OSError, EOFError, KeyError, zipfile.BadZipFile) as fault:
        found = f"cannot be read as arrays of numpy: {fault}; save plain arrays of numbers"
        raise RecordFormatError(f"{file.name}: {found}") from fault
    return _texts(arrays)


def _matlab(file: SourceFile) -> Iterable[str]:
    """Return the variables of a MATLAB file, and the fields of its structures, as text."""
    from scipy.io import loadmat

    try:
        found = loadmat(io.BytesIO(file.content), squeeze_me=True, struct_as_record=True)
    except NotImplementedError as fault:  # raised by scipy for version 7.3
        raise RecordRefused(f"{file.name}: a MATLAB file of version 7.3, which cannot be read; {_SAVE}") from fault
    except Exception as fault:  # scipy raises anything from ValueError to TypeError on damaged bytes
        raise RecordFormatError(f"{file.name}: cannot be read as a MATLAB file: {fault}; {_SAVE}") from fault
    variables: dict[str, Any] = {}
    for name, value in found.items():
        if name.startswith("__"):
            continue
        fields = value.dtype.names if isinstance(value, np.ndarray) and value.shape == () else None
        variables |= {field: value[field].item() for field in fields} if fields else {name: value}
    return _texts(variables)


def _texts(arrays: Mapping[str, Any]) -> list[str]:
    """Return a text table for each group of columns of equal length, with single numbers and words as header text."""
    prose: list[str] = []
    columns: dict[int, list[tuple[str, np.ndarray]]] = {}
    for name, value in arrays.items():
        array = np.asarray(value).squeeze()
        if array.dtype.kind in "US" and array.ndim == 0:
            text = " ".join(str(array[()]).split())
            prose.append(f"units: {text}" if name.lower() in _UNITS else f"{name}: {text}")
        elif array.dtype.names:
            for field in array.dtype.names:
                columns.setdefault(array.size, []).append((field, array[field].ravel()))
        elif array.dtype.kind in "iuf" and array.ndim == 0:
            known = _NUMBERS.get(name.lower())
            prose += [f"{known} = {array[()]!s}"] if known else []
        elif array.dtype.kind in "iuf" and array.ndim <= 2 and array.size >= _FEWEST_ROWS:
            table = array.reshape(-1, 1) if array.ndim == 1 else array if array.shape[0] >= array.shape[1] else array.T
            label = "" if name.lower() in _SAMPLES else name
            names = [label] if table.shape[1] == 1 else [f"{label} {number}" for number in range(1, table.shape[1] + 1)]
            columns.setdefault(len(table), []).extend(zip(names, table.T, strict=True))
    return [_table(prose, named) for _, named in sorted(columns.items(), reverse=True)]


def _table(prose: list[str], named: list[tuple[str, np.ndarray]]) -> str:
    """Return a table as text: header text, headings (if the columns have names), and the columns."""
    # Columns without names (of a series without a name, or of a matrix) are written without headings.
    bare = all(not name.strip(" 0123456789") for name, _ in named)
    heading = [] if bare else [_DELIMITER.join(name.replace(_DELIMITER, ",") or "value" for name, _ in named)]
    # The reader of columns distinguishes samples from counts by their decimal point.
    rows = np.column_stack([values.astype(float) for _, values in named]).tolist()
    return "\n".join([*prose, *heading, *(_DELIMITER.join(map(repr, row)) for row in rows)])
