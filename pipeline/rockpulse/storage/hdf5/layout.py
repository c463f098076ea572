"""Checks a results file from an unknown source: no external links, no oversized arrays, only known variables."""

from collections.abc import Iterator, Mapping
from itertools import islice

import h5py
import numpy as np

from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5.atomic import ASSESSMENT
from rockpulse.storage.hdf5.netcdf4 import NOT_A_COORDINATE, is_bare_dimension
from rockpulse.storage.variables import Declared, StoredVariable
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS
from rockpulse.storage.variables.fragility import FRAGILITY, FRAGILITY_GROUPS
from rockpulse.storage.variables.site import SITE_GROUPS, SITE_KIND

#: Declared variables by kind of file and by group; after a comma, the name of a group states its variant.
GROUPS: dict[str, dict[str, Declared]] = {
    ASSESSMENT: ASSESSMENT_GROUPS,
    FRAGILITY: FRAGILITY_GROUPS,
    SITE_KIND: SITE_GROUPS,
}

#: Groups that every file of each kind contains.
ALWAYS = {ASSESSMENT: ASSESSMENT_GROUPS.keys() - {"/spectra", "/directions", "/records"}}


def wrong_variables(variables: Mapping[str, h5py.Dataset], kind: str, units: bool = True) -> Iterator[str]:
    """Yield a message for each variable whose type, shape or (with `units`) unit differs from the declared one."""
    for path, variable in variables.items():
        if is_bare_dimension(variable.attrs.get("NAME")):
            continue
        group, _, name = path.rpartition("/")
        name = name.removeprefix(NOT_A_COORDINATE)
        differences = [  # a group may have several variants
            _difference(variable, declared[name], units)
            for title, declared in GROUPS[kind].items()
            if title.partition(",")[0] == group and name in declared
        ]
        if differences and all(differences):
            yield f"variable {path}: {differences[0]}"


def missing_variables(variables: Mapping[str, h5py.Dataset], kind: str) -> Iterator[str]:
    """Yield a message for each required variable that the file does not contain."""
    found = {path.replace(f"/{NOT_A_COORDINATE}", "/") for path in variables}
    present = {path.rpartition("/")[0] for path in found}
    for title, declared in GROUPS[kind].items():
        group, _, sort = title.partition(",")
        if group not in present and group not in ALWAYS.get(kind, ()):
            continue
        for name, expected in declared.items():
            due = not sort and expected.stored is None
            if due and f"{group}/{name}" not in found:
                yield f"variable {group}/{name}: it is missing"


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


#: Largest number of groups and variables in a file; results have a few hundred.
OBJECTS = 10_000
#: Largest compression ratio of deflate; size of a variable up to which its values may be missing in the file [bytes].
PACKED, FREE = 1100, 1024**2
#: HDF5 filters that results use; for any other filter HDF5 would load a plugin that is installed on the machine.
FILTERS = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)


def checked_datasets(hdf5: h5py.File) -> dict[str, h5py.Dataset]:
    """Return all datasets of an open file by path; raise ResultsError if the file is not safe to read."""
    found: dict[str, h5py.Dataset] = {}
    waiting, seen = [hdf5["/"]], {h5py.h5o.get_info(hdf5["/"].id).addr}
    while waiting:
        group = waiting.pop()
        for name in islice(group, OBJECTS):
            path = f"{group.name.rstrip('/')}/{name}"
            where = f"{hdf5.filename}: {path}"
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                raise ResultsError(
                    f"{where}: expected a group or a variable, found a link to another place, which is not followed"
                )
            item = group[name]
            if isinstance(item, h5py.Dataset):
                _check_dataset(where, item)
                found[path] = item
            elif isinstance(item, h5py.Group):
                waiting.append(item)
            else:
                raise ResultsError(f"{where}: expected a group or a variable, found a named data type")
            address = h5py.h5o.get_info(item.id).addr
            if address in seen:
                raise ResultsError(f"{where}: this object appears in the file under another name too")
            seen.add(address)
            if len(seen) > OBJECTS:
                raise ResultsError(
                    f"{hdf5.filename}: more than {OBJECTS} groups and variables, more than any results file has"
                )
    return found


def _check_dataset(where: str, dataset: h5py.Dataset) -> None:
    created = dataset.id.get_create_plist()
    if created.get_layout() == h5py.h5d.VIRTUAL or created.get_external_count():
        raise ResultsError(f"{where}: its values are kept in another file, which is not read")
    filters = [created.get_filter(number) for number in range(created.get_nfilters())]
    if foreign := [name.decode("ascii", "replace") for code, _, _, name in filters if code not in FILTERS]:
        raise ResultsError(f"{where}: compressed by {', '.join(foreign)}, which results files never use")
    if h5py.h5ds.is_scale(dataset.id) and is_bare_dimension(dataset.attrs.get("NAME")):
        return  # a dimension without a variable has a length but no values to be read
    declared, held = (dataset.size or 0) * dataset.dtype.itemsize, dataset.id.get_storage_size()
    if declared > FREE + PACKED * held:
        raise ResultsError(f"{where}: declares {declared:,} bytes of values, but the file contains {held:,}")
