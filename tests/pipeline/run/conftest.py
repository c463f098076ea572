"""Eight records, the results of a run on them that nothing disturbed, and a disk that can be filled."""

import shutil
import subprocess

import pytest
from batch_runs import CONFIGURATION, RECORDS, command, write
from file_contents import contents


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Eight records and a configuration."""
    folder = tmp_path_factory.mktemp("records")
    for number in range(RECORDS):
        write(folder / f"r{number}.AT2", 0.2 + 0.05 * number)
    (folder / "site.toml").write_text(CONFIGURATION)
    return folder


@pytest.fixture(scope="session")
def undisturbed(folder, tmp_path_factory):
    """What comes of them when nothing happens."""
    target = tmp_path_factory.mktemp("undisturbed") / "results.h5"
    assert command(folder, target, "--quiet") == 0
    return contents(target)


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
