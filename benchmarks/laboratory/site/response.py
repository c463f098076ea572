"""Fit of a sequence to the responses to a recorded motion, the calibration that the paper left open (section 5)."""

from dataclasses import replace

import numpy as np

from laboratory.site import response_posterior as posterior
from laboratory.site.response_result import ResponseCalibration, warnings
from laboratory.site.response_search import explore, search_space, start_point
from laboratory.site.response_targets import SMALL, ResponseTargets, describe_family, recorded_family, recorded_targets
from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rockpulse.errors import ConfigError
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import record_sequence


def calibrate_response(
    record: Record,
    blocks: Block | None = None,
    *,
    vertical: ArrayLike | None = None,
    start: ImpulseSequence | None = None,
    spacing: str = "end",
    smallest: float = SMALL,
    confidence: float = 0.9,
    seed: int = 0,
    threads: int | None = None,
) -> ResponseCalibration:
    """The sequence that does to a family of blocks what a conditioned record does (docs/decisions/010).

    Without `blocks` (m,) the family is 100 about the edge at which this motion overturns
    (:func:`laboratory.site.response_targets.motion_family`). `vertical` (n,) is the vertical ground acceleration [m/s2]
    that acts on them. The search begins at `start`, by default the statistics of the half-waves, and keeps its
    duration. Peaks below `smallest` are known to be small only [-]. The answer depends on `seed` and on the record's
    id, not on `threads`. A ConfigError for an option out of range; RecordRefused if no block moves, fewer than 6 rock
    without overturning, or too few half-waves are left for a start.
    """
    if spacing not in SPACINGS:
        raise ConfigError(f"calibrate_response: spacing: expected one of {', '.join(SPACINGS)}, got {spacing!r}")
    if not 0.0 < confidence < 1.0:
        raise ConfigError(f"calibrate_response: confidence: expected a level between 0 and 1, got {confidence!r}")
    family = recorded_family(record, threads, vertical) if blocks is None else blocks
    targets = recorded_targets(record, family, smallest, threads, vertical)
    if start is None:
        start = record_sequence(half_waves(record), phase=intense_phase(record), spacing=spacing)
    rng = np.random.default_rng(np.random.SeedSequence([seed, *record.id.encode()]))
    fit = fit_sequence(targets, start, spacing, confidence, rng, threads, record.id)
    if blocks is None:
        fit = replace(fit, warnings=(describe_family(family), *fit.warnings))
    return fit


def fit_sequence(
    targets: ResponseTargets,
    start: ImpulseSequence | None,
    spacing: str,
    confidence: float,
    rng: np.random.Generator,
    threads: int | None,
    record_id: str,
) -> ResponseCalibration:
    """The likeliest sequence of targets; without `start` main impulses are limited by their number only."""
    space = search_space(targets, start, spacing)
    point = None if start is None or start.main == 0.0 else start_point(space, start)
    threshold = posterior.deviance_threshold(int(np.count_nonzero(targets.number)), confidence)
    explored = explore(targets, space, point, 4.0 * threshold, rng, threads)
    likeliest = explored.points[np.argmax(explored.likelihood)]
    independent, correlation = posterior.independent_share(targets, explored.peaks(likeliest[np.newaxis]).ravel())
    samples = posterior.sample_posterior(explored, rng, independent)
    limits = posterior.intervals(space, samples, confidence)
    ends = posterior.flat_ends(explored, threshold, independent)
    curves = posterior.profiles(explored, independent)
    flat = tuple(name for name, (low, high) in ends.items() if low and high and np.all(curves[name][1] <= threshold))
    best = explored.best(limits, posterior.parameter_values(space, explored.points))
    sequence = space.sequence(explored.points[best])
    values = posterior.parameter_values(space, explored.points[[best]])
    peaks = targets.reached(sequence, threads)
    of_start = None if start is None else targets.reached(start, threads)
    calibration = ResponseCalibration(
        record_id=record_id,
        sequence=sequence,
        parameters={name: value.item() for name, value in values.items()},
        intervals=limits,
        main_counts=posterior.main_counts(samples),
        profiles=curves,
        flat=flat,
        correlations=posterior.correlations(space, samples),
        misfit=targets.misfit(peaks).item(),
        unsafe_share=targets.short_of(peaks).item(),
        spread=float(explored.spread[best]),
        targets=targets,
        peaks=peaks.ravel(),
        start=start,
        start_misfit=np.nan if of_start is None else targets.misfit(of_start).item(),
        start_unsafe_share=np.nan if of_start is None else targets.short_of(of_start).item(),
        confidence=confidence,
        effective_samples=samples.effective,
        candidates=len(explored.likelihood),
        independent_share=independent,
        neighbour_correlation=correlation,
        warnings=(),
    )
    return replace(calibration, warnings=warnings(calibration, space, ends))
