"""Converts counts to acceleration with the sensitivity or the full response of StationXML or of an obspy Trace."""

import copy
import math
import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers import kit
from rockpulse.readers.kit.obspy_bridge import obspy_notes

#: Quantity of each unit without its prefix, and factor of each prefix.
_QUANTITIES = {"M": "displacement", "M/S": "velocity", "M/S2": "acceleration"}
_PREFIXES = {"": 1.0, "C": 1e-2, "M": 1e-3, "U": 1e-6, "N": 1e-9}
#: Input units of a response, spelled without power signs, each with its quantity and its size in SI units.
_MOTION = {prefix + word: (name, scale) for word, name in _QUANTITIES.items() for prefix, scale in _PREFIXES.items()}
_MOTION |= {"G": ("acceleration", kit.STANDARD_GRAVITY), "GAL": ("acceleration", 0.01), "GALS": ("acceleration", 0.01)}
#: Units of sensors that do not record ground motion but may belong to the same station.
_NO_MOTION = frozenset({"PA", "HPA", "KPA", "MBAR", "C", "DEGC", "K", "T", "NT", "%", "M/M", "RAD", "RAD/S", "RAD/S2"})
#: Relative difference of the product of the stage gains and the stated sensitivity above which there is a warning.
GAIN_TOLERANCE = 0.05

#: SI units as spelled by obspy, which scales other units only in some spellings.
_OBSPY_UNITS = {"displacement": "M", "velocity": "M/S", "acceleration": "M/S**2"}
#: The response is removed where it exceeds this share of its maximum; noise grows by at most the inverse of the share.
RESPONSE_FLOOR = 0.01
#: Start and end of the upper taper, as shares of the highest frequency of the pass band.
UPPER_TAPER = (0.8, 0.95)
#: Highest start of a pass band without a warning [Hz]: pulses near a fault last several seconds.
LONG_PULSES = 0.05
#: Half-waves longer than this share of the longest period of the pass band lose 4 % or more of their impulse.
_WHOLE_IMPULSE = 0.2
_USE_SENSITIVITY = 'set [records] response = "sensitivity"'
_LOOKS = 400  # number of frequencies at which the response is evaluated


@dataclass(frozen=True)
class ConvertedCounts:
    """Samples after the conversion from counts, and the factor that turns them into m/s2."""

    samples: np.ndarray  # (n,) samples, in m/s2 after multiplication by `factor`
    factor: float | None  # m/s2 per count at the frequency of the sensitivity
    processing: tuple[str, ...]  # description of the method, for `Record.processing`
    warnings: tuple[str, ...]


def from_counts(where: str, counts: np.ndarray, dt: float, response: Any, way: str) -> ConvertedCounts:
    """Convert counts (n,) to acceleration; `way` is "sensitivity" or "remove", as in `ReadOptions.response`."""
    if way == "remove":
        removed = without_response(where, counts, dt, response)
        return replace(removed, warnings=(*kit.clipping_warning(counts), *removed.warnings))
    factor = sensitivity_factor(where, response)
    return ConvertedCounts(counts.astype(float), factor, (), tuple(sensitivity_notes(response)))


def sensitivity_factor(where: str, response: Any) -> float:
    """Return the factor [m/s2 per count] from the sensitivity of an accelerometer; `where` names the channel."""
    sensitivity = response.instrument_sensitivity
    if sensitivity is None or not sensitivity.value:
        raise RecordRefused(f"{where} is in counts and its response states no sensitivity; get the full StationXML")
    if not math.isfinite(float(sensitivity.value)):
        expected = "a finite sensitivity of the instrument"
        raise kit.unexpected(where, expected, str(sensitivity.value), "correct the StationXML")
    quantity, scale = measured(where, sensitivity.input_units)
    if quantity != "acceleration":
        raise kit.NotAcceleration(
            f"{where} records {sensitivity.input_units}, expected an acceleration (M/S**2); use the accelerometer "
            "channel of the station (code ending in NE, NN, NZ), or have the response removed (response='remove')"
        )
    return scale / float(sensitivity.value)


def sensitivity_notes(response: Any) -> list[str]:
    """Return warnings if the sensitivity is negative, or differs from the product of the stage gains."""
    sensitivity = response.instrument_sensitivity
    gains = [float(stage.stage_gain) for stage in response.response_stages or [] if stage.stage_gain is not None]
    if not gains:
        return _turned(sensitivity)
    units = (sensitivity.input_units, first_stage(response).input_units)
    total, stages = (_MOTION.get(_spelled(unit), ("", 1.0)) for unit in units)
    if not (total[0] and stages[0]):
        total = stages = ("", 1.0)
    return _turned(sensitivity) + _contradictions(math.prod(gains) / float(sensitivity.value), total, stages)


def _contradictions(ratio: float, total: tuple[str, float], stages: tuple[str, float]) -> list[str]:
    """Return a warning if the stages of a response contradict its sensitivity.

    `ratio` is the gain of the stages divided by the sensitivity; `total` and `stages` are quantity and size in SI units
    of the input units of both.
    """
    if total[0] != stages[0]:
        return [f"the sensitivity is stated for {total[0]}, but the stages of the response begin with {stages[0]}"]
    share = ratio * total[1] / stages[1] - 1.0
    off = f"the product of the stage gains differs from the sensitivity of the response by {100.0 * share:.3g} %"
    return [] if abs(share) <= GAIN_TOLERANCE else [off]


def _turned(sensitivity: Any) -> list[str]:
    note = f"the sensitivity is negative, {float(sensitivity.value):g}: the polarity is reversed"
    return [note] if float(sensitivity.value) < 0.0 else []


def _spelled(unit: Any) -> str:
    """Return an input unit in the spelling of the keys of `_MOTION`."""
    word = re.sub(r"SEC(OND)?S?", "S", re.sub(r"[\s^*().]", "", str(unit).upper()))
    return re.sub(r"(/S/S|S-2)$", "/S2", re.sub(r"(?<!/)S-1$", "/S", word))


def measured(where: str, unit: Any) -> tuple[str, float]:
    """Return the quantity that a sensor with this input unit measures, and the size of the unit in SI units."""
    word = _spelled(unit)
    if word in _NO_MOTION:
        raise kit.NotAcceleration(f"{where} records {unit}, expected ground motion, such as M/S**2")
    if word not in _MOTION:
        raise RecordRefused(
            f"{where}: unknown input unit {unit!r} of the response; expected M, M/S, M/S**2 (prefix C, M, U or N), "
            "G or GAL; correct the StationXML"
        )
    return _MOTION[word]


def first_stage(response: Any) -> Any:
    """Return the first stage of a response, whose input is the ground motion."""
    return min(response.response_stages, key=lambda stage: stage.stage_sequence_number)


def without_response(where: str, counts: np.ndarray, dt: float, response: Any) -> ConvertedCounts:
    """Remove the full instrument response from counts (n,) in the frequency domain; return acceleration."""
    # No taper in time (it would reduce a pulse near the ends), no water level (it would distort the pass band).
    import obspy

    unit, quantity, scale = _input_unit(where, response)
    # The first stage gets an SI unit as input unit; the gain remains in counts per unit of the file.
    first, response = first_stage(response), copy.copy(response)
    renamed = copy.copy(first)
    renamed.input_units = _OBSPY_UNITS[quantity]
    response.response_stages = [renamed if stage is first else stage for stage in response.response_stages]
    counts = np.asarray(counts, dtype=float)
    try:
        with obspy_notes(terminal=True) as notes:
            band = pass_band(response, dt, counts.size)
            trace = obspy.Trace(counts, {"delta": dt})
            trace.stats.response = response
            trace.remove_response(output="ACC", pre_filt=band, water_level=None, zero_mean=True, taper=False)
            gain, size = _gain(response, band)
    except Exception as fault:  # obspy and its C library may raise any error for an unusual response
        raise RecordFormatError(
            f"{where}: obspy cannot evaluate the response: {fault}; download the StationXML again, "
            f"or {_USE_SENSITIVITY}"
        ) from fault
    if not band[1] < band[2]:
        would = f"the pass band would begin at {band[1]:.3g} Hz and end at {band[2]:.3g} Hz"
        raise RecordRefused(
            f"{where}: {counts.size} samples are too few to remove the response: {would}; use a longer record"
        )
    if not np.all(np.isfinite(trace.data)):
        raise RecordFormatError(f"{where}: the response is zero within the pass band; {_USE_SENSITIVITY}")
    low = f"from {band[1]:.3g} Hz (nothing below {band[0]:.3g} Hz)" if band[0] > 0.0 else "from 0 Hz"
    passed = f"{low} to {band[2]:.3g} Hz (nothing above {band[3]:.3g} Hz)"
    note = f"instrument response removed, {unit} to m/s2: mean removed, pass band {passed}"
    # Stages that differ from the sensitivity are reported by `_disagreement`, with the difference.
    warnings = [note for note in notes if not any(words in note for words in ("norm_resp", "Execution continuing"))]
    if quantity != "acceleration":
        check = "check that it did not reach its limit"
        warnings.append(f"the sensor records {quantity}, which was differentiated: {check}")
    if band[1] > LONG_PULSES:
        damped = f"impulses longer than about {_WHOLE_IMPULSE / band[1]:.2g} s are reduced"
        advice = "use an accelerometer for near-fault pulses"
        warnings.append(f"the pass band begins at {band[1]:.3g} Hz: {damped}; {advice}")
    warnings += _disagreement(where, response, size, quantity, scale)
    return ConvertedCounts(trace.data * gain, scale / gain, (note,), tuple(warnings))


def _input_unit(where: str, response: Any) -> tuple[str, str, float]:
    """Return the input unit of a response, its quantity and size in SI units; raise an error without usable stages."""
    from obspy.core.inventory.response import PolynomialResponseStage

    stages = response.response_stages
    if not stages:
        advice = f"download it with level=response, or {_USE_SENSITIVITY}"
        raise RecordRefused(f"{where}: the StationXML contains no stages of the response; {advice}")
    if any(isinstance(stage, PolynomialResponseStage) for stage in stages):
        raise RecordRefused(f"{where}: the response is a polynomial, which is not supported; {_USE_SENSITIVITY}")
    sensitivity = response.instrument_sensitivity
    unit = str(first_stage(response).input_units or (sensitivity and sensitivity.input_units))
    return (unit.upper(), *measured(where, unit))


def _disagreement(where: str, response: Any, size: float, quantity: str, scale: float) -> list[str]:
    """Return a warning if the gain `size` of the stages [counts per unit] contradicts the stated sensitivity."""
    sensitivity = response.instrument_sensitivity
    if np.isnan(size):
        return []
    total = measured(where, sensitivity.input_units) if sensitivity.input_units else (quantity, scale)
    return _turned(sensitivity) + _contradictions(size / abs(float(sensitivity.value)), total, (quantity, scale))


def pass_band(response: Any, dt: float, count: int) -> tuple[float, float, float, float]:
    """Return the four corner frequencies of the cosine taper [Hz]; the pass band is from the second to the third.

    Low frequencies pass if the response at zero frequency is not zero. Otherwise the second corner is the higher of
    two frequencies: one cycle in the record, and the lowest frequency at which the response exceeds `RESPONSE_FLOOR`
    times its largest value. The first corner is half of the second.
    """
    nyquist, cycle = 0.5 / dt, 1.0 / (count * dt)
    looks = np.concatenate([[0.0], np.geomspace(min(0.1 * cycle, 0.01 * nyquist), nyquist, _LOOKS)])
    size = np.abs(response.get_evalresp_response_for_frequencies(looks, output="DEF"))
    # At zero frequency the C library divides by zero for some sensors; the result NaN counts as zero response.
    answers = looks[np.nan_to_num(size) >= RESPONSE_FLOOR * np.nanmax(size)]
    lowest, highest = float(answers[0]), float(answers[-1])
    low = (-2.0, -1.0) if lowest == 0.0 else (0.5 * max(lowest, cycle), max(lowest, cycle))
    return (*low, UPPER_TAPER[0] * highest, UPPER_TAPER[1] * highest)


def _gain(response: Any, band: tuple[float, float, float, float]) -> tuple[float, float]:
    """Return the gain in the pass band [counts] per m/s2 and per input unit (NaN if no sensitivity is stated there)."""
    sensitivity = response.instrument_sensitivity
    frequency = float(sensitivity.frequency or 0.0) if sensitivity is not None and sensitivity.value else np.inf
    if max(band[1], 0.0) <= frequency <= band[2]:
        return _at(response, frequency, "ACC"), _at(response, frequency, "DEF")
    return _at(response, float(np.sqrt(max(band[1], 0.01 * band[2]) * band[2])), "ACC"), np.nan


def _at(response: Any, frequency: float, output: str) -> float:
    return abs(complex(response.get_evalresp_response_for_frequencies(np.array([frequency]), output=output)[0]))
