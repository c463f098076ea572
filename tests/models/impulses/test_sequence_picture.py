"""What an impulse sequence shows of itself: its numbers, and where its impulses stand in a half-cycle."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking import ImpulseSequence
from rocking.pictures import BLUE, RED

SVG = "{http://www.w3.org/2000/svg}"


def stems(sequence, colour):
    """Places and sizes of the stems of a colour [px], upwards positive, over all half-cycles."""
    root = ET.fromstring(sequence._repr_html_()).find(f".//{SVG}svg")
    found = []
    for path in root.findall(f"{SVG}path"):
        if path.attrib["stroke"] == colour:
            numbers = re.findall(r"M([\d.]+) ([\d.]+)V([\d.]+)", path.attrib["d"])
            found += [(float(at), float(base) - float(tip)) for at, base, tip in numbers]
    return np.array(found)


def test_a_sequence_is_told_in_a_line():
    told = "<ImpulseSequence I 0.7 m/s, I_s 0.28 m/s, dT 0.1 s, duration 20 s, spacing end>"
    assert repr(ImpulseSequence(0.7, 0.28, 0.1, 20.0)) == told
    several = ImpulseSequence([0.7, 0.8], 0.28, np.nan, np.inf, main_count=4, spacing="continuous")
    told = "of 2 sequences, I 0.7 to 0.8 m/s, I_s 0.28 m/s, duration inf s, main impulses 4, spacing continuous"
    assert repr(several) == f"<ImpulseSequence {told}>"


def test_impulses_alternate_and_sum_to_zero_between_main_ones():
    sequence = ImpulseSequence(0.8, 0.2, 0.1, 20.0, intermediate_count=6)
    main, secondary = stems(sequence, RED), stems(sequence, BLUE)
    assert np.sign(main[:, 1]).tolist() == [1.0, -1.0]
    assert np.sign(secondary[:, 1]).tolist() == [-1.0, 1.0] * 3 + [1.0, -1.0] * 3
    assert np.sum(secondary[:6, 1]) == pytest.approx(0.0, abs=0.7)
    assert secondary[1, 1] / main[0, 1] == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize(
    ("spacing", "first", "last"), [("end", 1.0, 0.0), ("middle", 0.5, 0.5), ("start", 0.0, 1.0), ("open", 1.0, 1.0)]
)
def test_a_spacing_is_drawn_where_the_impulses_act(spacing, first, last):
    sequence = ImpulseSequence(0.8, 0.2, 0.1, 20.0, intermediate_count=4, spacing=spacing)
    main, secondary = stems(sequence, RED), stems(sequence, BLUE)
    interval = secondary[1, 0] - secondary[0, 0]
    assert (secondary[0, 0] - main[0, 0]) / interval == pytest.approx(first, abs=0.02)
    assert (main[1, 0] - secondary[3, 0]) / interval == pytest.approx(last, abs=0.02)


def test_a_sequence_without_secondary_impulses_has_none_drawn():
    assert stems(ImpulseSequence(0.8, 0.0, 0.1, 20.0), BLUE).size == 0
    assert stems(ImpulseSequence(0.0, 0.0, 0.1, 20.0), RED).shape == (2, 2)
