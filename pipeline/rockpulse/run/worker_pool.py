"""The workers of a batch: this process, local processes or a cluster. Items whose worker dies are processed again."""

import logging
import pickle
import re
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from itertools import islice
from operator import length_hint
from typing import Any, Self, TypeVar

from rocking.lanes import available_cores
from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line
from rockpulse.run.processes import Packed, WorkerDied, WorkerProcesses, call, functions
from rockpulse.version import __version__

logger = logging.getLogger("rockpulse")
Item = TypeVar("Item")
Result = TypeVar("Result")
#: Pattern of the address of a dask scheduler.
ADDRESS = re.compile(r"[a-z]+://\S+:\d+|inproc://\S+")
#: Number of groups of items submitted per worker, so that no worker is idle while the parent writes; more on a cluster,
#: where the transfer takes longer.
AHEAD, AHEAD_ON_CLUSTER = 2, 4
#: Time [s] that a group of items should take on a cluster, whose scheduler distributes fewer than 200 groups a second,
#: and largest number of items of a group.
GROUP_SECONDS, LARGEST_GROUP = 0.5, 128
#: Interval between queries for the workers of a scheduler [s].
ASK_EVERY = 1.0


@dataclass(frozen=True)
class WorkerLost:
    """The result of an item whose worker died at each attempt."""

    reason: str  # how the worker ended


@dataclass(eq=False)
class WorkerPool:
    """The workers of a batch; a class method creates the pool for use in a ``with`` block."""

    executor: Executor | None  # None for this process
    count: Callable[[], int]  # number of items processed at the same time
    deaths: tuple[type[Exception], ...] = ()  # errors by which a future reports a dead worker
    tries: int = 1  # number of attempts for an item whose worker died
    owned: bool = True  # whether the executor is shut down at the end
    ahead: int = AHEAD
    group_seconds: float = 0.0  # time that a group of items should take [s]; 0 for single items
    handed_out: set[Future[Any]] = field(default_factory=set)

    @classmethod
    def inline(cls) -> Self:
        """Return a pool that uses only this process, with all its threads."""
        return cls(None, lambda: 1)

    @classmethod
    def local(cls, workers: int) -> Self:
        """Return a pool of local processes, each of which computes on one thread."""
        if workers < 1:
            raise ValueError(f"workers: expected a whole number of at least 1, got {workers!r}")
        return cls(WorkerProcesses(workers), lambda: workers, deaths=(WorkerDied,), tries=2)

    @classmethod
    def scheduler(cls, address: str, timeout: float = 20.0) -> Self:
        """Return a pool of the workers of a running dask.distributed cluster; each item is computed on one thread.

        Items are sent in groups, each of which is a task for the scheduler. The scheduler repeats a group whose worker
        died (its option ``allowed-failures``); if it gives up, each item of the group is tried again, alone. Raises
        ConfigError if the package ``distributed`` is missing, if no scheduler responds within the timeout [s] at the
        address, such as ``tcp://10.0.0.1:8786``, or if a worker has another version of rockpulse.
        """
        if not ADDRESS.fullmatch(address):
            raise ConfigError(
                f"--scheduler {address}: expected the address of a running dask scheduler as scheme://host:port, such "
                "as tcp://10.0.0.1:8786"
            )
        cluster = _Cluster(address, timeout)
        return cls(cluster, cluster.size, deaths=cluster.deaths, ahead=AHEAD_ON_CLUSTER, group_seconds=GROUP_SECONDS)

    @classmethod
    def through(cls, executor: Executor) -> Self:
        """Return a pool that uses the given executor; the caller must shut the executor down."""
        return cls(executor, available_cores, owned=False)

    @property
    def size(self) -> int:
        """Number of items that are processed at the same time; on a cluster it changes with the number of workers."""
        return self.count()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        # A traceback keeps the generator `run` alive, so that its `finally` would not run.
        for future in list(self.handed_out):
            future.cancel()
        if self.executor is not None and self.owned:
            self.executor.shutdown(cancel_futures=True)

    def run(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | WorkerLost]]:
        """Yield each item with the result of a picklable function, in the order in which they are finished.

        A few items per worker, or on a cluster a few groups of items, are submitted in advance. An item whose worker
        died is repeated once, alone and after all others; if its worker dies again, the result is :class:`WorkerLost`.
        Raises the error of the function with the worker's traceback in its notes, and ConnectionError if the cluster is
        lost.
        """
        if self.executor is None:
            yield from ((item, function(item)) for item in items)
            return
        waiting, again, packed = iter(items), list[Item](), Packed.of(function)
        unsent, size = length_hint(items, LARGEST_GROUP**2), 1
        running: dict[Future[tuple[float, list[Result]]], list[Item]] = {}
        try:
            while True:
                for _ in range(self.ahead * self.size - len(running)):
                    # The last groups are smaller, so that all workers end at the same time.
                    group = list(islice(waiting, max(1, min(size, unsent // (2 * self.size)))))
                    if not group:
                        break
                    running[self._submit(packed, group)] = group
                    unsent -= len(group)
                if not running:
                    break
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    group, results = running.pop(future), self._results(future)
                    if not isinstance(results, WorkerLost):
                        seconds, found = results
                        size = max(1, min(int(self.group_seconds * len(group) / max(seconds, 1e-9)), LARGEST_GROUP))
                        yield from zip(group, found, strict=True)
                    elif self.tries > 1 or len(group) > 1:
                        again += group
                    else:
                        yield group[0], results
            for item in again:
                yield item, self.result_of(self._submit(packed, [item]))
        finally:
            for future in running:
                future.cancel()

    def begin(self, function: Callable[[Item], Result], item: Item) -> Future[Any]:
        """Start to process one item in a worker, and return a future for :meth:`result_of`."""
        return self._submit(Packed.of(function), [item])

    def result_of(self, future: Future[Any]) -> Any | WorkerLost:
        """Return the result of a single item when it is finished; the errors are those of :meth:`run`."""
        results = self._results(future)
        return results if isinstance(results, WorkerLost) else results[1][0]

    def _submit(self, packed: Packed, group: list[Item]) -> Future[tuple[float, list[Any]]]:
        assert self.executor is not None
        future = self.executor.submit(call, packed, group)
        self.handed_out.add(future)
        future.add_done_callback(self.handed_out.discard)
        return future

    def _results(self, future: Future[Any]) -> tuple[float, list[Any]] | WorkerLost:
        try:
            found = future.result()
        except self.deaths as error:
            return WorkerLost(str(error))
        except CancelledError as error:
            raise ConnectionError(
                "the work was cancelled from outside: the scheduler or the executor has ended"
            ) from error
        results: tuple[float, list[Any]] = pickle.loads(found) if isinstance(found, bytes) else found
        return results


def _call(key: str, items: bytes) -> bytes:
    """Run :func:`call` with pickled items and return its pickled result; dask does not inspect bytes."""
    from distributed import get_worker, sync

    content = b""
    if key not in functions:
        worker = get_worker()
        content = sync(worker.loop, worker.scheduler.get_metadata, keys=[key])
    return pickle.dumps(call(Packed(key, content), pickle.loads(items)), protocol=5)


def version() -> str:
    """Return the version of rockpulse in this process."""
    return __version__


class _Cluster(Executor):
    """Executor of a running dask.distributed cluster; it raises the errors listed at :meth:`WorkerPool.scheduler`."""

    def __init__(self, address: str, timeout: float) -> None:
        try:
            from distributed import Client, KilledWorker
        except ImportError as error:
            raise ConfigError(
                f"--scheduler {address}: the package distributed is not installed ({error}): "
                'pip install "rockpulse[distributed]"'
            ) from error
        self.deaths, self._address = (KilledWorker,), address
        self._threads, self._ask_again = 1, 0.0
        with ExitStack() as left:
            # dask logs tracebacks of errors that it also raises.
            for handler in list(logging.getLogger("distributed").handlers):
                handler.addFilter(_nothing)
                left.callback(handler.removeFilter, _nothing)
            try:
                self._client = Client(address, timeout=timeout, name="rockpulse", set_as_default=False)
            except (OSError, ValueError) as error:
                raise ConfigError(
                    f"--scheduler {address}: expected the address of a running dask scheduler, such as "
                    f"tcp://10.0.0.1:8786, but none answers within {timeout:g} s ({first_line(error)}); start one:  "
                    "dask scheduler  and its workers:  dask worker ADDRESS --nthreads 1"
                ) from error
            left.callback(self._client.close)
            self._check_versions()
            self._left = left.pop_all()
        # pure=False: two calls with equal arguments are two calls.
        self._executor = self._client.get_executor(pure=False)
        self._stored: Any = None  # task of dask with the key of the function that workers get from the scheduler

    def size(self) -> int:
        """Number of threads of all workers, at least 1; it is cached for one second, as asking the cluster is slow."""
        now = time.monotonic()
        if now >= self._ask_again:
            with self._connected():
                self._threads = max(sum(self._client.nthreads().values()), 1)
            self._ask_again = now + ASK_EVERY
        return self._threads

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call ``fn(*args, **kwargs)`` on a worker; if `fn` is :func:`call`, the future contains pickled results."""
        if fn is call:
            packed, items = args
            if self._stored is None or self._stored.key != packed.key:
                # The scheduler deletes this metadata with the task of the same key, which ends with this client.
                self._stored = self._client.submit(int, key=packed.key)
                with self._connected():
                    self._client.set_metadata(packed.key, packed.content)
            fn, args = _call, (packed.key, pickle.dumps(items, protocol=5))
        future: Future[Any] = self._executor.submit(fn, *args, **kwargs)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel the remaining items and disconnect."""
        self._executor.shutdown(wait=False)
        self._left.close()

    @contextmanager
    def _connected(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise ConnectionError(
                f"the dask scheduler at {self._address} does not answer any more ({first_line(error)})"
            ) from error

    def _check_versions(self) -> None:
        found_on = self._client.run(version, on_error="return")
        if not found_on:
            logger.warning("the dask scheduler at %s has no workers yet: waiting for the first", self._address)
        for worker, found in found_on.items():
            if found != __version__:
                raise ConfigError(
                    f"dask worker {worker}: expected rockpulse {__version__}, found {found!r}; "
                    "install the same version in the environment of every worker"
                )


def _nothing(record: logging.LogRecord) -> bool:
    return False
