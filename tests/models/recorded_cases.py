"""Blocks and motions that the tests of the recorded response share."""

import numpy as np
from scipy.signal import butter, sosfilt

from rocking import Block

G = 9.81  # VALIDATION: all numbers are for this value; blocks A and B have R = 2 m and R = 4 m
EQUATIONS = ["linear", "nonlinear"]


def block_a(**options):
    return Block(half_width=0.5, half_height=np.sqrt(3.75), gravity=G, **options)


def block_b(**options):
    return Block(half_width=0.5, half_height=np.sqrt(15.75), gravity=G, **options)


def synthetic(seed=1, n=1500, dt=0.01, peak=4.0):
    """Seeded motion of a few sines under a bell: smooth, strong enough to rock and to overturn."""
    rng = np.random.default_rng(seed)
    t = dt * np.arange(n)
    waves = sum(rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for f in (0.6, 1.1, 1.9, 3.3))
    motion = waves * np.exp(-(((t - 0.4 * t[-1]) / (0.2 * t[-1])) ** 2))
    return peak * motion / np.max(np.abs(motion))


def block_of(radius, slenderness, restitution="housner", gravity=G):
    """A rectangle by its half-diagonal [m] and slenderness."""
    alpha = np.arctan(1.0 / slenderness)
    return Block(
        half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha), restitution=restitution, gravity=gravity
    )


def shaking(seed, count, dt, low=0.3, high=8.0):
    """(n,) Noise filtered from `low` to `high` [Hz] under a half-sine envelope, peak 1; always the same for a seed."""
    noise = np.random.default_rng(seed).standard_normal(count)
    band = butter(2, [low, min(high, 0.4 / dt)], "bandpass", fs=1.0 / dt, output="sos")
    motion = sosfilt(band, noise) * np.sin(np.pi * np.arange(count) / (count - 1))
    return motion / np.max(np.abs(motion))
