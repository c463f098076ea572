"""The critical double impulse against the published values and the equation of motion itself."""

import math

import pytest
from scipy.integrate import solve_ivp

from rockpulse.models import Block
from rockpulse.studies.paper.double_impulse import critical_double_impulse
from rockpulse.studies.paper.paper_blocks import paper_block


# VALIDATION V4 (Nabeshima et al. 2016, published formulas; doi:10.3389/fbuil.2016.00009).
@pytest.mark.parametrize(("name", "impulse", "interval"), [("A", 0.698343, 0.611518), ("B", 0.461962, 0.823083)])
def test_published_values(name, impulse, interval):
    assert critical_double_impulse(paper_block(name, "housner")) == pytest.approx((impulse, interval), abs=2e-6)


def test_it_grows_with_the_square_root_of_the_size():
    small = critical_double_impulse(Block(half_width=0.1, half_height=0.6))
    large = critical_double_impulse(Block(half_width=0.4, half_height=2.4))
    assert large == pytest.approx((2.0 * small[0], 2.0 * small[1]), rel=1e-12)


def test_it_is_what_the_equation_of_motion_gives():
    """The first half-cycle integrated step by step lasts t_0, and the second impulse leads just to the top."""
    block = paper_block("B", 0.7)
    impulse, interval = critical_double_impulse(block)
    p, alpha, g = block.p, block.alpha_c, block.gravity

    def motion(_, y):
        return y[1], -p * p * math.sin(alpha - y[0])

    def ground(time, y):
        return y[0] if time > 0.0 else 1.0

    ground.terminal, ground.direction = True, -1.0
    rate = p * p * math.cos(alpha) / g * impulse
    first = solve_ivp(motion, (0.0, 10.0), (0.0, rate), events=ground, rtol=1e-12, atol=1e-14, method="DOP853")
    assert first.t_events[0][0] == pytest.approx(interval, rel=1e-9)
    after = rate - block.restitution * first.y_events[0][0][1]
    assert 0.5 * after**2 == pytest.approx(p * p * (1.0 - math.cos(alpha)), rel=1e-9)
