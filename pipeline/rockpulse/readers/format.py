"""One row of the table of formats, as every reader offers it, and the options of reading."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from numbers import Real

from rockpulse.errors import ConfigError
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import canonical_unit
from rockpulse.record.record import Record, distinct_ids

__all__ = ["RESPONSES", "Format", "ReadOptions"]

RESPONSES = ("sensitivity", "remove")


@dataclass(frozen=True)
class ReadOptions:
    """Properties that the caller knows and the file may not state; see `rockpulse.read`.

    Raises UnitError or ConfigError for a value that is none of the accepted ones.
    """

    units: str | None = None  # unit of the accelerations, for formats that do not state one
    dt: float | None = None  # sampling interval [s], for columns without a time column
    # "sensitivity": counts are divided by it; "remove": the full instrument response is removed
    response: str = "sensitivity"

    def __post_init__(self) -> None:
        if self.units is not None:
            canonical_unit(self.units, "option units")
        if self.dt is not None and not (isinstance(self.dt, Real) and math.isfinite(self.dt) and self.dt > 0.0):
            raise ConfigError(f"option dt: expected a sampling interval in s above 0, found {self.dt!r}")
        if self.response not in RESPONSES:
            raise ConfigError(f"option response: expected one of {', '.join(RESPONSES)}, found {self.response!r}")


@dataclass(frozen=True)
class Format:
    """One row of the table of formats."""

    name: str  # short name, `Record.format`
    what: str  # the files, in words
    recognised: str  # by which signs the format is known
    unit: str  # unit of the values and where it comes from; "-" where nothing is read
    processed: str  # "yes" for corrected volumes, "no" for raw ones, "by type", "unknown"; "-" where nothing is read
    example: str  # a typical file name
    detect: Callable[[bytes, str], bool]  # (head, name): cheap, never raises; the head is the beginning of the file
    # channels in the order of the file; raises RockpulseError and nothing else
    parse: Callable[[SourceFile, ReadOptions], list[Record]]
    obspy_reads: bool = False  # whether obspy reads these files itself: then they are no plugin of it

    def read(self, file: SourceFile, options: ReadOptions) -> list[Record]:
        """The channels of a file that this format recognises, in the order of the file, each with an id of its own.

        A file that holds everything twice is read once, with a warning on each channel.
        """
        half = file.first_half()
        if half is None:
            return distinct_ids(self.parse(file, options))
        note = "the second half of the file is a copy of the first: it was read once"
        return [
            replace(record, source_sha256=file.sha256, warnings=(*record.warnings, note))
            for record in distinct_ids(self.parse(half, options))
        ]
