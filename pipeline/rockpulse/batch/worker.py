"""A worker process: takes calls from its pipe, sends back what they return, ends with its parent.

Nothing heavy is imported here: a worker is up at once, and what it works with comes with the first call.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection, wait
from typing import Any

from rocking.lanes import thread_limit
from rockpulse.version import __version__

__all__ = ["call", "serve", "version"]


def call(function: Callable[[Any], Any], item: Any) -> Any:
    """The result of the function for the item, with its kernels on one thread: the neighbours need the other cores."""
    with thread_limit(1):
        return function(item)


def version() -> str:
    """The version of rockpulse that this process works with."""
    return __version__


def serve(pipe: Connection) -> None:
    """Answer the letters that come through the pipe until the parent closes it or is gone.

    The first message is "ready". A letter is the pickled triple (function, arguments, keywords). The answer is the
    pickled pair (True, result) or (False, exception); the exception carries the traceback as a note.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group: the parent decides
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        pipe.send_bytes(b"ready")
        while True:
            pipe.send_bytes(_answer(pipe.recv_bytes()))
    except (EOFError, ConnectionError):  # the parent has closed the pipe: nobody is left to tell
        return


def _end_with_parent() -> None:
    """End this process, whatever it is at, when its parent is gone: SIGKILL leaves the parent no time to say so."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _answer(letter: bytes) -> bytes:
    try:
        function, args, kwargs = pickle.loads(letter)
        return pickle.dumps((True, function(*args, **kwargs)), protocol=5)
    except BaseException as error:  # SystemExit too: whatever the function raises is for the parent to see
        return _report(error)


def _report(error: BaseException) -> bytes:
    error.add_note(f"in worker process {os.getpid()}:\n{traceback.format_exc()}")
    try:
        report = pickle.dumps((False, error), protocol=5)
        pickle.loads(report)
    except Exception:  # an exception with arguments of its own often does not come back from pickle
        substitute = RuntimeError(f"{type(error).__name__}: {error}")
        substitute.add_note(error.__notes__[-1])
        report = pickle.dumps((False, substitute), protocol=5)
    return report
