"""The results file: an xarray tree written whole or not at all, with its provenance, and read back the same."""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.config.configuration import stored_sections
from rockpulse.config.settings import SPACINGS, SequenceSettings
from rockpulse.errors import ResultsError, RockpulseError
from rockpulse.input_file import check_regular
from rockpulse.remark import find, recognised, with_codes
from rockpulse.storage.assessment_variables import minor_of
from rockpulse.storage.atomic_file import ASSESSMENT, check_target, named, remove_parts, replacing
from rockpulse.storage.checksums import CHECKSUM, CHECKSUM_OF_ATTRIBUTES
from rockpulse.storage.fact_variables import FACTS
from rockpulse.storage.fragility_variables import FRAGILITY
from rockpulse.storage.site_variables import SITE_KIND
from rockpulse.storage.summary_variables import BLOCK, RECORD
from rockpulse.storage.variables import NOT_KNOWN
from rockpulse.version import __version__

if TYPE_CHECKING:
    import h5py
    import xarray as xr

__all__ = [
    "ASSESSMENT",
    "OF_RECORDS",
    "SCHEMA_VERSION",
    "check_described",
    "check_schema",
    "check_target",
    "completed",
    "load",
    "named",
    "opened",
    "provenance",
    "readable",
    "remove_parts",
    "replacing",
    "save",
    "with_facts",
]

#: MAJOR.MINOR of the layout described in docs/schema.md; another MAJOR is refused.
SCHEMA_VERSION = "1.5"

#: Kinds of files that are read back, and the group that each of them has.
KINDS = {ASSESSMENT: "summary", SITE_KIND: "site", FRAGILITY: "fragility"}

#: Of the kinds that have facts of records: the group with a row for every record.
OF_RECORDS = {ASSESSMENT: "summary", SITE_KIND: "site", FRAGILITY: "capacities"}

#: Variables of /summary that tell how the sequence model answers, but for the spacing.
OF_SEQUENCES = {
    "main_impulse",
    "secondary_impulse",
    "secondary_interval",
    "sequence_duration",
    "main_count",
    "p",
    "alpha_c",
    "radius",
    "restitution",
}

#: Variables of /half_cycles that tell the spacing of a sequence.
OF_HALF_CYCLES = {"record_index", "model_index", "duration"}

CONVENTIONS = "CF-1.11"
PACKAGES = ("numpy", "numba", "scipy", "xarray", "h5netcdf", "h5py", "obspy")


def save(tree: xr.DataTree, path: str | os.PathLike[str], overwrite: bool = False) -> None:
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
    from rockpulse.storage.hdf5_writer import write_tree

    check_described(tree, path)
    with replacing(path, overwrite, tree.attrs.get("kind", ASSESSMENT), tree.nbytes) as part:
        write_tree(tree, part, provenance(tree.attrs))


def check_described(tree: xr.DataTree, path: str | os.PathLike[str]) -> None:
    """A ResultsError where a variable of the tree, which is to be written to the path, has no unit or no name."""
    for name, variable in _variables(tree):
        for attribute in ("units", "long_name"):
            if not isinstance(variable.attrs.get(attribute), str):
                raise ResultsError(f"{path}: the variable {name} has no {attribute!r}; set it before saving")


def load(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read results into memory, as :func:`rockpulse.load` does, which adds the accessor of an assessment."""
    from rockpulse.storage.hdf5_dataset import read_tree

    with opened(path) as (hdf5, kind), readable(path):
        tree = read_tree(hdf5)
    tree = tree.map_over_datasets(_as_saved)
    if (group := OF_RECORDS.get(kind, "")) in tree.children:
        tree[group].dataset = with_facts(tree[group].to_dataset(), tree.attrs)
    if kind == ASSESSMENT:
        summary = tree["summary"].to_dataset()
        tree["summary"].dataset = completed(
            summary, tree.attrs, lambda: tree["half_cycles"].to_dataset() if "half_cycles" in tree else None
        )
    return tree


def completed(
    summary: xr.Dataset, attrs: Mapping[Any, Any], half_cycles: Callable[[], xr.Dataset | None]
) -> xr.Dataset:
    """The group /summary of an assessment with what its version did not store worked out from what it did.

    `attrs` are those of the root; `half_cycles` gives the group of that name, None where the file has none, and is
    called only where the spacing of a file of schema 1.0 depends on it.
    """
    summary = _coded(summary)
    if attrs["schema_version"] != "1.0":
        return summary
    found = {}
    if "block" in summary.dims:
        found["gravity"] = BLOCK["gravity"].variable(_gravity(summary))
    if "main_impulse" in summary:
        calibrated = np.isfinite(summary["main_impulse"].values)
        code = _spacing(summary, calibrated, attrs.get("configuration"), half_cycles) if calibrated.any() else NOT_KNOWN
        found["spacing"] = RECORD["spacing"].variable(np.where(calibrated, code, NOT_KNOWN))
    return summary.assign(found)


def with_facts(dataset: xr.Dataset, attrs: Mapping[Any, Any]) -> xr.Dataset:
    """A group with a row for every record, what its version did not store of earthquake and site said to be unknown.

    `attrs` are those of the root.
    """
    if "record" not in dataset.sizes:
        return dataset
    count, minor = dataset.sizes["record"], minor_of(attrs["schema_version"])
    lacking = {name: fact for name, fact in FACTS.items() if fact.since > minor and name not in dataset}
    return dataset.assign({name: fact.variable([fact.absent] * count) for name, fact in lacking.items()})


def _gravity(summary: xr.Dataset) -> list[float]:
    """Gravity at each block from its p and R, which are those of a rectangle: g = 4 R p^2/3; NaN without them."""
    if not {"p", "radius"} <= set(summary):
        return [math.nan] * summary.sizes["block"]
    p, radius = summary["p"].values, summary["radius"].values
    return [float(f"{value:.12g}") for value in 4.0 * radius * p * p / 3.0]


def _spacing(
    summary: xr.Dataset, calibrated: np.ndarray, configuration: Any, half_cycles: Callable[[], xr.Dataset | None]
) -> int:
    """The code of the spacing of the sequences, of the records that are `calibrated`, in a file of schema 1.0.

    The spacing is that of the configuration, unless the half-cycles of the first sequence say otherwise: a design
    sequence has its own. It is not known where the configuration or the half-cycles cannot be asked.
    """
    from rocking.block import Block
    from rocking.sequence import ImpulseSequence, sequence_response

    try:
        configured = stored_sections(str(configuration)).get("sequence", {}).get("spacing", SequenceSettings().spacing)
    except ResultsError:  # no TOML, or none at all
        return NOT_KNOWN
    if configured not in SPACINGS:
        return NOT_KNOWN
    models = summary["model"].values.tolist()
    if "sequence" not in models:
        return SPACINGS.index(configured)
    table = half_cycles()
    if table is None or not (set(summary) >= OF_SEQUENCES and set(table) >= OF_HALF_CYCLES):
        return NOT_KNOWN
    first = int(np.argmax(calibrated))
    rows = np.flatnonzero(table["record_index"].values == first)
    own = table.isel(row=slice(rows[0], rows[-1] + 1) if rows.size else slice(0))
    of_first = (own["record_index"].values == first) & (own["model_index"].values == models.index("sequence"))
    stored = own["duration"].values[of_first]
    p, restitution = summary["p"].values, summary["restitution"].values
    cases = restitution.size // p.size
    block = Block.from_parameters(
        np.repeat(p, cases),
        np.repeat(summary["alpha_c"].values, cases),
        restitution=restitution.ravel(),
        gravity=_gravity(summary)[0],
        log=False,
    )
    main, secondary, interval, duration, count = (
        summary[name].values[first].item()
        for name in ("main_impulse", "secondary_impulse", "secondary_interval", "sequence_duration", "main_count")
    )
    for spacing in dict.fromkeys((configured, *SPACINGS)):
        sequence = ImpulseSequence(main, secondary, interval, duration, None if count < 0 else count, None, spacing)
        found = sequence_response(block, sequence).half_cycles
        assert found is not None
        durations = found.duration.T[np.isfinite(found.start_velocity).T]
        if durations.shape == stored.shape and np.allclose(durations, stored, rtol=1e-6):
            return SPACINGS.index(spacing)
    return NOT_KNOWN


def _coded(summary: xr.Dataset) -> xr.Dataset:
    """The group /summary with codes beside the remarks, which in files of before 0.2.0 the texts have to tell."""
    if "warning_codes" in summary or "warnings" not in summary:
        return summary
    codes = [with_codes(map(recognised, str(text).splitlines()))[1] for text in summary["warnings"].values]
    found = {"warning_codes": RECORD["warning_codes"].variable(codes)}
    if "processing" in summary:
        acting = [
            find(map(recognised, str(text).splitlines()), "vertical_acceleration")
            for text in summary["processing"].values
        ]
        names = ["" if one is None else one.values["record"] for one in acting]
        found["vertical_channel"] = RECORD["vertical_channel"].variable(names)
    return summary.assign(found)


def check_schema(path: str | os.PathLike[str]) -> str:
    """The kind of a file of results, a key of `KINDS`; errors as of :func:`load` where it cannot be read."""
    import h5py

    from rockpulse.storage.contained import contained

    check_regular(path, ResultsError)
    with Path(path).open("rb"):
        pass
    try:
        with h5py.File(path, "r") as file:
            contained(file)
            found = file.attrs.get("schema_version")
            kind = str(file.attrs.get("kind", ASSESSMENT))
            known = KINDS.get(kind, "?") in file and isinstance(found, str)
    except (OSError, RuntimeError, KeyError) as error:
        raise ResultsError(
            f"{path}: expected a results file of rockpulse (HDF5), found something else or a truncated file ({error}); "
            "records are assessed with 'rockpulse assess'"
        ) from error
    if not known:
        raise ResultsError(
            f"{path}: an HDF5 file, not written by rockpulse (or of a kind that this version does not know): attribute "
            f"'schema_version' or group '{KINDS.get(kind, KINDS[ASSESSMENT])}' is missing"
        )
    if found.split(".")[0] != SCHEMA_VERSION.split(".")[0]:
        raise ResultsError(
            f"{path}: expected schema version {SCHEMA_VERSION.split('.')[0]}.x, found {found}; run the assessment "
            "again with this version, or open the file with the version of rockpulse named in it"
        )
    return kind


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[tuple[h5py.File, str]]:
    """An open file of results, whose variables are as docs/schema.md describes them, and its kind; errors as `load`."""
    import h5py

    from rockpulse.storage.contained import contained
    from rockpulse.storage.layout import wrong_variables

    kind = check_schema(path)
    with h5py.File(path, "r") as hdf5:
        with readable(path):
            wrong = next(wrong_variables(contained(hdf5), kind, units=False), "")
        if wrong:
            raise ResultsError(
                f"{path}: {wrong}; 'rockpulse verify' says what else is not as it was written, run the assessment again"
            )
        yield hdf5, kind


@contextmanager
def readable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Within it, what is said of a damaged file becomes a ResultsError."""
    try:
        yield
    except RockpulseError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise ResultsError(f"{path}: the results file is damaged ({error}); run the assessment again") from error


def _variables(tree: xr.DataTree) -> Iterator[tuple[str, Any]]:
    for node in tree.subtree:
        for name, variable in node.to_dataset(inherit=False).variables.items():
            yield f"{node.path.rstrip('/')}/{name}", variable


#: Between the time and the version in a line of the attribute `history`.
WRITTEN_BY = " written by rockpulse "


def provenance(attrs: Mapping[Any, Any]) -> dict[str, Any]:
    """Attributes of the root of a file that tell its origin; those that are there already, as a title, stay."""
    stamp = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}{WRITTEN_BY}{__version__}"
    before = attrs.get("history")
    return {
        "Conventions": CONVENTIONS,
        "kind": ASSESSMENT,
        "title": "Overturning safety of rigid blocks under recorded ground motion",
        "rockpulse_version": __version__,
        "python_version": platform.python_version(),
        **_versions(),
        **attrs,
        "schema_version": SCHEMA_VERSION,
        "history": f"{before}\n{stamp}" if before else stamp,
    }


@cache  # each costs a search of the installed files
def _versions() -> dict[str, str]:
    return {f"{package}_version": version(package) for package in PACKAGES}


def _as_saved(dataset: xr.Dataset) -> xr.Dataset:
    """Strings come back as objects; the encoding would tie a copy to the old file; checksums are of the file."""
    strings = {name: variable.astype(str) for name, variable in dataset.variables.items() if variable.dtype == object}
    plain = dataset.assign(strings).drop_encoding()
    for attrs in (plain.attrs, *(variable.attrs for variable in plain.variables.values())):
        for checksum in (CHECKSUM, CHECKSUM_OF_ATTRIBUTES):
            attrs.pop(checksum, None)
    return plain
