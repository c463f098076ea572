"""The lanes of a spectrum lie where they should and stand for all slender blocks."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rocking import Block, Outcome, OverturningSpectrum, Uncertainty, recorded_response
from rocking.spectrum import slender_ground
from rocking.spectrum.body_probability import lane_capacity
from rocking.spectrum.probability import MOST_RESTITUTION
from rocking.spectrum.slender_lanes import (
    BEYOND,
    FIRST,
    LEAST_RESTITUTION,
    SECOND,
    body_piece_lanes,
    both_stages,
    check_strength,
    piece_lanes,
    spectrum_lanes,
)
from synthetic import synthetic_motion

DT = 0.01
MOTION = synthetic_motion(3, pga=3.0)[:1200]
P = np.array([1.5, 3.0])
C = np.array([0.8, 0.9, 1.0])


@pytest.fixture(scope="module")
def lanes():
    return spectrum_lanes(MOTION, DT, P)


def test_lanes_fill_strength_and_restitution(lanes):
    assert lanes.log_x.shape == (P.size, FIRST + SECOND)
    assert np.all(np.diff(lanes.restitution, axis=1) >= 0.0)
    assert lanes.restitution.min() >= LEAST_RESTITUTION
    assert lanes.restitution.max() <= BEYOND
    assert np.all(lanes.bottom == pytest.approx(np.log(P / np.max(np.abs(MOTION)))))
    inside = (lanes.log_x > lanes.bottom[:, None]) & (lanes.log_x <= lanes.top[:, None])
    assert np.array_equal(lanes.weight > 0.0, inside)
    # The weights sum up to the stretch of ln x that the lanes fill, but for the slanted ends of the second part.
    assert np.sum(lanes.weight, axis=1) == pytest.approx(lanes.top - lanes.bottom, rel=0.1)


def test_nothing_is_lifted_at_the_bottom_and_all_falls_at_the_top(lanes):
    low = lanes.log_x <= lanes.bottom[:, None]
    assert np.all(lanes.peak[low] == 0.0)
    late = lanes.log_x > (lanes.bottom + 0.9 * (lanes.top - lanes.bottom))[:, None]
    assert np.mean(np.isinf(lanes.peak[late])) > 0.99


@pytest.mark.parametrize("slenderness", [3.5, 20.0])
def test_a_block_of_any_slenderness_has_the_same_spectrum(lanes, slenderness):
    """Similarity of slender blocks, against the nonlinear equation: single verdicts differ near an edge."""
    p = np.repeat(P, lanes.log_x.shape[1])
    alpha = math.atan(1.0 / slenderness)
    block = Block.from_parameters(
        p=p, alpha=alpha, restitution=np.minimum(lanes.restitution.ravel(), MOST_RESTITUTION), log=False
    )
    factor = np.exp(lanes.log_x.ravel()) * block.gravity * math.tan(alpha) / p
    nonlinear = recorded_response(block, MOTION, DT, block_scale=factor)
    over = nonlinear.outcome == Outcome.OVERTURNS
    assert np.mean(over != np.isinf(lanes.peak.ravel())) < 0.08
    own = OverturningSpectrum(replace(lanes, peak=nonlinear.peak_rotation_ratio.reshape(lanes.peak.shape)))
    slender = OverturningSpectrum(lanes)
    # Single lanes near an edge: over records the error has a dispersion of 0.03 (docs/decisions/018).
    for rotation in (np.inf, 0.4):
        difference = np.log(own.spectrum(C, rotation) / slender.spectrum(C, rotation))
        assert np.max(np.abs(difference)) < 0.08
        assert abs(np.mean(difference)) < 0.02


def test_the_mirror_image_has_the_same_lanes(lanes):
    mirrored = spectrum_lanes(-MOTION, DT, P)
    assert np.array_equal(mirrored.log_x, lanes.log_x)
    assert np.array_equal(mirrored.peak, lanes.peak)


@pytest.mark.parametrize("side", [0, 1])
def test_a_long_record_is_marched_in_parts(side, monkeypatch):
    whole = spectrum_lanes(MOTION, DT, P, side=side)
    monkeypatch.setattr(slender_ground, "AT_ONCE", 333)
    parts = spectrum_lanes(MOTION, DT, P, side=side)
    assert np.mean(np.isinf(parts.peak) != np.isinf(whole.peak)) < 0.003  # rounding at edges
    both = np.isfinite(parts.peak) & np.isfinite(whole.peak)
    assert np.quantile(np.abs(parts.peak[both] - whole.peak[both]), 0.95) < 1e-9


def test_threads_do_not_matter(lanes):
    assert np.array_equal(spectrum_lanes(MOTION, DT, P, threads=1).peak, lanes.peak)


def test_lanes_end_where_sixteen_times_the_impulse_that_overturns_is_met_if_all_fall_before():
    """A short pulse of the impulse I overturns from x I = 1 on: the lanes end at x = 1/(0.06 I)."""
    pulse = np.append(np.linspace(0.0, 50.0, 3), np.zeros(100))
    impulse = np.trapezoid(pulse, dx=DT)
    found = spectrum_lanes(pulse, DT, [0.5])
    assert found.top[0] == pytest.approx(-math.log(0.06 * impulse), abs=0.02)


def test_survivors_at_the_top_make_the_lanes_reach_further():
    """A pulse after a long weak shaking: the measure of the build-up is far above what overturns the block."""
    many = np.tile([0.5, -0.5], 500)
    found = spectrum_lanes(np.repeat(many, 4), DT, [1.0])
    late = found.log_x[0] > found.top[0] - 0.1 * (found.top[0] - found.bottom[0])
    assert np.all(np.isinf(found.peak[0][late]))


@pytest.mark.parametrize(
    ("acceleration", "p", "told"),
    [(np.zeros(10), [1.0], "zeros"), (MOTION, [2.0, 1.0], "ascending"), (MOTION, [-1.0], "positive")],
)
def test_what_has_no_spectrum(acceleration, p, told):
    with pytest.raises(ValueError, match=told):
        spectrum_lanes(acceleration, DT, p)


@pytest.mark.parametrize(("needed", "highest"), [((0.84, 0.93), 0.93), ((0.9, 1.0), BEYOND)])
def test_the_lanes_of_a_needed_part_are_those_of_the_whole_range(lanes, needed, highest):
    part = spectrum_lanes(MOTION, DT, P, needed=needed)
    assert part.between == needed
    for place in range(P.size):
        inside = (lanes.restitution[place] >= needed[0]) & (lanes.restitution[place] <= highest)
        own = (part.restitution[place] >= needed[0]) & (part.restitution[place] <= highest)
        for name in ("log_x", "restitution", "weight", "peak"):
            assert np.array_equal(getattr(part, name)[place][own], getattr(lanes, name)[place][inside])
        assert np.sum(~own) < FIRST
    with pytest.raises(ValueError, match="needed: expected two ascending restitutions from"):
        spectrum_lanes(MOTION, DT, P, needed=(0.7, 0.9))


@pytest.mark.parametrize("second", [0, 700.0])
def test_the_number_of_lanes_is_a_positive_whole_number(second):
    with pytest.raises(ValueError, match="second: expected"):
        spectrum_lanes(MOTION, DT, P, second=second)


def test_a_march_before_a_wall_ends_where_rounding_alone_lifts_the_block():
    """A half-sine whose last sample, -1e-16, is all that pushes away from the wall: strengths of 1e16 lift there."""
    motion = np.sin(np.pi * np.arange(9) / 8)
    motion[-1] = -abs(motion[-1])
    assert not np.any(np.isinf(spectrum_lanes(motion, 0.02, [1.0, 4.0], side=1).peak))


def test_a_wall_lets_only_the_motions_away_from_it_lift_a_block():
    """A ground that is pushed one way only lifts a block before a wall on the one side of it, and not on the other."""
    push = np.where(np.arange(200) < 100, 3.0, 0.0)
    with pytest.raises(ValueError, match="lift the block away from its wall"):
        spectrum_lanes(push, DT, P, side=1)
    with pytest.raises(ValueError, match="lift the block away from its wall"):
        spectrum_lanes(-push, DT, P, side=-1)
    one, other = spectrum_lanes(-push, DT, P, side=1), spectrum_lanes(push, DT, P, side=-1)
    np.testing.assert_array_equal(one.log_x, other.log_x)
    np.testing.assert_array_equal(one.peak, other.peak)
    assert (one.side, other.side) == (1, -1)
    assert np.any(np.isinf(one.peak))
    assert np.any(np.isfinite(one.peak))


@pytest.mark.parametrize(("side", "least", "most"), [(0, 0.7125, BEYOND), (1, 0.25, 0.55)])
def test_lanes_cover_the_restitutions_of_free_blocks_and_the_rebounds_before_a_wall(side, least, most):
    found = spectrum_lanes(MOTION, DT, P, side=side).restitution
    assert least <= found.min() < least + 0.01
    assert most - 0.01 < found.max() <= most


def evenly(rank):
    """Restitutions from 0.7 to 0.9."""
    return 0.7 + 0.2 * rank


def known_verdicts(log_x, restitution):
    """Overturning above an edge that falls with C, and again in a band below it."""
    along = log_x + 1.1 * (restitution - 0.8)
    return np.where((along > 0.9) | ((along > 0.5) & (along < 0.6)), np.inf, 0.3)


@pytest.mark.parametrize(("low", "high"), [(-0.4, 1.6), (0.1, 1.4)])
def test_sums_over_lanes_by_their_weights_are_integrals_over_strength_and_restitution(low, high):
    """The area of all lanes, and of those that overturn: beyond the edge, and in the band of 0.1 below it."""
    found = both_stages(low, high, known_verdicts, evenly, 700)
    weight, over = found["weight"], np.isinf(found["peak"])
    assert weight.sum() == pytest.approx(high - low, abs=0.006)
    assert weight[over].sum() == pytest.approx(high - 0.9 + 0.1, abs=0.006)
    assert found["peak"].tolist() == known_verdicts(found["log_x"], found["restitution"]).tolist()


@pytest.mark.parametrize(("last", "times"), [(0.92, 1), (0.88, 0), (1.6, 2), (9.0, 6)])
def test_lanes_that_stand_in_the_last_tenth_raise_the_top(last, times):
    """By 0.7 of ln x each time: from 0 to 1, all overturn from `last` on."""
    found = both_stages(0.0, 1.0, lambda log_x, _: np.where(log_x > last, np.inf, 0.5), evenly, 700)
    assert found["top"] == pytest.approx(1.0 + 0.7 * times)
    assert found["weight"][found["log_x"] > 1.0].sum() == pytest.approx(0.7 * times, abs=0.02)


@pytest.mark.sweep
@pytest.mark.parametrize("p", [0.9, 2.5])
def test_one_ulp_on_the_record_moves_the_factors_by_less_than_a_hundredth(p):
    """A block of high C, whose many small hops multiply rounding."""
    body = Block.from_parameters(p=[p], alpha=[0.1], restitution=0.97, log=False)
    ulp = MOTION * (1.0 + np.finfo(float).eps * np.random.default_rng(1).integers(-1, 2, MOTION.size))
    known = Uncertainty()
    one, other = (
        lane_capacity(body_piece_lanes(TIMES, ground, body, known)[0], known, 0.45) for ground in (MOTION, ulp)
    )
    assert other == pytest.approx(one, rel=0.01)


def test_lanes_before_a_wall_reach_at_least_0_7_above_uplift():
    """Thirty times weaker pushes away from it than towards it: what these build up says nothing of the others."""
    ground = np.where(np.arange(400) < 200, 3.0, np.where(np.arange(400) < 380, -0.1, 0.0))
    found = spectrum_lanes(ground, DT, [2.0], side=1)
    assert found.bottom[0] == pytest.approx(math.log(2.0 / 0.1))
    steps = (found.top[0] - found.bottom[0]) / 0.7
    assert steps == pytest.approx(round(steps), abs=1e-9)
    assert round(steps) >= 1


def test_a_ground_of_straight_pieces_has_the_lanes_of_its_samples():
    times, ground = np.array([0.0, 0.3, 0.5, 0.9, 1.2]), np.array([0.0, 3.0, -1.0, -4.0, 0.0])
    samples = np.interp(DT * np.arange(121), times, ground)
    found, sampled = piece_lanes(times, ground, P), spectrum_lanes(samples, DT, P)
    assert found.bottom == pytest.approx(np.log(P / 4.0))
    assert found.bottom == pytest.approx(sampled.bottom)
    same = piece_lanes(DT * np.arange(121), samples, P)
    for name in ("log_x", "restitution", "weight", "peak", "bottom", "top", "between", "side"):
        assert np.array_equal(getattr(same, name), getattr(sampled, name))
    # A corner that stands there twice is one.
    twice = piece_lanes(np.insert(times, 2, 0.3), np.insert(ground, 2, 3.0), P)
    assert np.array_equal(twice.peak, found.peak)


def test_the_strongest_ground_motion_is_a_million_times_gravity():
    check_strength(np.array([0.0, -0.999999e6 * 9.80665]))
    check_strength(np.empty(0))
    with pytest.raises(ValueError, match="at most 1e\\+06 times gravity"):
        check_strength(np.array([0.0, -1.000001e6 * 9.80665]))


BODIES = Block.from_parameters(p=[1.7, 0.9, 1.7], alpha=[0.1, 0.2, 0.15], restitution=[0.85, 0.97, 0.6], log=False)
TIMES = DT * np.arange(MOTION.size)


@pytest.mark.sweep
def test_the_lanes_of_a_body_have_its_own_p_and_its_own_restitutions_and_end_as_they_do_alone():
    """At ln f = ln x + ln(g tan(alpha)/p)."""
    known = Uncertainty()
    found = body_piece_lanes(TIMES, MOTION, BODIES, known)
    for place, own in enumerate(found):
        body = BODIES.lane(place).lanes(1)
        lift = math.log(float(body.gravity * np.tan(body.alpha_c)[0]) / np.max(np.abs(MOTION)))
        assert own.bottom == pytest.approx(lift)
        assert np.sum(own.weight) == pytest.approx(own.top - own.bottom, rel=0.1)
        assert own.log_factor.size > 1600
        (alone,) = body_piece_lanes(TIMES, MOTION, body, known, threads=1)
        for name in ("log_factor", "weight", "over", "bottom", "top"):
            assert np.array_equal(getattr(own, name), getattr(alone, name)), name


@pytest.mark.sweep
@pytest.mark.parametrize("side", [0, 1, -1])
def test_the_lanes_of_a_body_are_those_of_a_spectrum_over_its_range_of_restitution_and_at_its_p(side):
    body = BODIES.lane(0).lanes(1)
    (found,) = body_piece_lanes(TIMES, MOTION, body, Uncertainty(), side=side, second=SECOND)
    spectrum = piece_lanes(TIMES, MOTION, body.p, (0.95 * 0.85, 1.05 * 0.85), side=side)
    inside = spectrum.weight[0] > 0.0
    speed = math.log(float(body.gravity * np.tan(body.alpha_c)[0] / body.p[0]))
    assert found.log_factor - speed == pytest.approx(spectrum.log_x[0, inside], rel=1e-6, abs=1e-6)
    assert found.weight == pytest.approx(spectrum.weight[0, inside], rel=1e-6)
    assert np.mean(found.over != np.isinf(spectrum.peak[0, inside])) < 0.01  # rounding at edges
    assert (found.bottom - speed, found.top - speed) == pytest.approx((spectrum.bottom[0], spectrum.top[0]))


def test_measured_restitutions_may_leave_a_gap_between_them():
    """One very low value of C: no lane of the first stage has a level near those between it and the others."""
    body, gap = BODIES.lane(0).lanes(1), Uncertainty(restitution=(0.1, *(1.0,) * 60))
    (lanes,) = body_piece_lanes(TIMES, MOTION, body, gap)
    assert lanes.log_factor.size > 1000
    assert 0.1 < np.average(lanes.over, weights=lanes.weight) < 0.9
