"""Whether an HDF5 file, which may come from anybody, holds all that it shows: no link out of it, no endless array."""

from __future__ import annotations

from itertools import islice

import h5py

from rockpulse.errors import ResultsError
from rockpulse.storage.netcdf4 import says_no_variable

__all__ = ["contained"]

#: Most groups and variables that are looked at; results have some hundreds.
OBJECTS = 10_000
#: Bytes that deflate packs into one at the most, and bytes of a variable that need not be in the file at all.
PACKED, FREE = 1100, 1024**2
#: Filters that results are written with; HDF5 looks for others among the plugins of the machine.
FILTERS = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)


def contained(hdf5: h5py.File) -> dict[str, h5py.Dataset]:
    """Every dataset of an open file by its path, looked at before anything of it is read.

    Raises
    ------
    ResultsError
        For a soft or external link, an object that stands in two places, values that are kept in other files (external
        storage, virtual datasets), a filter that results do not have, an array that declares far more values than the
        file has room for, and more than `OBJECTS` objects.
    """
    found: dict[str, h5py.Dataset] = {}
    waiting, seen = [hdf5["/"]], {h5py.h5o.get_info(hdf5["/"].id).addr}
    while waiting:
        group = waiting.pop()
        for name in islice(group, OBJECTS):
            path = f"{group.name.rstrip('/')}/{name}"
            where = f"{hdf5.filename}: {path}"
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                raise ResultsError(f"{where}: a link to somewhere else, which results do not have; it is not followed")
            item = group[name]
            if isinstance(item, h5py.Dataset):
                _check_dataset(where, item)
                found[path] = item
            elif isinstance(item, h5py.Group):
                waiting.append(item)
            else:
                raise ResultsError(f"{where}: expected a group or a variable, found a type")
            address = h5py.h5o.get_info(item.id).addr
            if address in seen:
                raise ResultsError(f"{where}: this object stands in the file under another name too")
            seen.add(address)
            if len(seen) > OBJECTS:
                raise ResultsError(f"{hdf5.filename}: more than {OBJECTS} groups and variables, which no results have")
    return found


def _check_dataset(where: str, dataset: h5py.Dataset) -> None:
    created = dataset.id.get_create_plist()
    if created.get_layout() == h5py.h5d.VIRTUAL or created.get_external_count():
        raise ResultsError(f"{where}: its values are kept in another file, which is not read")
    filters = [created.get_filter(number) for number in range(created.get_nfilters())]
    if foreign := [name.decode("ascii", "replace") for code, _, _, name in filters if code not in FILTERS]:
        raise ResultsError(f"{where}: packed by {', '.join(foreign)}, which results are not")
    if h5py.h5ds.is_scale(dataset.id) and says_no_variable(dataset.attrs.get("NAME")):
        return  # a dimension alone has a length and no values, and is never read
    declared, held = (dataset.size or 0) * dataset.dtype.itemsize, dataset.id.get_storage_size()
    if declared > FREE + PACKED * held:
        raise ResultsError(f"{where}: declares {declared:,} bytes of values, of which the file holds {held:,}")
