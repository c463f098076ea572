"""``rockpulse check`` on a configuration and on results."""

import pandas as pd
import pytest

CONFIG = """
[check]
spectrum = "en_1998_1"
ag = 0.25
ground = "C"
[[block]]
name = "wall"
width = 0.4
height = 4.0
[[block]]
name = "parapet"
width = 0.3
height = 1.2
[[block.floor]]
period = 0.5
participation = 1.2
"""


@pytest.fixture
def site(tmp_path):
    path = tmp_path / "site.toml"
    path.write_text(CONFIG)
    return path


def test_bodies_are_checked_from_the_configuration_alone(site, tmp_path, run):
    table = tmp_path / "check.csv"
    shown = run("check", "--config", site, "--code", "-o", table).out
    assert "Checks of codes, 2 bodies: EN 1998-1 type 1, a_g 0.25 g, ground C; SLV, q 2, FC 1.35" in shown
    assert "FAILS" in shown
    assert "parapet, EN 1998-1, 4.3.5: level (height of the floor/height of the building) is not given." in shown
    found = pd.read_csv(table)
    assert len(found) == 6
    first = found[(found["block"] == "wall") & (found["code"] == "circolare_2009")].iloc[0]
    assert first["activation_ratio"] == pytest.approx(0.1 / 1.35 / 0.14375)
    assert "exists" in run("check", "--config", site, "-o", table, code=2).err


@pytest.mark.sweep
def test_results_bring_the_probability_of_the_same_bodies(golden, loaded_once, run):
    shown = run("check", golden.results, "--code", "circolare_2019").out
    assert "at P = 50 %" in " ".join(shown.split())
    row = next(line for line in shown.splitlines() if "Circolare 7/2019" in line)
    assert 0.0 <= float(row.split()[-2]) <= 1.0


@pytest.mark.sweep
def test_other_bodies_of_the_same_name_bring_no_probability(golden, tmp_path, run):
    other, table = tmp_path / "other.toml", tmp_path / "check.csv"
    bare = golden.config.read_text().replace("width = 1.0", "width = 0.9")
    other.write_text(bare + '[[block]]\nname = "statue"\nwidth = 0.5\nheight = 1.8\n')
    shown = " ".join(run("check", golden.results, "--config", other, "-o", table).out.split())
    assert "pier: the results have another body of this name (width 1 there, 0.9" in shown
    assert "statue: the results have no body of this name." in shown
    found = pd.read_csv(table).groupby("block")["probability"].count()
    assert found.to_dict() == {"pier": 0, "statue": 0, "stele": len(pd.read_csv(table)["code"].unique())}


@pytest.mark.sweep
def test_a_file_of_another_kind_is_refused(golden, run):
    assert (
        "site.h5: expected an assessment file, found a site calibration file" in run("check", golden.site, code=2).err
    )
