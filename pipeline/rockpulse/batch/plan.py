"""What is to be done, decided on records without their samples: one task for each channel or pair."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path

import rocking
from rockpulse.assessment.directions import PlannedMotion, plan_motions, swept_directions
from rockpulse.batch.located import Located
from rockpulse.config.configuration import Config
from rockpulse.config.settings import SECTIONS, CalibrationSettings
from rockpulse.failures import Failure
from rockpulse.readers import ReadOptions
from rockpulse.record.record import Record
from rockpulse.storage.save_load import SCHEMA_VERSION
from rockpulse.version import __version__

__all__ = ["Plan", "Task", "configuration_fingerprint", "plan", "program_digest", "read_options"]

#: Sections of the configuration on which no record's numbers depend, by verb.
IDLE = {"assess": {"site", "calibration", "fragility"}, "calibrate": {"site", "models", "search", "fragility"}}

#: Keys of [calibration] that are used when all records are done, and those that only matching a response asks for.
LATE = ("weights", "design", "quantile", "bootstrap")
OF_MATCHING = ("family", "confidence")


@dataclass(frozen=True, eq=False)
class Task:
    """A channel, or a pair to be rotated, with everything that is known of it but the samples; small, and picklable.

    Attributes
    ----------
    planned : PlannedMotion
        Without samples.
    channels : tuple of Located
        Where those of its channels are, with the ids and warnings that the plan gave them.
    vertical : Located or None
        The vertical channel that acts too.
    fingerprint : str
        SHA-256 of everything that the answer depends on: samples, what is known of the records, configuration, version.
    """

    planned: PlannedMotion
    channels: tuple[Located, ...]
    vertical: Located | None
    fingerprint: str

    @property
    def key(self) -> str:
        """Record id or name of the pair; the same in every run on the same files."""
        return self.planned.name

    @property
    def source(self) -> str:
        """The files, as rows of failures name them."""
        return "; ".join(dict.fromkeys(channel.record.source for channel in self.channels))

    def read(self, options: ReadOptions) -> PlannedMotion:
        """What is planned, with the samples.

        Parameters
        ----------
        options : ReadOptions
            Those of the survey.

        Raises
        ------
        RockpulseError, OSError
            As `rockpulse.batch.located.Located.read`.
        """
        channels = tuple(channel.read(options) for channel in self.channels)
        vertical = None if self.vertical is None else self.vertical.read(options)
        return replace(self.planned, channels=channels, vertical=vertical)


@dataclass(frozen=True, eq=False)
class Plan:
    """Everything that is to be done.

    Attributes
    ----------
    tasks : tuple of Task
        In the order of the results.
    failures : list of Failure
        What is left out already.
    swept : dict of str to list of str, or None
        Name of each pair of a sweep over direction, and the ids of its directions; None where there is no sweep.
    """

    tasks: tuple[Task, ...]
    failures: list[Failure]
    swept: dict[str, list[str]] | None

    @property
    def planned(self) -> list[PlannedMotion]:
        """What the tasks are, without samples."""
        return [task.planned for task in self.tasks]


def plan(located: Sequence[Located], failures: Iterable[Failure], config: Config, verb: str = "assess") -> Plan:
    """Decide what is to be done.

    Parameters
    ----------
    located : sequence of Located
        From `rockpulse.batch.survey.gather`; ids differ.
    failures : iterable of Failure
        What reading has left out.
    config : Config
        Options.
    verb : {"assess", "calibrate"}
        What is done. The records of a site are dealt with in the order of their ids, as
        :func:`rockpulse.calibrate_site` does, those of an assessment in the order given.

    Returns
    -------
    Plan
        The tasks that :func:`rockpulse.assess` or :func:`rockpulse.calibrate_site` would carry out one by one.
    """
    if verb == "calibrate":
        located = sorted(located, key=lambda one: one.record.id)
    of_id = {one.record.id: one for one in located}
    planned, left_out = plan_motions([one.record for one in located], config)
    settings = configuration_fingerprint(config, verb)

    def place(record: Record) -> Located:
        """The planned record, which may have got a warning, with the places of its samples."""
        return replace(of_id[record.id], record=record)

    tasks = tuple(_task(one, place, settings) for one in planned)
    return Plan(tasks, [*failures, *left_out], swept_directions(planned, config))


def read_options(config: Config) -> ReadOptions:
    """How the configuration has files read.

    Parameters
    ----------
    config : Config
        Section records is used.
    """
    records = config.records
    return ReadOptions(records.units, records.dt, records.response)


def configuration_fingerprint(config: Config, verb: str) -> str:
    """SHA-256 of the options that change numbers of a record, of the schema and of the program.

    Parameters
    ----------
    config : Config
        Options; paths of records and the number of workers change nothing, nor does the name of the site, or what is
        looked at when all records are done: the tables of events and weights, and the quantile and the resamples of a
        site. The seed and the level of confidence are asked for where the response of each record is matched.
    verb : {"assess", "calibrate"}
        What is done.
    """
    late = {name: getattr(CalibrationSettings(), name) for name in LATE}
    matched = verb == "calibrate" and config.calibration.method == "response"
    if not matched:
        late |= {name: getattr(CalibrationSettings(), name) for name in OF_MATCHING}
    config = replace(
        config,
        records=replace(config.records, paths=(), events=None),
        calibration=replace(config.calibration, **late),
        run=replace(config.run, workers=1, seed=config.run.seed if matched else 0),
    )
    sections = [repr(getattr(config, name)) for name in SECTIONS if name not in IDLE[verb]]
    bodies = [repr(entry) for entry in (*config.blocks, *config.demands)]
    return _digest([verb, __version__, program_digest(), SCHEMA_VERSION, *sections, *bodies])


@lru_cache(maxsize=1)
def program_digest() -> str:
    """SHA-256 of the sources of this package: the version of an installation that can be edited stays the same."""
    digest = hashlib.sha256()
    for folder in (Path(__file__).parents[1], Path(str(rocking.__file__)).parent):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _task(planned: PlannedMotion, place: Callable[[Record], Located], settings: str) -> Task:
    channels = tuple(place(channel) for channel in planned.channels)
    vertical = None if planned.vertical is None else place(planned.vertical)
    actors = [text for one in (*channels, vertical) if one is not None for text in _told(one)]
    fingerprint = _digest([settings, planned.name, *planned.remarks, str(planned.copy), str(len(channels)), *actors])
    return Task(planned, channels, vertical, fingerprint)


def _told(located: Located) -> list[str]:
    """The digest of the samples, and everything that is known of the record."""
    known = [repr(getattr(located.record, item.name)) for item in fields(Record) if item.name != "acceleration"]
    return [located.digest, str(located.record.npts), *known]


def _digest(texts: Iterable[str]) -> str:
    return hashlib.sha256(repr(list(texts)).encode()).hexdigest()
