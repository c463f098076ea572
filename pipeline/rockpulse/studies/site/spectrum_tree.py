"""The site file by the overturning spectrum: quantiles over earthquakes, and the design sequence of every body."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from rocking.block import Block
from rocking.spectrum_lanes import RATES
from rockpulse.calibration.design_spectrum import DesignSpectrum
from rockpulse.config.configuration import Config
from rockpulse.failures import Failure
from rockpulse.remark import Remark, as_stored
from rockpulse.storage.variables import failure_table, with_values
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.storage.variables.site import OF_RECORDS, SITE, SITE_AXES, SITE_KIND, SPECTRA, SPECTRA_AXES
from rockpulse.studies.site.remarks import scaled_far
from rockpulse.studies.site.spectrum import Quantiles, QuantileSample, fewest_events
from rockpulse.studies.site.statistics import event_draws

#: Quantiles that every file has beside that of the design, by their names.
STATED = {"spectrum_50": 0.5, "spectrum_84": 0.84}


def build_spectrum_tree(
    done: Mapping[str, np.ndarray],
    weights: np.ndarray,
    block_names: Sequence[str],
    blocks: Block | None,
    config: Config,
    failures: Sequence[Failure],
    remarks: Sequence[str],
) -> xr.DataTree:
    """Put the spectra of all records, their quantiles and the design of every body into one tree.

    `done` is what :func:`rockpulse.studies.site.spectrum.site_spectrum_record` found of every record, and
    "event"; the weights are of mean one; `remarks` is what is to be said already.
    """
    settings = config.calibration
    names, numbers = np.unique(done["event"], return_inverse=True)
    counted = weights > 0.0
    events = np.unique(numbers[counted], return_inverse=True)[1]
    count, least = int(events.max()) + 1, fewest_events(settings.quantile)
    spectra: dict[str, Any] = {name: done[name] for name in ("spectrum", "record_ratio", "record_main_count")}
    enough = count >= least
    if enough:
        sample = QuantileSample(
            weights[counted], events, event_draws(count, settings.bootstrap, config.run.seed), settings.confidence
        )
        spectra |= _quantiles(sample, {name: values[counted] for name, values in spectra.items()}, settings.quantile)
    else:
        few = Remark("too_few_events", count=count, least=int(least), quantile=float(settings.quantile))
        remarks = [few, *remarks]
        spectra |= {
            name: np.full([{"p": RATES.size, "restitution": RESTITUTIONS.size}[dim] for dim in one.dims], math.nan)
            for name, one in SPECTRA.items()
            if name not in spectra
        }
    of_bodies = _bodies(spectra, blocks, weights if enough else np.zeros(weights.size))
    outside = [
        str(name)
        for name, effect in zip(block_names, of_bodies["effective_impulse"], strict=True)
        if enough and math.isnan(effect)
    ]
    if outside:
        remarks = [*remarks, Remark("outside_spectrum", names=", ".join(outside))]
    if config.records.include_vertical:
        remarks = [*remarks, Remark("vertical_left_out")]
    remarks = [*remarks, *scaled_far(done["scale_factor"])]
    site = {
        "quantile": settings.quantile,
        "confidence": settings.confidence,
        "resamples": settings.bootstrap,
        "record_count": np.count_nonzero(counted),
        "event_count": count,
        "remarks": "\n".join(remarks),
        "remark_values": as_stored(remarks),
        **{name: done[name] for name in OF_RECORDS if name != "weight"},
        "weight": weights,
        "event_records": np.bincount(numbers),
        **of_bodies,
    }
    axes = {"record": done["record"], "block": list(block_names), "site_event": names}
    dataset = xr.Dataset(with_values(SITE, site), with_values(SITE_AXES, axes))
    dataset.attrs |= {
        "method": settings.method,
        "spectrum": settings.spectrum,
        "scaled_to": settings.scale_to if settings.target is None else f"{settings.scale_to} {settings.target:g}",
        "weights": settings.weighting,
    }
    along = {"record": done["record"], "p": RATES, "restitution": RESTITUTIONS}
    tree = xr.DataTree.from_dict(
        {
            "/site": dataset,
            "/spectra": xr.Dataset(with_values(SPECTRA, spectra), with_values(SPECTRA_AXES, along)),
            "/failures": failure_table(failures),
        }
    )
    tree.attrs["kind"] = SITE_KIND
    tree.attrs["title"] = config.site.name or "Overturning spectrum of a site"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    return tree


def _quantiles(sample: QuantileSample, of_records: Mapping[str, np.ndarray], quantile: float) -> dict[str, np.ndarray]:
    """The quantiles of /spectra with both ends of their intervals, by name."""
    levels = {**STATED, "spectrum_design": quantile}
    found = dict(
        zip(levels, sample.quantiles(of_records["spectrum"], list(levels.values()), logarithmic=True), strict=True)
    )
    (ratio,) = sample.quantiles(of_records["record_ratio"], [0.5], logarithmic=False)
    (count,) = sample.quantiles(of_records["record_main_count"].astype(float), [0.5], logarithmic=False)
    found["ratio"] = Quantiles(ratio.value, np.clip(ratio.lower, 0.0, 1.0), np.clip(ratio.upper, 0.0, 1.0))
    found["main_count"] = Quantiles(count.value, np.maximum(np.floor(count.lower), 1.0), np.ceil(count.upper))
    ends = {"": "value", "_lower": "lower", "_upper": "upper"}
    return {f"{name}{end}": getattr(one, field) for name, one in found.items() for end, field in ends.items()}


def _bodies(spectra: Mapping[str, np.ndarray], blocks: Block | None, weights: np.ndarray) -> dict[str, np.ndarray]:
    """The design of each body (m,) and its interval, NaN for a body outside the spectrum or without any weight."""
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
