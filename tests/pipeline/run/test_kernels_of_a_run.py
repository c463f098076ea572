"""Compiled kernels in a run: results follow the sources, and a damaged cache costs no record."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from dask_cluster import dask_cluster, wait_for_workers
from record_writers import at2, pulse

import rocking
import rockpulse
from rocking.kernel_cache import folder
from rockpulse.run.worker_pool import WorkerPool

#: A line of a kernel that others call, and what it becomes.
KERNEL = "rocking/march/event.py"
LINE = "    start = acceleration[k] * f[row.FACTOR + j]\n"
CHANGED = "    start = 1.1 * acceleration[k] * f[row.FACTOR + j]\n"
#: Size of a kernel that is compiled at once [bytes].
SMALL = 30_000
PEAK = """
import sys
import rockpulse as rp
from rockpulse import models
if __name__ == "__main__":
    if sys.argv[1] == "response":
        record = rp.read("records/a.AT2")[0]
        block = models.Block(0.4, 3.0)
        print(models.recorded_response(block, record.acceleration, record.dt).peak_rotation_ratio)
    else:
        tree = rp.load(sys.argv[1])
        print(float(tree["summary"]["peak_rotation_ratio"].sel(model="nonlinear").max()))
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a copy of both packages, two records and an empty cache."""
    top = tmp_path
    monkeypatch.setenv("PYTHONPATH", str(top / "packages"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(top / "cache"))
    for package in (rocking, rockpulse):
        source = Path(package.__file__).parent
        shutil.copytree(source, top / "packages" / source.name, ignore=shutil.ignore_patterns("__pycache__"))
    (top / "records").mkdir()
    for name in ("a", "b"):
        (top / "records" / f"{name}.AT2").write_bytes(at2(pulse() * (1.0 if name == "a" else 0.9)))
    (top / "peak.py").write_text(PEAK)
    return top


def peak(top, way):
    """The largest rotation of the wall by one way of running."""

    def done(*command):
        command = [sys.executable, *command]
        run = subprocess.run(command, cwd=top, capture_output=True, text=True)
        assert (run.returncode, run.stderr) == (0, "")
        return run.stdout

    if way == "response":
        return float(done("peak.py", way))
    job = ["-m", "rockpulse", "assess", "records", "--block", "wall=0.4x3.0", "-o", f"{way}.h5", "--overwrite"]
    if way == "dask":
        with dask_cluster(Path(tempfile.mkdtemp(dir=top))) as (address, *_):
            with WorkerPool.scheduler(address, timeout=300.0) as pool:
                wait_for_workers(pool, 2)
            done(*job, "--scheduler", address)
    else:
        done(*job, "--workers", "2" if way == "workers" else "1")
    return float(done("peak.py", f"{way}.h5"))


WAYS = ("assess", "response", "workers", "dask")


@pytest.mark.slow
def test_a_change_of_a_kernel_whose_caller_is_unchanged_counts_at_once_and_so_does_its_return(place):
    path = place / "packages" / KERNEL
    text = path.read_text()
    assert text.count(LINE) == 1
    before = {way: peak(place, way) for way in WAYS}
    path.write_text(text.replace(LINE, CHANGED))
    changed = {way: peak(place, way) for way in WAYS}
    path.write_text(text)
    restored = {way: peak(place, way) for way in WAYS}
    assert restored == before
    assert all(changed[way] != before[way] for way in WAYS)


@pytest.mark.slow
@pytest.mark.parametrize("workers", ["1", "2"])
def test_damaged_kernels_cost_no_record_and_are_said_once(workers, tmp_path, monkeypatch):
    (tmp_path / "records").mkdir()
    for name, peak in (("a", 0.3), ("b", 0.25), ("c", 0.2)):
        (tmp_path / "records" / f"{name}.AT2").write_bytes(at2(pulse(peak=peak)))
    job = [sys.executable, "-m", "rockpulse", "assess", "records", "--block", "wall=0.4x3.0", "-o"]

    def run(output):
        return subprocess.run([*job, output, "--workers", workers], cwd=tmp_path, capture_output=True, text=True)

    assert run("before.h5").stderr == ""
    kept = shutil.copytree(folder(), tmp_path / "cache" / folder().name)
    for path in kept.iterdir():
        if path.stat().st_size < SMALL:
            path.write_bytes(path.read_bytes()[:-1])
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(kept.parent))
    found = run("after.h5")
    assert found.returncode == 0
    assert found.stderr.count("\n") == 1
    assert str(kept) in found.stderr
    before, after = (rockpulse.load(tmp_path / name) for name in ("before.h5", "after.h5"))
    assert after["summary"].sizes["record"] == 3
    assert after["summary"].equals(before["summary"])
