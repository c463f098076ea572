"""Telling the user, who may have left: the work goes on, and the exit code stays what it is."""

from __future__ import annotations

import os
import sys
from typing import TextIO

from rockpulse.foreign_text import escaped

__all__ = ["QUIET", "forsake", "tell"]

#: What --quiet does.
QUIET = "print nothing but one line on what failed"


def tell(text: str, file: TextIO | None = None) -> None:
    """Print a text, to standard output by default, with control characters as escapes.

    Where nobody reads any more, as in ``| head``, the rest is dropped.
    """
    file = sys.stdout if file is None else file
    try:
        print(escaped(text), file=file, flush=True)
    except BrokenPipeError:
        forsake(file)


def forsake(file: TextIO) -> None:
    """Have the rest of what is written to standard output or standard error go nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, file.fileno())
    os.close(nowhere)
