"""What every reader offers: one row of the table of formats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real

from rockpulse.errors import ConfigError
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import canonical_unit
from rockpulse.record.record import Record

__all__ = ["RESPONSES", "Format", "ReadOptions"]

RESPONSES = ("sensitivity", "remove")


@dataclass(frozen=True)
class ReadOptions:
    """What the caller knows and the file may not say; see `rockpulse.read`.

    Raises UnitError or ConfigError for a value that is none of the accepted ones.

    Attributes
    ----------
    units : str or None
        Unit of the accelerations, for formats that do not state one.
    dt : float or None
        Sampling interval [s], for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts with a StationXML become m/s2: divided by the sensitivity, or with the full instrument response
        removed.
    """

    units: str | None = None
    dt: float | None = None
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
    """One row of the table of formats.

    Attributes
    ----------
    name : str
        Short name, `Record.format`.
    what : str
        What the files are.
    recognised : str
        By what the format is known.
    unit : str
        Unit of the values and where it comes from; "-" where nothing is read.
    processed : str
        "yes" for corrected volumes, "no" for raw ones, "by type", "unknown"; "-" where nothing is read.
    example : str
        A typical file name.
    detect : callable
        ``(head, name) -> bool``: cheap, never raises; `head` is the beginning of the file.
    parse : callable
        ``(file, options) -> list of Record``, in the order of the file; raises RockpulseError and nothing else.
    obspy_reads : bool
        Whether obspy reads these files itself: then they are no plugin of it.
    """

    name: str
    what: str
    recognised: str
    unit: str
    processed: str
    example: str
    detect: Callable[[bytes, str], bool]
    parse: Callable[[SourceFile, ReadOptions], list[Record]]
    obspy_reads: bool = False
