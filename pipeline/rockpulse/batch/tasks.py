"""What a worker does: read the samples of a task, work on them, send back bytes and rows, never an exception."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import get_ident
from typing import TYPE_CHECKING, Generic, TypeVar

from rocking.block import Block
from rockpulse.assessment.assessment import RecordAssessment, Watch, assess_planned
from rockpulse.assessment.directions import PlannedMotion
from rockpulse.assessment.tree import record_part
from rockpulse.batch.journal import UNFINISHED, Done
from rockpulse.batch.packing import pack
from rockpulse.batch.plan import Task, read_options
from rockpulse.batch.survey import unexpected
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.errors import RockpulseError
from rockpulse.failures import Failure

if TYPE_CHECKING:
    from rockpulse.studies.site.record import SiteRecord

__all__ = ["Job", "assess_task", "calibrate_task"]

Acting = TypeVar("Acting", Bodies, Block)
Result = TypeVar("Result")

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
    from rockpulse.studies.site.calibration import calibrate_planned
    from rockpulse.studies.site.part import pack_site_record

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
