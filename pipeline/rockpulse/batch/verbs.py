"""What assessing and calibrating do differently in a batch."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, ClassVar, Protocol

from rockpulse.assessment.events import event_table, events_by_id
from rockpulse.assessment.tree import template
from rockpulse.batch.assembly import RUN_ID, JournalParts, assemble
from rockpulse.batch.journal import Journal
from rockpulse.batch.kept import finished
from rockpulse.batch.located import Located
from rockpulse.batch.plan import Plan, Task
from rockpulse.batch.tasks import Done, Job, assess_task, calibrate_task
from rockpulse.config.bodies import Bodies, gather_bodies
from rockpulse.config.configuration import Config
from rockpulse.failures import Failure
from rockpulse.storage.save_load import ASSESSMENT, save
from rockpulse.storage.site_variables import SITE_KIND

if TYPE_CHECKING:
    from rockpulse.studies.site.calibration import SiteStudy

__all__ = ["Assessment", "Calibration", "Verb"]

logger = logging.getLogger("rockpulse")

PathLike = str | os.PathLike[str]


class Verb(Protocol):
    """What assessing and calibrating do differently."""

    name: ClassVar[str]
    doing: ClassVar[str]
    kind: ClassVar[str]
    config: Config
    output: PathLike

    def work(self, every: Sequence[Located], made: Plan) -> Callable[[Task], Done]:
        """What a worker does with a task."""

    def write(self, journal: Journal, made: Plan, failures: list[Failure], overwrite: bool) -> int:
        """Write the file; the number of motions in it, none where nothing was written."""


class Assessment:
    """Bodies under all records.

    Parameters
    ----------
    config, output
        As `rockpulse.assess_files` takes them.
    tell : callable
        Called with what the user should know before it is all over.

    Raises
    ------
    ConfigError, OSError
        For bodies that cannot be, or a table of events that is none.
    """

    name: ClassVar[str] = "assess"
    doing: ClassVar[str] = "assessing"
    kind: ClassVar[str] = ASSESSMENT

    def __init__(self, config: Config, output: PathLike, tell: Callable[[str], object]) -> None:
        self.config, self.output, self.tell = config, output, tell
        self.bodies: Bodies = gather_bodies(config.blocks)  # refused before the records are read, and so is the table
        self.named = event_table(config)
        self.events: dict[str, str] = {}
        for name, warning in zip(self.bodies.names, self.bodies.warnings, strict=True):
            if warning:
                logger.warning("block %s: %s", name, warning)

    def work(self, every: Sequence[Located], made: Plan) -> Callable[[Task], Done]:
        """Assess all bodies; a table of events that does not fit is refused before."""
        events, unread = events_by_id([one.record for one in every], self.named, made.failures)
        self.events = {task.key: events[task.channels[0].record.id] for task in made.tasks}
        made.failures.extend(unread)
        for row in unread:
            logger.error("%s", row.reason)
            self.tell(row.reason)
        return partial(assess_task, job=Job(self.config, self.bodies))

    def write(self, journal: Journal, made: Plan, failures: list[Failure], overwrite: bool) -> int:
        """Put the parts of the journal together."""
        parts = JournalParts(journal, finished(journal, made), self.events)
        if not any(True for _ in parts):
            return 0
        empty = template(self.bodies, self.config)
        return assemble(self.output, empty, parts, failures, made.swept, overwrite, journal.run_id)


class Calibration:
    """The design sequence of a site.

    Parameters
    ----------
    config, output
        As `rockpulse.calibrate_files` takes them.

    Raises
    ------
    ConfigError, OSError
        For bodies that cannot be, or a table of events that is none.
    """

    name: ClassVar[str] = "calibrate"
    doing: ClassVar[str] = "calibrating"
    kind: ClassVar[str] = SITE_KIND

    def __init__(self, config: Config, output: PathLike) -> None:
        self.config, self.output = config, output
        if config.blocks:
            gather_bodies(config.blocks)  # refused before the records are read, and so is the table
        event_table(config)
        self.study: SiteStudy | None = None

    def work(self, every: Sequence[Located], made: Plan) -> Callable[[Task], Done]:
        """Calibrate the sequence; tables that do not fit are refused before."""
        from rockpulse.studies.site.calibration import prepare_site

        records = sorted((one.record for one in every), key=lambda record: record.id)
        self.study = prepare_site(records, made.planned, self.config, failures=made.failures)
        return partial(calibrate_task, job=Job(self.config, self.study.lanes))

    def write(self, journal: Journal, made: Plan, failures: list[Failure], overwrite: bool) -> int:
        """Describe the site."""
        from rockpulse.studies.site.calibration import site_results
        from rockpulse.studies.site.part import unpack_site_record

        assert self.study is not None
        done = [unpack_site_record(part) for key in finished(journal, made) for part in journal.parts(key)]
        tree = site_results(done, self.study, self.config, failures)
        tree.attrs[RUN_ID] = journal.run_id
        save(tree, self.output, overwrite)
        return len(done)
