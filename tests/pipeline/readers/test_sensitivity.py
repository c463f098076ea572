"""The sensitivity of an instrument: its unit, its sign, and the gains of the stages."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.kit.response import first_stage, measured, sensitivity_factor, sensitivity_notes, turned
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY


def response(value, unit="M/S**2", gains=(), first="M/S**2"):
    """Stages of some gains, the last first, as a file may hold them."""
    stages = [
        SimpleNamespace(stage_gain=gain, stage_sequence_number=number, input_units=first if number == 1 else "V")
        for number, gain in enumerate(gains, 1)
    ]
    whole = SimpleNamespace(value=value, input_units=unit)
    return SimpleNamespace(instrument_sensitivity=whole, response_stages=stages[::-1] or None)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("M", ("displacement", 1.0)),
        ("cm", ("displacement", 0.01)),
        ("MM", ("displacement", 0.001)),
        ("UM/S", ("velocity", 1e-6)),
        ("nm/sec", ("velocity", 1e-9)),
        ("M/SECOND", ("velocity", 1.0)),
        ("m s-1", ("velocity", 1.0)),
        ("MM/S**2", ("acceleration", 0.001)),
        ("M/S/S", ("acceleration", 1.0)),
        ("cm s-2", ("acceleration", 0.01)),
        ("(M/S^2)", ("acceleration", 1.0)),
        ("g", ("acceleration", STANDARD_GRAVITY)),
        ("Gal", ("acceleration", 0.01)),
        ("gals", ("acceleration", 0.01)),
    ],
)
def test_units_of_motion_in_any_spelling(unit, expected):
    quantity, scale = measured("x", unit)
    assert (quantity, scale) == (expected[0], pytest.approx(expected[1], rel=1e-12))
    if quantity == "acceleration":
        assert sensitivity_factor("x", response(-50.0, unit)) == pytest.approx(-scale / 50.0, rel=1e-12)


def test_sensitivities_of_no_acceleration_are_refused():
    for value in (None, 0.0):
        with pytest.raises(RecordRefused, match=r"^x is in counts and its response states no sensitivity"):
            sensitivity_factor("x", response(value))
    with pytest.raises(RecordRefused, match="states no sensitivity"):
        sensitivity_factor("x", SimpleNamespace(instrument_sensitivity=None))
    for value in (float("inf"), float("nan")):
        with pytest.raises(
            RecordFormatError, match=rf"^x: expected a finite sensitivity of the instrument, found {value}"
        ):
            sensitivity_factor("x", response(value))
    with pytest.raises(NotAcceleration, match=r"^x records CM/S, expected an acceleration"):
        sensitivity_factor("x", response(2.0, "CM/S"))
    with pytest.raises(NotAcceleration, match=r"^x records hPa, expected ground motion"):
        measured("x", "hPa")
    with pytest.raises(RecordRefused, match="unknown input unit None"):
        measured("x", None)


@pytest.mark.parametrize(
    ("value", "unit", "gains", "first", "told"),
    [
        (600.0, "M/S**2", (2.0, 300.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, None, 300.0), "M/S**2", ""),
        (600.0, "M/S**2", (None,), "M/S**2", ""),
        (600.0, "M/S**2", (), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 314.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 320.0), "M/S**2", "differ from its sensitivity by 6.67 %"),
        (600.0, "M/S**2", (2.0, 286.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 270.0), "M/S**2", "differ from its sensitivity by -10 %"),
        (6.0, "CM/S**2", (2.0, 300.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 3.0), "CM/S**2", ""),
        (
            600.0,
            "M/S",
            (2.0, 300.0),
            "M/S**2",
            "stated for velocity, the stages of the response begin with acceleration",
        ),
        (600.0, "COUNTS", (2.0, 300.0), "CM/S**2", ""),
        (600.0, "CM/S**2", (2.0, 300.0), "PA", ""),
        (600.0, "M/S**2", (2.0, float("nan")), "M/S**2", "by nan %"),
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_sensitivity_against_the_gains_of_the_stages(value, unit, gains, first, told, sign):
    signed = tuple(gain and gain * (sign if number == 0 else 1.0) for number, gain in enumerate(gains))
    notes = sensitivity_notes(response(sign * value, unit, signed, first))
    assert notes[: len(notes) - bool(told)] == (
        [f"the sensitivity is negative, {-value:g}: a sign is turned"] if sign < 0.0 else []
    )
    assert not told or notes[-1].endswith(told)


def test_the_first_stage_is_that_of_the_lowest_number():
    assert first_stage(response(1.0, gains=(7.0, 8.0, 9.0))).stage_gain == 7.0
    assert turned(SimpleNamespace(value=-0.5)) == ["the sensitivity is negative, -0.5: a sign is turned"]
    assert turned(SimpleNamespace(value=0.0)) == turned(SimpleNamespace(value=3.0)) == []
