"""The decorator `njit` of all kernels, and the folder in which their compiled code is kept between runs.

Numba's own cache notices a change in a kernel's file only, not in the kernels that it calls. Here every state of the
sources has a folder of its own (docs/decisions/021-kernel-cache.md): ``rockpulse-<digest>`` below the user's cache
folder, or below ``NUMBA_CACHE_DIR``. A file holds one kernel for one signature and one processor, with a checksum.
"""

import errno
import hashlib
import logging
import os
import pickle
import re
import shutil
import sys
import tempfile
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
import platformdirs
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

logger = logging.getLogger("rockpulse.kernels")

#: Time after which the folder of an installation that is no longer used is removed [days].
KEPT_DAYS = 30.0
#: Name of a folder of compiled kernels.
FOLDER = re.compile(r"rockpulse-[0-9a-f]{16}")
#: Number of bytes of the checksum before the content of a file.
CHECKSUM = hashlib.sha256().digest_size
COMPILING = "compiling the kernels for this processor, once for this installation (about 60 s)"
ADVICE = "kernels are compiled in every run (about 60 s): set NUMBA_CACHE_DIR to a folder that you can write to"


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` without the lock of Python and with numpy's arithmetic, kept in the folder of compiled kernels."""

    def compiled(function: Callable[..., Any]) -> Any:
        kernel = numba.njit(**{"nogil": True, "error_model": "numpy", **options})(function)
        if kernel is not function:  # as with NUMBA_DISABLE_JIT
            kernel._cache = KernelCache(function)
        return kernel

    return compiled


@cache
def folder() -> Path:
    """The folder of the kernels that this process compiles; an absolute path, which need not exist.

    Raises
    ------
    OSError
        If the sources are not in files, or the user has no home.
    """
    if not SOURCES:
        raise FileNotFoundError(errno.ENOENT, "the sources of the kernels are not in files", str(Path(__file__).parent))
    versions = [numba.__version__, np.__version__, sys.version, sys.implementation.cache_tag]
    state = hashlib.sha256(repr([SOURCES, *versions]).encode()).hexdigest()
    given = numba.config.CACHE_DIR
    parent = Path(given).absolute() if given else platformdirs.user_cache_path("rockpulse", appauthor=False)
    if not parent.is_absolute():
        raise FileNotFoundError(errno.ENOENT, "this user has no home folder", str(parent))
    made = parent / f"rockpulse-{state[:16]}"
    with suppress(OSError):  # of a folder that is read only, or not there yet
        os.utime(made)  # in use
    return made


def sources() -> str:
    """SHA-256 of the sources of all kernels as they are now; empty if they are not in files."""
    top = Path(__file__).parent
    paths = sorted(top.rglob("*.py"))
    texts = (path.relative_to(top).as_posix().encode() + b"\0" + path.read_bytes() for path in paths)
    return hashlib.sha256(b"\0".join(texts)).hexdigest() if paths else ""


#: The digest of the sources when this process imported this module, which every kernel's module does first.
SOURCES = sources()


class KernelCache(NullCache):
    """The compiled code of one kernel in files; a fault of the files is said once, and the kernel compiled anew."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.fault = ""  # of the file that was last looked for

    def load_overload(self, sig: object, target_context: Any) -> CompileResult | None:
        """The compiled code for a signature; None if there is none that can be trusted."""
        self.fault = ""
        target_context.refresh()
        key = self._key(sig, target_context.codegen())
        try:
            content = _own(self._path(key)).read_bytes()
            if hashlib.sha256(content[CHECKSUM:]).digest() != content[:CHECKSUM]:
                raise ValueError("damaged")
            stored, parts = pickle.loads(content[CHECKSUM:])
            if stored != key:
                raise ValueError("of another installation")
            return CompileResult._rebuild(target_context, *parts)
        except FileNotFoundError:
            _announce()
        except OSError as error:
            self.fault = f"not readable ({error.strerror})"
        except Exception as error:  # of whatever the content asks for
            self.fault = str(error) if type(error) is ValueError else "damaged"
        return None

    def save_overload(self, sig: object, data: Any) -> None:
        """Keep what was compiled for a signature, in place of a file that could not be used."""
        key = self._key(sig, data.codegen)
        try:
            if sources() != SOURCES:
                logger.info("the sources of the kernels have changed: what this process compiles is not kept")
                return
            content = dumps((key, data._reduce()))
            _make_folder()
            _write(self._path(key), hashlib.sha256(content).digest() + content)
        except OSError as error:
            _say_not_kept(error)
            return
        if self.fault:
            logger.warning("%s: compiled kernels were %s and are replaced", folder(), self.fault)

    def _key(self, sig: object, codegen: Any) -> tuple[str, ...]:
        """Kernel, signature, and processor with its features."""
        return self.function.__module__, self.function.__qualname__, str(sig), repr(codegen.magic_tuple())

    def _path(self, key: tuple[str, ...]) -> Path:
        module, name, *_ = key
        return folder() / f"{module}.{name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.kernel"


def _own(path: Path) -> Path:
    """The path of a file of this user or of the system's; raises ValueError for another's, whose code is not run."""
    if hasattr(os, "geteuid") and path.stat().st_uid not in (0, os.geteuid()):
        raise ValueError("of another user")
    return path


def _announce() -> None:
    """Say that kernels are compiled, and before that takes its time if they cannot be kept."""
    try:
        _make_folder()
        tempfile.TemporaryFile(dir=folder()).close()
    except OSError as error:
        _say_not_kept(error)
    else:
        logger.info(COMPILING)


def _make_folder() -> None:
    """Make the folder if it is not there, and remove folders of other installations that are long unused."""
    made = folder()
    if made.is_dir():
        return
    made.mkdir(parents=True, exist_ok=True)
    for other in made.parent.iterdir():
        with suppress(FileNotFoundError):  # another process may do the same
            if FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > KEPT_DAYS * 86400.0:
                shutil.rmtree(other, ignore_errors=True)


def _say_not_kept(error: OSError) -> None:
    try:
        where = str(folder())
    except OSError:
        where = str(error.filename)
    logger.warning("%s: %s; %s", where, error.strerror, ADVICE)


def _write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    part = path.with_name(f"{uuid.uuid4().hex}.part")
    try:
        part.write_bytes(content)
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


#: Messages that this process has logged.
said: set[str] = set()


def _first_time(record: logging.LogRecord) -> bool:
    """Whether a message has not been logged before in this process, which has dozens of kernels."""
    text = record.getMessage()
    new = text not in said
    said.add(text)
    return new


logger.addFilter(_first_time)
