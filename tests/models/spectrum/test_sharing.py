"""Which bodies share a spectrum, and what it covers."""

import numpy as np
import pytest

from rocking import Block, Uncertainty
from rocking.body.limits import RATES
from rocking.spectrum.sharing import shared_groups


@pytest.mark.parametrize("place", [0.0, 0.4, 1.0])
def test_the_frequency_parameters_shared_by_many_bodies_enclose_each_of_them(place):
    lowest = RATES[0] + place * (0.98 * RATES[-1] - RATES[0])
    p = np.linspace(lowest, lowest + 0.02 * RATES[-1], 200)
    blocks = Block.from_parameters(p=p, alpha=0.1, restitution=0.9, log=False)
    ((inside, arguments),) = shared_groups(blocks, Uncertainty(), own=1000, density=4000.0)
    assert inside.tolist() == list(range(200))
    shared = arguments["p"]
    assert shared[0] <= p[0] * (1.0 + 1e-9)
    assert shared[-1] >= p[-1] * (1.0 - 1e-9)
    assert np.sum((shared > p[0]) & (shared < p[-1])) >= shared.size - 2
    assert list(shared_groups(blocks.take(np.arange(60)), Uncertainty(), own=1000, density=4000.0)) == []


def test_bodies_share_a_spectrum_over_the_restitutions_that_they_have():
    """A low restitution, and a wall, make spectra of their own; each has as many samples per unit of C."""
    lossy, free = np.repeat([0.8, 0.92], 100), Uncertainty()
    blocks = Block.from_parameters(p=2.0, alpha=0.1, restitution=lossy, log=False)
    groups = list(shared_groups(blocks, free, own=2000, density=4000.0))
    assert [(inside.tolist(), one["between"], one["second"], one["side"]) for inside, one in groups] == [
        (list(range(100, 200)), (0.84, 1.0), 740, 0),
        (list(range(100)), (0.7125, 1.0), 1250, 0),
    ]
    beside = Block.from_parameters(
        p=np.full(100, 2.0), alpha=0.1, restitution="housner", one_sided=True, rebound=0.4, log=False
    )
    ((inside, arguments),) = shared_groups(beside, free, own=2000, density=4000.0)
    assert inside.size == 100
    assert (arguments["side"], arguments["between"], arguments["second"]) == (1, (0.25, 0.55), 1200)
    limits = [groups[0][1]["needed"], groups[1][1]["needed"], arguments["needed"]]
    assert np.array(limits) == pytest.approx(np.array([[0.92], [0.8], [0.4]]) * [[0.95, 1.05]])
