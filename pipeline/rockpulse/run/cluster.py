"""A dask.distributed cluster as an executor."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import ExitStack, contextmanager
from typing import Any

from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line
from rockpulse.run.processes import version
from rockpulse.version import __version__

__all__ = ["Cluster"]

logger = logging.getLogger("rockpulse")

#: Time between two questions to the scheduler about its workers [s].
ASK_EVERY = 1.0


class Cluster(Executor):
    """The workers of a running dask.distributed cluster, as an executor; the cluster itself stays as it is.

    `deaths` are the errors of a future whose workers died, all of those that the scheduler tried it on. Making one
    raises ConfigError as :meth:`rockpulse.run.crew.Crew.scheduler` says.
    """

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
        self._quiet = ExitStack()
        self._quiet.enter_context(_silenced())
        try:
            self._client = Client(address, timeout=timeout, name="rockpulse", set_as_default=False)
        except (OSError, ValueError) as error:
            self._quiet.close()
            raise ConfigError(
                f"--scheduler {address}: expected the address of a running dask scheduler, such as "
                f"tcp://10.0.0.1:8786, but none answers within {timeout:g} s ({first_line(error)}); start one:  "
                "dask scheduler  and its workers:  dask worker ADDRESS --nthreads 1"
            ) from error
        try:
            self._check_versions()
        except BaseException:
            self._leave()
            raise
        # Two calls with equal arguments are two calls: without pure=False they would be one.
        self._executor = self._client.get_executor(pure=False)

    def size(self) -> int:
        """Threads of all workers, asked for every second; 1 while there is none, so that one call waits for the first.

        Every question waits for the scheduler, as long as a short record takes.
        """
        now = time.monotonic()
        if now >= self._ask_again:
            try:
                self._threads = max(sum(self._client.nthreads().values()), 1)
            except OSError as error:
                raise ConnectionError(
                    f"the dask scheduler at {self._address} does not answer any more ({first_line(error)})"
                ) from error
            self._ask_again = now + ASK_EVERY
        return self._threads

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a worker of the cluster call ``fn(*args, **kwargs)``."""
        future: Future[Any] = self._executor.submit(fn, *args, **kwargs)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Drop what is not done and leave the cluster."""
        self._executor.shutdown(wait=False)
        self._leave()

    def _leave(self) -> None:
        self._client.close()
        self._quiet.close()

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


@contextmanager
def _silenced() -> Iterator[None]:
    """Within it, dask logs nothing: what goes wrong comes as an exception too, and its log shows tracebacks of it."""
    handlers = list(logging.getLogger("distributed").handlers)

    def nothing(record: logging.LogRecord) -> bool:
        return False

    for handler in handlers:
        handler.addFilter(nothing)
    try:
        yield
    finally:
        for handler in handlers:
            handler.removeFilter(nothing)
