"""Fragility of free bodies in terms of an intensity measure, from the stored overturning spectra of records.

.. note:: A record with the value m of a measure is scaled by x/m to reach the level x, so its effective impulse on a
   body is S x/m, and the body overturns if that exceeds g tan(alpha)/p. With the mean and standard deviation of ln(S/m)
   over records, equal for all earthquakes, P(overturning | x) is the normal distribution of (ln x + mean - ln(g
   tan(alpha)/p))/deviation. The mean of the records' probabilities assumes no distribution.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple, Self

import numpy as np
import xarray as xr
from scipy.special import ndtr

from rocking.body.block import Block
from rockpulse.earthquakes import mean_weights
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.record.measures import PGA, STORED_LEVELS
from rockpulse.sequences.design_spectrum import at_blocks, within
from rockpulse.storage.variables.risk import FREE_FRAGILITY

#: Largest number of record-body pairs that are computed at once.
AT_ONCE = 30_000


class BodyCurves(NamedTuple):
    """Overturning probabilities of m bodies under r records at l levels of a measure; logarithms of SI values."""

    at: np.ndarray  #: (m, r, l) logarithms of the levels; the step is the same for all bodies and records
    probability: np.ndarray  #: (m, r, l) probability of overturning [-]
    log_s: np.ndarray  #: (m, r) logarithms of the overturning spectra
    own: np.ndarray  #: (r,) logarithms of the intensity measure of the unscaled records
    speed: np.ndarray  #: (m,) logarithms of g tan(alpha)/p
    floor: np.ndarray  #: (m,) logarithms of g tan(alpha), the acceleration that lifts a body

    @classmethod
    def read(cls, spectra: xr.Dataset, block: Block, own: np.ndarray) -> Self:
        """Return the curves from spectra and `own`, ln of the records' measures; ResultsError if C has no spectrum."""
        axes = spectra["p"].values, spectra["restitution"].values
        log_s = at_blocks(block, *axes, np.log(spectra["spectrum"].transpose("p", "restitution", "record").values))
        if np.any(np.isnan(log_s)):
            raise ResultsError(
                "results: the spectra have no values at the C of these bodies, because [uncertainty] restitution is "
                "not a range, or too narrow a range; assess again with a range such as [0.95, 1.05]"
            )
        stored = spectra["probability"].transpose("p", "restitution", "record", "level").values
        floor = np.log(block.gravity * np.tan(block.alpha_c))
        speed = floor - np.log(block.p)
        at = (speed[:, np.newaxis] - log_s + own)[:, :, np.newaxis] + np.log(spectra["level"].values)
        return cls(at, at_blocks(block, *axes, stored), log_s, own, speed, floor)

    @property
    def spacing(self) -> float:
        """Step between the logarithms of successive stored levels."""
        return float(self.at[0, 0, -1] - self.at[0, 0, 0]) / (self.at.shape[2] - 1)

    def step_of(self, log_level: np.ndarray) -> np.ndarray:
        """Return the index (bodies, records) of the stored interval that contains a level, or is nearest to it."""
        place = ((log_level - self.at[:, :, 0]) / self.spacing).astype(int)
        return np.clip(place, 0, self.at.shape[2] - 2)

    def read_at(self, values: np.ndarray, log_level: np.ndarray) -> np.ndarray:
        """Interpolate values (bodies, records, levels) at one level for each body and record."""
        step = self.step_of(log_level)
        share = np.clip((log_level - values_at(self.at, step)) / self.spacing, 0.0, 1.0)
        low = values_at(values, step)
        return np.asarray(low + share * (values_at(values, step + 1) - low))

    def scatter(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return, for each body, mean and standard deviation over the records of ln of the level that overturns it."""
        ratio = self.log_s - self.own
        centre = ratio @ weights
        return self.speed - centre, np.sqrt((ratio - centre[:, np.newaxis]) ** 2 @ weights)

    def medians(self, weights: np.ndarray) -> np.ndarray:
        """Return, for each body, ln of the level at which the mean probability over the weighted records is 1/2."""
        low, high = self.at[:, :, 0].min(axis=1), self.at[:, :, -1].max(axis=1)
        for _ in range(48):
            middle = 0.5 * (low + high)
            reached = self.read_at(self.probability, middle[:, np.newaxis]) @ weights >= 0.5
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return np.asarray(0.5 * (low + high))


def values_at(values: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return the elements (bodies, records) of `values` (bodies, records, levels) at the level indices `place`."""
    return np.take_along_axis(values, place[:, :, np.newaxis], axis=2)[:, :, 0]


def spectra_of(results: xr.DataTree, measure: str) -> tuple[xr.Dataset, xr.Dataset]:
    """Return /spectra and, for its records, /summary; raise ConfigError for a measure that is not stored."""
    measured = [one.name for one in STORED_LEVELS]
    if measure not in measured:
        raise ConfigError(f"measure: expected one of {' or '.join(measured)}, found {measure}")
    if "spectra" not in results.children:
        raise ResultsError(
            'these results contain no overturning spectra; assess again with [uncertainty] spectrum = "all"'
        )
    spectra = results["spectra"].to_dataset()
    return spectra, results["summary"].to_dataset().sel(record=spectra["record"].values)


def curves_in_parts(
    spectra: xr.Dataset, summary: xr.Dataset, block: Block, measure: str
) -> Iterator[tuple[np.ndarray, BodyCurves]]:
    """Yield indices and curves of the bodies within the range of the spectra, in parts of limited size."""
    own = np.log(summary[measure].values.astype(float))
    covered = np.flatnonzero(within(block, spectra["p"].values, spectra["restitution"].values))
    for places in np.array_split(covered, max(1, math.ceil(covered.size * own.size / AT_ONCE))):
        if places.size:
            yield places, BodyCurves.read(spectra, block.take(places), own)


def free_body_fragility(results: xr.DataTree, block: Block, levels: Any, measure: str = PGA) -> xr.Dataset:
    """Compute the probability of overturning of free bodies at levels of an intensity measure.

    Parameters
    ----------
    results : xarray.DataTree
        Results of :func:`rockpulse.assess` with spectra at the p of these bodies (``[uncertainty] spectrum = "all"``).
    block : Block
        (m,) slender free-standing bodies.
    levels : (n,) array_like
        Levels of the measure, positive [m/s2 or m/s].
    measure : str
        "pga" or "pgv" of one component.

    Returns
    -------
    xarray.Dataset
        Over (body, level): `probability`, the mean over records, and `lognormal`, from the `median` and `dispersion` of
        S over (body). In PGA both are 0 below g tan(alpha). Both are NaN for a body that the spectra do not cover.

    Raises
    ------
    ResultsError
        For results without spectra, or if a spectrum is missing at the p of the bodies.
    ConfigError
        For another measure, or levels that are not positive.

    Examples
    --------
    >>> found = rp.free_body_fragility(results, rp.models.Block(width=[1.0], height=[5.0]), [1.0, 3.0, 30.0])
    >>> found["probability"].values.round(2).tolist()
    [[0.0, 0.08, 0.72]]
    """
    at = np.atleast_1d(np.asarray(levels, dtype=float))
    spectra, summary = spectra_of(results, measure)
    if at.ndim != 1 or not np.all(np.isfinite(at) & (at > 0.0)):
        raise ConfigError(f"levels: expected positive numbers, got {levels!r:.80}")
    lanes = block if block.shape else block.lanes(1)
    weights = mean_weights(summary["event"].values.astype(str)).mean(axis=0)
    found = {
        name: np.full((lanes.shape[0], *([at.size] if "level" in one.dims else [])), np.nan)
        for name, one in FREE_FRAGILITY.items()
    }
    for places, curves in curves_in_parts(spectra, summary, lanes, measure):
        middle, deviation = curves.scatter(weights)
        moves = np.log(at) > curves.floor[:, np.newaxis] if measure == PGA else np.ones((places.size, at.size))
        over = (np.log(at) - middle[:, np.newaxis]) / deviation[:, np.newaxis]
        of_records = [curves.read_at(curves.probability, np.full((1, 1), one)) @ weights for one in np.log(at)]
        found["lognormal"][places] = moves * ndtr(over)
        found["probability"][places] = moves * np.stack(of_records, axis=1)
        found["median"][places], found["dispersion"][places] = np.exp(middle), deviation
    return xr.Dataset(
        {name: one.variable(found[name]) for name, one in FREE_FRAGILITY.items()}, {"level": at}, {"measure": measure}
    )
