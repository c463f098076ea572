"""From counts to acceleration with the response of an instrument, as StationXML or an obspy Trace holds it."""

from __future__ import annotations

import warnings as python_warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.source import NotAcceleration

__all__ = ["Removed", "pass_band", "sensitivity_factor", "without_response"]

#: Input units of an accelerometer's response, and m/s2 per unit.
_ACCELERATION_UNITS = {"M/S**2": 1.0, "M/S^2": 1.0, "M/S/S": 1.0, "M/S2": 1.0, "CM/S**2": 0.01, "CM/S^2": 0.01}
#: Input units whose response can be removed, all of them scaled by obspy, and what they measure.
_MOTION_UNITS = {"M/S**2": "acceleration", "M/S/S": "acceleration", "CM/S**2": "acceleration"}
_MOTION_UNITS |= {"M/S": "velocity", "CM/S": "velocity", "MM/S": "velocity", "NM/S": "velocity"}
_MOTION_UNITS |= {"M": "displacement", "CM": "displacement", "MM": "displacement", "NM": "displacement"}

#: The response is removed where it is above this share of its largest value: noise grows at most by its inverse.
RESPONSE_FLOOR = 0.01
#: Where the upper taper begins and ends, as shares of the highest frequency of the pass band.
UPPER_TAPER = (0.8, 0.95)
#: The stages of a response and its stated sensitivity may differ by this share before it is reported.
_GAIN_TOLERANCE = 0.05
#: Frequencies at which the response is looked at.
_LOOKS = 400


@dataclass(frozen=True)
class Removed:
    """Samples without the response of the instrument.

    Attributes
    ----------
    samples : (n,) ndarray
        Acceleration over `factor` [counts].
    factor : float
        m/s2 per count at the frequency of the sensitivity; the samples carry the rest of the response.
    note : str
        What was done, for the processing of the record.
    warnings : tuple of str
        What is doubtful.
    """

    samples: np.ndarray
    factor: float
    note: str
    warnings: tuple[str, ...]


def sensitivity_factor(where: str, response: Any) -> float:
    """m/s2 per count from the overall sensitivity of an accelerometer.

    Parameters
    ----------
    where : str
        File and channel, for messages.
    response : obspy Response
        The response.

    Raises
    ------
    NotAcceleration
        If the instrument records velocity or displacement.
    RecordRefused
        If no sensitivity is stated.
    """
    sensitivity = response.instrument_sensitivity
    if sensitivity is None or not sensitivity.value:
        raise RecordRefused(f"{where} is in counts and its response states no sensitivity; get the full StationXML")
    unit = str(sensitivity.input_units).upper()
    if unit not in _ACCELERATION_UNITS:
        raise NotAcceleration(
            f"{where} records {unit}, expected an acceleration (M/S**2); use the accelerometer channel of the station "
            "(code ending in NE, NN, NZ), or have the response removed (response='remove')"
        )
    return _ACCELERATION_UNITS[unit] / float(sensitivity.value)


def without_response(where: str, counts: np.ndarray, dt: float, response: Any) -> Removed:
    """Remove the full response of an instrument in the frequency domain, down to acceleration.

    Parameters
    ----------
    where : str
        File and channel, for messages.
    counts : (n,) ndarray
        Samples [counts].
    dt : float
        Sampling interval [s].
    response : obspy Response
        With its stages, from ground acceleration, velocity or displacement to counts.

    Returns
    -------
    Removed
        The acceleration and how it was made.

    Raises
    ------
    RecordRefused
        If the response has no stages, is a polynomial, or does not begin with ground motion.
    RecordFormatError
        If obspy cannot evaluate it.

    Notes
    -----
    ``Trace.remove_response(output="ACC")`` with the mean removed before, no taper in time (it would eat a pulse near
    the ends), no water level (it would distort what `pass_band` lets through), and a cosine taper in frequency.
    """
    import obspy

    unit = _input_unit(where, response)
    counts = np.asarray(counts, dtype=float)
    try:
        with python_warnings.catch_warnings(record=True) as caught:
            python_warnings.simplefilter("always")
            band = pass_band(response, dt, counts.size)
            trace = obspy.Trace(counts, {"delta": dt})
            trace.stats.response = response
            trace.remove_response(output="ACC", pre_filt=band, water_level=None, zero_mean=True, taper=False)
            gain, gap = _gain(response, band)
    except Exception as fault:  # obspy and its C library raise what they like on an odd response
        raise RecordFormatError(
            f"{where}: obspy cannot evaluate the response: {fault}; get the StationXML again, or use its sensitivity"
        ) from fault
    if not band[1] < band[2]:
        raise RecordRefused(
            f"{where}: {counts.size} samples are too few to remove the response: the pass band would begin at "
            f"{band[1]:.3g} Hz and end at {band[2]:.3g} Hz; use a longer record"
        )
    if not np.all(np.isfinite(trace.data)):
        raise RecordFormatError(f"{where}: the response is zero within the pass band; use its sensitivity")
    low = f"from {band[1]:.3g} Hz (nothing below {band[0]:.3g} Hz)" if band[0] > 0.0 else "from 0 Hz"
    note = (
        f"instrument response removed, {unit} to m/s2: mean removed, pass band {low} to {band[2]:.3g} Hz "
        f"(nothing above {band[3]:.3g} Hz)"
    )
    warnings = [f"obspy: {item.message}" for item in caught if not issubclass(item.category, DeprecationWarning)]
    if _MOTION_UNITS[unit] != "acceleration":
        warnings.append(f"a sensor of {_MOTION_UNITS[unit]}, differentiated: check that it was not driven to its limit")
    if abs(gap) > _GAIN_TOLERANCE:
        warnings.append(f"the stages of the response differ from its sensitivity by {100.0 * gap:.3g} %")
    return Removed(trace.data * gain, 1.0 / gain, note, tuple(warnings))


def _input_unit(where: str, response: Any) -> str:
    """Unit of the ground motion [upper case]; refused where the full response cannot be removed."""
    from obspy.core.inventory.response import PolynomialResponseStage

    stages = response.response_stages
    if not stages:
        raise RecordRefused(
            f"{where}: the StationXML has no stages of the response; get it with them (level=response), or use the "
            "sensitivity"
        )
    if any(isinstance(stage, PolynomialResponseStage) for stage in stages):
        raise RecordRefused(f"{where}: the response is a polynomial, which is not read; use the sensitivity")
    sensitivity = response.instrument_sensitivity
    unit = str(stages[0].input_units or (sensitivity and sensitivity.input_units)).upper()
    if unit not in _MOTION_UNITS:
        raise NotAcceleration(f"{where} records {unit}, expected ground motion: one of {', '.join(_MOTION_UNITS)}")
    return unit


def pass_band(response: Any, dt: float, count: int) -> tuple[float, float, float, float]:
    """Corners of the cosine taper in frequency [Hz]: zero below the first, one from the second to the third.

    Parameters
    ----------
    response : obspy Response
        The response, to whatever the instrument records.
    dt : float
        Sampling interval [s].
    count : int
        Samples of the record.

    Returns
    -------
    tuple of four floats
        Where the instrument answers at zero frequency (accelerometers) nothing is cut below, so that the impulse of
        a near-fault pulse stays whole: the first two are negative. Else the second is one cycle in the record, or
        where the response falls to `RESPONSE_FLOOR` of its largest value if that is higher, and the first half of
        it. The others are `UPPER_TAPER` of the Nyquist frequency, or of where the response falls below the same floor.
    """
    nyquist, cycle = 0.5 / dt, 1.0 / (count * dt)
    looks = np.concatenate([[0.0], np.geomspace(min(0.1 * cycle, 0.01 * nyquist), nyquist, _LOOKS)])
    size = np.abs(response.get_evalresp_response_for_frequencies(looks, output="DEF"))
    # At zero the C library divides by zero for some sensors: what it cannot tell counts as no answer.
    answers = looks[np.nan_to_num(size) >= RESPONSE_FLOOR * np.nanmax(size)]
    lowest, highest = float(answers[0]), float(answers[-1])
    low = (-2.0, -1.0) if lowest == 0.0 else (0.5 * max(lowest, cycle), max(lowest, cycle))
    return (*low, UPPER_TAPER[0] * highest, UPPER_TAPER[1] * highest)


def _gain(response: Any, band: tuple[float, float, float, float]) -> tuple[float, float]:
    """Counts per m/s2 at one frequency, and by what share the stages differ from the stated sensitivity there."""
    sensitivity = response.instrument_sensitivity
    frequency = float(sensitivity.frequency or 0.0) if sensitivity is not None and sensitivity.value else np.inf
    if max(band[1], 0.0) <= frequency <= band[2]:
        share = abs(_at(response, frequency, "DEF")) / abs(float(sensitivity.value)) - 1.0
        return abs(_at(response, frequency, "ACC")), share
    return abs(_at(response, float(np.sqrt(max(band[1], 0.01 * band[2]) * band[2])), "ACC")), 0.0


def _at(response: Any, frequency: float, output: str) -> complex:
    return complex(response.get_evalresp_response_for_frequencies(np.array([frequency]), output=output)[0])
