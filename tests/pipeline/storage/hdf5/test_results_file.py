"""The results file: the same tree back, whole or not at all, and refused where it is not ours."""

import os
import threading
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from results_tree import results_bytes, results_tree, small_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5 import atomic as target_file
from rockpulse.storage.hdf5 import results_file as store
from rockpulse.storage.hdf5.atomic import check_target
from rockpulse.storage.hdf5.results_file import load_tree, save


def assert_same_nodes(one, other):
    assert [node.path for node in one.subtree] == [node.path for node in other.subtree]
    for node in one.subtree:
        back = other[node.path].to_dataset(inherit=False)
        given = node.to_dataset(inherit=False)
        if node.path != "/":
            xr.testing.assert_identical(given, back)
        for name, variable in given.variables.items():
            assert back[name].dtype.kind == variable.dtype.kind, name
            assert list(back[name].dims) == list(variable.dims), name


@pytest.mark.sweep
def test_a_tree_that_was_loaded_is_saved_and_loaded_again_the_same(tmp_path):
    (tmp_path / "first.h5").write_bytes(results_bytes())
    first = load_tree(tmp_path / "first.h5")
    assert_same_nodes(results_tree(), first)
    save(first, tmp_path / "second.h5")
    second = load_tree(tmp_path / "second.h5")
    assert_same_nodes(first, second)
    assert {**second.attrs, "history": ""} == {**first.attrs, "history": ""}
    assert second.attrs["history"].startswith(first.attrs["history"] + "\n")


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """The tree, saved and loaded."""
    path = tmp_path_factory.mktemp("loaded") / "results.h5"
    path.write_bytes(results_bytes())
    return load_tree(path)


def test_provenance_is_complete(loaded):
    attrs = loaded.attrs
    assert attrs["Conventions"] == "CF-1.11"
    assert attrs["schema_version"] == store.SCHEMA_VERSION
    assert attrs["numpy_version"] == np.__version__
    assert {"rockpulse_version", "python_version", *(f"{name}_version" for name in store.PACKAGES)} <= set(attrs)
    assert "written by rockpulse" in attrs["history"]


def test_a_file_name_in_an_odd_encoding_does_not_spoil_the_results(tmp_path):
    tree = small_tree()
    tree["site"]["word"].values[:] = np.array([os.fsdecode(b"caf\xe9.txt"), ""])
    save(tree, tmp_path / "results.h5")
    assert load_tree(tmp_path / "results.h5")["site"]["word"].values[0] == "caf\ufffd.txt"


@pytest.mark.parametrize("attribute", ["units", "long_name"])
def test_a_variable_without_unit_or_name_is_refused_by_name(tmp_path, attribute):
    tree = small_tree()
    del tree["site"]["x"].attrs[attribute]
    with pytest.raises(ResultsError, match=rf"/site/x has no '{attribute}'"):
        save(tree, tmp_path / "results.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_exists_is_refused_and_stays_intact(tmp_path):
    target = tmp_path / "results.h5"
    target.write_bytes(b"old")
    for attempt in (lambda: check_target(target), lambda: save(small_tree(), target)):
        with pytest.raises(ResultsError, match=r"results\.h5: the file exists; .*--overwrite"):
            attempt()
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def attribute(path, name):
    """One of the root, by bare h5py."""
    with h5py.File(path) as file:
        return file.attrs[name]


def old_results(target):
    """Results of an earlier run; their bytes."""
    save(small_tree("of an earlier run"), target)
    return target.read_bytes()


@pytest.mark.parametrize("part", [0.0, 0.5])
def test_truncated_results_are_refused_and_replaced(tmp_path, part):
    target = tmp_path / "results.h5"
    whole = old_results(target)
    target.write_bytes(whole[: int(part * len(whole))])
    with pytest.raises(ResultsError, match=r"results\.h5: "):
        load_tree(target)
    if part:  # an empty file might be anything
        save(small_tree(), target, overwrite=True)
        assert attribute(target, "title") == "Borgo"


def test_results_of_another_schema_are_replaced(tmp_path):
    _with_attribute(tmp_path / "results.h5", schema_version="1.5", title="old")
    tree = small_tree()
    before = dict(tree.attrs)
    save(tree, tmp_path / "results.h5", overwrite=True)
    assert attribute(tmp_path / "results.h5", "title") == "Borgo"
    assert tree.attrs == before


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_fault_while_writing_leaves_the_old_file_and_no_rubbish(tmp_path, monkeypatch, step):
    target = tmp_path / "results.h5"
    old = old_results(target)

    def fail(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(target_file.os, step, fail)
    with pytest.raises(ResultsError, match=r"cannot write the results: No space left on device"):
        save(small_tree(), target, overwrite=True)
    assert target.read_bytes() == old
    assert list(tmp_path.iterdir()) == [target]


def test_a_file_that_appears_during_the_run_is_not_replaced(tmp_path, monkeypatch):
    target = tmp_path / "results.h5"
    flush = target_file.flush

    def meanwhile(path, mode):
        target.write_bytes(b"of somebody else")
        flush(path, mode)

    monkeypatch.setattr(target_file, "flush", meanwhile)
    with pytest.raises(ResultsError, match="the file exists"):
        save(small_tree(), target)
    assert target.read_bytes() == b"of somebody else"
    assert list(tmp_path.iterdir()) == [target]


def test_two_writers_at_once_leave_one_whole_file(tmp_path):
    target = tmp_path / "results.h5"
    writers = [threading.Thread(target=save, args=(small_tree(), target, True)) for _ in range(2)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert_same_nodes(small_tree(), load_tree(target))
    assert list(tmp_path.iterdir()) == [target]


def _with_attribute(path, **attrs):
    save(small_tree(), path)
    with h5py.File(path, "a") as file:
        file.attrs.update(attrs)


@pytest.mark.parametrize(("kind", "verb"), [("site calibration", "calibrate"), ("fragility", "fragility")])
def test_a_refused_file_names_the_verb_that_makes_it(tmp_path, kind, verb):
    group = store.KINDS[kind]
    save(xr.DataTree.from_dict({"/": xr.Dataset(attrs={"kind": kind}), f"/{group}": xr.Dataset()}), tmp_path / "f.h5")
    with h5py.File(tmp_path / "f.h5", "a") as file:
        file.attrs["schema_version"] = "1.5"
    with pytest.raises(ResultsError, match=f"expected schema version 2.0, found 1.5; run 'rockpulse {verb}' again"):
        load_tree(tmp_path / "f.h5")


def test_files_that_are_not_ours_are_refused(tmp_path):
    text, foreign, numbered = tmp_path / "notes.txt", tmp_path / "foreign.h5", tmp_path / "numbered.h5"
    text.write_text("no results")
    with h5py.File(foreign, "w") as file:
        file["summary"] = 1.0
    with h5py.File(numbered, "w") as file:
        file.attrs["schema_version"] = "1.0"
    with pytest.raises(ResultsError, match=r"notes\.txt: not a rockpulse results file"):
        load_tree(text)
    for path in (foreign, numbered):
        with pytest.raises(ResultsError, match="not written by rockpulse"):
            load_tree(path)
    with pytest.raises(FileNotFoundError):
        load_tree(tmp_path / "none.h5")


@pytest.mark.sweep
@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="needs /proc to list open files")
def test_load_closes_the_file(tmp_path):
    target = tmp_path / "results.h5"
    target.write_bytes(results_bytes())
    tree = load_tree(target)
    opened = [str(link.readlink()) for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
    assert str(target) not in opened
    assert tree["summary"]["pga"].values[0] == 5.5574


def test_an_ordinary_umask_decides_who_may_read_the_results(tmp_path):
    before = os.umask(0o022)
    try:
        save(small_tree(), tmp_path / "results.h5")
    finally:
        os.umask(before)
    assert (tmp_path / "results.h5").stat().st_mode & 0o777 == 0o644
