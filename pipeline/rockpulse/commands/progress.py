"""Signs of life on a terminal while the work goes on: progress bars, and that the kernels are compiled."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

__all__ = ["compiling_told", "progress_bars"]

#: Columns and rows of a terminal that does not tell its own.
SIZE = (80, 24)

COMPILING = "rockpulse: compiling the kernels, once (about 20 s); later runs load them"


def progress_bars(quiet: bool) -> Callable[..., Any]:
    """``tqdm.tqdm`` on standard error: silent where that is asked for, or where it is no terminal."""
    from tqdm import tqdm

    columns, rows = SIZE
    # Of a terminal without a size tqdm would show nothing at all.
    sized = quiet or not sys.stderr.isatty() or os.get_terminal_size(sys.stderr.fileno()).columns > 0
    return partial(tqdm, disable=True if quiet else None, **({} if sized else {"ncols": columns, "nrows": rows}))


@contextmanager
def compiling_told(quiet: bool) -> Iterator[None]:
    """Within it, the first kernel that has to be compiled is told of on a terminal; one from the cache is not."""
    if quiet or not sys.stderr.isatty():
        yield
        return
    from numba.core.event import Event, Listener, install_listener
    from tqdm import tqdm

    class Told(Listener):
        told = False

        def on_start(self, event: Event) -> None:
            if not self.told:
                self.told = True
                tqdm.write(COMPILING, file=sys.stderr)  # above a bar that is there already

        def on_end(self, event: Event) -> None:
            pass

    with install_listener("numba:compile", Told()):
        yield
