"""The files are netCDF-4: laid out as h5netcdf lays them out, and read by xarray as by the project's own reader."""

import shutil

import h5py
import numpy as np
import pytest
import xarray as xr

from rockpulse.storage.hdf5.netcdf4 import attributes, dataset_of, groups_of, variables_of
from rockpulse.storage.hdf5.writer import attributes_checksum, write_tree

NOT_COMPARED = {"sha256", "attributes_sha256"}  # what rockpulse adds


@pytest.fixture(scope="module")
def tree():
    summary = xr.Dataset(
        {
            "pga": ("record", [1.0, np.nan], {"units": "m s^-2", "long_name": "peak"}),
            "outcome": (
                ("record", "block"),
                np.array([[0, 1, 2], [2, 1, 0]], np.int8),
                {"flag_values": np.array([0, 1, 2], np.int8), "flag_meanings": "a b c", "one": np.array([3])},
            ),
            "words": (("block", "case"), np.array([["é", ""], ["b", "c"], ["d", "e"]], object)),
            "number": ((), 3.5),
            "count": ((), 7),
        },
        coords={"record": ["one", "two"], "rate": ("record", [1.0, 2.0])},
        attrs={"comment": "of a group", "limits": [0.5, 2.0], "one": 1, "factor": np.float32(0.5), "code": b"ab"},
    )
    empty = xr.Dataset({"values": ("row", np.empty(0)), "names": ("row", np.empty(0, str))})
    odd = xr.Dataset({"values": ("case", [1, 2, 3]), "case": ("row", [0.5, 0.25])})  # not along its own dimension
    root = xr.Dataset(attrs={"kind": "a test", "runs": 2})
    return xr.DataTree.from_dict({"/": root, "/summary": summary, "/empty": empty, "/odd": odd})


@pytest.fixture(scope="module")
def files(tree, tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    write_tree(tree, folder / "own.h5", tree.attrs)
    tree.to_netcdf(folder / "other.h5", engine="h5netcdf", encoding={})
    return folder / "own.h5", folder / "other.h5"


def attribute(item, name):
    """Type and value of an attribute; references as the paths that they lead to."""
    stored, value = item.attrs.get_id(name), item.attrs[name]
    kind = stored.get_type()
    text = (kind.is_variable_str(), kind.get_cset()) if kind.get_class() == h5py.h5t.STRING else None
    if name == "REFERENCE_LIST":
        value = sorted((item.file[one].name, int(axis)) for one, axis in value)
    elif name == "DIMENSION_LIST":
        value = [[item.file[one].name for one in scales] for scales in value]
    elif name == "_NCProperties":
        value = None  # who wrote it
    size = None if value is None else kind.get_size()
    return kind.get_class(), size, text, stored.shape, repr(value)


def in_order(item):
    """Names of attributes as they were made; h5netcdf writes the number of a file's first dimension twice."""
    first = item.attrs.get("_Netcdf4Dimid") == 0
    return [name for name in item.attrs if name not in NOT_COMPARED and not (first and name == "_Netcdf4Dimid")]


def described(item):
    told = {name: attribute(item, name) for name in item.attrs if name not in NOT_COMPARED}
    made = item.id.get_create_plist()
    if not isinstance(item, h5py.Dataset):
        return told, in_order(item), list(item), made.get_link_creation_order(), made.get_attr_creation_order()
    return (
        told,
        in_order(item),
        item.shape,
        item.maxshape,
        item.dtype,
        repr(item.fillvalue),
        made.fill_value_defined(),
        item.chunks,
        made.get_attr_creation_order(),
        repr(item[()]),
    )


def test_every_object_is_as_h5netcdf_writes_it(files):
    """Their order too."""
    with h5py.File(files[0]) as own, h5py.File(files[1]) as other:
        paths = [["/"], ["/"]]
        for file, names in zip((own, other), paths, strict=True):
            file.visit(names.append)
        assert paths[0] == paths[1]
        assert len(paths[0]) > 15
        for path in paths[0]:
            assert described(own[path]) == described(other[path]), path


def test_a_group_is_read_as_xarray_reads_it_undecoded(files):
    with h5py.File(files[0]) as file:
        for group in ("summary", "empty", "odd"):
            own = dataset_of(file[group])
            with xr.open_dataset(files[0], group=group, engine="h5netcdf", decode_cf=False) as other:
                assert own.identical(other)
                assert own.sizes == other.sizes
                assert set(own.variables) == set(other.variables)
            values = own["outcome" if group == "summary" else "values"]
            np.testing.assert_array_equal(values.values, file[group][values.name][()])


@pytest.mark.parametrize(
    ("variable", "attrs", "error", "message"),
    [
        ([True], {}, TypeError, "/g/a: expected numbers or strings, found True or False"),
        ([1.0], {"open": True}, TypeError, "/g/a: attribute 'open': expected numbers or strings"),
        ([1.0], {"NAME": "x"}, ValueError, "/g/a: an attribute cannot have the name 'NAME'"),
    ],
)
def test_what_netcdf_cannot_hold_is_refused(tmp_path, variable, attrs, error, message):
    tree = xr.DataTree.from_dict({"/g": xr.Dataset({"a": ("x", variable, attrs)})})
    with pytest.raises(error, match=message):
        write_tree(tree, tmp_path / "odd.h5", {})


def test_a_dataset_of_two_names_is_two_variables(files, tmp_path):
    copy = shutil.copy(files[0], tmp_path / "copy.h5")
    with h5py.File(copy, "a") as file:
        file["summary/again"] = file["summary/pga"]
        found = dataset_of(file["summary"])
        assert found["again"].identical(found["pga"].rename("again"))
        assert found["words"].dims == ("block", "case")


def test_the_checksum_of_attributes_is_that_of_the_file(files):
    with h5py.File(files[0]) as file:
        attrs = {group.name: attributes(group) for group in groups_of(file)}
        dims = {}
        for group in groups_of(file):
            for variable in variables_of(group):
                path = f"{group.name.rstrip('/')}/{variable.name}"
                attrs[path], dims[path] = attributes(variable.stored), variable.dimensions()
        assert attributes_checksum(attrs, dims) == file.attrs["attributes_sha256"]


def test_a_variable_without_dimensions_is_refused(tmp_path):
    with h5py.File(tmp_path / "odd.h5", "w") as file:
        file["values"] = [1.0, 2.0]
        with pytest.raises(ValueError, match="'values' has 1 dimensions, of which 0 have a name"):
            dataset_of(file)
