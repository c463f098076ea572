"""The journal: durable, locked, resumed, and clear about what it cannot use."""

import errno
import json
import os
import signal
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

from rockpulse.errors import Failure, ResultsError
from rockpulse.run import frames
from rockpulse.run import journal as journals
from rockpulse.run.frames import pack, unpack
from rockpulse.run.journal import Journal, journal_path
from rockpulse.run.tasks import Done

FAILURE = Failure("a.txt", "assess", os.fsdecode(b"caf\xe9") + ": no intense phase", "failed")


def done(key, content=b"x", fingerprint="f", failures=()):
    return Done(key, fingerprint, (content,) if content else (), failures)


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    """Nobody waits for a run that is not going to end."""
    monkeypatch.setattr(journals, "PATIENCE", 0.1)


@pytest.fixture
def target(tmp_path):
    return tmp_path / "results.h5"


def test_what_was_added_is_there_after_reopening(target):
    with Journal.open(target) as journal:
        run_id = journal.run_id
        journal.add(done("a", b"\0\xff" * 70000))
        journal.add(Done("b", "g", (b"1", b"", b"3"), (FAILURE, FAILURE)))
    with Journal.open(target, resume=True) as journal:
        assert journal.run_id == run_id
        assert journal.finished() == {"a": "f", "b": "g"}
        assert journal.parts("a") == (b"\0\xff" * 70000,)
        assert journal.parts("b") == (b"1", b"", b"3")
        assert journal.parts("never heard of") == ()
        assert list(journal.failures()) == ["b"]
        assert journal.failures()["b"][1].reason == "caf\ufffd: no intense phase"


def test_what_has_taken_the_place_of_a_journal_stays(target):
    with Journal.open(target) as journal:
        journal.add(done("a"))
        journal_path(target).unlink()
        assert not journal.is_current
        with pytest.raises(ResultsError, match="removed during the run"):
            journal.add(done("b"))
        journal_path(target).write_text("another's")
        journal.remove()
    assert journal_path(target).read_text() == "another's"


def test_runs_that_begin_together_end_in_one_that_works(target):
    all_told = Barrier(4)

    def begin(number):
        try:
            journal = Journal.open(target)
        except ResultsError as error:
            all_told.wait(300.0)
            return str(error)
        all_told.wait(300.0)
        journal.remove()
        return "works"

    with ThreadPoolExecutor(4) as threads:
        said = sorted(threads.map(begin, range(4)), key=len)
    assert said[0] == "works"
    assert all("is writing this output" in text for text in said[1:])
    assert list(target.parent.iterdir()) == []


def test_an_empty_file_is_no_journal_to_ask_about_and_goes_with_a_run_that_fails(target, monkeypatch):
    journal_path(target).touch()

    def full(*given):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(journals, "append", full)
        with pytest.raises(
            ResultsError, match=r"cannot write the journal of the run .*: No space left on device; choose"
        ):
            Journal.open(target)
    assert not journal_path(target).exists()


def test_a_second_result_of_a_task_takes_the_place_of_the_first(target):
    with Journal.open(target) as journal:
        journal.add(Done("a", "old", (b"1", b"2"), (FAILURE,)))
        journal.add(Done("a", "new", (b"3",)))
        assert journal.finished() == {"a": "new"}
        assert journal.parts("a") == (b"3",)
        assert journal.failures() == {}


def test_a_stopped_run_is_neither_dropped_nor_resumed_unasked(target):
    with Journal.open(target) as journal:
        first = journal.run_id
        journal.add(done("a"))
        journal.add(done("b"))
    with pytest.raises(ResultsError, match=r"stopped with 2 records done; continue with --resume, or .* --overwrite"):
        Journal.open(target)
    with Journal.open(target, overwrite=True) as journal:
        assert journal.finished() == {}
        assert journal.run_id != first
    with Journal.open(target) as journal:  # nothing was done: nothing to ask about
        assert journal.finished() == {}


def in_process(script, *args):
    """A process that runs a script and then waits for its input to end."""
    command = [sys.executable, "-c", textwrap.dedent(script), *map(str, args)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


OWNER = """
    import sys
    from rockpulse.run.journal import Journal
    from rockpulse.run.tasks import Done
    with Journal.open(sys.argv[1]) as journal:
        journal_file = journal.path
        for number in range(3):
            journal.add(Done(f"record {number}", "f", (bytes(200_000),)))
            print(number, flush=True)
        journal._file.write(journal_file.read_bytes()[:-100_000])  # as if the next one were half written
        sys.stdin.read()
"""


@pytest.mark.sweep
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_killed_run_gives_its_lock_back_and_keeps_what_it_finished(target):
    with in_process(OWNER, target) as owner:
        assert [owner.stdout.readline() for _ in range(3)] == ["0\n", "1\n", "2\n"]
        who = f"process {owner.pid}" if Path("/proc/locks").is_file() else "process"
        with pytest.raises(ResultsError, match=rf"{who} is writing this output; wait for it"):
            Journal.open(target, resume=True)
        owner.send_signal(signal.SIGKILL)
        owner.wait(timeout=300)
    with Journal.open(target, resume=True) as journal:
        assert list(journal.finished()) == ["record 0", "record 1", "record 2"]
        assert journal.parts("record 2") == (bytes(200_000),)


def test_a_journal_goes_with_the_file_behind_a_link(target, tmp_path):
    (tmp_path / "far").mkdir()
    target.symlink_to(tmp_path / "far" / "real.h5")
    assert journal_path(target) == (tmp_path / "far" / "real.h5.journal").resolve()


def _text(path):
    path.write_text("my own journal, a diary\n" * 50)


def _of_another_version(path):
    path.write_bytes(b"\x89RPJ\x09" + bytes(200))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (_text, "found another file, which is not changed"),
        (_of_another_version, "found the journal of another version"),
        (os.mkfifo, "expected a file, found a pipe"),
    ],
)
@pytest.mark.parametrize("options", [{}, {"resume": True}, {"overwrite": True}])
def test_a_file_that_is_no_journal_is_left_alone(target, make, message, options):
    path = journal_path(target)
    make(path)
    before = path.read_bytes() if path.is_file() else b""
    with pytest.raises(ResultsError, match=message):
        Journal.open(target, **options)
    assert path.is_fifo() or path.read_bytes() == before


def kept_of(target):
    """What a journal of records of a kilobyte keeps, each as it was written, and the keys of those that are not."""
    with Journal.open(target, resume=True) as journal:
        damaged, gaps = journal.drop_damaged(lambda *_: True), journal.gaps
        for key, fingerprint in journal.finished().items():
            assert (fingerprint, journal.parts(key)) == ("f", (bytes([int(key[-1])]) * 1000,))
            assert journal.failures()[key] == [Failure(key, "assess", "weak", "skipped")]
        return set(journal.finished()), damaged, gaps


@pytest.fixture
def whole(target):
    """The bytes of a journal of six records."""
    with Journal.open(target) as journal:
        for number in range(6):
            weak = (Failure(f"record {number}", "assess", "weak", "skipped"),)
            journal.add(done(f"record {number}", bytes([number]) * 1000, failures=weak))
    return journal_path(target).read_bytes()


@pytest.mark.sweep
def test_any_byte_that_is_damaged_costs_the_record_that_it_belongs_to(target, whole):
    """Every 53rd byte, each with another bit changed; the first of the file does not hide what comes after it."""
    for place in range(0, len(whole), 53):
        changed = bytes([whole[place] ^ (1 << place % 8)])
        journal_path(target).write_bytes(whole[:place] + changed + whole[place + 1 :])
        found, damaged, gaps = kept_of(target)
        assert len(found) == (6 if place < whole.index(frames.MARK, 1) else 5)
        assert len(damaged) + gaps == 1 or place >= whole.rindex(frames.MARK)  # the last one may have been cut off


def test_a_journal_that_was_cut_off_keeps_what_lies_before(target, whole):
    ends = [place for place in range(1, len(whole) + 1) if whole.startswith(frames.MARK, place)] + [len(whole)]
    for size in range(0, len(whole), 199):
        journal_path(target).write_bytes(whole[:size])
        assert kept_of(target) == ({f"record {number}" for number in range(6) if ends[number + 1] <= size}, [], 0)


def test_frames_that_somebody_has_made_are_passed_over(target, whole):
    """With right checksums, but without what is asked of them."""
    run = {"run": "r", "started": "today"}
    row = ["a", "read", "why", "failed", "units g"]
    others = (
        [],
        {},
        {"run": 3, "started": ""},
        {**run, "key": "a"},
        {**run, "key": ["a"], "fingerprint": "f", "failures": []},
        {**run, "key": "a", "fingerprint": "f", "failures": [row[:3]]},
        {**run, "key": "a", "fingerprint": "f", "failures": "text"},
    )
    with journal_path(target).open("r+b", buffering=0) as file:
        for number, head in enumerate(others):
            end = file.seek(0, os.SEEK_END)
            text = json.dumps(head if number == 0 else {**head, "parts": []}).encode()
            start = frames.START.pack(frames.MARK, len(text), 0, frames._crc(len(text), 0, text))
            file.write(start + text)
            assert file.tell() > end
    found, damaged, gaps = kept_of(target)
    assert (len(found), damaged, gaps) == (6, [], len(others))


def test_a_head_that_is_damaged_after_it_was_read_is_an_error_of_its_task(target):
    with Journal.open(target) as journal:
        journal.add(done("a", b"1"))
        content = journal_path(target).read_bytes()
        journal_path(target).write_bytes(content.replace(b'"key": "a"', b'"key": "b"'))
        with pytest.raises(ResultsError, match=r"the stored result of a is damaged.*--resume"):
            journal.parts("a")


def test_a_full_disk_keeps_what_was_finished(target, monkeypatch):
    def fill(file, content):
        file.write(memoryview(content)[:100])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with Journal.open(target) as journal:
        journal.add(done("a", bytes(100_000)))
        journal.add(done("broke off", b"", fingerprint=journals.UNFINISHED))
        size = journal_path(target).stat().st_size
        with monkeypatch.context() as patch:
            patch.setattr(frames, "_write", fill)
            with pytest.raises(
                ResultsError,
                match=r"cannot store the result of b: No space.*; the 1 records finished before are kept.*--resume",
            ):
                journal.add(done("b", bytes(10_000_000)))
        assert journal_path(target).stat().st_size == size
        assert journal.finished()["a"] == "f"
    with Journal.open(target, resume=True) as journal:
        assert journal.parts("a") == (bytes(100_000),)
        journal.add(done("b", bytes(10_000_000)))
        assert journal.parts("b") == (bytes(10_000_000),)


def test_a_place_that_takes_no_journal_is_refused(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ResultsError, match=r"cannot write the journal of the run .*: Not a directory"):
        Journal.open(tmp_path / "file" / "results.h5")


ARRAYS = {
    "float": np.array([[1.5, np.nan], [-np.inf, -0.0]]),
    "scalar": np.array(3),
    "empty": np.zeros((0, 4, 2)),
    "flags": np.array([-1, 0, 127], dtype=np.int8),
    "text": np.array(["", "Grünthal", os.fsdecode(b"caf\xe9"), "two\nlines"]),
    "no text": np.array([], dtype=str),
    "turned": np.arange(12.0).reshape(3, 4).T,
}


def test_packed_arrays_come_back_bit_by_bit():
    back = unpack(pack(ARRAYS))
    assert list(back) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert back[name].dtype == array.dtype, name
        assert back[name].shape == array.shape, name
        assert back[name].tobytes() == array.tobytes(), name


def test_only_numbers_and_texts_are_packed():
    with pytest.raises(TypeError, match="a: expected numbers or strings"):
        pack({"a": np.array([object()])})


def test_bytes_that_are_no_packed_arrays_are_refused():
    packed = pack(ARRAYS)
    for other in (b"", b"RPA1", b"\x80\x04K\x01.", packed[:-1], packed + b"\0", packed.replace(b'"<f8"', b'"|O8"')):
        with pytest.raises(ValueError, match=r"expected|Expecting"):
            unpack(other)
