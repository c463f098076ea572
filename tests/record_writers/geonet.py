"""GeoNet V1A and V2A (New Zealand): per component text, integers, reals, and blocks of ten fields of 8 characters."""

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.readers.kit.direction import direction
from rockpulse.record.record import Record

START = datetime(2016, 11, 13, 11, 2, 20, tzinfo=UTC)
ORIGIN = datetime(2016, 11, 13, 11, 2, 56, tzinfo=UTC)


def geonet(
    columns: Sequence[Sequence[float]],
    components: Sequence[str] = ("N10E", "N80W", "Up"),
    corrected: bool = False,
    dt: float = 0.005,
    reading: float = 1.0,
    site: str = "HSES",
    place: str = "Hanmer Springs Emergency Centre",
    start: datetime = START,
    origin: datetime = ORIGIN,
) -> bytes:
    """A file of several components, accelerations in mm/s2, V1A (in units of `reading` [mm/s2]) or V2A."""
    lines: list[str] = []
    name = f"{origin:%Y%m%d_%H%M%S}_{site}_20"
    for values, component in zip(columns, components, strict=True):
        count = len(values)
        at = int(np.argmax(np.abs(values)))
        stated = values[at]
        velocity = dt * np.cumsum(values)
        displacement = dt * np.cumsum(velocity)
        integers = [origin.year, origin.month, origin.day, origin.hour, origin.minute, 10 * origin.second, 0, 0]
        integers += [start.year, start.month, 35, 46, 12, 117, 35, 56, 8, 0, start.day, start.hour]
        azimuth = direction(component).azimuth
        integers += [35, 48, 57, 117, 35, 51, 10, 0 if np.isnan(azimuth) else round(azimuth), 2, 5]
        blocks = [count] * 3 if corrected else [count, 0, 0]
        integers += [count, 0, 0, *blocks, 0, 0, start.minute, 1000 * start.second + start.microsecond // 1000]
        duration = (count - 1) * dt
        lines += [
            f"{'C' if corrected else 'Unc'}orrected accelerogram {name} ",
            f"Site {site:9s} 35 48 57N  117 35 51W     Basalt file:  20161113_110300_{site}",
            place,
            "Instrument Basalt_2430",
            "Resolution: 24-bit   Instr Period: 0.0050 s   Damping: 0.700",
            f"Accelerogram {name:<40s}Processed 2016 December 09",
            NOTE,
            f"{origin:%Y %B %d}         {origin:%H:%M:%S} UT",
            "Epicentre  35 46 12N 117 35 56W  Bearing N02E  Dist    5km  Depth    8km Mw 7.10",
            f"Number of points {count:6d}    Duration {duration:6.2f} s",
            f"Instrument corrected data at {dt:5.3f} sec intervals"
            if corrected
            else f"Raw readings in units of {reading:.2f} mm/s/s  at intervals of {dt:5.3f} s",
            "Band-pass filter transition bands are .10-.25 Hz and 24.50-25.50 Hz"
            if corrected
            else "Data is unfiltered",
            f"Component {component}  Longitudinal Accelerometer Axis" if corrected else f"Component {component}",
            f"Acceleration:  {'p' if corrected else 'P'}eak {stated:8.1f} mm/s/s at {at * dt:6.2f} s     "
            "RMS   209.89 mm/s/s",
            *(
                [
                    f"Velocity:      peak {np.max(np.abs(velocity)):8.2f} mm/s   at  66.08 sec     rms    13.55 mm/s",
                    f"Displacement:  peak {np.max(np.abs(displacement)):8.3f} mm     at 115.40 sec     rms    6.245 mm",
                ]
                if corrected
                else ["Velocity record unevaluated", "Displacement record unevaluated"]
            ),
            *rows([f"{integer:8d}" for integer in integers], 10),
            "   200.0    0.70    0.00   0.000  0.0000   0.000   0.000   1.000     0.0    0.00",
            "  35.816 117.598  35.770 117.599    7.10    0.00    0.00    0.00      0.      0.",
            f"{duration:8.2f}    0.00    0.00{duration:8.2f}  0.0050{dt:8.4f}      0.      0.      0.  9806.6",
            f"{stated:8.1f}{at * dt:8.2f}   209.9      0.      0.     0.0    0.00     0.0     0.0   0.000",
            "    0.00    0.00    0.00    0.00   0.000    0.00    0.00    0.00    0.00   0.000",
            "   0.000   0.000   0.000      0.      0.   0.000   0.000   0.000      0.      0.",
            *rows([f"{value / reading:8.1f}" for value in values], 10),
        ]
        if corrected:
            lines += rows([f"{value:8.2f}" for value in velocity], 10)
            lines += rows([f"{value:8.3f}" for value in displacement], 10)
    return ("\n".join(lines) + "\n").encode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels, uncorrected and corrected."""
    columns = [1000.0 * channel.acceleration for channel in channels]
    start, dt = channels[0].start_time, channels[0].dt
    origin = start.replace(second=53, microsecond=0)
    common = {"dt": dt, "site": "CLC", "place": "China Lake", "start": start}
    return {
        f"clc_geonet.V{volume}A": geonet(
            columns, ("N90E", "N00E", "Up"), corrected=volume == 2, origin=origin, **common
        )
        for volume in (1, 2)
    }
