"""The work of a worker: read the samples of a task, work on them, send back bytes and rows, never an exception."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from threading import get_ident

from rockpulse.batch.journal import UNFINISHED, Done
from rockpulse.batch.packing import pack
from rockpulse.batch.plan import Task, read_options
from rockpulse.batch.survey import unexpected
from rockpulse.config.configuration import Config
from rockpulse.errors import RockpulseError
from rockpulse.failures import Failure
from rockpulse.motions.runner import Work, worked

__all__ = ["carry_out"]

#: The steps whose time is measured.
STEPS = ("read", "condition", "solve", "pack")


def carry_out(task: Task, work: Work, stage: str, config: Config) -> Done:
    """Read the samples of a task and work on its motions; whatever goes wrong is a row in what comes of it."""
    seconds = dict.fromkeys(STEPS, 0.0)

    @contextmanager
    def watch(step: str) -> Iterator[None]:
        began = time.perf_counter()
        try:
            yield
        finally:
            seconds[step] += time.perf_counter() - began

    parts: list[bytes] = []
    failures: list[Failure] = []
    at = "read"
    with _heard() as messages:
        try:
            with watch("read"):
                planned = task.read(read_options(config))
            at = stage
            for outcome in worked(planned, work, stage, config, watch):
                if isinstance(outcome, Failure):
                    failures.append(outcome)
                else:
                    with watch("pack"):
                        parts.append(pack(outcome))
        except Exception as fault:
            if not isinstance(fault, RockpulseError | OSError):
                messages.append((logging.ERROR, f"{task.key}: {traceback.format_exc()}"))
                fault = unexpected(fault)
            row = Failure(task.source, at, f"{task.key}: {fault}", "failed")
            return Done(task.key, UNFINISHED, (), (row,), tuple(messages), seconds)
    return Done(task.key, task.fingerprint, tuple(parts), tuple(failures), tuple(messages), seconds)


@contextmanager
def _heard() -> Iterator[list[tuple[int, str]]]:
    """Level and text of what this thread logs meanwhile; the parent logs it, and nobody else."""
    messages: list[tuple[int, str]] = []
    thread = get_ident()

    def take(record: logging.LogRecord) -> bool:
        if record.thread != thread:
            return True
        messages.append((record.levelno, record.getMessage()))
        return False

    logger = logging.getLogger("rockpulse")
    logger.addFilter(take)
    try:
        yield messages
    finally:
        logger.removeFilter(take)
