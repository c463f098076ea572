"""A batch in Python: its file is the tree of the in-memory route, whoever does the work."""

import logging
import multiprocessing
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from batch_runs import bar_of, without_results
from file_contents import assert_contents, contents
from nominal import Config, ida
from record_writers import at2, pulse
from record_writers.geonet import geonet

import rockpulse as rp
from rocking import kernel_cache
from rockpulse import BlockSettings, CalibrationSettings, ModelSettings, RecordSettings, SearchSettings
from rockpulse.assessment import assessment
from rockpulse.errors import ConfigError, Failure, RecordRefused, ResultsError, StoppedAtFailure
from rockpulse.readers.folders import read_all
from rockpulse.run import batch as run
from rockpulse.run.analysis import run as run_in_memory
from rockpulse.run.batch import assess_files, calibrate_files, fragility_files
from rockpulse.run.options import BatchOptions
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration

CONFIG = Config(
    models=ModelSettings(use=("sequence", "linear")),
    search=SearchSettings(models=("sequence",), points=16),
    bodies=(BlockSettings(name="wall", width=0.4, height=3.0), BlockSettings(name="pier", width=1.0, height=3.0)),
)
SITE = Config(
    calibration=CalibrationSettings(bootstrap=100),
    fragility=ida(limit_states=("uplift", 0.4, "overturning"), measures=("pga", "velocity_ratio")),
    search=SearchSettings(points=16),
    bodies=CONFIG.bodies[:1],
)


def three(number):
    """Two horizontal channels and a vertical one [mm/s2]."""
    return [pulse(300 + number, peak * (1.0 + 0.1 * number)) for peak in (3000.0, -2000.0, 1500.0)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two instruments of three channels, three single channels, one of them twice, and a damaged file."""
    folder = tmp_path_factory.mktemp("records")
    for number in range(2):
        (folder / f"g{number}.V1A").write_bytes(geonet(three(number), site=f"ST{number}"))
    for number in range(3):
        content = at2(pulse(400, 0.25 + 0.1 * number), title=f"Event {'ABC'[number]}, 1/2/2003, Station {number}, 090")
        (folder / f"r{number}.AT2").write_bytes(content)
    (folder / "again.AT2").write_bytes((folder / "r1.AT2").read_bytes())
    (folder / "cut.AT2").write_bytes((folder / "r0.AT2").read_bytes()[:900])
    return folder


def saved(tree, path):
    rp.save(tree, path)
    return contents(path)


@pytest.mark.sweep
def test_the_file_of_an_assessment_is_the_tree_in_memory(folder, tmp_path):
    config = replace(CONFIG, records=RecordSettings(components="sweep", azimuth_step=90.0), bodies=CONFIG.bodies[:1])
    records, failures = read_all(folder)
    expected = saved(rp.assess(records, config, failures=failures), tmp_path / "memory.h5")
    report = assess_files(folder, config, tmp_path / "batch.h5", BatchOptions(workers=1))
    assert report.records == len(expected["summary/record"]["values"]) > 3
    assert_contents(report.path, expected)


#: The other analyses by their verbs, each in memory and of files.
OTHERS = {"calibrate": (SiteCalibration, calibrate_files), "fragility": (FragilityAnalysis, fragility_files)}


@pytest.mark.parametrize("verb", OTHERS)
@pytest.mark.parametrize(
    "components", [pytest.param("horizontal", marks=pytest.mark.sweep), pytest.param("sweep", marks=pytest.mark.slow)]
)
def test_the_file_of_a_site_and_of_fragility_is_the_tree_in_memory(folder, tmp_path, verb, components):
    config = replace(SITE, records=RecordSettings(components=components, azimuth_step=60.0))
    analysis, of_files = OTHERS[verb]
    files = [folder / name for name in ("g0.V1A", "r0.AT2", "r1.AT2", "cut.AT2")]
    records, failures = read_all(files)
    expected = saved(run_in_memory(analysis(config), records, failures), tmp_path / "memory.h5")
    report = of_files(files, config, tmp_path / "batch.h5", BatchOptions(workers=1))
    assert report.records == (4 if components == "horizontal" else 3)
    assert_contents(tmp_path / "batch.h5", expected)


@pytest.fixture(scope="module")
def in_memory(folder, tmp_path_factory):
    """What the records give in memory."""
    records, failures = read_all(folder)
    return saved(rp.assess(records, CONFIG, failures=failures), tmp_path_factory.mktemp("one") / "results.h5")


@pytest.mark.slow
def test_two_workers_give_the_same(folder, in_memory, tmp_path):
    assess_files(folder, CONFIG, tmp_path / "results.h5", BatchOptions(workers=2))
    assert_contents(tmp_path / "results.h5", in_memory)


@pytest.mark.slow
def test_a_worker_that_is_killed_at_work_changes_nothing_and_its_record_is_tried_again(
    folder, in_memory, tmp_path, monkeypatch
):
    """One of two processes is killed at the first record: what they have finished is kept, the others go on."""
    submitted, killed, submit, add = [], [], run.WorkerPool._submit, run.Journal.add
    added = []

    def submitting(pool, packed, group):
        submitted.extend(group)
        return submit(pool, packed, group)

    def kill(desc):
        if desc == "assessing" and not killed:
            killed.append(multiprocessing.active_children()[0])
            killed[0].kill()

    monkeypatch.setattr(run.WorkerPool, "_submit", submitting)
    monkeypatch.setattr(run.Journal, "add", lambda journal, done: added.append(done.key) or add(journal, done))
    report = assess_files(folder, CONFIG, tmp_path / "results.h5", BatchOptions(workers=2, bar=bar_of(kill)))
    tasks = [item for item in submitted if isinstance(item, run.Task)]
    repeated = {task.key for task in tasks if tasks.count(task) == 2}
    assert (len(repeated), len(tasks)) == (1, len(added) + 1)
    assert sorted(added) == sorted({task.key for task in tasks})  # each result once
    assert added[0] not in repeated
    assert added[-1] in repeated
    assert report.broken_off == 0
    assert_contents(tmp_path / "results.h5", in_memory)


@pytest.mark.sweep
def test_any_executor_gives_the_same_and_stays_the_callers(folder, in_memory, tmp_path):
    with ThreadPoolExecutor(3) as threads:
        assess_files(folder, CONFIG, tmp_path / "results.h5", BatchOptions(executor=threads))
        assert threads.submit(abs, -1).result() == 1
    assert_contents(tmp_path / "results.h5", in_memory)


@pytest.mark.parametrize("verb", [rp.assess, rp.fragility, rp.calibrate])
def test_the_functions_take_progress_and_failures(verb):
    record = rp.Record(pulse(300, 3.0), 0.01, "a")
    seen, row = [], Failure("b.AT2", "read", "b.AT2: damaged", "failed")
    config = replace(SITE, models=CONFIG.models)
    try:
        tree = verb([record], config, failures=[row], progress=lambda planned: seen.extend(planned) or planned)
        assert tree["failures"]["reason"].values.tolist()[0] == "b.AT2: damaged"
    except RecordRefused:  # one record calibrates no site
        assert verb is rp.calibrate
    assert [one.name for one in seen] == ["a"]


@pytest.mark.sweep
def test_the_number_of_workers_is_that_of_the_configuration(folder, tmp_path, monkeypatch):
    started = []
    without_results(monkeypatch)
    monkeypatch.setattr(run.WorkerPool, "begin", lambda *args: None)
    monkeypatch.setattr(
        run.WorkerPool, "local", lambda workers: started.append(workers) or run.WorkerPool(None, lambda: workers)
    )
    for workers in (1, 3):
        config = replace(CONFIG, run=replace(CONFIG.run, workers=workers))
        assess_files(folder / "r0.AT2", config, tmp_path / f"{workers}.h5")
    assess_files(folder / "r0.AT2", config, tmp_path / "two.h5", BatchOptions(workers=2))
    assess_files(folder / "r0.AT2", config, tmp_path / "all.h5", BatchOptions(workers="all"))  # one file: no process
    assert started == [3, 2]


LOST = run.WorkerLost("killed by signal 9"), "compiling the kernels: killed by signal 9"
LOGGED = (("rockpulse", logging.WARNING, "compiled again by every run"),), "compiled again by every run"


@pytest.mark.parametrize(("outcome", "said"), [LOST, LOGGED])
def test_a_run_waits_for_the_kernels_and_says_what_their_worker_says(
    folder, tmp_path, monkeypatch, caplog, outcome, said
):
    monkeypatch.setattr(kernel_cache, "logged", set())
    monkeypatch.setattr(run, "PATIENCE", 0.0)
    monkeypatch.setattr(run.WorkerPool, "local", lambda workers: run.WorkerPool(None, lambda: workers))
    monkeypatch.setattr(run.WorkerPool, "begin", lambda *args: Future())
    monkeypatch.setattr(run.WorkerPool, "result_of", lambda *args: outcome)
    caplog.set_level(logging.INFO, "rockpulse")
    assert assess_files(folder / "r0.AT2", CONFIG, tmp_path / "r.h5", BatchOptions(workers=2)).records == 1
    assert run.WAITING in caplog.text
    assert said in caplog.text


@pytest.mark.sweep
def test_progress_and_report_say_what_was_done(folder, tmp_path, caplog, monkeypatch):
    without_results(monkeypatch)
    caplog.set_level(logging.INFO, "rockpulse")
    bars = []

    @contextmanager
    def bar(**given):
        bars.append({**given, "done": 0})
        yield SimpleNamespace(update=lambda n: bars[-1].update(done=bars[-1]["done"] + n))
        bars[-1]["closed"] = True

    options = BatchOptions(workers=1, bar=bar)
    report = assess_files([folder / "cut.AT2", folder], CONFIG, tmp_path / "results.h5", options)
    assert bars == [
        {"total": 7, "initial": 0, "desc": "reading", "unit": " files", "done": 7, "closed": True},
        {"total": 7, "initial": 0, "desc": "assessing", "unit": " records", "done": 7, "closed": True},
    ]
    assert (report.path, report.records, report.resumed) == (tmp_path / "results.h5", 7, 0)
    assert sorted(report.seconds) == ["condition", "pack", "read", "solve"]
    assert all(seconds > 0.0 for seconds in report.seconds.values())
    rows = [(row.file.rpartition("/")[2], row.stage, row.kind) for row in report.failures]
    assert rows == [
        ("cut.AT2", "read", "failed"),
        ("r1.AT2", "read", "duplicate"),
        ("g0.V1A", "select", "vertical"),
        ("g1.V1A", "select", "vertical"),
    ]
    assert f"{report.path}: 7 records; left out: duplicate 1, failed 1, vertical 2" in caplog.text
    assert [entry.message for entry in caplog.records if "cut.AT2" in entry.message and entry.levelname == "ERROR"]
    assert caplog.text.count("the format does not say whether the record is processed") <= 7


def test_nothing_assessed_writes_nothing_and_leaves_nothing(folder, tmp_path, caplog):
    caplog.set_level(logging.INFO, "rockpulse")
    output = tmp_path / "results.h5"
    report = assess_files([folder / "cut.AT2", tmp_path / "gone"], CONFIG, output, BatchOptions(workers=1))
    assert (report.path, report.records) == (None, 0)
    assert [row.stage for row in report.failures] == ["read", "find"]
    assert f"{output}: nothing was written; left out: failed 2" in caplog.text
    with pytest.raises(RecordRefused, match="no record could be calibrated"):
        calibrate_files(folder / "cut.AT2", SITE, output, BatchOptions(workers=1))
    assert fragility_files(folder / "cut.AT2", SITE, output, BatchOptions(workers=1)).path is None
    assert list(tmp_path.iterdir()) == []


def test_strict_stops_at_the_first_failure_and_says_what_is_kept(folder, tmp_path, monkeypatch):
    output = tmp_path / "results.h5"
    with pytest.raises(StoppedAtFailure, match=r"\(--strict\): .*cut.AT2:\d+: .*; nothing was finished yet"):
        assess_files(folder, CONFIG, output, BatchOptions(workers=1, strict=True))
    assert list(tmp_path.iterdir()) == []

    (tmp_path / "still.AT2").write_bytes(at2(np.zeros(400)))
    paths = [folder / "r0.AT2", tmp_path / "still.AT2"]
    without_results(monkeypatch)
    said = (
        r"still.*; 2 finished records are kept in .*journal: .*--resume.*, and without --strict it goes on after this"
    )
    for resume in (False, True):  # resumed, it stops where it stopped
        with pytest.raises(StoppedAtFailure, match=said):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1, strict=True, resume=resume))
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True))
    assert (report.records, report.resumed, len(report.failures)) == (1, 2, 1)


def test_what_cannot_be_is_refused_before_anything_is_read(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(run, "survey_file", None)
    with pytest.raises(ConfigError, match="block"):
        assess_files(folder, replace(CONFIG, bodies=()), tmp_path / "results.h5")
    with pytest.raises(ResultsError, match="there is no folder"):
        assess_files(folder, CONFIG, tmp_path / "gone" / "results.h5")
    (tmp_path / "there.h5").write_text("a text")
    with pytest.raises(ResultsError, match="the file exists"):
        assess_files(folder, CONFIG, tmp_path / "there.h5")
    assert [path.name for path in tmp_path.iterdir()] == ["there.h5"]


def test_a_fault_of_the_program_is_a_row_and_the_rest_goes_on(folder, tmp_path, monkeypatch, caplog):
    def broken(record, config, vertical):
        if record.id.startswith("r1"):
            raise ZeroDivisionError("a fault")
        return original(record, config, vertical)

    original = assessment.extract
    without_results(monkeypatch)
    monkeypatch.setattr(assessment, "extract", broken)
    report = assess_files(sorted(folder.glob("r*")), CONFIG, tmp_path / "results.h5", BatchOptions(workers=1))
    (row,) = report.failures
    assert report.records == 2
    assert (row.stage, row.kind) == ("assess", "failed")
    assert "unexpected ZeroDivisionError: a fault; please report it" in row.reason
    assert "Traceback" in caplog.text
