"""The formats of rockpulse as plugins of obspy: ``obspy.read("RSN763.AT2")`` gives a Stream in m/s2.

The entry points that ``hatch_build.py`` makes name ``<FORMAT>.is_format`` and ``<FORMAT>.read_format`` of this module.
Importing it loads neither obspy, numba nor xarray.
"""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import FORMATS, Format, ReadOptions
from rockpulse.readers.obspy_trace import to_trace
from rockpulse.readers.source import HEAD, SourceFile, open_source, open_stream

if TYPE_CHECKING:
    import obspy

__all__ = ["PLUGINS", "Plugin"]

logger = logging.getLogger("rockpulse")

#: Formats that are read where they are asked for by name and never claimed: any text file of numbers looks like one.
_BY_NAME_ONLY = frozenset({"columns"})


@lru_cache(maxsize=1)
def _recognised(head: bytes, name: str) -> str:
    """Name of the format that `rockpulse.read` would take, or an empty text; obspy asks every plugin in turn."""
    return next((row.name for row in FORMATS if row.detect(head, name)), "")


def _head(file: str | BinaryIO) -> tuple[bytes, str]:
    """The first bytes and the name of a path or an open file; the position in an open file does not change."""
    if isinstance(file, str | os.PathLike):
        source = open_source(Path(file))
        return source.head, source.name
    position = file.tell()
    head = file.read(HEAD)
    file.seek(position)
    name = getattr(file, "name", "stream")
    return head if isinstance(head, bytes) else b"", name if isinstance(name, str) else "stream"


@dataclass(frozen=True)
class Plugin:
    """The two functions that obspy wants of one format, for its row of the table of formats."""

    row: Format

    def is_format(self, file: str | BinaryIO) -> bool:
        """Whether a path or an open binary file holds this format and no other that rockpulse knows."""
        if self.row.name in _BY_NAME_ONLY:
            return False
        try:
            head, name = _head(file)
        except (RockpulseError, OSError):  # empty, damaged gzip, a folder: not ours to complain of
            return False
        return _recognised(head, name) == self.row.name

    def read_format(
        self,
        file: str | BinaryIO,
        headonly: bool = False,
        starttime: Any = None,
        endtime: Any = None,
        nearest_sample: bool = True,
        units: str | None = None,
        dt: float | None = None,
        response: str = "sensitivity",
        **others: Any,
    ) -> obspy.Stream:
        """Read every channel of a file into an obspy Stream in m/s2; see `rockpulse.to_trace`.

        `headonly` leaves the samples out; obspy itself applies `starttime`, `endtime` and `nearest_sample` afterwards;
        `units`, `dt` and `response` are those of `rockpulse.read`, whose errors are raised. Options of other formats
        (``details``, ``byteorder``) are ignored, as obspy's own readers do, and logged.
        """
        import obspy

        if others:
            logger.warning(
                "%s: obspy.read has options that are not of this format: %s", self.row.name, ", ".join(others)
            )
        options = ReadOptions(units, dt, response)
        source: SourceFile = open_source(Path(file)) if isinstance(file, str | os.PathLike) else open_stream(file)
        if not self.row.detect(source.head, source.name):
            raise RecordFormatError(
                f"{source.name}: expected {self.row.what} (recognised by {self.row.recognised}); "
                "leave the format out, or name the right one"
            )
        traces = [to_trace(record) for record in self.row.read(source, options)]
        return obspy.Stream([obspy.Trace(header=trace.stats) for trace in traces] if headonly else traces)


#: By the name that obspy knows them by.
PLUGINS = {row.name.upper(): Plugin(row) for row in FORMATS if row.unit != "-" and not row.obspy_reads}


def __getattr__(name: str) -> Plugin:
    """The plugin of a format under its name in upper case, ``obspy_plugin.AT2``, as the entry points name it."""
    if name not in PLUGINS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return PLUGINS[name]
