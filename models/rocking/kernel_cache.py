"""The decorator `njit` of all kernels, and the folder that stores their compiled code between runs.

Numba's own cache detects a change in the file of a kernel only, not in the kernels that it calls. Here each version of
the sources has its own folder (docs/decisions/021-kernel-cache.md): ``rockpulse-<digest>`` in the user's cache folder,
or in ``NUMBA_CACHE_DIR``. A file contains one kernel for one signature and one processor, with a checksum.
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

#: Time after which an unused folder is removed [days].
KEPT_DAYS = 30.0
#: Name of a folder of compiled kernels.
FOLDER = re.compile(r"rockpulse-[0-9a-f]{16}")
#: Length of the checksum at the start of a file [bytes].
CHECKSUM = hashlib.sha256().digest_size
COMPILING = "compiling the kernels for this processor, once per installation (about a minute)"
ADVICE = "every run compiles the kernels again (about a minute): set NUMBA_CACHE_DIR to a writable folder"


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return ``numba.njit`` with numpy's error model, the interpreter lock released and the cache of this module."""

    def compiled(function: Callable[..., Any]) -> Any:
        kernel = numba.njit(**{"nogil": True, "error_model": "numpy", **options})(function)
        if kernel is not function:  # they are the same if NUMBA_DISABLE_JIT is set
            kernel._cache = KernelCache(function)
        return kernel

    return compiled


@cache
def folder() -> Path:
    """Return the absolute path of the folder for the kernels of this process, which may not exist yet.

    Raises
    ------
    OSError
        If there are no source files (the package is in an archive), or the user has no home folder.
    """
    if not SOURCES:
        raise FileNotFoundError(
            errno.ENOENT, "the source files of the compiled solvers are missing", str(Path(__file__).parent)
        )
    versions = [numba.__version__, np.__version__, sys.version, sys.implementation.cache_tag]
    digest = hashlib.sha256(repr([SOURCES, *versions]).encode()).hexdigest()
    given = numba.config.CACHE_DIR
    parent = Path(given).absolute() if given else platformdirs.user_cache_path("rockpulse", appauthor=False)
    if not parent.is_absolute():
        raise FileNotFoundError(errno.ENOENT, "the user has no home folder", str(parent))
    path = parent / f"rockpulse-{digest[:16]}"
    with suppress(OSError):  # if it does not exist yet, or is read-only
        os.utime(path)  # the time of its last use
    return path


def sources() -> str:
    """Return the SHA-256 of all source files of the package; an empty string if there are none."""
    top = Path(__file__).parent
    paths = sorted(top.rglob("*.py"))
    texts = (path.relative_to(top).as_posix().encode() + b"\0" + path.read_bytes() for path in paths)
    return hashlib.sha256(b"\0".join(texts)).hexdigest() if paths else ""


#: Digest of the sources when this module was imported, before any kernel was imported.
SOURCES = sources()


class KernelCache(NullCache):
    """Cache of the compiled code of one kernel in files; after a file error the kernel is compiled again."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.fault = ""  # what is wrong with the file that was read last

    def load_overload(self, sig: object, target_context: Any) -> CompileResult | None:
        """Return the compiled code for a signature, or None if there is no valid file."""
        self.fault = ""
        target_context.refresh()
        key = self._key(sig, target_context.codegen())
        try:
            content = _checked_owner(self._path(key)).read_bytes()
            if hashlib.sha256(content[CHECKSUM:]).digest() != content[:CHECKSUM]:
                raise ValueError("damaged")
            stored, parts = pickle.loads(content[CHECKSUM:])
            if stored != key:
                raise ValueError("for another kernel")
            return CompileResult._rebuild(target_context, *parts)
        except FileNotFoundError:
            _announce()
        except OSError as error:
            self.fault = f"not readable ({error.strerror})"
        except Exception as error:  # a damaged pickle may raise any exception
            self.fault = str(error) if type(error) is ValueError else "damaged"
        return None

    def save_overload(self, sig: object, data: Any) -> None:
        """Store the compiled code for a signature; replace an invalid file."""
        key = self._key(sig, data.codegen)
        try:
            if sources() != SOURCES:
                logger.info("the sources of the kernels have changed: the kernels of this process are not stored")
                return
            content = dumps((key, data._reduce()))
            _make_folder()
            _write(self._path(key), hashlib.sha256(content).digest() + content)
        except OSError as error:
            _warn_not_stored(error)
            return
        if self.fault:
            logger.warning("%s: a file of compiled code was %s and has been replaced", folder(), self.fault)

    def _key(self, sig: object, codegen: Any) -> tuple[str, ...]:
        """Return the key that identifies a file: module, kernel, signature, and processor with its features."""
        return self.function.__module__, self.function.__qualname__, str(sig), repr(codegen.magic_tuple())

    def _path(self, key: tuple[str, ...]) -> Path:
        module, name, *_ = key
        return folder() / f"{module}.{name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.kernel"


def _checked_owner(path: Path) -> Path:
    """Return the path; raise ValueError if the file belongs to another user, whose code must not be run."""
    if hasattr(os, "geteuid") and path.stat().st_uid not in (0, os.geteuid()):
        raise ValueError("owned by another user")
    return path


def _announce() -> None:
    """Log that kernels are being compiled, or that they cannot be stored."""
    try:
        _make_folder()
        tempfile.TemporaryFile(dir=folder()).close()
    except OSError as error:
        _warn_not_stored(error)
    else:
        logger.info(COMPILING)


def _make_folder() -> None:
    """Create the folder if it does not exist, and remove folders that have not been used for a long time."""
    path = folder()
    if path.is_dir():
        return
    path.mkdir(parents=True, exist_ok=True)
    for other in path.parent.iterdir():
        with suppress(FileNotFoundError):  # another process may remove it too
            if FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > KEPT_DAYS * 86400.0:
                shutil.rmtree(other, ignore_errors=True)


def _warn_not_stored(error: OSError) -> None:
    try:
        path = str(folder())
    except OSError:
        path = str(error.filename)
    logger.warning("%s: %s; %s", path, error.strerror, ADVICE)


def _write(path: Path, content: bytes) -> None:
    part = path.with_name(f"{uuid.uuid4().hex}.part")
    try:
        part.write_bytes(content)
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


#: Messages that this process has already logged.
logged: set[str] = set()


def _first_time(record: logging.LogRecord) -> bool:
    """Return True if this process logs the message for the first time; many kernels may log the same message."""
    text = record.getMessage()
    new = text not in logged
    logged.add(text)
    return new


logger.addFilter(_first_time)
