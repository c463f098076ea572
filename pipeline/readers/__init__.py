"""Readers of strong-motion files: one file per family, one table of formats, one function.

Importing this package loads neither obspy, pandas, numba nor xarray, so that it may serve as a reader plugin.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rockpulse.readers.at2 import is_at2, read_at2
from rockpulse.readers.columns import is_columns, read_columns
from rockpulse.readers.csmip_v1 import is_csmip_v1, read_csmip_v1
from rockpulse.readers.knet import is_knet, read_knet
from rockpulse.readers.miniseed import is_miniseed, read_miniseed
from rockpulse.readers.refused import REFUSED
from rockpulse.readers.sac import is_sac, read_sac
from rockpulse.readers.smc import is_smc, read_smc
from rockpulse.readers.source import SourceFile, Unrecognised, open_source
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record import Record, distinct_ids

__all__ = ["FORMATS", "UNITS", "Format", "read", "read_source"]


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
        Unit of the values and where it comes from.
    processed : str
        "yes" for corrected volumes, "no" for raw ones, "by type", "unknown"; "-" where nothing is read.
    detect : callable
        ``(head, name) -> bool``: cheap, never raises; `head` is the beginning of the file.
    parse : callable
        ``(file, units, dt) -> list of Record``.
    """

    name: str
    what: str
    recognised: str
    unit: str
    processed: str
    detect: Callable[[bytes, str], bool]
    parse: Callable[[SourceFile, str | None, float | None], list[Record]]


#: Tried from top to bottom; the first that recognises the file reads it.
FORMATS: tuple[Format, ...] = (
    Format("csmip_v1", "CSMIP volume 1, both layouts", "first line 'Uncorrected Accelerogram Data'",
           "g or g/10, from the header", "no", is_csmip_v1, read_csmip_v1),
    Format("smc", "USGS SMC accelerogram", "first line '1 UNCORRECTED' or '2 CORRECTED ACCELEROGRAM'",
           "cm/s2", "by type", is_smc, read_smc),
    Format("at2", "PEER AT2", "a line with NPTS and DT near the top",
           "g, from the header", "yes", is_at2, read_at2),
    Format("knet", "K-NET, KiK-net ASCII", "first words 'Origin Time'",
           "counts, scale in the header", "no", is_knet, read_knet),
    Format("miniseed", "miniSEED with StationXML in the same folder", "record header",
           "counts, gain from StationXML", "no", is_miniseed, read_miniseed),
    Format("sac", "SAC, binary", "header version",
           "asked for (units)", "unknown", is_sac, read_sac),
    *(
        Format(row.name, row.what, f"first lines like {row.opening}", "-", "-", row.detect, row.parse)
        for row in REFUSED
    ),
    Format("columns", "columns of numbers (CSV, TXT), with or without time", "rows of numbers after a short header",
           "asked for (units)", "unknown", is_columns, read_columns),
)  # fmt: skip


def read_source(file: SourceFile, units: str | None = None, dt: float | None = None) -> list[Record]:
    """Every channel of an opened file; see `read`."""
    if units is not None:
        canonical_unit(units, "option units")
    for row in FORMATS:
        if row.detect(file.head, file.name):
            return distinct_ids(row.parse(file, units, dt))
    tried = ", ".join(row.name for row in FORMATS)
    raise Unrecognised(
        f"{file.name}: no reader recognises the file (formats tried: {tried}); "
        "convert it to columns of time and acceleration, and give the unit"
    )


def read(path: str | os.PathLike[str], units: str | None = None, dt: float | None = None) -> list[Record]:
    """Read every channel of a strong-motion file.

    Parameters
    ----------
    path : str or path
        A file, plain or compressed with gzip. For folders and zip archives see `rockpulse.sources.read_all`.
    units : str, optional
        Unit of the accelerations, a key of `UNITS`, for the formats that do not state one (columns, SAC). Files that
        state their unit keep it.
    dt : float, optional
        Sampling interval [s] for columns without a time column.

    Returns
    -------
    list of Record
        In m/s2, in the order of the file.

    Raises
    ------
    RecordFormatError
        No reader recognises the file, or it breaks the rules of its format.
    RecordRefused
        A sound file without usable acceleration: velocity, spectra, counts without a gain, gaps.
    UnitError
        The unit is missing or unknown.
    OSError
        The file cannot be opened.
    """
    return read_source(open_source(Path(path)), units, dt)
