"""What was changed in a results file, or in its inputs, is found and named."""

import gzip
import hashlib
import shutil
import zipfile

import h5py
import numpy as np
import pytest
import xarray as xr
from nominal import Config
from results_tree import small_tree

import rockpulse as rp
from rockpulse import ModelSettings, RecordSettings
from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5 import results_file as store
from rockpulse.storage.hdf5.results_file import load_tree, save
from rockpulse.storage.hdf5.verification import verify
from rockpulse.storage.hdf5.writer import CHECKSUM, CHECKSUM_OF_ATTRIBUTES, TreeWriter, VariableChecksum


def changes(path):
    """The differences of a small site file, which has few of the variables of a site."""
    return tuple(one for one in verify(path).differences if not one.endswith("it is missing"))


def sha256(content):
    return hashlib.sha256(content).hexdigest()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Input files of every sort, and the results of records that were read from them."""
    folder = tmp_path_factory.mktemp("verify")
    (folder / "one.txt").write_bytes(b"first")
    (folder / "two; half!.txt").write_bytes(b"second")
    for name in ("three.txt.gz", "more.txt.gz"):
        (folder / name).write_bytes(gzip.compress(b"third"))
    with zipfile.ZipFile(folder / "all.zip", "w") as archive:
        archive.writestr("a/four.txt", b"fourth")
        archive.writestr("five.txt", b"fifth")
    sources = {
        f"{folder}/one.txt": sha256(b"first"),
        f"{folder}/two; half!.txt": sha256(b"second"),
        f"{folder}/three.txt.gz": sha256(b"third"),
        f"{folder}/more.txt.gz": sha256(b"third"),
        f"{folder}/all.zip!a/four.txt; {folder}/all.zip!five.txt": f"{sha256(b'fourth')}; {sha256(b'fifth')}",
        f"{folder}/gone.txt": sha256(b"gone"),
        "": "",
    }
    time = np.arange(0.0, 4.0, 0.01)
    records = [
        rp.Record(3.0 * np.sin(2.0 * np.pi * time), 0.01, f"r{number}", source=source, source_sha256=checksum)
        for number, (source, checksum) in enumerate(sources.items())
    ]
    config = Config(models=Config().models.__class__(use=("resonance",)))
    blocks = {"pier": rp.models.Block(1.0, 3.873)}
    save(rp.assess(records, config, blocks), folder / "results.h5")
    return folder


@pytest.fixture
def results(folder, tmp_path):
    """A copy that may be changed."""
    return shutil.copy(folder / "results.h5", tmp_path / "results.h5")


def every(file):
    """The variables of a file."""
    return [item for group in file.values() if isinstance(group, h5py.Group) for item in group.values()]


def test_an_untouched_file_is_as_it_was_written(folder, results):
    found, without_inputs = verify(results), verify(results, inputs=False)
    assert found.differences == ()
    assert found.absent == (f"{folder}/gone.txt",)
    assert found.inputs == 6
    assert found.variables > 60
    assert (found.kind, found.schema) == ("assessment", store.SCHEMA_VERSION)
    assert (without_inputs.inputs, without_inputs.absent) == (0, ())


def _set(path, value):
    def change(file):
        file[path][0] = value

    return change


def _nudge(file):
    values = file["summary/uplift_ratio"]
    values[2, 0] = np.nextafter(values[2, 0], np.inf)


def _attribute(path, name, value):
    return lambda file: file[path].attrs.__setitem__(name, value)


#: Each is named, all of them in one file.
CHANGES = {
    "a number": (_set("summary/pga", 1.0), "variable /summary/pga: its values were changed"),
    "the last digit": (_nudge, "variable /summary/uplift_ratio: its values"),
    "a flag": (_set("summary/outcome", 3), "variable /summary/outcome: its values"),
    "a text": (_set("summary/record", "r9"), "variable /summary/record: its values"),
    "a unit": (
        _attribute("summary/dt", "units", "ms"),
        "variable /summary/dt: expected the attribute units 's', found 'ms'",
    ),
    "a variable more": (
        lambda file: file["summary"].create_dataset("mine", data=[1.0]).dims[0].attach_scale(file["summary/block"]),
        "variable /summary/mine: it has no checksum",
    ),
    "a variable more, without dimensions": (
        lambda file: file["summary"].create_dataset("bare", data=[1.0, 2.0]),
        "variable /summary/bare: it has no checksum",
    ),
    "a variable less": (lambda file: file.__delitem__("summary/pgv"), "variable /summary/pgv: it is missing"),
    "a name": (lambda file: file.move("summary/npts", "summary/number"), "variable /summary/npts: it is missing"),
}
#: Each in a file of its own: of all of them no more is told than that there is one.
OF_ATTRIBUTES = {
    "a root attribute": _attribute("/", "title", "mine"),
    "an attribute of a variable": _attribute("site/x", "flag_meanings", "a b c d"),
    "a group attribute": _attribute("site", "note", "x"),
    "an empty group": lambda file: file.create_group("mine"),
}


@pytest.mark.sweep
def test_changes_are_found_and_named(results):
    with h5py.File(results, "a") as file:
        for change, _ in CHANGES.values():
            change(file)
    told = "\n".join(verify(results, inputs=False).differences)
    assert [name for name, (_, message) in CHANGES.items() if message not in told] == []


@pytest.mark.parametrize("name", OF_ATTRIBUTES)
def test_a_change_of_attributes_or_names_is_found(tmp_path, name):
    save(small_tree(), tmp_path / "site.h5")
    with h5py.File(tmp_path / "site.h5", "a") as file:
        OF_ATTRIBUTES[name](file)
    (told,) = changes(tmp_path / "site.h5")
    assert "attributes, or the names or dimensions of variables" in told


@pytest.mark.parametrize(
    "count", [pytest.param(10, marks=pytest.mark.sweep), pytest.param(300, marks=pytest.mark.slow)]
)
def test_any_damaged_byte_is_found_or_changes_nothing(results, count):
    whole = results.read_bytes()
    untouched = load_tree(results)
    found = 0
    for offset in range(8, len(whole), len(whole) // count):
        results.write_bytes(whole[:offset] + bytes([whole[offset] ^ 0x10]) + whole[offset + 1 :])
        try:
            differences = verify(results, inputs=False).differences
        except ResultsError:
            found += 1
            continue
        if differences:
            found += 1
        else:
            xr.testing.assert_identical(load_tree(results), untouched)
    assert found > count // 8


@pytest.mark.sweep
def test_a_file_without_checksums_says_so(results):
    with h5py.File(results, "a") as file:
        del file.attrs[CHECKSUM_OF_ATTRIBUTES]
        for variable in every(file):
            variable.attrs.pop(CHECKSUM, None)
    assert verify(results, inputs=False).differences == (
        "the file has no checksums: it was written by another program",
    )


#: By file other contents, and whether they are those of another record.
OTHERS = {
    "one.txt": (b"other", True),
    "two; half!.txt": (b"", True),
    "three.txt.gz": (gzip.compress(b"other", mtime=0), True),
    "more.txt.gz": (gzip.compress(b"third", compresslevel=1, mtime=7), False),  # other bytes around the same record
}


@pytest.mark.sweep
def test_an_input_that_changed_is_named(folder, results):
    before = {name: (folder / name).read_bytes() for name in OTHERS}
    try:
        for name, (content, _) in OTHERS.items():
            (folder / name).write_bytes(content)
        differences = verify(results).differences
    finally:
        for name, content in before.items():
            (folder / name).write_bytes(content)
    for name, (_, changed) in OTHERS.items():
        assert sum(one.startswith(f"input {folder}/{name}: it ") for one in differences) == changed, name
    assert len(differences) == 3


@pytest.mark.sweep
def test_an_input_inside_an_archive_that_changed_is_named(folder, results):
    before = (folder / "all.zip").read_bytes()
    with zipfile.ZipFile(folder / "all.zip", "w") as archive:
        archive.writestr("five.txt", b"other")
    try:
        found = verify(results)
        (folder / "all.zip").write_bytes(before[:50])
        damaged = verify(results)
    finally:
        (folder / "all.zip").write_bytes(before)
    assert found.differences == (
        f"input {folder}/all.zip!a/four.txt: it can no longer be read (the archive no longer has this member)",
        f"input {folder}/all.zip!five.txt: it is not the file that was read (its SHA-256 differs)",
    )
    assert all("can no longer be read" in text and "damaged zip" in text for text in damaged.differences)
    assert len(damaged.differences) == 2


@pytest.mark.sweep
def test_inputs_are_found_from_any_folder(golden, tmp_path, monkeypatch):
    """They were named from a folder that is not this one; the configuration knows where they are."""
    config = Config(
        records=RecordSettings(paths=(str(golden.records),), store="none"), models=ModelSettings(use=("resonance",))
    )
    blocks = {"pier": rp.models.Block(1.0, 3.873)}
    monkeypatch.chdir(golden.folder)
    records, _ = rp.read_all("records")
    save(rp.assess(records, config, blocks), tmp_path / "results.h5")
    monkeypatch.chdir(tmp_path)
    found = verify("results.h5")
    assert (found.inputs, found.absent, found.differences) == (5, (), ())


def test_the_checksum_is_the_documented_one(results):
    with h5py.File(results) as file:
        pga, record, outcome = (file[f"summary/{name}"] for name in ("pga", "record", "outcome"))
        assert pga.attrs[CHECKSUM] == sha256(b"float64 7\n" + pga[:].astype("<f8").tobytes())
        assert record.attrs[CHECKSUM] == sha256(b"text 7\n" + b"".join(text + b"\0" for text in record[:]))
        assert outcome.attrs[CHECKSUM] == sha256(b"int8 7x1x1\n" + outcome[:].tobytes())


def test_a_checksum_does_not_depend_on_the_pieces_or_the_byte_order():
    values = np.arange(24.0).reshape(6, 4)
    whole, pieces, turned = (VariableChecksum(values.dtype, values.shape) for _ in range(3))
    whole.add(values)
    for row in values:
        pieces.add(row[np.newaxis])
    turned.add(np.asfortranarray(values).astype(">f8"))
    assert whole.hexdigest() == pieces.hexdigest() == turned.hexdigest()


def test_a_writer_that_was_given_too_little_or_too_much_says_so(tmp_path):
    def write(*counts):
        with TreeWriter(tmp_path / "x.h5", {}) as writer:
            writer.add_group("/a", {"row": 3}, {})
            writer.add_variable("/a/b", ("row",), np.dtype(float), {})
            for count in counts:
                writer.append("/a/b", np.zeros(count))

    write(1, 2)
    with pytest.raises(ValueError, match="/a/b: expected 3 values, found 2"):
        write(1, 1)
    with pytest.raises(ValueError, match=r"/a/b: expected .* \(3,\) from index 2 on, found the shape \(2"):
        write(2, 2)


def test_every_variable_lies_in_one_piece(results):
    with h5py.File(results) as file:
        assert {variable.chunks for variable in every(file) if variable.size} == {None}


def test_a_coordinate_beside_the_dimensions_comes_back_as_one(tmp_path):
    tree = small_tree()
    described = {"units": "1", "long_name": "one more"}
    tree["site"] = (
        tree["site"].to_dataset().assign_coords(row=("y", np.arange(2), described), scalar=((), 2.5, described))
    )
    save(tree, tmp_path / "site.h5")
    back = load_tree(tmp_path / "site.h5")["site"].to_dataset()
    assert {"row", "scalar"} <= set(back.coords)
    xr.testing.assert_identical(back, tree["site"].to_dataset())
    assert changes(tmp_path / "site.h5") == ()
