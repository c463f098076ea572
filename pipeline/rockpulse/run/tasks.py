"""The tasks of a batch, one for each channel or pair of channels: planned without samples, executed by workers."""

import hashlib
import logging
import pickle
import time
import traceback
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import asdict, dataclass, fields, replace
from functools import lru_cache
from itertools import chain
from operator import attrgetter
from pathlib import Path
from threading import get_ident
from typing import Any, TypeVar

import numpy as np

import rocking
from rocking.body.block import Block
from rocking.kernel_cache import logger as kernel_logger
from rocking.march.demand import ground_demand
from rockpulse.config.configuration import SECTIONS, Config, located
from rockpulse.config.settings import CalibrationSettings
from rockpulse.errors import Failure, RockpulseError
from rockpulse.readers import ReadOptions
from rockpulse.record.record import BETWEEN, Record, id_matches
from rockpulse.run.analysis import Analysis, Work, worked
from rockpulse.run.frames import pack
from rockpulse.run.journal import UNFINISHED, Done, Message
from rockpulse.run.survey import Located, SamplesLocation, unexpected_fault
from rockpulse.selection.directions import PlannedMotion, conditioned_motions
from rockpulse.selection.tables import demand_selections, selection_of
from rockpulse.storage.hdf5.results_file import SCHEMA_VERSION
from rockpulse.version import __version__

Item = TypeVar("Item")
#: For each command, the sections of the configuration that do not affect the numbers of a record.
IDLE = {
    "assess": {"site", "report", "calibration", "selection", "fragility", "hazard", "check"},
    "calibrate": {"site", "report", "models", "search", "uncertainty", "selection", "fragility", "hazard", "check"},
    "fragility": {"site", "report", "models", "uncertainty", "calibration", "selection", "hazard", "check"},
}

#: Keys of [calibration] and of [fragility] that affect only the statistics at the end of a run.
LATE = ("weights", "quantile", "confidence", "bootstrap")
OF_FITS = ("model", "overturning_model", "confidence")
#: Keys of [records] that are part of the fingerprint of each task, or affect no numbers.
OF_TASKS = ("paths", "events", "keep", "units", "dt", "files", "pairs", "confirm")


@dataclass(frozen=True, eq=False, slots=True)
class Task:
    """A channel, or a pair of channels to be rotated, without samples; compressed, it needs a fifth of its memory."""

    key: str  # id of the channel or name of the pair, equal in every run on the same files
    fingerprint: str  # SHA-256 of samples, metadata, configuration and version
    content: bytes  # plan of the channels, and locations of the samples by id of the record
    pattern: bytes  # dictionary of the compression; all tasks of a run share it

    def _unpacked(self) -> tuple[PlannedMotion, Mapping[str, tuple[SamplesLocation, ...]]]:
        found: tuple[PlannedMotion, Mapping[str, tuple[SamplesLocation, ...]]]
        found = pickle.loads(zlib.decompressobj(zdict=self.pattern).decompress(self.content))
        return found

    @property
    def planned(self) -> PlannedMotion:
        """The channels without samples."""
        return self._unpacked()[0]

    @property
    def source(self) -> str:
        """Names of the files of the channels, as they appear in /failures."""
        return BETWEEN.join(dict.fromkeys(channel.source for channel in self.planned.channels))

    def read(self, options: ReadOptions) -> PlannedMotion:
        """Read the samples of all channels of this task again; raise the same errors as :meth:`Located.read`."""
        planned, places = self._unpacked()

        def again(record: Record) -> Record:
            return Located(record, places[record.id]).read(options)

        vertical, partner = (one if one is None else again(one) for one in (planned.vertical, planned.partner))
        comparisons = tuple(
            replace(one, other=again(one.other), beside=tuple(map(again, one.beside))) for one in planned.comparisons
        )
        channels = tuple(map(again, planned.channels))
        return replace(planned, channels=channels, vertical=vertical, partner=partner, comparisons=comparisons)


class TakenFrom(Iterator[Item]):
    """Iterates over the elements of a list in their order, and removes each element from the list."""

    def __init__(self, items: list[Item]) -> None:
        self._left = items
        items.reverse()

    def __next__(self) -> Item:
        if not self._left:
            raise StopIteration
        return self._left.pop()

    def __length_hint__(self) -> int:
        return len(self._left)


def tasks_of(planned: list[PlannedMotion], channels: list[Located], config: Config, verb: str) -> list[Task]:
    """Return a task for each channel or pair of channels; both lists are emptied step by step, which saves memory."""
    places = {one.record.id: one.parts for one in channels}
    channels.clear()
    settings, confirm = configuration_fingerprint(config, verb), config.records.confirm
    tasks: list[Task] = []
    for one in TakenFrom(planned):
        compared = [record for comparison in one.comparisons for record in comparison.records]
        acting = [record for record in (*one.channels, one.vertical, one.partner, *compared) if record is not None]
        facts = [text for record in acting for text in _facts_of(record, places[record.id])]
        confirmed = [record.id for record in acting if id_matches(record.id, confirm)]
        roles = [str(len(one.channels)), str(one.vertical is not None)]
        fingerprint = _digest([settings, one.name, *one.warnings, str(one.copy), *roles, *facts, *confirmed])
        content = pickle.dumps((one, {record.id: places[record.id] for record in acting}), 5)
        pattern = tasks[0].pattern if tasks else content
        press = zlib.compressobj(1, zdict=pattern)
        tasks.append(Task(one.name, fingerprint, press.compress(content) + press.flush(), pattern))
    return tasks


def read_options(config: Config) -> ReadOptions:
    """Return the options for reading files, from the configuration."""
    records = config.records
    return ReadOptions(records.units, records.dt, records.response, records.files, records.pairs)


def configuration_fingerprint(config: Config, verb: str) -> str:
    """Return the SHA-256 of the program, the results schema, and the options that affect the results of a record.

    Not included are paths, duplicate selection, workers, names, and options for the end of a run (tables of earthquakes
    and weights, statistics, fits). Units, sampling intervals and confirmed ids are part of the fingerprint of each
    task; the seed is included only if a probability of overturning is computed.
    """
    seeded = verb == "assess" and config.has_probability
    bodies = config.bodies_digest
    config = replace(
        config,
        bodies=(),
        records=_as_default(config.records, OF_TASKS),
        calibration=_as_default(config.calibration, LATE),
        fragility=_as_default(config.fragility, OF_FITS),
        search=config.search if verb == "assess" else replace(config.search, intervals=False),
        uncertainty=replace(config.uncertainty, azimuth=False),
        run=replace(config.run, workers=1, seed=config.run.seed if seeded else 0),
    )
    sections = [repr(asdict(getattr(config, name))) for name in SECTIONS if name not in IDLE[verb]]
    demands = [repr(asdict(entry)) for entry in config.demands]
    chosen = repr(selection_of(config) if verb == "fragility" else demand_selections(config))
    return _digest([verb, __version__, program_digest(), SCHEMA_VERSION, *sections, bodies, *demands, chosen])


def digest_of(tasks: Iterable[Task], events: Mapping[str, str], config: Config, verb: str) -> str:
    """Return the SHA-256 of all inputs of a run: records, their earthquakes, and the whole configuration."""
    text = replace(config, bodies=(), run=replace(config.run, workers=1)).as_text()
    table = located(config.calibration.weights, config.folder)  # the name of a rule refers to no file
    weights = hashlib.sha256(table.read_bytes()).hexdigest() if table.is_file() else ""
    rows = (f"{one.key} {one.fingerprint} {events.get(one.key)}" for one in sorted(tasks, key=attrgetter("key")))
    return _digest(chain([verb, text, config.bodies_digest, weights], rows))


def _as_default(settings: Any, keys: Iterable[str]) -> Any:
    plain = type(settings)()
    return replace(settings, **{key: plain[key] for key in keys})


@lru_cache(maxsize=1)
def program_digest() -> str:
    """Return the SHA-256 of the source files; in an editable installation they may change without a new version."""
    digest = hashlib.sha256()
    for folder in (Path(__file__).parents[1], Path(str(rocking.__file__)).parent):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _facts_of(record: Record, places: tuple[SamplesLocation, ...]) -> list[str]:
    known = [repr(getattr(record, item.name)) for item in fields(Record) if item.name != "acceleration"]
    return [Located(record, places).digest.hex(), str(record.npts), *known]


def _digest(texts: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for text in texts:
        digest.update(f"{text!r}\n".encode())
    return digest.hexdigest()


def carry_out(task: Task, work: Work, stage: str, config: Config) -> Done:
    """Read the samples of a task and process its records; every error becomes a row of /failures."""
    seconds = dict.fromkeys(("read", "condition", "solve", "pack"), 0.0)

    @contextmanager
    def watch(step: str) -> Iterator[None]:
        began = time.perf_counter()
        try:
            yield
        finally:
            seconds[step] += time.perf_counter() - began

    parts: list[bytes] = []
    failures: list[Failure] = []
    at, fingerprint = "read", task.fingerprint
    with _log_lines() as messages:
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
                messages.append(("rockpulse", logging.ERROR, f"{task.key}: {traceback.format_exc()}"))
                fault = unexpected_fault(fault)
            fingerprint, parts = UNFINISHED, []
            failures = [Failure(task.source, at, f"{task.key}: {fault}", "failed")]
    return Done(task.key, fingerprint, tuple(parts), tuple(failures), tuple(messages), seconds)


def log_again(messages: Iterable[Message]) -> None:
    """Log the messages of a worker in this process."""
    for name, level, text in messages:
        logging.getLogger(name).log(level, "%s", text)


@contextmanager
def _log_lines() -> Iterator[list[Message]]:
    """Collect the log messages of this thread for the main process, except those on the start of a compilation."""
    messages: list[Message] = []
    thread = get_ident()

    def take(record: logging.LogRecord) -> bool:
        if record.thread != thread or (record.name == kernel_logger.name and record.levelno < logging.WARNING):
            return True
        messages.append((record.name, record.levelno, record.getMessage()))
        return False

    loggers = [logging.getLogger("rockpulse"), kernel_logger]
    for logger in loggers:
        logger.filters.insert(0, take)  # before the filter that drops repeated messages
    try:
        yield messages
    finally:
        for logger in loggers:
            logger.removeFilter(take)


def compile_kernels(kind: type[Analysis], config: Config) -> tuple[Message, ...]:
    """Compile or load the kernels of a kind of analysis in a worker; return its log messages."""
    with _log_lines() as messages:
        warm_up(kind, config)
    return tuple(messages)


def warm_up(kind: type[Analysis], config: Config) -> None:
    """Compile or load every kernel of a kind of analysis by processing a short artificial record."""
    plain = Config(
        models=config.models,
        search=replace(config.search, points=8, step=1.2),
        uncertainty=replace(config.uncertainty, azimuth=False),
        calibration=CalibrationSettings(spectrum=config.calibration.spectrum),
        fragility=replace(config.fragility, pga_min=0.0),
    )
    time = 0.01 * np.arange(801)
    motion = 6.0 * np.exp(-time / 3.0) * (np.sin(5.0 * time) + 0.5 * np.sin(23.0 * time))
    record = Record(motion, dt=0.01, id="warm-up", processed=True)
    # Bodies from a post that overturns to a wall that hardly moves, so that every kernel is called.
    sizes = {"a": (0.1, 1.0), "b": (0.2, 2.0), "c": (0.5, 2.5), "d": (1.0, 5.0), "e": (1.0, 4.0)}
    blocks = {name: Block(half_width=b, half_height=h) for name, (b, h) in sizes.items()}
    small = kind(plain, blocks)
    for one in small.plan([record]).planned:
        for motion in conditioned_motions(one, plain):
            small.work(motion, nullcontext)
    # This kernel computes bodies one by one, as with vertical acceleration.
    ground_demand(blocks["a"], record.acceleration, record.dt)
