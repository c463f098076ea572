"""Words in the prose above plain columns: the motions, units, intervals and counts that they state."""

from __future__ import annotations

import math

import pytest

from rockpulse.readers.kit.headings import kinds_of, stated_counts, stated_kinds, stated_steps, stated_units


@pytest.mark.parametrize(
    ("line", "kinds", "units", "steps", "counts"),
    [
        ("# velocity (cm/s)", ["velocity"], [], [], []),
        ("accelerogram of the main shock, spectrally matched", [], [], [], []),
        ("shear wave velocity 360 m/s", [], [], [], []),
        ("Acceleration in g, dt = 0.02, N = 400", ["acceleration"], ["g"], [0.02], [400]),
        ("Beschleunigung in mm/s², 100 Hz", ["acceleration"], ["mm/s2"], [0.01], []),
        *[(f"dt = 5 {unit}", [], [], [0.005], []) for unit in ("ms", "msec", "millisec", "milliseconds")],
        ("dt = 500 us", [], [], [5e-4], []),
        *[(f"dt = 2 {unit}", [], [], [120.0], []) for unit in ("min", "minutes")],
        ("500 Hz filter, 2000 samples per second", [], [], [], []),
        ("with 2 numbers", [], [], [], []),
        ("response spectrum", ["spectrum"], [], [], []),
        ("target spectrum", [], [], [], []),
        ("time of the velocity", ["velocity"], [], [], []),
        ("dt (ms) = 3/4", [], [], [7.5e-4], []),
        ("dt = 2.5e-2 s", [], [], [0.025], []),
        ("dt = 0,25e+1", [], [], [2.5], []),
        ("sampling rate: 0", [], [], [math.inf], []),
        ("sampling rate 250, dt = 0.02, 500 hz", [], [], [0.02, 0.004], []),
        ("300 points and 40 values", [], [], [], [300, 40]),
    ],
)
def test_words_of_a_header(line, kinds, units, steps, counts):
    assert list(stated_kinds([line])) == kinds
    assert sorted({unit.wording for unit in stated_units([line])}) == units
    assert [step.value for step in stated_steps([line])] == pytest.approx(steps)
    assert [count.value for count in stated_counts([line])] == counts


def test_statements_tell_their_lines_and_words():
    header = ["Station", "Acceleration", "Velocity [cm/s]", "acceleration [Gal]", "sampling rate = 50", "NPTS = 7"]
    assert stated_kinds(header) == {"acceleration": 2, "velocity": 3}
    assert {(one.line, one.wording, one.value) for one in stated_units(header)} == {(4, "Gal", 0.0)}
    assert [(one.line, one.wording, one.value) for one in stated_steps(header)] == [(5, "sampling rate = 50", 0.02)]
    assert [(one.line, one.wording, one.value) for one in stated_counts(header)] == [(6, "npts = 7", 7.0)]
    (bare,) = stated_steps(["x", "recorded with 40 hz"])
    assert (bare.line, bare.wording, bare.value) == (2, "40 hz", 0.025)
    (named,) = stated_steps(["resampled to dt = 0.5", "dt = 0.25"])
    assert (named.line, named.wording, named.value) == (2, "dt = 0.25", 0.25)


@pytest.mark.parametrize(
    ("line", "quantities"),
    [
        *[
            (line, ["acceleration"])
            for line in ("in g", "units: (g)", "unit = g(980)", "# g", "[g]", "values of 3 as gal")
        ],
        *[(line, ["velocity"]) for line in ("in kine", "cm/s", "[m/s]")],
        *[(line, ["displacement"]) for line in ("# cm", "units: cm")],
        *[(line, []) for line in ("in cm", "[cm]", "units: s", "# ms", "peak [g]", "converted, in g")],
        *[(line, []) for line in ("trigger=3 gal", "trigger 3(gal", "٣gal")],
    ],
)
def test_units_of_prose(line, quantities):
    assert list(stated_kinds([line])) == quantities
    assert bool(stated_units([line])) == ("acceleration" in quantities)


def test_kinds_of_motion_come_before_acceleration_and_time():
    assert kinds_of("Time, Acc, PSA, Disp, VEL") == ["velocity", "displacement", "spectrum", "acceleration", "time"]
    assert kinds_of("Acceleration, target spectrum") == ["acceleration"]
    assert kinds_of("Ivme, Hız") == ["velocity", "acceleration"]


@pytest.mark.parametrize(("length", "counts"), [(1000, [12.0]), (1001, [])])
def test_a_line_is_looked_at_up_to_its_thousandth_letter(length, counts):
    words = " 12 points"
    assert [one.value for one in stated_counts(["x" * (length - len(words)) + words])] == counts
