"""The sequence whose responses are those of a recorded motion: the calibration the paper left open (section 5)."""

from dataclasses import replace

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rockpulse.errors import ConfigError
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences import response_posterior as posterior
from rockpulse.sequences.estimators import calibrate
from rockpulse.sequences.response_result import ResponseCalibration, remarks
from rockpulse.sequences.response_search import explore, search_space, start_point
from rockpulse.sequences.response_targets import (
    SMALL,
    ResponseTargets,
    describe_family,
    recorded_family,
    recorded_targets,
)

#: Forms of the calibration: the likeliest sequence, or one that covers a share of the blocks.
FORMS = ("fit", "enveloping")
#: Main impulses of the scan of an envelope, of each refinement, and the relative width of the last bracket.
SCANNED, REFINED, TOLERANCE = 400, 33, 1e-6


def calibrate_response(
    record: Record,
    blocks: Block | None = None,
    *,
    vertical: ArrayLike | None = None,
    start: ImpulseSequence | None = None,
    form: str = "fit",
    share: float = 0.84,
    spacing: str = "end",
    smallest: float = SMALL,
    confidence: float = 0.9,
    seed: int = 0,
    threads: int | None = None,
) -> ResponseCalibration:
    """Impulse sequence that reproduces the peak rotations of a family of blocks under a record.

    Parameters
    ----------
    record : Record
        Conditioned.
    blocks : Block, optional
        (m,) blocks, the site's own. Without, 100 of engineering size about the edge at which this motion overturns
        (:func:`rockpulse.sequences.response_targets.motion_family`); a remark names their ranges.
    vertical : (n,) array_like, optional
        Vertical ground acceleration on the samples of the record [m/s2], positive up; it acts on the blocks whose
        rotations are the targets.
    start : ImpulseSequence, optional
        Start of the search; it also gives the duration. The statistical estimate on the intense phase without.
    form : {"fit", "enveloping"}
        "fit": the likeliest sequence. "enveloping": with I_s/I, dT and main count of the fit, the smallest main
        impulse whose response is not below the recorded one for `share` of the blocks that the record moves.
    share : float
        Of "enveloping", above 0 and at most 1 [-].
    spacing : {"end", "middle", "start", "open", "continuous"}
        Where the secondary impulses stand in a half-cycle.
    smallest : float
        Peaks below this are known to be small only [-].
    confidence : float
        Level of the intervals [-].
    seed : int
        Seed of the search; the record's id is part of the key.
    threads : int, optional
        Threads that share the work; None for all available cores. The answer does not depend on it.

    Returns
    -------
    ResponseCalibration
        The sequence with intervals, profiles and remarks.

    Raises
    ------
    ConfigError
        For an unknown form or spacing, or a share or level out of range.
    RecordRefused
        Where no block moves, fewer than 6 rock without overturning, or too few half-waves are left for a start.

    Notes
    -----
    The targets are theta_max/alpha_c of the nonlinear equation. ln(target/peak) is taken as normal with an estimated
    spread; overturned blocks are known to reach at least 1 only, blocks that hardly move to stay below `smallest`, and
    blocks at rest say nothing.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, section 5, doi:10.7712/120117.5612.17190.
    """
    for name, value, known in (("form", form, FORMS), ("spacing", spacing, SPACINGS)):
        if value not in known:
            raise ConfigError(f"calibrate_response: {name}: expected one of {', '.join(known)}, got {value!r}")
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"calibrate_response: share: expected a share above 0 and at most 1, got {share!r}")
    if not 0.0 < confidence < 1.0:
        raise ConfigError(f"calibrate_response: confidence: expected a level between 0 and 1, got {confidence!r}")
    family = recorded_family(record, threads, vertical) if blocks is None else blocks
    targets = recorded_targets(record, family, smallest, threads, vertical)
    if start is None:
        start = calibrate(half_waves(record), phase=intense_phase(record), spacing=spacing)
    rng = np.random.default_rng(np.random.SeedSequence([seed, *record.id.encode()]))
    fit = fit_sequence(targets, start, spacing, confidence, rng, threads, record.id)
    if blocks is None:
        fit = replace(fit, remarks=(describe_family(family), *fit.remarks))
    return envelope(fit, share, threads) if form == "enveloping" else fit


def envelope(fit: ResponseCalibration, share: float, threads: int | None = None) -> ResponseCalibration:
    """The calibration of a fit with the smallest main impulse that covers a share of the moved blocks [-]."""
    factor, again = enveloping_main(fit.targets, fit.sequence, share, threads)
    sequence = fit.sequence.scaled(factor)
    peaks = fit.targets.reached(sequence, threads)
    said = f"the enveloping main impulse is {factor:.3g} times the fitted one and covers {share:.0%} of the blocks"
    if again:
        said += "; between larger impulses that do, some do not: cover is not monotonic in the impulse"
    return replace(
        fit,
        form="enveloping",
        sequence=sequence,
        parameters={**fit.parameters, "main": float(sequence.main)},
        misfit=fit.targets.misfit(peaks).item(),
        unsafe_share=fit.targets.short_of(peaks).item(),
        peaks=peaks.ravel(),
        remarks=(*fit.remarks, said),
    )


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
        form="fit",
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
        remarks=(),
    )
    return replace(calibration, remarks=remarks(calibration, space, ends))


def enveloping_main(
    targets: ResponseTargets, sequence: ImpulseSequence, share: float, threads: int | None = None
) -> tuple[float, bool]:
    """Factor on both impulses at which a sequence first covers a share of the targets; and if a larger one does not.

    The peak of a block is not monotonic in I (its number of secondary impulses jumps), so the range is scanned and the
    first edge refined. It ends where every block overturns at once: (I/I_1c)(1 - sigma/2) of 2, above the root of every
    spacing. A band of cover narrower than a step of the scan may be missed.
    """
    speaks = ~targets.silent
    critical = np.asarray(targets.blocks.critical_impulse)[speaks]
    last = 4.0 * critical.max() / sequence.main
    first = 1e-3 * critical.min() / sequence.main

    def covered(factors: np.ndarray) -> np.ndarray:
        return 1.0 - targets.short_of(targets.reached(sequence.scaled(factors), threads)) >= share - 1e-12

    factors = np.geomspace(first, last, SCANNED)
    enough = covered(factors)
    edge = int(np.argmax(enough))
    again = not bool(np.all(enough[edge:]))
    low, high = factors[max(edge - 1, 0)], factors[edge]
    while high - low > TOLERANCE * high:
        inner = np.linspace(low, high, REFINED)
        edge = max(int(np.argmax(covered(inner[1:]))) + 1, 1)
        low, high = inner[edge - 1], inner[edge]
    return float(high), again
