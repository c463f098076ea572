"""Computes intensity measures and the intense phase of a record.

The ground acceleration is linear between samples, and the ground velocity is zero at the first sample.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.record.record import STANDARD_GRAVITY, Record, largest

#: Length of the intense phase in section 4 of Casapulla & Maione (2017) [s].
WINDOW_LENGTH = 20.0
#: Damping of oscillators [-], and the periods of Housner's intensity [s].
DAMPING, PERIODS = 0.05, np.linspace(0.1, 2.5, 49)
#: Smallest number of points per period at which the response of an oscillator is computed.
POINTS = 16
#: Default acceleration that limits the bracketed duration [m/s2] (Bolt 1973).
BRACKET_LEVEL = 0.05 * STANDARD_GRAVITY
#: Share of the Arias intensity at which a significant duration ends, by its name; names of all methods.
UPPER_SHARES = {"D5-95": 0.95, "D5-75": 0.75}
INTENSE_PHASES = (*UPPER_SHARES, "bracketed", "window")


@dataclass(frozen=True)
class IntensePhase:
    """The part of a record that a calibration uses, in seconds from the first sample."""

    start: float
    end: float

    @property
    def duration(self) -> float:
        """Length of the phase [s]."""
        return self.end - self.start


def arias_intensity(record: Record) -> float:
    """Return the Arias intensity [m/s]: the integral of the squared acceleration, times pi/(2 g)."""
    return float(math.pi / (2.0 * STANDARD_GRAVITY) * _energy(record)[-1])


def pgv(record: Record) -> float:
    """Return the largest absolute ground velocity [m/s], at a sample or a zero crossing of the acceleration."""
    left, right = record.acceleration[:-1], record.acceleration[1:]
    velocity = ground_velocity(record.acceleration, record.dt)
    crossing = np.flatnonzero(((left < 0.0) & (right > 0.0)) | ((left > 0.0) & (right < 0.0)))
    before, after = left[crossing], right[crossing]
    interior = velocity[crossing] + 0.5 * record.dt * before * (before / (before - after))
    return max(largest(velocity), largest(interior))


def ground_velocity(acceleration: np.ndarray, dt: float) -> np.ndarray:
    """Return the ground velocity at each sample of the ground acceleration; it is zero at the first sample."""
    velocity = np.zeros(acceleration.size)
    np.add(acceleration[1:], acceleration[:-1], out=velocity[1:])
    velocity[1:] *= 0.5 * dt
    return np.cumsum(velocity, out=velocity)


def spectral_acceleration(record: Record, period: float) -> float:
    """Return the 5 % damped pseudo-acceleration at a period [s]: (2 pi/period)^2 times the peak displacement [m/s2]."""
    from scipy.signal import lfilter  # imported late, as its import is slow

    # Exact at each computed time; interpolation adds times if the sampling is coarse for the period.
    finer = max(1, math.ceil(POINTS * record.dt / period))
    times = np.arange((record.npts - 1) * finer + 1) / finer
    ground = record.acceleration if finer == 1 else np.interp(times, np.arange(record.npts), record.acceleration)
    rate = 2.0 * math.pi / period
    return rate * rate * float(np.max(np.abs(lfilter(*_oscillator(rate, record.dt / finer), ground))))


@lru_cache(maxsize=4096)
def _oscillator(rate: float, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and denominator of the digital filter that turns ground acceleration into displacement.

    The displacement is that of an oscillator with the circular frequency `rate` [rad/s], relative to the ground.
    """
    from scipy.signal import cont2discrete

    upper, lower, _ = cont2discrete(([-1.0], [1.0, 2.0 * DAMPING * rate, rate * rate]), dt, method="foh")
    return upper[0], lower


def spectrum_intensity(record: Record) -> float:
    """Return Housner's intensity divided by 2.4 s: the mean 5 % damped pseudo-velocity from 0.1 to 2.5 s [m/s]."""
    velocities = [period / (2.0 * math.pi) * spectral_acceleration(record, period) for period in PERIODS]
    return float(np.trapezoid(velocities, PERIODS) / (PERIODS[-1] - PERIODS[0]))


def largest_change(record: Record, within: float) -> float:
    """Return the largest change of the ground velocity [m/s] over the time `within` [s], rounded to whole samples."""
    velocity = np.append(0.0, np.cumsum(0.5 * (record.acceleration[1:] + record.acceleration[:-1]))) * record.dt
    steps = min(max(round(within / record.dt), 1), velocity.size - 1)
    return largest(velocity[steps:] - velocity[:-steps])


def fajfar_index(record: Record) -> float:
    """Return PGV t_D^(1/4) [m s^-0.75], where t_D is the duration D5-95 (Fajfar, Vidic & Fischinger 1990)."""
    return pgv(record) * intense_phase(record).duration ** 0.25


def intense_phase(
    record: Record,
    method: str = "D5-95",
    start_s: float | None = None,
    end_s: float | None = None,
    level: float | None = None,
) -> IntensePhase:
    """Return the intense phase of a record.

    Parameters
    ----------
    record : Record
        Ground acceleration, (n,) [m/s2].
    method : {"D5-95", "D5-75", "bracketed", "window"}
        "D5-95", "D5-75": between these percentages of the Arias intensity. "bracketed": from the first to the last time
        the absolute acceleration exceeds `level`. "window": from `start_s` to `end_s`; 20 s (the paper's limit) from
        `start_s` if only this is given; if neither is given, the window of 20 s with the largest Arias intensity among
        windows that begin at a sample. A window ends with the record at the latest.
    start_s, end_s : float, optional
        Limits of the window [s] from the first sample.
    level : float, optional
        Acceleration that limits the bracketed duration [m/s2], by default 0.05 g.

    Returns
    -------
    IntensePhase
        Its start and end are interpolated between samples, since the Arias intensity is a cubic of time there.

    Raises
    ------
    ConfigError
        For an unknown method, or an argument that is invalid or does not apply to the method.
    RecordRefused
        If the record is zero throughout, never exceeds `level`, or ends before the window begins.

    References
    ----------
    Trifunac, M. D., Brady, A. G. (1975), Bull. Seismol. Soc. Am. 65(3), 581-626.
    Bolt, B. A. (1973), Duration of strong ground motion, Proc. 5th World Conf. Earthquake Eng., Rome.
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, section 4, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> phase = intense_phase(Record([2.0, 2.0, 2.0], dt=5.0, id="constant"))
    >>> round(phase.start, 6), round(phase.end, 6)
    (0.5, 9.5)
    """
    if method not in INTENSE_PHASES:
        raise ConfigError(f"intense_phase: method: expected one of {', '.join(INTENSE_PHASES)}, got {method!r}")
    if method != "window" and (start_s is not None or end_s is not None):
        raise ConfigError(
            f"intense_phase: start_s and end_s apply only to method 'window', found {method!r}: "
            "leave them out or change the method"
        )
    if method != "bracketed" and level is not None:
        raise ConfigError(f"intense_phase: level applies only to method 'bracketed', found {method!r}: leave it out")
    if method == "bracketed":
        return _bracketed_phase(record, BRACKET_LEVEL if level is None else level)
    if method == "window":
        return _window(record, start_s, end_s)
    energy = _nonzero_energy(record)
    return IntensePhase(*(_time_of(record, energy, share * energy[-1]) for share in (0.05, UPPER_SHARES[method])))


def _energy(record: Record) -> np.ndarray:
    """Return the integral of the squared acceleration from the first sample to each sample, (n,) [m2/s3]."""
    left, right = record.acceleration[:-1], record.acceleration[1:]
    return np.concatenate(([0.0], np.cumsum(record.dt / 3.0 * (left * left + left * right + right * right))))


def _nonzero_energy(record: Record) -> np.ndarray:
    energy = _energy(record)
    if energy[-1] <= 0.0:
        raise RecordRefused(
            f"{record.id}: the acceleration is zero throughout: there is no intense phase; leave the record out"
        )
    return energy


def _time_of(record: Record, energy: np.ndarray, level: float) -> float:
    """Return the first time [s] at which the integral of the squared acceleration reaches `level` [m2/s3]."""
    after = max(int(np.searchsorted(energy, level)), 1)
    before = after - 1
    left, right = record.acceleration[before : after + 1].tolist()
    scale = max(abs(left), abs(right))
    missing = level - energy[before]
    if missing == 0.0:
        return before * record.dt
    # In units of the larger end the value reached is b = cbrt(a^3 + 3 s E), s the slope; (b - a)/s = 3 E/(a^2 + a b +
    # b^2) is the time without the cancellation at small s.
    left, slope, missing = left / scale, (right - left) / scale / record.dt, missing / scale**2
    reached = float(np.cbrt(left**3 + 3.0 * slope * missing))
    after_left = 3.0 * missing / (left * left + left * reached + reached * reached)
    return float(before * record.dt + min(after_left, record.dt))


def _bracketed_phase(record: Record, bracket: float) -> IntensePhase:
    if not (math.isfinite(bracket) and bracket > 0.0):
        raise ConfigError(f"intense_phase: level: expected a positive acceleration in m/s2, got {bracket!r}")
    above = np.flatnonzero(np.abs(record.acceleration) > bracket)
    if above.size == 0:
        raise RecordRefused(
            f"{record.id}: the acceleration never exceeds level = {bracket:.4g} m/s2 (PGA {record.pga:.4g} m/s2); "
            "give a lower level or choose method 'D5-95'"
        )
    ends = ((int(above[0]), -1), (int(above[-1]), 1))
    return IntensePhase(*(_bracket_time(record, inside, inside + step, bracket) for inside, step in ends))


def _bracket_time(record: Record, inside: int, outside: int, bracket: float) -> float:
    if not 0 <= outside < record.npts:
        return inside * record.dt
    high, low = record.acceleration[inside], record.acceleration[outside]
    fraction = (high - math.copysign(bracket, high)) / (high - low)
    return float((inside + (outside - inside) * fraction) * record.dt)


def _window(record: Record, start_s: float | None, end_s: float | None) -> IntensePhase:
    if start_s is None:
        if end_s is not None:
            raise ConfigError("intense_phase: end_s needs start_s; give both, start_s alone, or neither")
        return _strongest_window(record)
    end = start_s + WINDOW_LENGTH if end_s is None else end_s
    if not (math.isfinite(start_s) and math.isfinite(end) and 0.0 <= start_s < end):
        raise ConfigError(
            f"intense_phase: expected 0 <= start_s < end_s in s, got start_s {start_s!r} and end_s {end_s!r}"
        )
    if start_s >= record.duration:
        raise RecordRefused(
            f"{record.id}: the window begins at {start_s:g} s, after the end of the record ({record.duration:g} s); "
            "give an earlier start_s"
        )
    return IntensePhase(float(start_s), min(float(end), record.duration))


def _strongest_window(record: Record) -> IntensePhase:
    energy = _nonzero_energy(record)
    if record.duration <= WINDOW_LENGTH:
        return IntensePhase(0.0, record.duration)
    # A window that begins at sample i ends `part` of an interval after sample i + whole.
    whole, part = divmod(WINDOW_LENGTH / record.dt, 1.0)
    starts = np.arange(math.floor((record.duration - WINDOW_LENGTH) / record.dt * (1.0 + 1e-12)) + 1)
    ends = np.minimum(starts + int(whole), record.npts - 1)
    left = record.acceleration[ends]
    step = record.acceleration[np.minimum(ends + 1, record.npts - 1)] - left
    inside = record.dt * part * (left * left + part * left * step + part * part * step * step / 3.0)
    content = energy[ends] + inside - energy[starts]
    # Equal windows differ by rounding errors: the first one within these errors of the largest is chosen.
    start = record.dt * int(np.argmax(content >= np.max(content) * (1.0 - 1e-12)))
    return IntensePhase(start, min(start + WINDOW_LENGTH, record.duration))
