"""Conditions a record: corrects the baseline, filters without phase shift, and resamples; every step is optional."""

import logging
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.record.defects import DRIFT, slow_velocity, with_defects
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record
from rockpulse.warning_text import WarningText, code_of, find

#: Share of the energy of the record at which the pre-event window ends; the energy is computed about the mean.
QUIET_SHARE = 1e-6
#: Shortest pre-event window that is found automatically [s].
QUIET_LENGTH = 1.0
#: Share of the PGV above which the final velocity of a record gives a warning.
DRIFT_SHARE = 0.1
#: Largest length of the default taper at each end, as a share of the record.
TAPER_SHARE = 0.05
#: Length of the zeros added at each end, divided by the order of the filter, in periods of its lowest corner frequency
#: (Boore 2005).
PAD_PERIODS = 1.5
#: Largest number of zeros added at each end [samples]; a corner frequency that needs more is rejected.
LONGEST_PAD = 10_000_000
#: Anti-alias filter of resampling: attenuation in the stop band [dB]; width of the transition band below the lower
#: Nyquist frequency, as a share of this frequency.
RESAMPLING_ATTENUATION = 100.0
RESAMPLING_TRANSITION = 0.2
#: Largest numerator and denominator of a resampling ratio.
RESAMPLING_LIMIT = 1000
logger = logging.getLogger("rockpulse")


def condition(
    record: Record,
    baseline: str = "auto",
    highpass_hz: float | None = None,
    lowpass_hz: float | None = None,
    order: int = 2,
    taper_s: float | None = None,
    resample_s: float | None = None,
    pre_event_s: float | None = None,
) -> Record:
    """Return a conditioned copy of a record: baseline removed, then tapered and filtered, then resampled.

    Parameters
    ----------
    record : Record
        Ground acceleration, (n,) [m/s2].
    baseline : {"auto", "none", "mean", "pre-event", "linear", "quadratic"}
        What is subtracted. "none": nothing. "mean", "linear", "quadratic": the least-squares polynomial of degree 0, 1
        or 2 through all samples.
        "pre-event": the mean of the pre-event window, or of all samples if no window is found. "auto": nothing for a
        processed record, "pre-event" for a raw one, "mean" with a warning if the format does not state the processing.
    highpass_hz, lowpass_hz : float, optional
        Corner frequencies of the Butterworth filters [Hz]; by default no filter is applied.
    order : int
        Order of one pass of each filter, 1 to 10. The filter runs forwards and backwards, so that the effective order
        is twice this, the phase zero, and the gain 1/(1 + (fc/f)^(2 order)), which is 1/2 at the corner.
    taper_s : float, optional
        Length of the cosine taper at each end [s]; 0 for none. By default there is none without a filter; with a filter
        it is one period of the lowest corner, but at most 5 % of the record.
    resample_s : float, optional
        New sampling interval [s].
    pre_event_s : float, optional
        Length of the pre-event window from the first sample [s]; by default it is detected.

    Returns
    -------
    Record
        The conditioned record, with the steps added to ``processing`` in words and numbers, and a warning if the
        baseline is assumed or the ground velocity ends at more than 10 % of the PGV.

    Raises
    ------
    ConfigError
        For an unknown baseline, corners that are negative, in the wrong order or not below the Nyquist frequency,
        tapers that overlap, a pre-event window outside the record, or a new interval whose ratio to the old one is not
        a fraction of integers up to 1000.

    Notes
    -----
    *Pre-event window.* S(T) is the energy of the first T seconds about their own mean; S never decreases with T.
    The window ends where S reaches 1e-6 of its value for the whole record, and is not used if shorter than 1 s.

    *Filter.* The record is tapered, padded with zeros over a time of 1.5 n/f at both ends (Boore 2005; n is the order
    of a pass, f the lowest corner frequency), and cut to its old length after filtering. The ground velocity of the cut
    record starts from zero; the processing step states the velocity of the padded record at that time.

    *Resampling.* A polyphase filter with a Kaiser window (100 dB) passes frequencies up to 0.8 times the lower of the
    two Nyquist frequencies, and stops frequencies above this Nyquist frequency, so that a longer sampling interval
    causes no aliasing. The time of the first sample does not change.

    References
    ----------
    Boore, D. M. (2005), On pads and filters, Bull. Seismol. Soc. Am. 95(2), 745-750, doi:10.1785/0120040160.

    Examples
    --------
    >>> raw = Record([2.0, 1.0, 3.0, 2.0], dt=0.01, id="raw", processed=False)
    >>> shifted = condition(raw, baseline="mean")
    >>> shifted.acceleration.tolist(), shifted.processing
    ([0.0, -1.0, 1.0, 0.0], ('baseline: mean of all samples, 2 m/s2, subtracted',))
    """
    nyquist, length = 0.5 / record.dt, record.duration
    band = f"a frequency above 0 and below the Nyquist frequency {nyquist:g} Hz of {record.id}"
    window = f"a window of at least two samples inside {record.id}, {record.dt:g} to {length:g} s"
    tapers = f"0 to {0.5 * length:g} s, half the length of {record.id}"
    interval = f"a positive interval in s, no longer than {record.id} ({length:g} s)"
    for name, right, given, expected in (
        ("baseline", baseline in BASELINES, baseline, f"one of {', '.join(BASELINES)}"),
        ("highpass_hz", highpass_hz is None or 0.0 < highpass_hz < nyquist, highpass_hz, band),
        ("lowpass_hz", lowpass_hz is None or 0.0 < lowpass_hz < nyquist, lowpass_hz, band),
        ("order", type(order) is int and 1 <= order <= 10, order, "a whole number from 1 to 10"),
        ("taper_s", taper_s is None or 0.0 <= taper_s <= 0.5 * length, taper_s, tapers),
        ("resample_s", resample_s is None or 0.0 < resample_s <= length, resample_s, interval),
        ("pre_event_s", pre_event_s is None or record.dt <= pre_event_s <= length, pre_event_s, window),
    ):
        if not right:
            raise ConfigError(f"condition: {name}: expected {expected}, got {given!r}")
    if highpass_hz is not None and lowpass_hz is not None and highpass_hz >= lowpass_hz:
        raise ConfigError(f"condition: expected highpass_hz below lowpass_hz, got {highpass_hz!r} and {lowpass_hz!r}")
    if pre_event_s is not None and baseline not in ("auto", "pre-event"):
        only = "pre_event_s applies only to baseline 'pre-event' or 'auto'"
        raise ConfigError(f"condition: {only}, found {baseline!r}; leave it out")
    record = BASELINES[baseline](with_defects(record), pre_event_s)
    corner, unfiltered = highpass_hz or lowpass_hz, record
    if taper_s is None:
        taper_s = 0.0 if corner is None else min(1.0 / corner, TAPER_SHARE * record.duration)
    if taper_s > 0.0:
        record = _taper(record, taper_s)
    if corner is not None:
        record = _filter(record, highpass_hz, lowpass_hz, order, unfiltered)
    if resample_s is not None and not math.isclose(resample_s, record.dt, rel_tol=1e-9):
        record = _resample(record, resample_s)
    return replace(_watched(record), stage="conditioned")


def _watched(record: Record) -> Record:
    """Add a warning on baseline drift if the ground velocity of the record drifts; otherwise remove such a warning."""
    final = record.dt * float(np.sum(record.acceleration) - 0.5 * (record.acceleration[0] + record.acceleration[-1]))
    peak = pgv(record)
    record = replace(record, warnings=tuple(one for one in record.warnings if code_of(one) != "baseline_drift"))
    slow, rest = slow_velocity(record.acceleration, record.dt)
    if abs(final) <= DRIFT_SHARE * peak and slow <= DRIFT * rest:
        return record
    return _warned(record, WarningText("baseline_drift", velocity=final, slow=slow, rest=rest, pgv=peak))


def _warned(record: Record, warning: WarningText) -> Record:
    logger.warning("%s: %s", record.id, warning)
    return record.with_warning(warning)


def _noted(record: Record, acceleration: np.ndarray, note: str) -> Record:
    return replace(record, acceleration=acceleration, processing=(*record.processing, note))


def _polynomial(record: Record, degree: int, name: str) -> Record:
    # On [-1, 1] and in Legendre polynomials the fit is well conditioned for any length of record.
    place = np.linspace(-1.0, 1.0, record.npts)
    fitted = np.polynomial.legendre.legfit(place, record.acceleration, min(degree, record.npts - 1))
    line = np.polynomial.legendre.legval(place, fitted)
    values = f"{line[0]:.4g} m/s2" if degree == 0 else f"{line[0]:.4g} m/s2 at the start, {line[-1]:.4g} at the end"
    return _noted(record, record.acceleration - line, f"baseline: {name} of all samples, {values}, subtracted")


def _pre_event(record: Record, pre_event: float | None) -> Record:
    count = quiet_samples(record) if pre_event is None else math.floor(pre_event / record.dt * (1.0 + 1e-12)) + 1
    length = (count - 1) * record.dt
    if pre_event is None and length < QUIET_LENGTH:
        note = (
            f"baseline: no pre-event window, the record is quiet for {length:.4g} s only "
            f"(needed: {QUIET_LENGTH:g} s): mean of all samples instead"
        )
        return _polynomial(record.with_note(note), 0, "mean")
    mean = float(np.mean(record.acceleration[:count]))
    found = "detected" if pre_event is None else "given"
    note = f"baseline: mean of the pre-event window 0 to {length:.4g} s ({found}), {mean:.4g} m/s2, subtracted"
    return _noted(record, record.acceleration - mean, note)


def quiet_samples(record: Record) -> int:
    """Return the number of samples in the pre-event window that is detected in a record, at least 1."""
    # Subtract the first sample, as a constant offset would exceed the noise.
    shifted = record.acceleration - record.acceleration[0]
    number = np.arange(1, record.npts + 1)
    energy = np.cumsum(shifted**2) - np.cumsum(shifted) ** 2 / number
    beyond = energy > QUIET_SHARE * energy[-1]
    return int(np.argmax(beyond)) if beyond[-1] else record.npts


def _auto(record: Record, pre_event: float | None) -> Record:
    if record.processed:
        return _noted(record, record.acceleration, "baseline: unchanged, as the record is processed")
    if record.processed is False:
        return _pre_event(record, pre_event)
    record = _polynomial(record, 0, "mean")
    return record if find(record.warnings, "baseline_guessed") else _warned(record, WarningText("baseline_guessed"))


#: Functions that subtract the baseline of a record, by the value of the option `baseline`.
BASELINES: dict[str, Callable[[Record, float | None], Record]] = {
    "auto": _auto,
    "none": lambda record, _: record,
    "mean": lambda record, _: _polynomial(record, 0, "mean"),
    "pre-event": _pre_event,
    "linear": lambda record, _: _polynomial(record, 1, "line"),
    "quadratic": lambda record, _: _polynomial(record, 2, "parabola"),
}


def _taper(record: Record, length: float) -> Record:
    edge = np.minimum(record.time, record.time[::-1])
    window = 0.5 * (1.0 - np.cos(np.pi * np.minimum(edge / length, 1.0)))
    tapered = record.acceleration * window
    before, after = np.sum(record.acceleration**2), np.sum(tapered**2)
    lost = 0.0 if before == 0.0 else 100.0 * (1.0 - after / before)
    return _noted(record, tapered, f"taper: cosine, {length:.4g} s at each end, removes {lost:.2g} % of the energy")


def _filter(record: Record, highpass: float | None, lowpass: float | None, order: int, unfiltered: Record) -> Record:
    from scipy import signal  # imported late, as its import is slow

    rate = 1.0 / record.dt
    corners = {kind: corner for kind, corner in (("high-pass", highpass), ("low-pass", lowpass)) if corner is not None}
    kinds = {kind.replace("-", ""): corner for kind, corner in corners.items()}
    sections = [signal.butter(order, corner, kind, fs=rate, output="sos") for kind, corner in kinds.items()]
    words = [f"{kind} {corner:g} Hz" for kind, corner in corners.items()]
    pad = math.ceil(PAD_PERIODS * order / (highpass or lowpass or rate) * rate)
    if pad > LONGEST_PAD:
        raise ConfigError(
            f"condition: the corner frequency {highpass or lowpass:g} Hz needs {pad:.3g} samples of padding at each "
            f"end, expected at most {LONGEST_PAD:g}; use a higher one ({record.id} is {record.duration:g} s long)"
        )
    filtered = signal.sosfiltfilt(np.concatenate(sections), np.pad(record.acceleration, pad), padtype=None)
    cut = replace(record, acceleration=filtered[pad : pad + record.npts])
    # Velocity at the first sample that is kept, by the trapezoidal rule.
    lead = record.dt * float(np.sum(filtered[:pad]) + 0.5 * filtered[pad])
    note = (
        f"filter: Butterworth {' and '.join(words)}, zero phase, order {order} each way (effective {2 * order}), "
        f"pads of {pad * record.dt:.4g} s removed afterwards (velocity at the first sample: {lead:.3g} m/s); "
        f"PGV {pgv(unfiltered):.4g} -> {pgv(cut):.4g} m/s, "
        f"largest half-wave impulse {half_waves(unfiltered).largest:.4g} -> {half_waves(cut).largest:.4g} m/s"
    )
    return _noted(record, cut.acceleration, note)


def _resample(record: Record, interval: float) -> Record:
    from scipy import signal

    ratio = Fraction(record.dt / interval).limit_denominator(RESAMPLING_LIMIT)
    up, down = ratio.numerator, ratio.denominator
    if up > RESAMPLING_LIMIT or not math.isclose(up / down, record.dt / interval, rel_tol=1e-9):
        raise ConfigError(
            f"condition: resample_s: the ratio of {interval!r} s to the interval of {record.id}, {record.dt!r} s, is "
            f"not a ratio of whole numbers up to {RESAMPLING_LIMIT}; choose a simpler interval"
        )
    lower = 1.0 / max(up, down)  # the lower Nyquist frequency, as a share of the Nyquist frequency after interpolation
    taps, beta = signal.kaiserord(RESAMPLING_ATTENUATION, RESAMPLING_TRANSITION * lower)
    kernel: Any = signal.firwin(taps | 1, (1.0 - 0.5 * RESAMPLING_TRANSITION) * lower, window=("kaiser", beta))
    kept = (record.npts - 1) * up // down + 1
    first, last = record.acceleration[[0, -1]]
    slope = (last - first) / record.duration
    departure = record.acceleration - (first + slope * record.time)
    resampled = signal.resample_poly(departure, up, down, window=kernel)[:kept]
    changed = replace(record, acceleration=resampled + (first + slope * interval * np.arange(kept)), dt=interval)
    note = (
        f"resampled: {record.dt:g} -> {interval:g} s (polyphase {up}/{down}, passes up to "
        f"{0.5 * (1.0 - RESAMPLING_TRANSITION) / max(record.dt, interval):.4g} Hz); "
        f"PGA {record.pga:.4g} -> {changed.pga:.4g} m/s2"
    )
    return changed.with_note(note)
