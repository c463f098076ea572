"""The results file: an xarray tree written whole or not at all, with its provenance, and read back the same.

The tree is written to a temporary name beside the target, flushed to the disk and then renamed, so a run that is killed
leaves the old file or none (at worst a hidden ``.part`` file, which may be deleted).
"""

from __future__ import annotations

import os
import platform
import secrets
from collections.abc import Iterator
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.accuracy_variables import REPORT
from rockpulse.calibration.rule_variables import RULE_KIND
from rockpulse.calibration.site_variables import SITE_KIND
from rockpulse.errors import ResultsError
from rockpulse.fragility.variables import FRAGILITY
from rockpulse.study.variables import STUDY

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ASSESSMENT", "SCHEMA_VERSION", "check_target", "load", "named", "save"]

#: MAJOR.MINOR of the layout described in docs/schema.md; another MAJOR is refused.
SCHEMA_VERSION = "1.0"

#: Root attribute `kind` of the results of an assessment; files without it are assessments.
ASSESSMENT = "assessment"

#: Kinds of files that are read back, and the group that each of them has.
KINDS = {ASSESSMENT: "summary", SITE_KIND: "site", FRAGILITY: "fragility", RULE_KIND: "rates", STUDY: "statements"}

CONVENTIONS = "CF-1.11"
DAMAGED = "damaged file"
SIGNATURE = b"\x89HDF\r\n\x1a\n"
PACKAGES = ("rockpulse", "numpy", "numba", "scipy", "xarray", "h5netcdf", "h5py", "obspy")


def check_target(path: str | Path, overwrite: bool = False, kind: str = ASSESSMENT) -> Path:
    """Whether a results file can be written here, asked before any work is done.

    Parameters
    ----------
    path : str or Path
        Where the results are to go.
    overwrite : bool
        Whether results that exist may be replaced: an HDF5 file of rockpulse of the same kind, of any schema version,
        or a damaged one. No other file is ever replaced.
    kind : {"assessment", "site calibration", "accuracy report"}
        What the file is to hold.

    Returns
    -------
    Path
        The file that will be written, links resolved.

    Raises
    ------
    ResultsError
        For a file that exists, a folder that does not, or a place or name that cannot be written.
    """
    target = Path(os.path.realpath(path))
    try:
        if target.exists():
            _check_replaceable(target, path, overwrite, kind)
        if not target.parent.is_dir():
            raise ResultsError(f"{path}: there is no folder {target.parent}; create it first")
        part = _part(target)
        part.touch(exist_ok=False)  # its name is longer than that of the target
        part.unlink()
    except OSError as error:
        raise ResultsError(f"{path}: cannot write into the folder {target.parent}: {error.strerror}") from error
    return target


def save(tree: xr.DataTree, path: str | Path, overwrite: bool = False) -> None:
    """Write results to one HDF5 file, atomically.

    Parameters
    ----------
    tree : xarray.DataTree
        Results as :func:`rockpulse.assess` returns them (docs/schema.md); every variable has `units` and `long_name`.
        The attribute `kind` says what they are, an assessment without.
    path : str or Path
        File to write.
    overwrite : bool
        Whether results that exist may be replaced (:func:`check_target`). Until the new file is complete the old one
        stays as it is.

    Raises
    ------
    ResultsError
        Where the target exists or cannot be written, or a variable lacks its unit or long name.

    See Also
    --------
    load : the way back.
    """
    kind = tree.attrs.get("kind", ASSESSMENT)
    target = check_target(path, overwrite, kind)
    for name, variable in _variables(tree):
        for attribute in ("units", "long_name"):
            if not isinstance(variable.attrs.get(attribute), str):
                raise ResultsError(f"{path}: the variable {name} has no {attribute!r}; set it before saving")
    complete = _with_provenance(tree)
    part = _part(target)
    try:
        complete.to_netcdf(part, mode="w", engine="h5netcdf")
        _flush(part, os.O_RDWR)
        check_target(path, overwrite, kind)  # somebody else may have written it during the run
        part.replace(target)
    except OSError as error:
        raise ResultsError(f"{path}: cannot write the results: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)
    if os.name == "posix":  # elsewhere a folder cannot be opened
        _flush(target.parent, os.O_RDONLY)


def load(path: str | Path) -> xr.DataTree:
    """Read results into memory; the file is closed afterwards.

    Parameters
    ----------
    path : str or Path
        File written by :func:`save`.

    Returns
    -------
    xarray.DataTree
        The tree that was saved, with the provenance in its attributes.

    Raises
    ------
    ResultsError
        For a file that is no HDF5, is damaged, was not written by rockpulse, is an accuracy report, or has another
        major schema version.
    OSError
        Where the file cannot be opened.
    """
    import xarray as xr

    _check_schema(path)
    try:
        # Times are plain seconds and stay so, whatever units xarray may take for time deltas.
        with xr.open_datatree(path, engine="h5netcdf", decode_times=False, decode_timedelta=False) as opened:
            tree = opened.load()
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise ResultsError(f"{path}: the results file is damaged ({error}); run the assessment again") from error
    return tree.map_over_datasets(_as_saved)


def _part(target: Path) -> Path:
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")


def _check_replaceable(target: Path, path: str | Path, overwrite: bool, kind: str) -> None:
    """Only results may be replaced: under a mistyped name a record or a configuration would be lost for good."""
    if not target.is_file():
        raise ResultsError(f"{path}: expected the name of a results file, found something that is no regular file")
    if not overwrite:
        raise ResultsError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
    try:
        found = _kind(target)
    except OSError as error:
        raise ResultsError(f"{path}: cannot read the file that is to be replaced: {error.strerror}") from error
    if found is None:
        raise ResultsError(
            f"{path}: expected results of rockpulse, found another file, which is not replaced even with --overwrite; "
            "choose another name, or remove it by hand"
        )
    if found not in (kind, DAMAGED):
        raise ResultsError(
            f"{path}: expected {named(kind)} of rockpulse, found {named(found)}, which is not replaced even with "
            "--overwrite; choose another name, or remove it by hand"
        )


def named(kind: str) -> str:
    """A kind of file with its article."""
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def _kind(target: Path) -> str | None:
    """What a file of rockpulse holds, whatever its schema version; None for another file."""
    import h5py

    with target.open("rb") as file:
        if file.read(len(SIGNATURE)) != SIGNATURE:
            return None
    try:
        with h5py.File(target, "r", locking=False) as hdf5:  # locked by its owner is not damaged
            ours = {"schema_version", "rockpulse_version"} <= set(hdf5.attrs)
            return str(hdf5.attrs.get("kind", ASSESSMENT)) if ours else None
    except (OSError, RuntimeError, KeyError):
        return DAMAGED


def _check_schema(path: str | Path) -> None:
    import h5py

    with Path(path).open("rb"):
        pass
    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get("schema_version")
            kind = file.attrs.get("kind", ASSESSMENT)
            known = KINDS.get(kind, "/") in file and kind in KINDS and isinstance(found, str)
    except (OSError, RuntimeError, KeyError) as error:
        raise ResultsError(
            f"{path}: expected a results file of rockpulse (HDF5), found something else or a truncated file ({error}); "
            "records are assessed with 'rockpulse assess'"
        ) from error
    if kind == REPORT:
        raise ResultsError(
            f"{path}: expected results of 'rockpulse assess'; this is an accuracy report: open it with xarray or h5py, "
            "see docs/schema.md"
        )
    if not known:
        raise ResultsError(
            f"{path}: an HDF5 file, not written by rockpulse (or of a kind that this version does not know): attribute "
            f"'schema_version' or group '{KINDS.get(kind, KINDS[ASSESSMENT])}' is missing"
        )
    if found.split(".")[0] != SCHEMA_VERSION.split(".")[0]:
        raise ResultsError(
            f"{path}: expected schema version {SCHEMA_VERSION.split('.')[0]}.x, found {found}; "
            "run the assessment again with this version, or open the file with the version of rockpulse named in it"
        )


def _variables(tree: xr.DataTree) -> Iterator[tuple[str, Any]]:
    for node in tree.subtree:
        for name, variable in node.to_dataset(inherit=False).variables.items():
            yield f"{node.path.rstrip('/')}/{name}", variable


def _with_provenance(tree: xr.DataTree) -> xr.DataTree:
    """The tree with what makes the file tell where it comes from; what is there already (a title, versions) stays."""
    stamp = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by rockpulse {version('rockpulse')}"
    complete = tree.map_over_datasets(_as_text)
    before = tree.attrs.get("history")
    complete.attrs = {
        "Conventions": CONVENTIONS,
        "kind": ASSESSMENT,
        "title": "Overturning safety of rigid blocks under recorded ground motion",
        "python_version": platform.python_version(),
        **{f"{package}_version": version(package) for package in PACKAGES},
        **{name: _in_utf8(text) if isinstance(text, str) else text for name, text in tree.attrs.items()},
        "schema_version": SCHEMA_VERSION,
        "history": f"{before}\n{stamp}" if before else stamp,
    }
    return complete


def _as_text(dataset: xr.Dataset) -> xr.Dataset:
    """File names may hold bytes outside UTF-8, which HDF5 does not take: they become the replacement character."""
    texts = {name: variable for name, variable in dataset.variables.items() if variable.dtype.kind == "U"}
    in_utf8 = np.vectorize(_in_utf8, otypes=[str])
    return dataset.assign({name: variable.copy(data=in_utf8(variable.values)) for name, variable in texts.items()})


def _in_utf8(text: str) -> str:
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def _as_saved(dataset: xr.Dataset) -> xr.Dataset:
    """Strings come back as objects; the encoding would tie a copy to the old file."""
    strings = {name: variable.astype(str) for name, variable in dataset.variables.items() if variable.dtype == object}
    return dataset.assign(strings).drop_encoding()


def _flush(path: Path, mode: int) -> None:
    handle = os.open(path, mode)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
