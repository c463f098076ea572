"""``rockpulse calibrate`` and ``rockpulse assess --sequence`` from files to files."""

import re
import shutil
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO

import numpy as np
import pytest
from file_contents import assert_contents, contents

import rockpulse as rp
from rockpulse.cli import main
from rockpulse.errors import ResultsError

TOML = """
[site]
name = "An old town"
[calibration]
quantile = 0.5
bootstrap = 100
[[block]]
name = "wall"
width = 0.25
height = 2.2
[[block]]
name = "pier"
width = 1.1
height = 5.0
"""


@pytest.fixture(scope="module")
def motions(golden, tmp_path_factory):
    """Five records of five earthquakes, and a text that is none."""
    folder = tmp_path_factory.mktemp("motions")
    for number in range(5):
        shutil.copy(golden.records / f"burst{number}.AT2", folder)
    (folder / "notes.txt").write_text("no record")
    return folder


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    path = tmp_path_factory.mktemp("site") / "site.toml"
    path.write_text(TOML)
    return path


@pytest.fixture(scope="module")
def calibrated(motions, config, tmp_path_factory):
    """The site file of the motions, and what was printed to either stream."""
    target, out, err = tmp_path_factory.mktemp("results") / "site.h5", StringIO(), StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        assert main(["calibrate", str(motions), "--config", str(config), "-o", str(target)]) == 0
    return target, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def done(calibrated):
    return calibrated[0]


@pytest.fixture(scope="module")
def loaded(done):
    """The site file as it comes back."""
    return rp.load(done)


@pytest.fixture(scope="module")
def assessed(done, config, tmp_path_factory):
    """The bodies under the design sequence: the results file and what was printed."""
    target, out = tmp_path_factory.mktemp("assessed") / "results.h5", StringIO()
    with redirect_stdout(out):
        assert main(["assess", "--sequence", str(done), "--config", str(config), "-o", str(target)]) == 0
    return target, out.getvalue()


def test_the_summary_shows_the_design_and_the_sequence(calibrated, motions, config, run):
    target, out, err = calibrated
    assert err == ""
    for words in ("Calibrated on 5 records", "The design\n", "Sequence of the site", "without end", "wall", "pier"):
        assert words in out
    assert not re.search(r"\bnan\b", out, re.I)
    assert out.endswith(f"site: {target}\n")
    assert "the file exists" in run("calibrate", motions, "--config", config, "-o", target, code=2).err


def test_the_file_comes_back_as_it_was_calibrated(motions, config, loaded):
    tree = rp.calibrate(motions, rp.load_config(config))
    assert loaded.attrs["kind"] == "site calibration"
    assert loaded.attrs["title"] == "An old town"
    assert loaded["site"].to_dataset().identical(tree["site"].to_dataset())


@pytest.mark.sweep
def test_inspect_shows_what_calibrate_printed(done, run):
    assert "Sequence of the site" in run("inspect", done).out
    assert "notes.txt" in run("inspect", done, "--failures").out


@pytest.mark.sweep
def test_assess_takes_the_design_in_place_of_records(assessed, done, config):
    target, out = assessed
    assert "design sequence 0.5" in out
    assert "because they need a record and the input is a design spectrum: nonlinear" in re.sub(r"\s+", " ", out)
    summary = rp.load(target)["summary"].to_dataset()
    blocks = [block.block() for block in rp.load_config(config).bodies]
    lanes = rp.models.Block.stack([one.lanes(1) for one in blocks])
    response = rp.models.sequence_response(lanes, rp.load_design(done).sequence(lanes), paired=True)
    found = summary["peak_rotation_ratio"].sel(record="design sequence 0.5", model="sequence")
    np.testing.assert_array_equal(found, response.peak_rotation_ratio)
    # The verdicts are those of the calibration's own table.
    site = rp.load(done)["site"]
    np.testing.assert_array_equal(found, site["rotation_ratio"])
    overturned = summary["outcome"].sel(record="design sequence 0.5", model="sequence") == 2
    np.testing.assert_array_equal(overturned, site["design_factor"] <= 1.0)
    assert summary["source"].values.tolist() == [str(done)]
    assert main(["inspect", str(target), "--record", "design sequence 0.5", "--block", "pier"]) == 0


@pytest.mark.sweep
def test_files_of_another_kind_are_refused(assessed, motions, config, tmp_path, run):
    results, text = assessed[0], tmp_path / "notes.txt"
    text.write_text("no site")
    with pytest.raises(ResultsError, match=r"expected a site file of 'rockpulse calibrate', found an assessment"):
        rp.load_design(results)
    with pytest.raises(ResultsError, match="not a rockpulse results file"):
        rp.load_design(text)
    # A results file is never replaced by a site file, nor the other way round.
    arguments = ["calibrate", str(motions), "--config", str(config), "-o", str(results), "--overwrite"]
    assert "not replaced even with --overwrite" in run(*arguments, code=2).err


@pytest.mark.sweep
def test_tables_count_from_the_folder_of_the_configuration(motions, loaded, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    (site / "site.toml").write_text(
        '[records]\nevents = "events.csv"\n' + TOML.replace("quantile = 0.5", 'quantile = 0.5\nweights = "weights.csv"')
    )
    ids = loaded["site"]["record"].values.tolist()
    (site / "events.csv").write_text("record,event\n" + "".join(f"{name},event {n}\n" for n, name in enumerate(ids)))
    (site / "weights.csv").write_text("record,weight\n" + "".join(f"{name},{n}\n" for n, name in enumerate(ids)))
    target = tmp_path / "site.h5"
    arguments = ["calibrate", str(motions), "--config", str(site / "site.toml"), "-o", str(target), "--quiet"]
    assert main(arguments) == 0
    tree = rp.load(target)
    assert tree["site"].sizes["site_event"] == len(ids)
    again = tmp_path / "again.toml"
    again.write_text(tree.attrs["configuration"], encoding="utf-8")  # it repeats the run from any folder
    assert main(["calibrate", "--config", str(again), "-o", str(tmp_path / "again.h5"), "--quiet"]) == 0
    assert_contents(tmp_path / "again.h5", contents(target))


def test_where_every_record_is_zero_a_quiet_run_says_so_and_writes_no_file(config, tmp_path, run):
    np.savetxt(tmp_path / "still.txt", np.zeros(1000))
    given = ["--config", str(config), "--units", "m/s2", "--dt", "0.01", "-o", str(tmp_path / "site.h5"), "--quiet"]
    said = run("calibrate", tmp_path / "still.txt", *given, code=1).err
    assert said.startswith("rockpulse: no record could be calibrated; nothing was written: ")
    assert said.count("\n") == 1
    assert not (tmp_path / "site.h5").exists()


@pytest.mark.sweep
def test_too_few_earthquakes_make_no_design(golden, tmp_path, run):
    out = run("inspect", golden.site).out
    assert out.startswith(
        "! not enough earthquakes (5; at least 7 for the quantile 0.84)\n\nCalibrated on 5 records of"
    )
    assert "stele" not in out
    assert "I_eff" not in out
    design = tmp_path / "design.h5"
    said = run("assess", "--sequence", golden.site, "--block", "wall=0.25x2.2", "-o", design, code=2).err
    assert "no design spectrum: not enough earthquakes (5; at least 7" in said
