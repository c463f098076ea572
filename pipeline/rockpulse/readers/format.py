"""Defines `Format`, a row of the table of formats (one for each reader), and the options for reading files."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import MISSING, dataclass, replace
from fnmatch import fnmatchcase
from numbers import Real

from rockpulse.errors import ConfigError, RecordFormatError, Remedy, UnitError
from rockpulse.option import KeyType, Section, key, number, text
from rockpulse.readers.file_pairs import PairSettings, path_spellings
from rockpulse.readers.kit.channel import with_copy_warnings
from rockpulse.readers.kit.spacing import same_step
from rockpulse.readers.kit.text import UNITS, canonical_unit, for_other_files
from rockpulse.readers.parts import PartRule
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import Record, distinct_ids

RESPONSES = ("sensitivity", "remove")
_PATTERN = KeyType("a pattern that is not empty", lambda value: isinstance(value, str) and bool(value.strip()), str)


@dataclass(frozen=True)
class FileSettings(Section):
    """Unit and sampling interval of the files that match a pattern; section [[records.file]] in TOML.

    Attributes
    ----------
    match : str
        Pattern of the end of a path, such as ``*.g3``, ``site 2/*``, ``old.zip`` (every member of the archive) or
        ``*/a.g3``; ``*`` and ``?`` match any characters, including ``/``. The pattern is case-sensitive; ``.gz`` at
        the end of the path is ignored. Brackets are ordinary characters, and a backslash means ``/``.
    units : str or None
        Unit of the accelerations, a key of `rockpulse.readers.UNITS`.
    dt : float or None
        Sampling interval [s].

    Raises
    ------
    ConfigError
        For an empty pattern or an unknown unit, or if neither unit nor interval is given.

    Examples
    --------
    >>> one = FileSettings(match="*.g3", units="g", dt=0.02)
    >>> one.chooses("columns/ARL360.g3"), one.chooses("old.zip!ARL360.g3"), one.chooses("ARL360.txt")
    (True, True, False)
    """

    heading = "[[records.file]]"
    match: str = key(MISSING, _PATTERN)
    units: str | None = text(None)
    dt: float | None = number(None, low=0.0, above=True, unit="s")

    @property
    def where(self) -> str:
        """Return the text by which messages refer to this section."""
        return f'[[records.file]] match = "{self.match}"' if isinstance(self.match, str) else self.heading

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.units is None and self.dt is None:
            raise ConfigError(f"{self.where}: expected units, dt or both, found neither")
        if self.units is not None:
            try:
                canonical_unit(self.units, f"option units of {self.where}")
            except UnitError as error:
                raise ConfigError(str(error)) from None

    def chooses(self, name: str) -> bool:
        """Return whether the pattern matches a file or a member of an archive, named as in `Record.source`."""
        parts = path_spellings(name)
        pattern = self.match.replace("\\", "/").removeprefix("./").replace("[", "[[]")
        return any(fnmatchcase(part, wanted) for part in parts for wanted in (pattern, f"*/{pattern}"))


@dataclass(frozen=True)
class ReadOptions:
    """Unit, sampling interval and other options that the caller gives for reading files; see `rockpulse.read`."""

    units: str | None = None  # unit of the accelerations, for formats that do not state one
    dt: float | None = None  # sampling interval [s], for columns without a time column
    # "sensitivity": counts are divided by the sensitivity; "remove": the full instrument response is removed
    response: str = "sensitivity"
    # unit and interval of some files, in place of the above; if several match a file, the last one applies
    files: tuple[FileSettings, ...] = ()
    pairs: tuple[PairSettings, ...] = ()  # pairs of files with the two components of a recording

    def __post_init__(self) -> None:
        if self.units is not None:
            canonical_unit(self.units, "option units")
        if self.dt is not None and not (isinstance(self.dt, Real) and math.isfinite(self.dt) and self.dt > 0.0):
            raise ConfigError(f"option dt: expected a sampling interval in s above 0, found {self.dt!r}")
        if self.response not in RESPONSES:
            raise ConfigError(f"option response: expected one of {', '.join(RESPONSES)}, found {self.response!r}")

    def of_file(self, name: str) -> "ReadOptions":
        """Return the options for one file, named as in `Record.source`: unit, interval, and matching entries."""
        if not self.files and not self.pairs:
            return self
        units, dt = self._last("units", name), self._last("dt", name)
        return replace(
            self,
            units=self.units if units is None else units.units,
            dt=self.dt if dt is None else dt.dt,
            files=tuple(row for row in self.files if row is units or row is dt),
            pairs=tuple(row for row in self.pairs if row.side(name)),
        )

    def said_by(self, key: str) -> str:
        """Return where the property `key` was given, for a message: "the option units" or a [[records.file]] entry."""
        row = self._last(key)
        return f"the option {key}" if row is None else row.where

    def advice(self, key: str) -> str:
        """Return the advice for a message about a file that contradicts the property `key` given by the user."""
        value = getattr(self, key)
        if self._last(key) is not None:
            return "correct the wrong one, or the pattern"
        return for_other_files(f"--{key} {value:g}" if isinstance(value, float) else f"--{key} {value}")

    def check(self, records: Sequence[Record]) -> None:
        """Raise an error if the unit or interval of a record differs from the FileSettings that match its file."""
        units, dt = self._last("units"), self._last("dt")
        for record in records:
            if units is not None:
                given = canonical_unit(str(units.units), "option units")
                if UNITS.get(record.source_unit) != UNITS[given]:
                    conflict = f"the file states the unit {record.source_unit}, but {units.where} says {given}"
                    stated = [Remedy("units", (record.source_unit,))] if record.source_unit in UNITS else []
                    raise UnitError(f"{record.source}: {conflict}; {self.advice('units')}", *stated)
            if dt is not None and dt.dt is not None and not same_step((record.dt, dt.dt)):
                conflict = f"the file states an interval of {record.dt:g} s, but {dt.where} says {dt.dt:g} s"
                remedy = Remedy("dt", (f"{record.dt:.9g}",))
                raise RecordFormatError(f"{record.source}: {conflict}; {self.advice('dt')}", remedy)

    def _last(self, key: str, name: str | None = None) -> FileSettings | None:
        """Return the last FileSettings with a value for `key` that match the file `name` (None: any), or None."""
        found = (row for row in reversed(self.files) if row[key] is not None)
        return next((row for row in found if name is None or row.chooses(name)), None)


def begins_with(pattern: re.Pattern[str], count: int = 200) -> Callable[[bytes, str], bool]:
    """Return a function for `Format.detect` that matches a pattern to the first `count` bytes of a file."""
    return lambda head, name: bool(pattern.match(head[:count].decode("latin-1")))


@dataclass(frozen=True)
class Format:
    """A row of the table of formats: name, detector, reader and description of a format."""

    name: str  # short name, `Record.format`
    what: str  # description of the files
    recognised: str  # how the format is recognised
    unit: str  # unit of the values and where it comes from; "-" for files that are always rejected
    example: str  # a typical file name
    detect: Callable[[bytes, str], bool]  # called with the first bytes and the name; never raises an error
    # returns the channels in the order of the file; raises only RockpulseError
    parse: Callable[[SourceFile, ReadOptions], list[Record]]
    processed: str = "no"  # "no" for raw files, "yes" for corrected ones, "by type", "unknown"; "-" if always rejected
    obspy_reads: bool = False  # whether obspy itself reads these files, so that it needs no plugin
    parts: PartRule | None = None  # file names of the parts, if the agency splits long records into files

    def read(self, file: SourceFile, options: ReadOptions) -> list[Record]:
        """Read the channels of a file; if its second half repeats the first, only the first half is read."""
        half = file.first_half()
        records = [replace(record, format=self.name) for record in self.parse(half or file, options)]
        if self.parts:
            records = self.parts.read(half or file, records)
        records = with_copy_warnings(distinct_ids(records))
        if half is None:
            return records
        note = "the second half of the file is a copy of the first half; the content was read once"
        return [replace(record, source_sha256=file.sha256).with_warning(note) for record in records]
