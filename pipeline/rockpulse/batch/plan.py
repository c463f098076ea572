"""The tasks of a batch, decided on records without their samples: one task for each channel or pair."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

import rocking
from rockpulse.batch.located import Located
from rockpulse.config.configuration import Config, located
from rockpulse.config.fragility_settings import FragilitySettings
from rockpulse.config.settings import SECTIONS, CalibrationSettings
from rockpulse.motions.directions import PlannedMotion
from rockpulse.motions.tables import selection_of
from rockpulse.readers import ReadOptions
from rockpulse.record.record import BETWEEN, Record, id_matches
from rockpulse.storage.hdf5.results_file import SCHEMA_VERSION
from rockpulse.version import __version__

__all__ = ["Task", "configuration_fingerprint", "digest_of", "program_digest", "read_options", "tasks_of"]

#: Sections of the configuration on which no record's numbers depend, by verb.
IDLE = {
    "assess": {"site", "report", "calibration", "fragility", "hazard", "check"},
    "calibrate": {"site", "report", "models", "search", "uncertainty", "fragility", "hazard", "check"},
    "fragility": {"site", "report", "models", "uncertainty", "calibration", "hazard", "check"},
}

#: Keys of [calibration] that are used when all records are done, those that only matching a response asks for, and keys
#: of [fragility] that are used when all records are done.
LATE = ("weights", "design", "quantile", "bootstrap")
OF_MATCHING = ("family", "confidence")
OF_FITS = ("model", "overturning_model", "confidence")

SettingsOf = TypeVar("SettingsOf", CalibrationSettings, FragilitySettings)


@dataclass(frozen=True, eq=False, slots=True)
class Task:
    """A channel, or a pair to be rotated, with everything that is known of it but the samples; small, and picklable."""

    planned: PlannedMotion  # without samples
    channels: tuple[Located, ...]  # with the ids and warnings that the plan gave them
    vertical: Located | None
    partner: Located | None
    fingerprint: str  # SHA-256 of all that the answer depends on: samples, metadata, configuration, version

    @property
    def key(self) -> str:
        """Record id or name of the pair; the same in every run on the same files."""
        return self.planned.name

    @property
    def source(self) -> str:
        """The files, as rows of failures name them."""
        return BETWEEN.join(dict.fromkeys(channel.record.source for channel in self.channels))

    def read(self, options: ReadOptions) -> PlannedMotion:
        """The planned motion with its samples, read with the options of the survey; raises as `Located.read`."""
        channels = tuple(channel.read(options) for channel in self.channels)
        vertical, partner = (None if one is None else one.read(options) for one in (self.vertical, self.partner))
        return replace(self.planned, channels=channels, vertical=vertical, partner=partner)


def tasks_of(planned: Iterable[PlannedMotion], channels: Iterable[Located], config: Config, verb: str) -> list[Task]:
    """A task for each channel or pair that an analysis has planned on located records."""
    of_id = {one.record.id: one for one in channels}
    settings, confirm = configuration_fingerprint(config, verb), config.records.confirm

    def place(record: Record) -> Located:
        """The planned record, which may have got a warning, with the places of its samples."""
        return replace(of_id[record.id], record=record)

    return [_task(one, place, settings, confirm) for one in planned]


def read_options(config: Config) -> ReadOptions:
    """The options by which the configuration has files read."""
    records = config.records
    return ReadOptions(records.units, records.dt, records.response, records.files)


def configuration_fingerprint(config: Config, verb: str) -> str:
    """SHA-256 of the options that change numbers of a record, of the schema and of the program.

    Paths of records, which of them are kept beside others of the same shaking, and the number of workers change
    nothing, nor does the name of the site, or what is looked at when all records are done: the tables of events and
    weights, and the options of statistics and fits. A body is the same whether its size was confirmed or not. Unit and
    interval of a file are told by its records as they were read, and what is confirmed by each task for itself. The
    seed and the level of confidence are asked for where the response of each record is matched, the seed also where
    bodies have a probability of overturning.
    """
    matched = verb == "calibrate" and config.calibration.method == "response"
    seeded = matched or (verb == "assess" and (config.has_probability or config.sequence.method == "response"))
    config = replace(
        config,
        records=replace(config.records, paths=(), events=None, keep=(), units=None, dt=None, files=(), confirm=()),
        calibration=_as_default(config.calibration, LATE if matched else LATE + OF_MATCHING),
        fragility=_as_default(config.fragility, OF_FITS),
        search=config.search if verb == "assess" else replace(config.search, intervals=False),
        uncertainty=replace(config.uncertainty, azimuth=False),
        run=replace(config.run, workers=1, seed=config.run.seed if seeded else 0),
    )
    sections = [repr(getattr(config, name)) for name in SECTIONS if name not in IDLE[verb]]
    blocks = [replace(block, confirm_size=True) for block in config.blocks]
    bodies = [repr(entry) for entry in (*blocks, *config.demands)]
    chosen = repr(selection_of(config)) if verb == "fragility" else ""
    return _digest([verb, __version__, program_digest(), SCHEMA_VERSION, *sections, *bodies, chosen])


def digest_of(tasks: Iterable[Task], events: Mapping[str, str], config: Config, verb: str) -> str:
    """SHA-256 of all that a run is asked for: every record, the earthquake of each, and the whole configuration."""
    text = replace(config, run=replace(config.run, workers=1)).as_text()
    table = located(config.calibration.weighting, config.folder)  # or the name of a rule
    weights = hashlib.sha256(table.read_bytes()).hexdigest() if table.is_file() else ""
    return _digest(
        [verb, text, weights, *sorted(f"{one.key} {one.fingerprint} {events.get(one.key)}" for one in tasks)]
    )


def _as_default(settings: SettingsOf, keys: Iterable[str]) -> SettingsOf:
    """A section with some of its keys as where they are omitted."""
    plain = type(settings)()
    return replace(settings, **{key: getattr(plain, key) for key in keys})


@lru_cache(maxsize=1)
def program_digest() -> str:
    """SHA-256 of the sources of this package: the version of an installation that can be edited stays the same."""
    digest = hashlib.sha256()
    for folder in (Path(__file__).parents[1], Path(str(rocking.__file__)).parent):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _task(planned: PlannedMotion, place: Callable[[Record], Located], settings: str, confirm: Sequence[str]) -> Task:
    channels = tuple(place(channel) for channel in planned.channels)
    vertical, partner = (None if one is None else place(one) for one in (planned.vertical, planned.partner))
    acting = [*channels, *(one for one in (vertical, partner) if one is not None)]
    told = [text for one in acting for text in _told(one)]
    confirmed = [one.record.id for one in acting if id_matches(one.record.id, confirm)]
    roles = [str(len(channels)), str(vertical is not None)]
    known = [planned.name, *planned.remarks, str(planned.copy), *roles, *told, *confirmed]
    fingerprint = _digest([settings, *known])
    return Task(planned, channels, vertical, partner, fingerprint)


def _told(located: Located) -> list[str]:
    """The digest of the samples, and everything that is known of the record."""
    known = [repr(getattr(located.record, item.name)) for item in fields(Record) if item.name != "acceleration"]
    return [located.digest, str(located.record.npts), *known]


def _digest(texts: Iterable[str]) -> str:
    return hashlib.sha256(repr(list(texts)).encode()).hexdigest()
