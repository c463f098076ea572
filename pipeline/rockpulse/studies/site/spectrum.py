"""The overturning spectra of the records of a site, and their quantiles over earthquakes with intervals.

.. note:: At every p and C the quantile is the smallest S with at least that share of the weight at or below it. The
   intervals resample earthquakes (:mod:`rockpulse.studies.site.statistics`), for records of one are no independent
   observations. What is said of a quantile needs earthquakes beyond it: with fewer than 1/(1 - quantile) of them it is
   the largest one seen, and no interval says how much larger the next one is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rocking.half_wave_demand import lobe_shapes
from rocking.overturning_spectrum import OverturningSpectrum
from rocking.spectrum_lanes import RATES
from rockpulse.assessment.overturning import LANES
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.motions.directions import Motion
from rockpulse.motions.runner import Part, Watch
from rockpulse.record.half_wave import half_waves
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.record import facts_of_record, no_facts, scaled_motion
from rockpulse.studies.site.remarks import FEWEST_EVENTS
from rockpulse.studies.site.statistics import ROUNDING, bootstrap_interval


def site_spectrum_record(motion: Motion, watch: Watch, config: Config) -> Part:
    """Scale a motion and work out its overturning spectrum: arrays by the names of the file.

    They are (1,), but "spectrum" (1, a, c), "record_ratio" and "record_main_count" (1, a). RecordRefused where the
    motion cannot be scaled or is nothing but zeros.
    """
    with watch("solve"):
        record, factor = scaled_motion(motion, config)
        if record.pga == 0.0:
            raise RecordRefused(f"{record.id}: nothing but zeros, which has no overturning spectrum")
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


def no_spectrum_record() -> Part:
    """Every array of :func:`site_spectrum_record`, and "event", without a row."""
    return {
        **no_facts(),
        "spectrum": np.zeros((0, RATES.size, RESTITUTIONS.size)),
        **dict.fromkeys(("record_ratio", "record_main_count"), np.zeros((0, RATES.size))),
    }


def fewest_events(quantile: float) -> int:
    """Earthquakes below which no quantile of a site is stated: one lies beyond it, and at least five.

    Examples
    --------
    >>> fewest_events(0.5), fewest_events(0.84), fewest_events(0.95)
    (5, 7, 20)
    """
    return max(FEWEST_EVENTS, math.ceil((1.0 - ROUNDING) / min(quantile, 1.0 - quantile)))


@dataclass(frozen=True, eq=False)
class Quantiles:
    """A quantile of k values over records, with its interval; NaN with a single event."""

    value: np.ndarray  # (k,)
    lower: np.ndarray  # (k,)
    upper: np.ndarray  # (k,)


@dataclass(frozen=True, eq=False)
class QuantileSample:
    """Weights and events of n records, and resamples of the events, of which quantiles are taken."""

    weights: np.ndarray  # (n,) above zero
    events: np.ndarray  # (n,) number of each record's event
    draws: np.ndarray  # (b, g) how often each event is in each resample
    confidence: float

    def quantiles(self, values: np.ndarray, levels: list[float], logarithmic: bool) -> list[Quantiles]:
        """Quantiles over the records of values (n, ...), one for each level, of the shape of the values of a record.

        The interval of positive values is worked out on their logarithms where these are asked for.
        """
        flat = values.reshape(values.shape[0], -1)
        found = np.empty((len(levels), 3, flat.shape[1]))
        sizes = np.bincount(self.events, self.weights)
        drawn = self.draws[:, self.events] * self.weights
        for column in range(flat.shape[1]):
            order = np.argsort(flat[:, column], kind="stable")
            ordered = flat[order, column]
            below, of_draws = np.cumsum(self.weights[order]), np.cumsum(drawn[:, order], axis=1)
            for row, level in enumerate(levels):
                share = level - ROUNDING
                value = ordered[np.searchsorted(below, share * below[-1])]
                # As many records lie below the quantile as there are sums below the share.
                resampled = ordered[np.sum(of_draws < share * of_draws[:, -1:], axis=1)]
                if logarithmic:
                    ends = np.exp(bootstrap_interval(np.log(value), np.log(resampled), sizes, self.confidence))
                else:
                    ends = np.array(bootstrap_interval(float(value), resampled, sizes, self.confidence))
                found[row, :, column] = value, *ends
        return [Quantiles(*one) for one in found.reshape(len(levels), 3, *values.shape[1:])]
