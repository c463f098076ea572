"""A body and its pedestal as one, and the motion of floors against closed forms and a slow integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import floor_motion
from rocking.body.block import Block
from rocking.body.supports import with_pedestal


def test_two_parts_of_one_rectangle_are_that_rectangle():
    whole = Block(width=0.6, height=3.0, mass=900.0)
    top = Block(width=0.6, height=1.2, mass=360.0)
    found = with_pedestal(top, 0.6, 1.8, 540.0)
    for name in ("p", "p_2", "alpha_c", "alpha_2", "radius", "restitution", "mass"):
        assert float(getattr(found, name)) == pytest.approx(float(getattr(whole, name)), rel=1e-12), name


def test_several_pedestals_are_put_together_in_any_grouping():
    statue = Block.from_corners(0.2, 0.25, 0.9, 0.5, mass=600.0)
    one = with_pedestal(with_pedestal(statue, 0.7, 0.5, 700.0), 0.7, 0.4, 560.0)
    both = with_pedestal(statue, 0.7, 0.9, 1260.0)
    for name in ("p", "p_2", "alpha_c", "alpha_2", "restitution", "restitution_2"):
        assert float(getattr(one, name)) == pytest.approx(float(getattr(both, name)), rel=1e-12), name
    # Its centre of mass lies towards the corner nearer to it, and so does that of the whole.
    assert one.alpha_c < one.alpha_2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"block": Block(width=0.5, height=1.8)}, "expected a block with a mass"),
        ({"block": Block(width=0.5, height=1.8, mass=1.0, one_sided=True)}, "expected a free-standing block"),
        ({"width": 0.4}, "at least the width of the block on it, 0.5 m, got 0.4"),
    ],
)
def test_what_cannot_stand_is_refused(change, message):
    given = {"block": Block(width=0.5, height=1.8, mass=600.0), "width": 0.9, "height": 1.2, "mass": 2300.0} | change
    with pytest.raises(ValueError, match=message):
        with_pedestal(**given)


def test_a_body_without_symmetry_stands_with_the_middle_of_its_base_on_that_of_the_pedestal():
    """Steiner about the corners of the whole, both of them; at another gravity and with a restitution of its own."""
    statue = Block.from_corners(0.2, 0.3, 1.0, 0.6, gravity=9.0, mass=600.0)
    found = with_pedestal(statue.lanes(1), 0.9, 1.2, 2300.0, restitution=0.8)
    # The centre of the statue is 0.05 to the right of the middle of its base, and of that of the pedestal.
    x, z = 600.0 * 0.05 / 2900.0, (600.0 * 2.2 + 2300.0 * 0.6) / 2900.0
    for corner, alpha, p in ((0.45, found.alpha_c, found.p), (-0.45, found.alpha_2, found.p_2)):
        inertia = 600.0 * (0.6**2 + (0.05 - corner) ** 2 + 2.2**2)
        inertia += 2300.0 * ((0.9**2 + 1.2**2) / 12.0 + corner**2 + 0.6**2)
        radius = np.hypot(corner - x, z)
        assert float(alpha) == pytest.approx(np.arctan(abs(corner - x) / z), rel=1e-12)
        assert float(p) == pytest.approx(np.sqrt(2900.0 * 9.0 * radius / inertia), rel=1e-12)
    assert (float(found.mass), found.gravity) == (2900.0, 9.0)
    assert float(found.restitution) == float(found.restitution_2) == 0.8


@pytest.mark.parametrize("name", ["width", "height", "mass"])
def test_sizes_and_mass_of_a_pedestal_are_above_zero(name):
    given = {"width": 0.9, "height": 1.2, "mass": 2300.0}
    for value in (0.0, -1.0, np.nan, [1.0]):
        with pytest.raises(ValueError, match=f"pedestal {name}"):
            with_pedestal(Block(width=0.5, height=1.8, mass=600.0), **given | {name: value})
    assert (
        with_pedestal(Block(width=1e-3, height=1e-2, mass=1e-3, log=False), **given | {name: 0.1}, restitution=0.8).mass
        > 0.0
    )


def test_two_bodies_on_one_pedestal_are_refused():
    with pytest.raises(ValueError, match="2"):
        with_pedestal(Block(width=[0.5, 0.6], height=1.8, mass=600.0), 0.9, 1.2, 2300.0)


def test_of_the_whole_nothing_is_logged(caplog):
    """It is wider than high, of which its warnings tell."""
    statue = Block(width=0.5, height=1.8, mass=600.0)
    caplog.clear()
    whole = with_pedestal(statue, 3.9, 0.2, 9000.0, restitution=0.5)
    assert whole.warnings
    assert not caplog.records


def test_a_stiff_building_moves_with_the_ground():
    ground = np.sin(2.0 * np.pi * np.arange(0.0, 5.0, 0.01))
    found = floor_motion(ground, 0.01, period=0.01)
    assert found.dt == pytest.approx(0.00025)
    assert found.acceleration[:: round(0.01 / found.dt)][: ground.size] == pytest.approx(ground, abs=0.02)


def test_resonance_builds_up_to_half_the_inverse_of_damping():
    t = np.arange(0.0, 60.0, 0.01)
    found = floor_motion(np.sin(2.0 * np.pi * t / 0.5), 0.01, period=0.5, damping=0.05)
    assert found.amplification == pytest.approx(np.hypot(1.0, 2 * 0.05) / (2 * 0.05), rel=5e-3)


@pytest.mark.sweep
def test_modes_act_in_parallel_as_integrated():
    rng = np.random.default_rng(1)
    ground, dt = np.append(0.0, rng.normal(size=39)), 0.02
    periods, dampings, shares = (0.6, 0.2), (0.05, 0.03), (1.3, -0.4)
    found = floor_motion(ground, dt, periods, dampings, shares)
    times = found.dt * np.arange(round(39 * dt / found.dt) + 1)
    expected = np.interp(times, dt * np.arange(40), ground)
    for period, ratio, share in zip(periods, dampings, shares, strict=True):
        rate = 2.0 * np.pi / period

        def pull(t, y, rate=rate, ratio=ratio):
            a = np.interp(t, dt * np.arange(40), ground)
            return y[1], -a - 2.0 * ratio * rate * y[1] - rate**2 * y[0]

        run = solve_ivp(pull, (0.0, times[-1]), (0.0, 0.0), "DOP853", t_eval=times, max_step=dt, rtol=1e-10, atol=1e-12)
        expected += share * np.array([pull(t, y)[1] for t, y in zip(times, run.y.T, strict=True)])
    assert found.acceleration[: times.size] == pytest.approx(expected, abs=1e-6 * np.max(np.abs(expected)))


def test_a_mode_that_takes_no_part_leaves_the_motion_of_the_ground():
    """From the first sample to the last one, with as many between two as the period asks for."""
    for period, parts in ((0.4, 1), (0.2, 2)):
        found = floor_motion(np.ones(10), 0.01, period=period, participation=0.0)
        assert found.dt == pytest.approx(0.01 / parts)
        assert found.acceleration.tolist() == [1.0] * (9 * parts + 1)
        assert found.amplification == 1.0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"period": 0.0}, "period"),
        ({"period": 0.4, "damping": 0.0}, "above 0 and below 1"),
        ({"period": 0.4, "damping": [0.05, 1.0]}, "above 0 and below 1"),
        ({"period": 0.4, "quiet": [1e-3]}, "quiet"),
        ({"period": [0.4, 0.2], "damping": [0.05, 0.05, 0.05]}, "arrays of one length"),
        ({"period": 0.4, "quiet": 0.0}, "quiet"),
    ],
)
def test_wrong_modes_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        floor_motion(np.ones(10), 0.01, **given)


def test_the_floor_rings_on_as_if_the_record_went_on_with_zeros_and_ends_where_it_is_quiet():
    ground = np.append(np.random.default_rng(3).normal(size=200), 0.0)
    modes = [0.35, 0.8], [0.05, 0.11], [-0.7, 1.9]
    for quiet in (1e-3, 0.3):
        found = floor_motion(ground, 0.01, *modes, quiet=quiet)
        longer = floor_motion(np.append(ground, np.zeros(3000)), 0.01, *modes, quiet=quiet)
        assert found.dt == longer.dt == 0.005
        size = found.acceleration.size
        assert found.acceleration == pytest.approx(longer.acceleration[:size], abs=1e-12)
        assert np.max(np.abs(longer.acceleration[size:])) <= quiet
        assert abs(found.acceleration[-2]) > quiet >= abs(found.acceleration[-1])
        assert found.amplification == np.max(np.abs(found.acceleration)) / np.max(np.abs(ground))


def test_a_floor_without_damping_to_speak_of_is_followed_for_a_thousand_periods():
    pulse = np.array([0.0, 1.0, 0.0])
    for periods, last in ((0.04, 40.0), ([0.04, 0.05], 50.0)):
        found = floor_motion(pulse, 0.001, periods, damping=1e-7)
        assert found.acceleration.size == 3 + round(last / 0.001)


def test_a_quiet_or_silent_record_is_as_long_as_it_is():
    silent = floor_motion(np.zeros(10), 0.01, 0.4)
    assert (silent.acceleration.tolist(), silent.amplification) == ([0.0] * 10, 1.0)
    quiet = floor_motion(np.full(10, 1e-5), 0.01, 0.4)
    assert quiet.acceleration.size == 10
    assert quiet.acceleration[0] != 0.0
    loud = floor_motion(np.full(3, -1.0), 0.01, 0.4, participation=-2.0)
    assert loud.amplification == np.max(np.abs(loud.acceleration))
