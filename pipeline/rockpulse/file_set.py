"""Several files that appear together, each of them whole, or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType

__all__ = ["FileSet"]


def _hidden(target: Path) -> Path:
    """A new name in the folder of a file."""
    return target.with_name(f".rockpulse.{os.getpid()}.{secrets.token_hex(4)}.part")


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Give errors of the operating system the name of the file that was asked for."""
    try:
        yield
    except OSError as fault:
        raise OSError(fault.errno, fault.strerror or str(fault), str(path)) from fault


class FileSet:
    """Contents that are written beside their places at once, and moved there by `commit`.

    A symbolic link stays what it is: the file it points to is written. Leaving the context removes what was not
    committed.
    """

    def __init__(self) -> None:
        self._parts = ExitStack()
        self._moves: list[tuple[Path, Path, Path]] = []

    def __enter__(self) -> FileSet:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._parts.close()

    def add(self, target: Path, content: bytes) -> None:
        """Write the content of a file, not yet in its place; an OSError carries the name of `target`."""
        place = Path(os.path.realpath(target))
        part = _hidden(place)
        self._parts.callback(part.unlink, missing_ok=True)
        with _named(target):
            part.write_bytes(content)
        self._moves.append((target, part, place))

    def commit(self) -> None:
        """Put every file in its place; if one fails, all that was there before comes back and the OSError is raised."""
        with ExitStack() as copies, ExitStack() as undo:
            for target, part, place in self._moves:
                with _named(target):
                    if place.exists():
                        copy = _hidden(place)
                        copies.callback(copy.unlink, missing_ok=True)
                        shutil.copy2(place, copy)
                        undo.callback(copy.replace, place)
                    else:
                        undo.callback(place.unlink, missing_ok=True)
                    part.replace(place)
            undo.pop_all()
