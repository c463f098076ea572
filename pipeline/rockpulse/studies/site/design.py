"""The design sequence of a site, chosen from the distribution of its records' sequences.

.. note:: A sequence has a shape (I_s/I, dT, number of main impulses, duration) and a size I. Sequences cannot be ranked
   by their parameters (Casapulla & Maione 2017, section 4), but by the rotations that they cause. Hence the design has
   the median shape, and the smallest I at which the sequence covers the quantile of the recorded rotations of the
   blocks that it does not overturn; its coverage is tested on records left out. Blocks that the design overturns are
   excluded: the design covers every record for them, so that the quantile would not apply to the blocks that are safe
   under the design (docs/decisions/011).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rockpulse.earthquakes import ROUNDING, bootstrap_interval, log_moments, weighted_quantile
from rockpulse.errors import RecordRefused

#: Parameters of a sequence, in the order of the tables.
PARAMETERS = ("main", "ratio", "interval", "main_count", "duration")
#: Code for a block that the sequence overturns, in addition to 1 (rotation covered) and 0 (not covered).
BEYOND = 2.0
#: Numbers of main impulses in the first grid and in each refined grid, and number of refinements.
GRID, REFINED, ROUNDS = 256, 17, 3
#: Weakest main impulse of the grid, divided by the smallest I_1c; it causes peaks of about 1e-8 alpha_c.
WEAKEST = 1e-4


@dataclass(frozen=True, eq=False)
class SiteSample:
    """The sequences of n records, and the peak rotations of m blocks under these records."""

    values: np.ndarray  # (n, 5) in the order and units of PARAMETERS; NaN without a sequence
    peaks: np.ndarray  # (n, m) theta_max/alpha_c; inf if overturned, NaN at rest
    weights: np.ndarray  # (n,) at least 0, not all 0
    events: np.ndarray  # (n,) index of each record's event
    blocks: Block  # (m,)
    spacing: str  # spacing of the secondary impulses of all sequences

    @property
    def logarithms(self) -> np.ndarray:
        """Logarithms (n, 5) of the parameters; NaN if a record has no sequence or the parameter is zero."""
        with np.errstate(divide="ignore"):
            logarithms = np.log(self.values)
        return np.where(np.isfinite(logarithms), logarithms, np.nan)

    @property
    def counted(self) -> np.ndarray:
        """Mask (n, m) of the record-block pairs that count: the record has a weight above 0 and lifts the block."""
        return ~np.isnan(self.peaks) & (self.weights[:, np.newaxis] > 0.0)

    def part(self, kept: np.ndarray) -> "SiteSample":
        """Return the sample with only the records in the mask `kept` (n,)."""
        return replace(
            self,
            values=self.values[kept],
            peaks=self.peaks[kept],
            weights=self.weights[kept],
            events=np.unique(self.events[kept], return_inverse=True)[1],
        )


def design_sequence(sample: SiteSample, quantile: float) -> ImpulseSequence:
    """Return the sequence that covers the share `quantile` of the rotations; RecordRefused if no block rotates."""
    shape = _sequence(_medians(sample), sample)
    if not np.any(sample.counted):
        raise RecordRefused(
            "no record lifts a block, so that there is no rotation to cover: take other blocks or scale the records"
        )
    low, high = _range(sample)
    for number in (GRID, *[REFINED] * ROUNDS):
        mains = np.geomspace(low, high, number)
        reached = _reached(sample, shape, mains)
        hits, total = _event_sums(sample, reached, ~np.isinf(reached))
        short = np.flatnonzero(_falls_short(hits.sum(axis=0), total.sum(axis=0), quantile))
        # The rotation need not increase with I: the design exceeds the largest I that does not cover the quantile.
        if short.size == 0:
            high = float(mains[0])
            break
        if short[-1] == mains.size - 1:
            raise RecordRefused(
                f"no main impulse up to {high:.3g} m/s covers the quantile {quantile:g} of the recorded rotations with "
                f"I_s/I = {shape.secondary / shape.main:.3g} and spacing {sample.spacing!r}: take another spacing"
            )
        low, high = float(mains[short[-1]]), float(mains[short[-1] + 1])
    return replace(shape, main=high, secondary=min(shape.secondary / shape.main * high, high))


def _medians(sample: SiteSample) -> np.ndarray:
    """Return the median (5,) of each parameter: lognormal, but a sample median for the number of main impulses."""
    once = np.ones((1, int(sample.events.max()) + 1), dtype=int)
    medians = np.exp(log_moments(sample.logarithms, sample.weights, sample.events, once)[0][0])
    medians[3] = weighted_quantile(sample.values[:, 3], 0.5, sample.weights)
    if not np.isfinite(medians[1]):
        medians[1] = 0.0  # no record has secondary impulses
    return medians


def _sequence(values: np.ndarray, sample: SiteSample) -> ImpulseSequence:
    main, ratio, interval, count, duration = values.tolist()
    return ImpulseSequence(
        main=main,
        secondary=min(ratio, 1.0) * main,
        interval=interval,
        duration=duration if math.isfinite(duration) else math.inf,
        main_count=max(int(count), 1) if math.isfinite(count) else None,
        spacing=sample.spacing,
    )


def _range(sample: SiteSample) -> tuple[float, float]:
    """Return the weakest main impulse of the grid, and a main impulse that overturns every block.

    Secondary impulses reduce the speed by at most half, unless they act at the same instant (spacing "start").
    """
    critical = np.atleast_1d(sample.blocks.critical_impulse)
    return WEAKEST * float(critical.min()), 4.0 * float(critical.max())


def covered_rotations(sample: SiteSample, sequence: ImpulseSequence) -> np.ndarray:
    """Return codes (n, m): 1 if the rotation is covered, 0 if not, BEYOND if the sequence overturns, NaN at rest."""
    reached = np.atleast_1d(sequence_response(sample.blocks, sequence, table_rows=0).peak_rotation_ratio)
    marks = np.where(np.isinf(reached), BEYOND, sample.peaks <= reached)
    return np.where(np.isnan(sample.peaks), np.nan, marks)


def _reached(sample: SiteSample, shape: ImpulseSequence, mains: np.ndarray) -> np.ndarray:
    """Return the peak rotations (q, m) of m blocks under q sequences of one shape, with the main impulses `mains`."""
    sequences = shape.scaled(mains / shape.main)
    return np.asarray(sequence_response(sample.blocks, sequences, table_rows=0).peak_rotation_ratio)


def _event_sums(sample: SiteSample, reached: np.ndarray, stands: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights (g, q) of the covered and of all rotations; only blocks in the mask `stands` (q, m) count."""
    counted = sample.counted
    hits, total = np.zeros((2, int(sample.events.max()) + 1, reached.shape[0]))
    for record, event in enumerate(sample.events):
        of = counted[record]
        covers = sample.peaks[record, of] <= reached[:, of]
        hits[event] += sample.weights[record] * np.count_nonzero(covers & stands[:, of], axis=1)
        total[event] += sample.weights[record] * np.count_nonzero(stands[:, of], axis=1)
    return hits, total


def _falls_short(hits: np.ndarray, total: np.ndarray, quantile: float) -> np.ndarray:
    """Return whether the weight `hits` is below the share `quantile` of the weight `total`; False if both are zero."""
    return np.asarray(hits < (quantile - ROUNDING) * total)


def overturning_limit(sample: SiteSample, sequence: ImpulseSequence, quantile: float) -> tuple[np.ndarray, float]:
    """Return a mask (m,) of blocks whose overturning governs the design, and the coverage just below the design."""
    low, high = _range(sample)
    bracket = math.log(high / low) / (GRID - 1) / (REFINED - 1) ** ROUNDS
    reached = _reached(sample, sequence, sequence.main * np.array([1.0 - 2.0 * bracket, 1.0]))
    stands = ~np.isinf(reached)
    fallen = stands[0] & ~stands[1] & sample.counted.any(axis=0)
    hits, total = (sums.sum() for sums in _event_sums(sample, reached[:1], stands[:1]))
    kept_hits, kept = (sums.sum() for sums in _event_sums(sample, reached[:1], stands.all(axis=0, keepdims=True)))
    limits = _falls_short(hits, total, quantile) and not _falls_short(kept_hits, kept, quantile)
    return fallen & limits, float(hits / total) if total > 0.0 else math.nan


def main_impulse_interval(
    sample: SiteSample, sequence: ImpulseSequence, quantile: float, draws: np.ndarray, confidence: float
) -> tuple[float, float]:
    """Return the bootstrap interval [m/s], over events, of the main impulse of a design whose shape is fixed.

    `draws` (b, g) are resamples of events. With a single event both ends are NaN. The upper end is inf if every block
    overturns in more resamples than the interval leaves out. The ends are NaN and inf if the design overturns every
    block, or if the overturning of one block determines the design in most resamples, as the interval would then
    describe only that block. Each end differs from the design by at least one step of the grid, about 2 %.
    """
    middle = math.log(sequence.main)
    mains = np.geomspace(*_range(sample), GRID * 2)
    reached = _reached(sample, sequence, mains)
    stands = ~np.isinf(reached)
    hits, total = _event_sums(sample, reached, stands)
    sizes, rows, last = total.max(axis=1), np.arange(draws.shape[0]), mains.size - 1
    if np.count_nonzero(sizes) < 2:
        return math.nan, math.nan
    counted = draws @ total
    short = _falls_short(draws @ hits, counted, quantile)
    step = np.where(short.any(axis=1), mains.size - np.argmax(short[:, ::-1], axis=1), 0)
    # If the lower step covers enough on the blocks that survive this step, the overturning of a block sets the limit.
    kept_hits, kept = _event_sums(sample, reached[:-1], stands[:-1] & stands[1:])
    enough = ~_falls_short(draws @ kept_hits, draws @ kept, quantile)
    limited = (step > 0) & (step <= last) & enough[rows, np.clip(step - 1, 0, last - 1)]
    most = np.bincount(step[limited], minlength=1).max() / rows.size
    if most > 0.5 or not np.any(covered_rotations(sample, sequence)[sample.counted] != BEYOND):
        return math.nan, math.inf
    bounded = (step <= last) & (counted[rows, np.minimum(step, last)] > 0.0)
    resampled = np.where(bounded, np.log(mains)[np.minimum(step, last)], math.inf)
    resampled[draws @ sizes == 0.0] = math.nan
    lower, upper = bootstrap_interval(middle, resampled, sizes, confidence)
    grid = math.log(mains[1] / mains[0])
    return math.exp(np.minimum(lower, middle - grid)), math.exp(np.maximum(upper, middle + grid))


def correlation(logarithms: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the weighted correlation (p, p) of logarithms (n, p); NaN for parameters without values or variation."""
    count = logarithms.shape[1]
    matrix = np.full((count, count), np.nan)
    for row in range(count):
        for column in range(row + 1):
            both = np.isfinite(logarithms[:, row]) & np.isfinite(logarithms[:, column]) & (weights > 0.0)
            if not np.any(both):
                continue
            pair = logarithms[both][:, [row, column]]
            if np.any(np.ptp(pair, axis=0) <= 1e-12 * (1.0 + np.abs(pair[0]))):
                continue
            pair = pair - np.average(pair, axis=0, weights=weights[both])
            covariance = pair.T @ (weights[both, np.newaxis] * pair)
            value = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
            matrix[row, column] = matrix[column, row] = np.clip(value, -1.0, 1.0)
    return matrix
