"""Records of bursts that are drawn from a seed, and two bodies."""

import numpy as np

from rockpulse import BlockSettings
from rockpulse.record.record import Record

DT = 0.01
WALL = BlockSettings(name="wall", width=0.4, height=3.0)
TOWER = BlockSettings(name="tower", width=3.0, height=9.0)


def motion(seed=0, peak=4.0, n=1200):
    rng = np.random.default_rng(seed)
    t = DT * np.arange(n)
    waves = sum(rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for f in (0.7, 1.3, 2.1))
    shaped = waves * np.exp(-(((t - 5.0) / 2.0) ** 2))
    return peak * shaped / np.max(np.abs(shaped))


def record(name, seed=0, peak=4.0, **options):
    return Record(motion(seed, peak), DT, id=name, processed=True, source=f"{name}.txt", **options)
