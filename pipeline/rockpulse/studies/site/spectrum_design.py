"""Design spectrum of a site: quantiles over earthquakes of the records' overturning spectra, and sequences of bodies.

.. note:: At every p and C the quantile is the smallest S with at least that share of the weight at or below it. The
   intervals are from resampling earthquakes. With fewer than 1/(1 - quantile) earthquakes the quantile is the largest
   S, without an interval.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.body.limits import RATES
from rocking.spectrum.half_waves import lobe_shapes
from rocking.spectrum.overturning import OverturningSpectrum
from rockpulse.assessment.spectra import LANES
from rockpulse.config.configuration import Config
from rockpulse.earthquakes import ROUNDING, Quantiles, draw_earthquakes, record_quantiles
from rockpulse.errors import RecordRefused
from rockpulse.record.half_wave import half_waves
from rockpulse.run.analysis import Part, Watch
from rockpulse.selection.directions import Motion
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.variables import with_values
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.storage.variables.site import OF_RECORDS, SITE, SITE_AXES, SPECTRA, SPECTRA_AXES
from rockpulse.studies.site.site_records import empty_facts, facts_of_record, scaled_motion
from rockpulse.studies.site.site_warnings import FEWEST_EVENTS, unusual_factors_warning
from rockpulse.warning_text import WarningText, as_stored

#: Quantiles in every file in addition to the design quantile, by name.
STATED = {"spectrum_50": 0.5, "spectrum_84": 0.84}


def site_spectrum_record(motion: Motion, watch: Watch, config: Config) -> Part:
    """Return the overturning spectrum of a scaled record as arrays (1, ...) by name; RecordRefused if all is zero."""
    with watch("solve"):
        record, factor = scaled_motion(motion, config)
        if record.pga == 0.0:
            raise RecordRefused(f"{record.id}: all samples are zero, so that there is no overturning spectrum")
        waves = half_waves(record, **config.half_waves)
        count, ratio, _ = lobe_shapes(waves.start, waves.centroid, waves.end, waves.impulse, RATES)
        lanes = LANES[config.calibration.spectrum](record, waves=waves)
        found = {
            **facts_of_record(record, factor, config),
            "spectrum": OverturningSpectrum(lanes).spectrum(RESTITUTIONS),
            "record_ratio": ratio,
            "record_main_count": count,
        }
    return {name: np.array([values]) for name, values in found.items()}


def empty_spectrum_record() -> Part:
    """Return the arrays of :func:`site_spectrum_record` and "event" without rows."""
    return {
        **empty_facts(),
        "spectrum": np.zeros((0, RATES.size, RESTITUTIONS.size)),
        **dict.fromkeys(("record_ratio", "record_main_count"), np.zeros((0, RATES.size))),
    }


def fewest_events(quantile: float) -> int:
    """Return the number of earthquakes that a quantile needs: at least five, with at least one beyond the quantile."""
    return max(FEWEST_EVENTS, math.ceil((1.0 - ROUNDING) / min(quantile, 1.0 - quantile)))


def spectrum_design(
    done: Mapping[str, np.ndarray],
    weights: np.ndarray,
    block_names: Sequence[str],
    blocks: Block | None,
    config: Config,
    warnings: Sequence[str],
) -> dict[str, xr.Dataset]:
    """Return the groups /site and /spectra with the quantiles of the spectra and the design of every body."""
    settings = config.calibration
    names, numbers = np.unique(done["event"], return_inverse=True)
    counted = weights > 0.0
    events = np.unique(numbers[counted], return_inverse=True)[1]
    count, least = int(events.max()) + 1, fewest_events(settings.quantile)
    spectra: dict[str, Any] = {name: done[name] for name in ("spectrum", "record_ratio", "record_main_count")}
    enough = count >= least
    if enough:
        draws = draw_earthquakes(count, settings.bootstrap, [config.run.seed, *b"site"])
        quantiles = partial(
            record_quantiles, weights=weights[counted], events=events, draws=draws, confidence=settings.confidence
        )
        own = {name: values[counted] for name, values in spectra.items()}
        spectra |= _interval_tables(quantiles, own, settings.quantile)
    else:
        few = WarningText("too_few_events", count=count, least=int(least), quantile=float(settings.quantile))
        warnings = [few, *warnings]
        sizes = {"p": RATES.size, "restitution": RESTITUTIONS.size}
        others = {name: one.dims for name, one in SPECTRA.items() if name not in spectra}
        spectra |= {name: np.full([sizes[dim] for dim in dims], math.nan) for name, dims in others.items()}
    of_bodies = _bodies(spectra, blocks, weights if enough else np.zeros(weights.size))
    effects = zip(block_names, of_bodies["effective_impulse"].tolist(), strict=True)
    outside = [str(name) for name, effect in effects if enough and math.isnan(effect)]
    if outside:
        warnings = [*warnings, WarningText("outside_spectrum", names=", ".join(outside))]
    if config.records.include_vertical:
        warnings = [*warnings, WarningText("vertical_left_out")]
    warnings = [*warnings, *unusual_factors_warning(done["scale_factor"])]
    site = {
        "quantile": settings.quantile,
        "confidence": settings.confidence,
        "resamples": settings.bootstrap,
        "record_count": np.count_nonzero(counted),
        "event_count": count,
        "site_warnings": "\n".join(warnings),
        "site_warning_values": as_stored(warnings),
        **{name: done[name] for name in OF_RECORDS if name != "weight"},
        "weight": weights,
        "event_records": np.bincount(numbers),
        **of_bodies,
    }
    axes = {"record": done["record"], "block": list(block_names), "site_event": names}
    along = {"record": done["record"], "p": RATES, "restitution": RESTITUTIONS}
    return {
        "/site": xr.Dataset(with_values(SITE, site), with_values(SITE_AXES, axes), {"spectrum": settings.spectrum}),
        "/spectra": xr.Dataset(with_values(SPECTRA, spectra), with_values(SPECTRA_AXES, along)),
    }


def _interval_tables(
    quantiles: Callable[..., list[Quantiles]], of_records: Mapping[str, np.ndarray], quantile: float
) -> dict[str, np.ndarray]:
    """Return the tables of /spectra by name: quantiles over records, and the ends of their intervals."""
    levels = {**STATED, "spectrum_design": quantile}
    of_levels = quantiles(of_records["spectrum"], list(levels.values()), logarithmic=True)
    found = dict(zip(levels, of_levels, strict=True))
    (ratio,) = quantiles(of_records["record_ratio"], [0.5], logarithmic=False)
    (count,) = quantiles(of_records["record_main_count"].astype(float), [0.5], logarithmic=False)
    found["ratio"] = Quantiles(ratio.value, np.clip(ratio.lower, 0.0, 1.0), np.clip(ratio.upper, 0.0, 1.0))
    found["main_count"] = Quantiles(count.value, np.maximum(np.floor(count.lower), 1.0), np.ceil(count.upper))
    ends = ("", "_lower", "_upper")
    return {f"{name}{end}": table for name, one in found.items() for end, table in zip(ends, one, strict=True)}


def _bodies(spectra: Mapping[str, np.ndarray], blocks: Block | None, weights: np.ndarray) -> dict[str, np.ndarray]:
    """Return the design values (m,) of the bodies by name; NaN outside the spectrum, or if all weights are zero."""
    names = [name for name, one in SITE.items() if one.dims == ("block",)]
    if blocks is None:
        return {name: np.empty(0) for name in names}
    found = {name: np.full(blocks.shape, math.nan) for name in names}
    for name in ("alpha_c", "p", "restitution", "critical_impulse"):
        found[name] = np.array(np.broadcast_to(getattr(blocks, name), blocks.shape))
    if not np.any(weights > 0.0):
        return found

    def design(spectrum: np.ndarray) -> DesignSpectrum:
        return DesignSpectrum(RATES, RESTITUTIONS, spectrum, spectra["ratio"], spectra["main_count"].astype(int))

    middle = design(spectra["spectrum_design"])
    inside = np.flatnonzero(middle.covers(blocks))
    if not inside.size:
        return found
    covered = Block.stack([blocks.lane(int(place)) for place in inside])
    for end, opposite in (("", ""), ("_lower", "_upper"), ("_upper", "_lower")):
        if np.all(np.isfinite(spectra[f"spectrum_design{end}"])):
            one = design(spectra[f"spectrum_design{end}"])
            found[f"effective_impulse{end}"][inside] = one.effective_impulse(covered)
            found[f"design_factor{opposite}"][inside] = one.factor(covered)
            found[f"main{end}"][inside] = one.sequence(covered).main
        for name in ("ratio", "main_count"):
            found[f"{name}{end}"][inside] = spectra[f"{name}{end}"][middle.nearest(covered)]
    speed = covered.gravity * np.tan(covered.alpha_c) / covered.p
    own = np.array([design(one).effective_impulse(covered) for one in spectra["spectrum"]])
    found["overturned_share"][inside] = weights @ (own >= speed) / np.sum(weights)
    return found
