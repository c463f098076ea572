"""The worse screen of a body on a pedestal, and bodies that would slide, from answers that are given."""

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, probable

from rockpulse.assessment.verdict import Sliding, sliding, verdicts, worse_screens

NAN = np.nan
NAMES = ["chest", "statue", "statue with pedestal", "lone with pedestal"]


def bodies(**variables):
    """Four bodies under two records, which overturn them with 0.1, 0.3, 0.2 and 0.9."""
    each = [
        probable([share] * 2).assign_coords(block=[name])
        for name, share in zip(NAMES, (0.1, 0.3, 0.2, 0.9), strict=True)
    ]
    return xr.concat(each, "block", data_vars="minimal", coords="minimal").assign(variables)


@pytest.mark.parametrize(("shares", "worse"), [([0.3, 0.2], 1), ([0.3, 0.4], 2), ([0.01, 0.04], 2), ([0.9, 0.3], 1)])
def test_the_worse_of_both_screens_counts(shares, worse):
    summary = bodies(pedestal_of=("block", ["", "", "statue", "lone"]))
    summary["overturning_probability"][:, 1:3] = shares
    found = answers(summary)
    every = verdicts(found)
    # Of the last one there is the screen with its pedestal alone.
    assert list(worse_screens(found, every)) == [("statue", every[worse])]


def test_without_pedestals_there_are_no_screens():
    found = answers(bodies())
    assert list(worse_screens(found, verdicts(found))) == []


def test_a_body_slides_under_the_records_that_ask_for_more_friction_than_it_has():
    required = [[0.2, 0.5, NAN, 0.4], [0.4, 0.4, NAN, 0.3]]
    found = answers(bodies(friction=("block", [0.3, 0.5, NAN, 0.2]), friction_required=(("record", "block"), required)))
    first, _, _, last = found.bodies
    assert list(sliding(found)) == [Sliding(first, 1, 2, 0.4, 0.3), Sliding(last, 2, 2, 0.4, 0.2)]
    assert list(sliding(answers(bodies()))) == []
