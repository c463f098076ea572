"""Spellings of the unit of acceleration."""

from __future__ import annotations

import pytest

from rockpulse.errors import UnitError
from rockpulse.readers.kit.text import UNITS, canonical_unit, mentioned_units, other_readings, quantity_of


@pytest.mark.parametrize(
    ("unit", "spellings"),
    [
        ("m/s2", "m/s2 M/S^2 m/s**2 m/sec2 m/s/s m/s² ms-2 m·s⁻² m.s^-2"),
        ("cm/s2", "cm/s2 CM/SEC/SEC cm/sec^2 cm/second2 cm/s² cms-2"),
        ("mm/s2", "mm/s2 mm/s/s"),
        ("gal", "gal Gals GAL."),
        ("g", "g G g. (g)"),
        ("g/10", "g/10 G/10."),
    ],
)
def test_spellings(unit, spellings):
    for text in spellings.split():
        assert canonical_unit(f" {text} ", "a:1") == unit


@pytest.mark.parametrize("text", ["", "counts", "m/s", "cm", "m/s3", "s-2", "kg", "gg", "1"])
def test_what_is_no_unit_of_acceleration(text):
    with pytest.raises(UnitError, match=r"a:1: unknown unit of acceleration .* expected one of m/s2, "):
        canonical_unit(text, "a:1")


def test_the_nearest_unit_is_named():
    with pytest.raises(UnitError, match=r"^option --units: unknown .* 'gg'; did you mean \"g\"\?; .*, g, g/10$"):
        canonical_unit("gg", "option --units")


def test_of_units_as_near_one_is_named():
    with pytest.raises(UnitError, match=r"'mm/s' \(velocity\); did you mean \"mm/s2\"\?; expected"):
        canonical_unit("mm/s", "option units")


def test_every_unit_reads_as_itself():
    assert [canonical_unit(unit, "") for unit in UNITS] == list(UNITS)
    assert UNITS["gal"] == UNITS["cm/s2"]


def test_other_readings_are_ordinary_accelerations():
    assert other_readings(300.0) == "0.306 g if it were cm/s2 or 0.0306 g if it were mm/s2"
    assert (
        other_readings(20.0, "cm/s2") == "2.04 g if it were m/s2 or 0.00204 g if it were mm/s2 or 2 g if it were g/10"
    )
    assert other_readings(1e9) == "1.02e+05 g if it were mm/s2, no ordinary acceleration either"
    assert other_readings(1e-4, "g") == "1.02e-05 g if it were m/s2, no ordinary acceleration either"


@pytest.mark.parametrize(("share", "ordinary"), [(0.0009, False), (0.001, True), (3.0, True), (3.5, False)])
def test_an_ordinary_acceleration_is_from_a_thousandth_of_gravity_to_three_times_it(share, ordinary):
    assert other_readings(share * UNITS["g"]).startswith(f"{share:g} g if it were m/s2") is ordinary


@pytest.mark.parametrize(
    ("text", "quantity"),
    [
        ("cm/s2", "acceleration"),
        ("Gal", "acceleration"),
        ("mg", "acceleration"),
        ("cm/sec", "velocity"),
        ("kine", "velocity"),
        ("mm", "displacement"),
        ("msec", "time"),
        ("Hz", "frequency"),
        ("NS", ""),
        ("", ""),
    ],
)
def test_what_a_unit_measures(text, quantity):
    assert quantity_of(text) == quantity


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("acc_cm_s2", [("acceleration", "cm/s2")]),
        ("acc_cm_per_s2", [("acceleration", "cm/s2")]),
        ("a in mps2", [("acceleration", "m/s2")]),
        ("acceleration m s-2", [("acceleration", "m/s2")]),
        ("m·s⁻²", [("acceleration", "m/s2")]),
        ("UNIT = gal(cm/s/s)", [("acceleration", "gal"), ("acceleration", "cm/s2")]),
        ("cm/sec squared, cm/sec", [("acceleration", "cm/s2"), ("velocity", "")]),
        ("time_in_s, 5 m south, comms", []),
    ],
)
def test_units_in_running_text(text, units):
    found = [
        (quantity, canonical_unit(wording, "a:1") if quantity == "acceleration" else "")
        for quantity, wording, _ in mentioned_units(text)
    ]
    assert found == units


def test_units_in_running_text_as_they_are_written_and_where():
    assert list(mentioned_units("Acc. (Gal), vel_cm_s")) == [("acceleration", "Gal", 6), ("velocity", "cm_s", 16)]
    assert list(mentioned_units("Größe in M·s⁻²")) == [("acceleration", "m·s-2", 9)]
