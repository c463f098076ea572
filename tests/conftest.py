"""Records, results and the browser that several tests share, and the kernels compiled before a long run."""

import gc
import os
from pathlib import Path

import pytest

TOP = Path(__file__).parents[1]

#: Tests in a run from which on all kernels are needed.
LONG_RUN = 1000


def pytest_collection_finish():
    """Thousands of tests are no garbage: to look through them again and again takes a tenth of a run."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session):
    """Before a long run in several processes, compile the kernels that are not in the cache, each process a share."""
    process = getattr(session.config, "workerinput", None)
    if process is not None and len(session.items) > LONG_RUN and os.environ.get("NUMBA_DISABLE_JIT", "0") == "0":
        from compiled_kernels import compile_share

        number = int(process["workerid"].removeprefix("gw"))
        compile_share(number, process["workercount"])


@pytest.fixture(scope="session")
def shared(tmp_path_factory, worker_id):
    """The folder of a session, whichever worker asks for it."""
    base = tmp_path_factory.getbasetemp()
    return base if worker_id == "master" else base.parent


@pytest.fixture(scope="session")
def golden(shared):
    """Results of every study on short records, made once a session (tests/golden.py)."""
    from golden import golden

    return golden(shared / "golden")


@pytest.fixture(scope="session", autouse=True)
def _marched_once(shared):
    """Marches of slender blocks are done once a session (tests/marched_once.py)."""
    from marched_once import keep_marches

    (shared / "marches").mkdir(exist_ok=True)
    keep_marches(shared / "marches")


@pytest.fixture
def run(capsys):
    """Runs a command to its exit code, and returns what it has printed."""
    from rockpulse.cli import main

    def run(*words, code=0):
        capsys.readouterr()
        found, printed = main([str(word) for word in words]), capsys.readouterr()
        assert found == code, printed
        return printed

    return run


@pytest.fixture(scope="session")
def samples() -> Path:
    """The sample records that come with the project."""
    return TOP / "data" / "samples" / "records"


@pytest.fixture(scope="session")
def ridgecrest(samples):
    """The nine channels of the Ridgecrest samples, as read."""
    from rockpulse.readers import read

    return [channel for name in ("CICCC.RAW", "CICLC.v1", "CITOW2.RAW") for channel in read(samples / name)]


@pytest.fixture(scope="session")
def ccc(ridgecrest):
    """The three channels of Christmas Canyon."""
    return [channel for channel in ridgecrest if channel.station == "CCC"]


@pytest.fixture(scope="session")
def records_folder() -> Path:
    """Real records that may not be passed on; the environment variable ROCKPULSE_RECORDS names the folder."""
    folder = os.environ.get("ROCKPULSE_RECORDS")
    if not folder:
        pytest.skip("ROCKPULSE_RECORDS is not set: no folder of real records to read")
    if not Path(folder).is_dir():
        pytest.fail(f"ROCKPULSE_RECORDS={folder} is no folder")
    return Path(folder)


@pytest.fixture(scope="session")
def driver(tmp_path_factory):
    """One browser for all tests of pages."""
    from real_browser import chromium

    driver = chromium(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.fixture(scope="session")
def axe():
    """The script of axe-core, which npm brings and the repository does not; ROCKPULSE_AXE names it."""
    script = os.environ.get("ROCKPULSE_AXE")
    if not script:
        pytest.skip("ROCKPULSE_AXE is not set: npm install axe-core, and set it to the path of axe.min.js")
    return Path(script).read_text(encoding="utf-8")
