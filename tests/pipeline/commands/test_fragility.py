"""``rockpulse fragility`` on short records."""

import re

import numpy as np
import pytest
from file_contents import assert_contents, contents

import rockpulse as rp
from rockpulse.cli import main
from rockpulse.run.options import BatchReport


def test_inspect_shows_the_curves_of_a_file(golden, run):
    tree = rp.load(golden.fragility)
    curve = tree["fragility"].to_dataset().sel(block="stele", limit_state="overturning", measure="velocity_ratio")
    assert int(curve["records"]) == 5
    assert 0.2 < float(curve["median"]) < 2.0
    assert tree.attrs["kind"] == "fragility"
    shown = run("inspect", golden.fragility).out
    assert "5 records of 5 earthquakes, 2 bodies, data: ida" in shown
    assert re.search(r"stele +overturning +[0-9.]+ +", shown)
    assert "nothing failed" in run("inspect", golden.fragility, "--failures").out


def test_without_a_configuration_the_blocks_of_the_command_line_are_enough(tmp_path, monkeypatch, capsys):
    from rockpulse.run import batch

    given = []
    monkeypatch.setattr(batch, "fragility_files", lambda *words: given.append(words) or BatchReport(None, 0, 0, []))
    arguments = ["--block", "stele=0.2x1.6", "--units", "cm/s2", "--dt", "0.01", "-o", str(tmp_path / "f.h5")]
    assert main(["fragility", "r0.txt", *arguments, "--quiet"]) == 1
    ((paths, config, output, _),) = given
    assert (list(map(str, paths)), str(output)) == (["r0.txt"], str(tmp_path / "f.h5"))
    assert [block.name for block in config.bodies] == ["stele"]
    assert (config.records.units, config.records.dt) == ("cm/s2", 0.01)
    assert config.fragility == rp.FragilitySettings()


@pytest.mark.sweep
def test_the_file_repeats_the_run(tmp_path, run):
    time = np.arange(0.0, 4.0, 0.01)
    for number in range(3):
        motion = (2.0 + number) * np.sin(2.0 * np.pi * (1.0 + 0.2 * number) * time) * np.exp(-((time - 2.0) ** 2))
        np.savetxt(tmp_path / f"r{number}.txt", 100.0 * motion, fmt="%.6f")
    files = sorted(map(str, tmp_path.glob("r*.txt")))
    config = tmp_path / "site.toml"
    config.write_text('[fragility]\nlimit_states = ["uplift", "overturning"]\nmeasures = ["pga"]\n')
    arguments = ["--block", "stele=0.2x1.6", "--units", "cm/s2", "--dt", "0.01", "--config", str(config)]
    assert "3 records of " in run("fragility", *files, *arguments, "-o", tmp_path / "f.h5").out
    tree = rp.load(tmp_path / "f.h5")
    assert tree["fragility"]["block"].values.tolist() == ["stele"]
    (tmp_path / "again.toml").write_text(tree.attrs["configuration"], encoding="utf-8")
    again = tmp_path / "again.h5"
    run("fragility", "--config", tmp_path / "again.toml", "-o", again, "--quiet")
    assert_contents(again, contents(tmp_path / "f.h5"))
