"""The interval of a probability where all lanes that tell of it agree: against the binomial, in closed form."""

import numpy as np
import pytest
from scipy.special import ndtr

from rocking.lane_factors import lane_factors
from rocking.lane_march import BodyLanes
from rocking.uncertainty import Uncertainty

#: Shift of ln f with a standard deviation of 0.1.
NORMAL = Uncertainty(factor=0.1, geometry=0.0)


@pytest.mark.parametrize("over", [False, True])
def test_lanes_that_agree_leave_a_twentieth_to_the_other_answer(over):
    """n like answers have 0.05^(1/n) as the lower end of their share, and n is the effective number of lanes.

    The lanes lie between -1 and 1 standard deviations: what is above them overturns, what is below them stands.
    """
    logs = np.linspace(-0.1, 0.1, 41)
    every = np.full(41, over)
    lanes = BodyLanes(logs, np.full(41, 0.005), every, np.zeros(41, dtype=bool), -0.1, 0.1, open=False)
    found = lane_factors(lanes, NORMAL, 0.6, 10.0).found
    above, inside = ndtr(-1.0), ndtr(1.0) - ndtr(-1.0)
    bells = np.exp(-0.5 * (logs / 0.1) ** 2)
    sure = 0.05 ** (np.sum(bells**2) / np.sum(bells) ** 2)
    if over:
        expected = (above + inside * sure, above + inside, above + inside)
    else:
        expected = (above, above, above + inside * (1.0 - sure))
    assert [found[f"at_one{end}"] for end in ("_low", "", "_high")] == pytest.approx(expected, abs=1e-9)
