"""A results file opened without reading it: what is asked for is read, and nothing else.

:func:`rockpulse.load` takes a whole file into memory; a table of the worst twenty of two million answers needs a few
variables, which are read when their values are.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.errors import ResultsError
from rockpulse.option import hint
from rockpulse.storage.save_load import ASSESSMENT, OF_RECORDS, completed, opened, with_facts

if TYPE_CHECKING:
    import h5py
    import xarray as xr

__all__ = ["ResultsFile", "flag_words", "open_results", "pointwise", "slab", "worded"]


@dataclass(frozen=True, eq=False)
class ResultsFile:
    """A results file that is open; values are read from it when they are asked for."""

    path: Path
    kind: str  # of results, as the root attribute says
    attrs: dict[str, Any]  # of the root
    groups: tuple[str, ...]  # without the leading slash
    _hdf5: h5py.File = field(repr=False)
    _opened: dict[str, xr.Dataset] = field(default_factory=dict, repr=False)

    def dataset(self, group: str) -> xr.Dataset:
        """A group, its values not yet read; a ResultsError where there is none of the name, or it is damaged."""
        from rockpulse.storage.hdf5_dataset import dataset_of

        if group not in self.groups:
            raise ResultsError(
                f"{self.path}: there is no group {group!r}{hint(group, self.groups)} (there are "
                f"{', '.join(self.groups)})"
            )
        if group not in self._opened:
            try:
                with self.reading():
                    dataset = dataset_of(self._hdf5[group])
            except (KeyError, ValueError) as error:  # a dimension is gone, or a variable came without any
                raise ResultsError(
                    f"{self.path}: /{group} is not as it was written ({error}); 'rockpulse verify' says what else, run "
                    "the assessment again"
                ) from error
            if group == OF_RECORDS.get(self.kind):
                dataset = with_facts(dataset, self.attrs)
            if group == "summary" and self.kind == ASSESSMENT:
                with self.reading():
                    dataset = completed(dataset, self.attrs, self._half_cycles)
            self._opened[group] = dataset
        return self._opened[group]

    def _half_cycles(self) -> xr.Dataset | None:
        return self.dataset("half_cycles") if "half_cycles" in self.groups else None

    def tree(self, *groups: str) -> xr.DataTree:
        """The named groups that the file has (all by default) as a tree whose values are not yet read."""
        import xarray as xr

        chosen = [name for name in groups or self.groups if name in self.groups]
        return xr.DataTree.from_dict(
            {"/": xr.Dataset(attrs=self.attrs), **{f"/{name}": self.dataset(name) for name in chosen}}
        )

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Within it, what HDF5 says of a damaged file becomes a ResultsError."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            if getattr(error, "errno", None) is not None:  # of the file system, not of HDF5
                raise
            raise ResultsError(
                f"{self.path}: the results file is damaged ({error}); run the assessment again"
            ) from error


@contextmanager
def open_results(path: str | Path) -> Iterator[ResultsFile]:
    """Open a file of results for reading what is needed of it; raises as :func:`rockpulse.load`."""
    import h5py

    with opened(path) as (hdf5, kind):
        groups = tuple(name for name, item in hdf5.items() if isinstance(item, h5py.Group))
        attrs = {name: value.item() if isinstance(value, np.generic) else value for name, value in hdf5.attrs.items()}
        yield ResultsFile(Path(path), kind, attrs, groups, hdf5)


def slab(variable: xr.Variable, positions: dict[Any, Any]) -> np.ndarray:
    """Values at positions along each dimension, by reading the box around them.

    HDF5 reads a box at the speed of the disk and scattered positions one by one. Positions are integers in any order,
    or a slice; a dimension that is not named is read whole, and a name that the variable lacks is passed over.
    """
    box: list[slice] = []
    inside: list[Any] = []
    for dim, size in variable.sizes.items():
        wanted = positions.get(dim, slice(None))
        if isinstance(wanted, slice):
            box.append(wanted)
            inside.append(np.arange(len(range(*wanted.indices(size)))))
        else:
            start, stop = (int(wanted.min()), int(wanted.max()) + 1) if wanted.size else (0, 0)
            box.append(slice(start, stop))
            inside.append(wanted - start)
    values = variable[tuple(box)].values
    if all(isinstance(positions.get(dim, slice(None)), slice) for dim in variable.dims):
        return values
    return values[np.ix_(*inside)]


def pointwise(variable: xr.Variable, places: dict[str, np.ndarray]) -> np.ndarray:
    """One value for each of r places, by reading the box around them.

    `places` holds (r,) positions along each dimension; names that the variable lacks are passed over.
    """
    starts = {dim: int(places[dim].min()) if places[dim].size else 0 for dim in map(str, variable.dims)}
    stops = {dim: int(places[dim].max()) + 1 if places[dim].size else 0 for dim in starts}
    values = variable[tuple(slice(starts[dim], stops[dim]) for dim in starts)].values
    return np.asarray(values[tuple(places[dim] - starts[dim] for dim in starts)])


def flag_words(variable: xr.Variable | xr.DataArray) -> dict[int, str]:
    """Words for the values of a flag; empty for a variable that is no flag."""
    if "flag_meanings" not in variable.attrs:
        return {}
    values = np.atleast_1d(variable.attrs["flag_values"]).tolist()
    return dict(zip(values, str(variable.attrs["flag_meanings"]).split(), strict=True))


def worded(values: np.ndarray, words: dict[int, str]) -> np.ndarray:
    """Integer values of a flag as the words of :func:`flag_words`; a number that has none stays as it is.

    Examples
    --------
    >>> worded(np.array([1, 0, 7]), {0: "no", 1: "yes"}).tolist()
    ['yes', 'no', '7']
    """
    codes, inverse = np.unique(values, return_inverse=True)
    names = np.array([words.get(code, str(code)) for code in codes.tolist()], dtype=object)
    return names[inverse].reshape(values.shape) if codes.size else values.astype(object)
