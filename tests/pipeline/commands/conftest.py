"""A results file that is read once for the commands of a module, and the smallest configuration of a run."""

from functools import cache
from pathlib import Path

import pytest
from assess_command import QUICK, assess_words
from results_tree import results_bytes

from rockpulse.storage.hdf5 import results_file


@pytest.fixture(scope="module")
def loaded_once():
    """A file that commands of a module load whole is read by the first of them; none changes what it is given."""
    read = results_file.load_tree
    kept = cache(lambda path, changed: read(path))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results_file, "load_tree", lambda path: kept(path, Path(path).stat().st_mtime_ns))
        yield


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """The name of a file of results that are known."""
    path = tmp_path_factory.mktemp("results") / "results.h5"
    path.write_bytes(results_bytes())
    return str(path)


@pytest.fixture(scope="session")
def quick(tmp_path_factory):
    """A configuration by which a record is assessed at once."""
    path = tmp_path_factory.mktemp("quick") / "quick.toml"
    path.write_text(QUICK)
    return path


@pytest.fixture
def assess(run):
    """Assesses files on two bodies to an exit code, and returns what is printed."""
    return lambda *arguments, code=0: run(*assess_words(*arguments), code=code)
