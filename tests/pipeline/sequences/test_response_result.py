"""Remarks on a calibrated sequence: each is made from its own limit on, and not before."""

from types import SimpleNamespace

import numpy as np
import pytest

from rockpulse.sequences.response_result import remarks

LOW, HIGH = np.array([0.1, 0.0, -3.0, 1.0]), np.array([1.0, 1.0, 0.0, 20.0])
SPACE = SimpleNamespace(low=LOW, high=HIGH, spacing="end")
ENDS = dict.fromkeys(("ratio", "interval", "main_count"), (False, False))
NOTHING = np.zeros(10, dtype=bool)
TARGETS = SimpleNamespace(number=~NOTHING, small=NOTHING, overturned=NOTHING, silent=NOTHING, smallest=0.01)


def said(ends=ENDS, space=SPACE, **known):
    usual = {"flat": (), "correlations": {}, "spread": 0.1, "independent_share": 1.0, "effective_samples": 500.0}
    calibration = SimpleNamespace(targets=TARGETS, neighbour_correlation=0.4, **(usual | known))
    return remarks(calibration, space, ends)[1:]


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({}, None),
        ({"spread": 0.3}, None),
        ({"spread": 0.31}, "to a factor of 1.4 either way"),
        ({"independent_share": 0.4}, "the 10 numbers count as 4 independent ones"),
        ({"effective_samples": 100.0}, None),
        ({"effective_samples": 99.0}, "the intervals rest on 99 effective samples"),
        ({"correlations": {("main", "ratio"): 0.89}}, None),
        ({"correlations": {("main", "ratio"): -0.9}}, "main and ratio are not told apart (correlation -0.90)"),
    ],
    ids=str,
)
def test_a_remark_is_made_where_there_is_reason_for_it(known, words):
    found = said(**known)
    assert len(found) == (words is not None)
    assert words is None or words in found[0]


def test_limits_that_fit_as_well_are_named():
    ends = ENDS | {"ratio": (True, True), "main_count": (True, False), "interval": (True, False)}
    assert said(ends) == (
        "ratio: both 0 and 1, the limits of the search, fit about as well as the best",
        "interval: no lower limit of the interval dT of the secondary impulses down to 0.0498 s, the end of the search",
    )
    ends = ENDS | {"ratio": (False, True), "main_count": (False, True), "interval": (True, True)}
    assert said(ends, flat=("interval",)) == (
        "ratio: no upper limit of the I_s/I up to 1, the end of the search",
        "interval: the data do not tell the interval dT of the secondary impulses; all of 0.0498 s to 1 s fit about as "
        "well",
        "main_count: no upper limit of the number of main impulses up to 20, the end of the search",
    )
    assert said(ENDS | {"main_count": (True, True)}) == (
        "main_count: both 1 and 20, the limits of the search, fit about as well as the best",
    )


def test_a_continuous_spacing_has_no_interval_to_speak_of():
    ends = dict.fromkeys(ENDS, (True, True))
    assert said(ends, SimpleNamespace(low=LOW, high=HIGH, spacing="continuous")) == (
        "interval: the limit of infinitely many secondary impulses has none",
        "ratio: both 0 and 1, the limits of the search, fit about as well as the best",
        "main_count: both 1 and 20, the limits of the search, fit about as well as the best",
    )


def test_the_targets_are_counted_by_their_kinds():
    places = np.arange(10)
    targets = SimpleNamespace(
        number=places < 4, overturned=places == 4, small=places > 7, silent=(places > 4) & (places < 8), smallest=0.05
    )
    calibration = SimpleNamespace(
        targets=targets, flat=(), correlations={}, spread=0.1, independent_share=1.0, effective_samples=500.0
    )
    assert remarks(calibration, SPACE, ENDS) == (
        "4 peaks are numbers, 1 blocks overturn (at least 1), 2 stay below 0.05, 3 say nothing (at rest or unresolved)",
    )
