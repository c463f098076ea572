"""Whether the variables of a results file are those that docs/schema.md describes: type, dimensions, unit, words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import h5py
import numpy as np

from rockpulse.storage.assessment_variables import ASSESSMENT_GROUPS, minor_of
from rockpulse.storage.atomic_file import ASSESSMENT
from rockpulse.storage.fragility_variables import FRAGILITY, FRAGILITY_GROUPS
from rockpulse.storage.netcdf4 import NOT_A_COORDINATE, says_no_variable
from rockpulse.storage.site_spectrum_variables import SITE_GROUPS
from rockpulse.storage.site_variables import SITE_KIND
from rockpulse.storage.variables import Declared, StoredVariable

__all__ = ["GROUPS", "missing_variables", "wrong_variables"]

#: Declarations by the kind of file, and by group; after a comma stands the sort of results that a group is of.
GROUPS: dict[str, dict[str, Declared]] = {
    ASSESSMENT: ASSESSMENT_GROUPS,
    FRAGILITY: FRAGILITY_GROUPS,
    SITE_KIND: SITE_GROUPS,
}

#: Groups that every file of a kind has.
ALWAYS = {ASSESSMENT: ASSESSMENT_GROUPS.keys() - {"/spectra", "/directions", "/records"}}


def wrong_variables(variables: Mapping[str, h5py.Dataset], kind: str, units: bool = True) -> Iterator[str]:
    """A sentence on each variable that a file of a kind holds in another type, shape or unit than it is declared with.

    `variables` are the datasets of the open file by their paths. Without `units` any unit will do: earlier versions and
    trees of the user's own may name one in another way.
    """
    for path, variable in variables.items():
        if says_no_variable(variable.attrs.get("NAME")):
            continue
        group, _, name = path.rpartition("/")
        differences = [
            _difference(variable, one, units) for one in _declared(kind, group, name.removeprefix(NOT_A_COORDINATE))
        ]
        if differences and all(differences):
            yield f"variable {path}: {differences[0]}"


def missing_variables(variables: Mapping[str, h5py.Dataset], kind: str, schema: str) -> Iterator[str]:
    """A sentence on each variable that a file of a kind and version lacks, though every file of them has it.

    Groups that differ with the sort of results or the configuration may be missing, and so may their variables.
    """
    found = {path.replace(f"/{NOT_A_COORDINATE}", "/") for path in variables}
    present = {path.rpartition("/")[0] for path in found}
    for title, declared in GROUPS[kind].items():
        group, _, sort = title.partition(",")
        if group not in present and group not in ALWAYS.get(kind, ()):
            continue
        for name, expected in declared.items():
            due = not sort and expected.stored is None and expected.since <= minor_of(schema)
            if due and f"{group}/{name}" not in found:
                yield f"variable {group}/{name}: it is missing"


def _declared(kind: str, group: str, name: str) -> list[StoredVariable]:
    """All declarations of a variable: a group may differ with the sort of results."""
    tables = (declared for title, declared in GROUPS[kind].items() if title.partition(",")[0] == group)
    return [declared[name] for declared in tables if name in declared]


def _difference(found: h5py.Dataset, expected: StoredVariable, units: bool) -> str:
    text = h5py.check_string_dtype(found.dtype) is not None
    if text != (expected.kind is str) or (not text and found.dtype.kind != np.dtype(expected.kind).kind):
        return f"expected values of type {np.dtype(expected.kind).name}, found {found.dtype}"
    sizes = {len(expected.dims), len([name for name in expected.dims if name != "case"])}
    if found.ndim not in sizes:
        return f"expected the dimensions ({', '.join(expected.dims)}), found the shape {found.shape}"
    for name, value in (("units", expected.units if units else None), ("long_name", None)):
        held = found.attrs.get(name)
        if not isinstance(held, str) or value not in (None, held):
            return f"expected the attribute {name}{'' if value is None else f' {value!r}'}, found {held!r:.60}"
    if expected.words:
        values, words = found.attrs.get("flag_values"), found.attrs.get("flag_meanings")
        if not isinstance(words, str) or np.size(values) != len(words.split()) or np.asarray(values).dtype.kind != "i":
            return "expected flag_values and as many words in flag_meanings"
    return ""
