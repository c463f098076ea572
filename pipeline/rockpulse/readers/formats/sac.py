"""SAC binary files; the unit is not in the header."""

import math
import struct

import numpy as np

from rockpulse.errors import UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.kit.obspy_bridge import codes_of, obspy_stream, seed_direction, utc_time

#: Length of the header, and offsets of the words NPTS and NVHDR [bytes].
_HEADER, _NPTS, _NVHDR = 632, 4 * 79, 4 * 76
#: Offsets of the words DELTA, DEPMIN, DEPMAX, B, E: interval, extremes, times of the first and the last sample.
_STATED = {"delta": 0, "depmin": 4, "depmax": 8, "b": 20, "e": 24}
_UNDEFINED = -12345.0
_COORDINATES = {"STLA": 31, "STLO": 32, "EVLA": 35, "EVLO": 36}
_ACCELERATION = 8  # value of IDEP
_SERIES = {6: "displacement", 7: "velocity"}  # values of IDEP that exclude acceleration
_LAST_STEPS = 2.0  # largest error of E [steps]


def _byte_order(head: bytes) -> str | None:
    """Return the byte order in which the version number of the header is valid; None if it is valid in neither."""
    if len(head) < _HEADER:
        return None
    orders = (order for order in "<>" if struct.unpack_from(order + "i", head, _NVHDR)[0] in (6, 7))
    return next(orders, None)


def read_sac(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of a SAC file; `options.units` is required, as the header does not state the unit."""
    order = _byte_order(file.head)
    if order is None:
        raise kit.unexpected(file.name, "a SAC header of version 6 or 7", "none", "is it a SAC file?")
    declared = struct.unpack_from(f"{order}i", file.content, _NPTS)[0]
    available = (len(file.content) - _HEADER) // 4
    if not 1 <= declared <= available:
        advice = "the file may be truncated: download it again"
        raise kit.unexpected(file.name, f"{declared} samples (header NPTS)", f"room for {available}", advice)
    for name, word in _COORDINATES.items():
        # obspy shifts longitudes by 360 degrees until they are in range, which never ends for absurd values.
        value = struct.unpack_from(f"{order}f", file.content, 4 * word)[0]
        if value != _UNDEFINED and not abs(value) <= 360.0:
            advice = "correct the header, or write the file again"
            raise kit.unexpected(file.name, f"degrees in the header word {name}", f"{value:g}", advice)
    (trace,), notes = obspy_stream(file, "SAC")
    stats = trace.stats
    header = stats.sac
    if header.get("iftype", 1) != 1 or not header.get("leven", 1):
        expected = "an equally spaced time series (IFTYPE 1, LEVEN true)"
        found = f"IFTYPE {header.get('iftype')}, LEVEN {header.get('leven')}"
        raise kit.unexpected(file.name, expected, found, "export the record again")
    series = _SERIES.get(header.get("idep"))
    if header.get("idep") not in (*_SERIES, _ACCELERATION) and kit.kind_of_name(file) not in ("", "acceleration"):
        raise kit.other_kind(file.name, kit.kind_of_name(file))
    if series:
        raise kit.NotAcceleration(f"{file.name}: expected an acceleration, but the header (IDEP) says {series}")
    if options.units is None:
        raise UnitError(
            f"{file.name}: a SAC header does not state the unit of acceleration; {kit.GIVE_UNIT.advice(file.name)}",
            kit.GIVE_UNIT,
        )
    unit = kit.canonical_unit(options.units, "option units")
    inclination, azimuth = header.get("cmpinc"), header.get("cmpaz")
    dip = None if inclination is None else float(inclination) - 90.0
    with np.errstate(invalid="ignore"):  # a signalling NaN; Record reports it
        values = np.asarray(trace.data, dtype=float)
    start = utc_time(file, stats.starttime) if "nzyear" in header else None
    # The values in the file, which obspy recalculates; NaN if undefined.
    raw = {key: struct.unpack_from(f"{order}f", file.content, at)[0] for key, at in _STATED.items()}
    words = {key: math.nan if value == _UNDEFINED else value for key, value in raw.items()}
    extremes = (words["depmin"], words["depmax"])
    extremes = extremes if math.isfinite(sum(extremes)) else (math.nan, math.nan)
    last, step = words["b"] + words["delta"] * (declared - 1), words["delta"]
    # E is a float32, which has few digits for large times.
    if abs(words["e"] - last) > _LAST_STEPS * abs(step) + 1e-6 * abs(last):
        found = f"{declared} samples at {step:g} s from {words['b']:g} s (B) end at {last:g} s"
        notes.append(f"the header states {words['e']:g} s as the time of the last sample (E), {found}")

    def stated(name: str) -> float:
        return float(f"{float(header.get(name, math.nan)):.7g}")  # the header stores float32

    # An origin time O equal to B, the time of the first sample, was never set: no record begins at the origin time.
    to_origin = stated("o") - stated("b")
    scale = float(header.get("scale", 1.0))
    if scale != 1.0:
        notes.append(f"the header word SCALE = {scale:g} is not applied")
    return [
        kit.build_record(
            file,
            values,
            # The header stores dt as float32: 0.01 would become 0.00999999977648.
            float(f"{stats.delta:.7g}"),
            unit,
            processed=None,
            component=stats.channel,
            facing=seed_direction(stats.channel, None if azimuth is None else float(azimuth), dip),
            **codes_of(stats),
            event=str(header.get("kevnm", "")).strip(),
            sensor_depth=float(header.get("stdp", math.nan)),
            start_time=start,
            origin_time=kit.later(start, to_origin) if math.isfinite(to_origin) and to_origin != 0.0 else None,
            magnitude=(stated("mag"), ""),
            hypocentre=(stated("evla"), stated("evlo")),
            depth_km=stated("evdp"),
            distance_km=stated("dist"),
            station_place=(stated("stla"), stated("stlo")),
            # The larger absolute value of DEPMIN and DEPMAX, if both are set and one is not 0.
            header_peak=(max(map(abs, extremes)) or math.nan, 0.0),
            warnings=notes,
        )
    ]


SAC = Format(
    name="sac",
    what="SAC, binary",
    recognised="header version",
    unit="must be given (--units)",
    processed="unknown",
    example="T001230.HNE.sac",
    detect=lambda head, name: _byte_order(head) is not None,
    parse=read_sac,
    obspy_reads=True,
)
