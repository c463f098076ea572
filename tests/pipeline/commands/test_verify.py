"""``rockpulse verify``: exit codes and what is said."""

import shutil

import h5py
import pytest

from rockpulse.cli import main


@pytest.fixture(scope="module")
def assessed(golden, quick, tmp_path_factory):
    """Results of a record, and a copy of the record."""
    folder = tmp_path_factory.mktemp("verify")
    record = shutil.copy(golden.records / "burst0.AT2", folder)
    arguments = ["--config", str(quick), "--block", "wall=0.5x4", "--quiet", "--workers", "1"]
    assert main(["assess", str(record), *arguments, "-o", str(folder / "results.h5")]) == 0
    return folder


@pytest.mark.sweep
def test_all_as_it_was(assessed, run):
    out = run("verify", assessed / "results.h5").out
    assert "assessment, schema 2.0, " in out
    assert "variables: unchanged" in out
    assert "input files checked: 1, missing: 0" in out


def test_a_change_is_one_exit_code_and_one_line(assessed, tmp_path, run):
    changed = shutil.copy(assessed / "results.h5", tmp_path / "changed.h5")
    with h5py.File(changed, "a") as file:
        file["summary/pga"][0] = 9.9
    assert (
        run("verify", changed, "--quiet", code=1).out == f"{changed}: variable /summary/pga: its values were changed\n"
    )


@pytest.mark.sweep
def test_inputs_that_were_moved_or_changed(assessed, run):
    record = assessed / "burst0.AT2"
    content = record.read_bytes()
    record.unlink()
    assert f"missing: 1\n  {record}" in run("verify", assessed / "results.h5").out
    record.write_bytes(content.replace(b"QUAKE", b"QUAKE ", 1) if b"QUAKE" in content else content + b" ")
    assert f"input {record}: it is not the file that was read" in run("verify", assessed / "results.h5", code=1).out
    record.write_bytes(content)
