"""What the age of a body that still stands says of a hazard: a precarious rock as a test of it.

.. note:: A body that overturns lambda times a year has stood for T years with the probability exp(-lambda T). At a
   confidence q that leaves frequencies up to -ln(1 - q)/T; a larger one contradicts the hazard, whose rates would have
   to be lower by the ratio of the two, for lambda is proportional to them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.storage.variables.risk import STANDING

if TYPE_CHECKING:
    import xarray as xr


def standing_test(risk: xr.Dataset, age: float, confidence: float = 0.95) -> xr.Dataset:
    """What it says of the hazard that bodies have stood for so many years.

    Parameters
    ----------
    risk : xarray.Dataset
        Of :func:`rockpulse.annual_frequency` for overturning, or of :func:`rockpulse.inventory_frequency`.
    age : float
        Time for which the bodies have stood as they are [years].
    confidence : float
        At which a frequency is excluded [-].

    Returns
    -------
    xarray.Dataset
        Over the bodies: `chance` = exp(-frequency age) with `chance_low` and `chance_high` at the limits of the
        frequency, `largest`, the frequency at which the chance is 1 - confidence [1/year], `factor` on the rates of
        the hazard that leads to it, and `contradicted`.

    Raises
    ------
    ConfigError
        For an age that is not positive, or a confidence that is none.

    References
    ----------
    Brune, J. N. (1996), Bull. Seismol. Soc. Am. 86(1A), 43-54.

    Examples
    --------
    >>> import xarray as xr
    >>> risk = xr.Dataset({name: ("body", [1e-3]) for name in ("frequency", "frequency_low", "frequency_high")})
    >>> found = standing_test(risk, age=5000.0)  # exp(-5) = 0.0067; -ln(0.05)/5000 = 5.99e-4
    >>> [round(float(found[name].item()), 6) for name in ("chance", "largest", "factor", "contradicted")]
    [0.006738, 0.000599, 0.599146, 1.0]
    """
    import xarray as xr

    if not (math.isfinite(age) and age > 0.0) or not 0.0 < confidence < 1.0:
        raise ConfigError(f"age, confidence: expected a positive time and a share, got {age!r}, {confidence!r}")
    frequency, low, high = (risk[f"frequency{end}"].values for end in ("", "_low", "_high"))
    largest = np.full(frequency.shape, -math.log1p(-confidence) / age)
    values = {
        "chance": np.exp(-frequency * age),
        "chance_low": np.exp(-high * age),
        "chance_high": np.exp(-low * age),
        "largest": largest,
        "factor": largest / frequency,
        "contradicted": np.where(np.isnan(frequency), -1, frequency > largest),
    }
    dims = tuple(map(str, risk["frequency"].dims))
    found = xr.Dataset({name: one.variable(values[name], dims) for name, one in STANDING.items()}, risk.coords)
    found.attrs.update(age=age, confidence=confidence)
    return found
