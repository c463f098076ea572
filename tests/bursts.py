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


def packet(number, event, seconds=4.0, centre=2.0, width=1.0):
    """A record of 3 m/s2 at most, named after its number and its earthquake, in a bell of a centre and a width [s]."""
    t = np.arange(0.0, seconds, 0.02)
    rng = np.random.default_rng(number)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.0)) for f in (0.6, 1.1, 2.3))
    waves *= 3.0 / np.max(np.abs(waves)) * np.exp(-(((t - centre) / width) ** 2))
    return Record(waves, dt=0.02, id=f"r{number}", event=f"e{event}", processed=True)
