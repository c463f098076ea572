"""Selects records, bodies and models of a results file by name, and reads their values."""

from collections.abc import Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import TypeVar

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.body.restraint import Restraints
from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.config.configuration import section_of, stored_sections
from rockpulse.errors import ResultsError
from rockpulse.option import Section
from rockpulse.storage.hdf5.netcdf4 import flag_words
from rockpulse.views.shared.formatting import restitution

_Section = TypeVar("_Section", bound=Section)
#: Largest number of names in a message.
LISTED = 20


def one_name(dataset: xr.Dataset, dimension: str, name: str | None) -> str:
    """Return the only name along a dimension that matches a name or pattern; raise ResultsError for none or several."""
    known = [str(item) for item in dataset[dimension].values]
    if name is None and len(known) == 1:
        return known[0]
    if name is None:
        option = dimension.replace("_", "-")
        given = f"expected the name of one of {len(known)} {dimension}s (--{option}), found none"
        raise ResultsError(f"{given}; there are: {_listed(known)}")
    met = [name] if name in known else [label for label in known if fnmatchcase(label, name)]
    if len(met) == 1:
        return met[0]
    if met:
        found = f'"{name}" matches {len(met)} {dimension}s in these results'
        raise ResultsError(f"{dimension}: {found}, but the picture shows only one; choose among: {_listed(met)}")
    spelt = {label.lower(): label for label in known}
    near = [spelt[label] for label in get_close_matches(name.lower(), list(spelt), n=3, cutoff=0.4)]
    nearest, there = f"the nearest: {_listed(near)}; " if near else "", f"there are: {_listed(known)}"
    if near and len(known) > LISTED:
        there = f"there are {len(known)} (rockpulse inspect --{dimension}s)"
    raise ResultsError(
        f'no {dimension} "{name}" in these results (a pattern with * and ? is accepted); {nearest}{there}'
    )


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more


def chosen_case(summary: xr.Dataset, case: int) -> dict[str, int]:
    """Return the indexer that selects a restitution by its number from 1; empty if there is only one restitution."""
    count = summary.sizes.get("case", 1)
    if not 1 <= case <= count:
        raise ResultsError(f"case: expected the number of a restitution from 1 to {count}, got {case}")
    return {"case": case - 1} if "case" in summary.dims else {}


def settings_of(tree: xr.DataTree, section: type[_Section]) -> _Section:
    """Return a section of the configuration that is stored in the results."""
    sections = stored_sections(str(tree.attrs.get("configuration", "")))
    found: _Section = section_of(section, sections.get(section.heading.strip("[]"), {}))
    return found


def block_of(summary: xr.Dataset, block: str, case: int = 1) -> Block:
    """Return a body of /summary as a Block; `case` is the number of its restitution, from 1."""
    own = summary.sel(block=block).isel(chosen_case(summary, case))
    names = ("alpha_c", "p", "radius", "restitution", "alpha_2", "p_2", "radius_2", "restitution_2", "mass")
    return Block.restored(
        float(own["gravity"]),
        Restraints.from_text(str(own["restraints"].values)),
        half_width=0.5 * float(own["width"]),
        half_height=0.5 * float(own["height"]),
        side=int(own["one_sided"]),
        hinge=float(own["hinge_depth"]),
        **{name: float(own[name]) for name in names},
    )


def plain_bodies(summary: xr.Dataset) -> list[str]:
    """Return the bodies to which overturning spectra apply: symmetric, free, on the ground, with no fixed azimuth."""
    like = (summary["one_sided"].values == 0) & (summary["alpha_2"].values == summary["alpha_c"].values)
    like &= np.isnan(summary["body_azimuth"].values)
    like &= (summary["restraints"].values == "") & (summary["floors"].values == "")
    return [str(name) for name in summary["block"].values[like]]


def named_body(summary: xr.Dataset, block: str, case: int = 1) -> str:
    """Return the name of a body; its restitution is added if the results have several for each body."""
    if "case" not in summary.dims:
        return block
    c = summary["restitution"].sel(block=block).isel(chosen_case(summary, case))
    return f"{block}, C = {restitution(float(c))}"


def ragged(tree: xr.DataTree, sizes: str, names: Sequence[str], record: str) -> dict[str, xr.Variable] | None:
    """Return variables of /records for one record; the variable `sizes` has the number of samples of each record."""
    if "records" not in tree.children or any(name not in tree["records"] for name in (sizes, *names)):
        return None
    stored = tree["records"].to_dataset()
    place = stored["record"].values.tolist().index(record)
    first, last = np.cumsum([0, *stored[sizes].values])[place : place + 2]
    return {name: stored[name].variable[first:last] for name in names}


def table_of_pair(
    tree: xr.DataTree, group: str, record: str, block: str, model: str, case: int = 1
) -> dict[str, np.ndarray]:
    """Return the rows of a group such as /half_cycles that belong to one record, body, model and restitution."""
    summary, table = tree["summary"].to_dataset(), tree[group].to_dataset()
    rows = table["case_index"].values == case - 1
    for dimension, name in (("record", record), ("block", block), ("model", model)):
        rows &= table[f"{dimension}_index"].values == summary.get_index(dimension).get_loc(name)
    return {str(name): variable.values[rows] for name, variable in table.data_vars.items()}


def sequence_of(tree: xr.DataTree, record: str) -> ImpulseSequence:
    """Return the impulse sequence of a record [m/s, s], with the spacing used for its half-cycles.

    Raise ResultsError if the record has no sequence.
    """
    own = tree["summary"].to_dataset().sel(record=record)
    names = ("main_impulse", "secondary_impulse", "secondary_interval", "sequence_duration")
    main, secondary, interval, duration = (float(own[name]) for name in names)
    if not np.isfinite(main):
        raise ResultsError(
            f"{record}: no impulse sequence: the intense phase of the record contains too few half-waves"
        )
    count, spacing = int(own["main_count"]), flag_words(own["spacing"])[int(own["spacing"])]
    return ImpulseSequence(main, secondary, interval, duration, None if count < 0 else count, spacing=spacing)
