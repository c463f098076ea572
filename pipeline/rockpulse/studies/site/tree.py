"""The site file put together: distributions, design sequence, coverage, and what is to be said of them.

The design of a site file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from rocking.block import Block
from rocking.sequence import ImpulseSequence, sequence_response
from rockpulse.calibration.design_spectrum import DesignSpectrum
from rockpulse.config.configuration import Config
from rockpulse.errors import ResultsError
from rockpulse.failures import Failure
from rockpulse.remark import as_stored
from rockpulse.storage.hdf5.atomic import ASSESSMENT, named
from rockpulse.storage.hdf5.results_file import load
from rockpulse.storage.variables import failure_table, with_values
from rockpulse.storage.variables.site import COORDINATES, PARAMETER, SITE_KIND, VARIABLES
from rockpulse.studies.site.coverage import coverage_of, judged, leave_one_event_out, unjudged_events
from rockpulse.studies.site.design import (
    BEYOND,
    PARAMETERS,
    SiteSample,
    covered,
    design_sequence,
    main_impulse_interval,
    overturning_limit,
)
from rockpulse.studies.site.record import rotation_to_cover
from rockpulse.studies.site.remarks import site_remarks
from rockpulse.studies.site.statistics import correlation, event_draws, fit_lognormal, weighted_quantile

#: Mark of a pair that does not count.
NOT_COUNTED = -1


def build_site_tree(
    done: Mapping[str, np.ndarray],
    weights: np.ndarray,
    block_names: Sequence[str],
    blocks: Block,
    config: Config,
    failures: Sequence[Failure],
    remarks: Sequence[str],
) -> xr.DataTree:
    """Fit, design, judge, and put everything into one tree.

    `done` is what :func:`rockpulse.studies.site.record.site_record` found of every record, and "event"; the weights are
    of mean one; `remarks` is what is to be said already. Raises RecordRefused where the records make no design
    sequence.
    """
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
    # Records of no weight are shown and judged by nobody; the statistics are those of the others.
    fitted = sample.part(weights > 0.0)
    draws = event_draws(int(fitted.events.max()) + 1, settings.bootstrap, config.run.seed)
    design = design_sequence(fitted, settings.quantile, settings.design)
    left_out = leave_one_event_out(sample, settings.quantile, settings.design)
    marks = left_out.covered
    coverage = coverage_of(marks, sample, settings.confidence)
    in_sample = covered(fitted, design)
    per_parameter = _per_parameter(fitted, design, draws, config)
    counted, rests = ~np.isnan(fitted.peaks), judged(marks, sample)
    fallen, below = np.zeros(len(block_names), dtype=bool), math.nan
    if settings.design == "response":
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
    unjudged = {str(names[event]): reason for event, reason in unjudged_events(left_out, sample).items()}
    told = site | {"share_below": below, "design_upper": per_parameter["design_upper"][0]}
    remarks = [*remarks, *site_remarks(told, done["scale_factor"], done["event"], weights, unjudged)]
    site |= {"remarks": "\n".join(remarks), "remark_values": as_stored(remarks)}
    of_events = [coverage_of(marks[numbers == one], sample.part(numbers == one), 0.9)[0] for one in range(names.size)]
    values = site | per_parameter | _records(done, weights, left_out.main) | _blocks(sample, design, marks)
    values |= {
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
    dataset.attrs |= {
        "method": settings.method,
        "design": settings.design,
        "spacing": config.sequence.spacing,
        "scaled_to": settings.scale_to if settings.target is None else f"{settings.scale_to} {settings.target:g}",
        "weights": settings.weighting,
    }
    tree = xr.DataTree.from_dict({"/site": dataset, "/failures": failure_table(failures)})
    tree.attrs["kind"] = SITE_KIND
    tree.attrs["title"] = config.site.name or "Design sequence of impulses of a site"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    return tree


def _weighted_share(part: np.ndarray, whole: np.ndarray, weights: np.ndarray) -> float:
    total = float(weights @ whole.sum(axis=1))
    return float(weights @ part.sum(axis=1)) / total if total > 0.0 else math.nan


def _per_parameter(
    sample: SiteSample, design: ImpulseSequence, draws: np.ndarray, config: Config
) -> dict[str, np.ndarray]:
    settings = config.calibration
    fit = fit_lognormal(sample.logarithms, sample.weights, sample.events, draws, settings.confidence)
    ends = main_impulse_interval(sample, design, settings.quantile, settings.design, draws, settings.confidence)
    nothing = np.full(len(PARAMETERS) - 1, math.nan)
    table = {
        "median": fit.median,
        "median_lower": fit.median_interval[0],
        "median_upper": fit.median_interval[1],
        "dispersion": fit.dispersion,
        "dispersion_lower": fit.dispersion_interval[0],
        "dispersion_upper": fit.dispersion_interval[1],
        "design": np.array(
            [
                design.main,
                design.secondary / design.main,
                design.interval,
                math.nan if design.main_count is None else design.main_count,
                design.duration if math.isfinite(design.duration) else math.nan,
            ]
        ),
        "design_lower": np.concatenate([[ends[0]], nothing]),
        "design_upper": np.concatenate([[ends[1]], nothing]),
    }
    for percent in (16, 50, 84):
        table[f"quantile_{percent}"] = np.array(
            [weighted_quantile(column, percent / 100.0, sample.weights) for column in sample.values.T]
        )
    return table


def _records(done: Mapping[str, np.ndarray], weights: np.ndarray, mains: np.ndarray) -> dict[str, np.ndarray]:
    names = [name for name, one in VARIABLES.items() if one.dims in (("record",), ("record", "parameter"))]
    columns = {**done, "weight": weights, "left_out_main": mains}
    return {name: columns[name] for name in names}


def _blocks(sample: SiteSample, design: ImpulseSequence, marks: np.ndarray) -> dict[str, Any]:
    blocks = sample.blocks
    shares = [coverage_of(marks[:, [place]], sample, 0.9, standing=False)[0] for place in range(marks.shape[1])]
    return {
        **{name: getattr(blocks, name) for name in ("alpha_c", "p", "restitution", "critical_impulse")},
        "design_rotation_ratio": np.atleast_1d(sequence_response(blocks, design, table_rows=0).peak_rotation_ratio),
        "block_coverage": shares,
    }


def load_design(path: str | Path) -> DesignSpectrum | ImpulseSequence:
    """The design that ``rockpulse calibrate`` has stored.

    Parameters
    ----------
    path : str or Path
        A site file.

    Returns
    -------
    DesignSpectrum or ImpulseSequence
        The design spectrum, which has a sequence for every body; one sequence for all of them where the file was made
        by the method "response" or "statistics".

    Raises
    ------
    ResultsError
        For a file that is no results file of rockpulse, of another kind, or of too few earthquakes for a design.
    OSError
        Where the file cannot be opened.
    """
    tree = load(path)
    kind = tree.attrs.get("kind", ASSESSMENT)
    if kind != SITE_KIND:
        raise ResultsError(f"{path}: expected a site file of 'rockpulse calibrate', found {named(kind)}")
    return design_of(tree, str(path))


def design_of(tree: xr.DataTree, name: str = "site") -> DesignSpectrum | ImpulseSequence:
    """The design of a site in memory (:func:`rockpulse.calibrate_site`), as :func:`load_design` reads it from a file.

    `name` stands for the site in the message where there is no design.
    """
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        spectra = tree["spectra"].to_dataset()
        if np.isnan(spectra["spectrum_design"].values).any():
            raise ResultsError(f"{name}: no design: {str(site['remarks'].item()).splitlines()[0]}")
        return DesignSpectrum(
            spectra["p"].values,
            spectra["restitution"].values,
            spectra["spectrum_design"].values,
            spectra["ratio"].values,
            spectra["main_count"].values.astype(int),
        )
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    return ImpulseSequence(
        main=value["main"],
        secondary=min(value["ratio"] * value["main"], value["main"]),
        interval=value["interval"],
        duration=math.inf if math.isnan(value["duration"]) else value["duration"],
        main_count=None if math.isnan(value["main_count"]) else int(value["main_count"]),
        spacing=str(site.attrs["spacing"]),
    )
