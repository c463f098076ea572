"""Design sequence of a site: distributions of the sequences, the design, and its coverage of records left out."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rockpulse.config.configuration import Config
from rockpulse.earthquakes import draw_earthquakes, fit_lognormal, share_interval, weighted_quantile
from rockpulse.errors import RecordRefused
from rockpulse.storage.variables import with_values
from rockpulse.storage.variables.site import COORDINATES, PARAMETER, VARIABLES
from rockpulse.studies.site.design import (
    BEYOND,
    PARAMETERS,
    SiteSample,
    correlation,
    covered_rotations,
    design_sequence,
    main_impulse_interval,
    overturning_limit,
)
from rockpulse.studies.site.site_records import parameters_of, rotation_to_cover
from rockpulse.studies.site.site_warnings import sequence_design_warnings
from rockpulse.warning_text import as_stored

#: Code for a record-block pair that is not counted.
NOT_COUNTED = -1


class Coverage(NamedTuple):
    """The coverage of each earthquake's rotations by a design fitted to the other earthquakes; NaN without a design."""

    covered: np.ndarray  # (n, m) codes of :func:`rockpulse.studies.site.design.covered_rotations`
    main: np.ndarray  # (n,) main impulse of the design without the event of the record [m/s]


def leave_one_event_out(sample: SiteSample, quantile: float) -> Coverage:
    """Fit a design to all earthquakes but one, test it on the records of that earthquake, and repeat for each."""
    marks, mains = np.full(sample.peaks.shape, math.nan), np.full(sample.weights.size, math.nan)
    for event in np.unique(sample.events):
        out = sample.events == event
        others = ~out & (sample.weights > 0.0)
        if not np.any(others):
            continue
        try:
            sequence = design_sequence(sample.part(others), quantile)
        except RecordRefused:  # the other earthquakes give no design
            continue
        marks[out] = covered_rotations(sample.part(out), sequence)
        mains[out] = sequence.main
    return Coverage(marks, mains)


def counted_pairs(marks: np.ndarray, sample: SiteSample, standing: bool = True) -> np.ndarray:
    """Return a mask (n, m) of the record-block pairs that are counted; `standing` leaves out overturned blocks."""
    counted: np.ndarray = ~np.isnan(marks) & (sample.weights[:, np.newaxis] > 0.0)
    if standing:
        counted &= marks != BEYOND
    return counted


def coverage_of(
    marks: np.ndarray, sample: SiteSample, confidence: float, standing: bool = True
) -> tuple[float, float, float]:
    """Return the weighted share of covered rotations and its interval; `standing` leaves out overturned blocks."""
    counted = counted_pairs(marks, sample, standing)
    rows = np.nonzero(counted)[0]
    if rows.size == 0:
        return math.nan, math.nan, math.nan
    return share_interval(np.minimum(marks[counted], 1.0), sample.weights[rows], sample.events[rows], confidence)


def untested_events(found: Coverage, sample: SiteSample) -> dict[int, str]:
    """Return a code, by index, for each event that tests no design, or only a design that overturns every block."""
    rests, lifts, counted = (
        counted_pairs(found.covered, sample).any(axis=1),
        ~np.isnan(sample.peaks),
        sample.weights > 0.0,
    )
    reasons = {}
    for event in np.unique(sample.events[counted & ~np.isin(sample.events, sample.events[rests])]).tolist():
        rows = (sample.events == event) & counted
        if not np.any(lifts[rows]):
            reasons[event] = "unlifted"
        elif np.isnan(found.main[rows]).all():
            reasons[event] = "no_design"
        else:
            reasons[event] = "overturning_design"
    return reasons


def sequence_design(
    done: Mapping[str, np.ndarray],
    weights: np.ndarray,
    block_names: Sequence[str],
    blocks: Block,
    config: Config,
    warnings: Sequence[str],
) -> dict[str, xr.Dataset]:
    """Return the group /site with distributions, design and coverage; raise RecordRefused if there is no design."""
    settings = config.calibration
    names, numbers = np.unique(done["event"], return_inverse=True)
    peaks = done["peaks"]
    sample = SiteSample(
        values=done["value"],
        peaks=rotation_to_cover(peaks),
        weights=weights,
        events=numbers,
        blocks=blocks,
        spacing=config.sequence.spacing,
    )
    # Records of zero weight are in the file, but not in the statistics.
    fitted = sample.part(weights > 0.0)
    draws = draw_earthquakes(int(fitted.events.max()) + 1, settings.bootstrap, [config.run.seed, *b"site"])
    design = design_sequence(fitted, settings.quantile)
    left_out = leave_one_event_out(sample, settings.quantile)
    marks = left_out.covered
    coverage = coverage_of(marks, sample, settings.confidence)
    in_sample = covered_rotations(fitted, design)
    per_parameter = _per_parameter(fitted, design, draws, config)
    counted, rests = ~np.isnan(fitted.peaks), counted_pairs(marks, sample)
    fallen, below = overturning_limit(fitted, design, settings.quantile)
    site: dict[str, Any] = {
        "quantile": settings.quantile,
        "confidence": settings.confidence,
        "resamples": settings.bootstrap,
        "record_count": fitted.weights.size,
        "event_count": draws.shape[1],
        "lifting_events": np.unique(fitted.events[counted.any(axis=1)]).size,
        "lifted_share": _weighted_share(counted, np.ones_like(counted), fitted.weights),
        "unresolved_share": _weighted_share(np.isnan(peaks[weights > 0.0]), np.ones_like(counted), fitted.weights),
        "design_set_by": ", ".join(np.array(block_names, dtype=str)[fallen].tolist()),
        "coverage": coverage[0],
        "coverage_lower": coverage[1],
        "coverage_upper": coverage[2],
        "judged_pairs": np.count_nonzero(rests),
        "judged_events": np.unique(numbers[rests.any(axis=1)]).size,
        "coverage_in_sample": coverage_of(in_sample, fitted, settings.confidence)[0],
        "coverage_all": coverage_of(marks, sample, settings.confidence, standing=False)[0],
        "standing_share": _weighted_share((in_sample != BEYOND) & counted, counted, fitted.weights),
    }
    unjudged = {str(names[event]): reason for event, reason in untested_events(left_out, sample).items()}
    facts = site | {"share_below": below, "design_upper": per_parameter["design_upper"][0]}
    warnings = [*warnings, *sequence_design_warnings(facts, done["scale_factor"], done["event"], weights, unjudged)]
    site |= {"site_warnings": "\n".join(warnings), "site_warning_values": as_stored(warnings)}
    of_events = [coverage_of(marks[numbers == one], sample.part(numbers == one), 0.9)[0] for one in range(names.size)]
    columns = {**done, "weight": weights, "left_out_main": left_out.main}
    of_records = [name for name, one in VARIABLES.items() if one.dims in (("record",), ("record", "parameter"))]
    alone = [coverage_of(marks[:, [place]], sample, 0.9, standing=False)[0] for place in range(marks.shape[1])]
    values = site | per_parameter | {name: columns[name] for name in of_records}
    values |= {
        **{name: getattr(blocks, name) for name in ("alpha_c", "p", "restitution", "critical_impulse")},
        "design_rotation_ratio": np.atleast_1d(sequence_response(blocks, design, table_rows=0).peak_rotation_ratio),
        "block_coverage": alone,
        "event_records": np.bincount(numbers),
        "event_coverage": of_events,
        "correlation": correlation(fitted.logarithms, fitted.weights),
        "rotation_ratio": peaks,
        "covered": np.where(np.isnan(marks), NOT_COUNTED, marks),
    }
    coordinates = {
        "record": done["record"],
        "block": list(block_names),
        "site_event": names,
        "parameter": list(PARAMETERS),
        "other_parameter": list(PARAMETERS),
        "parameter_unit": [PARAMETER[name][0] for name in PARAMETERS],
        "parameter_name": [PARAMETER[name][1] for name in PARAMETERS],
    }
    dataset = xr.Dataset(with_values(VARIABLES, values), with_values(COORDINATES, coordinates))
    dataset.attrs |= {"spacing": config.sequence.spacing}
    return {"/site": dataset}


def _weighted_share(part: np.ndarray, whole: np.ndarray, weights: np.ndarray) -> float:
    total = float(weights @ whole.sum(axis=1))
    return float(weights @ part.sum(axis=1)) / total if total > 0.0 else math.nan


def _per_parameter(
    sample: SiteSample, design: ImpulseSequence, draws: np.ndarray, config: Config
) -> dict[str, np.ndarray]:
    settings = config.calibration
    fit = fit_lognormal(sample.logarithms, sample.weights, sample.events, draws, settings.confidence)
    ends = main_impulse_interval(sample, design, settings.quantile, draws, settings.confidence)
    table = {"median": fit.median, "dispersion": fit.dispersion, "design": np.array(parameters_of(design))}
    for place, end in enumerate(("lower", "upper")):
        table[f"median_{end}"] = fit.median_interval[place]
        table[f"dispersion_{end}"] = fit.dispersion_interval[place]
        table[f"design_{end}"] = np.array([ends[place], *[math.nan] * (len(PARAMETERS) - 1)])
    for percent in (16, 50, 84):
        column = [weighted_quantile(values, percent / 100.0, sample.weights) for values in sample.values.T]
        table[f"quantile_{percent}"] = np.array(column)
    return table
