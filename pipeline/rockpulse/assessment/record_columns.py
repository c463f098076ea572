"""What the results say of a record, apart from the answers of the models."""

from __future__ import annotations

from typing import Any

import numpy as np

from rockpulse.ladder import Scene
from rockpulse.record.intensity import arias_intensity, pgv
from rockpulse.remark import find, with_codes

__all__ = ["main_impulse", "record_scalars"]


def main_impulse(scene: Scene) -> float:
    """Main impulse of the calibrated sequence [m/s]; NaN where the record gave no sequence.

    Parameters
    ----------
    scene : Scene
        The record and what was extracted from it.
    """
    return np.nan if scene.sequence is None else float(scene.sequence.main)


def record_scalars(scene: Scene) -> dict[str, Any]:
    """The columns of a record, by the names of docs/schema.md.

    Parameters
    ----------
    scene : Scene
        The conditioned record and what was extracted from it.

    Returns
    -------
    dict of str to object
        The earthquake, `event`, is empty: all records together tell it.
    """
    record, sequence = scene.record, scene.sequence
    warnings, codes = with_codes(record.warnings)
    vertical = find(record.processing, "vertical_acceleration")
    count = -1
    if sequence is not None and sequence.main_count is not None:
        count = int(sequence.main_count)
    return {
        "source": record.source,
        "source_sha256": record.source_sha256,
        "format": record.format,
        "event": "",
        "event_title": record.event,
        "network": record.network,
        "station": record.station,
        "station_name": record.station_name,
        "component": record.component,
        "azimuth": record.azimuth,
        "start_time": "" if record.start_time is None else record.start_time.isoformat(),
        "npts": record.npts,
        "dt": record.dt,
        "pga": record.pga,
        "pgv": pgv(record),
        "pgv_drift": int(find(record.warnings, "baseline_drift") is not None),
        "arias_intensity": arias_intensity(record),
        "intense_start": scene.phase.start,
        "intense_end": scene.phase.end,
        "main_impulse": main_impulse(scene),
        "secondary_impulse": np.nan if sequence is None else float(sequence.secondary),
        "secondary_interval": np.nan if sequence is None else float(sequence.interval),
        "sequence_duration": np.nan if sequence is None else float(sequence.duration),
        "main_count": count,
        "half_wave_count": int(scene.waves.impulse.size),
        "warnings": warnings,
        "warning_codes": codes,
        "processing": "\n".join(record.processing),
        "vertical_channel": "" if vertical is None else vertical.values["record"],
    }
