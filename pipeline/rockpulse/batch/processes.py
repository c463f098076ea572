"""Worker processes as an executor: a pipe to each, so that the death of one is known at once and costs one item."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from rockpulse.batch.worker import serve

__all__ = ["WorkerDied", "WorkerProcesses"]

#: How often a worker may be killed while it starts before that is taken for more than bad luck.
STARTS = 5
#: Variables of the environment that tell libraries of linear algebra their number of threads.
ALGEBRA = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
#: Signals can be masked for one thread (not on Windows).
MASKS = hasattr(signal, "pthread_sigmask")


class WorkerDied(RuntimeError):
    """The process that worked on an item was killed or ended itself."""


class WorkerProcesses(Executor):
    """An executor of processes that are started afresh (spawn), with one thread of this process for each.

    A process is started with the first call that no other is free for, and again after a death. A future raises the
    error of the function, with the worker's traceback in its notes; :class:`WorkerDied` where the process did not live
    to answer; ``ChildProcessError`` where no process can be started. See docs/decisions/014-batch.md.
    """

    def __init__(self, workers: int) -> None:
        if MASKS:
            ensure_running()  # before the threads block SIGINT: it unblocks the signal when it starts its own process
        self._threads = ThreadPoolExecutor(
            workers, "rockpulse-worker", initializer=_leave_interrupts_to_the_main_thread
        )
        self._own = threading.local()
        self._changing = threading.Lock()
        self._processes: list[SpawnProcess] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a worker call ``fn(*args, **kwargs)``, all of which must pickle."""
        return self._threads.submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all workers at once, whatever they are at, and leave none behind."""
        with self._changing:
            self._ended = True
            for process in self._processes:
                process.kill()
        self._threads.shutdown(wait=True, cancel_futures=True)
        while self._processes:
            self._processes.pop().join()

    def _ask(self, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        letter = pickle.dumps((function, args, kwargs), protocol=5)
        if not hasattr(self._own, "worker"):
            self._own.worker = self._start()
        process, pipe = self._own.worker
        try:
            pipe.send_bytes(letter)
            answer = pipe.recv_bytes()
        except (EOFError, OSError):
            del self._own.worker
            raise WorkerDied(f"the worker process {_fate(self._end(process, pipe))}") from None
        good, result = pickle.loads(answer)
        if good:
            return result
        raise result

    def _start(self) -> tuple[SpawnProcess, Connection]:
        for _ in range(STARTS):
            ours, theirs = multiprocessing.Pipe()
            with self._changing:
                if self._ended:
                    raise ChildProcessError("the worker processes have been ended")
                process = multiprocessing.get_context("spawn").Process(target=serve, args=(theirs,), daemon=True)
                with _algebra_on_one_thread():
                    process.start()
                self._processes.append(process)
            theirs.close()  # the worker has the only copy now: its death is the end of the pipe
            try:
                ours.recv_bytes()  # its first message: it is ready
                return process, ours
            except (EOFError, OSError):
                code = self._end(process, ours)
            if code >= 0:
                raise ChildProcessError(
                    f"a worker process {_fate(code)} while it started; its own message is above. A script that starts "
                    'workers needs the line  if __name__ == "__main__":  before what it runs'
                )
        raise ChildProcessError(
            f"a worker process {_fate(code)} while it started, {STARTS} times; is there enough memory?"
        )

    def _end(self, process: SpawnProcess, pipe: Connection) -> int:
        """Sweep up after a worker whose pipe has ended; its exit code, negative for a signal."""
        pipe.close()
        with self._changing:
            process.join(5.0)
            process.kill()
            process.join()
            if process in self._processes:
                self._processes.remove(process)
        assert process.exitcode is not None  # it has been waited for
        return process.exitcode


@contextmanager
def _algebra_on_one_thread() -> Iterator[None]:
    """Let processes that are started meanwhile do linear algebra on one thread, unless the user has said otherwise.

    A library of linear algebra starts a thread for each core in every process; those of several workers wait for each
    other so much that two workers took three times as long as one thread each.
    """
    ours = [name for name in ALGEBRA if name not in os.environ]
    os.environ.update(dict.fromkeys(ours, "1"))
    try:
        yield
    finally:
        for name in ours:
            del os.environ[name]


def _fate(code: int) -> str:
    return (
        f"ended itself with exit code {code}"
        if code >= 0
        else f"was killed by signal {-code} ({signal.strsignal(-code)})"
    )


def _leave_interrupts_to_the_main_thread() -> None:
    """Block Ctrl-C in this thread; the processes it starts inherit that, and are quiet from their first instruction."""
    if MASKS:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
