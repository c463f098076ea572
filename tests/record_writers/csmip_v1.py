"""CSMIP volume 1, old layout of pairs and new layout of equal steps."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, azimuth_code, peak_time, rows
from rockpulse.record.record import STANDARD_GRAVITY, Record


def _csmip_header(number, component, place, count, length, unit_line, start, note, peak, at) -> list[str]:
    location = f"  (STA CHN: {number:2d})     LOCATION: {place}" if place else ""
    return [
        "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 02/08/94, TEST",
        note,
        "JANUARY 17, 1994 04:31 PST",
        f"14403-S3492-94021.02               TRIGGER TIME: {start}",
        "STATION NO. 14403   35.816N, 117.598W     SMA-1  S/N 3492",
        "TEST STATION",
        f"CHAN {number:2d}: {component}{location}",
        "TEST EARTHQUAKE     JANUARY 17, 1994 04:31 PST",
        "HYPOCENTER: 35.770N, 117.599W, H=8KM. MW=7.1",
        "INSTR PERIOD =  .0397 SEC,  DAMPING =  .592,  SENSITIVITY = 1.77 CM/G.",
        f"NO. OF POINTS = {count:6d}  RECORD LENGTH ={length:7.3f} SEC",
        unit_line,
        "RMS ACCEL OF COMPLETE RECORD =  .021 G.",
        "    0" * 16,
        f"{'    0' * 10}{azimuth_code(component):5d}{count % 100_000:5d}{'    0' * 4}",
        *["    0" * 16] * 4,
        "    0" * 4,
        f"{'      .000' * 2}{length:10.3f}{'      .000' * 3}{peak:10.3f}{at:10.3f}",
        *["      .000" * 8] * 5,
        "      .000" * 2,
    ]


def csmip_pairs(
    times, values, number=1, component=" 90 DEG", start="01/17/94, 12:31:04.1 UTC", note="TEST EARTHQUAKE"
) -> bytes:
    """One channel in the old layout: (time, acceleration in g/10) pairs of width 7."""
    peak = np.max(np.abs(values)) / 10.0
    at = times[int(peak_time(values))] if len(times) else 0.0
    unit_line = f"UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  =  {peak:5.3f} G, AT {at:7.3f} SEC."
    fields = [f"{number:7.3f}" for pair in zip(times, values, strict=True) for number in pair]
    length = times[-1] if len(times) else 0.0
    header = _csmip_header(number, component, "", len(values), length, unit_line, start, note, peak, at)
    lines = header + rows(fields, 10)
    lines.append(f"/&  ----------  END OF DATA FOR CHANNEL {number:2d}  ----------")
    return ("\r\n".join(lines) + "\r\n").encode("latin-1")


def csmip_equal(
    values: Sequence[float],
    heading: str = "{n:6d} Accelerogram points at 100 pts/sec in units of g.       Format: (8f9.6)",
    number: int = 1,
    component: str = " 90 DEG",
    place: str = "",
    dt: float = 0.01,
    start: str = "7/06/19, 03:16: 8.5 UTC (GPS)",
    end: str = "\r\n",
    note: str = "TEST EARTHQUAKE",
) -> bytes:
    """One channel in the new layout: equal steps, in g unless the heading says otherwise."""
    peak = np.max(np.abs(values))
    at = peak_time(values, dt)
    unit_line = f"UNITS OF UNCOR DATA ARE SEC AND G.         MAX  = {peak:6.3f} G, AT {at:7.3f} SEC."
    length = dt * len(values)
    lines = _csmip_header(number, component, place, len(values), length, unit_line, start, note, peak, at)
    lines += [heading.format(n=len(values)), *rows([f"{value:9.6f}" for value in values], 8)]
    lines.append(f"/&  ----------  END OF DATA FOR CHANNEL {number:2d}  ----------")
    return (end.join(lines) + end).encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels in each layout."""
    start = "07/06/19, 03:19:58.0 UTC"
    old, new = b"", b""
    for number, (channel, component) in enumerate(zip(channels, ("090 DEG", "360 DEG", "UP"), strict=True), start=1):
        values = channel.acceleration / STANDARD_GRAVITY
        old += csmip_pairs(channel.time, 10.0 * values, number, component, start=start, note=NOTE)
        new += csmip_equal(values, number=number, component=component, start=start, note=NOTE)
    return {"CLC_OLD.V1": old, "CLC_NEW.V1": new}
