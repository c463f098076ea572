"""``rockpulse diff``: exit codes and options."""

import re

import pytest
from results_tree import results_tree

from rockpulse.cli import main
from rockpulse.storage.hdf5.results_file import save


@pytest.fixture(scope="module")
def files(results, tmp_path_factory):
    """Results, and the same with a PGA that is larger by a millionth."""
    second = tmp_path_factory.mktemp("larger") / "b.h5"
    tree = results_tree()
    tree["summary"]["pga"].values[1] *= 1.0 + 1e-6
    save(tree, second)
    return results, str(second)


def test_exit_code_zero_where_the_results_are_the_same(files, run):
    assert "The results are the same" in run("diff", files[0], files[0]).out
    run("diff", *files, "--rtol", "1e-5")


@pytest.mark.sweep
def test_the_other_options_are_passed_on(files):
    assert main(["diff", *files, "--atol", "1e-5"]) == 0
    assert main(["diff", *files, "--ignore", "/summary/pga"]) == 0


@pytest.mark.sweep
def test_exit_code_one_where_they_differ(files, run):
    out = run("diff", *files, code=1).out
    assert "Variables beyond rtol 1e-09" in out
    assert "/summary/pga" in out
    assert "1.0e-06" in out
    assert max(map(len, out.splitlines())) <= 120


@pytest.mark.slow
def test_one_screen_or_all_of_it(files, tmp_path, run):
    tree = results_tree()
    for variable in tree["summary"].data_vars.values():
        if variable.dtype.kind == "f":
            variable.values[...] = variable.values * 1.5 + 0.1
    save(tree, tmp_path / "c.h5")
    brief = run("diff", files[0], tmp_path / "c.h5", code=1).out
    assert len(brief.splitlines()) <= 50
    assert "All differences: rockpulse diff BEFORE AFTER --full" in brief
    whole = run("diff", files[0], tmp_path / "c.h5", "--full", code=1).out
    shown, more = brief.count("  /summary/"), int(re.search(r"and (\d+) more variables", brief)[1])
    assert shown == 6
    assert whole.count("  /summary/") == shown + more
    assert "--full" not in whole
