"""The factors that bring a motion to the demands of a site."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from rocking.block import Block
from rockpulse.config.settings import DemandSettings
from rockpulse.record.intensity import pgv, spectral_acceleration, spectrum_intensity
from rockpulse.record.record import Record

__all__ = ["FARTHEST", "demand_factors"]

#: Factors on a record between which it still stands for a recorded earthquake of the demand's strength (docs/limits.md).
FARTHEST = (0.25, 4.0)

#: The strength of a motion in each measure of a demand; that of "velocity_ratio" before it is taken over the body's.
_STRENGTH: dict[str, Callable[[Record, DemandSettings], float]] = {
    "pga": lambda record, demand: record.pga,
    "pgv": lambda record, demand: pgv(record),
    "si": lambda record, demand: spectrum_intensity(record),
    "velocity_ratio": lambda record, demand: pgv(record),
    "sa": lambda record, demand: spectral_acceleration(record, demand.period or math.nan),
}


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
    found = np.empty((blocks.shape[0], len(demands)))
    for place, demand in enumerate(demands):
        strength = math.exp(np.mean([math.log(_STRENGTH[demand.measure](one, demand)) for one in channels]))
        own = blocks.p / (blocks.gravity * np.tan(blocks.alpha_c)) if demand.measure == "velocity_ratio" else 1.0
        found[:, place] = demand.value / (strength * own)
    return found
