"""Batches that broke off, in part or as a whole: what they leave, what they say, and what resuming makes of it."""

import pickle
from dataclasses import replace

import pytest
from batch_runs import CONFIG, SITE, bar_of, four_records, without_results
from file_contents import contents

import rockpulse as rp
from rockpulse import BlockSettings
from rockpulse.assessment import assessment
from rockpulse.errors import ResultsError
from rockpulse.readers.folders import read_all
from rockpulse.run import batch as run
from rockpulse.run import survey
from rockpulse.run.batch import assess_files, calibrate_files
from rockpulse.run.journal import JournalError, journal_path
from rockpulse.run.options import BatchOptions, BatchReport


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return four_records(tmp_path_factory.mktemp("records"))


def test_a_lost_worker_is_a_row_of_its_record(folder, tmp_path, monkeypatch):
    class Losing(run.WorkerPool):
        def run(self, function, items):
            for item, result in super().run(function, items):
                lost = getattr(item, "key", "").startswith("r1")
                yield item, run.WorkerLost("the worker process was killed by signal 9 (Killed)") if lost else result

    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(run.WorkerPool, "inline", classmethod(lambda cls: Losing(None, lambda: 1)))
        without_results(patch)
        report: BatchReport = assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    (row,) = report.failures
    assert (report.records, report.broken_off) == (2, 1)
    assert (row.file, row.stage, row.kind) == (str(folder / "r1.AT2"), "assess", "failed")
    assert "r1.090: the worker process was killed by signal 9 (Killed), at every attempt" in row.reason


def test_what_broke_off_is_done_by_a_run_that_resumes(folder, tmp_path, monkeypatch):
    """Memory runs out at one record, and the file of another one cannot be read."""
    told, extract, read = [], assessment.extract, survey.read_opened

    def out_of_memory(record, config, vertical):
        if record.id.startswith("r1"):
            raise MemoryError
        return extract(record, config, vertical)

    def gone(opened, options):
        if opened.name.endswith("r2.AT2"):
            raise OSError(5, "Input/output error", opened.name)
        return read(opened, options)

    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(assessment, "extract", out_of_memory)
        patch.setattr(survey, "read_opened", gone)
        report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, tell=told.append))
    assert (report.records, report.broken_off) == (1, 2)
    assert sorted(row.stage for row in report.failures) == ["assess", "read"]
    again = f"the same command with --resume tries them again, and uses the results in {output}.journal"
    assert told == [f"2 files or records could not be finished: {again}"]
    with pytest.raises(ResultsError, match=r"the file exists; .*--overwrite together with --resume continues"):
        assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    # Resumed, what broke off is done in place of the file that lacks it, and the journal ends.
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True))
    assert (report.records, report.resumed, report.failures, report.broken_off) == (3, 1, [], 0)
    assert len(contents(output)["summary/record"]["values"]) == 3
    assert not journal_path(output).exists()


@pytest.mark.sweep
def test_the_results_of_another_run_are_not_replaced_by_resuming(folder, tmp_path, monkeypatch):
    paths, output = sorted(folder.glob("r*"))[:2], tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(run, "write_results", interrupted)
        with pytest.raises(run.Interrupted, match="2 finished records are kept"):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    rp.save(rp.assess(read_all(paths)[0], CONFIG), output)
    before = output.read_bytes()
    with pytest.raises(ResultsError, match="--overwrite together with --resume"):
        assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True))
    assert output.read_bytes() == before
    output.write_bytes(before[: len(before) // 2])  # damaged
    with pytest.raises(ResultsError, match=r"damaged .*--overwrite together with --resume"):
        assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True))
    without_results(monkeypatch)
    assert assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, overwrite=True)).resumed == 2


@pytest.mark.sweep
def test_what_killed_writers_have_left_is_swept_up(folder, tmp_path):
    (tmp_path / ".results.h5.0123abcd.part").write_text("half")
    assess_files(folder / "r0.AT2", CONFIG, tmp_path / "results.h5", BatchOptions(workers=1))
    assert [path.name for path in tmp_path.iterdir()] == ["results.h5"]


def test_a_journal_that_is_removed_under_a_run_stops_it_and_nothing_is_claimed(folder, tmp_path, caplog):
    output = tmp_path / "results.h5"
    removing = bar_of(lambda desc: desc == "assessing" and journal_path(output).unlink())
    with pytest.raises(ResultsError, match="removed during the run, and the finished records with it"):
        assess_files(sorted(folder.glob("r*")), CONFIG, output, BatchOptions(workers=1, bar=removing))
    assert "; nothing is kept, because " in caplog.text
    assert not output.exists()


def test_only_what_the_plan_can_use_is_counted_as_kept(folder, tmp_path, monkeypatch):
    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(run, "write_results", interrupted)
        with pytest.raises(run.Interrupted, match="3 finished records are kept"):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1))
        wider = replace(CONFIG, bodies=(BlockSettings(name="wide", width=0.5, height=3.0),))
        with pytest.raises(run.Interrupted, match="1 finished record is kept"):
            assess_files(paths[:1], wider, output, BatchOptions(workers=1, resume=True))
        patch.setattr(run._Batch, "work", interrupted)
        with pytest.raises(
            run.Interrupted, match=r"nothing of this run was finished.* keeps 3 records from runs with other"
        ):
            assess_files(folder / "other.AT2", CONFIG, output, BatchOptions(workers=1, resume=True))


def test_a_site_that_cannot_be_written_keeps_what_is_finished(folder, tmp_path, monkeypatch):
    def full(*args):
        raise ResultsError("the results take 3 MB, 1 MB are free; free some space there")

    monkeypatch.setattr(run, "write_results", full)
    with pytest.raises(ResultsError, match=r"free some space there; 3 finished records are kept .*--resume continues"):
        calibrate_files(sorted(folder.glob("r*")), SITE, tmp_path / "site.h5", BatchOptions(workers=1))


@pytest.mark.parametrize(
    "error", [ResultsError("full"), ResultsError("there", tells_resume=True), JournalError("gone")]
)
def test_whether_a_message_tells_of_resuming_survives_pickling(error):
    back = pickle.loads(pickle.dumps(error))
    assert (type(back), str(back), back.tells_resume) == (type(error), str(error), error.tells_resume)
    assert error.tells_resume == (str(error) != "full")


def interrupted(*args):
    raise KeyboardInterrupt
