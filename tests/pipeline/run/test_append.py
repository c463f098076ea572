"""Records appended to a results file: only they are computed, and the file is that of one run over all records."""

import signal
from dataclasses import replace

import pytest
from batch_runs import CONFIG, four_records
from file_contents import assert_contents, contents
from killed_run import in_a_fork
from killed_run import run as killed_at
from record_writers import pulse
from record_writers.geonet import geonet

import rockpulse as rp
from rockpulse import BlockSettings, RecordSettings, SiteSettings
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.readers.folders import read_all
from rockpulse.run import batch
from rockpulse.run.batch import assess_files, calibrate_files
from rockpulse.run.journal import journal_path
from rockpulse.run.options import BatchOptions

#: Everything that a row can have in a file: samples, half-waves, histories, half-cycles, intervals.
FULL = replace(
    CONFIG,
    models=rp.ModelSettings(use=("sequence", "nonlinear"), histories=True),
    search=rp.SearchSettings(models=("sequence",), points=16),
    records=RecordSettings(store="all"),
    uncertainty=rp.UncertaintySettings(probability=False),
)


@pytest.fixture
def folder(tmp_path):
    """Four records of different lengths: records that could be copies of each other are compared with each other."""
    (tmp_path / "records").mkdir()
    return four_records(tmp_path / "records", longer=40)


def appending(told=None, **more):
    return BatchOptions(workers=1, append=True, tell=(told if told is not None else []).append, **more)


def pairs(folder):
    """Four instruments of two horizontal channels and a vertical one."""
    for number in range(4):
        three = [pulse(300 + 40 * number, peak) for peak in (3000.0, -2000.0 - 500.0 * number, 1500.0)]
        (folder / f"g{number}.V1A").write_bytes(geonet(three, site=f"ST{number}"))
    return [folder / f"g{number}.V1A" for number in range(4)]


@pytest.mark.parametrize(
    "components", [pytest.param("horizontal", marks=pytest.mark.slow), pytest.param("sweep", marks=pytest.mark.sweep)]
)
def test_a_file_with_appended_records_is_that_of_one_run_over_all(tmp_path, components):
    """New rows come before, between and after the old ones; one file cannot be read in either run."""
    config = replace(FULL, records=replace(FULL.records, components=components, azimuth_step=90.0))
    files = pairs(tmp_path)
    (tmp_path / "cut.V1A").write_bytes(files[0].read_bytes()[:2000])
    output, told = tmp_path / "results.h5", []
    assess_files([files[1], files[3], tmp_path / "cut.V1A"], config, output, BatchOptions(workers=1))
    every = [*files, tmp_path / "cut.V1A"]
    report = assess_files(every, config, output, appending(told))
    tasks = 8 if components == "horizontal" else 4
    assert (report.records, report.resumed) == (8, tasks // 2)
    assert told == [f"{tasks // 2} of {tasks} records are in {output} already"]
    assess_files(every, config, tmp_path / "all.h5", BatchOptions(workers=1))
    assert_contents(output, contents(tmp_path / "all.h5"))
    assert rp.diff(output, tmp_path / "all.h5").same
    assert not journal_path(output).exists()


@pytest.mark.sweep
def test_appending_nothing_new_computes_nothing(folder, tmp_path, monkeypatch):
    output, told = tmp_path / "results.h5", []
    assess_files(folder, CONFIG, output, BatchOptions(workers=1))
    written = output.read_bytes()
    monkeypatch.setattr(batch.Assessment, "work", None)
    report = assess_files(folder, CONFIG, output, appending(told))
    assert (report.records, report.resumed) == (4, 4)
    assert told == [f"{output}: the run was already complete; nothing was left to do"]
    assert output.read_bytes() == written
    # Another description of the site, on which no row depends, is taken over.
    assess_files(folder, replace(CONFIG, site=SiteSettings(name="Elsewhere")), output, appending())
    assert rp.load(output).attrs["title"] == "Elsewhere"


WIDER = (BlockSettings(name="wall", width=0.5, height=3.0), BlockSettings(name="pier", width=1.0, height=3.0))
CHANGED = [
    (replace(CONFIG, bodies=WIDER), r'\[\[block\]\] "pier" is not in the file, .*"wall" width: 0.4 in the file, 0.5'),
    (replace(CONFIG, models=rp.ModelSettings(use=("sequence",))), r"\[models\] use: \('resonance',\) in the file, "),
    (replace(CONFIG, conditioning=rp.ConditioningSettings(highpass_hz=0.2)), r"\[conditioning\] highpass_hz: "),
]


@pytest.mark.parametrize(("config", "expected"), CHANGED)
@pytest.mark.sweep
def test_other_options_or_bodies_are_named_and_nothing_is_appended(folder, tmp_path, config, expected):
    output = tmp_path / "results.h5"
    assess_files(folder / "r0.AT2", CONFIG, output, BatchOptions(workers=1))
    written = output.read_bytes()
    with pytest.raises(ConfigError, match=f"nothing can be appended, .*{expected}"):
        assess_files(folder, config, output, appending())
    assert output.read_bytes() == written
    assert not journal_path(output).exists()


@pytest.mark.sweep
def test_another_version_and_a_changed_program_are_named(folder, tmp_path, monkeypatch):
    output = tmp_path / "results.h5"
    assess_files(folder / "r0.AT2", CONFIG, output, BatchOptions(workers=1))
    monkeypatch.setattr("rockpulse.run.tasks.program_digest", lambda: "another")
    with pytest.raises(ConfigError, match="computed differently: the program, or the table of a"):
        assess_files(folder, CONFIG, output, appending())
    monkeypatch.setattr("rockpulse.run.earlier_results.__version__", "9.9")
    with pytest.raises(ConfigError, match=r"written by rockpulse \S+, and this is version 9.9"):
        assess_files(folder, CONFIG, output, appending())


@pytest.mark.sweep
def test_a_changed_record_is_computed_again_and_a_missing_one_is_not_lost(folder, tmp_path):
    output, told = tmp_path / "results.h5", []
    assess_files([folder / "r0.AT2", folder / "r1.AT2"], CONFIG, output, BatchOptions(workers=1))
    with pytest.raises(ConfigError, match=r"1 of its 2 records are not in the given files, .*lost: .*r0.090; give"):
        assess_files([folder / "r1.AT2", folder / "r2.AT2"], CONFIG, output, appending())
    text = (folder / "r1.AT2").read_bytes()
    (folder / "r1.AT2").write_bytes(text.replace(b"Event 1", b"Event 7"))
    report = assess_files(folder, CONFIG, output, appending(told))
    assert report.resumed == 1
    again = "; 1 must be computed again, because they or the records compared with them have changed"
    assert told == [f"1 of 4 records are in {output} already{again}"]


@pytest.mark.sweep
def test_a_file_without_the_identities_of_its_records_is_not_extended(folder, tmp_path, monkeypatch):
    output = tmp_path / "results.h5"
    with pytest.raises(ResultsError, match="there is no such file; leave --append out"):
        assess_files(folder, CONFIG, output, appending())
    rp.save(rp.assess(read_all(folder)[0], CONFIG), output)
    with pytest.raises(ResultsError, match="does not identify the inputs"):
        assess_files(folder, CONFIG, output, appending())
    with pytest.raises(ResultsError, match="either append or overwrite"):
        assess_files(folder, CONFIG, output, appending(overwrite=True))
    with pytest.raises(ResultsError, match="only results of an assessment"):
        calibrate_files(folder, CONFIG, tmp_path / "site.h5", appending())


@pytest.mark.sweep
def test_a_damaged_file_is_not_extended(folder, tmp_path):
    import h5py

    output = tmp_path / "results.h5"
    assess_files(folder / "r0.AT2", CONFIG, output, BatchOptions(workers=1))
    with h5py.File(output, "r+") as file:
        file["summary/pga"][0] += 1.0
    with pytest.raises(ResultsError, match="/summary/pga: its values were changed; nothing is appended"):
        assess_files(folder, CONFIG, output, appending())


POINTS = [
    pytest.param("rename", 1, marks=pytest.mark.sweep),
    *(pytest.param(point, number, marks=pytest.mark.slow) for point, number in (("record", 1), ("assembly", 40))),
    pytest.param("renamed", 1, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("point", "number"), POINTS)
def test_a_killed_run_leaves_the_old_file_and_goes_on_by_resuming(folder, tmp_path, point, number):
    output = tmp_path / "out" / "results.h5"
    output.parent.mkdir()
    assess_files(folder / "r1.AT2", CONFIG, output, BatchOptions(workers=1))
    written = output.read_bytes()
    (folder / "site.toml").write_text(CONFIG.as_text())
    command = ["assess", str(folder), "--config", str(folder / "site.toml"), "-o", str(output), "--quiet"]
    killed = in_a_fork(lambda: killed_at(point, number, [*command, "--workers", "1", "--append"]), output)
    assert killed[0] == -signal.SIGKILL, killed[1]
    assert (output.read_bytes() == written) == (point != "renamed")
    with pytest.raises(ResultsError, match="continue with --resume"):
        assess_files(folder, CONFIG, output, appending())
    # Without the earlier record it would be lost, also on resuming.
    with pytest.raises(ConfigError, match="would be lost"):
        assess_files(folder / "r0.AT2", CONFIG, output, BatchOptions(workers=1, resume=True))
    report = assess_files(folder, CONFIG, output, BatchOptions(workers=1, resume=True))
    assert (report.records, report.resumed) == (4, {"record": 2, "assembly": 4, "rename": 4, "renamed": 4}[point])
    assess_files(folder, CONFIG, tmp_path / "all.h5", BatchOptions(workers=1))
    assert_contents(output, contents(tmp_path / "all.h5"))
    assert [path.name for path in output.parent.iterdir()] == ["results.h5"]
