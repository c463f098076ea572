"""Full disks, places that cannot be written, and what lies where the journal should be."""

import re
import shutil

import pytest
from batch_runs import command, names, records_in
from file_contents import assert_contents, contents


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Eight records of 6,000 samples: 48 kB in the results, a page of 64 kB in the journal."""
    return records_in(tmp_path_factory.mktemp("long records"), 8, 6000)


@pytest.fixture(scope="module")
def undisturbed(folder, tmp_path_factory):
    target = tmp_path_factory.mktemp("undisturbed") / "results.h5"
    assert command(folder, target, "--quiet") == 0
    return contents(target)


@pytest.mark.sweep
def test_a_disk_that_fills_up_keeps_what_is_finished(folder, tmpfs, undisturbed, capsys):
    place, change = tmpfs
    target = place / "results.h5"
    change("size=400k")
    assert command(folder, target, "--quiet") == 2
    said = capsys.readouterr().err
    kept = re.search(
        r"cannot store the result of r\d\.090: .*; the (\d) records finished before are kept: free some", said
    )
    assert 0 < int(kept[1]) < 8
    assert said.count("\n") == 1
    assert not target.exists()
    change("size=16m")
    assert command(folder, target, "--resume") == 0
    assert f"{kept[1]} of 8 records were finished before\n" in capsys.readouterr().err
    assert_contents(target, undisturbed)
    assert names(place) == [target.name]


@pytest.mark.sweep
def test_a_disk_that_fills_up_while_the_results_are_written(folder, tmpfs, undisturbed, monkeypatch, capfd):
    place, change = tmpfs
    target = place / "results.h5"
    change("size=700k")
    with monkeypatch.context() as patch:  # somebody else takes the room that was there
        patch.setattr("shutil.disk_usage", lambda path: shutil._ntuple_diskusage(10**9, 0, 10**9))
        assert command(folder, target, "--quiet") == 2
    said = capfd.readouterr().err
    assert "results.h5: cannot write the results: No space left on device; 8 finished records are kept" in said
    assert not target.exists()
    assert not list(place.glob(".*.part"))
    change("size=16m")
    assert command(folder, target, "--quiet", "--resume") == 0
    assert_contents(target, undisturbed)


def test_a_name_that_leaves_no_room_for_that_of_the_unfinished_file_is_refused(folder, tmp_path, capsys):
    assert command(folder, tmp_path / ("n" * 241)) == 2
    assert "File name too long" in capsys.readouterr().err
    assert names(tmp_path) == []


@pytest.mark.sweep
def test_a_read_only_disk_is_refused_at_once(folder, tmpfs, capsys):
    place, change = tmpfs
    change("ro")
    for options in ([], ["--resume"], ["--overwrite"]):
        assert command(folder, place / "results.h5", *options) == 2
        assert "Read-only file system" in capsys.readouterr().err
    change("rw")


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("file/results.h5", "there is no folder .*file; create it first"),
        ("gone/results.h5", r"there is no folder .*gone; create it first"),
        ("folder", "found a folder or a device"),
        ("file", "the file exists|found another file, which is not replaced"),
    ],
)
def test_a_place_that_takes_no_results_is_refused_at_once(folder, tmp_path, capsys, target, message):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    assert command(folder, tmp_path / target, "--resume") == 2
    said = capsys.readouterr().err
    assert re.search(message, said)
    assert str(tmp_path / target) in said
    assert names(tmp_path) == ["file", "folder"]
    assert (tmp_path / "file").read_text() == "mine"
