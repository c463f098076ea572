"""The periodic motion to which an endless sequence tends (Eq. 10, F4, V7, V10)."""

import numpy as np
import pytest

from rocking.block import Block
from rocking.periodic import steady_state
from rocking.sequence import ImpulseSequence, sequence_response


def block(restitution):
    return Block(0.5, np.sqrt(3.75), restitution=restitution, gravity=9.81)


def continuous(body, main, ratio):
    impulse = np.asarray(main) * body.critical_impulse
    return ImpulseSequence(impulse, ratio * impulse, np.nan, np.inf, spacing="continuous")


@pytest.mark.parametrize(
    ("main", "ratio", "effective", "peak", "half_period"),
    [
        (0.3, 0.0, 0.75, 0.338562, 1.945910),  # V7 (D)
        (0.625, 0.5, 0.9375, 0.652015, 3.433987),  # V10 (D), I = I_2c
        (0.625, 0.7, 0.6875, 0.273816, 1.686399),
    ],
)
def test_steady_state_of_v7_and_v10(main, ratio, effective, peak, half_period):
    body = block(0.6)
    steady = steady_state(body, continuous(body, main, ratio))
    assert steady.stable is True
    assert steady.effective_velocity == pytest.approx(effective, abs=1e-12)
    assert steady.start_velocity == pytest.approx(effective + 0.5 * ratio * main, abs=1e-12)
    assert steady.peak == pytest.approx(peak, abs=5e-7)
    assert steady.half_period * body.p == pytest.approx(half_period, abs=5e-7)


@pytest.mark.parametrize(("main", "ratio"), [(0.3, 0.0), (0.625, 0.5), (0.5, 0.3)])
def test_response_without_end_tends_to_the_steady_state(main, ratio):
    body = block(0.6)
    series = continuous(body, main, ratio)
    steady, response = steady_state(body, series), sequence_response(body, series)
    assert response.half_cycles.start_velocity[-1] == pytest.approx(steady.start_velocity, rel=1e-12)
    assert response.peak_rotation_ratio == pytest.approx(steady.peak, rel=1e-10)
    assert response.half_cycles.duration[-1] == pytest.approx(steady.half_period, rel=1e-10)


def test_motion_that_overturns_has_no_steady_state():
    body = block(0.6)
    steady = steady_state(body, continuous(body, 0.625, 0.4))
    assert steady.stable is False
    assert (steady.peak, steady.half_period) == (np.inf, np.inf)
    assert steady.effective_velocity > 1.0


def test_critical_limit_is_stable_and_never_reached():
    body = block(0.6)
    steady = steady_state(body, continuous(body, 0.4, 0.0))
    assert steady.stable is True
    assert steady.peak == pytest.approx(1.0, abs=1e-6)


def test_without_losses_only_equal_secondary_impulses_are_stable():
    body = block(1.0)
    assert steady_state(body, continuous(body, 0.4, 0.5)).start_velocity == np.inf
    kept = steady_state(body, continuous(body, 0.4, 1.0))
    assert kept.stable is True
    assert kept.start_velocity == pytest.approx(0.4)


def test_lanes_are_every_sequence_on_every_block():
    bodies = Block(0.5, [2.0, 3.0], restitution=[0.6, 0.9], gravity=9.81)
    steady = steady_state(bodies, ImpulseSequence([0.0, 0.1, 0.5], 0.0, 0.1, np.inf))
    assert steady.stable.shape == steady.peak.shape == (3, 2)
    assert steady.stable[0].all()
    assert np.all(steady.peak[0] == 0.0)


def test_other_spacings_are_refused():
    with pytest.raises(ValueError, match="spacing"):
        steady_state(block(0.6), ImpulseSequence(0.3, 0.1, 0.1, 20.0))
