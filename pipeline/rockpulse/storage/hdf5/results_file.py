"""The results file: writing it, as a whole or not at all, and reading it completely or in parts."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.errors import ResultsError, RockpulseError
from rockpulse.files import check_regular
from rockpulse.option import hint
from rockpulse.storage.hdf5.atomic import ASSESSMENT, replacing
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.version import __version__

if TYPE_CHECKING:
    import h5py
    import xarray as xr


#: Version of the layout in docs/schema.md; files with another version are rejected.
SCHEMA_VERSION = "2.0"
#: Kinds of files that can be read, and the group that identifies each.
KINDS = {ASSESSMENT: "summary", SITE_KIND: "site", FRAGILITY: "fragility"}
#: Command that creates each kind of file.
VERBS = {ASSESSMENT: "assess", SITE_KIND: "calibrate", FRAGILITY: "fragility"}
PACKAGES = ("numpy", "numba", "scipy", "xarray", "h5netcdf", "h5py", "obspy")


def save(tree: xr.DataTree, path: str | os.PathLike[str], overwrite: bool = False) -> None:
    """Write results to one HDF5 file, atomically.

    Parameters
    ----------
    tree : xarray.DataTree
        Results as :func:`rockpulse.assess` returns them (docs/schema.md); every variable has `units` and `long_name`.
        The root attribute `kind` is the kind of results; the default is an assessment.
    path : str or Path
        File to write.
    overwrite : bool
        Whether existing results may be replaced (:func:`check_target`). The old file stays unchanged until the new one
        is complete.

    Raises
    ------
    ResultsError
        If the target exists or cannot be written, or a variable lacks its unit or long name.

    See Also
    --------
    load : reads the file.

    Examples
    --------
    >>> rp.save(results, "again.h5", overwrite=True)
    >>> rp.load("again.h5").rockpulse
    <Results 5 records, 2 bodies, model nonlinear>
    """
    from rockpulse.storage.hdf5.writer import write_tree

    check_described(tree, path)
    with replacing(path, overwrite, tree.attrs.get("kind", ASSESSMENT), tree.nbytes) as part:
        write_tree(tree, part, provenance(tree.attrs))


def check_described(tree: xr.DataTree, path: str | os.PathLike[str]) -> None:
    """Raise ResultsError if a variable of a tree has no unit or no long name; `path` is used in the message."""
    for node in tree.subtree:
        for name, variable in node.to_dataset(inherit=False).variables.items():
            for attribute in ("units", "long_name"):
                if not isinstance(variable.attrs.get(attribute), str):
                    where = f"{node.path.rstrip('/')}/{name}"
                    raise ResultsError(f"{path}: the variable {where} has no {attribute!r}; set it before saving")


def load_tree(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read results into memory without the ``rockpulse`` accessor, which :func:`rockpulse.load` adds."""
    from rockpulse.storage.hdf5.netcdf4 import read_tree

    with opened(path) as (hdf5, _), damage_reported(path):
        tree = read_tree(hdf5)
    return tree.map_over_datasets(_as_saved)


def given_results(results: xr.DataTree | str | os.PathLike[str]) -> xr.DataTree:
    """Return results in memory unchanged, or read them from a file."""
    return load_tree(results) if isinstance(results, str | os.PathLike) else results


@contextmanager
def checked(path: str | os.PathLike[str]) -> Iterator[tuple[h5py.File, str, dict[str, h5py.Dataset]]]:
    """Open a results file of this schema version; yield the file, its kind and its datasets by path."""
    import h5py

    from rockpulse.storage.hdf5.layout import checked_datasets

    check_regular(path, ResultsError)
    Path(path).open("rb").close()
    with ExitStack() as stack:
        try:
            hdf5 = stack.enter_context(h5py.File(path, "r"))
            datasets = checked_datasets(hdf5)
            found = hdf5.attrs.get("schema_version")
            kind = str(hdf5.attrs.get("kind", ASSESSMENT))
            known = KINDS.get(kind, "?") in hdf5 and isinstance(found, str)
        except BlockingIOError as error:  # another process has locked the file
            raise ResultsError(
                f"{path}: another process has this file open for writing; wait until it ends, or close the file there"
            ) from error
        except (OSError, RuntimeError, KeyError) as error:
            raise ResultsError(
                f"{path}: not a rockpulse results file, or damaged (HDF5: {error}); create one with 'rockpulse "
                "assess', or restore a copy"
            ) from error
        if not known:
            raise ResultsError(
                f"{path}: an HDF5 file, not written by rockpulse (or of a kind that this version does not know): "
                f"attribute 'schema_version' or group '{KINDS.get(kind, KINDS[ASSESSMENT])}' is missing"
            )
        if found != SCHEMA_VERSION:
            raise ResultsError(
                f"{path}: expected schema version {SCHEMA_VERSION}, found {found}; run 'rockpulse {VERBS[kind]}' again "
                "with this version, or open the file with the version that its attribute 'rockpulse_version' names"
            )
        yield hdf5, kind, datasets


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[tuple[h5py.File, str]]:
    """Open a results file and check its variables; yield the file and its kind. Raises ResultsError and OSError."""
    from rockpulse.storage.hdf5.layout import wrong_variables

    with checked(path) as (hdf5, kind, datasets):
        with damage_reported(path):
            wrong = next(wrong_variables(datasets, kind, units=False), "")
        if wrong:
            raise ResultsError(f"{path}: {wrong}; 'rockpulse verify' lists every change; run the assessment again")
        yield hdf5, kind


@contextmanager
def damage_reported(
    path: str | os.PathLike[str],
    errors: tuple[type[Exception], ...] = (OSError, RuntimeError, KeyError, ValueError, TypeError),
) -> Iterator[None]:
    """Convert `errors` caused by a damaged file to ResultsError, in a ``with`` block."""
    try:
        yield
    except errors as error:
        if isinstance(error, RockpulseError) or getattr(error, "errno", None) is not None:  # not an error of HDF5
            raise
        raise ResultsError(f"{path}: the results file is damaged ({error}); run the assessment again") from error


#: Separator between time and version in a line of the attribute `history`.
WRITTEN_BY = " written by rockpulse "


def provenance(attrs: Mapping[Any, Any]) -> dict[str, Any]:
    """Return the root attributes of a file: the given ones, the versions of packages, and the history."""
    stamp = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}{WRITTEN_BY}{__version__}"
    before = attrs.get("history")
    return {
        "Conventions": "CF-1.11",
        "kind": ASSESSMENT,
        "title": "Overturning safety of rigid blocks under recorded ground motion",
        "rockpulse_version": __version__,
        "python_version": platform.python_version(),
        **_versions(),
        **attrs,
        "schema_version": SCHEMA_VERSION,
        "history": f"{before}\n{stamp}" if before else stamp,
    }


@cache  # for each package, Python searches the installed files
def _versions() -> dict[str, str]:
    return {f"{package}_version": version(package) for package in PACKAGES}


def _as_saved(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset as it was before saving: with plain strings, without encoding and checksums."""
    from rockpulse.storage.hdf5.writer import CHECKSUM, CHECKSUM_OF_ATTRIBUTES

    strings = {name: variable.astype(str) for name, variable in dataset.variables.items() if variable.dtype == object}
    plain = dataset.assign(strings).drop_encoding()
    for attrs in (plain.attrs, *(variable.attrs for variable in plain.variables.values())):
        for checksum in (CHECKSUM, CHECKSUM_OF_ATTRIBUTES):
            attrs.pop(checksum, None)
    return plain


@dataclass(frozen=True, eq=False)
class ResultsFile:
    """An open results file; its values are read on demand."""

    path: Path
    kind: str  # root attribute `kind`
    attrs: dict[str, Any]  # attributes of the root
    groups: tuple[str, ...]  # names of the groups without the leading slash
    _hdf5: Any = field(repr=False)  # h5py.File; None for results in memory
    _opened: dict[str, xr.Dataset] = field(default_factory=dict, repr=False)

    def dataset(self, group: str) -> xr.Dataset:
        """Return a group, whose values are read on demand; raise ResultsError if it is missing or damaged."""
        from rockpulse.storage.hdf5.netcdf4 import dataset_of

        if group not in self.groups:
            raise ResultsError(
                f"{self.path}: there is no group {group!r}{hint(group, self.groups)} (groups: {', '.join(self.groups)})"
            )
        if group not in self._opened:
            try:
                with self.reading():
                    self._opened[group] = dataset_of(self._hdf5[group])
            except (KeyError, ValueError) as error:  # the name of a dimension is missing
                raise ResultsError(
                    f"{self.path}: /{group} was changed or damaged ({error}); 'rockpulse verify' lists every change; "
                    "run the assessment again"
                ) from error
        return self._opened[group]

    def tree(self, *groups: str) -> xr.DataTree:
        """Return the named groups that exist, by default all groups, as a tree whose values are read on demand."""
        import xarray as xr

        chosen = [name for name in groups or self.groups if name in self.groups]
        return xr.DataTree.from_dict(
            {"/": xr.Dataset(attrs=self.attrs), **{f"/{name}": self.dataset(name) for name in chosen}}
        )

    def reading(self) -> AbstractContextManager[None]:
        """Convert errors of HDF5, which mean that the file is damaged, to ResultsError, in a ``with`` block."""
        return damage_reported(self.path, (OSError, RuntimeError))


def of_tree(tree: xr.DataTree, name: str) -> ResultsFile:
    """Return results in memory as a results file; messages use `name` as its path."""
    groups = {str(group): node.to_dataset() for group, node in tree.children.items()}
    attrs = {str(key): value for key, value in tree.attrs.items()}
    return ResultsFile(Path(name), str(attrs.get("kind", ASSESSMENT)), attrs, tuple(groups), None, groups)


@contextmanager
def open_results_file(path: str | Path) -> Iterator[ResultsFile]:
    """Open a results file, whose values are read on demand; raise the errors of :func:`rockpulse.load`."""
    import h5py

    with opened(path) as (hdf5, kind):
        groups = tuple(name for name, item in hdf5.items() if isinstance(item, h5py.Group))
        attrs = {name: value.item() if isinstance(value, np.generic) else value for name, value in hdf5.attrs.items()}
        yield ResultsFile(Path(path), kind, attrs, groups, hdf5)
