"""``rockpulse inspect`` on a tree that is known."""

import numpy as np
import pandas as pd
import pytest
from results_tree import RECORDS, results_tree

import rockpulse as rp
from rockpulse.calibration.rule import POINTS, Rule
from rockpulse.calibration.rule_judgement import judge_rules
from rockpulse.calibration.rule_variables import RULE_KIND
from rockpulse.calibration.site_variables import SITE_KIND
from rockpulse.cli import main
from rockpulse.fragility.variables import FRAGILITY
from rockpulse.store import ASSESSMENT, KINDS, save
from rockpulse.study.parametric_analysis import figure4
from rockpulse.study.variables import STUDY
from rockpulse.synthetic import synthetic_motion


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


def motions():
    return [
        rp.Record(synthetic_motion(seed, duration=5.0, pga=4.0), dt=0.01, id=f"m{seed}", processed=True)
        for seed in range(1)
    ]


def verdicts(cases=300):
    """A judgement on made-up cases; a statement where they are few."""
    random = np.random.default_rng(1)
    over = random.uniform(size=cases) < 0.3
    table = pd.DataFrame({"record": "one", "event": np.arange(cases) // 50, "overturns": over, "peak": 0.3})
    table = table.assign(event=table["event"].astype(str), uplift_ratio=9.0, march=1.0 + over, velocity_ratio=1.0)
    return judge_rules(table, {point: Rule(point, 1.0) for point in POINTS}, resamples=5)


def site():
    return rp.calibrate_site(motions(), rp.Config(), blocks={"wall": rp.models.Block(0.2, 1.6)})


def fragility():
    return rp.fragility_curves(motions(), rp.Config(), blocks={"wall": rp.models.Block(0.2, 1.6)})


#: A file of every kind, and words that inspect shows of it.
EVERY = {
    ASSESSMENT: (results_tree, "OVERTURNS"),
    SITE_KIND: (site, "design sequence"),
    FRAGILITY: (fragility, "wall"),
    RULE_KIND: (verdicts, "left-out"),
    STUDY: (
        lambda: figure4(impulse_ratios=(0.1, 0.3), secondary_ratios=(0.0, 0.5), counts=(2.0, np.inf)),
        "theta_max/alpha_c",
    ),
}


@pytest.mark.parametrize("kind", [*KINDS, "statement only"])
def test_every_kind_of_file_is_shown(kind, tmp_path, capsys):
    make, words = EVERY.get(kind, (lambda: verdicts(40), "no verdict on the rule"))
    path = tmp_path / "file.h5"
    save(make(), path)
    assert main(["inspect", str(path)]) == 0
    assert words in capsys.readouterr().out


def test_verdicts_of_the_rule_are_shown_whole(tmp_path, capsys):
    save(verdicts(), tmp_path / "verdicts.h5")
    assert main(["inspect", str(tmp_path / "verdicts.h5"), "--failures"]) == 0
    assert capsys.readouterr().out == "nothing failed and nothing was skipped\n"
    assert main(["inspect", str(tmp_path / "verdicts.h5"), "--record", "one"]) == 2
    assert "verdicts of the rule" in capsys.readouterr().err
