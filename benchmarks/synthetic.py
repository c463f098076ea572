"""Seeded synthetic motions and blocks, equal on every machine, for measuring solvers and not for assessing sites."""

from typing import NamedTuple

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.record.record import STANDARD_GRAVITY

#: Samples are whole multiples of 1/PER_UNIT [m/s2]: the last bits of an FFT differ between machines, these digits do
#: not. Dividing a whole number by PER_UNIT is rounded correctly everywhere.
PER_UNIT = 1e6


class SyntheticLanes(NamedTuple):
    """One block and one strength of shaking per lane."""

    p: np.ndarray  #: (count,) frequency parameter [1/s]
    alpha: np.ndarray  #: (count,) critical angle [rad]
    restitution: np.ndarray  #: (count,) velocity ratio C [-]
    pga: np.ndarray  #: (count,) peak ground acceleration that the lane asks for [m/s2]


def synthetic_motion(seed: int, duration: float = 60.0, dt: float = 0.01, pga: float = 3.0) -> np.ndarray:
    """Synthetic accelerogram (n,) [m/s2]: Gaussian noise with the Kanai-Tajimi spectrum under an envelope.

    n is round(duration/dt) + 1. Samples are whole multiples of 1e-6 m/s2 that sum to 0; the first and the last are
    zero. The `seed` draws the noise, the ground frequency (0.5 to 5 Hz, log-uniform) and damping (0.3 to 0.7), and the
    envelope.

    Spectrum, with r = f/f_g (Kanai-Tajimi) and q = f/f_h, f_h = 0.1 f_g (the second filter of Clough & Penzien, damping
    0.6, which takes away what would drift):

    S(f) = (1 + 4 z^2 r^2)/((1 - r^2)^2 + 4 z^2 r^2) x q^4/((1 - q^2)^2 + 4 0.6^2 q^2)

    Envelope (Amin & Ang; Jennings, Housner & Tsai): (t/t_1)^2, then 1 up to t_2, then exp(-k (t - t_2)). t_1 is 3 to 15
    % of the duration, the strong phase t_2 - t_1 3 to 35 %, and k leaves 1e-6 to 0.03 (log-uniform) at the end.

    References: Tajimi (1960), Proc. 2nd World Conf. Earthq. Eng., Tokyo, 2, 781-797; Clough & Penzien (1975), Dynamics
    of Structures, McGraw-Hill; Amin & Ang (1968), J. Eng. Mech. Div. ASCE 94(2), 559-583; Jennings, Housner & Tsai
    (1968), Simulated earthquake motions, EERL, Caltech.
    """
    if not 1.0 <= duration <= 1e5:
        raise ConfigError(f"duration: expected 1 to 1e5 s, got {duration!r}")
    if not 1e-4 <= dt <= 0.1:
        raise ConfigError(f"dt: expected a sampling interval of 0.0001 to 0.1 s, got {dt!r}")
    if not 1e-3 <= pga <= 1e3:
        raise ConfigError(f"pga: expected 0.001 to 1000 m/s2, got {pga!r}")
    random = _frozen_stream(seed)
    ground_hz = 0.5 * 10.0 ** random.uniform(0.0, 1.0)
    damping = random.uniform(0.3, 0.7)
    rise, strong = random.uniform(0.03, 0.15), random.uniform(0.03, 0.35)
    left = 10.0 ** random.uniform(-6.0, -1.5)
    n = round(duration / dt) + 1
    noise = np.fft.rfft(random.standard_normal(n))

    frequency = np.fft.rfftfreq(n, dt)
    r, q = (frequency / ground_hz) ** 2, (frequency / (0.1 * ground_hz)) ** 2
    kanai_tajimi = (1.0 + 4.0 * damping**2 * r) / ((1.0 - r) ** 2 + 4.0 * damping**2 * r)
    no_drift = q**2 / ((1.0 - q) ** 2 + 4.0 * 0.6**2 * q)
    stationary = np.fft.irfft(noise * np.sqrt(kanai_tajimi * no_drift), n)

    t = np.arange(n) / (n - 1)
    decay = np.exp(np.log(left) * np.maximum(t - rise - strong, 0.0) / (1.0 - rise - strong))
    envelope = np.minimum((t / rise) ** 2, 1.0) * decay
    envelope[-1] = 0.0
    motion = stationary * envelope
    motion -= envelope * (np.sum(motion) / np.sum(envelope))
    whole = np.rint(motion * (pga * PER_UNIT / np.max(np.abs(motion)))).astype(np.int64)
    return _balanced(whole) / PER_UNIT


def _frozen_stream(seed: int) -> np.random.RandomState:
    # Its stream is frozen; newer generators may change theirs between versions of numpy.
    if not 0 <= seed < 2**32:
        raise ConfigError(f"seed: expected a whole number from 0 to 2**32 - 1, got {seed!r}")
    return np.random.RandomState(seed)


def _balanced(whole: np.ndarray) -> np.ndarray:
    """Whole numbers that sum to zero: what rounding left over is taken from small samples, evenly spread."""
    rest = int(whole.sum())
    inner = np.arange(1, whole.size - 1)
    small = inner[np.abs(whole[inner]) <= np.median(np.abs(whole))]
    chosen = small[np.linspace(0, small.size - 1, abs(rest)).astype(np.int64)]
    np.subtract.at(whole, chosen, int(np.sign(rest)))
    return whole


def synthetic_lanes(seed: int, count: int, restitution: float = 0.9) -> SyntheticLanes:
    """Blocks of p 1 to 8 1/s, alpha 0.05 to 0.3 rad and PGA 0.2 to 0.4 g (count,), drawn lane by lane from a seed."""
    if count < 1:
        raise ConfigError(f"count: expected at least one lane, got {count!r}")
    share = _frozen_stream(seed).uniform(size=(count, 3))
    p, alpha, pga = 8.0 ** share[:, 0], 0.05 + 0.25 * share[:, 1], (0.2 + 0.2 * share[:, 2]) * STANDARD_GRAVITY
    p, alpha, pga = (np.rint(values * PER_UNIT) / PER_UNIT for values in (p, alpha, pga))
    return SyntheticLanes(p, alpha, np.full(count, float(restitution)), pga)
