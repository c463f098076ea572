"""Compiled kernels in a run: a damaged cache costs no record."""

import shutil
import subprocess
import sys

import pytest
from record_writers import at2, pulse

import rockpulse
from rocking.kernel_cache import folder

#: Size of a kernel that is compiled at once [bytes].
SMALL = 30_000


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
