"""Remarks on a calibrated sequence: each is made from its own limit on, and not before."""

from types import SimpleNamespace

import numpy as np
import pytest

from rockpulse.calibration.response_remarks import remarks

SPACE = SimpleNamespace(low=np.array([0.1, 0.0, -3.0, 1.0]), high=np.array([1.0, 1.0, 0.0, 20.0]), spacing="end")
ENDS = dict.fromkeys(("ratio", "interval", "main_count"), (False, False))
NOTHING = np.zeros(10, dtype=bool)
TARGETS = SimpleNamespace(number=~NOTHING, small=NOTHING, overturned=NOTHING, silent=NOTHING, smallest=0.01)


def said(ends=ENDS, **known):
    usual = {"flat": (), "correlations": {}, "spread": 0.1, "independent_share": 1.0, "effective_samples": 500.0}
    calibration = SimpleNamespace(targets=TARGETS, neighbour_correlation=0.4, **(usual | known))
    return remarks(calibration, SPACE, ends)[1:]


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
