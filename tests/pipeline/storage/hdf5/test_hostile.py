"""Results files from others: tampered with in seeded ways, and opened by every verb that opens one."""

import contextlib
import io
import os
import random
import re
import resource
import shutil
import signal
import sys
import time
import traceback
from pathlib import Path

import h5py
import numpy as np
import pytest
from hostile_results import CHANGES, tamper
from results_tree import results_bytes

from rockpulse.cli import main
from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5 import layout
from rockpulse.storage.hdf5.results_file import load_tree

#: Longest that a verb may take with a file, in time of the processor and of the clock, which other work stretches [s].
SECONDS, PATIENCE = 10, 120
#: Most memory that a process may take which opens a file by one verb after the other [bytes].
MEMORY = 10**9
#: Characters that a terminal or a page obeys.
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")

#: The verb that makes a file, and those that open it; {0} is the file, {1} what is written, {2} another, sound file.
KINDS = {
    "assess": (
        "inspect {0}",
        "inspect {0} --all",
        "inspect {0} --worst 3",
        "inspect {0} --records --sort pga",
        "inspect {0} --blocks",
        "inspect {0} --failures",
        "verify {0} --no-inputs",
        "verify {0} --inputs",
        "export {0} -o {1}.csv",
        "export {0} --group half_cycles -o {1}.csv",
        "diff {2} {0}",
        "report {0} -o {1}.html",
        "plot {0} spectrum -o {1}.svg",
        "plot {0} critical-scale -o {1}.svg",
        "plot {0} bodies -o {1}.svg",
        "plot {0} accelerogram -o {1}.svg",
        "plot {0} overturning-map -o {1}.svg",
        "check {0} --code",
    ),
    "fragility": (
        "inspect {0}",
        "verify {0} --no-inputs",
        "export {0} -o {1}.csv",
        "diff {2} {0}",
        "risk {0} --hazard {3}",
        "plot {0} fragility -o {1}.svg",
    ),
    "calibrate": (
        "inspect {0}",
        "verify {0} --no-inputs",
        "export {0} -o {1}.csv",
        "diff {2} {0}",
        "plot {0} calibration -o {1}.svg",
    ),
}


@pytest.fixture
def sound(golden):
    """A sound file of each kind, by the verb that made it."""
    return {"assess": golden.results, "fragility": golden.fragility, "calibrate": golden.site}


@pytest.fixture
def place(tmp_path):
    """A folder with a pipe that nobody writes to, and a hazard curve."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "hazard.csv").write_text("pga [m/s2],annual rate\n0.1,0.5\n1,0.05\n5,0.005\n20,0.0001\n")
    return tmp_path


def told(arguments):
    """Exit code and texts of a verb, which ends in time."""

    def late(*_):
        raise AssertionError(f"{arguments}: longer than {PATIENCE} s")

    out, error = io.StringIO(), io.StringIO()
    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(PATIENCE)
    began = time.process_time()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            code = main(arguments)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    assert time.process_time() - began < SECONDS, arguments
    return code, out.getvalue(), error.getvalue()


def opened_by(verbs, source, place, seed, change):
    """Open a file by each of the verbs: every end is one of the command line's own, and nothing leaves unescaped."""
    for verb in verbs:
        arguments = verb.format(place / "results.h5", place / "out", source, place / "hazard.csv").split()
        arguments += ["--overwrite"] if "-o" in arguments else []
        code, out, error = told(arguments)
        where = f"seed {seed}, {change}: {' '.join(arguments)}"
        assert code in (0, 1, 2), where
        assert "Traceback" not in error, where
        assert code != 2 or error.startswith("rockpulse: "), where
        written = [one for one in place.glob("out*") if one.suffix in (".html", ".csv", ".svg", ".md")]
        for text in (out, error, *(one.read_text("utf-8") for one in written)):
            assert not OBEYED.search(text), where
        for one in place.glob("out*"):
            one.unlink()


def within_memory(call):
    """Make a call in a fork; its largest memory beyond that of this process [bytes]. What it raises fails the test."""
    own = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
    child = os.fork()
    if not child:
        code = 1
        try:
            call()
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    _, status, used = os.wait4(child, 0)
    assert status == 0
    return used.ru_maxrss * 1024 - own


def tried(source, verbs, seeds, place, each):
    """Tamper with copies of a file, and open them by some of the verbs, each file in a process of its own."""
    for seed in seeds:
        shutil.copy(source, place / "results.h5")
        change = tamper(place / "results.h5", seed, place)
        some = random.Random(seed).sample(verbs, min(each, len(verbs)))
        most = within_memory(lambda: opened_by(some, source, place, seed, change))  # noqa: B023 - called at once
        assert most < MEMORY, f"seed {seed}, {change}: {most / 1e6:.0f} MB"


@pytest.mark.sweep
@pytest.mark.parametrize(
    "verb", ["assess", *(pytest.param(one, marks=pytest.mark.slow) for one in KINDS if one != "assess")]
)
def test_a_file_that_was_tampered_with_is_an_error_in_words(verb, sound, place):
    quick = [one for one in KINDS[verb] if not one.startswith("report")]  # a report takes seconds
    every = 1 if verb == "assess" else 3
    tried(sound[verb], quick, range(0, len(CHANGES), every), place, each=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verb", "first", "last"),
    [
        *(("assess", first, first + 50) for first in range(1000, 1300, 50)),
        ("fragility", 1000, 1120),
        ("calibrate", 1000, 1080),
    ],
)
def test_five_hundred_files_that_were_tampered_with(verb, first, last, sound, place):
    tried(sound[verb], KINDS[verb], range(first, last), place, each=len(KINDS[verb]))


@pytest.fixture
def small(tmp_path):
    (tmp_path / "results.h5").write_bytes(results_bytes())
    return tmp_path / "results.h5"


#: Groups and variables that a file may have, in place of ten thousand, which take seconds to make.
FEW = 300


def external(file, pipe):
    file["more"] = h5py.ExternalLink(pipe, "/x")


def soft(file, pipe):
    file["more"] = h5py.SoftLink("/summary")


def twice(file, pipe):
    file["summary/again"] = file["summary"]


def virtual(file, pipe):
    layout = h5py.VirtualLayout(shape=(4,), dtype=float)
    layout[:] = h5py.VirtualSource(pipe, "x", shape=(4,))
    file.create_virtual_dataset("more", layout)


def named_type(file, pipe):
    file["more"] = np.dtype(float)


def dataset(shape, outside=False, **options):
    def change(file, pipe):
        beside = {"external": [(pipe, 0, h5py.h5f.UNLIMITED)]} if outside else {}
        file.create_dataset("more", shape, float, **options, **beside)

    return change


def many(file, pipe):
    group = file.create_group("more")
    for number in range(FEW):
        group.create_group(str(number))


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (external, "/more: expected a group or a variable, found a link"),
        (soft, "/more: expected a group or a variable, found a link"),
        (twice, "/summary/again: this object appears in the file under another name too"),
        (dataset((3,), outside=True), "/more: its values are kept in another file"),
        (virtual, "/more: its values are kept in another file"),
        (
            dataset((10**6, 10**6), chunks=(1000, 1000)),
            "/more: declares 8,000,000,000,000 bytes of values, but the file contains 0",
        ),
        (named_type, "/more: expected a group or a variable, found a named data type"),
        (dataset((100,), compression="lzf"), "/more: compressed by lzf, which results files never use"),
        (many, f"more than {FEW} groups and variables"),
    ],
)
def test_a_file_that_leads_out_of_itself_or_has_no_end_is_refused(small, place, monkeypatch, change, message):
    monkeypatch.setattr(layout, "OBJECTS", FEW)
    with h5py.File(small, "r+") as file:
        change(file, os.fspath(place / "pipe"))
    with pytest.raises(ResultsError, match=re.escape(message)):
        load_tree(small)
    assert told(["verify", str(small), "--no-inputs"])[0] == 2


def test_a_long_dimension_without_values_is_no_endless_array(small):
    """As /records/sample of many records: its length is that of the samples, and it holds none."""
    with h5py.File(small, "r+") as file:
        scale = file["records"].create_dataset("instants", (10**7,), ">f4", chunks=(10**6,))
        scale.make_scale("This is a netCDF dimension but not a netCDF variable.  10000000")
    assert "summary" in load_tree(small).children


@pytest.mark.sweep
def test_a_record_file_that_results_name_is_hashed_only_if_it_is_a_file(small, place):
    with h5py.File(small, "r+") as file:
        sources = file["summary/source"]
        sources[...] = np.full(sources.shape, os.fspath(place / "pipe"), dtype=object)
    code, out, _ = told(["verify", str(small), "--inputs"])
    assert code == 1
    assert "pipe: it can no longer be read" in out
