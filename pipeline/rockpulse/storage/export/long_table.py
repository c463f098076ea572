"""Long tables: a group of a results file with one row for each result and one column for each variable."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rockpulse.errors import ResultsError, some
from rockpulse.option import hint
from rockpulse.storage.export.row_selection import Condition, RowSelection, positions_matching, rows
from rockpulse.storage.hdf5.netcdf4 import flag_words, flags_as_words, pointwise
from rockpulse.storage.hdf5.results_file import KINDS, ResultsFile, open_results_file

if TYPE_CHECKING:
    import pandas as pd

#: Dimensions with one column for each label, if a variable has exactly one of them besides the dimensions of the rows.
SPREAD = ("demand", "parameter")
#: A variable with this dimension is in a table only if the user names the dimension among those of the rows.
ASKED = "tie"
#: Dimension to which each index variable of a table refers.
POINTS_AT = {"record_index": "record", "block_index": "block", "case_index": "case", "model_index": "model"}
#: Coordinates of /summary to which an index may refer.
LABELLED = ("record", "block", "model")
#: Largest number of rows that are built at once.
CHUNK = 50_000


@dataclass(frozen=True, eq=False)
class TableColumn:
    """A column of a long table: its heading, its meaning, and the variable that contains its values."""

    name: str  # heading of the column
    units: str
    long_name: str
    words: dict[int, str]  # word for each value of a flag; empty for other variables
    variable: xr.Variable  # not yet read
    labels: np.ndarray | None = None  # labels to show if the values are indices of labels; index -1: no label
    #: For a ragged array: index after the last row of each label.
    ends: np.ndarray | None = None

    def values(self, places: dict[str, np.ndarray]) -> np.ndarray:
        """Return the values of the column in some rows; `places` contains the indices of the rows by dimension."""
        if self.ends is not None and self.labels is not None:
            return np.asarray(self.labels[np.searchsorted(self.ends, places[str(self.variable.dims[0])], side="right")])
        found = pointwise(self.variable, places)
        if self.labels is not None:
            return np.where(found < 0, "", self.labels[found])
        if self.words:
            return flags_as_words(found, self.words)
        return found.astype(object) if found.dtype.kind == "U" else found


@dataclass(frozen=True, eq=False)
class LongTable:
    """A table of one group of an open results file; rows are read when they are needed."""

    group: str
    dims: tuple[str, ...]  # dimensions of the rows
    columns: tuple[TableColumn, ...]
    left_out: tuple[str, ...]  # variables that have other dimensions, and are omitted
    places: dict[str, np.ndarray]  # position of every row along each dimension
    found: int  # number of rows before the limit of the selection is applied

    def __len__(self) -> int:
        return int(next(iter(self.places.values())).size)

    @property
    def per(self) -> str:
        """Return a phrase on the rows, such as ", one per record x block"; empty if the rows have no dimensions."""
        return "" if self.dims == ("row",) else f", one per {' x '.join(self.dims)}"

    def frames(self, size: int = CHUNK) -> Iterator[pd.DataFrame]:
        """Yield the rows as data frames of at most `size` rows; if there are no rows, yield one empty frame."""
        import pandas as pd

        for start in range(0, max(len(self), 1), size):
            part = {dim: place[start : start + size] for dim, place in self.places.items()}
            yield pd.DataFrame({column.name: column.values(part) for column in self.columns})

    def frame(self) -> pd.DataFrame:
        """Return all rows as one data frame."""
        return next(self.frames(max(len(self), 1)))


def long_table(
    file: ResultsFile,
    group: str | None = None,
    dims: Sequence[str] | None = None,
    selection: RowSelection | None = None,
    columns: Sequence[str] | None = None,
) -> LongTable:
    """Return a long table of a group; rows have the dimensions `dims` (default: those of the largest variables)."""
    selection = selection or RowSelection()
    group = (group or KINDS[file.kind]).strip("/")
    dataset = file.dataset(group)
    dims = _dimensions(dataset, group) if dims is None else tuple(dims)
    if not dims or (columns is not None and not columns):
        raise ResultsError(f"expected at least one {'column' if dims else 'dimension for the rows'}")
    sizes = list(map(str, dataset.sizes))
    if unknown := [dim for dim in dims if dim not in sizes]:
        raise ResultsError(
            f"/{group} has no dimension {unknown[0]!r}{hint(unknown[0], sizes)} (it has {', '.join(sizes)})"
        )
    named = {name: _texts(file.dataset("summary")[name]) for name in LABELLED} if "summary" in file.groups else {}
    labels = [*_label_columns(dataset, dims), *_owners(dataset, dims)]
    found = [*_pointers(dataset, dims, named), *_variables(dataset, dims)]
    if columns is not None:
        if lacking := [name for name in columns if not any(_answers_to(one, name) for one in [*labels, *found])]:
            known = [column.name for column in found]
            choices = f"it has {some(known, 5)} (the manual lists all on the page of the schema)"
            raise ResultsError(f"this table of /{group} has no column {lacking[0]!r}{hint(lacking[0], known, choices)}")
        found = [column for column in found if any(_answers_to(column, name) for name in columns)]
    masks, selection = _masks(dataset, named, labels, selection)
    places, count = rows(dataset, dims, selection, masks)
    shown = {name for name in map(str, dataset.variables) if set(dataset[name].dims) <= set(dims)}
    left = tuple(
        str(name) for name in dataset.data_vars if name not in shown and not _spread_dim(dataset.variables[name], dims)
    )
    return LongTable(group, dims, (*labels, *found), left, places, count)


def results_table(
    path: str | Path,
    group: str | None = None,
    dims: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    record: str | None = None,
    block: str | None = None,
    model: str | None = None,
    where: Sequence[str] = (),
    sort: str | None = None,
    descending: bool = False,
    limit: int | None = None,
) -> pd.DataFrame:
    """Read results from a file as a long pandas table; only the requested values are read.

    Parameters
    ----------
    path : str or Path
        Results file of any kind.
    group : str, optional
        Group of the file; by default the main group (`summary` of an assessment).
    dims : sequence of str, optional
        Dimensions of the rows: ``["record"]`` gives one row per record; by default each result has a row.
    columns : sequence of str, optional
        Names of variables; all by default.
    record, block, model : str, optional
        Keep only these names; * and ? are wildcards.
    where : sequence of str
        Conditions that a row must meet: ``["outcome = overturns", "safety_factor < 0.5"]``.
    sort : str, optional
        Variable by which the rows are sorted, smallest first; unknown values are last.
    descending : bool
        Sort the largest first.
    limit : int, optional
        Largest number of rows.

    Returns
    -------
    pandas.DataFrame
        The rows, with flags as words and SI units as in the file (docs/schema.md).

    Raises
    ------
    ResultsError, OSError
        For a file that cannot be read, or a name that it does not contain.

    Examples
    --------
    >>> worst = rp.results_table("results.h5", model="nonlinear", sort="factor_10", limit=2)
    >>> worst[["record", "block"]].values.tolist()
    [['burst.2', 'stele'], ['burst.3', 'stele']]
    """
    names = {dim: (pattern,) for dim, pattern in (("record", record), ("block", block), ("model", model)) if pattern}
    selection = RowSelection(names, tuple(map(Condition.parse, where)), sort, descending, limit)
    with open_results_file(path) as file, file.reading():
        return long_table(file, group, dims, selection, columns).frame()


def _dimensions(dataset: xr.Dataset, group: str) -> tuple[str, ...]:
    """Return the dimensions of the variable with most dimensions, without dimensions that become columns."""
    shown = [one.dims for one in dataset.data_vars.values() if ASKED not in one.dims]
    every = [tuple(str(dim) for dim in dims if dim not in SPREAD) for dims in shown]
    most = [dims for dims in dict.fromkeys(every) if dims and len(dims) == max(map(len, every))]
    if len(most) != 1:
        several = "; ".join(" ".join(dims) for dims in most) or "none"
        raise ResultsError(
            f"/{group} contains several tables: expected the dimensions of one of them (--rows), found none; "
            f"the tables have {several}"
        )
    return most[0]


def _answers_to(column: TableColumn, name: str) -> bool:
    """Return whether a name is the heading of a column, with or without the label in brackets that may end it."""
    return name in (column.name, column.name.partition("[")[0])


def _texts(variable: xr.DataArray) -> np.ndarray:
    return np.array([str(label) for label in variable.values], dtype=object)


def _label_columns(dataset: xr.Dataset, dims: Sequence[str]) -> Iterator[TableColumn]:
    """Yield, for each dimension, a column with its labels or, if it has no labels, with its indices."""
    for dim in dims:
        if dim in dataset.coords:
            yield _column(dim, dataset.variables[dim])
        elif len(dims) > 1:
            numbers = xr.Variable((dim,), np.arange(dataset.sizes[dim]))
            yield TableColumn(dim, "1", f"number of the {dim}, from 0", {}, numbers)


def _owners(dataset: xr.Dataset, dims: Sequence[str]) -> Iterator[TableColumn]:
    """Yield a column with the record, or other object, to which each row of a ragged array belongs."""
    for variable in dataset.data_vars.values():
        dim = str(variable.attrs.get("sample_dimension", ""))
        if dim in dims:
            owner = str(variable.dims[0])
            labels = _texts(dataset[owner]) if owner in dataset.coords else np.arange(variable.size)
            along = xr.Variable((dim,), np.broadcast_to(0, (dataset.sizes[dim],)))
            yield TableColumn(owner, "1", f"{owner} of the row", {}, along, labels, np.cumsum(variable.values))


def _pointers(dataset: xr.Dataset, dims: Sequence[str], named: Mapping[str, np.ndarray]) -> Iterator[TableColumn]:
    for name, at in POINTS_AT.items():
        if name in dataset and set(dataset[name].dims) <= set(dims):
            variable = dataset.variables[name]
            if at in named:
                yield TableColumn(at, "1", f"{at} of /summary; empty if there is none", {}, variable, named[at])
            else:
                yield TableColumn(at, "1", variable.attrs.get("long_name", ""), {}, variable)


def _variables(dataset: xr.Dataset, dims: Sequence[str]) -> Iterator[TableColumn]:
    for name, variable in dataset.data_vars.items():
        bare = dataset.variables[name]
        if name in POINTS_AT or not bare.dims:
            continue
        if set(bare.dims) <= set(dims):
            yield _column(str(name), bare)
        elif spread := _spread_dim(bare, dims):
            for place, label in enumerate(dataset[spread].values):
                yield _column(f"{name}[{label}]", bare.isel({spread: place}), variable.attrs)


def _spread_dim(variable: xr.Variable, dims: Sequence[str]) -> str:
    beyond = [str(dim) for dim in variable.dims if dim not in dims]
    return beyond[0] if len(beyond) == 1 and beyond[0] in SPREAD and len(variable.dims) > 1 else ""


def _column(name: str, variable: xr.Variable, attrs: Mapping[str, Any] | None = None) -> TableColumn:
    attrs = variable.attrs if attrs is None else attrs
    return TableColumn(
        name, str(attrs.get("units", "1")), str(attrs.get("long_name", "")), flag_words(variable), variable
    )


def _masks(
    dataset: xr.Dataset, named: Mapping[str, np.ndarray], labels: Sequence[TableColumn], selection: RowSelection
) -> tuple[list[tuple[tuple[str, ...], np.ndarray]], RowSelection]:
    """Return row masks for selected names that the table stores as indices, and the selection without these names."""
    masks, left = [], dict(selection.names)
    for name, at in POINTS_AT.items():
        if left.get(at) and at not in dataset.coords and name in dataset and at in named:
            wanted = positions_matching(named[at].tolist(), left.pop(at), at)
            masks.append((tuple(map(str, dataset[name].dims)), np.isin(dataset[name].values, wanted)))
    for column in labels:
        if column.ends is not None and column.labels is not None and left.get(column.name):
            wanted = positions_matching([str(label) for label in column.labels], left.pop(column.name), column.name)
            sizes = np.diff(column.ends, prepend=0)
            masks.append(((str(column.variable.dims[0]),), np.repeat(np.isin(np.arange(sizes.size), wanted), sizes)))
    return masks, RowSelection(left, selection.conditions, selection.sort, selection.descending, selection.limit)
