"""What a worker does: read the samples of a task, work on them, send back bytes and rows, never an exception."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import get_ident
from typing import TYPE_CHECKING, Generic, TypeVar

from rockpulse.assessment import RecordAssessment, Watch, assess_planned
from rockpulse.batch.journal import pack
from rockpulse.batch.plan import Task, read_options
from rockpulse.batch.survey import unexpected
from rockpulse.bodies import Bodies
from rockpulse.config import Config
from rockpulse.directions import PlannedMotion
from rockpulse.errors import RockpulseError
from rockpulse.failures import Failure
from rockpulse.models.block import Block
from rockpulse.results import record_part

if TYPE_CHECKING:
    from rockpulse.calibration.site_record import SiteRecord

__all__ = ["UNFINISHED", "Done", "Job", "assess_task", "calibrate_task"]

Acting = TypeVar("Acting", Bodies, Block)
Result = TypeVar("Result")

#: Fingerprint of a task that broke off for want of its file or of memory, or by a fault of the program. No task has it:
#: a run that is resumed tries again.
UNFINISHED = ""

#: The steps whose time is measured.
STEPS = ("read", "condition", "solve", "pack")


@dataclass(frozen=True)
class Job(Generic[Acting]):
    """What all tasks of a run have in common.

    Attributes
    ----------
    config : Config
        Options.
    bodies : Bodies or Block
        The bodies to assess; of a calibration the (m,) blocks that the design has to cover.
    """

    config: Config
    bodies: Acting


@dataclass(frozen=True)
class Done:
    """What came of a task.

    Attributes
    ----------
    key : str
        That of the task.
    fingerprint : str
        That of the task, or :data:`UNFINISHED`.
    parts : tuple of bytes
        One for each motion: of an assessment the arrays of `rockpulse.results.record_part`, packed by
        `rockpulse.batch.journal.pack`; of a calibration a record of the site, packed by
        `rockpulse.calibration.site_part.pack_site_record`.
    failures : tuple of Failure
        A row for everything that failed; one for a task that broke off, and no part.
    messages : tuple of (int, str)
        Level and text of what was logged.
    seconds : dict of str to float
        Time of the steps "read", "condition", "solve", "pack" [s].
    """

    key: str
    fingerprint: str
    parts: tuple[bytes, ...] = ()
    failures: tuple[Failure, ...] = ()
    messages: tuple[tuple[int, str], ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)


def assess_task(task: Task, job: Job[Bodies]) -> Done:
    """Assess all bodies under the motions of a task.

    Parameters
    ----------
    task : Task
        From `rockpulse.batch.plan.plan`.
    job : Job
        Options and bodies.

    Returns
    -------
    Done
        Whatever goes wrong is a row in it.
    """

    def work(planned: PlannedMotion, watch: Watch) -> Iterator[RecordAssessment | Failure]:
        return assess_planned(planned, job.bodies, job.config, watch)

    def packed(assessment: RecordAssessment) -> bytes:
        return pack(record_part(assessment, job.bodies, job.config))

    return _carried_out(task, "assess", job.config, work, packed)


def calibrate_task(task: Task, job: Job[Block]) -> Done:
    """Calibrate the sequences of the motions of a task.

    Parameters
    ----------
    task : Task
        From `rockpulse.batch.plan.plan`.
    job : Job
        Options and blocks.

    Returns
    -------
    Done
        Whatever goes wrong is a row in it.
    """
    # With scipy.stats, which would take a third of the time that a worker takes to start; assess_task does without.
    from rockpulse.calibration.site_calibration import calibrate_planned
    from rockpulse.calibration.site_part import pack_site_record

    def work(planned: PlannedMotion, watch: Watch) -> Iterator[SiteRecord | Failure]:
        return calibrate_planned(planned, job.bodies, job.config, watch)

    return _carried_out(task, "calibrate", job.config, work, pack_site_record)


def _carried_out(
    task: Task,
    stage: str,
    config: Config,
    work: Callable[[PlannedMotion, Watch], Iterator[Result | Failure]],
    packed: Callable[[Result], bytes],
) -> Done:
    """What the work on the samples of a task yields, until it ends or an error ends it."""
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
            for outcome in work(planned, watch):
                if isinstance(outcome, Failure):
                    failures.append(outcome)
                else:
                    with watch("pack"):
                        parts.append(packed(outcome))
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
