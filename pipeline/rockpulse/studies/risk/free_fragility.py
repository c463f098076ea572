"""The fragility of free bodies over an intensity measure, from the overturning spectra of records.

.. note:: At the level x of a measure a record of the value m acts with the factor x/m, so its effective impulse on a
   body is S x/m, and the body overturns where that exceeds g tan(alpha)/p. Over records ln(S/m) has a mean and a
   standard deviation, earthquakes alike: P(overturning | x) is the normal distribution of (ln x + mean - ln(g
   tan(alpha)/p))/deviation. Beside it stands the mean of the records' own probabilities, which assumes no distribution.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import ndtr

from rocking.block import Block
from rockpulse.errors import ConfigError
from rockpulse.storage.variables.risk import FREE_FRAGILITY
from rockpulse.studies.risk.body_curves import curves_in_parts, event_weights, spectra_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["free_body_fragility"]


def free_body_fragility(results: xr.DataTree, block: Block, levels: Any, measure: str = "pga") -> xr.Dataset:
    """The probability of overturning of free bodies at levels of an intensity measure.

    Parameters
    ----------
    results : xarray.DataTree
        Of :func:`rockpulse.assess`, with the spectra at the p of these bodies (``[uncertainty] spectrum = "all"``).
    block : Block
        (m,) slender free-standing bodies.
    levels : (n,) array_like
        Of the measure, positive [m/s2 or m/s].
    measure : str
        "pga" or "pgv", of one component as the records were assessed.

    Returns
    -------
    xarray.Dataset
        Over (body, level): `probability`, the mean of those of the records, and `lognormal`, by the `median` and
        `dispersion` of S over (body). In PGA they are 0 below g tan(alpha). NaN for a body that the spectra do not
        stand for.

    Raises
    ------
    ResultsError
        For results without spectra, or with gaps at the p of the bodies.
    ConfigError
        For another measure, or levels that are not positive.

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> shake = [
    ...     rp.Record(3.0 * np.sin(2.0 * np.pi * f * t), dt=0.01, id=f"sine {f}", processed=True) for f in (0.7, 1.1)
    ... ]
    >>> config = rp.Config(uncertainty=rp.UncertaintySettings(spectrum="all"))
    >>> tree = rp.assess(shake, config, blocks={"pier": rp.models.Block(width=1.0, height=5.0)})
    >>> found = rp.free_body_fragility(tree, rp.models.Block(width=[1.0], height=[5.0]), [1.0, 3.0, 30.0])
    >>> bool(found["probability"][0, 0] == 0.0), bool(found["probability"][0, 2] > 0.9)
    (True, True)
    """
    import xarray as xr

    at = np.atleast_1d(np.asarray(levels, dtype=float))
    spectra, summary = spectra_of(results, measure)
    if at.ndim != 1 or not np.all(np.isfinite(at) & (at > 0.0)):
        raise ConfigError(f"levels: expected positive numbers, got {levels!r:.80}")
    lanes = block if block.shape else block.lanes(1)
    weights = event_weights([str(event) for event in summary["event"].values]).mean(axis=0)
    found = {
        name: np.full((lanes.shape[0], *([at.size] if "level" in one.dims else [])), np.nan)
        for name, one in FREE_FRAGILITY.items()
    }
    for places, curves in curves_in_parts(spectra, summary, lanes, measure):
        middle, deviation = curves.scatter(weights)
        moves = np.log(at) > curves.floor[:, np.newaxis] if measure == "pga" else np.ones((places.size, at.size))
        over = (np.log(at) - middle[:, np.newaxis]) / deviation[:, np.newaxis]
        of_records = [curves.read_at(curves.probability, np.full((1, 1), one)) @ weights for one in np.log(at)]
        found["lognormal"][places] = moves * ndtr(over)
        found["probability"][places] = moves * np.stack(of_records, axis=1)
        found["median"][places], found["dispersion"][places] = np.exp(middle), deviation
    return xr.Dataset(
        {name: one.variable(found[name]) for name, one in FREE_FRAGILITY.items()}, {"level": at}, {"measure": measure}
    )
