"""The demands of a site, and the factors that bring a motion to them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rocking.block import Block
from rockpulse.config.settings import DemandSettings
from rockpulse.record.intensity import pgv, spectral_acceleration, spectrum_intensity
from rockpulse.record.record import Record

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FARTHEST", "Demand", "demand_factors", "stored_demands"]

#: Factors on a record between which it still stands for a recorded earthquake of that strength (docs/limits.md).
FARTHEST = (0.25, 4.0)

#: The strength of a motion in each measure of a demand; that of "velocity_ratio" before it is taken over the body's.
_STRENGTH: dict[str, Callable[[Record, DemandSettings], float]] = {
    "pga": lambda record, demand: record.pga,
    "pgv": lambda record, demand: pgv(record),
    "si": lambda record, demand: spectrum_intensity(record),
    "velocity_ratio": lambda record, demand: pgv(record),
    "sa": lambda record, demand: spectral_acceleration(record, demand.period or math.nan),
}


#: The measures in words, and units as they are shown.
_TITLES = {"pga": "PGA", "pgv": "PGV", "si": "SI", "velocity_ratio": "p PGV/(g tan alpha_c)", "sa": "Sa"}
_SHOWN_UNITS = {"m s-2": "m/s2", "m s-1": "m/s", "1": ""}


class Demand(NamedTuple):
    """The strength that a site asks for in a limit state: its value, and measure and value in words."""

    value: float
    limit_state: str
    words: str


def stored_demands(summary: xr.Dataset) -> dict[str, Demand]:
    """The demands of the node /summary by their names."""
    if "demand" not in summary.dims:
        return {}
    found = {}
    for place, name in enumerate(summary["demand"].values):
        own = summary.isel(demand=place)
        period = float(own["demand_period"])
        title = _TITLES[str(own["demand_measure"].values)] + ("" if math.isnan(period) else f"({period:g} s)")
        value = float(own["demand_value"])
        words = f"{title} {value:.4g} {_SHOWN_UNITS[str(own['demand_units'].values)]}".rstrip()
        found[str(name)] = Demand(value, str(own["limit_state"].values), words)
    return found


def demand_factors(channels: Sequence[Record], blocks: Block, demands: Sequence[DemandSettings]) -> np.ndarray:
    """The factor on a motion that brings it to each demand, for each of (m,) blocks.

    Parameters
    ----------
    channels : sequence of Record
        The conditioned channels of the motion's shaking: the geometric mean of their strengths is brought to the
        demand, so that a pair has one factor.
    blocks : Block
        (m,) bodies; only `measure = "velocity_ratio"` depends on them.
    demands : sequence of DemandSettings
        d demands.

    Returns
    -------
    (m, d) ndarray
        Factors [-].

    Examples
    --------
    >>> from rockpulse import Record
    >>> pair = [Record([0.0, 1.0, -1.0, 0.0], dt=0.1, id="x"), Record([0.0, 4.0, -4.0, 0.0], dt=0.1, id="y")]
    >>> body = Block(half_width=[0.2], half_height=[1.0])
    >>> demand_factors(pair, body, [DemandSettings(name="ULS", value=3.0)]).tolist()  # geometric mean 2 m/s2
    [[1.5]]
    """
    found = np.empty((*blocks.shape, len(demands)))
    for place, demand in enumerate(demands):
        strength = math.exp(np.mean([math.log(_STRENGTH[demand.measure](one, demand)) for one in channels]))
        own = blocks.p / (blocks.gravity * np.tan(blocks.alpha_c)) if demand.measure == "velocity_ratio" else 1.0
        found[:, place] = demand.strength / (strength * own)
    return found
