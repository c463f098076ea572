"""Records as `obspy.Trace` and back.

Fields that a Trace has no place for travel in ``trace.stats.rockpulse``, so that the way there and back loses nothing.
Only copies in memory and obspy's PICKLE keep it; the files of other formats do not.
"""

from __future__ import annotations

import re
from dataclasses import MISSING, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.errors import ConfigError, RecordFormatError, RecordRefused, UnitError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clipping import clipping_warning
from rockpulse.readers.facing import Direction
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.instrument import without_response
from rockpulse.readers.obspy_bridge import utc_time
from rockpulse.readers.sensitivity import sensitivity_factor, sensitivity_notes
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Orientation, Record, record_id

if TYPE_CHECKING:
    import obspy

__all__ = ["from_trace", "to_trace"]

_CODES = ("network", "station", "location", "channel")
#: Fields that travel in ``stats.rockpulse``: all of a Record for which a Trace has no place of its own.
_KEPT = tuple(field for field in fields(Record) if field.name not in {*_CODES, "acceleration", "start_time"})
#: Methods of a Trace after which its data are no acceleration in the unit they had before.
_CHANGES_UNIT = {"integrate", "differentiate", "normalize", "remove_response", "remove_sensitivity", "simulate"}
_CHANGES_UNIT |= {"trigger"}
#: Largest relative gap between the interval of a Trace, which keeps the rate, and the one it was made with.
_SAME_STEP = 1e-12


def to_trace(record: Record) -> obspy.Trace:
    """The record as an `obspy.Trace`.

    Parameters
    ----------
    record : Record
        The record.

    Returns
    -------
    obspy.Trace
        ``data`` in m/s2 (a copy that may be changed), ``stats.calib`` 1, codes, interval and start time in ``stats``,
        every other field of the record in ``stats.rockpulse``. Where the record has no start time,
        ``stats.starttime`` is obspy's own default, 1970-01-01, and ``stats.rockpulse.start_time_known`` is False.

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
    """A record from an `obspy.Trace`.

    Parameters
    ----------
    trace : obspy.Trace
        One made by `to_trace` or by ``obspy.read`` through rockpulse needs nothing else, whatever filters it went
        through; any other needs `units`.
    units : str, optional
        Unit of the data: a key of `rockpulse.readers.UNITS`, or "counts".
    factor : float, optional
        m/s2 per count. Without it, counts need ``trace.stats.response`` (``trace.attach_response(inventory)``).
    response : {"sensitivity", "remove"}
        The use of an attached response; see `rockpulse.readers.ReadOptions`.
    azimuth : float, optional
        Direction of a horizontal trace, clockwise from north [degrees]; needed after ``Stream.rotate``, which keeps no
        account of it. A rotation that leaves the channel codes as they were cannot be seen: give the azimuth.

    Returns
    -------
    Record
        In m/s2. The steps in ``stats.processing`` are appended to its own. Where ``stats.rockpulse`` has the id, that
        one stays, even if the trace was cut, unless the codes have changed since: then it is made of the new ones,
        with a warning, and with a new channel code the direction becomes unknown unless `azimuth` is given
        (``dataclasses.replace(record, orientation="vertical")`` where you know better).

    Raises
    ------
    UnitError
        The unit is missing, unknown, contradicts ``stats.rockpulse``, or has changed on the way (integrated).
    RecordRefused
        Masked samples, counts without a gain, or ``stats.calib`` other than 1: in obspy it may mean nm, nm/s or
        anything else per count, so it is never applied. Where `factor` is given it is left alone.
    RecordFormatError
        Fewer than two samples, or samples that are not finite.
    ConfigError
        An azimuth that is not finite.
    """
    where = f"trace {trace.id}"
    if azimuth is not None and not np.isfinite(azimuth):
        raise ConfigError(f"{where}: expected an azimuth in degrees, found {azimuth!r}; leave it out if it is unknown")
    stats = trace.stats
    if np.ma.is_masked(trace.data):
        raise RecordRefused(
            f"{where}: {np.ma.count_masked(trace.data)} samples are masked (a gap); split the trace "
            "(trace.split()) and take one part"
        )
    if stats.calib != 1.0 and factor is None:
        raise RecordRefused(
            f"{where}: stats.calib is {stats.calib:g}, and obspy does not say per what; multiply the data yourself and "
            "set it to 1, or give units='counts' and the factor in m/s2 per count"
        )
    changed = [step for step in _steps(stats) if _changes_unit(step)]
    if changed and (units is None or units == "counts"):
        raise UnitError(
            f"{where}: the values are no longer what they were: {changed[0]}; say which unit of acceleration they "
            f"have, one of {', '.join(UNITS)}"
        )
    kept = stats.get("rockpulse")
    if kept is None:
        return _new(where, trace, units, factor, ReadOptions(response=response), azimuth)
    known = units is None or (units != "counts" and UNITS[canonical_unit(units, "option units")] == 1.0)
    if not known or factor is not None:
        raise UnitError(f"{where}: stats.rockpulse says m/s2; give no units and no factor, or delete stats.rockpulse")
    return _restored(where, trace, kept, azimuth)


def _changes_unit(step: str) -> bool:
    """Whether a line of ``stats.processing`` names a method that changes the unit, ``ObsPy 1.5.1: integrate(...)``."""
    method = re.search(r":\s*(\w+)\(", step)
    return bool(method and method[1] in _CHANGES_UNIT)


def _steps(stats: Any) -> tuple[str, ...]:
    return tuple(map(str, stats.get("processing", ())))


def _restored(where: str, trace: Any, kept: Any, azimuth: float | None) -> Record:
    """The record that a trace with ``stats.rockpulse`` was made from, with the processing since then."""
    missing = [field.name for field in _KEPT if field.default is MISSING and field.name not in kept]
    if missing:
        raise RecordFormatError(
            f"{where}: expected {', '.join(missing)} in stats.rockpulse, found "
            f"{', '.join(sorted(kept)) or 'nothing'}; delete stats.rockpulse and give the units"
        )
    stats = trace.stats
    values = {field.name: kept[field.name] for field in _KEPT if field.name in kept}
    same = abs(stats.delta - values["dt"]) <= _SAME_STEP * values["dt"]
    values["dt"] = values["dt"] if same else float(stats.delta)
    values["warnings"] = tuple(values.get("warnings", ()))
    values["processing"] = (*values.get("processing", ()), *_steps(stats))
    start = utc_time(SourceFile(where, b"", bytes), stats.starttime) if kept.get("start_time_known", True) else None
    codes = {code: stats[code] for code in _CODES}
    record = Record(acceleration=np.ma.getdata(trace.data), start_time=start, **codes, **values)
    codes_before = kept.get("codes")
    if codes_before is None or dict(codes_before) != codes:
        record = _renamed(record, codes_before, azimuth is None)
    if azimuth is None or azimuth % 360.0 == record.azimuth:
        return record
    orientation: Orientation = "structural" if record.orientation == "structural" else "horizontal"
    return replace(record, azimuth=azimuth % 360.0, orientation=orientation, component="")


def _renamed(record: Record, before: dict[str, str] | None, undirected: bool) -> Record:
    """The record without the fields that its former codes told; `undirected` if nobody says where it points."""
    stem = SourceFile(record.source, b"", bytes).path.stem or record.station_name or "trace"
    codes = (record.network, record.station, record.location, record.channel)
    record = replace(record, id=record_id(*codes, record.start_time, stem, 1))
    old = "unknown" if before is None else ".".join(before[code] for code in _CODES)
    told = f"the codes were {old} when the trace was made; the id was made anew"
    if before is not None and before["channel"] == record.channel:
        return record.with_warning(told)
    orientation: Orientation = "structural" if record.orientation == "structural" else "unknown"
    record = replace(record, component="", orientation=orientation, azimuth=float("nan"))
    return record.with_warning(told + (" and the direction is no longer known" if undirected else ""))


def _new(
    where: str, trace: Any, units: str | None, factor: float | None, options: ReadOptions, azimuth: float | None
) -> Record:
    """A record from a trace of which only obspy's own fields are known."""
    stats = trace.stats
    if units is None:
        raise UnitError(
            f"{where}: a trace does not state the unit of its data; give units, one of {', '.join(UNITS)}, or counts "
            "with a factor in m/s2 per count or a response attached to the trace"
        )
    file = SourceFile(where, b"", bytes)
    samples = np.asarray(np.ma.getdata(trace.data), dtype=float)
    notes: list[str] = []
    warnings: list[str] = []
    if units != "counts":
        if factor is not None:
            raise UnitError(f"{where}: a factor belongs to units='counts', found units={units!r}; give one of the two")
        unit = canonical_unit(units, "option units")
    else:
        unit = units
        if factor is None and stats.get("response") is None:
            raise RecordRefused(
                f"{where}: counts without a gain; give the factor in m/s2 per count, or attach the station's response "
                "(trace.attach_response(inventory))"
            )
        if factor is None and options.response == "remove":
            removed = without_response(where, samples, float(stats.delta), stats.response)
            notes, warnings = [removed.note], [*clipping_warning(samples), *removed.warnings]
            samples, factor = removed.samples, removed.factor
        elif factor is None:
            factor = sensitivity_factor(where, stats.response)
            warnings = sensitivity_notes(stats.response)
        if not (np.isfinite(factor) and factor != 0.0):
            raise UnitError(f"{where}: expected a factor in m/s2 per count other than 0, found {factor!r}")
    record = build_record(
        file,
        1,
        samples,
        float(stats.delta),
        unit,
        factor=factor,
        format="obspy",
        processed=None,
        component=stats.channel,
        facing=None if azimuth is None else Direction("horizontal", azimuth % 360.0),
        channel=stats.channel,
        network=stats.network,
        station=stats.station,
        location=stats.location,
        start_time=None if stats.starttime.timestamp == 0.0 else utc_time(file, stats.starttime),
        warnings=warnings,
        processing=[*_steps(stats), *notes],
    )
    return replace(record, source="", source_sha256="")
