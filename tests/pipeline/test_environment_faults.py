"""Faults of the environment: what each command says, and what it leaves behind."""

import codecs
import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import pandas as pd
import pytest
from record_writers import at2, pulse

from rockpulse.cli import main
from rockpulse.files import write_files
from rockpulse.storage.export.table_file import table_csv

POSIX = pytest.mark.skipif(os.name != "posix", reason="permissions and signals of POSIX")


@pytest.fixture
def record(tmp_path):
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse()))
    return path


def test_a_results_file_that_another_process_holds_is_not_called_truncated(tmp_path):
    path = tmp_path / "results.h5"
    with h5py.File(path, "w") as writer:
        writer.flush()
        code = "import sys; from rockpulse.cli import main; sys.exit(main(['inspect', sys.argv[1]]))"
        run = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True)
    assert run.returncode == 2
    assert "another process has this file open" in run.stderr
    assert "truncated" not in run.stderr


#: Commands that write a file beside the record, and its name.
WRITERS = {
    "init-config": (["init-config"], "site.toml"),
    "convert": (["convert", "a.AT2"], "b.csv"),
    "plot": (["plot", "a.AT2", "record"], "record.svg"),
}


@pytest.mark.sweep
@pytest.mark.parametrize("verb", WRITERS)
def test_a_full_disk_leaves_no_part_of_a_file_and_gives_its_name_and_advice(verb, record, tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    command, name = WRITERS[verb]
    write = Path.write_bytes

    def full(path, content):
        write(path, content[: len(content) // 2])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(Path, "write_bytes", full)
    said = run(*command, "-o", name, code=2).err
    assert name in said
    assert os.strerror(errno.ENOSPC) in said
    assert [path.name for path in tmp_path.iterdir()] == [record.name]


@POSIX
def test_the_mode_of_a_file_that_is_replaced_is_kept(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("before")
    path.chmod(0o640)
    write_files({path: b"after"})
    assert path.read_text() == "after"
    assert path.stat().st_mode & 0o777 == 0o640


@POSIX
@pytest.mark.sweep
def test_the_mode_of_results_that_are_replaced_is_kept(record, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    job = ["assess", record.name, "--block", "wall=0.4x3.0", "-o", "results.h5", "--quiet"]
    assert main(job) == 0
    Path("results.h5").chmod(0o604)
    assert main([*job, "--overwrite"]) == 0
    assert Path("results.h5").stat().st_mode & 0o777 == 0o604


@POSIX
@pytest.mark.parametrize("gap", [pytest.param(0.0, marks=pytest.mark.sweep), pytest.param(0.2, marks=pytest.mark.slow)])
def test_two_interrupts_exit_with_130_and_no_traceback(gap, tmp_path):
    for number in range(40):
        (tmp_path / f"r{number}.AT2").write_bytes(at2(pulse(4000, 0.2 + 0.001 * number)))
    job = ["assess", str(tmp_path), "--block", "wall=0.4x3.0", "-o", str(tmp_path / "results.h5"), "--workers", "2"]
    # A shell lets the jobs that it starts in the background ignore Ctrl-C, and the processes of these inherit it.
    answering = signal.signal(signal.SIGINT, signal.default_int_handler)
    run = subprocess.Popen([sys.executable, "-m", "rockpulse", *job], stderr=subprocess.PIPE, text=True)
    signal.signal(signal.SIGINT, answering)
    journal, end = tmp_path / "results.h5.journal", time.monotonic() + 120.0
    while not (journal.exists() and journal.stat().st_size > 1000) and time.monotonic() < end:
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    time.sleep(gap)
    run.send_signal(signal.SIGINT)
    said = run.communicate(timeout=60)[1]
    assert run.returncode == 130
    assert "Traceback" not in said


@pytest.mark.sweep
def test_a_script_on_standard_input_is_advised_to_become_a_file(record, tmp_path):
    script = (
        "from rockpulse.run.worker_pool import WorkerPool as Pool\nwith Pool.local(2) as pool: [*pool.run(abs, [1])]\n"
    )
    run = subprocess.run([sys.executable, "-"], input=script, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode != 0
    last = run.stderr.strip().splitlines()[-1]
    assert "standard input" in last
    assert "__main__" not in last


@pytest.mark.parametrize(("name", "marked"), [("Casa", False), ("Chiesa di Nicolò", True)])
def test_a_table_for_people_has_a_byte_order_mark_if_it_is_not_ascii(name, marked):
    content = table_csv(pd.DataFrame({"body": [name], "P": [0.1]}))
    assert content.startswith(codecs.BOM_UTF8) == marked
    assert content.decode("utf-8-sig") == f"body,P\n{name},0.1\n"


@pytest.mark.parametrize("name", ["é" * 130 + ".csv", "x" * 300 + ".csv"])
def test_a_name_that_is_too_long_is_said_to_be(name, record, tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    said = run("convert", record.name, "-o", name, code=2).err
    assert os.strerror(errno.ENAMETOOLONG) in said
    assert "shorter name" in said
