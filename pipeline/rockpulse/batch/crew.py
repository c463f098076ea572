"""The workers of a batch: this process, processes of this machine or a cluster; none of it is lost when one dies."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from itertools import islice
from types import TracebackType
from typing import Any, TypeVar

from rocking.lanes import available_cores
from rockpulse.batch.processes import WorkerDied, WorkerProcesses
from rockpulse.batch.worker import call
from rockpulse.errors import ConfigError

__all__ = ["Crew", "WorkerLost"]

Item = TypeVar("Item")
Result = TypeVar("Result")

#: An address of a dask scheduler.
ADDRESS = re.compile(r"[a-z]+://\S+:\d+|inproc://\S+")

#: Items handed out per worker: one in work, one waiting, so that nobody is idle while the parent writes; and on a
#: cluster, where an item and its result take longer on their way than a short record takes in work.
AHEAD, AHEAD_ON_CLUSTER = 2, 8


@dataclass(frozen=True)
class WorkerLost:
    """In place of a result: the item took its worker with it each time it was tried."""

    reason: str  # the end of the worker in words


class Crew:
    """Workers for the length of a ``with`` block; made by one of the class methods.

    Leaving the block, by whatever way, ends the processes of :meth:`local` at once and leaves none behind; a cluster is
    told to drop what it was given.

    Examples
    --------
    >>> with Crew.inline() as crew:
    ...     list(crew.run(abs, [-2, 1]))
    [(-2, 2), (1, 1)]
    """

    def __init__(
        self,
        executor: Executor | None,
        size: Callable[[], int],
        deaths: tuple[type[Exception], ...] = (),
        tries: int = 1,
        owned: bool = True,
        ahead: int = AHEAD,
    ) -> None:
        self._executor, self._size, self._deaths, self._tries, self._owned = executor, size, deaths, tries, owned
        self._ahead = ahead
        self._handed_out: set[Future[Any]] = set()

    @classmethod
    def inline(cls) -> Crew:
        """The crew that is this process, with all its threads."""
        return cls(None, lambda: 1)

    @classmethod
    def local(cls, workers: int) -> Crew:
        """So many processes of this machine, each with its kernels on one thread; they start when there is work."""
        if workers < 1:
            raise ValueError(f"workers: expected a whole number of at least 1, got {workers!r}")
        return cls(WorkerProcesses(workers), lambda: workers, deaths=(WorkerDied,), tries=2)

    @classmethod
    def scheduler(cls, address: str, timeout: float = 20.0) -> Crew:
        """The workers of a dask.distributed cluster that is running, each item with its kernels on one thread.

        Raises ConfigError without the package ``distributed``, where no scheduler answers at the address, such as
        ``tcp://10.0.0.1:8786``, within the timeout [s], or where a worker has no rockpulse of this version. The
        scheduler itself tries an item again whose worker died, on other workers (its option ``allowed-failures``).
        """
        if not ADDRESS.fullmatch(address):
            raise ConfigError(
                f"--scheduler {address}: expected the address of a running dask scheduler as scheme://host:port, such "
                "as tcp://10.0.0.1:8786"
            )
        from rockpulse.batch.cluster import Cluster

        cluster = Cluster(address, timeout)
        return cls(cluster, cluster.size, deaths=cluster.deaths, ahead=AHEAD_ON_CLUSTER)

    @classmethod
    def through(cls, executor: Executor, size: int | None = None) -> Crew:
        """Any executor, which stays the caller's to shut down; `size` items side by side, without it one a core.

        Where its workers are processes, they must be able to import rockpulse.
        """
        return cls(executor, lambda: size or available_cores(), owned=False)

    @property
    def size(self) -> int:
        """Number of items that are worked on side by side; on a cluster this changes as its workers come and go."""
        return self._size()

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # A traceback keeps `run` alive and its own clearing up from happening.
        for future in list(self._handed_out):
            future.cancel()
        if self._executor is not None and self._owned:
            self._executor.shutdown(cancel_futures=True)

    def run(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | WorkerLost]]:
        """Have the function called with every item: pairs of the item and its result, in order of completion.

        The function is pickled, so it stands at the top level of a module (or is a ``functools.partial`` of such). A
        few items a worker, two or on a cluster eight, are taken ahead of the results. The result is a
        :class:`WorkerLost` where the worker died of the item, and died again when it was tried a second time, after all
        others and alone.

        Raises
        ------
        Exception
            The function's own; the traceback of the worker is in its notes.
        ConnectionError
            Where the cluster was lost with the work half done.
        """
        if self._executor is None:
            yield from ((item, function(item)) for item in items)
            return
        waiting, again = iter(items), list[Item]()
        running: dict[Future[Result], Item] = {}
        try:
            while True:
                for item in islice(waiting, max(self._ahead * self.size - len(running), 0)):
                    running[self._submit(function, item)] = item
                if not running:
                    break
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    item, result = running.pop(future), self._result(future)
                    if isinstance(result, WorkerLost) and self._tries > 1:
                        again.append(item)
                    else:
                        yield item, result
            for item in again:
                second: Result | WorkerLost = self._result(self._submit(function, item))
                yield item, second
        finally:
            for future in running:
                future.cancel()

    def _submit(self, function: Callable[[Item], Result], item: Item) -> Future[Result]:
        assert self._executor is not None
        future = self._executor.submit(call, function, item)
        self._handed_out.add(future)
        future.add_done_callback(self._handed_out.discard)
        return future

    def _result(self, future: Future[Result]) -> Result | WorkerLost:
        try:
            return future.result()
        except self._deaths as error:
            return WorkerLost(str(error))
        except CancelledError as error:
            raise ConnectionError(
                "the work was cancelled from outside: the scheduler or the executor is gone"
            ) from error
