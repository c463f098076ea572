"""The file that is put together from parts is the one that save writes of the whole tree."""

import os
import shutil
from dataclasses import replace

import h5py
import pytest
from file_contents import assert_contents, contents

from rockpulse.assessment.assessment import Assessment
from rockpulse.assessment.tree import build_tree, empty_tree
from rockpulse.config.configuration import load_config
from rockpulse.errors import Failure, ResultsError
from rockpulse.run import assembly
from rockpulse.run.analysis import worked
from rockpulse.run.assembly import JournalParts, assemble
from rockpulse.run.earlier_results import run_of
from rockpulse.run.frames import pack
from rockpulse.run.journal import Done, Journal
from rockpulse.selection.directions import plan_motions, swept_directions
from rockpulse.storage.hdf5.results_file import save
from rockpulse.storage.hdf5.verification import verify

BLOCKS = '[[block]]\nname = "wall"\nwidth = 0.5\nheight = 4.0\n[[block]]\nname = "pier"\nwidth = 0.3\nheight = 1.5\n'
CASES = BLOCKS.replace("width", "restitution = [0.9, 0.95]\nwidth")
QUICKLY = "[search]\nintervals = true\npoints = 16\nstep = 1.2"
FAST = f'use = ["resonance", "linear"]\n{QUICKLY}'
CONFIGURATIONS = {
    "plain": f"[models]\n{FAST}\n{BLOCKS}",
    "no records": f'[models]\n{FAST}\n[records]\nstore = "none"\n{BLOCKS}',
    "half-waves": f'[models]\n{FAST}\n[records]\nstore = "half_waves"\n{BLOCKS}',
    "histories": f'[models]\nuse = ["sequence", "linear"]\nhistories = true\n{QUICKLY}\n{CASES}',
    "cases and demands": f'[models]\n{FAST}\n[[demand]]\nname = "SLV"\nvalue = 2.0\n{CASES}',
    "sweep": f'[models]\n{FAST}\n[records]\ncomponents = "sweep"\nazimuth_step = 45\n{BLOCKS}',
    "probability": '[models]\nuse = ["nonlinear"]\n[records]\ncomponents = "sweep"\nazimuth_step = 45\n'
    f"[uncertainty]\nazimuth = true\n{CASES}",
}
FAILURES = [
    Failure("a.txt", "read", "a.txt: no record", "skipped"),
    Failure(os.fsdecode(b"\xe9"), "read", "x", "failed"),
]


@pytest.fixture(scope="module")
def assessed(ridgecrest, tmp_path_factory):
    """By name of the configuration: parts, bodies, configuration, directions of the sweep."""
    cut = [replace(record, acceleration=record.acceleration[2700:3100]) for record in ridgecrest[:6]]
    fewer = {"histories", "cases and demands", "sweep", "probability"}

    def made(name):
        if name not in found:
            path = tmp_path_factory.mktemp("site") / "site.toml"
            path.write_text(CONFIGURATIONS[name])
            config = load_config(path)
            analysis = Assessment(config)
            planned, _ = plan_motions(cut[:3] if name in fewer else cut, config)
            done = [part for one in planned for part in worked(one, analysis.work, analysis.name, config)]
            assert not any(isinstance(part, Failure) for part in done)
            done = [analysis.of_event(part, "Ridgecrest") for part in done]
            found[name] = done, analysis.bodies, config, swept_directions(planned, config)
        return found[name]

    found = {}
    return made


@pytest.mark.parametrize(
    ("name", "chunk"),
    [
        pytest.param("histories", 60_000, marks=pytest.mark.sweep),
        *(pytest.param(name, 1, marks=pytest.mark.sweep) for name in ("cases and demands", "probability")),
        *(pytest.param(name, assembly.CHUNK, marks=pytest.mark.slow) for name in CONFIGURATIONS),
    ],
)
def test_the_assembled_file_is_the_saved_one(assessed, tmp_path, name, chunk, monkeypatch):
    monkeypatch.setattr(assembly, "CHUNK", chunk)
    monkeypatch.setattr(assembly, "FAILURES_AT_ONCE", 1)
    done, bodies, config, swept = assessed(name)
    if swept is not None:
        done = done[1:-1]  # not all directions are there
        swept = {**swept, "of nothing": ["never"] * 3}
    save(build_tree(done, bodies, config, FAILURES, swept), tmp_path / "saved.h5")
    run = {"run_id": "r" * 32}
    count = assemble(tmp_path / "made.h5", empty_tree(bodies, config), done, FAILURES, swept, run=run)
    assert count == len(done) > 1
    assert_contents(tmp_path / "made.h5", contents(tmp_path / "saved.h5"))
    assert verify(tmp_path / "made.h5", inputs=False).differences == ()


@pytest.mark.sweep
def test_parts_from_a_journal_stand_in_the_order_of_the_keys(assessed, tmp_path):
    done, bodies, config, _ = assessed("plain")
    target = tmp_path / "results.h5"
    with Journal.open(target) as journal:
        for number in (3, 0, 2, 1):
            parts = (pack(done[number]),)
            journal.add(Done(f"record {number}", "f", parts))
        keys = [f"record {number}" for number in range(4)]
        parts = JournalParts(journal, Assessment(config), dict.fromkeys(keys, ""), dict.fromkeys(keys, "Ridgecrest"))
        assert assemble(target, empty_tree(bodies, config), parts, FAILURES, run={"run_id": journal.run_id}) == 4
        assert run_of(target)[0] == journal.run_id
    save(build_tree(done[:4], bodies, config, FAILURES), tmp_path / "saved.h5")
    assert_contents(target, contents(tmp_path / "saved.h5"))
    assert verify(target, inputs=False).differences == ()


def test_a_run_knows_its_own_file_only(tmp_path):
    path = tmp_path / "results.h5"
    assert run_of(path) == ("", "")
    path.write_text("a text")
    assert run_of(path) == ("", "")
    with h5py.File(path, "w") as file:
        file.attrs["run_id"] = "another"
    assert run_of(path) == ("another", "")


def test_too_little_room_is_known_before_anything_is_written(assessed, tmp_path, monkeypatch):
    done, bodies, config, _ = assessed("plain")
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr("shutil.disk_usage", lambda path: usage._replace(free=1_000_000))
    with pytest.raises(ResultsError, match=r"the results need \d+ MB, but 1 MB are free .* free some space there"):
        assemble(tmp_path / "results.h5", empty_tree(bodies, config), done, run={"run_id": "mine"})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.sweep
def test_the_size_that_is_expected_is_that_of_the_file(assessed, tmp_path, monkeypatch):
    done, bodies, config, _ = assessed("histories")
    replacing, sizes = assembly.replacing, []
    monkeypatch.setattr(assembly, "replacing", lambda *given: sizes.append(given[3]) or replacing(*given))
    assemble(tmp_path / "results.h5", empty_tree(bodies, config), done)
    (expected,) = sizes
    assert expected < (tmp_path / "results.h5").stat().st_size < expected + 500_000
