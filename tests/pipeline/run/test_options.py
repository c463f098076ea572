"""What --resume, --overwrite, --strict and --log-file do with a run that stopped, fails or goes through."""

import re
import shutil

import pytest
from batch_runs import CONFIGURATION, RECORDS, command, names, write
from file_contents import assert_contents, contents

from rockpulse.cli import main
from rockpulse.run.journal import Journal, journal_path
from rockpulse.run.processes import WorkerProcesses


@pytest.fixture(scope="module")
def interrupted(folder, tmp_path_factory):
    """A folder for copies of the records, and the journal of a run on them that Ctrl-C has stopped after two."""
    mine, target = tmp_path_factory.mktemp("copies") / "mine", tmp_path_factory.mktemp("stopped") / "results.h5"
    shutil.copytree(folder, mine)
    add, added = Journal.add, []

    def add_two(self, done):
        add(self, done)
        added.append(done.key)
        if len(added) == 2:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Journal, "add", add_two)
        assert command(mine, target, "--quiet") == 130
    return mine, journal_path(target)


@pytest.fixture
def stopped(interrupted, folder, tmp_path):
    """The records as they were when the run was stopped, and its output, of which there is the journal."""
    mine, journal = interrupted
    shutil.rmtree(mine)
    shutil.copytree(folder, mine)  # under the names that the journal has
    target = tmp_path / "results.h5"
    shutil.copy(journal, journal_path(target))
    return mine, target


def redone(monkeypatch):
    """The records that are worked on from now on."""
    add, keys = Journal.add, []
    monkeypatch.setattr(Journal, "add", lambda self, done: keys.append(done.key) or add(self, done))
    return keys


@pytest.mark.sweep
def test_resuming_does_what_is_missing(stopped, monkeypatch, capsys):
    mine, target = stopped
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume") == 0
    assert "rockpulse: 2 of 4 records were finished before\n" in capsys.readouterr().err
    assert keys == ["r2.090", "r3.090"]


@pytest.mark.slow
def test_resuming_with_a_changed_file_does_that_one_again(stopped, monkeypatch):
    mine, target = stopped
    write(mine / "r1.AT2", 0.9)
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert keys == ["r1.090", "r2.090", "r3.090"]
    assert contents(target)["summary/pga"]["values"][1] == pytest.approx(0.9 * 9.80665, rel=0.01)


@pytest.mark.sweep
def test_resuming_on_the_wrong_files_loses_nothing(stopped, tmp_path, monkeypatch, capsys):
    mine, target = stopped
    (tmp_path / "wrong").mkdir()
    given = ["--config", str(mine / "site.toml"), "-o", str(target), "--resume", "--workers", "1"]
    assert main(["assess", str(tmp_path / "wrong"), *given]) == 1
    said = capsys.readouterr().err
    assert (
        "results.h5.journal keeps 2 finished records of other files: to continue with them, give --resume and their"
        in said
    )
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert len(keys) == 2


@pytest.mark.sweep
def test_resuming_what_never_began_begins_it(folder, tmp_path, capsys):
    mine, target = shutil.copytree(folder, tmp_path / "mine"), tmp_path / "results.h5"
    assert command(mine, target, "--resume") == 0
    assert "0 of 4 records were finished before\n" in capsys.readouterr().err
    assert len(contents(target)["summary/record"]["values"]) == RECORDS
    written = target.read_bytes()
    assert command(mine, target, "--resume") == 0
    assert "results.h5: the run was already complete; nothing was left to do" in capsys.readouterr().err
    for change in (
        lambda: (mine / "site.toml").write_text(CONFIGURATION.replace("Test", "Elsewhere")),
        lambda: (mine / "site.toml").write_text(CONFIGURATION.replace("0.4", "0.5")),
        lambda: (mine / "site.toml").write_text(CONFIGURATION) and (mine / "r1.AT2").unlink(),
    ):
        change()
        assert command(mine, target, "--resume") == 2
        assert "results.h5: the file exists" in capsys.readouterr().err
    assert target.read_bytes() == written
    assert names(tmp_path) == ["mine", "results.h5"]


def test_a_log_goes_to_the_end_of_no_other_file(folder, tmp_path, capsys):
    notes = tmp_path / "notes.txt"
    notes.write_text("mine")
    assert command(folder, tmp_path / "results.h5", "--log-file", str(notes)) == 2
    assert "notes.txt: expected a new file or an existing log" in capsys.readouterr().err
    assert notes.read_text() == "mine"
    assert command(folder, tmp_path / "results.h5", "--log-file", str(tmp_path / "results.h5")) == 2
    assert "expected a file other than the output" in capsys.readouterr().err
    assert not (tmp_path / "results.h5").exists()


@pytest.mark.slow
def test_the_log_file_tells_the_run_and_is_added_to(folder, tmp_path):
    log = tmp_path / "log.txt"
    log.write_text("2026-01-01 00:00:00,000 INFO what was there\n")
    for target, options in (("a.h5", ()), ("b.h5", ("--quiet",))):
        assert command(folder, tmp_path / target, "--log-file", str(log), *options) == 0
    lines = log.read_text().splitlines()
    assert lines[0].endswith("what was there")
    stamp = r"20\d\d-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} "
    assert all(re.match(stamp + "(INFO|WARNING) ", line) for line in lines[1:])
    told = [re.sub(stamp, "", line) for line in lines[1:] if " INFO " in line]
    assert told[1:4] == [
        "INFO reading 4 files",
        "INFO assessing 4 records; finished before: 0, to be repeated: 0",
        f"INFO {tmp_path / 'a.h5'}: 4 records; left out: nothing",
    ]
    assert len(told) == 8
    assert "WARNING r0.090: " in log.read_text()


def test_the_lock_is_given_back_when_a_run_fails(folder, tmp_path, monkeypatch):
    def broken(self, *args, **kwargs):
        raise RuntimeError("no process can be started")

    with monkeypatch.context() as patch:
        patch.setattr(WorkerProcesses, "submit", broken)
        with pytest.raises(RuntimeError, match="no process can be started"):
            command(folder, tmp_path / "r.h5", "--workers", "2")
    assert names(tmp_path) == []
    with Journal.open(tmp_path / "r.h5") as journal:
        assert journal.finished() == {}


@pytest.mark.sweep
def test_resuming_with_other_options_does_all_again_and_says_so(stopped, monkeypatch, capsys):
    """Arrays of another shape, of two bodies in place of one, are no damage."""
    mine, target = stopped
    (mine / "site.toml").write_text(CONFIGURATION + '[[block]]\nname = "wide"\nwidth = 0.5\nheight = 3.0\n')
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume") == 0
    changed = "2 are processed again, because they, the options or the version of rockpulse have changed\n"
    said = capsys.readouterr().err
    assert f"0 of {RECORDS} records were finished before; {changed}" in said
    assert "damaged" not in said
    assert len(keys) == RECORDS
    assert command(mine, target.with_name("fresh.h5"), "--quiet") == 0
    assert_contents(target, contents(target.with_name("fresh.h5")))
