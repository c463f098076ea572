"""``rockpulse assess`` on the sample records with rotated pairs, from files to files."""

import pytest
from nominal import toml

import rockpulse as rp
from rockpulse.cli import main

BODIES = '[models]\nuse = ["resonance", "nonlinear"]\n[[block]]\nname = "pinnacle"\nwidth = 0.45\nheight = 1.8\n'


def run(tmp_path, path, records):
    config, target = tmp_path / "site.toml", tmp_path / "results.h5"
    config.write_text(f"[records]\n{records}\n{BODIES}{toml(without='models')}")
    return main(["assess", str(path), "--config", str(config), "-o", str(target)]), target


@pytest.fixture(scope="module")
def swept(samples, tmp_path_factory):
    code, target = run(tmp_path_factory.mktemp("swept"), samples / "CICLC.v1", 'components = "sweep"\nstore = "none"')
    assert code == 0
    return target


@pytest.fixture(scope="module")
def tree(swept):
    return rp.load(swept)


def test_a_sweep_is_written_and_read_back(tree):
    found = tree["directions"]
    assert found["pair"].values.tolist() == ["CI.CLC..360-90@20190706T031608"]
    assert found.sizes["direction"] == 18
    assert found["main_impulse_azimuth"].item() == 160.0
    assert found["main_impulse_largest"].item() == pytest.approx(0.392, abs=0.001)
    assert found["pga_largest"].item() >= max(5.009, found["pga_median"].item())
    assert tree["summary"]["record"].values[2] == "CI.CLC..H020@20190706T031608"


def test_inspect_shows_the_directions(swept, capsys):
    assert main(["inspect", str(swept), "--all"]) == 0
    out = capsys.readouterr().out
    assert "Median and largest over 18 directions" in out
    assert main(["inspect", str(swept), "--record", "CI.CLC..H020@20190706T031608"]) == 0
    assert "rotated to 20 degrees" in " ".join(capsys.readouterr().out.split())


def test_a_single_channel_is_a_failure_that_says_what_to_do(samples, tmp_path, capsys):
    code, _ = run(tmp_path, samples, 'components = "azimuth"\nazimuth = 30')
    assert code == 1
    out = " ".join(capsys.readouterr().out.split())
    assert 'no second horizontal channel with a known azimuth was recorded together with it; components = "hor' in out
