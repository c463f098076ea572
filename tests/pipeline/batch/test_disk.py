"""Full disks, places that cannot be written, journals of all kinds, and what is said about it."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from record_writers import at2, pulse

import rockpulse as rp
from rockpulse.batch.journal import Journal, journal_path
from rockpulse.batch.processes import WorkerProcesses
from rockpulse.cli import main
from rockpulse.tree_writer import TreeWriter

RECORDS = 8
CONFIGURATION = """
[site]
name = "Test"
[models]
use = ["sequence"]
[search]
models = []
[[block]]
name = "wall"
width = 0.4
height = 3.0
"""


def write(path, peak):
    """A record of 6,000 samples: 48 kB in the results, a page of 64 kB in the journal."""
    path.write_bytes(at2(pulse(6000, peak), title="Event, 1/2/2003, Station, 090"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("records")
    for number in range(RECORDS):
        write(folder / f"r{number}.AT2", 0.2 + 0.05 * number)
    (folder / "site.toml").write_text(CONFIGURATION)
    return folder


def names(folder):
    return sorted(path.name for path in Path(folder).iterdir())


def command(folder, target, *options):
    given = ["--config", str(folder / "site.toml"), "-o", str(target), "--workers", "1", *options]
    return main(["assess", str(folder), *given])


@pytest.fixture(scope="module")
def undisturbed(folder, tmp_path_factory):
    target = tmp_path_factory.mktemp("undisturbed") / "results.h5"
    assert command(folder, target, "--quiet") == 0
    return rp.load(target)


def assert_same(path, other, groups=("summary", "records", "half_cycles", "failures")):
    tree = rp.load(path)
    for group in groups:
        xr.testing.assert_identical(tree[group].to_dataset(), other[group].to_dataset())


@pytest.fixture
def tmpfs(tmp_path):
    """A file system of its own and the means to give it another size or make it read-only."""
    place = tmp_path / "disk"
    place.mkdir()

    def mount(options):
        return subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", place], capture_output=True, check=False)

    if shutil.which("mount") is None or mount("size=16m").returncode:
        pytest.skip("no file system can be mounted here (root is needed): tested by a failing file layer only")
    yield place, lambda options: mount(f"remount,{options}").check_returncode()
    subprocess.run(["umount", place], check=True)


def test_a_disk_that_fills_up_keeps_what_is_finished(folder, tmpfs, undisturbed, capsys):
    place, change = tmpfs
    target = place / "results.h5"
    change("size=1100k")
    assert command(folder, target, "--quiet") == 2
    said = capsys.readouterr().err
    kept = re.search(r"cannot keep the result of r\d\.090: .*; the (\d) finished before are kept: make room", said)
    assert 0 < int(kept[1]) < RECORDS
    assert said.count("\n") == 1
    assert not target.exists()
    change("size=16m")
    assert command(folder, target, "--resume") == 0
    assert f"{kept[1]} of 8 records were finished before\n" in capsys.readouterr().err
    assert_same(target, undisturbed)
    assert names(place) == [target.name]


def test_a_journal_that_cannot_grow_keeps_what_is_finished(folder, tmp_path, undisturbed, monkeypatch, capsys):
    target = tmp_path / "results.h5"
    original = Journal.open.__func__

    def small(cls, *args):
        journal = original(cls, *args)
        journal._connection.execute("PRAGMA max_page_count = 12")
        return journal

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "open", classmethod(small))
        assert command(folder, target, "--quiet") == 2
    assert re.search(
        r"cannot keep the result of .*disk is full; the [1-7] finished before are kept", capsys.readouterr().err
    )
    assert command(folder, target, "--quiet", "--resume") == 0
    assert_same(target, undisturbed)


def test_no_room_for_the_results_keeps_what_is_finished(folder, tmpfs, undisturbed, capsys):
    place, change = tmpfs
    target = place / "results.h5"
    change("size=1800k")
    assert command(folder, target, "--quiet") == 2
    assert re.search(
        r"results.h5: the results take \d MB, \d MB are free in .*; make room there; 8 finished records are kept in "
        r".*: the same command with --resume goes on from there\n$",
        capsys.readouterr().err,
    )
    assert "results.h5.journal" in names(place)
    assert not target.exists()
    change("size=16m")
    assert command(folder, target, "--quiet", "--resume") == 0
    assert_same(target, undisturbed)
    assert names(place) == [target.name]


def test_a_disk_that_fills_up_while_the_results_are_written(folder, tmpfs, undisturbed, monkeypatch, capfd):
    place, change = tmpfs
    target = place / "results.h5"
    change("size=1600k")
    with monkeypatch.context() as patch:  # somebody else takes the room that was there
        patch.setattr("shutil.disk_usage", lambda path: shutil._ntuple_diskusage(10**9, 0, 10**9))
        assert command(folder, target, "--quiet") == 2
    said = capfd.readouterr().err
    assert "results.h5: cannot write the results: No space left on device; 8 finished records are kept" in said
    assert not target.exists()
    assert not list(place.glob(".*.part"))
    change("size=16m")
    assert command(folder, target, "--quiet", "--resume") == 0
    assert_same(target, undisturbed)


def test_a_fault_of_the_disk_while_the_results_are_written(folder, tmp_path, undisturbed, monkeypatch, capsys):
    target = tmp_path / "results.h5"

    def fail(self, path, values):
        raise OSError("Can't write data (errno = 5, error message = 'Input/output error')")

    with monkeypatch.context() as patch:
        patch.setattr(TreeWriter, "append", fail)
        assert command(folder, target, "--quiet") == 2
    assert "cannot write the results: Input/output error; 8 finished records are kept" in capsys.readouterr().err
    assert command(folder, target, "--quiet", "--resume") == 0
    assert_same(target, undisturbed)


def test_a_name_that_leaves_no_room_for_that_of_the_journal_is_refused(folder, tmp_path, capsys):
    assert command(folder, tmp_path / ("n" * 240)) == 2
    assert "cannot keep the journal of the run beside the output: File name too long" in capsys.readouterr().err
    assert names(tmp_path) == []


def test_a_read_only_disk_is_refused_at_once(folder, tmpfs, capsys):
    place, change = tmpfs
    change("ro")
    for options in ([], ["--resume"], ["--overwrite"]):
        assert command(folder, place / "results.h5", *options) == 2
        assert "Read-only file system" in capsys.readouterr().err
    change("rw")


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("file/results.h5", "there is no folder .*file; create it first"),
        ("gone/results.h5", r"there is no folder .*gone; create it first"),
        ("folder", "found something that is no regular file"),
        ("file", "the file exists|found another file, which is not replaced"),
    ],
)
@pytest.mark.parametrize("resume", [(), ("--resume",)], ids=["new", "resumed"])
def test_a_place_that_takes_no_results_is_refused_at_once(folder, tmp_path, capsys, target, message, resume):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    assert command(folder, tmp_path / target, *resume) == 2
    said = capsys.readouterr().err
    assert re.search(message, said)
    assert str(tmp_path / target) in said
    assert names(tmp_path) == ["file", "folder"]
    assert (tmp_path / "file").read_text() == "mine"


def test_the_output_may_lie_on_another_disk_than_temporary_files(folder, tmp_path, undisturbed, monkeypatch):
    shared = Path("/dev/shm")
    if not shared.is_dir() or shared.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("no second file system at /dev/shm")
    with tempfile.TemporaryDirectory(dir=shared) as place:
        monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
        monkeypatch.setenv("TMPDIR", str(tmp_path))
        assert command(folder, Path(place) / "results.h5", "--quiet") == 0
        assert_same(Path(place) / "results.h5", undisturbed)
        assert names(place) == ["results.h5"]
    assert names(tmp_path) == []


def text(path):
    path.write_text("a diary\n" * 50)


def half_of_a_journal(path):
    with Journal.open(path.with_suffix("")) as journal:
        journal._connection.execute("CREATE TABLE filler AS SELECT randomblob(500000)")
    path.write_bytes(path.read_bytes()[:200_000])


@pytest.mark.parametrize(
    ("make", "message"),
    [(text, "found another file, which is left alone"), (half_of_a_journal, "the journal of the run is damaged")],
)
@pytest.mark.parametrize("options", [(), ("--resume",), ("--overwrite",)], ids=["new", "resumed", "overwritten"])
def test_a_journal_that_is_none_is_refused(folder, tmp_path, capsys, make, message, options):
    target = tmp_path / "results.h5"
    make(journal_path(target))
    before = journal_path(target).read_bytes()
    assert command(folder, target, *options) == 2
    assert message in capsys.readouterr().err
    assert journal_path(target).read_bytes() == before
    assert not target.exists()


@pytest.fixture
def stopped(folder, tmp_path, monkeypatch, capsys):
    """A copy of the records, and a run on it that Ctrl-C has stopped after five of them."""
    mine = tmp_path / "mine"
    shutil.copytree(folder, mine)
    target = tmp_path / "results.h5"
    add, added = Journal.add, []

    def interrupted(self, done):
        add(self, done)
        added.append(done.key)
        if len(added) == 5:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "add", interrupted)
        assert command(mine, target, "--quiet") == 130
    assert "interrupted; 5 finished records are kept in" in capsys.readouterr().err
    return mine, target


def redone(monkeypatch):
    """The records that are worked on from now on."""
    add, keys = Journal.add, []
    monkeypatch.setattr(Journal, "add", lambda self, done: keys.append(done.key) or add(self, done))
    return keys


def test_resuming_does_what_is_missing(stopped, monkeypatch, capsys):
    mine, target = stopped
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume") == 0
    assert "rockpulse: 5 of 8 records were finished before\n" in capsys.readouterr().err
    assert keys == ["r5.090", "r6.090", "r7.090"]


def test_a_stopped_run_is_not_begun_anew_unasked(stopped, capsys):
    mine, target = stopped
    assert command(mine, target) == 2
    assert re.search(r"was stopped with 5 records done; go on with --resume, or begin", capsys.readouterr().err)
    assert command(mine, target, "--overwrite", "--quiet") == 0
    assert rp.load(target)["summary"].sizes["record"] == RECORDS


def test_resuming_with_other_options_does_all_again_and_says_so(stopped, monkeypatch, capsys):
    mine, target = stopped
    (mine / "site.toml").write_text(CONFIGURATION.replace("0.4", "0.5"))
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume") == 0
    assert (
        "0 of 8 records were finished before; 5 are done again, for they, the options or the version of rockpulse have "
        "changed\n" in capsys.readouterr().err
    )
    assert len(keys) == RECORDS
    assert command(mine, target.with_name("fresh.h5"), "--quiet") == 0
    assert_same(target, rp.load(target.with_name("fresh.h5")))


def test_options_that_change_no_number_do_nothing_again(stopped, monkeypatch):
    mine, target = stopped
    (mine / "site.toml").write_text(CONFIGURATION.replace('"Test"', '"Another"') + "[run]\nworkers = 1\n")
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert len(keys) == 3
    assert "Another" in rp.load(target).attrs["title"]


def test_resuming_with_a_changed_file_does_that_one_again(stopped, monkeypatch):
    mine, target = stopped
    write(mine / "r2.AT2", 0.9)
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert keys == ["r2.090", "r5.090", "r6.090", "r7.090"]
    found = rp.load(target)["summary"]["pga"].sel(record="r2.090").item()
    assert found == pytest.approx(0.9 * 9.80665, rel=0.01)


def test_a_file_that_went_and_one_that_came_are_seen(stopped, monkeypatch):
    mine, target = stopped
    (mine / "r1.AT2").unlink()
    write(mine / "r8.AT2", 0.9)
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert keys == ["r5.090", "r6.090", "r7.090", "r8.090"]
    found = rp.load(target)["summary"]["record"].values.tolist()
    assert found == [f"r{number}.090" for number in (0, 2, 3, 4, 5, 6, 7, 8)]


def test_resuming_on_the_wrong_files_loses_nothing(stopped, tmp_path, monkeypatch, capsys):
    mine, target = stopped
    (tmp_path / "wrong").mkdir()
    given = ["--config", str(mine / "site.toml"), "-o", str(target), "--resume", "--workers", "1"]
    assert main(["assess", str(tmp_path / "wrong"), *given]) == 1
    said = capsys.readouterr().err
    assert "results.h5.journal keeps 5 finished records of other files: give --resume with the paths of these" in said
    keys = redone(monkeypatch)
    assert command(mine, target, "--resume", "--quiet") == 0
    assert len(keys) == 3


def test_resuming_what_never_began_begins_it(folder, tmp_path, undisturbed, capsys):
    target = tmp_path / "results.h5"
    assert command(folder, target, "--resume") == 0
    assert "0 of 8 records were finished before\n" in capsys.readouterr().err
    assert_same(target, undisturbed)
    assert command(folder, target, "--resume") == 2
    assert "results.h5: the file exists" in capsys.readouterr().err
    assert names(tmp_path) == ["results.h5"]


def test_strict_stops_at_the_first_failure(folder, tmp_path, capsys):
    target, log = tmp_path / "results.h5", tmp_path / "log"
    (tmp_path / "still.AT2").write_bytes(at2(np.zeros(400)))
    given = ["--config", str(folder / "site.toml"), "-o", str(target), "--workers", "1", "--log-file", str(log)]
    assert main(["assess", str(folder / "r0.AT2"), str(tmp_path / "still.AT2"), *given, "--strict"]) == 1
    said = capsys.readouterr().err
    assert re.search(
        r"stopped at the first failure \(--strict\): still.090: .*; \d finished records? (is|are) kept", said
    )
    assert not target.exists()
    assert "ERROR stopped at the first failure" in log.read_text()


def test_the_log_file_tells_the_run_and_is_added_to(folder, tmp_path):
    log = tmp_path / "log.txt"
    log.write_text("what was there\n")
    for target, options in (("a.h5", ()), ("b.h5", ("--quiet",))):
        assert command(folder, tmp_path / target, "--log-file", str(log), *options) == 0
    lines = log.read_text().splitlines()
    assert lines[0] == "what was there"
    stamp = r"20\d\d-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} "
    assert all(re.match(stamp + "(INFO|WARNING) ", line) for line in lines[1:])
    told = [re.sub(stamp, "", line) for line in lines[1:] if " INFO " in line]
    assert told[1:4] == [
        "INFO reading 8 files",
        "INFO assessing 8 records; finished before: 0, of another state: 0",
        f"INFO {tmp_path / 'a.h5'}: 8 records; left out: nothing",
    ]
    assert len(told) == 8
    assert "WARNING r0.090: " in log.read_text()


def test_a_log_that_cannot_be_written_is_refused_before_the_work(folder, tmp_path, capsys):
    assert command(folder, tmp_path / "results.h5", "--log-file", str(tmp_path / "gone" / "log")) == 2
    assert "gone/log: No such file or directory" in capsys.readouterr().err
    assert names(tmp_path) == []


def test_the_lock_is_given_back_when_a_run_fails(folder, tmp_path, monkeypatch):
    def broken(self, *args, **kwargs):
        raise RuntimeError("no process can be started")

    with monkeypatch.context() as patch:
        patch.setattr(WorkerProcesses, "submit", broken)
        with pytest.raises(RuntimeError, match="no process can be started"):
            main(
                [
                    "assess",
                    str(folder),
                    "--config",
                    str(folder / "site.toml"),
                    "-o",
                    str(tmp_path / "r.h5"),
                    "--workers=2",
                ]
            )
    assert names(tmp_path) == []
    assert command(folder, tmp_path / "r.h5", "--quiet") == 0
