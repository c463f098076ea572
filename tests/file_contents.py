"""Read the whole content of an HDF5 file with h5py, to compare two files."""

import h5py
import numpy as np

#: References, which are addresses in the file: the dimensions are told by name.
REFERENCES = {"DIMENSION_LIST", "REFERENCE_LIST"}
#: What tells two runs apart that do the same: when, under which identity, and the checksum over both.
OF_THE_RUN = {"history", "run_id", "run_digest", "run_settings", "run_rows", "attributes_sha256"}


def contents(path):
    """By path of each group and variable its attributes, ``@name``, and of a variable its dimensions and values."""
    found = {}

    def look(name, item):
        left_out = REFERENCES | (OF_THE_RUN if name == "/" else set())
        found[name] = {f"@{key}": np.asarray(value) for key, value in item.attrs.items() if key not in left_out}
        if isinstance(item, h5py.Dataset):
            dimensions = [" ".join(scale.name for scale in dimension.values()) for dimension in item.dims]
            found[name] |= {"dimensions": np.array(dimensions, str), "values": np.asarray(item[()])}

    with h5py.File(path) as file:
        look("/", file)
        file.visititems(look)
    return found


def assert_contents(path, expected):
    """Whether a file holds what :func:`contents` has found in another: type for type, bit for bit."""
    found = contents(path)
    assert sorted(found) == sorted(expected)
    for name, parts in found.items():
        assert sorted(parts) == sorted(expected[name]), name
        for key, values in parts.items():
            np.testing.assert_array_equal(values, expected[name][key], strict=True, err_msg=f"{name} {key}")
