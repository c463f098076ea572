"""``rockpulse inspect`` on a tree that is known."""

import pytest
from results_tree import RECORDS, results_tree

from rockpulse.cli import main
from rockpulse.store import save


@pytest.fixture
def results(tmp_path):
    path = tmp_path / "results.h5"
    save(results_tree(), path)
    return str(path)


def test_the_overview_names_records_verdicts_and_what_was_left_out(results, capsys):
    assert main(["inspect", results]) == 0
    out = capsys.readouterr().out
    assert all(record in out for record in RECORDS)
    assert "OVERTURNS" in out
    assert "upper-bound type input" in out
    assert "cut.AT2:4: expected 100 samples, found 3" in out


def test_one_record_and_one_block(results, capsys):
    assert main(["inspect", results, "--record", RECORDS[0]]) == 0
    assert "secondary impulse I_s" in capsys.readouterr().out
    assert main(["inspect", results, "--block", "column"]) == 0
    assert "critical impulse I_1c" in capsys.readouterr().out


def test_record_block_and_failures_together(results, capsys):
    assert main(["inspect", results, "--record", RECORDS[2], "--block", "cabinet", "--failures"]) == 0
    out = capsys.readouterr().out
    assert "interval dT" in out
    assert "restitution C" in out
    assert out.endswith("skipped (find) notes.txt: no record\n")


def test_no_failures_are_told_as_such(tmp_path, capsys):
    tree = results_tree()
    tree["failures"] = tree["failures"].isel(failure=slice(0))
    save(tree, tmp_path / "clean.h5")
    assert main(["inspect", str(tmp_path / "clean.h5"), "--failures"]) == 0
    assert capsys.readouterr().out == "nothing failed and nothing was skipped\n"


@pytest.mark.parametrize("option", ["--record", "--block"])
def test_an_unknown_name_is_exit_code_two_with_the_known_ones(results, capsys, option):
    assert main(["inspect", results, option, "nobody"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "there are:\n  " in captured.err
