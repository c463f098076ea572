"""The file that results go to: looked at before the work, and never anybody else's."""

import subprocess
import sys
import textwrap

import h5py
import numpy as np
import pytest
from results_tree import results_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5 import atomic as target_file
from rockpulse.storage.hdf5.atomic import check_target
from rockpulse.storage.hdf5.results_file import save


def _foreign_hdf5(path):
    with h5py.File(path, "w") as file:
        file.attrs["schema_version"] = "1.0"  # a common name; only rockpulse adds its own version
        file["data"] = np.arange(4.0)


FOREIGN = {
    "record.csv": lambda path: path.write_text("time,acc\n0.00,0.1\n"),
    "site.toml": lambda path: path.write_text("[site]\nname = 'mine'\n"),
    "empty.h5": lambda path: path.touch(),
    "foreign.h5": _foreign_hdf5,
}


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("through_a_link", [False, True])
def test_overwrite_replaces_nothing_but_results(tmp_path, name, through_a_link):
    path = tmp_path / name
    FOREIGN[name](path)
    before = path.read_bytes()
    named = path
    if through_a_link:
        named = tmp_path / "results.h5"
        named.symlink_to(path)
    for attempt in (lambda: check_target(named, overwrite=True), lambda: save(results_tree(), named, overwrite=True)):
        with pytest.raises(
            ResultsError, match=r"found another file.*choose another name, or remove it by hand"
        ) as caught:
            attempt()
        assert str(caught.value).startswith(f"{named}: ")
    assert path.read_bytes() == before
    assert {item.name for item in tmp_path.iterdir()} == {path.name, named.name}


@pytest.mark.sweep
def test_a_foreign_file_that_is_in_use_is_not_taken_for_a_damaged_one(tmp_path):
    path = tmp_path / "foreign.h5"
    script = f"""
        import h5py
        with h5py.File({str(path)!r}, "w") as file:
            file["data"] = 1.0
            file.flush()
            print("open", flush=True)
            input()
    """
    command = [sys.executable, "-c", textwrap.dedent(script)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as owner:
        try:
            assert owner.stdout.readline() == "open\n"
            with pytest.raises(ResultsError, match="found another file"):
                check_target(path, overwrite=True)
        finally:
            owner.communicate("\n", timeout=300)


@pytest.mark.sweep
def test_a_link_is_followed_and_the_check_leaves_nothing_behind(tmp_path):
    (tmp_path / "far").mkdir()
    link = tmp_path / "results.h5"
    link.symlink_to(tmp_path / "far" / "real.h5")
    assert check_target(link) == (tmp_path / "far" / "real.h5").resolve()
    assert list((tmp_path / "far").iterdir()) == []
    save(results_tree(), link)
    assert link.is_symlink()
    assert (tmp_path / "far" / "real.h5").is_file()


def test_a_folder_that_takes_no_file_is_refused(tmp_path, monkeypatch):
    def refuse(*args, **kwargs):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(target_file.Path, "touch", refuse)
    with pytest.raises(ResultsError, match=r"cannot write in .*: Read-only file system"):
        check_target(tmp_path / "results.h5")
