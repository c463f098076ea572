"""One record of a site: its scaling to a target, and the facts about it in a site file."""

import math
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.record.defects import drifts
from rockpulse.record.half_wave import half_waves
from rockpulse.record.measures import IMPULSE, MEASURES, STORED_LEVELS, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.selection.directions import Motion
from rockpulse.storage.variables.site import OF_RECORDS
from rockpulse.storage.variables.summary import facts_of
from rockpulse.warning_text import WarningText

#: Usual range of scale factors; a record scaled by more or less would represent another kind of earthquake.
USUAL_FACTORS = (0.25, 4.0)


def measured_value(name: str, record: Record, config: Config) -> float:
    """Return the value of an intensity measure of a conditioned record; `name` is the name of the measure."""
    return float(MEASURES[name].value(RecordOnBodies(record, partial(half_waves, record, **config.half_waves))))


def scale_factor(record: Record, config: Config) -> float:
    """Return the factor [-] that scales a record to the configured target; RecordRefused if the measure is zero."""
    settings = config.calibration
    if settings.scale_to == "none" or settings.target is None:
        return 1.0
    measure = measured_value(settings.scale_to, record, config)
    if not (math.isfinite(measure) and measure > 0.0):
        raise RecordRefused(f"{record.id}: its {settings.scale_to} is {measure:g}, so it cannot be scaled to a target")
    return settings.target / measure


def scaled(record: Record, factor: float) -> Record:
    """Return a record multiplied by a positive factor [-], with a line in its processing history."""
    if factor == 1.0:
        return record
    return replace(record, acceleration=factor * record.acceleration).with_note(f"scaled by {factor:.6g}")


def scaled_motion(motion: Motion, config: Config) -> tuple[Record, float]:
    """Return the record scaled to the target, and its scale factor [-]; raise RecordRefused if this is impossible."""
    conditioned, factor, scale_to = motion.record, scale_factor(motion.record, config), config.calibration.scale_to
    if not USUAL_FACTORS[0] <= factor <= USUAL_FACTORS[1]:
        low, high = USUAL_FACTORS
        conditioned = conditioned.with_warning(WarningText("scaled_far", factor=factor, low=low, high=high))
    if scale_to != "none" and MEASURES[scale_to].drifts and drifts(conditioned):
        conditioned = conditioned.with_warning(WarningText("scaled_to_drift"))
    return scaled(conditioned, factor), factor


def facts_of_record(record: Record, factor: float, config: Config) -> dict[str, Any]:
    """Return the values that a site file stores for one scaled record, by variable."""
    return {
        "record": record.id,
        "source": record.source,
        "source_sha256": record.source_sha256,
        "warnings": "\n".join(record.warnings),
        "processing": "\n".join(record.processing),
        "scale_factor": factor,
        **{one.name: measured_value(one.name, record, config) for one in STORED_LEVELS},
        "largest_impulse": measured_value(IMPULSE, record, config),
        **facts_of(SimpleNamespace(record=record)),
    }


def unusual_factors_warning(factors: np.ndarray) -> list[WarningText]:
    """Return a warning if scale factors of records are unusually small or large, otherwise an empty list."""
    low, high = USUAL_FACTORS
    odd = int(np.count_nonzero((factors < low) | (factors > high)))
    if not odd:
        return []
    ends = {"low": low, "high": high, "least": float(factors.min()), "most": float(factors.max())}
    return [WarningText("scaled_far_in_all", count=odd, total=factors.size, **ends)]


def empty_facts() -> dict[str, np.ndarray]:
    """Return the arrays of :func:`facts_of_record` and "event" without rows."""
    facts = {name: one.values([]) for name, one in OF_RECORDS.items() if name != "weight"}
    return {"record": np.zeros(0, dtype=str), **facts}
