"""``rockpulse assess`` on the sample records with rotated pairs, from files to files."""

import numpy as np
import pytest
from assess_command import QUICK
from record_writers import knet, pulse

import rockpulse as rp
from rockpulse.cli import main


def run(tmp_path, path, records):
    config, target = tmp_path / "site.toml", tmp_path / "results.h5"
    config.write_text(f"[records]\n{records}\n{QUICK.replace('linear', 'nonlinear')}")
    given = ["--block", "pinnacle=0.45x1.8", "-o", str(target), "--workers", "1"]
    return main(["assess", str(path), "--config", str(config), *given]), target


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """The same motion of a KiK-net station to the east and to the north: together it goes to 20 degrees."""
    folder = tmp_path_factory.mktemp("swept")
    for direction, code, share in (("EW", "4", np.sin), ("NS", "5", np.cos)):
        counts = np.rint(4e6 * share(np.radians(20.0)) * pulse(400, 0.3)).astype(int)
        (folder / f"AKT0139608110312.{direction}2").write_bytes(knet(counts, direction=code))
    code, target = run(folder, folder, 'components = "sweep"\nazimuth_step = 20\nstore = "none"')
    assert code == 0
    return target


@pytest.fixture(scope="module")
def tree(swept):
    return rp.load(swept)


def test_a_sweep_is_written_and_read_back(tree):
    found, summary = tree["directions"], tree["summary"]
    assert found.sizes == {"pair": 1, "direction": 9, "block": 1, "model": 1}
    assert found["main_impulse_azimuth"].item() == found["pga_azimuth"].item() == 20.0
    north = summary["pga"].values[found["record_index"].values[0, 0]]
    assert found["pga_largest"].item() == pytest.approx(north / np.cos(np.radians(20.0)), rel=1e-5)
    assert found["pga_largest"].item() > found["pga_median"].item()


@pytest.mark.sweep
def test_inspect_shows_the_directions(swept, run):
    out = run("inspect", swept, "--all").out
    assert "Median and largest over 9 directions" in out
    assert "rotated to 20 degrees" in " ".join(run("inspect", swept, "--record", "*H020*").out.split())


def test_a_single_channel_is_a_failure_that_says_what_to_do(golden, tmp_path, capsys):
    code, _ = run(tmp_path, golden.records / "burst0.AT2", 'components = "azimuth"\nazimuth = 30')
    assert code == 1
    said = " ".join(capsys.readouterr().err.split())
    assert 'no second horizontal channel with a known azimuth was recorded together with it; components = "hor' in said
