"""``rockpulse assess`` from files to files: exit codes, tables, refusals, and what it leaves on the disk."""

import io
import re
from contextlib import redirect_stderr, redirect_stdout

import numpy as np
import pytest
from assess_command import DT, STRONG, assess_words, configuration, values, write_at2

import rockpulse as rp
from rockpulse.cli import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two good records, one that is cut short, one that is no record."""
    folder = tmp_path_factory.mktemp("records")
    write_at2(folder / "strong.AT2", STRONG)
    write_at2(folder / "weak.AT2", 0.02 * STRONG, component="90")
    cut = write_at2(folder / "cut.AT2", STRONG).read_text().splitlines()
    (folder / "cut.AT2").write_text("\n".join(cut[:30]) + "\n")
    (folder / "notes.txt").write_text("no record at all\n")
    return folder


@pytest.fixture(scope="module")
def told(folder, tmp_path_factory):
    """The results of two good records, and what was printed on the way."""
    target = tmp_path_factory.mktemp("results") / "results.h5"
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        assert main(assess_words(folder / "strong.AT2", folder / "weak.AT2", "-o", target)) == 0
    return target, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def done(told):
    """Two good records, assessed."""
    return told[0]


@pytest.fixture(scope="module")
def tree(done):
    """The same, loaded."""
    return rp.load(done)


def test_all_done_is_exit_code_zero_with_a_table(told):
    target, out, err = told
    assert err == ""  # no progress bar where there is no terminal
    assert re.search(r"^  thin wall +1 of [12] ", out, re.M)
    assert out.count("thin wall") >= 2
    assert not re.search(r"\bnan\b", out, re.I)
    assert out.endswith(f"results: {target}\n")
    assert target.is_file()


def test_every_model_answers_for_every_record_and_block(tree):
    summary = tree["summary"]
    assert dict(summary.sizes) == {"record": 2, "block": 2, "model": 5}
    assert summary["block"].values.tolist() == ["thin wall", "pier"]
    assert summary["width"].values.tolist() == [0.2, 1.0]
    strong, weak = summary["record"].values
    assert summary["outcome"].sel(record=strong, block="thin wall", model="nonlinear") == 2
    assert (summary["outcome"].sel(record=weak, model=["linear", "nonlinear"]) == 0).all()


def test_the_results_hold_the_configuration_that_was_resolved(tree, tmp_path):
    path = tmp_path / "resolved.toml"
    path.write_text(tree.attrs["configuration"], encoding="utf-8")
    config = rp.load_config(path)
    assert [(block.name, block.width, block.height) for block in config.bodies] == [
        ("thin wall", 0.2, 2.2),
        ("pier", 1.0, 3.0),
    ]
    assert [name.rpartition("/")[2] for name in config.records.paths] == ["strong.AT2", "weak.AT2"]


@pytest.mark.sweep
def test_a_folder_with_a_broken_record_is_exit_code_one_and_the_others_are_assessed(folder, quick, tmp_path, assess):
    target = tmp_path / "results.h5"
    out = assess(folder, "-o", target, "--config", quick, code=1).out
    assert "failed: 1" in out
    assert re.search(r"cut\.AT2:\d+: ", out)
    assert "not records: notes.txt" in out
    assert len(values(target, "record")) == 2
    assert sorted(values(target, "failures/kind")) == ["failed", "skipped"]


@pytest.mark.sweep
def test_a_missing_file_named_explicitly_is_exit_code_one_and_the_others_are_assessed(folder, quick, tmp_path, assess):
    target = tmp_path / "results.h5"
    captured = assess(folder / "strong.AT2", folder / "absent.AT2", "-o", target, "--quiet", "--config", quick, code=1)
    assert captured.out == ""
    assert captured.err == "rockpulse: 1 of 2 files used (1 rejected): no such file or folder (absent.AT2).\n"
    assert len(values(target, "record")) == 1


def test_a_single_vertical_channel_is_why_nothing_is_written(tmp_path, assess):
    path = tmp_path / "hvps_UP.dat"
    path.write_text("".join(f"{0.01 * index:.2f} {np.sin(index):.4f}\n" for index in range(200)), encoding="ascii")
    said = assess(path, "-o", tmp_path / "results.h5", "--units", "m/s2", code=1).err
    assert "nothing was written: hvps_UP.UP: vertical channel; it was read but not assessed" in said


@pytest.mark.sweep
def test_one_column_is_read_once_unit_and_interval_are_named(quick, tmp_path, assess):
    path = tmp_path / "column.txt"
    np.savetxt(path, STRONG, fmt="%.6f")
    target = tmp_path / "results.h5"
    assert "option dt" in assess(path, "-o", target, "--units", "g", code=1).err
    given = ["-o", target, "--quiet", "--config"]
    assess(path, *given, quick, "--units", "g", "--dt", f"{DT}")
    assert values(target, "dt") == [DT]
    config = tmp_path / "site.toml"
    config.write_text(f"[records]\nunits = 'g'\ndt = {2 * DT}\n{quick.read_text()}")
    assess(path, *given, config, "--overwrite")
    assert values(target, "dt") == [2 * DT]
    assess(path, *given, config, "--dt", DT, "--overwrite")
    assert values(target, "dt") == [DT]
    assert f"\ndt = {DT}\n" in configuration(target)


def test_overwrite_spares_the_record_and_the_configuration(tmp_path, assess):
    record = write_at2(tmp_path / "strong.AT2", STRONG)
    config = tmp_path / "site.toml"
    config.write_text("[models]\nuse = ['resonance']\n")
    for target in (record, config):
        before = target.read_bytes()
        assert "remove it by hand" in assess(record, "--config", config, "-o", target, "--overwrite", code=2).err
        assert target.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["site.toml", "strong.AT2"]


def test_a_file_that_exists_is_refused_before_any_work_and_stays_intact(tmp_path, assess):
    target = tmp_path / "results.h5"
    target.write_bytes(b"old")
    assert "the file exists" in assess(tmp_path / "absent.AT2", "-o", target, code=2).err
    assert target.read_bytes() == b"old"


@pytest.mark.sweep
def test_the_configuration_names_records_and_blocks(folder, tmp_path, run):
    config = tmp_path / "site.toml"
    config.write_text(
        f"[records]\npaths = ['{folder}/strong.AT2']\n[models]\nuse = ['nonlinear', 'sequence']\n"
        "[search]\nmodels = []\n[uncertainty]\nprobability = false\n"
        "[[block]]\nname = 'column'\nwidth = 0.5\nheight = 4.0\nrestitution = [0.8, 0.9]\n"
    )
    target = tmp_path / "results.h5"
    out = run("assess", "--config", config, "--block", "pier=1.0x3.0", "-o", target).out
    summary = rp.load(target)["summary"]
    assert summary["model"].values.tolist() == ["sequence", "nonlinear"]
    assert summary["restitution"].sel(block="column").values.tolist() == [0.8, 0.9]
    assert summary["outcome"].dims == ("record", "block", "case", "model")
    assert len(re.findall(r"^  column, C = 0\.[89]00 ", out, re.M)) == 2
    assert "resonance" not in out
