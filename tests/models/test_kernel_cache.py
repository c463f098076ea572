"""The folder of compiled kernels: every state of the sources has its own, and no fault of it costs an answer."""

import errno
import hashlib
import logging
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rocking import kernel_cache
from rocking.kernel_cache import CHECKSUM, KEPT_DAYS, folder, njit

numba = pytest.importorskip("numba")
pytestmark = [
    pytest.mark.sweep,
    pytest.mark.skipif(numba.config.DISABLE_JIT == 1, reason="nothing is compiled without the compiler"),
]


def triple(x):
    return 3.0 * x


def halve(x):
    return 0.5 * x


@pytest.fixture
def parent(tmp_path, monkeypatch):
    """An empty cache of this process."""
    with monkeypatch.context() as during:
        during.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
        folder.cache_clear()
        kernel_cache.logged.clear()
        yield tmp_path / "cache"
    folder.cache_clear()


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """A folder with one kernel, compiled once for all tests."""
    with pytest.MonkeyPatch.context() as during:
        during.setattr(numba.config, "CACHE_DIR", str(tmp_path_factory.mktemp("compiled")))
        folder.cache_clear()
        assert run() == (6.0, True)
        return folder()


@pytest.fixture
def filled(parent, compiled):
    """A cache of this process with one kernel."""
    shutil.copytree(compiled, folder())
    assert run() == (6.0, False)
    return parent


def run(function=triple):
    """The answer for 2, and whether the kernel was compiled for it."""
    kernel = njit()(function)
    return kernel(2.0), not kernel.stats.cache_hits


def lines(caplog):
    """What was logged since the last call, at most a line of each text."""
    found = [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]
    caplog.clear()
    kernel_cache.logged.clear()
    return found


def stored():
    [path] = folder().glob("*.triple-*.kernel")
    return path


def signed(content):
    return hashlib.sha256(content).digest() + content


def changed(path):
    content = bytearray(path.read_bytes())
    content[-4000] ^= 1
    path.write_bytes(content)


def other_kernel(path):
    """In place of the file another valid one."""
    run(halve)
    [other] = folder().glob("*.halve-*.kernel")
    other.replace(path)


def raising(method, number, monkeypatch):
    """A method of paths that fails as a system call does."""

    def fails(path, *args, **kwargs):
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr(Path, method, fails)


#: Damage to a file that is replaced by a good one; the second answer is whether a line says so.
HEALED = {
    "cut in the checksum": (lambda path, _: os.truncate(path, CHECKSUM - 1), True),
    "a bit of the code": (lambda path, _: changed(path), True),
    "another kernel": (lambda path, _: other_kernel(path), True),
    "no pickle": (lambda path, _: path.write_bytes(signed(b"no pickle")), True),
    "a class that is gone": (lambda path, _: path.write_bytes(signed(b"crocking.gone\nKernel\n.")), True),
    "another user's": (lambda path, monkeypatch: monkeypatch.setattr(os, "geteuid", lambda: 4711), True),
    "faulty disk": (lambda path, monkeypatch: raising("read_bytes", errno.EIO, monkeypatch), True),
    "a link to nothing": (lambda path, _: (path.unlink(), path.symlink_to("nothing")), False),
    "cache removed": (lambda path, _: shutil.rmtree(path.parent.parent), False),
}


@pytest.mark.parametrize("damage", HEALED)
def test_a_damaged_file_is_said_once_and_replaced(damage, filled, monkeypatch, caplog):
    harm, is_said = HEALED[damage]
    with monkeypatch.context() as during:
        if damage == "another user's" and not (hasattr(os, "geteuid") and stored().stat().st_uid):
            os.chown(stored(), 4711, -1)
        else:
            harm(stored(), during)
        assert run() == (6.0, True)
    told = lines(caplog)
    assert len(told) == is_said
    assert all(str(folder()) in line for line in told)
    assert run() == (6.0, False)
    assert lines(caplog) == []


def replaced_by_file(path):
    shutil.rmtree(path)
    path.write_text("")


#: Faults with which nothing can be kept.
NOT_KEPT = {
    "file in place of the folder": lambda path, _: replaced_by_file(path.parent),
    "file in place of the cache": lambda path, _: replaced_by_file(path.parent.parent),
    "full disk": lambda path, monkeypatch: (path.unlink(), raising("write_bytes", errno.ENOSPC, monkeypatch)),
    "read only": lambda path, monkeypatch: (path.unlink(), raising("write_bytes", errno.EROFS, monkeypatch)),
}


@pytest.mark.parametrize("fault", NOT_KEPT)
def test_without_a_folder_kernels_are_compiled_in_memory_and_one_line_says_what_to_set(
    fault, filled, monkeypatch, caplog
):
    with monkeypatch.context() as during:
        NOT_KEPT[fault](stored(), during)
        assert run() == (6.0, True)
        assert run(halve) == (1.0, True)
    [line] = lines(caplog)
    assert "NUMBA_CACHE_DIR" in line
    assert str(filled) in line


def test_a_cache_removed_during_the_run_is_filled_again(filled, caplog):
    shutil.rmtree(filled)
    assert run(halve) == (1.0, True)
    assert run(halve) == (1.0, False)
    assert lines(caplog) == []


def test_folders_long_unused_are_removed_when_a_new_one_is_made(parent):
    long_ago = time.time() - (KEPT_DAYS + 1.0) * 86400.0
    names = ["rockpulse-0123456789abcdef", "rockpulse-fedcba9876543210", "rockpulse-of-somebody"]
    for name in names:
        (parent / name).mkdir(parents=True)
    for name in (names[0], names[2]):
        os.utime(parent / name, (long_ago, long_ago))
    run()
    assert sorted(path.name for path in parent.iterdir()) == sorted([*names[1:], folder().name])


# A package with two kernels of which one calls the other, in files of their own.
CALLEE = "from rocking.kernel_cache import njit\n\n\n@njit()\ndef slope(x):\n    return {factor} * x\n"
CALLER = """
from rocking.callee import slope
from rocking.kernel_cache import njit


@njit()
def line(x):
    return slope(x) + 1.0
"""
SCRIPT = "from rocking.caller import line; print(line(2.0), 'compiled' if line.stats.cache_misses else 'loaded')"


@pytest.fixture
def package(tmp_path):
    """The folder of the package, with a run of a new process that gives its answer and its errors."""

    class Package:
        top = tmp_path / "installation"

        def write(self, factor, stamp):
            (self.top / "rocking" / "callee.py").write_text(CALLEE.format(factor=factor))
            os.utime(self.top / "rocking" / "callee.py", (stamp, stamp))  # Python compares the time in whole seconds

        def start(self, **variables):
            clean = {name: value for name, value in os.environ.items() if name not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
            environment = {**clean, "XDG_CACHE_HOME": str(tmp_path / "home"), **variables, "PYTHONPATH": str(self.top)}
            pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
            return subprocess.Popen([sys.executable, "-c", SCRIPT], env=environment, cwd=tmp_path, **pipes)

        def run(self, **variables):
            return self.start(**variables).communicate()

    (Package.top / "rocking").mkdir(parents=True)
    (Package.top / "rocking" / "__init__.py").write_text("")
    shutil.copy(kernel_cache.__file__, Package.top / "rocking")
    (Package.top / "rocking" / "caller.py").write_text(CALLER)
    package = Package()
    package.write("3.0", 1_700_000_000)
    return package


def test_a_changed_callee_is_seen_and_the_state_before_is_found_again(package):
    assert package.run() == ("7.0 compiled\n", "")
    package.write("5.0", 1_700_000_100)
    assert package.run() == ("11.0 compiled\n", "")
    package.write("3.0", 1_700_000_200)
    assert package.run() == ("7.0 loaded\n", "")


def test_equal_sources_elsewhere_share_what_was_compiled(package):
    assert package.run() == ("7.0 compiled\n", "")
    package.top = package.top.rename(package.top.with_name("elsewhere"))
    assert package.run() == ("7.0 loaded\n", "")


def test_two_processes_at_once_and_the_next_one_loads(package):
    both = [package.start(), package.start()]
    for one in both:
        out, errors = one.communicate()
        assert (out.split()[0], errors) == ("7.0", "")
    assert package.run() == ("7.0 loaded\n", "")


def test_an_installation_that_nobody_can_write_to_without_a_home_compiles_in_memory(package):
    for path in (*(package.top / "rocking").iterdir(), package.top / "rocking"):
        path.chmod(0o555 if path.is_dir() else 0o444)
    out, errors = package.run(HOME="/proc/nonexistent", XDG_CACHE_HOME="")
    assert out == "7.0 compiled\n"
    assert errors.count("\n") == 1
    assert "/proc/nonexistent" in errors
    assert "set NUMBA_CACHE_DIR" in errors
    (package.top / "rocking").chmod(0o755)


def test_what_is_compiled_from_sources_that_changed_meanwhile_is_not_kept(parent, monkeypatch, caplog):
    monkeypatch.setattr(kernel_cache, "SOURCES", "the sources before")
    assert [run(), run()] == [(6.0, True)] * 2
    assert lines(caplog) == []
