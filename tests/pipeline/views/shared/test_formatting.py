"""Numbers and paragraphs for the terminal."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.views.shared.formatting import (
    WIDTH,
    between,
    lower_bound,
    paragraph,
    ratio,
    several,
    shortened,
    three_digits,
)


def test_a_ratio_has_two_or_three_digits_and_what_is_absent_is_a_dash():
    values = (0.0, 9.99e-4, 0.0999, 0.1, 9.99, 10.04, -0.5, math.inf)
    assert list(map(ratio, values)) == ["0", "<0.001", "0.100", "0.10", "9.99", "10.0", "-0.50", "inf"]
    assert ratio(math.nan) == three_digits(math.nan, "m/s") == between(math.nan, math.nan) == "-"


def test_intervals_and_counts_are_words():
    assert [between(*ends) for ends in ((0.5, 1.5), (0.5, math.inf))] == ["0.5 to 1.5", "0.5 to no limit"]
    assert several(0, "pair of channels") == "0 pairs of channels"
    assert (several(1, "body"), several(2, "body")) == ("1 body", "2 bodies")


@pytest.mark.sweep
@settings(derandomize=True, deadline=None, max_examples=200)
@given(value=st.floats(0.0, 30.0))
def test_a_lower_bound_is_never_above_the_value_and_an_estimate_has_one_digit(value):
    shown = lower_bound(value)
    assert shown[0] == ">"
    step = 0.001 if value < 0.1 else 0.01 if value < 10.0 else 0.1
    assert value - 1.001 * step <= float(shown[1:]) <= value


@settings(derandomize=True, deadline=None, max_examples=50)
@given(value=st.floats(allow_nan=True, allow_infinity=True))
def test_no_number_is_shown_as_nan(value):
    assert "nan" not in ratio(value) + three_digits(value, "m")


@pytest.mark.sweep
@settings(derandomize=True, deadline=None, max_examples=50)
@given(words=st.text(max_size=60), width=st.integers(5, 40))
def test_a_shortened_text_fits_and_keeps_both_ends(words, width):
    short = shortened(words, width)
    words = " ".join(words.splitlines())
    assert len(short) <= width
    assert short[0:1] == words[0:1]
    assert short[-1:] == words[-1:]
    assert short == words or "…" in short


def test_a_paragraph_fits_and_breaks_no_path():
    path = "/a/rather-long/path/" + "x" * WIDTH
    lines = paragraph(f"{'word ' * 60}{path}", "    ", "  ").splitlines()
    assert lines[0].startswith("  word")
    assert lines[1].startswith("    word")
    assert all(len(line) <= WIDTH for line in lines[:-1])
    assert lines[-1].strip() == path
