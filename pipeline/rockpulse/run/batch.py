"""Runs a batch from the paths of records to a results file, so that finished records are kept if it is stopped."""

import dataclasses
import logging
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, wait
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

from rocking.kernel_cache import logger as kernel_logger
from rocking.lanes import available_cores, thread_limit
from rockpulse.assessment.assessment import Assessment
from rockpulse.config.configuration import Config
from rockpulse.errors import Failure, RecordRefused, ResultsError, StoppedAtFailure, some
from rockpulse.readers.folders import Found, check_patterns, find_files
from rockpulse.run.analysis import Analysis
from rockpulse.run.assembly import JournalParts, write_results
from rockpulse.run.earlier_results import EarlierResults, check_appends, earlier_results, run_of, run_to_append
from rockpulse.run.frames import unpack
from rockpulse.run.journal import UNFINISHED, Journal, journal_path
from rockpulse.run.options import BatchOptions, BatchReport, Interrupted, quiet_bar
from rockpulse.run.survey import Located, gather_survey, survey_file
from rockpulse.run.tasks import (
    TakenFrom,
    Task,
    carry_out,
    compile_kernels,
    digest_of,
    log_again,
    read_options,
    tasks_of,
)
from rockpulse.run.worker_pool import WorkerLost, WorkerPool
from rockpulse.storage.hdf5.atomic import check_target, remove_parts

logger = logging.getLogger("rockpulse")
PathLike = str | os.PathLike[str]
Paths = PathLike | Iterable[PathLike]
Surveyed = tuple[list[Located], list[Failure], int]
#: Smallest number of files or records per process; fewer are left to this process, whose threads share the bodies.
ITEMS_PER_WORKER = 8
#: Time [s] after which a message says what the run waits for.
PATIENCE = 3.0
WAITING = "waiting for the kernels, which are compiled once per installation (about a minute)"


def assess_files(paths: Paths, config: Config, output: PathLike, options: BatchOptions | None = None) -> BatchReport:
    """Assess bodies under all records of files, folders and archives, and write the results.

    The results equal those of :func:`rockpulse.assess`, but only the samples of a few records are in memory at a
    time. Each finished record is kept in ``<output>.journal`` until the results are written.

    Parameters
    ----------
    paths : path or iterable of paths
        Files, folders, globs and zip archives, as :func:`rockpulse.read_all` takes them.
    config : Config
        Options and bodies.
    output : path
        The results file to write.
    options : BatchOptions, optional
        The workers, and whether an unfinished run is resumed or an existing file replaced.

    Returns
    -------
    BatchReport

    Raises
    ------
    ConfigError
        For invalid bodies or an invalid scheduler, a table of events that does not match the records, a pattern of
        ``config.records.files`` that matches no file, or, with ``options.append``, a file with other options, another
        program or records that are not among the given files.
    ResultsError
        If the output exists, cannot be written, or is being written by another process.
    StoppedAtFailure
        With ``options.strict``, at the first file or record that fails.
    Interrupted
        At Ctrl-C.

    Examples
    --------
    >>> rp.assess_files("records", config, "batch.h5", rp.BatchOptions(overwrite=True)).records
    5
    >>> rp.load("batch.h5").rockpulse
    <Results 5 records, 2 bodies, model nonlinear>
    """
    return _Batch(Assessment(config), output, options or BatchOptions()).run(paths)


def calibrate_files(paths: Paths, config: Config, output: PathLike, options: BatchOptions | None = None) -> BatchReport:
    """Derive the design spectrum of a site from all records of files, as :func:`rockpulse.calibrate`, and write it.

    Arguments, result and errors are as in :func:`assess_files`; a table of weights that does not match the records
    raises ConfigError, and records that give no design spectrum raise RecordRefused.

    >>> report = rp.calibrate_files("records", config, "design.h5", rp.BatchOptions(overwrite=True))
    >>> rp.load_design(report.path).restitution.tolist()
    [0.75, 0.8, 0.85, 0.9, 0.95, 1.0]
    """
    # Imports scipy.stats, which would add a third to the start time of a worker.
    from rockpulse.studies.site.calibration import SiteCalibration

    return _Batch(SiteCalibration(config), output, options or BatchOptions()).run(paths)


def fragility_files(paths: Paths, config: Config, output: PathLike, options: BatchOptions | None = None) -> BatchReport:
    """Fit fragility curves to all records of files, as :func:`rockpulse.fragility`, and write them.

    Arguments, result and errors are as in :func:`assess_files`.

    >>> options = rp.BatchOptions(overwrite=True)
    >>> rp.fragility_files("records/burst.2.AT2", config, "curves.h5", options).records
    1
    """
    from rockpulse.studies.fragility.fragility import FragilityAnalysis

    return _Batch(FragilityAnalysis(config), output, options or BatchOptions()).run(paths)


class _Batch:
    """One batch run with its journal and its tasks."""

    journal: Journal
    fingerprints: dict[str, str]  # of each task, by its key
    earlier: EarlierResults | None = None  # of the file to which the run appends
    kernels: Future[Any] | None = None  # of the worker that compiles or loads them

    def __init__(self, analysis: Analysis, output: PathLike, options: BatchOptions) -> None:
        self.analysis, self.output, self.options = analysis, output, options
        self.report, self.fingerprints = BatchReport(), {}

    def run(self, paths: Paths) -> BatchReport:
        """Run the whole batch, from reading the files to writing the results."""
        output, options = self.output, self.options
        # A resumed run may find the output file that it has written before it stopped.
        check_target(output, options.overwrite or options.resume or options.append, self.analysis.kind)
        appends = run_to_append(output, self.analysis, options.overwrite) if options.append else ""
        if options.scheduler is not None:  # the workers run in other folders
            given = [paths] if isinstance(paths, str | os.PathLike) else paths
            paths = [os.path.abspath(path) for path in given]  # noqa: PTH100 - links are not resolved
        found, rows = find_files(paths, (output, journal_path(output), *options.written))
        check_patterns(found, read_options(self.analysis.config))
        with Journal.open(output, options.resume, options.overwrite, appends) as journal, ExitStack() as resources:
            self.journal = journal
            remove_parts(output)  # temporary files of killed runs
            try:
                if self.worked(found, rows, resources):
                    return self.report
            except RecordRefused:  # the records give no design spectrum
                self.drop_empty_journal()
                raise
            except BaseException as error:
                left = self.kept(strict=isinstance(error, StoppedAtFailure))
                logger.error("%s; %s", str(error) or type(error).__name__, left)
                if isinstance(error, KeyboardInterrupt):
                    raise Interrupted(f"interrupted; {left}") from None
                silent = isinstance(error, ResultsError) and not error.tells_resume
                if silent or isinstance(error, StoppedAtFailure | ConnectionError):
                    raise type(error)(f"{error}\n{left}" if "\n" in str(error) else f"{error}; {left}") from error
                raise
            report = self.report
            if not report.records:
                self.drop_empty_journal()
            elif report.broken_off:
                many = "1 file or record" if report.broken_off == 1 else f"{report.broken_off} files or records"
                again = f"the same command with --resume tries them again, and uses the results in {journal.path}"
                self.log_and_tell(f"{many} could not be finished: {again}")
            else:
                journal.remove()
        report.path = Path(output) if report.records else None
        kinds = Counter(row.kind for row in report.failures)
        left_out = ", ".join(f"{kind} {count}" for kind, count in sorted(kinds.items())) or "nothing"
        written = f"{report.records} records" if report.records else "nothing was written"
        logger.info("%s: %s; left out: %s", output, written, left_out)
        return report

    def worked(self, found: list[Found], rows: Sequence[Failure], resources: ExitStack) -> bool:
        """Process the records and write the results file; return True if an earlier run has already written it."""
        analysis, output, options, journal = self.analysis, self.output, self.options, self.journal
        going_on = (options.resume or options.append) and not options.overwrite
        run_id, before = run_of(output) if going_on else ("", "")
        appending = bool(run_id and journal.appends) and run_id in (journal.appends, journal.run_id)
        if appending:
            check_appends(output, analysis.config, analysis.name)
        replace = options.overwrite or run_id == journal.run_id
        before = "" if replace else before
        check_target(output, replace or bool(before), analysis.kind)
        pool = self.pool_for(len(found), resources)
        every, rows, unread = self.surveyed(pool, found, rows)
        plan = analysis.plan([one.record for one in every], rows)
        read = [one.record.source for one in every] + [row.file for row in rows if row.kind != "failed"]
        # An assessment needs the planned records later only for a sweep; otherwise their list is emptied.
        swept = not isinstance(analysis, Assessment) or analysis.config.records.components == "sweep"
        planned = [*plan.planned] if swept else plan.planned
        tasks = tasks_of(planned, every, analysis.config, analysis.name)
        self.fingerprints = {task.key: task.fingerprint for task in tasks}
        if appending:
            self.earlier = earlier_results(output, analysis, tasks, read)
        del read
        for row in plan.failures:
            if row.kind == "failed":
                logger.error("%s", row.reason)
            if row.stage == "events":
                options.tell(row.reason)
        self.stop_at(plan.failures)
        asked = digest_of(tasks, plan.events, analysis.config, analysis.name)
        if before and (before == asked or not appending):  # the run that wrote the file has removed its journal
            check_target(output, before == asked, analysis.kind)
            journal.remove()
            options.tell(f"{output}: the run was already complete; nothing was left to do")
            self.report = BatchReport(Path(output), len(tasks), len(tasks), list(plan.failures))
            return True
        missing = self.missing(tasks)
        del tasks  # `missing` is emptied as the tasks are finished
        self.work(self.pool_for(len(missing), resources, pool), missing)
        self.report.failures = [*plan.failures, *self.report.failures]
        keys = self.finished()
        self.report.broken_off = unread + len(self.fingerprints) - len(keys)
        parts = JournalParts(journal, analysis, keys, plan.events, earlier=self.earlier)
        self.report.records = write_results(output, parts, plan, self.report.failures, replace or appending, asked)
        return False

    def pool_for(self, items: int, resources: ExitStack, before: WorkerPool | None = None) -> WorkerPool:
        """Return workers for a number of items: the earlier workers if they are enough, or new ones."""
        options = self.options
        if options.executor is not None:
            return before or resources.enter_context(WorkerPool.through(options.executor))
        if options.scheduler is not None:
            return before or resources.enter_context(WorkerPool.scheduler(options.scheduler))
        workers = self.analysis.config.run.workers if options.workers is None else options.workers
        if workers == "all":
            workers = max(1, min(available_cores(), items // ITEMS_PER_WORKER))
        elif workers == 1 and before is None:
            resources.enter_context(thread_limit(1))
        if before is not None and before.size >= int(workers):
            return before
        if workers == 1:
            return resources.enter_context(WorkerPool.inline())
        resources.close()  # ends the earlier workers
        pool = resources.enter_context(WorkerPool.local(int(workers)))
        compiles = partial(compile_kernels, config=self.analysis.config)
        self.kernels = pool.begin(compiles, type(self.analysis))
        return pool

    def surveyed(self, pool: WorkerPool, found: list[Found], failures: Sequence[Failure]) -> Surveyed:
        """Read all files and empty `found`; return channels, failures, and the number of files to read again."""
        look = partial(survey_file, options=read_options(self.analysis.config))
        located, rows, unread = list[Located](), list(failures), 0
        self.stop_at(rows)
        logger.info("reading %d files", len(found))
        with quiet_bar(self.options.bar, total=len(found), initial=0, desc="reading", unit=" files") as bar:
            for one, survey in pool.run(look, TakenFrom(found)):
                if isinstance(survey, WorkerLost):
                    rows.append(Failure(one.path, "read", f"{one.path}: {survey.reason}", "failed"))
                    unread += 1
                    self.stop_at(rows)
                else:
                    located += survey.located
                    rows += survey.failures
                    unread += survey.broken_off
                    log_again(survey.messages)
                    self.stop_at(survey.failures)
                bar.update(1)
        return *gather_survey(located, rows), unread

    def missing(self, tasks: Sequence[Task]) -> list[Task]:
        """Return the tasks without results; with `strict` raise StoppedAtFailure if a task failed in an earlier run."""
        journal, analysis, options = self.journal, self.analysis, self.options
        own, seen = set(self.finished()), journal.failures()

        def is_result(key: str, parts: Sequence[bytes]) -> bool:
            # a task of other records or options is kept
            return key not in own or ((bool(parts) or key in seen) and all(_is_part(part, analysis) for part in parts))

        damaged = journal.drop_damaged(is_result) if options.resume else []
        if damaged or journal.gaps:
            results = f"the results of {some(damaged, 5)}" if damaged else ""
            places = f"{journal.gaps} damaged part{'s' * (journal.gaps != 1)}" if journal.gaps else ""
            lost = " and ".join(filter(None, (results, places)))
            self.log_and_tell(f"{journal.path} is damaged: {lost} cannot be used; missing records are processed again")
        before, done = journal.finished(), self.finished()
        missing = [task for task in tasks if task.key not in done]
        resumed = self.report.resumed = len(done)
        stale = sum(before.get(task.key, UNFINISHED) != UNFINISHED for task in missing)
        logger.info(
            "%s %d records; finished before: %d, to be repeated: %d", analysis.doing, len(missing), resumed, stale
        )
        if self.earlier is not None:
            stale = self.earlier.stale
            again = f"; {stale} must be computed again, because they or the records compared with them have changed"
            kept = f"{len(self.earlier.rows)} of {len(tasks)} records are in {self.output} already"
            options.tell(f"{kept}{again if stale else ''}")
        elif options.resume:
            again = f"; {stale} are processed again, because they, the options or the version of rockpulse have changed"
            options.tell(f"{resumed} of {len(tasks)} records were finished before{again if stale else ''}")
        rows = journal.failures()
        for key in self.finished():
            self.stop_at(rows.get(key, ()))
        return missing

    def work(self, pool: WorkerPool, missing: list[Task]) -> None:
        """Execute the missing tasks and store their results; a task whose worker died becomes a row of /failures."""
        analysis, report = self.analysis, self.report
        work = partial(carry_out, work=analysis.work, stage=analysis.name, config=analysis.config)
        lost: dict[str, list[Failure]] = {}
        if missing and self.kernels is not None:
            self.wait_for_kernels(pool, self.kernels)
        counts = {"total": len(self.fingerprints), "initial": report.resumed, "unit": " records"}
        with quiet_bar(self.options.bar, desc=analysis.doing, **counts) as bar:
            for task, done in pool.run(work, TakenFrom(missing)):
                if isinstance(done, WorkerLost):
                    reason = f"{task.key}: {done.reason}, at every attempt; if memory ran out, use fewer workers"
                    lost[task.key] = [Failure(task.source, analysis.name, reason, "failed")]
                    logger.error("%s", reason)
                    self.stop_at(lost[task.key])
                else:  # the texts of the task are in memory already
                    own = done.fingerprint and task.fingerprint  # UNFINISHED is empty
                    self.journal.add(dataclasses.replace(done, key=task.key, fingerprint=own))
                    log_again(done.messages)
                    for step, taken in done.seconds.items():
                        report.seconds[step] = report.seconds.get(step, 0.0) + taken
                    self.stop_at(done.failures)
                bar.update(1)
        rows = self.journal.failures() | lost
        report.failures = [row for key in self.fingerprints for row in rows.get(key, ())]

    def wait_for_kernels(self, pool: WorkerPool, kernels: Future[Any]) -> None:
        """Wait until one worker has compiled or loaded the kernels; the other workers then load them."""
        if not wait([kernels], PATIENCE).done:
            kernel_logger.info(WAITING)
        messages = pool.result_of(kernels)
        if isinstance(messages, WorkerLost):
            self.log_and_tell(f"compiling the kernels: {messages.reason}; each worker now compiles them")
        else:
            log_again(messages)

    def finished(self) -> dict[str, str]:
        """Return the fingerprints, by key, of tasks whose results for the same files and options are stored."""
        before, kept = self.journal.finished(), () if self.earlier is None else self.earlier.rows
        return {
            key: fingerprint
            for key, fingerprint in self.fingerprints.items()
            if key in kept or before.get(key) == fingerprint
        }

    def kept(self, strict: bool = False) -> str:
        """Return a message on how many finished records are kept and where; remove the journal if there are none."""
        journal, every = self.journal, self.journal.complete
        if not journal.is_current:
            return f"nothing is kept, because {journal.path} was removed during the run"
        if not every:
            journal.remove()
            return "nothing was finished yet"
        count = len(every.intersection(self.finished())) if self.fingerprints else len(every)
        if not count:
            others = f"{journal.path} keeps {len(every)} records from runs with other files or options"
            return f"nothing of this run was finished yet; {others}"
        are = f"{count} finished {'record is' if count == 1 else 'records are'}"
        past = ", and without --strict it goes on after this failure" if strict else ""
        return f"{are} kept in {journal.path}: the same command with --resume continues from there{past}"

    def drop_empty_journal(self) -> None:
        """Remove the journal of a run that writes no file, unless the journal contains other records."""
        others = self.journal.complete - self.fingerprints.keys()
        if others:
            are = f"{self.journal.path} keeps {len(others)} finished records of other files"
            self.log_and_tell(f"{are}: to continue with them, give --resume and their paths")
        elif 0 < len(self.finished()) < len(self.fingerprints):
            self.log_and_tell(self.kept())
        else:
            self.journal.remove()

    def log_and_tell(self, text: str) -> None:
        """Write a message to the log and show it to the user."""
        logger.warning("%s", text)
        self.options.tell(text)

    def stop_at(self, failures: Iterable[Failure]) -> None:
        """With the option `strict`, raise StoppedAtFailure if a row reports a failed file or record."""
        failed = [row for row in failures if row.kind == "failed"] if self.options.strict else []
        if failed:
            raise StoppedAtFailure(f"stopped at the first failure (--strict): {failed[0].reason}")


def _is_part(packed: bytes, analysis: Analysis) -> bool:  # bytes with a correct checksum may come from another program
    try:
        return analysis.fits(unpack(packed))
    except (ValueError, TypeError, RecursionError):
        return False
