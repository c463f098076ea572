"""Design spectrum of a site (predictive quantiles of overturning spectra over earthquakes), and sequences of bodies.

.. note:: At every p and C the probability that another earthquake exceeds the design spectrum is 1 - quantile
   (:func:`rockpulse.earthquakes.record_quantiles`). The intervals are from resampling earthquakes. With fewer than
   1/(1 - quantile) earthquakes there is no design spectrum. I_s/I, dT and the number of main impulses are the weighted
   medians of the sequences of the records (:func:`rockpulse.record_sequence`).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.main_sequence import critical_impulse
from rocking.impulses.sequence import sequence_response
from rocking.spectrum.overturning import OverturningSpectrum
from rockpulse.assessment.scene import extract
from rockpulse.assessment.spectra import LANES
from rockpulse.config.configuration import Config
from rockpulse.earthquakes import ROUNDING, Quantiles, draw_earthquakes, record_quantiles
from rockpulse.errors import RecordRefused
from rockpulse.record.defects import drifts
from rockpulse.record.half_wave import half_waves
from rockpulse.record.measures import IMPULSE, MEASURES, STORED_LEVELS, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.run.analysis import Part, Watch
from rockpulse.selection.directions import Motion
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.variables import with_values
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.storage.variables.site import OF_RECORDS, SITE, SITE_AXES, SPECTRA, SPECTRA_AXES
from rockpulse.storage.variables.summary import facts_of
from rockpulse.warning_text import WarningText, as_stored

#: Usual range of scale factors; a record scaled by more or less would represent another kind of earthquake.
USUAL_FACTORS = (0.25, 4.0)


def measured_value(name: str, record: Record, config: Config) -> float:
    """Return the value of an intensity measure of a conditioned record; `name` is the name of the measure."""
    return float(MEASURES[name].value(RecordOnBodies(record, partial(half_waves, record, **config.half_waves))))


def scaled_motion(motion: Motion, config: Config) -> tuple[Record, float]:
    """Return the record scaled to the target, and its scale factor [-]; raise RecordRefused if its measure is zero."""
    record, settings, factor = motion.record, config.calibration, 1.0
    if settings.scale_to != "none" and settings.target is not None:
        measure = measured_value(settings.scale_to, record, config)
        if not (math.isfinite(measure) and measure > 0.0):
            name = settings.scale_to
            raise RecordRefused(f"{record.id}: its {name} is {measure:g}, so it cannot be scaled to a target")
        factor = settings.target / measure
    low, high = USUAL_FACTORS
    if not low <= factor <= high:
        record = record.with_warning(WarningText("scaled_far", factor=factor, low=low, high=high))
    if settings.scale_to != "none" and MEASURES[settings.scale_to].drifts and drifts(record):
        record = record.with_warning(WarningText("scaled_to_drift"))
    if factor != 1.0:
        record = replace(record, acceleration=factor * record.acceleration).with_note(f"scaled by {factor:.6g}")
    return record, factor


#: Smallest number of earthquakes for a design spectrum.
FEWEST_EVENTS = 5
#: For each parameter of the design sequence: the variable of the records whose median it is.
SHAPE = {"ratio": "record_ratio", "interval": "record_interval", "main_count": "record_main_count"}
#: Ends of the names of three variables: a value, and the lower and upper end of its interval.
ENDS = ("", "_lower", "_upper")
#: Quantiles in every file in addition to the design quantile, by name.
STATED = {"spectrum_50": 0.5, "spectrum_84": 0.84}


def site_spectrum_record(motion: Motion, watch: Watch, config: Config) -> Part:
    """Return spectrum, sequence and facts of a scaled record as arrays (1, ...); RecordRefused if it is all zeros."""
    with watch("solve"):
        record, factor = scaled_motion(motion, config)
        if record.pga == 0.0:
            raise RecordRefused(f"{record.id}: all samples are zero, so that there is no overturning spectrum")
        scene = extract(record, config)
        record = scene.record
        lanes = LANES[config.calibration.spectrum](record, waves=scene.waves, rotations=False)
        own = scene.sequence
        shape = [math.nan] * 3 if own is None else [own.secondary / own.main, own.interval, own.main_count]
        found = {
            "record": record.id,
            "source": record.source,
            "source_sha256": record.source_sha256,
            "warnings": "\n".join(record.warnings),
            "processing": "\n".join(record.processing),
            "scale_factor": factor,
            **{one.name: measured_value(one.name, record, config) for one in STORED_LEVELS},
            "largest_impulse": measured_value(IMPULSE, record, config),
            **facts_of(scene),
            "spectrum": OverturningSpectrum(lanes).spectrum(RESTITUTIONS),
            **dict(zip(SHAPE.values(), np.array(shape, dtype=float).tolist(), strict=True)),
        }
    return {name: np.array([values]) for name, values in found.items()}


def empty_spectrum_record() -> Part:
    """Return the arrays of :func:`site_spectrum_record`, and "event", with no rows."""
    facts = {name: one.values([]) for name, one in OF_RECORDS.items() if name != "weight"}
    shape = dict.fromkeys(SHAPE.values(), np.zeros(0))
    spectrum = np.zeros((0, RATES.size, RESTITUTIONS.size))
    return {"record": np.zeros(0, dtype=str), **facts, "spectrum": spectrum, **shape}


def fewest_events(quantile: float) -> int:
    """Return how many earthquakes a quantile requires: the largest of 5, 1/quantile and 1/(1 - quantile)."""
    return max(FEWEST_EVENTS, math.ceil((1.0 - ROUNDING) / min(quantile, 1.0 - quantile)))


def spectrum_design(
    done: Mapping[str, np.ndarray],
    weights: np.ndarray,
    block_names: Sequence[str],
    blocks: Block | None,
    config: Config,
    warnings: Sequence[str],
) -> dict[str, xr.Dataset]:
    """Return the groups /site and /spectra: quantiles of the spectra, the design sequence, and the bodies."""
    settings = config.calibration
    names, numbers = np.unique(done["event"], return_inverse=True)
    counted = weights > 0.0
    events = np.unique(numbers[counted], return_inverse=True)[1]
    count, least = int(events.max()) + 1, fewest_events(settings.quantile)
    spectra: dict[str, Any] = {"spectrum": done["spectrum"]}
    shape: dict[str, Any] = {f"{name}{end}": math.nan for name in SHAPE for end in ENDS}
    enough = count >= least
    if enough:
        draws = draw_earthquakes(count, settings.bootstrap, [config.run.seed, *b"site"])
        quantiles = partial(record_quantiles, draws=draws, confidence=settings.confidence)
        levels = {**STATED, "spectrum_design": settings.quantile}
        own = done["spectrum"][counted]
        distinct = sorted(set(levels.values()))
        found = quantiles(own, distinct, True, weights=weights[counted], events=events)
        for name, level in levels.items():
            spectra |= {f"{name}{end}": one for end, one in zip(ENDS, found[distinct.index(level)], strict=True)}
        shape = _shape(done, weights, numbers, quantiles)
    else:
        few = WarningText("too_few_events", count=count, least=int(least), quantile=float(settings.quantile))
        warnings = [few, *warnings]
        sizes = {"p": RATES.size, "restitution": RESTITUTIONS.size}
        others = {name: one.dims for name, one in SPECTRA.items() if name not in spectra}
        spectra |= {name: np.full([sizes[dim] for dim in dims], math.nan) for name, dims in others.items()}
    of_bodies = _bodies(spectra, shape, blocks, weights if enough else np.zeros(weights.size), config.sequence.spacing)
    effects = zip(block_names, of_bodies["effective_impulse"].tolist(), strict=True)
    outside = [str(name) for name, effect in effects if enough and math.isnan(effect)]
    if outside:
        warnings = [*warnings, WarningText("outside_spectrum", names=", ".join(outside))]
    if config.records.include_vertical:
        warnings = [*warnings, WarningText("vertical_left_out")]
    factors, (low, high) = done["scale_factor"], USUAL_FACTORS
    if odd := int(np.count_nonzero((factors < low) | (factors > high))):
        ends = {"low": low, "high": high, "least": float(factors.min()), "most": float(factors.max())}
        warnings = [*warnings, WarningText("scaled_far_in_all", count=odd, total=factors.size, **ends)]
    site = {
        "quantile": settings.quantile,
        "confidence": settings.confidence,
        "resamples": settings.bootstrap,
        "record_count": np.count_nonzero(counted),
        "event_count": count,
        "site_warnings": "\n".join(warnings),
        "site_warning_values": as_stored(warnings),
        **{name: done[name] for name in OF_RECORDS if name != "weight"},
        **{name: done[name] for name in SHAPE.values()},
        "weight": weights,
        "event_records": np.bincount(numbers),
        **shape,
        **of_bodies,
    }
    axes = {"record": done["record"], "block": list(block_names), "site_event": names}
    along = {"record": done["record"], "p": RATES, "restitution": RESTITUTIONS}
    stated = {"spectrum": settings.spectrum, "spacing": config.sequence.spacing}
    return {
        "/site": xr.Dataset(with_values(SITE, site), with_values(SITE_AXES, axes), stated),
        "/spectra": xr.Dataset(with_values(SPECTRA, spectra), with_values(SPECTRA_AXES, along)),
    }


def _shape(
    done: Mapping[str, np.ndarray], weights: np.ndarray, numbers: np.ndarray, quantiles: Callable[..., list[Quantiles]]
) -> dict[str, float]:
    """Return I_s/I, dT and the number of main impulses (medians over the records) by name, with their intervals."""
    known = (weights > 0.0) & np.isfinite(done["record_interval"])
    if not np.any(known):
        raise RecordRefused(
            "no record has the three half-waves in its intense phase that a sequence needs; choose a longer intense "
            "phase, or a lower half-wave threshold"
        )
    found: dict[str, float] = {}
    for name, of_record in SHAPE.items():
        values = done[of_record][known]
        values = np.log(values) if name == "interval" else values
        (one,) = quantiles(values, [0.5], False, weights=weights[known], events=numbers[known])
        middle, low, high = (float(end) for end in one)
        if name == "interval":
            middle, low, high = math.exp(middle), math.exp(low), math.exp(high)
        elif name == "ratio":
            low, high = max(low, 0.0), min(high, 1.0)
        else:
            low, high = max(math.floor(low), 1.0), math.ceil(high)
        found |= {f"{name}{end}": value for end, value in zip(ENDS, (middle, low, high), strict=True)}
    return found


def _bodies(
    spectra: Mapping[str, np.ndarray],
    shape: Mapping[str, float],
    blocks: Block | None,
    weights: np.ndarray,
    spacing: str,
) -> dict[str, np.ndarray]:
    """Return the design values of the bodies by name; NaN outside the spectrum, or if all weights are zero."""
    names = [name for name, one in SITE.items() if one.dims == ("block",)]
    if blocks is None:
        return {name: np.empty(0) for name in names}
    found = {name: np.full(blocks.shape, math.nan) for name in names}
    found |= {name: np.zeros(blocks.shape) for name in ("half_cycle", "least_count", "most_count")}
    for name in ("alpha_c", "p", "restitution", "critical_impulse"):
        found[name] = np.array(np.broadcast_to(getattr(blocks, name), blocks.shape))
    found["critical_impulse_2"] = np.array(critical_impulse(blocks, 2))
    if not np.any(weights > 0.0):
        return found

    def design(spectrum: np.ndarray) -> DesignSpectrum:
        parameters = shape["ratio"], shape["interval"], int(shape["main_count"])
        return DesignSpectrum(RATES, RESTITUTIONS, spectrum, *parameters, spacing=spacing)

    middle = design(spectra["spectrum_design"])
    inside = np.flatnonzero(middle.covers(blocks))
    if not inside.size:
        return found
    covered = Block.stack([blocks.lane(int(place)) for place in inside])
    sequence, effect = middle.sequence(covered), middle.effective_impulse(covered)
    for end, opposite in (("", ""), ("_lower", "_upper"), ("_upper", "_lower")):
        if np.all(np.isfinite(spectra[f"spectrum_design{end}"])):
            one = design(spectra[f"spectrum_design{end}"])
            found[f"effective_impulse{end}"][inside] = one.effective_impulse(covered)
            found[f"design_factor{opposite}"][inside] = one.factor(covered)
            found[f"main{end}"][inside] = sequence.main * one.effective_impulse(covered) / effect
    for name, values in _response(covered, sequence).items():
        found[name][inside] = values
    speed = covered.gravity * np.tan(covered.alpha_c) / covered.p
    own = np.array([design(one).effective_impulse(covered) for one in spectra["spectrum"]])
    found["overturned_share"][inside] = weights @ (own >= speed) / np.sum(weights)
    return found


def _response(blocks: Block, sequence: ImpulseSequence) -> dict[str, np.ndarray]:
    """Return, by name, the response of m blocks to their m sequences, and to the same sequences without an end."""
    own = sequence_response(blocks, sequence, table_rows=int(np.max(np.asarray(sequence.main_count))), paired=True)
    endless = sequence_response(blocks, replace(sequence, main_count=None), table_rows=0, paired=True)
    assert own.half_cycles is not None
    counts = own.half_cycles.impulse_count
    return {
        "rotation_ratio": np.asarray(own.peak_rotation_ratio),
        "stabilised_rotation": np.asarray(endless.peak_rotation_ratio),
        "half_cycle": np.maximum(endless.overturning_half_cycle, 0),
        "least_count": np.maximum(counts[0], 0),
        "most_count": np.maximum(counts.max(axis=0), 0),
    }
