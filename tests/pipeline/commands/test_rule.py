"""``rockpulse rule``: fitted and judged from files, with a statement where there is too little."""

import re
import tomllib

import pytest

import rockpulse as rp
from rockpulse.cli import main
from rockpulse.record.synthetic import synthetic_motion
from rockpulse.storage.hdf5 import results_file as store
from rockpulse.studies.rule import truth


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Six motions of six earthquakes."""
    place = tmp_path_factory.mktemp("records")
    for seed in range(6):
        motion = synthetic_motion(seed, duration=12.0, pga=5.0)
        event = f"Quake {'ABCDEF'[seed] * 3}"
        rp.write(rp.Record(motion, dt=0.01, id=f"motion_{seed}", event=event), place / f"motion_{seed}.at2")
    return place


def run(capsys, *words):
    code = main([str(word) for word in words])
    return code, capsys.readouterr()


@pytest.mark.sweep
def test_a_rule_is_fitted_written_and_judged(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(truth, "LANES", 64)
    rule, verdicts = tmp_path / "rule.toml", tmp_path / "verdicts.h5"
    code, said = run(capsys, "rule", "fit", folder, "-o", rule)
    assert code == 0, said.err
    written = tomllib.loads(rule.read_text())
    assert written["provenance"]["earthquakes"] == 6
    assert written["balanced"]["target"] == "capacity_mean"
    assert 0.8 < written["balanced"]["factor"] < 1.25
    assert str(folder) not in rule.read_text()
    assert re.search(r"rule, mean capacity +left-out", said.out)
    events = tmp_path / "events.csv"
    events.write_text("record,event\nmotion_0.1,Quake 1990\nmotion_1.1,Quake 1990\n")
    code, said = run(capsys, "rule", "judge", folder, "--rule", rule, "--events", events, "-o", verdicts)
    assert code == 0, said.err
    assert "Ishiyama" in said.out
    tree = rp.load(verdicts)
    assert tree.attrs["earthquakes"] == 5
    capacities = tree["capacities"].to_dataset().to_dataframe().set_index(["measure", "target", "kind"])
    given = capacities.loc[("march", "capacity_mean", "as-given")]
    assert given.coefficient == pytest.approx(written["balanced"]["factor"], rel=1e-5)
    assert len(tree["cases"].to_dataset().to_dataframe()) == 6 * 12


@pytest.mark.sweep
def test_one_earthquake_gives_a_statement(samples, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(truth, "LANES", 64)
    out = tmp_path / "verdicts.h5"
    code, said = run(capsys, "rule", "judge", samples / "CICCC.RAW", "-o", out)
    assert code == 0
    assert "2 strong channels of 1 earthquake," in " ".join(said.out.split())
    assert rp.load(out).attrs["statement"]
    code, said = run(capsys, "rule", "fit", samples / "CICCC.RAW", "-o", tmp_path / "rule.toml")
    assert code == 2
    assert "add records" in said.err
    assert not (tmp_path / "rule.toml").exists()


def test_without_a_strong_record_nothing_is_written(samples, tmp_path, capsys):
    (tmp_path / "notes.txt").write_text("no record")
    for action, name in (("judge", "verdicts.h5"), ("fit", "rule.toml")):
        code, said = run(capsys, "rule", action, tmp_path, samples / "2516b_a.smc", "-o", tmp_path / name)
        assert code == 1
        assert "no strong channel among the records, nothing was written" in said.err
        assert "notes.txt" in said.err
        assert not (tmp_path / name).exists()


def test_a_file_that_exists_is_kept(samples, tmp_path, capsys):
    rule = tmp_path / "rule.toml"
    rule.write_text("mine")
    code, said = run(capsys, "rule", "fit", samples, "-o", rule)
    assert code == 2
    assert "--overwrite" in said.err
    assert rule.read_text() == "mine"
    code, said = run(capsys, "rule", "judge", samples, "--rule", rule, "-o", tmp_path / "v.h5")
    assert code == 2
    assert "not valid TOML" in said.err


def test_verdicts_are_a_kind_of_their_own():
    from rockpulse.storage.rule_variables import RULE_KIND

    assert store.KINDS[RULE_KIND] == "rates"
