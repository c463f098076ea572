"""Test of the design of a site on earthquakes left out of it.

.. note:: A design and a record overturn a body at certain scale factors. A record is more severe than the design if its
   scale factor is smaller. Of the earthquakes left out, a share of 1 - q should be more severe. The records of an
   earthquake are averaged, and earthquakes have equal weights in the design and in the share.

   The capacity of a body is `factor_50` of the nonlinear overturning spectrum of the record, under the default
   uncertainty. The spectrum is that of ``rockpulse calibrate`` for one record.
"""

import math
import re
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from laboratory.ensemble import StrongMotion
from rocking.body.block import Block
from rocking.body.limits import RATES
from rocking.spectrum.overturning import OverturningSpectrum
from rocking.spectrum.slender_lanes import spectrum_lanes
from rockpulse.config.configuration import Config
from rockpulse.earthquakes import draw_earthquakes, record_quantiles
from rockpulse.selection.directions import Motion
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.spectrum_design import site_spectrum_record

#: The spectra of the design.
METHODS = ("rule", "nonlinear")
QUANTILES = (0.5, 0.84, 0.95)
#: Confidence of the intervals over earthquakes and of the width [-].
CONFIDENCE = 0.9
#: Slendernesses and restitutions [-] of the twelve bodies, at each of four frequency parameters [1/s].
SHAPES, BODY_RATES = np.array([(4.0, 0.8), (6.0, 0.9), (10.0, 0.97)]), (0.5, 1.25, 3.0, 8.0)
BODIES = Block.from_parameters(
    p=np.repeat(BODY_RATES, len(SHAPES)),
    alpha=np.tile(np.arctan(1.0 / SHAPES[:, 0]), len(BODY_RATES)),
    restitution=np.tile(SHAPES[:, 1], len(BODY_RATES)),
    log=False,
)


def known_of(motion: StrongMotion, folder: Path) -> dict[str, np.ndarray]:
    """Capacities and spectra of a motion by name, from its file in a folder if there is one.

    `capacity` (12,) [-], `rule` and `nonlinear` (a, c) [m/s].
    """
    # Files without station give equal ids.
    name = f"{motion.event} {motion.record.id} {motion.record.npts}"
    path = folder / f"{re.sub('[^A-Za-z0-9.-]', '_', name)}.npz"
    if not path.exists():
        np.savez(path, **_computed(motion))
    with np.load(path) as stored:
        return dict(stored)


def _computed(motion: StrongMotion) -> dict[str, np.ndarray]:
    record, config = motion.record, Config()
    own = OverturningSpectrum(spectrum_lanes(record.acceleration, record.dt))
    of_rule = site_spectrum_record(Motion(record), lambda _: nullcontext(), config)
    return {
        "capacity": own.factors(BODIES).factor_50,
        "nonlinear": own.spectrum(RESTITUTIONS),
        "rule": of_rule["spectrum"][0],
    }


@dataclass(frozen=True, eq=False)
class Site:
    """Records of several earthquakes, with the result of :func:`known_of` for each."""

    events: np.ndarray  # (n,) number of the earthquake of each record, from 0
    capacity: np.ndarray  # (n, 12) [-]
    rule: np.ndarray  # (n, a, c) [m/s]
    nonlinear: np.ndarray  # (n, a, c) [m/s]

    def factors(self, times: np.ndarray) -> np.ndarray:
        """Scale factors at which the design overturns the bodies; `times` (g,): how often each earthquake is drawn.

        They are (2, 3, 12) by method and quantile.
        """
        weights = (times / np.bincount(self.events))[self.events]
        drawn = weights > 0.0
        events = np.unique(self.events[drawn], return_inverse=True)[1]
        known = {"weights": weights[drawn], "events": events, "draws": np.zeros((0, events.max() + 1), dtype=int)}
        found = []
        for spectra in (self.rule, self.nonlinear):
            designs = record_quantiles(spectra[drawn], list(QUANTILES), True, **known, confidence=CONFIDENCE)
            every = [DesignSpectrum(RATES, RESTITUTIONS, one.value, 0.0, np.nan, 1) for one in designs]
            found.append([one.factor(BODIES) for one in every])
        return np.array(found)


def share_interval(
    hits: np.ndarray, weights: np.ndarray, events: np.ndarray, confidence: float
) -> tuple[float, float, float]:
    """Return the weighted mean of hits (n,), each from 0 to 1, and its confidence limits; NaN for one earthquake.

    Korn and Graubard's interval (1998, Survey Methodology 24, 193-201) is Clopper and Pearson's interval for the
    effective number of independent trials, s(1 - s)/var s times (z/t_(g-1))^2, with the variance of the share s over
    earthquakes. For s = 0 or 1 this variance is zero, and the number of trials is the number of earthquakes, so
    that few earthquakes give a wide interval.
    """
    from scipy.stats import beta, norm, t

    total = float(weights.sum())
    share = float(weights @ hits) / total
    names, place = np.unique(events, return_inverse=True)
    count = names.size
    if count < 2:
        return share, math.nan, math.nan
    residual = np.bincount(place, weights * (hits - share), count)
    variance = count / (count - 1.0) * float(residual @ residual) / total**2
    trials = share * (1.0 - share) / variance if variance > 1e-12 else float(count)
    level = 0.5 * (1.0 + confidence)
    trials *= float((norm.ppf(level) / t.ppf(level, count - 1)) ** 2)
    hit = share * trials
    lower = float(beta.ppf(1.0 - level, hit, trials - hit + 1.0)) if share > 1e-12 else 0.0
    upper = float(beta.ppf(level, hit + 1.0, trials - hit)) if share < 1.0 - 1e-12 else 1.0
    return share, lower, upper


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
    earthquakes; factor, the geometric mean over bodies of the factor on the design of all; width, the ratio of the ends
    of its 90 % interval over resampled earthquakes, the median over bodies.
    """
    count, shape = int(site.events.max()) + 1, (len(METHODS), len(QUANTILES))
    random = np.random.default_rng([seed, *b"site"])
    sums = {left_out: np.zeros((2, *shape, *site.capacity.shape)) for left_out in ("one", "half")}
    for left_out, out in partitions(count, draws, random):
        factors = site.factors(~out * 1.0)[:, :, np.newaxis]
        records = out[site.events]
        sums[left_out][0][:, :, records] += site.capacity[records] < factors
        sums[left_out][1][:, :, records] += 1.0
    resampled = np.array([site.factors(times) for times in draw_earthquakes(count, resamples, [seed, *b"width"])])
    low, high = np.quantile(resampled, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
    width, whole = np.median(high / low, axis=-1), np.exp(np.mean(np.log(site.factors(np.ones(count))), axis=-1))
    of_events = (np.arange(count)[:, np.newaxis] == site.events) / np.bincount(site.events)[:, np.newaxis]
    rows = []
    for left_out, (severe, judged) in sums.items():
        shares = of_events @ (severe / np.maximum(judged, 1.0))  # (2, 3, g, 12)
        for (method, level), table in ((place, shares[place]) for place in np.ndindex(shape)):
            share, *interval = share_interval(table.mean(axis=1), np.ones(count), np.arange(count), CONFIDENCE)
            quantile = QUANTILES[level]
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
                    "earthquakes": count,
                    "factor": whole[method, level],
                    "width": width[method, level],
                }
            )
    return pd.DataFrame(rows)
