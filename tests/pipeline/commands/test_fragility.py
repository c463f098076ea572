"""``rockpulse fragility`` on the shipped samples."""

import re

import numpy as np
import pytest
from file_contents import assert_contents, contents

import rockpulse as rp
from rockpulse.cli import main

CONFIG = """
[conditioning]
highpass_hz = 0.1
lowpass_hz = 25.0

[search]
points = 16

[fragility]
data = "ida"
factors = [0.01, 100.0]
limit_states = [0.4, "overturning"]
measures = ["velocity_ratio", "demand_cubic"]

[[block]]
name = "pinnacle"
width = 0.4
height = 2.4
"""


@pytest.fixture(scope="module")
def made(samples, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fragility")
    (folder / "site.toml").write_text(CONFIG)
    target = folder / "fragility.h5"
    arguments = [str(samples / "CICLC.v1"), "--config", str(folder / "site.toml"), "-o", str(target)]
    assert main(["fragility", *arguments, "--quiet"]) == 0
    return target, arguments


def test_the_file_holds_curves_of_one_event_without_a_band(made):
    tree = rp.load(made[0])
    curve = tree["fragility"].to_dataset().sel(block="pinnacle", limit_state="overturning", measure="velocity_ratio")
    assert int(curve["records"]) == 2
    assert 0.2 < float(curve["median"]) < 2.0
    assert np.isnan(float(curve["median_low"]))
    assert tree.attrs["kind"] == "fragility"
    assert "[fragility]" in tree.attrs["configuration"]


def test_inspect_shows_it(made, capsys):
    assert main(["inspect", str(made[0])]) == 0
    shown = capsys.readouterr().out
    assert "2 records of 1 earthquake, 1 body, data: ida" in shown
    assert "no band: the records come from 1 event, it needs 3" in shown
    assert "demand_cubic" in shown
    assert re.search(r"pinnacle +overturning +[0-9.]+ +- ", shown)  # nothing has a band
    assert "with its band" not in shown
    assert main(["inspect", str(made[0]), "--failures"]) == 0
    assert "vertical" in capsys.readouterr().out
    assert main(["inspect", str(made[0]), "--record", "x"]) == 2
    assert "this is a fragility file" in capsys.readouterr().err


@pytest.mark.sweep
def test_without_a_configuration_the_blocks_of_the_command_line_are_enough_and_the_file_repeats_the_run(
    tmp_path, capsys
):
    time = np.arange(0.0, 6.0, 0.01)
    for number in range(3):
        motion = (2.0 + number) * np.sin(2.0 * np.pi * (1.0 + 0.2 * number) * time) * np.exp(-((time - 3.0) ** 2))
        np.savetxt(tmp_path / f"r{number}.txt", 100.0 * motion, fmt="%.6f")
    files = sorted(map(str, tmp_path.glob("r*.txt")))
    arguments = ["--block", "stele=0.2x1.6", "--units", "cm/s2", "--dt", "0.01"]
    assert main(["fragility", *files, *arguments, "-o", str(tmp_path / "f.h5")]) == 0
    assert "3 records of " in capsys.readouterr().out
    tree = rp.load(tmp_path / "f.h5")
    assert tree["fragility"]["block"].values.tolist() == ["stele"]
    (tmp_path / "again.toml").write_text(tree.attrs["configuration"], encoding="utf-8")
    again = tmp_path / "again.h5"
    assert main(["fragility", "--config", str(tmp_path / "again.toml"), "-o", str(again), "--quiet"]) == 0
    assert_contents(again, contents(tmp_path / "f.h5"))
