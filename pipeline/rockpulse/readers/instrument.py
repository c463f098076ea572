"""From counts to acceleration with the response of an instrument, as StationXML or an obspy Trace holds it."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.obspy_bridge import obspy_notes
from rockpulse.readers.sensitivity import GAIN_TOLERANCE, first_stage, measured, turned

__all__ = ["Removed", "pass_band", "without_response"]

#: SI units as obspy spells them; it scales the others under some of their spellings only.
_OBSPY_UNITS = {"displacement": "M", "velocity": "M/S", "acceleration": "M/S**2"}

#: The response is removed where it is above this share of its largest value: noise grows at most by its inverse.
RESPONSE_FLOOR = 0.01
#: Begin and end of the upper taper, as shares of the highest frequency of the pass band.
UPPER_TAPER = (0.8, 0.95)
#: A pass band that begins above this [Hz] is reported: pulses near a fault last several seconds.
LONG_PULSES = 0.05
#: Half-waves longer than this share of the period at which the pass band begins lose 4 % of their impulse and more.
_WHOLE_IMPULSE = 0.2
#: Frequencies at which the response is looked at.
_LOOKS = 400


@dataclass(frozen=True)
class Removed:
    """Samples without the response of the instrument."""

    samples: np.ndarray  # (n,) acceleration over `factor` [counts]
    factor: float  # m/s2 per count at the frequency of the sensitivity; the samples carry the rest of the response
    note: str  # the method, for the processing of the record
    warnings: tuple[str, ...]


def without_response(where: str, counts: np.ndarray, dt: float, response: Any) -> Removed:
    """Remove the full response of an instrument from counts (n,) in the frequency domain, down to acceleration.

    The response must lead from ground acceleration, velocity or displacement to counts. The method is
    ``Trace.remove_response(output="ACC")`` with the mean removed before, no taper in time (it would eat a pulse near
    the ends), no water level (it would distort what `pass_band` lets through), and a cosine taper in frequency.

    Raises
    ------
    NotAcceleration
        If the response does not begin with ground motion.
    RecordRefused
        If the response has no stages, is a polynomial, or begins with an unknown unit.
    RecordFormatError
        If obspy cannot evaluate it.
    """
    import obspy

    unit, quantity, scale = _input_unit(where, response)
    response = _in_si(response, _OBSPY_UNITS[quantity])
    counts = np.asarray(counts, dtype=float)
    try:
        with obspy_notes(terminal=True) as notes:
            band = pass_band(response, dt, counts.size)
            trace = obspy.Trace(counts, {"delta": dt})
            trace.stats.response = response
            trace.remove_response(output="ACC", pre_filt=band, water_level=None, zero_mean=True, taper=False)
            gain, size = _gain(response, band)
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
    # Stages that differ from the sensitivity are reported by `_disagreement`, with the figure.
    warnings = [note for note in notes if not any(words in note for words in ("norm_resp", "Execution continuing"))]
    if quantity != "acceleration":
        warnings.append(f"a sensor of {quantity}, differentiated: check that it was not driven to its limit")
    if band[1] > LONG_PULSES:
        warnings.append(
            f"the pass band begins at {band[1]:.3g} Hz: impulses longer than about {_WHOLE_IMPULSE / band[1]:.2g} s "
            "are damped; use an accelerometer for near-fault pulses"
        )
    warnings += _disagreement(where, response, size, quantity, scale)
    return Removed(trace.data * gain, scale / gain, note, tuple(warnings))


def _input_unit(where: str, response: Any) -> tuple[str, str, float]:
    """Input unit of a response, the quantity it measures, SI units per unit; refused where it cannot be removed."""
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
    unit = str(first_stage(response).input_units or (sensitivity and sensitivity.input_units))
    return (unit.upper(), *measured(where, unit))


def _in_si(response: Any, unit: str) -> Any:
    """The response with an SI unit at the input of its first stage, in counts per unit of the file."""
    first = first_stage(response)
    renamed = copy.copy(first)
    renamed.input_units = unit
    result = copy.copy(response)
    result.response_stages = [renamed if stage is first else stage for stage in response.response_stages]
    return result


def _disagreement(where: str, response: Any, size: float, quantity: str, scale: float) -> list[str]:
    """A warning where the stages, with `size` counts per unit, contradict the stated sensitivity."""
    sensitivity = response.instrument_sensitivity
    if np.isnan(size):
        return []
    found, per_unit = measured(where, sensitivity.input_units) if sensitivity.input_units else (quantity, scale)
    if found != quantity:
        return [f"the sensitivity is stated for {found}, the stages of the response begin with {quantity}"]
    share = (size / scale) / (abs(float(sensitivity.value)) / per_unit) - 1.0
    if abs(share) <= GAIN_TOLERANCE:
        return turned(sensitivity)
    return [*turned(sensitivity), f"the stages of the response differ from its sensitivity by {100.0 * share:.3g} %"]


def pass_band(response: Any, dt: float, count: int) -> tuple[float, float, float, float]:
    """Corners of the cosine taper in frequency [Hz]: zero below the first, one from the second to the third.

    Where the instrument answers at zero frequency (accelerometers) nothing is cut below, so that the impulse of a
    near-fault pulse stays whole: the first two are negative. Else the second is one cycle in the record of `count`
    samples, or where the response falls to `RESPONSE_FLOOR` of its largest value if that is higher, and the first half
    of it. The others are `UPPER_TAPER` of the Nyquist frequency, or of where the response falls below the same floor.
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
    """Counts per m/s2 at one frequency, and counts per unit of the ground motion at that of the stated sensitivity.

    The second is NaN where no sensitivity is stated, or one at a frequency outside the pass band.
    """
    sensitivity = response.instrument_sensitivity
    frequency = float(sensitivity.frequency or 0.0) if sensitivity is not None and sensitivity.value else np.inf
    if max(band[1], 0.0) <= frequency <= band[2]:
        return abs(_at(response, frequency, "ACC")), abs(_at(response, frequency, "DEF"))
    return abs(_at(response, float(np.sqrt(max(band[1], 0.01 * band[2]) * band[2])), "ACC")), np.nan


def _at(response: Any, frequency: float, output: str) -> complex:
    return complex(response.get_evalresp_response_for_frequencies(np.array([frequency]), output=output)[0])
