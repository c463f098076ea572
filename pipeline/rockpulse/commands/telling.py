"""Telling the user, who may have left: the work goes on, and the exit code stays what it is."""

from __future__ import annotations

import os
import sys
from typing import TextIO

__all__ = ["forsake", "tell"]


def tell(text: str, file: TextIO | None = None) -> None:
    """Print a text; where nobody reads any more, as in ``rockpulse ... | head``, this and what follows is dropped.

    Parameters
    ----------
    text : str
        Without the last line break.
    file : text file, optional
        Standard output by default.
    """
    file = sys.stdout if file is None else file
    try:
        print(text, file=file, flush=True)
    except BrokenPipeError:
        forsake(file)


def forsake(file: TextIO) -> None:
    """Have what is still to be written into a pipe without a reader go nowhere.

    Parameters
    ----------
    file : text file
        Standard output or standard error.
    """
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, file.fileno())
    os.close(nowhere)
