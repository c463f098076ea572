"""Analyses a set of records in this process: plans the work, processes each record, and collects the results."""

import logging
import os
from abc import ABC, abstractmethod
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeAlias, cast

import numpy as np
import xarray as xr

from rockpulse.config.bodies import Blocks
from rockpulse.config.configuration import Config
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure, RecordRefused, TooWeak, some
from rockpulse.readers.folders import read_all
from rockpulse.record.record import Record
from rockpulse.selection.directions import (
    Motion,
    PlannedMotion,
    VerticalRefused,
    conditioned_motions,
    plan_motions,
    unconfirmed_channels,
)
from rockpulse.selection.duplicate_selection import unmatched_patterns, without_duplicates
from rockpulse.selection.events import event_table, events_by_id
from rockpulse.selection.twins import clock_twin

__all__ = ["Analysis", "Blocks", "Part", "Plan", "Records", "Watch", "Work", "joined", "run", "selected", "worked"]
logger = logging.getLogger("rockpulse")
#: Input of an analysis: channels, or the files, folders, globs and zip archives to read them from.
Records: TypeAlias = str | os.PathLike[str] | Record | Iterable[str | os.PathLike[str]] | Iterable[Record]
#: The arrays that one record adds to the results, by variable; their first dimension grows with the records.
Part = Mapping[str, np.ndarray]
#: Function that measures the time of a named step: ``with watch("solve"): ...``
Watch = Callable[[str], AbstractContextManager[Any]]
#: Function that computes the part of a record; a ValueError that it raises becomes a row of /failures.
Work = Callable[[Motion, Watch], Part]


@dataclass(frozen=True, eq=False)
class Plan:
    """The records to be processed, the earthquake of each, and the failures of records that are left out."""

    planned: list[PlannedMotion]  # in the order of the results
    events: dict[str, str]  # earthquake by id of the record
    failures: list[Failure]  # rows of /failures of the records that are left out


class Analysis(ABC):
    """Base class of an analysis: it computes a part of the results for every record, and combines the parts."""

    name: ClassVar[str]  # name of the command, and stage of its failures in /failures
    doing: ClassVar[str]  # what a progress bar says, such as "assessing"
    kind: ClassVar[str]  # kind of the results, an attribute of their root
    in_order_of_ids: ClassVar[bool] = True  # whether the records are sorted by id
    event_name: ClassVar[str] = "event"  # variable of a part with the earthquake of its record

    def __init__(self, config: Config, bodies: Blocks | None = None) -> None:
        self.config = config
        self.named_events: dict[str, str] = event_table(config)

    @property
    @abstractmethod
    def work(self) -> Work:
        """Return the function that computes the part of the results for one record; it can be pickled."""

    @property
    @abstractmethod
    def empty_part(self) -> Part:
        """Return arrays with no rows that have the names, types and other dimensions of the arrays of a part."""

    @abstractmethod
    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Return the tree of results made from the parts of all records; the parts are in the order of the plan."""

    def described(self, tree: xr.DataTree, title: str) -> xr.DataTree:
        """Return the tree with title, site and configuration as attributes; `title` is used if the site has no name."""
        site = self.config.site
        tree.attrs |= {"kind": self.kind, "title": site.name or title, "site_description": site.description}
        tree.attrs["configuration"] = self.config.as_text()
        return tree

    def plan(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Plan:
        """Return the records to process and their earthquakes; ConfigError for equal ids or an invalid table."""
        every = sorted(records, key=lambda record: record.id) if self.in_order_of_ids else list(records)
        twice = sorted(name for name, times in Counter(record.id for record in every).items() if times > 1)
        if twice:
            raise ConfigError(f"records: expected different ids, found more than one record with id {', '.join(twice)}")
        rows = list(failures)
        event_of, unread = events_by_id(every, self.named_events, rows)
        unmatched = unmatched_patterns(
            "[records] confirm", self.config.records.confirm, [record.id for record in every], rows
        )
        selected, duplicates, twins = without_duplicates(every, self.config.records, rows)
        planned, left_out = plan_motions(selected, self.config, twins)
        events = {one.name: event_of[one.channels[0].id] for one in planned}
        return Plan(planned, events, [*rows, *unread, *unmatched, *duplicates, *left_out])

    def dimension_of(self, name: str) -> str:
        """Return the dimension along which the arrays of a variable are joined over the records."""
        return "record"

    def fits(self, part: Part) -> bool:
        """Return whether a part has the names, types and shapes of the parts of this analysis."""
        expected = {name: array for name, array in self.empty_part.items() if name != self.event_name}
        if part.keys() != expected.keys():
            return False
        lengths: dict[str, set[int]] = defaultdict(set)
        for name, empty in expected.items():
            found = part[name]
            alike = (found.dtype.kind == "U") == (empty.dtype.kind == "U")
            alike = alike and np.can_cast(found.dtype, empty.dtype, "same_kind")
            if not alike or found.ndim != empty.ndim or found.shape[1:] != empty.shape[1:]:
                return False
            lengths[self.dimension_of(name)].add(len(found))
        return all(len(every) == 1 for every in lengths.values())

    def of_event(self, part: Part, event: str) -> Part:
        """Return the part with one more variable, which contains the earthquake `event` of its record."""
        rows = len(part["record"]) if "record" in part else 1
        return {**part, self.event_name: np.array([event] * rows)}


def selected(plan: Plan, table: Collection[str], of_motion: Mapping[str, Sequence[str]], where: str) -> Plan:
    """Return the plan reduced to the records listed in a table; `of_motion` lists the ids accepted for each record.

    Raises ConfigError if the table names an unknown record and all files were read.
    """
    known = [name for names in of_motion.values() for name in names]
    idle = unmatched_patterns(where, [*table], known, plan.failures)
    kept = [one for one in plan.planned if not set(table).isdisjoint(of_motion[one.name])]
    rows = [*plan.failures, *idle]
    if unchosen := sorted(of_motion.keys() - {one.name for one in kept}):
        reason = f"{len(unchosen)} of {len(of_motion)} records or pairs are not in the table: {some(unchosen, 3)}"
        rows.append(Failure(where, "select", reason, "skipped"))
    return replace(plan, planned=kept, failures=rows)


def run(
    analysis: Analysis,
    records: Records,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
) -> xr.DataTree:
    """Run an analysis in this process; `progress` wraps the list of records to process, as ``tqdm.tqdm`` does."""
    plan = analysis.plan(*_given(records, failures, analysis.config.records))
    rows, parts = list(plan.failures), []
    for one in plan.planned if progress is None else progress(plan.planned):
        for outcome in worked(one, analysis.work, analysis.name, analysis.config):
            if isinstance(outcome, Failure):
                rows.append(outcome)
            else:
                parts.append(analysis.of_event(outcome, plan.events[one.name]))
    return analysis.collect(parts, plan.planned, rows)


def _given(
    records: Records, failures: Iterable[Failure], options: RecordSettings
) -> tuple[list[Record], list[Failure]]:
    """Return the given records, or the records read from the given paths, with all failures."""
    one = isinstance(records, (str, os.PathLike, Record))
    every: list[Any] = [records] if one else list(cast(Iterable[Any], records))
    if every and all(isinstance(item, (str, os.PathLike)) for item in every):
        found, unread = read_all(every, options.units, None, options.dt, options.response, options.files, options.pairs)
        if not found:
            reasons = "; ".join(f"{row.reason}" for row in unread[:3])
            raise RecordRefused(f"records: no record in {', '.join(map(str, every))}{': ' * bool(reasons)}{reasons}")
        return found, [*failures, *unread]
    for item in every:
        if not isinstance(item, Record):
            raise ConfigError(
                f"records: expected paths or Records as rockpulse.read returns them, but not both, found {item!r:.80}"
            )
    return every, list(failures)


def worked(
    planned: PlannedMotion, work: Work, stage: str, config: Config, watch: Watch = nullcontext
) -> Iterator[Part | Failure]:
    """Process a channel or pair; yield a part for each record made from it, or a failure for each unused channel."""
    try:
        with watch("condition"):
            copies = clock_twin(planned.channels, planned.comparisons, config.records.confirm)
            if copies:
                yield from copies
                return
            motions = conditioned_motions(planned, config)
    except VerticalRefused as error:
        refused = [channel for channel in (planned.vertical, *planned.channels) if channel is not None]
        logger.error("%s", error)
        yield from (Failure(channel.source, stage, f"{channel.id}: {error}", "failed") for channel in refused)
        return
    except ValueError as error:
        if not planned.rotated:
            yield _failure(planned.channels[0], stage, error)
            return
        logger.error("%s: %s", planned.name, error)
        yield from (Failure(channel.source, "rotate", str(error), "failed") for channel in planned.channels)
        return
    with watch("condition"):
        doubtful = unconfirmed_channels(planned, motions, config, stage)
    if doubtful:
        yield from doubtful
        return
    for motion in motions:
        try:
            part = work(motion, watch)
        except ValueError as error:  # RockpulseError, and errors of models for invalid numbers
            yield _failure(motion.record, stage, error)
        else:
            yield part


def _failure(record: Record, stage: str, error: Exception) -> Failure:
    weak = isinstance(error, TooWeak)
    reason = str(error) if record.id in str(error) else f"{record.id}: {error}"
    logger.log(logging.WARNING if weak else logging.ERROR, "%s", reason)
    return Failure(file=record.source, stage=stage, reason=reason, kind="skipped" if weak else "failed")


def joined(parts: Sequence[Part]) -> dict[str, np.ndarray]:
    """Join the arrays of all parts; the rows are sorted by the variable "record"."""
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    order = np.argsort(whole["record"], kind="stable")
    return {name: values[order] for name, values in whole.items()}
