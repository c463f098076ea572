"""The overview of both figures of the study as text."""

import numpy as np
import pytest

from rockpulse.study import figure4, figure5
from rockpulse.views.text.study import study_overview


@pytest.fixture(scope="module")
def four():
    return figure4([0.9, 0.6], [0.1, 0.3], [0.0, 0.5, 1.0], [2, np.inf], threads=1)


@pytest.fixture(scope="module")
def five():
    return figure5(secondary_ratios=[0.0, 0.3, 0.7], intervals=[0.3, 0.5], step=0.5, threads=1)


def test_the_overview_of_figure_4_shows_peaks_and_half_cycles(four):
    text = study_overview(four)
    # C = 0.9, u_1 = 0.3: overturns in half-cycle 4 (VALIDATION V6); C = 0.6: within reach of x* = 0.338562 (V7).
    assert "(4)" in text
    assert "0.34" in text
    assert "n -> infinity" in text
    assert "peak_falls_with_secondary_impulses" in text
    assert max(map(len, text.splitlines())) < 130


def test_the_overview_shows_the_largest_n_where_there_is_no_limit():
    assert "n = 6, end" in study_overview(figure4([0.9], [0.2], [0.3], [2, 6], threads=1))


def test_the_overview_of_figure_5_shows_blocks_half_cycles_and_ranges(five):
    text = study_overview(five)
    assert "block B: R = 4 m" in text
    assert "(2) 0.61 s" in text
    assert "FAILS: slender_block_has_shorter_half_cycles" in text
    assert "dT 0.5 s" in text
    assert "!" in text
