"""The overall sensitivity of an instrument, in a unit that it measures, held against the gains of its stages."""

from __future__ import annotations

import math
import re
from typing import Any

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

__all__ = ["GAIN_TOLERANCE", "first_stage", "measured", "sensitivity_factor", "sensitivity_notes", "turned"]

#: Quantity that a unit without its prefix measures, and SI units per prefix.
_QUANTITIES = {"M": "displacement", "M/S": "velocity", "M/S2": "acceleration"}
_PREFIXES = {"": 1.0, "C": 1e-2, "M": 1e-3, "U": 1e-6, "N": 1e-9}
#: Input units that a response may have: spelling without signs of powers, quantity, SI units per unit.
_MOTION = {
    prefix + word: (quantity, scale) for word, quantity in _QUANTITIES.items() for prefix, scale in _PREFIXES.items()
}
_MOTION |= {"G": ("acceleration", STANDARD_GRAVITY), "GAL": ("acceleration", 0.01), "GALS": ("acceleration", 0.01)}
#: Units of sensors that share a station with accelerometers and record no motion of the ground.
_NO_MOTION = frozenset({"PA", "HPA", "KPA", "MBAR", "C", "DEGC", "K", "T", "NT", "%", "M/M", "RAD", "RAD/S", "RAD/S2"})
#: The stages of a response and its stated sensitivity may differ by this share before it is reported.
GAIN_TOLERANCE = 0.05


def sensitivity_factor(where: str, response: Any) -> float:
    """m/s2 per count from the overall sensitivity of an accelerometer; `where` names file and channel in messages.

    Raises
    ------
    NotAcceleration
        If the instrument records velocity, displacement, or no motion.
    RecordRefused
        If no sensitivity is stated, or one per an unknown unit.
    """
    sensitivity = response.instrument_sensitivity
    if sensitivity is None or not sensitivity.value:
        raise RecordRefused(f"{where} is in counts and its response states no sensitivity; get the full StationXML")
    if not math.isfinite(float(sensitivity.value)):
        raise RecordFormatError(
            f"{where}: expected a finite sensitivity of the instrument, found {sensitivity.value}; correct the "
            "StationXML"
        )
    quantity, scale = measured(where, sensitivity.input_units)
    if quantity != "acceleration":
        raise NotAcceleration(
            f"{where} records {sensitivity.input_units}, expected an acceleration (M/S**2); use the accelerometer "
            "channel of the station (code ending in NE, NN, NZ), or have the response removed (response='remove')"
        )
    return scale / float(sensitivity.value)


def sensitivity_notes(response: Any) -> list[str]:
    """Warnings where a sensitivity is negative, or is not the product of the gains of the stages."""
    notes, value = turned(response.instrument_sensitivity), float(response.instrument_sensitivity.value)
    gains = [float(stage.stage_gain) for stage in response.response_stages or [] if stage.stage_gain is not None]
    if not gains:
        return notes
    units = (response.instrument_sensitivity.input_units, first_stage(response).input_units)
    total, stages = (_MOTION.get(_spelled(unit), ("", 1.0)) for unit in units)
    if total[0] and stages[0] and total[0] != stages[0]:
        return [*notes, f"the sensitivity is stated for {total[0]}, the stages of the response begin with {stages[0]}"]
    per_unit = total[1] / stages[1] if total[0] and stages[0] else 1.0
    share = math.prod(gains) * per_unit / value - 1.0
    if not abs(share) <= GAIN_TOLERANCE:
        notes.append(f"the stages of the response differ from its sensitivity by {100.0 * share:.3g} %")
    return notes


def turned(sensitivity: Any) -> list[str]:
    """A warning where a sensitivity is negative."""
    value = float(sensitivity.value)
    return [f"the sensitivity is negative, {value:g}: a sign is turned"] if value < 0.0 else []


def _spelled(unit: Any) -> str:
    """An input unit in the spelling of `_MOTION`."""
    word = re.sub(r"SEC(OND)?S?", "S", re.sub(r"[\s^*().]", "", str(unit).upper()))
    return re.sub(r"(/S/S|S-2)$", "/S2", re.sub(r"(?<!/)S-1$", "/S", word))


def measured(where: str, unit: Any) -> tuple[str, float]:
    """The quantity that the input unit of a response measures, and SI units per unit."""
    word = _spelled(unit)
    if word in _NO_MOTION:
        raise NotAcceleration(f"{where} records {unit}, expected ground motion, such as M/S**2")
    if word not in _MOTION:
        raise RecordRefused(
            f"{where}: unknown input unit {unit!r} of the response; expected M, M/S, M/S**2 (C, M, U or N before it), "
            "G or GAL; correct the StationXML"
        )
    return _MOTION[word]


def first_stage(response: Any) -> Any:
    """The stage of a response that the ground motion enters."""
    return min(response.response_stages, key=lambda stage: stage.stage_sequence_number)
