"""Worker processes as an executor: a pipe to each, so that the death of one is known at once and costs one item.

Nothing heavy is imported here: a worker is up at once, and what it works with comes with the first call.
"""

import multiprocessing
import os
import pickle
import signal
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from rocking.lanes import thread_limit

#: How often a worker may be killed while it starts before that is taken for more than bad luck.
STARTS = 5
#: Variables of the environment that tell libraries of linear algebra their number of threads.
ALGEBRA = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
#: Signals can be masked for one thread (not on Windows).
MASKS = hasattr(signal, "pthread_sigmask")


def call(function: Callable[[Any], Any], item: Any) -> Any:
    """The result of the function for the item, with its kernels on one thread: the neighbours need the other cores."""
    with thread_limit(1):
        return function(item)


def serve(pipe: Connection) -> None:
    """Answer the letters that come through the pipe until the parent closes it or is gone: the life of a worker.

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
        note = f"in worker process {os.getpid()}:\n{traceback.format_exc()}"
        error.add_note(note)
        try:
            report = pickle.dumps((False, error), protocol=5)
            pickle.loads(report)
        except Exception:  # an exception with arguments of its own often does not come back from pickle
            substitute = RuntimeError(f"{type(error).__name__}: {error}")
            substitute.add_note(note)
            report = pickle.dumps((False, substitute), protocol=5)
        return report


class WorkerDied(RuntimeError):
    """The process that worked on an item was killed or ended itself."""


class WorkerProcesses(ThreadPoolExecutor):
    """An executor of processes that are started afresh (spawn), with one thread of this process for each.

    A process is started with the first call that no other is free for, and again after a death. A future raises the
    error of the function, with the worker's traceback in its notes; :class:`WorkerDied` where the process did not live
    to answer; ``ChildProcessError`` where no process can be started. See docs/decisions/014-batch.md.
    """

    def __init__(self, workers: int) -> None:
        if MASKS:
            ensure_running()  # before the threads block SIGINT: it unblocks the signal when it starts its own process
        super().__init__(workers, "rockpulse-worker", initializer=_leave_interrupts_to_the_main_thread)
        self._own = threading.local()
        self._changing = threading.Lock()
        self._workers: list[SpawnProcess] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a worker call ``fn(*args, **kwargs)``, all of which must pickle."""
        return super().submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all workers at once, whatever they are at, and leave none behind."""
        with self._changing:
            self._ended = True
            for process in self._workers:
                process.kill()
        super().shutdown(wait=True, cancel_futures=True)
        while self._workers:
            self._workers.pop().join()

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
                # A library of linear algebra starts a thread for each core in every process; those of several workers
                # wait for each other so much that two workers took three times as long as one thread each.
                unsaid = [name for name in ALGEBRA if name not in os.environ]
                os.environ.update(dict.fromkeys(unsaid, "1"))
                try:
                    process.start()
                finally:
                    for name in unsaid:
                        del os.environ[name]
                self._workers.append(process)
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
            if process in self._workers:
                self._workers.remove(process)
        assert process.exitcode is not None  # it has been waited for
        return process.exitcode


def _fate(code: int) -> str:
    if code >= 0:
        return f"ended itself with exit code {code}"
    return f"was killed by signal {-code} ({signal.strsignal(-code)})"


def _leave_interrupts_to_the_main_thread() -> None:
    """Block Ctrl-C in this thread; the processes it starts inherit that, and are quiet from their first instruction."""
    if MASKS:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
