"""Four records, and a disk that can be filled."""

import shutil
import subprocess

import pytest
from batch_runs import RECORDS, records_in


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return records_in(tmp_path_factory.mktemp("records"), RECORDS)


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
