"""A batch from paths to its file: survey, plan, work, assembly; what is finished stays finished, whatever happens."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rocking.threads import available_cores, thread_limit
from rockpulse.assessment.assessment import Assessment
from rockpulse.batch.assembly import JournalParts, is_assembled, run_digest, write_results
from rockpulse.batch.crew import Crew, WorkerLost
from rockpulse.batch.journal import UNFINISHED, Journal, journal_path
from rockpulse.batch.kept import finished, kept, worth
from rockpulse.batch.located import Located
from rockpulse.batch.options import BatchOptions
from rockpulse.batch.packing import unpack
from rockpulse.batch.plan import Task, digest_of, read_options, tasks_of
from rockpulse.batch.survey import gather, survey_file
from rockpulse.batch.tasks import carry_out
from rockpulse.batch.warm import warm_up
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused, ResultsError, StoppedAtFailure
from rockpulse.failures import Failure, some
from rockpulse.motions.runner import Analysis
from rockpulse.readers.folders import Found, check_patterns, find_files
from rockpulse.storage.hdf5.atomic import check_target, remove_parts

__all__ = ["BatchReport", "Interrupted", "assess_files", "calibrate_files", "fragility_files"]

logger = logging.getLogger("rockpulse")

PathLike = str | os.PathLike[str]

#: Files or records that make one more process worth its start; below, the threads of this one share the bodies of each.
ITEMS_PER_WORKER = 8


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a batch; the message says what is kept and how to go on."""


@dataclass
class BatchReport:
    """The outcome of a batch.

    Attributes
    ----------
    path : Path or None
        The file that was written; None where not one record gave a result.
    records : int
        Motions in it.
    resumed : int
        Tasks that an earlier run had finished.
    failures : list of Failure
        The rows of /failures.
    broken_off : int
        Files and records among them that were left undone and are tried again by a run that resumes this one.
    seconds : dict of str to float
        Time that all workers together have spent on each step [s]: "read", "condition", "solve", "pack".
    """

    path: Path | None = None
    records: int = 0
    resumed: int = 0
    failures: list[Failure] = field(default_factory=list)
    broken_off: int = 0
    seconds: dict[str, float] = field(default_factory=dict)


def assess_files(
    paths: PathLike | Iterable[PathLike], config: Config, output: PathLike, options: BatchOptions | None = None
) -> BatchReport:
    """Assess bodies under all records of some files, and write the results.

    The results are those of :func:`rockpulse.assess` on all records of the paths, but samples and answers of a few
    records only are in memory at a time, and each finished record is on the disk, in ``<output>.journal``, before
    others are waited for.

    Parameters
    ----------
    paths : path or iterable of paths
        Files, folders, globs and zip archives, as `rockpulse.readers.folders.read_all` takes them.
    config : Config
        Options and bodies.
    output : path
        The results file to write.
    options : BatchOptions, optional
        The workers, and the fate of a file that exists already.

    Returns
    -------
    BatchReport

    Raises
    ------
    ConfigError
        For bodies or a scheduler that cannot be, a table of events that does not fit, or a pattern of
        ``config.records.files`` that chooses no file.
    ResultsError
        Where the output exists, cannot be written, or another process is writing it.
    StoppedAtFailure
        With ``options.strict``, at the first file or record that fails.
    Interrupted
        At Ctrl-C.
    """
    return _run(Assessment(config), paths, output, options or BatchOptions())


def calibrate_files(
    paths: PathLike | Iterable[PathLike], config: Config, output: PathLike, options: BatchOptions | None = None
) -> BatchReport:
    """Calibrate the design sequence of a site on all records of some files, and write the site file.

    The site is that of :func:`rockpulse.calibrate_site` on all records of the paths.

    Parameters
    ----------
    paths, config, output, options
        As for :func:`assess_files`.

    Returns
    -------
    BatchReport

    Raises
    ------
    ConfigError, ResultsError, StoppedAtFailure, Interrupted
        As :func:`assess_files`; ConfigError also for tables of events or weights that do not fit.
    RecordRefused
        As :func:`rockpulse.calibrate_site`.
    """
    # With scipy.stats, which would take a third of the time that a worker of an assessment takes to start.
    from rockpulse.studies.site.calibration import SiteCalibration

    return _run(SiteCalibration(config), paths, output, options or BatchOptions())


def fragility_files(
    paths: PathLike | Iterable[PathLike], config: Config, output: PathLike, options: BatchOptions | None = None
) -> BatchReport:
    """Fit fragility curves to the capacities of bodies under all records of some files, and write the fragility file.

    The curves are those of :func:`rockpulse.fragility_curves` on all records of the paths.

    Parameters
    ----------
    paths, config, output, options
        As for :func:`assess_files`.

    Returns
    -------
    BatchReport

    Raises
    ------
    ConfigError, ResultsError, StoppedAtFailure, Interrupted
        As :func:`assess_files`.
    """
    from rockpulse.studies.fragility.assessment import FragilityAnalysis

    return _run(FragilityAnalysis(config), paths, output, options or BatchOptions())


def _run(
    analysis: Analysis, paths: PathLike | Iterable[PathLike], output: PathLike, options: BatchOptions
) -> BatchReport:
    # A run that is resumed may find its own file there, even one that is finished.
    check_target(output, options.overwrite or options.resume, analysis.kind)
    if options.scheduler is not None:  # its workers stand in folders of their own
        given = [paths] if isinstance(paths, str | os.PathLike) else paths
        paths = [os.path.abspath(path) for path in given]  # noqa: PTH100 - links stay what they are
    journal_file = journal_path(output)
    found, failures = find_files(paths, (output, journal_file, *options.written))
    check_patterns(found, analysis.config.records.files)
    with Journal.open(output, options.resume, options.overwrite) as journal, ExitStack() as hired:
        remove_parts(output)  # of runs that were killed
        tasks: list[Task] = []
        try:
            replace = options.overwrite or (options.resume and is_assembled(output, journal.run_id))
            before = "" if replace or not options.resume else run_digest(output)
            check_target(output, replace or bool(before), analysis.kind)
            crew = _hired(hired, options, analysis, len(found))
            every, failures, unread = _surveyed(crew, found, failures, analysis, options)
            prepared = analysis.prepare([one.record for one in every], failures)
            tasks = tasks_of(prepared.planned, every, analysis.config, analysis.name)
            del every, found  # the tasks have all of it, and a batch is large
            for row in prepared.failures:
                if row.kind == "failed":
                    logger.error("%s", row.reason)
                if row.stage == "events":
                    options.tell(row.reason)
            _stop_at(prepared.failures, options)
            asked = digest_of(tasks, prepared.events, analysis.config, analysis.name)
            if before:  # the run that wrote the file has left no journal
                check_target(output, before == asked, analysis.kind)
                journal.remove()
                options.tell(f"{output}: the run had ended before, nothing was left to do")
                return BatchReport(Path(output), len(tasks), len(tasks), list(prepared.failures))
            missing = _missing(journal, tasks, analysis, options)
            crew = _hired(hired, options, analysis, len(missing), crew)
            report = _worked(crew, journal, tasks, missing, analysis, options)
            report.failures = [*prepared.failures, *report.failures]
            keys = finished(journal, tasks)
            report.broken_off = unread + len(tasks) - len(keys)
            parts = JournalParts(journal, analysis, keys, prepared.events)
            report.records = write_results(output, parts, prepared, report.failures, replace, asked)
        except RecordRefused:  # the records make no site
            _without_output(journal, tasks, options)
            raise
        except BaseException as error:
            left = kept(journal, tasks, strict=isinstance(error, StoppedAtFailure))
            logger.error("%s; %s", str(error) or type(error).__name__, left)
            if isinstance(error, KeyboardInterrupt):
                raise Interrupted(f"interrupted; {left}") from None
            silent = isinstance(error, ResultsError) and not error.tells_resume
            if silent or isinstance(error, StoppedAtFailure | ConnectionError):
                raise type(error)(f"{error}; {left}") from error
            raise
        if not report.records:
            _without_output(journal, tasks, options)
        elif report.broken_off:
            again = f"the same command with --resume tries them again, for which {journal.path} is kept"
            _tell_all(f"{_counted(report.broken_off)} broke off: {again}", options)
        else:
            journal.remove()
    report.path = Path(output) if report.records else None
    kinds = Counter(row.kind for row in report.failures)
    left_out = ", ".join(f"{kind} {count}" for kind, count in sorted(kinds.items())) or "nothing"
    written = f"{report.records} records" if report.records else "nothing was written"
    logger.info("%s: %s; left out: %s", output, written, left_out)
    return report


def _counted(broken_off: int) -> str:
    return "1 file or record" if broken_off == 1 else f"{broken_off} files or records"


def _without_output(journal: Journal, tasks: Sequence[Task], options: BatchOptions) -> None:
    """Leave a journal whose records give nothing to write: removed, unless some are of other files or broke off."""
    others = worth(journal) - {task.key for task in tasks}
    if others:
        are = f"{journal.path} keeps {len(others)} finished records of other files"
        _tell_all(f"{are}: give --resume with the paths of these", options)
    elif 0 < len(finished(journal, tasks)) < len(tasks):
        _tell_all(kept(journal, tasks), options)
    else:
        journal.remove()


def _tell_all(text: str, options: BatchOptions) -> None:
    logger.warning("%s", text)
    options.tell(text)


def _hired(hired: ExitStack, options: BatchOptions, analysis: Analysis, items: int, before: Crew | None = None) -> Crew:
    """Workers for so many items, with kernels that are compiled; those `before` stay where they are enough."""
    if options.executor is not None:
        return before or hired.enter_context(Crew.through(options.executor))
    if options.scheduler is not None:
        return before or hired.enter_context(Crew.scheduler(options.scheduler))
    workers = analysis.config.run.workers if options.workers is None else options.workers
    if workers == "all":
        workers = max(1, min(available_cores(), items // ITEMS_PER_WORKER))
    elif workers == 1 and before is None:
        hired.enter_context(thread_limit(1))
    if before is not None and before.size >= int(workers):
        return before
    if workers == 1:
        return hired.enter_context(Crew.inline())
    hired.close()  # of those before
    warm_up(analysis)  # once, here, not once in every worker
    return hired.enter_context(Crew.local(int(workers)))


def _surveyed(
    crew: Crew, found: Sequence[Found], failures: Sequence[Failure], analysis: Analysis, options: BatchOptions
) -> tuple[list[Located], list[Failure], int]:
    """All channels without their samples, what was left out, and how much of that may be read another time."""
    look = partial(survey_file, options=read_options(analysis.config))
    surveys, rows, unread = [], list(failures), 0
    _stop_at(rows, options)
    logger.info("reading %d files", len(found))
    with options.bar(total=len(found), initial=0, desc="reading", unit=" files") as bar:
        for one, survey in crew.run(look, found):
            if isinstance(survey, WorkerLost):
                rows.append(Failure(str(one.path), "read", f"{one.path}: {survey.reason}", "failed"))
                unread += 1
                _stop_at(rows, options)
            else:
                surveys.append((one, survey))
                unread += survey.broken_off
                _log(survey.messages)
                _stop_at(survey.failures, options)
            bar.update(1)
    return *gather(found, surveys, rows), unread


def _missing(journal: Journal, tasks: Sequence[Task], analysis: Analysis, options: BatchOptions) -> list[Task]:
    """The tasks that are to be done; what was refused before is a failure to stop at like any other."""
    own, told = set(finished(journal, tasks)), journal.failures()

    def is_result(key: str, parts: Sequence[bytes]) -> bool:
        """Whether something is kept of a task, and its parts are of this analysis; others may be of other options."""
        return key not in own or ((bool(parts) or key in told) and all(_is_part(part, analysis) for part in parts))

    damaged = journal.drop_damaged(is_result) if options.resume else []
    if damaged or journal.gaps:
        results = f"the results of {some(damaged, 5)}" if damaged else ""
        places = f"what stood in {journal.gaps} place{'s' * (journal.gaps != 1)}" if journal.gaps else ""
        lost = " and ".join(filter(None, (results, places)))
        _tell_all(f"{journal.path} is damaged: {lost} cannot be used; what is missing is done again", options)
    before = journal.finished()
    missing = [task for task in tasks if before.get(task.key) != task.fingerprint]
    resumed = len(tasks) - len(missing)
    stale = sum(before.get(task.key, UNFINISHED) != UNFINISHED for task in missing)
    logger.info(
        "%s %d records; finished before: %d, of another state: %d", analysis.doing, len(missing), resumed, stale
    )
    if options.resume:
        again = f"; {stale} are done again, for they, the options or the version of rockpulse have changed"
        options.tell(f"{resumed} of {len(tasks)} records were finished before{again if stale else ''}")
    rows = journal.failures()
    for key in finished(journal, tasks):
        _stop_at(rows.get(key, ()), options)
    return missing


def _is_part(packed: bytes, analysis: Analysis) -> bool:
    """Whether bytes of a journal are what an analysis keeps there; anybody can write others with a right checksum."""
    try:
        return analysis.fits(unpack(packed))
    except (ValueError, TypeError, RecursionError):
        return False


def _worked(
    crew: Crew,
    journal: Journal,
    tasks: Sequence[Task],
    missing: Sequence[Task],
    analysis: Analysis,
    options: BatchOptions,
) -> BatchReport:
    """Every missing task, into the journal; a task whose worker is lost is a row of its own."""
    work = partial(carry_out, work=analysis.work, stage=analysis.name, config=analysis.config)
    report = BatchReport(resumed=len(tasks) - len(missing))
    lost: dict[str, Failure] = {}
    with options.bar(total=len(tasks), initial=report.resumed, desc=analysis.doing, unit=" records") as bar:
        for task, done in crew.run(work, missing):
            if isinstance(done, WorkerLost):
                reason = f"{task.key}: {done.reason}, each time it was tried; if memory ran out, use fewer workers"
                lost[task.key] = Failure(task.source, analysis.name, reason, "failed")
                logger.error("%s", reason)
                _stop_at([lost[task.key]], options)
            else:
                journal.add(done)
                _log(done.messages)
                for step, seconds in done.seconds.items():
                    report.seconds[step] = report.seconds.get(step, 0.0) + seconds
                _stop_at(done.failures, options)
            bar.update(1)
    rows = {key: list(failures) for key, failures in journal.failures().items()}
    rows |= {key: [failure] for key, failure in lost.items()}
    report.failures = [row for task in tasks for row in rows.get(task.key, ())]
    return report


def _stop_at(failures: Iterable[Failure], options: BatchOptions) -> None:
    failed = [row for row in failures if row.kind == "failed"] if options.strict else []
    if failed:
        raise StoppedAtFailure(f"stopped at the first failure (--strict): {failed[0].reason}")


def _log(messages: Iterable[tuple[int, str]]) -> None:
    for level, text in messages:
        logger.log(level, text)
