"""``rockpulse inspect`` on a tree that is known."""

import shutil

import h5py
import pytest
import xarray as xr
from results_tree import RECORDS, results_tree

from rockpulse.cli import main
from rockpulse.run.journal import Journal
from rockpulse.run.tasks import Done
from rockpulse.storage.hdf5.results_file import save

pytestmark = pytest.mark.usefixtures("loaded_once")


@pytest.mark.sweep
def test_the_overview_names_records_verdicts_and_what_was_left_out(results, run):
    out = run("inspect", results).out
    assert out.count("Each body") == 1
    assert all(record in out for record in RECORDS)
    assert "cut.AT2:4: expected 100 samples, found 3" in out
    out = run("inspect", results, "--all").out
    assert all(record in out for record in RECORDS)
    assert "OVERTURNS" in out
    assert "upper-bound input" in out
    assert "cut.AT2:4: expected 100 samples, found 3" in out


@pytest.mark.sweep
def test_record_block_and_failures_together(results, run):
    out = run("inspect", results, "--record", RECORDS[2], "--block", "cabinet", "--failures").out
    assert "interval dT" in out
    assert "restitution C" in out
    assert out.endswith("skipped (find) notes.txt: no record\n")


@pytest.mark.sweep
def test_cases_records_and_blocks_are_listed_and_filtered(results, run):
    out = run("inspect", results, "--outcome", "overturns", "--model", "resonance", "--sort", "pga", "--limit", "3").out
    assert "4 cases with model resonance; outcome = overturns, smallest pga first; 3 shown (--limit N for more)" in out
    out = run("inspect", results, "--records", "--where", "pga > 4.7").out
    assert out.startswith("1 record\n")
    assert RECORDS[0] in out
    assert RECORDS[1] not in out
    out = run("inspect", results, "--blocks", "--sort", "slenderness", "--descending", "--failures").out
    assert out.startswith("3 bodies, largest slenderness first")
    assert out.endswith("skipped (find) notes.txt: no record\n")


@pytest.mark.parametrize("gone", ["pga", pytest.param("record", marks=pytest.mark.sweep)])
def test_answers_that_another_program_has_taken_out_are_named(results, tmp_path, run, gone):
    lacking = str(shutil.copy(results, tmp_path))
    with h5py.File(lacking, "a") as file:
        del file["summary"][gone]
    said = run("inspect", lacking, code=2).err
    assert "rockpulse verify" in said
    assert gone == "record" or "variable /summary/" in said


@pytest.fixture(scope="module")
def unusual(tmp_path_factory):
    """Blocks with names of several lines, and nothing that failed."""
    tree = results_tree()
    names = xr.Variable("block", ["a\nb", "c\rd", "e\u2028f"], tree["summary"]["block"].attrs)
    tree["summary"] = xr.DataTree(tree["summary"].to_dataset().assign_coords(block=names))
    tree["failures"] = tree["failures"].isel(failure=slice(0))
    path = tmp_path_factory.mktemp("unusual") / "results.h5"
    save(tree, path)
    return str(path)


@pytest.mark.sweep
def test_names_of_several_lines_are_shown_in_one(unusual, run):
    out = run("inspect", unusual, "--blocks").out
    assert all(name in out for name in ("a b ", "c d ", "e f "))


@pytest.mark.sweep
def test_no_failures_are_told_as_such(unusual, run):
    assert run("inspect", unusual, "--failures").out == "nothing failed and nothing was skipped\n"


@pytest.mark.sweep
def test_the_worst_cases_and_those_of_a_pattern(results, run):
    out = run("inspect", results, "--worst", "2").out
    assert "9 cases with model nonlinear, largest peak_rotation_ratio first; 2 shown" in out  # it was not searched
    assert "6 cases with record CI.*; model nonlinear" in run("inspect", results, "--record", "CI.*").out
    assert "secondary impulse I_s" in run("inspect", results, "--record", "weak*").out


@pytest.mark.parametrize("kind", ["site", "fragility"])
def test_files_that_are_shown_whole_take_no_filters(golden, kind, capsys):
    assert main(["inspect", str(getattr(golden, kind)), "--records", "--worst", "3"]) == 2
    said = f"--records, --worst: expected results of 'rockpulse assess'; this is a {kind} file"
    assert said in capsys.readouterr().err


def test_an_unfinished_run_is_shown_with_its_progress(tmp_path, run):
    target = tmp_path / "results.h5"
    with Journal.open(target) as journal:
        journal.add(Done("a", "f", (b"x",)))
        journal.add(Done("b", "g", (b"y",)))
        said = run("inspect", target, code=2).err
    assert "is not finished: 2 records done, 0 of them with a failure" in said
    journal.path.unlink()
    assert "no such file" in run("inspect", target, code=2).err
