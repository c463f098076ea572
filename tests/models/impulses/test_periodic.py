"""The periodic motion to which an endless sequence tends (Eq. 10, F4, V7, V10)."""

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.impulses.sequence import ImpulseSequence, sequence_response, steady_state


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


def test_two_sequences_on_two_blocks_have_the_closed_form_of_each_pair():
    """u* = u_1 (1 - C s)/(1 - C), v* = u* - u_1 s/2, x* = 1 - sqrt(1 - v*^2), 2 atanh(v*)/p."""
    bodies = Block([0.5, 0.4], [2.0, 3.0], restitution=[0.6, 0.7], gravity=9.81)
    main, secondary = np.array([0.2, 0.35]), np.array([0.05, 0.2])
    steady = steady_state(bodies, ImpulseSequence(main, secondary, np.nan, np.inf, spacing="continuous"))
    for q, m in np.ndindex(2, 2):
        c, p, u1 = bodies.restitution[m], bodies.p[m], main[q] / bodies.critical_impulse[m]
        s = secondary[q] / main[q]
        start = u1 * (1.0 - c * s) / (1.0 - c)
        effective = start - u1 * s / 2.0
        assert effective < 1.0
        expected = (start, effective, 1.0 - np.sqrt(1.0 - effective**2), 2.0 * np.arctanh(effective) / p)
        names = ("start_velocity", "effective_velocity", "peak", "half_period")
        assert [getattr(steady, name)[q, m] for name in names] == pytest.approx(expected, rel=1e-9)
    assert steady.stable.all()


def test_a_spacing_does_not_matter_without_secondary_impulses():
    body, impulse = block(0.6), 0.3 * block(0.6).critical_impulse
    for spacing in ("end", "continuous"):
        series = ImpulseSequence(impulse, 0.0, 0.1, np.inf, spacing=spacing)
        assert steady_state(body, series).start_velocity == pytest.approx(0.75)
    with pytest.raises(ValueError, match="spacing"):
        steady_state(body, ImpulseSequence([impulse, impulse], [0.0, 1e-9], 0.1, np.inf))


def test_without_losses_a_motion_without_gain_keeps_its_velocity_lane_by_lane():
    bodies = Block.from_parameters(2.0, 0.2, [1.0, 0.6, 1.0], log=False)
    impulse = 0.4 * bodies.critical_impulse[0]
    steady = steady_state(bodies, ImpulseSequence(impulse, impulse, np.nan, np.inf, spacing="continuous"))
    assert steady.start_velocity == pytest.approx([0.4, 0.4, 0.4])
    assert steady.effective_velocity == pytest.approx([0.2, 0.2, 0.2])
    grows = steady_state(bodies, ImpulseSequence(impulse, 0.5 * impulse, np.nan, np.inf, spacing="continuous"))
    assert grows.start_velocity == pytest.approx([np.inf, 0.7, np.inf])
