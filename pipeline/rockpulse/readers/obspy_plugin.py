"""Converts records to and from `obspy.Trace`, and provides the plugins with which `obspy.read` reads the formats.

Data are in m/s2. Fields that a Trace lacks are in ``trace.stats.rockpulse``, which copies and PICKLE files keep. The
entry points made by ``hatch_build.py`` refer to ``<FORMAT>.is_format`` and ``<FORMAT>.read_format`` of this module.
"""

from __future__ import annotations

import logging
import os
import re
from dataclasses import MISSING, dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from rockpulse.errors import ConfigError, RecordFormatError, RecordRefused, RockpulseError, UnitError
from rockpulse.readers import FORMATS, Format, ReadOptions
from rockpulse.readers.kit.channel import build_record
from rockpulse.readers.kit.direction import Direction
from rockpulse.readers.kit.instrument_response import ConvertedCounts, from_counts
from rockpulse.readers.kit.obspy_bridge import codes_of, utc_time
from rockpulse.readers.kit.text import UNITS, canonical_unit, unexpected
from rockpulse.readers.source import HEAD, SourceFile, open_source, open_stream
from rockpulse.record.record import Orientation, Record, record_id

if TYPE_CHECKING:
    import obspy

logger = logging.getLogger("rockpulse")
_CODES = ("network", "station", "location", "channel")
#: Fields stored in ``stats.rockpulse``: all fields of a Record that a Trace lacks.
_KEPT = tuple(field for field in fields(Record) if field.name not in {*_CODES, "acceleration", "start_time"})
#: Methods of a Trace after which its data are not an acceleration in the same unit.
_CHANGES_UNIT = {
    *["integrate", "differentiate", "normalize", "remove_response", "remove_sensitivity", "simulate", "trigger"]
}
#: Largest relative difference between the intervals of a Trace, which stores the rate, and of its record.
_SAME_STEP = 1e-12
#: Formats that are read only if requested by name, as any text file of numbers would be recognised.
_BY_NAME_ONLY = frozenset({"columns"})


def to_trace(record: Record) -> obspy.Trace:
    """Return the record as an `obspy.Trace`.

    Parameters
    ----------
    record : Record
        The record.

    Returns
    -------
    obspy.Trace
        ``data`` in m/s2 (a copy), ``stats.calib`` 1, codes, interval and start time in ``stats``, every other field in
        ``stats.rockpulse``. Without a start time ``stats.starttime`` is obspy's default, 1970-01-01, and
        ``stats.rockpulse.start_time_known`` is False.

    Examples
    --------
    >>> record = Record([0.0, 1.5, -0.5], dt=0.01, id="example.1", azimuth=90.0)
    >>> trace = to_trace(record)
    >>> trace.stats.delta, trace.stats.rockpulse.azimuth, from_trace(trace).start_time
    (0.01, 90.0, None)
    """
    import obspy
    from obspy.core import AttribDict

    kept = AttribDict({field.name: getattr(record, field.name) for field in _KEPT})
    kept.start_time_known = record.start_time is not None
    header: dict[str, Any] = {code: getattr(record, code) for code in _CODES}
    kept.codes = dict(header)
    header |= {"delta": record.dt, "starttime": obspy.UTCDateTime(record.start_time or 0), "rockpulse": kept}
    return obspy.Trace(np.array(record.acceleration), header)


def from_trace(
    trace: obspy.Trace,
    units: str | None = None,
    factor: float | None = None,
    response: str = "sensitivity",
    azimuth: float | None = None,
) -> Record:
    """Return a record made from an `obspy.Trace`.

    Parameters
    ----------
    trace : obspy.Trace
        A trace from `to_trace`, or from ``obspy.read`` through rockpulse, needs no other argument, even after filters;
        any other trace needs `units`.
    units : str, optional
        Unit of the data: a key of `rockpulse.readers.UNITS`, or "counts".
    factor : float, optional
        m/s2 per count; without it, counts need ``trace.stats.response`` (``trace.attach_response(inventory)``).
    response : {"sensitivity", "remove"}
        How an attached response is used; see `rockpulse.readers.ReadOptions`.
    azimuth : float, optional
        Direction of a horizontal trace, clockwise from north [degrees]; needed after ``Stream.rotate``, which does not
        store it. A rotation that does not change the channel codes cannot be detected: give the azimuth.

    Returns
    -------
    Record
        The record in m/s2, with the steps in ``stats.processing`` appended to its processing. The id in
        ``stats.rockpulse`` is kept unless the codes have changed: it is then made from the new codes, with a warning,
        and after a change of the channel code the direction is unknown unless `azimuth` is given.

    Raises
    ------
    UnitError
        If the unit is missing or unknown, contradicts ``stats.rockpulse``, or has changed (after an integration).
    RecordRefused
        For masked samples, counts without a gain, or ``stats.calib`` other than 1, which in obspy may mean nm, nm/s or
        any other unit per count and is never applied; it is ignored if `factor` is given.
    RecordFormatError
        For fewer than two samples, or samples that are not finite.
    ConfigError
        If `azimuth` is not finite.

    Examples
    --------
    >>> from_trace(to_trace(record)).azimuth
    0.0
    """
    where = f"trace {trace.id}"
    if azimuth is not None and not np.isfinite(azimuth):
        raise ConfigError(f"{where}: expected an azimuth in degrees, found {azimuth!r}; leave it out if it is unknown")
    stats = trace.stats
    if np.ma.is_masked(trace.data):
        advice = "split the trace (trace.split()) and take one part"
        raise RecordRefused(f"{where}: {np.ma.count_masked(trace.data)} samples are masked (a gap); {advice}")
    if stats.calib != 1.0 and factor is None:
        raise RecordRefused(
            f"{where}: stats.calib is {stats.calib:g}, and obspy states no unit for it; multiply the data yourself and "
            "set it to 1, or give units='counts' and the factor in m/s2 per count"
        )
    # A line of stats.processing is such as "ObsPy 1.5.1: integrate(...)".
    changed = [step for step in _steps(stats) if {*re.findall(r":\s*(\w+)\(", step)[:1]} & _CHANGES_UNIT]
    if changed and (units is None or units == "counts"):
        asked = f"say which unit of acceleration they have, one of {', '.join(UNITS)}"
        raise UnitError(f"{where}: the processing of the trace changed the unit of its values: {changed[0]}; {asked}")
    kept = stats.get("rockpulse")
    if kept is None:
        ReadOptions(response=response)  # rejects an unknown value of `response`
        return _new(where, trace, units, factor, response, azimuth)
    known = units is None or (units != "counts" and UNITS[canonical_unit(units, "option units")] == 1.0)
    if not known or factor is not None:
        raise UnitError(f"{where}: stats.rockpulse says m/s2; give no units and no factor, or delete stats.rockpulse")
    return _restored(where, trace, kept, azimuth)


def _steps(stats: Any) -> tuple[str, ...]:
    return tuple(map(str, stats.get("processing", ())))


def _restored(where: str, trace: Any, kept: Any, azimuth: float | None) -> Record:
    """Return the record that `to_trace` stored in a trace, with the later processing of the trace."""
    missing = [field.name for field in _KEPT if field.default is MISSING and field.name not in kept]
    if missing:
        expected, advice = f"{', '.join(missing)} in stats.rockpulse", "delete stats.rockpulse and give the units"
        raise unexpected(where, expected, ", ".join(sorted(kept)) or "nothing", advice)
    stats = trace.stats
    values = {field.name: kept[field.name] for field in _KEPT if field.name in kept}
    same = abs(stats.delta - values["dt"]) <= _SAME_STEP * values["dt"]
    values["dt"] = values["dt"] if same else float(stats.delta)
    values["warnings"] = tuple(values.get("warnings", ()))
    values["processing"] = (*values.get("processing", ()), *_steps(stats))
    start = utc_time(SourceFile(where, b"", bytes), stats.starttime) if kept.get("start_time_known", True) else None
    codes = codes_of(stats)
    record = Record(acceleration=np.ma.getdata(trace.data), start_time=start, **codes, **values)
    codes_before = kept.get("codes")
    if codes_before is None or dict(codes_before) != codes:
        record = _renamed(record, codes_before, azimuth is None)
    if azimuth is None or azimuth % 360.0 == record.azimuth:
        return record
    orientation: Orientation = "structural" if record.orientation == "structural" else "horizontal"
    return replace(record, azimuth=azimuth % 360.0, orientation=orientation, component="")


def _renamed(record: Record, before: dict[str, str] | None, undirected: bool) -> Record:
    """Return the record with an id from its new codes, and a warning; a new channel has no known direction."""
    stem = SourceFile(record.source, b"", bytes).path.stem or record.station_name or "trace"
    codes = (record.network, record.station, record.location, record.channel)
    record = replace(record, id=record_id(*codes, record.start_time, stem, 1))
    old = "unknown" if before is None else ".".join(before[code] for code in _CODES)
    note = f"the codes were {old} when the trace was made; a new id was made"
    if before is not None and before["channel"] == record.channel:
        return record.with_warning(note)
    orientation: Orientation = "structural" if record.orientation == "structural" else "unknown"
    record = replace(record, component="", orientation=orientation, azimuth=float("nan"))
    return record.with_warning(note + (" and the direction is no longer known" if undirected else ""))


def _new(
    where: str, trace: Any, units: str | None, factor: float | None, response: str, azimuth: float | None
) -> Record:
    """Return a new record from a trace that was not made by `to_trace`."""
    stats = trace.stats
    if units is None:
        raise UnitError(
            f"{where}: a trace does not state the unit of its data; give units, one of {', '.join(UNITS)}, or counts "
            "with a factor in m/s2 per count or a response attached to the trace"
        )
    file = SourceFile(where, b"", bytes)
    samples = np.asarray(np.ma.getdata(trace.data), dtype=float)
    found = ConvertedCounts(samples, factor, (), ())
    if units == "counts":
        if factor is None and stats.get("response") is None:
            raise RecordRefused(
                f"{where}: counts without a gain; give the factor in m/s2 per count, or attach the station's response "
                "(trace.attach_response(inventory))"
            )
        if factor is None:
            found = from_counts(where, samples, float(stats.delta), stats.response, response)
        if found.factor is None or not np.isfinite(found.factor) or found.factor == 0.0:
            raise UnitError(f"{where}: expected a factor in m/s2 per count other than 0, found {found.factor!r}")
    elif factor is not None:
        raise UnitError(f"{where}: a factor belongs to units='counts', found units={units!r}; give one of the two")
    record = build_record(
        file,
        found.samples,
        float(stats.delta),
        units if units == "counts" else canonical_unit(units, "option units"),
        factor=found.factor,
        format="obspy",
        processed=None,
        component=stats.channel,
        facing=None if azimuth is None else Direction("horizontal", azimuth % 360.0),
        **codes_of(stats),
        start_time=None if stats.starttime.timestamp == 0.0 else utc_time(file, stats.starttime),
        warnings=found.warnings,
        processing=[*_steps(stats), *found.processing],
    )
    return replace(record, source="", source_sha256="")


@lru_cache(maxsize=1)
def _recognised(head: bytes, name: str) -> str:
    """Return the name of the format that recognises a file; cached, as obspy tries every plugin."""
    return next((row.name for row in FORMATS if row.detect(head, name)), "")


def _head(file: str | BinaryIO) -> tuple[bytes, str]:
    """Return the first bytes and the name of a file; the position in an open file does not change."""
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
    """A format as a plugin of obspy, with the two functions that obspy requires."""

    row: Format

    def is_format(self, file: str | BinaryIO) -> bool:
        """Return whether a path or an open binary file is in this format, by the rules of rockpulse."""
        if self.row.name in _BY_NAME_ONLY:
            return False
        try:
            head, name = _head(file)
        except (RockpulseError, OSError):  # an empty file, a damaged gzip file or a folder is left to obspy
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
        """Read every channel of a file into an obspy Stream in m/s2, with the options of `rockpulse.read`."""
        # obspy cuts the traces to the times afterwards; its own readers ignore options of other formats, too.
        import obspy

        if others:
            message = "%s: obspy.read was given options that this format does not have: %s"
            logger.warning(message, self.row.name, ", ".join(others))
        options = ReadOptions(units, dt, response)
        source: SourceFile = open_source(Path(file)) if isinstance(file, str | os.PathLike) else open_stream(file)
        if not self.row.detect(source.head, source.name):
            expected, advice = f"{self.row.what} (recognised by {self.row.recognised})", "or name the right one"
            raise RecordFormatError(f"{source.name}: expected {expected}; leave the format out, {advice}")
        traces = [to_trace(record) for record in self.row.read(source, options)]
        return obspy.Stream([obspy.Trace(header=trace.stats) for trace in traces] if headonly else traces)


#: The plugins by their names in obspy.
PLUGINS = {row.name.upper(): Plugin(row) for row in FORMATS if row.unit != "-" and not row.obspy_reads}


def __getattr__(name: str) -> Plugin:
    """Return the plugin of a format by its upper-case name, such as ``obspy_plugin.AT2``."""
    if name not in PLUGINS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return PLUGINS[name]
