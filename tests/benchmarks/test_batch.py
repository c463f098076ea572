"""The ensemble of the batch benchmark is the same everywhere, and a run of it tells what it took."""

from pathlib import Path

import numpy as np
import pytest

import rockpulse as rp


@pytest.fixture(scope="module")
def files(batch, tmp_path_factory):
    folder = tmp_path_factory.mktemp("ensemble")
    batch.write_records(folder, 5)
    return sorted(folder.iterdir())


def test_records_are_distinct_and_the_same_again(batch, files, tmp_path):
    records = [record for file in files for record in rp.read(file)]
    assert [record.npts for record in records] == [batch.SAMPLES] * 5
    assert len({record.id for record in records}) == len({record.event for record in records}) == 5
    peaks = np.array([np.abs(record.acceleration).max() for record in records]) / batch.GRAVITY
    assert ((peaks > 0.199) & (peaks < 0.601)).all()
    batch.write_record(3, tmp_path)
    assert (tmp_path / files[3].name).read_bytes() == files[3].read_bytes()


def test_blocks_are_as_slender_as_said(batch):
    blocks = batch.configuration(100).bodies
    slenderness = np.array([block.height / block.width for block in blocks])
    assert len({block.name for block in blocks}) == 100
    assert ((slenderness > 3.99) & (slenderness < 8.01)).all()
    assert batch.configuration(2).models == rp.Config().models
    assert batch.configuration(2, everything=True).search.intervals


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="the memory of a process is asked of Linux")
def test_a_run_tells_its_steps_and_the_memory_of_the_parent(batch, files, tmp_path, capsys):
    config = batch.configuration(2)
    one = batch.run([str(file) for file in files], config, str(tmp_path / "results.h5"), 1)
    assert one.records == 5
    assert rp.load(tmp_path / "results.h5")["summary"].sizes["record"] == 5
    assert one.total >= one.survey + one.work + one.assembly - 0.1
    assert one.seconds["solve"] < one.work
    assert list(one.memory) == [0, 20, 40, 60, 80, 100]
    assert 50.0 < max(one.memory.values()) <= one.peak
    batch.told(one, 1, "2 bodies", 2)
    said = capsys.readouterr().out
    assert f"{one.processor / 5:.2f} s of a core a record of 60 s" in said
    assert f"all but the solver: {one.total / one.seconds['solve'] - 1.0:.2f} times the solver" in said
