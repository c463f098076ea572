"""Intensity measures of a ground motion, with or without the block: each a function in a table.

.. note:: Every measure is proportional to a factor on the record: a capacity found as a factor is one in any of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from rocking.block import Block
from rocking.demand import Demand, ground_demand
from rockpulse.ladder import Scene
from rockpulse.record.intensity import fajfar_index, largest_change, pgv, spectral_acceleration, spectrum_intensity
from rockpulse.storage.variables.fragility import STATED, STRENGTH

__all__ = ["LARGEST_LOBES", "MEASURES", "QUALITIES", "TESTED", "Measure", "record_measures", "record_qualities"]

#: Lobes of E whose root mean square is a measure.
LARGEST_LOBES = 6

#: Half-waves with more than this share of the largest impulse are strong.
STRONG_SHARE = 0.5


@dataclass(frozen=True)
class Measure:
    """An intensity measure, its unit and long name as in the results.

    `value` takes a scene and (m,) blocks and returns a number or (m,) numbers.
    """

    units: str
    long_name: str
    value: Callable[[Scene, Block], np.ndarray | float]

    @property
    def dimensionless(self) -> bool:
        """Whether bodies of different size and slenderness can be put together in it."""
        return self.units == "1"


def _capacity(block: Block) -> np.ndarray:
    return np.asarray(block.gravity * np.tan(block.alpha_c))


def _impulse(scene: Scene) -> float:
    return float(np.max(np.abs(scene.waves.impulse), initial=0.0))


def _demand(scene: Scene, block: Block) -> Demand:
    return ground_demand(block, scene.record.acceleration, scene.record.dt)


def _rms(scene: Scene, block: Block) -> np.ndarray:
    return np.asarray(np.sqrt(np.mean(_demand(scene, block).lobes[:, :LARGEST_LOBES] ** 2, axis=1)))


def _acceleration(scene: Scene, block: Block, period: float) -> float:
    return spectral_acceleration(scene.record, period)


def _change(scene: Scene, block: Block) -> np.ndarray:
    rates, place = np.unique(block.p, return_inverse=True)
    largest = np.array([largest_change(scene.record, 2.0 / rate) for rate in rates])[place]
    return np.asarray(block.p * largest / _capacity(block))


#: Every measure by its name. E is the exponentially weighted impulse of :mod:`rocking.demand`; its lobes are
#: the largest abs(E) between two changes of sign, up to 16 of them.
MEASURES: dict[str, Measure] = {
    "pga": Measure("m s-2", "PGA", lambda scene, block: scene.record.pga),
    "pgv": Measure("m s-1", "PGV", lambda scene, block: pgv(scene.record)),
    "si": Measure(
        "m s-1", "SI (mean pseudo-velocity, 0.1 to 2.5 s)", lambda scene, block: spectrum_intensity(scene.record)
    ),
    "fajfar": Measure("m s-3/4", "PGV t_D^(1/4), t_D = D5-95", lambda scene, block: fajfar_index(scene.record)),
    **{
        f"sa_{period:g}": Measure("m s-2", f"Sa({period:g} s), 5 %", partial(_acceleration, period=period))
        for period in (0.5, 1.0, 2.0)
    },
    "uplift_ratio": Measure("1", "PGA/(g tan alpha_c)", lambda scene, block: scene.record.pga / _capacity(block)),
    "velocity_ratio": Measure(
        "1", "p PGV/(g tan alpha_c)", lambda scene, block: block.p * pgv(scene.record) / _capacity(block)
    ),
    "si_ratio": Measure(
        "1", "p SI/(g tan alpha_c)", lambda scene, block: block.p * spectrum_intensity(scene.record) / _capacity(block)
    ),
    "change_ratio": Measure("1", "p times the largest change of velocity within 2/p, over g tan alpha_c", _change),
    "impulse": Measure("m s-1", "largest half-wave impulse I", lambda scene, block: _impulse(scene)),
    "impulse_ratio": Measure("1", "I/I_1c", lambda scene, block: _impulse(scene) / block.critical_impulse),
    "demand_largest": Measure(
        "1", "largest p abs(E)/(g tan alpha_c)", lambda scene, block: _demand(scene, block).largest
    ),
    "demand_rms": Measure("1", "root mean square of the six largest lobes of p abs(E)/(g tan alpha_c)", _rms),
    "demand_cubic": Measure(
        "1",
        "cube root of the sum of the cubes of the lobes of p abs(E)/(g tan alpha_c)",
        lambda scene, block: np.cbrt(np.sum(_demand(scene, block).lobes ** 3, axis=1)),
    ),
    "demand_build_up": Measure(
        "1",
        "sum of (0.9 C)^k times the k-th largest lobe of p abs(E)/(g tan alpha_c), k from 0",
        lambda scene, block: _demand(scene, block).build_up,
    ),
}

#: Qualities of a record beside its intensity, which every record has.
QUALITIES = ("duration", "period", "strong_half_waves")

#: All that capacity is tested to depend on, in the order of the results.
TESTED = (*QUALITIES, STRENGTH, *STATED)


def record_measures(scene: Scene, block: Block, names: tuple[str, ...]) -> np.ndarray:
    """The k named measures of a record as it is, (k, m) in the unit of each, for (m,) lanes."""
    weaker = block.weaker
    return np.stack([np.broadcast_to(MEASURES[name].value(scene, weaker), block.shape) for name in names])


def record_qualities(scene: Scene) -> dict[str, float]:
    """Properties of a record on which a measure should not depend, by the names of :data:`QUALITIES`."""
    sizes = np.abs(scene.waves.between(scene.phase.start, scene.phase.end).impulse)
    return {
        "duration": scene.phase.duration,
        "period": 2.0 * math.pi * pgv(scene.record) / scene.record.pga,
        "strong_half_waves": float(np.count_nonzero(sizes > STRONG_SHARE * np.max(sizes, initial=0.0))),
    }
