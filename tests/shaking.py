"""A made-up accelerogram without a defect, and one defect of each kind put into an accelerogram at a given strength."""

import numpy as np

from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record

DT = 0.01


def shaking(seed=0, peak=3.0, seconds=60.0, dt=DT):
    """Band-limited noise (0.3 to 12 Hz) [m/s2] that rises after 10 s and dies away, printed to six decimals."""
    rng = np.random.default_rng(seed)
    time = dt * np.arange(round(seconds / dt))
    since = np.maximum(time - 10.0, 0.0)
    shaped = rng.normal(size=time.size) * since**2 * np.exp(-0.5 * since)
    frequency = np.fft.rfftfreq(2 * time.size, dt)
    low, high = (frequency / 0.3) ** 6, (frequency / 12.0) ** 6
    band = np.fft.irfft(np.fft.rfft(shaped, 2 * time.size) * low / (1.0 + low) / (1.0 + high))[: time.size]
    return np.round(peak * band / np.max(np.abs(band)) + 1e-5 * rng.normal(size=time.size), 6)


def at(samples, share):
    """Index at which a share of the energy has arrived."""
    energy = np.cumsum(samples**2)
    return int(np.searchsorted(energy, share * energy[-1]))


def step(samples, dt, strength):
    """A baseline step that brings the final velocity to so many times the PGV."""
    start = at(samples, 0.4)
    peak = pgv(Record(samples, dt, id="step"))
    return samples + strength * peak / ((samples.size - start) * dt) * (np.arange(samples.size) >= start), dt


def line(samples, dt, strength):
    """A baseline that grows linearly and brings the final velocity to half so many times the PGV."""
    peak = pgv(Record(samples, dt, id="line"))
    return samples + strength * peak / (samples.size * dt) * np.linspace(0.0, 1.0, samples.size), dt


def held(samples, dt, strength):
    """One value for so many seconds of the strong motion."""
    start = at(samples, 0.5)
    changed = samples.copy()
    changed[start : start + round(strength / dt)] = changed[start]
    return changed, dt


def filled(samples, dt, strength):
    """A straight line for so many seconds of the strong motion."""
    start = at(samples, 0.5)
    end = start + round(strength / dt)
    changed = samples.copy()
    changed[start : end + 1] = np.linspace(changed[start], changed[end], end - start + 1)
    return changed, dt


def repeated(samples, dt, strength):
    """That share of the samples repeat the one before."""
    changed = samples.copy()
    for place in np.flatnonzero(np.random.default_rng(1).random(samples.size - 1) < strength) + 1:
        changed[place] = changed[place - 1]
    return changed, dt


def twice(samples, dt, strength):
    """So many samples come a second time, over those behind them."""
    start = at(samples, 0.4)
    changed = samples.copy()
    changed[start + strength : start + 2 * strength] = changed[start : start + strength]
    return changed, dt


def spike(samples, dt, strength):
    """So many times the peak added to one sample of the strong motion."""
    place = at(samples, 0.3)
    changed = samples.copy()
    changed[place] += np.copysign(strength * np.max(np.abs(samples)), samples[place])
    return changed, dt


def noise(samples, dt, strength):
    """White noise over a motion whose peak is so many times three standard deviations of it."""
    white = np.random.default_rng(2).normal(size=samples.size)
    return 0.1 * (3.0 * strength * samples / np.max(np.abs(samples)) + white), dt


def late(samples, dt, strength):
    """Begins where that share of the energy has arrived."""
    return samples[at(samples, strength) :], dt


def early(samples, dt, strength):
    """Ends where that share of the energy has arrived."""
    return samples[: at(samples, strength)], dt


def coarse(samples, dt, strength):
    """A sample every so many seconds, without a filter."""
    time = np.arange(0.0, (samples.size - 1) * dt, strength)
    return np.interp(time, dt * np.arange(samples.size), samples), strength


#: By a name, the code of the defect, the function that makes it, and three strengths of which the larger two are found.
MADE = {
    "step": ("velocity_drift", step, (1.0, 20.0, 40.0)),
    "line": ("velocity_drift", line, (2.0, 30.0, 80.0)),
    "held": ("held_value", held, (0.05, 0.3, 1.0)),
    "filled": ("filled_gap", filled, (0.05, 0.3, 1.0)),
    "repeated": ("repeated_samples", repeated, (0.1, 0.5, 0.75)),
    "twice": ("repeated_block", twice, (16, 64, 200)),
    "spike": ("spike", spike, (0.02, 3.0, 10.0)),
    "noise": ("noise_only", noise, (2.0, 0.05, 0.0)),
    "late": ("starts_strong", late, (1e-4, 0.3, 0.4)),
    "early": ("ends_strong", early, (0.9999, 0.65, 0.4)),
    "coarse": ("coarse_sampling", coarse, (0.05, 0.1, 0.2)),
}
