"""One record of a site: scaling to a target, its sequence, and the response of the blocks."""

import math
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.assessment.scene import extract
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused, TooWeak
from rockpulse.record.defects import drifts
from rockpulse.record.half_wave import half_waves
from rockpulse.record.measures import IMPULSE, MEASURES, STORED_LEVELS, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.run.analysis import Part, Watch
from rockpulse.selection.directions import Motion
from rockpulse.storage.variables.site import OF_RECORDS
from rockpulse.storage.variables.summary import facts_of
from rockpulse.studies.site.design import PARAMETERS
from rockpulse.warning_text import WarningText, find

#: Smallest theta_max/alpha_c that is compared [-]; the smallest rotations cannot be compared with a sequence.
SMALLEST_PEAK = 0.01
#: Usual range of scale factors; a record scaled by more or less would represent another kind of earthquake.
USUAL_FACTORS = (0.25, 4.0)


def measured_value(name: str, record: Record, config: Config) -> float:
    """Return the value of a named intensity measure of a conditioned record."""
    return float(MEASURES[name].value(RecordOnBodies(record, partial(half_waves, record, **config.half_waves))))


def scale_factor(record: Record, config: Config) -> float:
    """Return the factor [-] that scales a record to the configured target; RecordRefused for a measure of zero."""
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


def block_family() -> Block:
    """Return 100 standard blocks: p from 1 to 5 1/s, slenderness from 12.5 to 3, C from 0.6 to 1 times Housner's C."""
    axes = np.geomspace(1.0, 5.0, 5), np.geomspace(0.08, 0.32, 5), [1.0, 0.9, 0.75, 0.6]
    p, alpha, share = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    return Block.from_parameters(p, alpha, share * (1.0 - 1.5 * np.sin(alpha) ** 2))


def rotation_to_cover(peaks: np.ndarray) -> np.ndarray:
    """Return the rotations to cover, from peaks theta_max/alpha_c: NaN at rest, inf if overturned or unresolved."""
    return np.where(peaks == 0.0, np.nan, np.where(np.isnan(peaks), np.inf, peaks))


def site_record(motion: Motion, watch: Watch, blocks: Block, config: Config) -> Part:
    """Scale a record, derive its sequence and apply the record to (m,) blocks; return arrays (1, ...) by name.

    "value" (1, 5) are the parameters of the sequence; NaN for a parameter without a value. "peaks" (1, m) are the
    peak rotations theta_max/alpha_c under the record: inf if overturned, 0 at rest, NaN if unresolved. Raises
    ValueError if the record cannot be scaled or has no sequence, TooWeak if it moves no block.
    """
    with watch("solve"):
        conditioned, factor = scaled_motion(motion, config)
        vertical = None if motion.vertical is None else scaled(motion.vertical, factor)
        scene = extract(conditioned, config, vertical)
        record = scene.record
        response = recorded_response(blocks, record.acceleration, record.dt, vertical=scene.vertical)
        peaks = np.where(response.outcome == Outcome.UNRESOLVED, np.nan, response.peak_rotation_ratio)
        if scene.sequence is None:
            reason = find(record.warnings, "no_sequence")
            raise (RecordRefused if np.any(peaks != 0.0) else TooWeak)(str(reason))
        misfit, unsafe = _compared(peaks, scene.sequence, blocks)
    found = {
        **facts_of_record(record, factor, config),
        "misfit": misfit,
        "unsafe_share": unsafe,
        "value": parameters_of(scene.sequence),
        "peaks": peaks,
    }
    return {name: np.array([values]) for name, values in found.items()}


def empty_site_record(blocks: Block) -> Part:
    """Return the arrays of :func:`site_record` and "event" without rows, for (m,) blocks."""
    return {
        **empty_facts(),
        **dict.fromkeys(("misfit", "unsafe_share"), np.zeros(0)),
        "value": np.zeros((0, len(PARAMETERS))),
        "peaks": np.zeros((0, *blocks.shape)),
    }


def scaled_motion(motion: Motion, config: Config) -> tuple[Record, float]:
    """Return the record scaled to the target, and the factor [-]; raise RecordRefused if scaling is impossible."""
    conditioned, factor, scale_to = motion.record, scale_factor(motion.record, config), config.calibration.scale_to
    if not USUAL_FACTORS[0] <= factor <= USUAL_FACTORS[1]:
        low, high = USUAL_FACTORS
        conditioned = conditioned.with_warning(WarningText("scaled_far", factor=factor, low=low, high=high))
    if scale_to != "none" and MEASURES[scale_to].drifts and drifts(conditioned):
        conditioned = conditioned.with_warning(WarningText("scaled_to_drift"))
    return scaled(conditioned, factor), factor


def facts_of_record(record: Record, factor: float, config: Config) -> dict[str, Any]:
    """Return the values of one scaled record that a site file stores, by variable."""
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


def empty_facts() -> dict[str, np.ndarray]:
    """Return the arrays of :func:`facts_of_record` and "event" without rows."""
    facts = {name: one.values([]) for name, one in OF_RECORDS.items() if name != "weight"}
    return {"record": np.zeros(0, dtype=str), **facts}


def parameters_of(sequence: ImpulseSequence) -> list[float]:
    """Return the parameters of a sequence in the order of PARAMETERS; NaN for an unlimited count or duration."""
    return [
        float(sequence.main),
        float(sequence.secondary / sequence.main),
        float(sequence.interval),
        math.nan if sequence.main_count is None else float(sequence.main_count),
        float(sequence.duration) if math.isfinite(sequence.duration) else math.nan,
    ]


def _compared(peaks: np.ndarray, sequence: ImpulseSequence, blocks: Block) -> tuple[float, float]:
    """Return the rms error of the sequence in ln peak rotation, and the share of lifted blocks not covered."""
    reached = np.asarray(sequence_response(blocks, sequence, table_rows=0).peak_rotation_ratio)
    needed = rotation_to_cover(peaks)
    lifted = ~np.isnan(needed) & ~np.isnan(reached)
    both = lifted & np.isfinite(needed) & np.isfinite(reached) & (needed >= SMALLEST_PEAK) & (reached > 0.0)
    misfit = float(np.sqrt(np.mean(np.log(reached[both] / peaks[both]) ** 2))) if np.any(both) else math.nan
    unsafe = float(np.mean(reached[lifted] < needed[lifted])) if np.any(lifted) else math.nan
    return misfit, unsafe
