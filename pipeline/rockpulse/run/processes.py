"""An executor with worker processes, each with its own pipe, so that a process that dies affects only one item."""

import multiprocessing
import os
import pickle
import secrets
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from typing import Any, NamedTuple, Self

from rocking.lanes import thread_limit

#: Largest number of attempts to start a worker, which may be killed while it starts.
STARTS = 5
#: Environment variables that set the number of threads of linear algebra libraries.
ALGEBRA = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
#: Whether signals can be masked for one thread (not on Windows).
MASKS = hasattr(signal, "pthread_sigmask")


class Packed(NamedTuple):
    """A pickled function, whose content is sent once to each worker; later calls contain only its key."""

    key: str
    content: bytes

    @classmethod
    def of(cls, function: Callable[[Any], Any]) -> Self:
        """Return a function, pickled and with a new key."""
        return cls(secrets.token_hex(16), pickle.dumps(function, protocol=5))


#: The functions that this process has unpickled last, at most KEPT of them, by key.
functions: dict[str, Callable[[Any], Any]] = {}
KEPT = 4


def call(packed: Packed, items: Sequence[Any]) -> tuple[float, list[Any]]:
    """Apply a function to each item; return the time taken [s] and the results. Kernels use one thread."""
    began = time.perf_counter()
    function = functions.get(packed.key)
    if function is None:
        function = functions[packed.key] = pickle.loads(packed.content)
        for key in list(functions)[:-KEPT]:
            functions.pop(key, None)  # another thread may have removed it
    with thread_limit(1):
        results = [function(item) for item in items]
    return time.perf_counter() - began, results


def serve(pipe: Connection) -> None:
    """Run a worker: for each received (function, args, keywords) send (True, result) or (False, exception)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole process group: the parent handles it
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        pipe.send_bytes(b"ready")
        while True:
            pipe.send_bytes(_answer(pipe.recv_bytes()))
    except (EOFError, ConnectionError):  # the parent has closed the pipe
        return


def _end_with_parent() -> None:
    """End this process when its parent ends, even if the parent is killed."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _answer(letter: bytes) -> bytes:
    try:
        function, args, kwargs = pickle.loads(letter)
        return pickle.dumps((True, function(*args, **kwargs)), protocol=5)
    except BaseException as error:  # also SystemExit: the parent raises it
        note = f"in worker process {os.getpid()}:\n{traceback.format_exc()}"
        error.add_note(note)
        try:
            report = pickle.dumps((False, error), protocol=5)
            pickle.loads(report)
        except Exception:  # exceptions with other arguments often cannot be unpickled
            substitute = RuntimeError(f"{type(error).__name__}: {error}")
            substitute.add_note(note)
            report = pickle.dumps((False, substitute), protocol=5)
        return report


class WorkerDied(RuntimeError):
    """Error: the worker process ended, or was killed, before it returned the result of an item."""


class WorkerProcesses(ThreadPoolExecutor):
    """An executor of new worker processes, each served by one thread of this process (docs/decisions/014-batch.md).

    A process is started if no other process is free, and is replaced if it dies. A future raises the error of the
    function, with the worker's traceback in its notes; :class:`WorkerDied` if the process has died; or
    ``ChildProcessError`` if no process can be started.
    """

    def __init__(self, workers: int) -> None:
        if MASKS:
            ensure_running()  # before the threads block SIGINT, as it unblocks SIGINT when it starts its own process
        super().__init__(workers, "rockpulse-worker", initializer=_leave_interrupts_to_the_main_thread)
        self._own = threading.local()
        self._changing = threading.Lock()
        self._workers: list[SpawnProcess] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call ``fn(*args, **kwargs)`` in a worker process; function and arguments are sent pickled."""
        return super().submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Kill all worker processes at once."""
        with self._changing:
            self._ended = True
            for process in self._workers:
                process.kill()
        super().shutdown(wait=True, cancel_futures=True)
        while self._workers:
            self._workers.pop().join()

    def _ask(self, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        if not hasattr(self._own, "worker"):
            self._own.worker, self._own.received = self._start(), ""  # key of the function that it received last
        process, pipe = self._own.worker
        key = args[0].key if function is call else self._own.received
        if function is call and key == self._own.received:
            args = (Packed(key, b""), *args[1:])
        letter = pickle.dumps((function, args, kwargs), protocol=5)
        try:
            pipe.send_bytes(letter)
            answer = pipe.recv_bytes()
        except (EOFError, OSError):
            del self._own.worker
            raise WorkerDied(f"the worker process {_fate(self._end(process, pipe))}") from None
        good, result = pickle.loads(answer)
        if good:
            self._own.received = key
            return result
        raise result

    def _start(self) -> tuple[SpawnProcess, Connection]:
        for _ in range(STARTS):
            ours, theirs = multiprocessing.Pipe()
            with self._changing:
                if self._ended:
                    raise ChildProcessError("the worker processes were stopped")
                process = multiprocessing.get_context("spawn").Process(target=serve, args=(theirs,), daemon=True)
                # Linear algebra libraries would start one thread per core in every process: two workers took three
                # times as long.
                unsaid = [name for name in ALGEBRA if name not in os.environ]
                os.environ.update(dict.fromkeys(unsaid, "1"))
                try:
                    process.start()
                finally:
                    for name in unsaid:
                        del os.environ[name]
                self._workers.append(process)
            theirs.close()  # the worker has the only copy, so that the pipe closes when it dies
            try:
                ours.recv_bytes()  # its first message reports that it is ready
                return process, ours
            except (EOFError, OSError):
                code = self._end(process, ours)
            if code >= 0 and str(getattr(sys.modules["__main__"], "__file__", "")).endswith("<stdin>"):
                raise ChildProcessError(
                    "worker processes cannot be started by a script on standard input: write it to a file and run that "
                    "file, or use one worker"
                )
            if code >= 0:
                raise ChildProcessError(
                    f"a worker process {_fate(code)} while it started; its own message is above. A script that starts "
                    'workers needs the line  if __name__ == "__main__":  before the code that it runs'
                )
        raise ChildProcessError(
            f"a worker process {_fate(code)} during its start, {STARTS} times; is there enough memory?"
        )

    def _end(self, process: SpawnProcess, pipe: Connection) -> int:
        """Clean up after a worker that has ended; return its exit code, which is negative if a signal killed it."""
        pipe.close()
        with self._changing:
            process.join(5.0)
            process.kill()
            process.join()
            if process in self._workers:
                self._workers.remove(process)
        assert process.exitcode is not None  # after join
        return process.exitcode


def _fate(code: int) -> str:
    if code >= 0:
        return f"ended itself with exit code {code}"
    return f"was killed by signal {-code} ({signal.strsignal(-code)})"


def _leave_interrupts_to_the_main_thread() -> None:
    """Block Ctrl-C in this thread and in the processes that it starts."""
    if MASKS:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
