"""The folder of compiled kernels follows every change of their sources: numba sees only that of a kernel's own file."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from kernel_cache import TOP, kernel_cache

import rocking

KERNELS = Path(rocking.__file__).parent


def test_the_kernels_that_are_imported_are_those_whose_state_is_taken():
    assert KERNELS == TOP / "models" / "rocking"
    assert kernel_cache() == kernel_cache(KERNELS)


def test_a_changed_kernel_has_another_folder(tmp_path):
    kernels = shutil.copytree(KERNELS, tmp_path / "rocking", ignore=shutil.ignore_patterns("__pycache__"))
    (kernels / "deeper").mkdir()
    (kernels / "deeper" / "kernel.py").write_text("x = 1")
    seen = {kernel_cache(kernels)}
    for name in ("lanes.py", "deeper/kernel.py"):
        (kernels / name).write_text((kernels / name).read_text() + "\n# changed\n")
        seen.add(kernel_cache(kernels))
    assert len(seen) == 3


@pytest.mark.sweep
def test_make_and_the_tests_use_the_folder_of_the_kernels_as_they_are(tmp_path):
    for name in ("Makefile", "tests/kernel_cache.py", "models/rocking/lanes.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(TOP / name, tmp_path / name)
    command = ["make", "--no-print-directory", "kernel-cache", f"PYTHON={sys.executable}"]
    clean = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}

    def folder():
        return subprocess.run(command, cwd=tmp_path, env=clean, capture_output=True, text=True, check=True).stdout

    first = folder()
    assert Path(first.strip()).parent == tmp_path / ".numba_cache"
    (tmp_path / "models/rocking/lanes.py").write_text("changed = True")
    assert folder() != first
