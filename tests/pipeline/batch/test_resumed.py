"""Batches that broke off, in part or as a whole: what they leave, what they say, and what resuming makes of it."""

from __future__ import annotations

import os
import pickle
import random
import subprocess
import sys
from collections import Counter
from contextlib import AbstractContextManager
from dataclasses import replace

import numpy as np
import pytest
from file_contents import assert_contents, contents
from record_writers import at2, pulse

import rockpulse as rp
from rockpulse import (
    BlockSettings,
    CalibrationSettings,
    FloorSettings,
    FragilitySettings,
    ModelSettings,
    PedestalSettings,
    SearchSettings,
    SiteSettings,
    TieSettings,
)
from rockpulse.assessment import assessment
from rockpulse.assessment.assessment import Assessment
from rockpulse.batch import run, survey
from rockpulse.batch.frames import MARK
from rockpulse.batch.journal import Done, Journal, JournalError, journal_path
from rockpulse.batch.options import BatchOptions
from rockpulse.batch.packing import pack, unpack
from rockpulse.batch.run import BatchReport, assess_files, calibrate_files
from rockpulse.config.configuration import Config
from rockpulse.config.fragility_settings import DATA
from rockpulse.errors import ResultsError
from rockpulse.motions.runner import worked
from rockpulse.readers.folders import read_all
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.studies.fragility.assessment import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration

CONFIG = Config(
    models=ModelSettings(use=("sequence",)),
    search=SearchSettings(models=()),
    blocks=(BlockSettings(name="wall", width=0.4, height=3.0),),
)
SITE = Config(calibration=CalibrationSettings(method="statistics", bootstrap=100), blocks=CONFIG.blocks)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three records that are worked on, and another one."""
    folder = tmp_path_factory.mktemp("records")
    for number, name in enumerate(("r0", "r1", "r2", "other")):
        title = f"Event {number}, 1/2/2003, Station {number}, 090"
        (folder / f"{name}.AT2").write_bytes(at2(pulse(400, 0.25 + 0.1 * number), title=title))
    return folder


def test_a_lost_worker_is_a_row_of_its_record(folder, tmp_path, monkeypatch):
    class Losing(run.Crew):
        def run(self, function, items):
            for item, result in super().run(function, items):
                lost = getattr(item, "key", "").startswith("r1")
                yield item, run.WorkerLost("the worker process was killed by signal 9 (Killed)") if lost else result

    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(run.Crew, "inline", classmethod(lambda cls: Losing(None, lambda: 1)))
        report: BatchReport = assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    (row,) = report.failures
    assert (report.records, report.broken_off) == (2, 1)
    assert (row.file, row.stage, row.kind) == (str(folder / "r1.AT2"), "assess", "failed")
    assert "r1.090: the worker process was killed by signal 9 (Killed), each time it was tried" in row.reason
    assert_completed(paths, output)


def assert_completed(paths, output):
    """The same command with --resume does what broke off, in place of the file that lacks it, and ends the journal."""
    with pytest.raises(ResultsError, match=r"the file exists; .*--overwrite together with --resume goes on"):
        assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True))
    assert (report.records, report.resumed, report.failures, report.broken_off) == (3, 2, [], 0)
    assert len(contents(output)["summary/record"]["values"]) == 3
    assert not journal_path(output).exists()


def test_what_broke_off_is_done_by_a_run_that_resumes(folder, tmp_path, monkeypatch):
    told, original = [], assessment.extract

    def out_of_memory(record, config, vertical):
        if record.id.startswith("r1"):
            raise MemoryError
        return original(record, config, vertical)

    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(assessment, "extract", out_of_memory)
        report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, tell=told.append))
    assert (report.records, report.broken_off) == (2, 1)
    again = f"the same command with --resume tries them again, for which {output}.journal is kept"
    assert told == [f"1 file or record broke off: {again}"]
    assert_completed(paths, output)


def test_a_file_that_could_not_be_read_is_read_by_a_run_that_resumes(folder, tmp_path, monkeypatch):
    original = survey.read_opened

    def gone(opened, options):
        if opened.name.endswith("r1.AT2"):
            raise OSError(5, "Input/output error", opened.name)
        return original(opened, options)

    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(survey, "read_opened", gone)
        report = assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    assert (report.records, report.broken_off, [row.stage for row in report.failures]) == (2, 1, ["read"])
    assert_completed(paths, output)


@pytest.mark.sweep
def test_a_run_that_resumes_has_the_same_probabilities_and_so_have_two_workers(folder, tmp_path, monkeypatch):
    """A wall that is read from the spectrum, a chest that has lanes of its own, and the bodies that practice has."""
    others = (
        BlockSettings(name="chest", width=0.4, height=0.9),
        BlockSettings(name="façade", width=0.4, height=3.0, one_sided=True),
        BlockSettings(name="tied", width=0.3, height=3.0, mass=1e3, ties=(TieSettings(height=2.0, stiffness=1e5),)),
        BlockSettings(name="aloft", width=0.4, height=3.0, floors=(FloorSettings(period=0.4),), friction=0.3),
        BlockSettings(
            name="statue",
            width=0.4,
            height=2.0,
            mass=8e2,
            pedestals=(PedestalSettings(width=0.6, height=1.0, mass=1e3),),
        ),
    )
    config = replace(CONFIG, models=ModelSettings(use=("nonlinear",)), blocks=(*CONFIG.blocks, *others))
    paths, original = sorted(folder.glob("r*")), assessment.extract

    def out_of_memory(record, config, vertical):
        if record.id.startswith("r1"):
            raise MemoryError
        return original(record, config, vertical)

    with monkeypatch.context() as patch:
        patch.setattr(assessment, "extract", out_of_memory)
        assess_files(paths, config, tmp_path / "resumed.h5", BatchOptions(workers=1))
    report = assess_files(paths, config, tmp_path / "resumed.h5", BatchOptions(workers=1, resume=True))
    assert (report.records, report.resumed) == (3, 2)
    resumed = contents(tmp_path / "resumed.h5")
    for workers in (1, 2):
        assess_files(paths, config, tmp_path / f"{workers}.h5", BatchOptions(workers=workers))
        assert_contents(tmp_path / f"{workers}.h5", resumed)
    assert np.all((resumed["summary/factor_50"]["values"] > 0.5) & (resumed["summary/factor_50"]["values"] < 10.0))


def stopped_at_the_last(folder, output, monkeypatch):
    """A run that has two of three records in its journal."""
    original = assessment.extract

    def interrupted(record, config, vertical):
        if record.id.startswith("r2"):
            raise KeyboardInterrupt
        return original(record, config, vertical)

    with monkeypatch.context() as patch:
        patch.setattr(assessment, "extract", interrupted)
        with pytest.raises(KeyboardInterrupt):
            assess_files(sorted(folder.glob("r*")), CONFIG, output, BatchOptions(workers=1))


def test_a_result_that_was_damaged_in_the_journal_is_done_again_and_the_others_are_not(folder, tmp_path, monkeypatch):
    paths, output, told = sorted(folder.glob("r*")), tmp_path / "results.h5", []
    stopped_at_the_last(folder, output, monkeypatch)
    with Journal.open(output, resume=True) as journal:
        key = next(one for one in journal.finished() if one.startswith("r1"))
        place = journal._kept[key].body.place + 1000
    content = bytearray(journal_path(output).read_bytes())
    content[place] ^= 4
    journal_path(output).write_bytes(content)
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, tell=told.append))
    assert (report.records, report.resumed, report.failures) == (3, 1, [])
    assert told == [
        f"{journal_path(output)} is damaged: the results of {key} cannot be used; what is missing is done again",
        "1 of 3 records were finished before",
    ]
    assess_files(paths, CONFIG, tmp_path / "alone.h5", BatchOptions(workers=1))
    assert_contents(output, contents(tmp_path / "alone.h5"))


def headed(text):
    """The packed arrays of a header, without a value."""
    return b"RPA1" + len(text).to_bytes(8, "little") + text.encode()


def without(name, part):
    return pack({path: values for path, values in part.items() if path != name})


#: What somebody may put in the place of a part, with a checksum that fits.
FORGED = {
    "no part": lambda part: (),
    "no bytes": lambda part: (b"",),
    "no arrays": lambda part: (headed(""),),
    "no shape": lambda part: (headed('[["a", 3]]'),),
    "a hundred terabytes of texts without a letter": lambda part: (headed('[["a", "U0", [100000000000000]]]'),),
    "an array fewer": lambda part: (without("/summary/pga", part),),
    "an array more": lambda part: (pack({**part, "/summary/more": np.zeros(1)}),),
    "a row more in one array": lambda part: (pack({**part, "/summary/pga": np.zeros(2)}),),
    "another shape": lambda part: (pack({**part, "/summary/peak_rotation_ratio": np.zeros((1, 7, 7))}),),
    "a number as such": lambda part: (pack({**part, "/summary/pga": np.array(1.0)}),),
    "texts for numbers": lambda part: (pack({**part, "/summary/pga": np.array(["1"])}),),
    "numbers for texts": lambda part: (pack({**part, "/summary/source": np.array([1.0])}),),
    "a sound and a wrong one": lambda part: (pack(part), without("/summary/pga", part)),
}


def test_what_somebody_has_put_into_the_journal_as_a_result_is_done_again(folder, tmp_path, monkeypatch):
    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    expected = contents(output)
    output.unlink()
    stopped_at_the_last(folder, output, monkeypatch)
    sound = journal_path(output).read_bytes()
    for forged, change in FORGED.items():
        journal_path(output).write_bytes(sound)
        with Journal.open(output, resume=True) as journal:
            key, fingerprint = next(one for one in journal.finished().items() if one[0].startswith("r1"))
            journal.add(Done(key, fingerprint, change(unpack(*journal.parts(key)))))
        told = []
        resume = BatchOptions(workers=1, resume=True, overwrite=True, tell=told.append)
        assert assess_files(paths, CONFIG, output, resume).resumed == 1, forged
        assert f"is damaged: the results of {key} cannot be used; what is missing is done again" in told[0], forged
        assert_contents(output, expected)


def test_results_of_other_options_are_no_damage(folder, tmp_path, monkeypatch):
    """Their arrays have other shapes."""
    output, told = tmp_path / "results.h5", []
    stopped_at_the_last(folder, output, monkeypatch)
    two = replace(CONFIG, blocks=(*CONFIG.blocks, BlockSettings(name="wide", width=0.5, height=3.0)))
    report = assess_files(sorted(folder.glob("r*")), two, output, BatchOptions(1, resume=True, tell=told.append))
    assert (report.records, report.resumed) == (3, 0)
    assert len(told) == 1
    assert "0 of 3 records were finished before; 2 are done again" in told[0]


EVERY = {
    "assess": Assessment(replace(CONFIG, models=ModelSettings(use=("sequence", "nonlinear")))),
    "statistics": SiteCalibration(SITE),
    "spectrum": SiteCalibration(replace(SITE, calibration=CalibrationSettings(bootstrap=100))),
    **{data: FragilityAnalysis(replace(CONFIG, fragility=FragilitySettings(data=data))) for data in DATA},
}


@pytest.mark.parametrize("name", EVERY)
def test_a_part_fits_the_analysis_that_makes_it_and_no_other(name):
    record = rp.Record(pulse(400, 0.4) * STANDARD_GRAVITY, dt=0.01, id="r", processed=True)
    (planned,) = EVERY[name].prepare([record]).planned
    (part,) = worked(planned, EVERY[name].work, name, EVERY[name].config)
    back = unpack(pack(part))
    assert [one for one, analysis in EVERY.items() if analysis.fits(back)] == [name]


def flipped(content, draw):
    place = draw.randrange(len(content))
    return content[:place] + bytes([content[place] ^ (1 << draw.randrange(8))]) + content[place + 1 :]


def zeroed(content, draw):
    """A page of a file system."""
    place = draw.randrange(len(content)) // 4096 * 4096
    return content[:place] + bytes(min(4096, len(content) - place)) + content[place + 4096 :]


def cut_off(content, draw):
    return content[: draw.randrange(len(content))]


def other_values(content, draw):
    """Some bytes of one of the results."""
    starts = [place for place in range(len(content)) if content.startswith(b"RPA1", place)]
    place = draw.choice(starts) + draw.randrange(12, 40)
    return content[:place] + draw.randbytes(20) + content[place + 20 :]


def records_touched(sound, damaged):
    """How many of the frames behind the first, which is that of the run, a change of the file has touched."""
    places = [place for place in range(len(sound)) if sound.startswith(MARK, place)]
    ends = [*places[1:], len(sound)]
    return sum(sound[place:end] != damaged[place:end] for place, end in zip(places[1:], ends[1:], strict=True))


@pytest.mark.slow
def test_two_hundred_damaged_journals_cost_the_records_that_were_damaged(folder, tmp_path, monkeypatch):
    """What it keeps of a record is done again, and no other; what is told of it is true."""
    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    stopped_at_the_last(folder, output, monkeypatch)
    sound = journal_path(output).read_bytes()
    journal_path(output).unlink()
    assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    expected = contents(output)
    draw, redone = random.Random(5), Counter()
    for number in range(200):
        damage = (flipped, zeroed, cut_off, other_values)[number % 4]
        output.unlink(missing_ok=True)
        damaged = damage(sound, draw)
        journal_path(output).write_bytes(damaged)
        told = []
        report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, tell=told.append))
        touched = records_touched(sound, damaged)
        assert 2 - report.resumed == touched
        assert told[-1] == f"{report.resumed} of 3 records were finished before"
        assert touched == 0 or damage is cut_off or " is damaged: " in told[0] or damaged.endswith(bytes(30))
        assert_contents(output, expected)
        assert [path.name for path in tmp_path.iterdir()] == [output.name]
        redone[damage.__name__, 2 - report.resumed] += 1
    print(dict(redone))


def stopped_after_writing(paths, output, monkeypatch):
    """Killed when the file had its name and its journal was still there."""

    def killed(self):
        raise SystemExit

    with monkeypatch.context() as patch:
        patch.setattr(run.Journal, "remove", killed)
        with pytest.raises(SystemExit):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1))


def test_a_run_that_ended_is_not_done_again_by_the_same_command(folder, tmp_path, monkeypatch):
    """As after a kill between the end of the journal and that of the process."""
    paths, output, told = sorted(folder.glob("r*")), tmp_path / "results.h5", []
    assess_files(paths, CONFIG, output, BatchOptions(workers=1))
    written = output.read_bytes()

    def done_again(*given):
        raise AssertionError

    resume = BatchOptions(workers=1, resume=True, tell=told.append)
    with monkeypatch.context() as patch:
        patch.setattr(run, "write_results", done_again)
        patch.setattr(assessment, "extract", done_again)
        report = assess_files(paths, CONFIG, output, resume)
    assert (report.path, report.records, report.resumed, report.failures) == (output, 3, 3, [])
    assert told == [f"{output}: the run had ended before, nothing was left to do"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["results.h5"]
    wider = replace(CONFIG, blocks=(BlockSettings(name="wide", width=0.5, height=3.0),))
    for asked in ((paths[:2], CONFIG), (paths, wider), (paths, replace(CONFIG, site=SiteSettings(name="other")))):
        with pytest.raises(ResultsError, match="the file exists"):
            assess_files(*asked, output, resume)
    assert output.read_bytes() == written


@pytest.mark.sweep
def test_resuming_a_run_that_had_only_its_journal_left_does_what_is_asked_for(folder, tmp_path, monkeypatch):
    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    resume = BatchOptions(workers=1, resume=True)
    stopped_after_writing(paths, output, monkeypatch)
    report = assess_files(paths, CONFIG, output, resume)
    assert (report.path, report.records, report.resumed, report.failures) == (output, 3, 3, [])
    assert not journal_path(output).exists()

    output.unlink()
    stopped_after_writing(paths, output, monkeypatch)
    wider = replace(CONFIG, blocks=(BlockSettings(name="wide", width=0.5, height=3.0),))
    assert assess_files(paths[:2], wider, output, resume).resumed == 0
    found = contents(output)
    assert (len(found["summary/record"]["values"]), found["summary/block"]["values"].tolist()) == (2, [b"wide"])


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
    assert assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, overwrite=True)).resumed == 2


def test_what_killed_writers_have_left_is_swept_up(folder, tmp_path):
    (tmp_path / ".results.h5.0123abcd.part").write_text("half")
    assess_files(folder / "r0.AT2", CONFIG, tmp_path / "results.h5", BatchOptions(workers=1))
    assert [path.name for path in tmp_path.iterdir()] == ["results.h5"]


def test_a_journal_that_is_removed_under_a_run_stops_it_and_nothing_is_claimed(folder, tmp_path, caplog):
    output = tmp_path / "results.h5"

    class Removing(AbstractContextManager):
        def __init__(self, desc, **given):
            self.desc = desc

        def __exit__(self, *error):
            pass

        def update(self, n):
            if self.desc == "assessing":
                journal_path(output).unlink()

    with pytest.raises(ResultsError, match="removed while the run was at work, and what was finished with it"):
        assess_files(sorted(folder.glob("r*")), CONFIG, output, BatchOptions(workers=1, bar=Removing))
    assert "; nothing is kept, for " in caplog.text
    assert not output.exists()


def test_only_what_the_plan_can_use_is_counted_as_kept(folder, tmp_path, monkeypatch):
    paths, output = sorted(folder.glob("r*")), tmp_path / "results.h5"
    with monkeypatch.context() as patch:
        patch.setattr(run, "write_results", interrupted)
        with pytest.raises(run.Interrupted, match="3 finished records are kept"):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1))
        wider = replace(CONFIG, blocks=(BlockSettings(name="wide", width=0.5, height=3.0),))
        with pytest.raises(run.Interrupted, match="1 finished record is kept"):
            assess_files(paths[:1], wider, output, BatchOptions(workers=1, resume=True))
        patch.setattr(run, "_worked", interrupted)
        with pytest.raises(run.Interrupted, match=r"nothing of this run was finished yet; .* keeps 3 records of other"):
            assess_files(folder / "other.AT2", CONFIG, output, BatchOptions(workers=1, resume=True))


def test_a_site_that_cannot_be_written_keeps_what_is_finished(folder, tmp_path, monkeypatch):
    def full(*args):
        raise ResultsError("the results take 3 MB, 1 MB are free; make room there")

    monkeypatch.setattr(run, "write_results", full)
    with pytest.raises(ResultsError, match=r"make room there; 3 finished records are kept in .*--resume goes on"):
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


@pytest.mark.sweep
def test_nobody_who_reads_is_no_reason_to_stop(folder, tmp_path):
    """Both streams go into a pipe whose reader has left; one file fails."""
    (tmp_path / "cut.AT2").write_bytes((folder / "r0.AT2").read_bytes()[:900])
    paths = [str(folder / "r0.AT2"), str(tmp_path / "cut.AT2")]
    options = ["--block", "wall=0.4x3", "-o", str(tmp_path / "r.h5"), "--workers=1", "--resume"]
    reader, writer = os.pipe()
    os.close(reader)
    ended = subprocess.run(
        [sys.executable, "-m", "rockpulse", "assess", *paths, *options], stdout=writer, stderr=writer, check=False
    )
    os.close(writer)
    assert ended.returncode == 1
    assert len(contents(tmp_path / "r.h5")["summary/record"]["values"]) == 1
