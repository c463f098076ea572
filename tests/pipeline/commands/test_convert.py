"""``rockpulse convert``."""

import shutil

import numpy as np
import pytest
from record_writers import at2, csmip_equal, pulse

from rockpulse.cli import main
from rockpulse.readers import read
from rockpulse.readers.kit.text import for_other_files


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "a.AT2").write_bytes(at2(pulse(200)))
    (tmp_path / "b.v1").write_bytes(csmip_equal(np.round(pulse(160), 6), place="Roof"))
    return tmp_path


def test_a_file_becomes_another_and_its_loss_is_reported(folder, run):
    out = folder / "out.mseed"
    text = run("convert", folder / "a.AT2", "-o", out).out
    assert "a.090 as .A090..HNE: 200 samples at 0.01 s, PGA 0.3 g" in text
    assert "the event, the processing and the warnings are not stored" in " ".join(text.split())
    assert np.array_equal(read(out)[0].acceleration, read(folder / "a.AT2")[0].acceleration)


def test_a_folder_of_records_and_what_failed(folder, run):
    (folder / "cut.AT2").write_bytes(at2(pulse(200))[:-300])
    (folder / "notes.txt").write_text("nothing here\n")
    captured = run("convert", folder, "-o", folder / "out", "--format", "csv", code=1)
    assert f"failed (read) {folder / 'cut.AT2'}" in captured.err
    assert "not records: notes.txt" in captured.err
    assert "rockpulse: 2 of 3 files used (1 rejected): expected 200 samples" in captured.err
    assert len(list((folder / "out").iterdir())) == 2
    assert "on a structure, which" in captured.out


def test_a_unit_is_asked_for_and_taken(tmp_path, run):
    (tmp_path / "a.txt").write_text("".join(f"{value:.6f}\n" for value in pulse(50)))
    arguments = ["convert", str(tmp_path / "a.txt"), "-o", str(tmp_path / "out.AT2")]
    captured = run(*arguments, code=1)
    assert "do not state their unit" in captured.err
    assert "no record could be read" in captured.err
    assert not (tmp_path / "out.AT2").exists()
    run(*arguments, "--units", "g", "--dt", "0.02")
    assert read(tmp_path / "out.AT2")[0].dt == 0.02
    run(*arguments, "--units", "stone", "--dt", "0.02", code=2)


def test_a_file_that_exists_is_replaced_where_allowed(folder, run):
    arguments = ["convert", str(folder / "a.AT2"), "-o", str(folder / "x.csv"), "--quiet"]
    run(*arguments)
    assert "the file exists" in run(*arguments, code=2).err
    run(*arguments, "--overwrite")


@pytest.mark.sweep
def test_the_response_is_removed_where_asked_for(records_folder, tmp_path, capsys):
    for path in (records_folder / "mseed_xml").glob("CI.WCS2*"):
        shutil.copy(path, tmp_path / path.name)
    source, out = str(tmp_path / "CI.WCS2..HNE.mseed"), tmp_path / "new" / "a.csv"
    out.parent.mkdir()
    assert main(["convert", source, "-o", str(out), "--response", "remove"]) == 0
    (record,) = read(out, units="m/s2")
    assert abs(record.acceleration.mean()) < 1e-6
    assert record.npts == 39000


def test_a_file_that_was_converted_as_advised_needs_no_option(tmp_path):
    (tmp_path / "ours.txt").write_text("".join(f"{value:.6f}\n" for value in np.sin(np.arange(300))))
    given = for_other_files("--units g --dt 0.01").partition("(rockpulse ")[2].rstrip(")")
    arguments = (
        given.replace("FILE.csv", str(tmp_path / "ours.csv")).replace("FILE", str(tmp_path / "ours.txt")).split()
    )
    assert main(arguments) == 0
    (record,) = read(tmp_path / "ours.csv")
    assert (record.dt, record.pga) == (0.01, pytest.approx(9.80665, rel=1e-3))
