"""Test of both methods of a site on earthquakes left out of the design.

.. note:: A design and a record overturn a body at certain scale factors. A record is more severe than the design if its
   scale factor is smaller. Of the earthquakes left out, a share of 1 - q should be more severe. The records of an
   earthquake are averaged, and earthquakes have equal weights in the design and in the share.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from laboratory.site.records import BODIES
from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rockpulse.config.configuration import Config
from rockpulse.earthquakes import draw_earthquakes, share_interval, weighted_quantile
from rockpulse.errors import RecordRefused
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.design import SiteSample, design_sequence

__all__ = ["METHODS", "QUANTILES", "Site", "judge"]

#: Methods of the design, in the order of the arrays: the spectra by the rule and by the nonlinear equation, and fits.
METHODS = ("spectrum, rule", "spectrum, nonlinear", "response")

QUANTILES = (0.5, 0.84, 0.95)

#: Confidence of the intervals over earthquakes and of the width [-].
CONFIDENCE = 0.9

#: Factors on a sequence at which it is tried, in steps of one per cent.
FACTORS = np.exp(np.arange(math.log(0.01), math.log(1000.0), 0.01))


@dataclass(frozen=True, eq=False)
class Site:
    """Records of several earthquakes, with the result of :func:`laboratory.site.records.known_of` for each."""

    events: np.ndarray  # (n,) number of the earthquake of each record, from 0
    capacity: np.ndarray  # (n, 12) [-]
    rule: np.ndarray  # (n, a, c) [m/s]
    nonlinear: np.ndarray  # (n, a, c) [m/s]
    value: np.ndarray  # (n, 5)
    peaks: np.ndarray  # (n, 12)

    def factors(self, times: np.ndarray) -> np.ndarray:
        """Scale factors at which the design overturns the bodies; `times` (g,): how often each earthquake is drawn.

        They are (3, 3, 12) by method and quantile; NaN if a method makes no design.
        """
        found = np.full((len(METHODS), len(QUANTILES), BODIES.shape[0]), np.nan)
        weights = (times / np.bincount(self.events))[self.events]
        for row, spectra in enumerate((self.rule, self.nonlinear)):
            found[row] = _of_spectra(spectra, weights)
        found[2] = _of_sequences(self, weights)
        return found


def _of_spectra(spectra: np.ndarray, weights: np.ndarray) -> np.ndarray:
    unused = np.zeros(RATES.size), np.ones(RATES.size, dtype=int)  # I_s/I and N have no part in the factor
    found = []
    for quantile in QUANTILES:
        design = np.apply_along_axis(weighted_quantile, 0, spectra, quantile, weights)
        found.append(DesignSpectrum(RATES, RESTITUTIONS, design, *unused).factor(BODIES))
    return np.array(found)


def _of_sequences(site: Site, weights: np.ndarray) -> np.ndarray:
    fitted = (weights > 0.0) & np.isfinite(site.value[:, 0])
    found = np.full((len(QUANTILES), BODIES.shape[0]), np.nan)
    if not np.any(fitted):
        return found
    numbers = np.unique(site.events[fitted], return_inverse=True)[1]
    spacing = Config().sequence.spacing
    sample = SiteSample(site.value[fitted], site.peaks[fitted], weights[fitted], numbers, BODIES, spacing)
    for row, quantile in enumerate(QUANTILES):
        try:
            found[row] = overturning_factor(design_sequence(sample, quantile))
        except RecordRefused:
            continue
    return found


def overturning_factor(sequence: ImpulseSequence) -> np.ndarray:
    """Smallest factor (12,) on a sequence at which it overturns each body; inf for none of the factors tried."""
    peaks = sequence_response(BODIES, sequence.scaled(FACTORS), table_rows=0).peak_rotation_ratio
    over = np.isinf(np.asarray(peaks))
    return np.where(over.any(axis=0), FACTORS[np.argmax(over, axis=0)], np.inf)


def partitions(count: int, draws: int, random: np.random.Generator) -> Iterator[tuple[str, np.ndarray]]:
    """Sets of earthquakes that are left out together, as (g,) bool: each alone, then both halves of every draw."""
    for one in range(count):
        yield "one", np.arange(count) == one
    for _ in range(draws):
        half = random.permutation(count) < count // 2
        yield from (("half", half), ("half", ~half))


def judge(site: Site, draws: int = 20, resamples: int = 100, seed: int = 0) -> pd.DataFrame:
    """Shares of the left-out earthquakes that are more severe than the design: a row a method, quantile and set.

    Columns: left_out ("one" earthquake at a time, or a "half" of them, in several draws), method, quantile; share over
    the bodies with `low` and `high`, its interval over earthquakes, `least` and `most` of the bodies; nominal, 1 - q;
    expected, the share beyond the quantile of as many independent values as the design has earthquakes; earthquakes;
    factor, the geometric mean over bodies of the factor on the design of all; width, the ratio of the ends of its
    90 % interval over resampled earthquakes, the median over bodies.
    """
    count, shape = int(site.events.max()) + 1, (len(METHODS), len(QUANTILES))
    random = np.random.default_rng([seed, *b"site"])
    sums = {left_out: np.zeros((2, *shape, *site.capacity.shape)) for left_out in ("one", "half")}
    fewest = {"one": count - 1, "half": count // 2}
    for left_out, out in partitions(count, draws, random):
        factors = site.factors(~out * 1.0)[:, :, np.newaxis]
        records = out[site.events]
        severe = np.where(np.isnan(factors), np.nan, site.capacity[records] < factors)
        sums[left_out][0][:, :, records] += np.nan_to_num(severe)
        sums[left_out][1][:, :, records] += ~np.isnan(severe)
    resampled = np.array([site.factors(times) for times in draw_earthquakes(count, resamples, [seed, *b"width"])])
    low, high = np.quantile(resampled, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
    width, whole = np.median(high / low, axis=-1), np.exp(np.mean(np.log(site.factors(np.ones(count))), axis=-1))
    of_events = (np.arange(count)[:, np.newaxis] == site.events) / np.bincount(site.events)[:, np.newaxis]
    rows = []
    for left_out, (severe, judged) in sums.items():
        with np.errstate(invalid="ignore"):
            shares = of_events @ (severe / judged)  # (3, 3, g, 12)
        for (method, level), table in ((place, shares[place]) for place in np.ndindex(shape)):
            share, *interval = share_interval(table.mean(axis=1), np.ones(count), np.arange(count), CONFIDENCE)
            known, quantile = fewest[left_out], QUANTILES[level]
            rows.append(
                {
                    "left_out": left_out,
                    "method": METHODS[method],
                    "quantile": quantile,
                    "share": share,
                    "low": interval[0],
                    "high": interval[1],
                    "least": table.mean(axis=0).min(),
                    "most": table.mean(axis=0).max(),
                    "nominal": 1.0 - quantile,
                    "expected": (known + 1 - math.ceil(quantile * known - 1e-9)) / (known + 1),
                    "earthquakes": count,
                    "factor": whole[method, level],
                    "width": width[method, level],
                }
            )
    return pd.DataFrame(rows)
