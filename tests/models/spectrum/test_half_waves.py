"""Lanes through half-waves and their demand: against the march over samples, E and closed forms."""

import math

import numpy as np
import pytest

from rocking import Block, OverturningSpectrum, Uncertainty, critical_scale, ground_demand, recorded_response
from rocking.march.demand import HANDED_ON
from rocking.response import Outcome
from rocking.spectrum.half_waves import (
    checked_half_waves,
    demand_of_half_waves,
    half_wave_lanes,
    impulse_lobes,
    lobe_shapes,
    main_lobes,
    triangles,
)
from rocking.spectrum.slender_ground import SlenderGround
from rocking.spectrum.slender_lanes import march_one_rate

G = 9.80665
RATES = np.array([0.7, 2.0, 5.0])


def half_waves(seed, count=40, dt=0.01):
    """Half-waves whose corners lie on samples, so that these are no approximation of the triangles, and the samples."""
    random = np.random.default_rng(seed)
    lengths = random.integers(4, 50, count)
    gaps = random.integers(0, 2, count) * 5
    start = np.cumsum(lengths + gaps) - lengths
    top = start + random.integers(1, lengths)
    end = start + lengths
    peak = random.uniform(0.5, 4.0, count) * (-1.0) ** np.arange(count)
    waves = dt * start, dt * (start + top + end) / 3.0, dt * end, 0.5 * peak * dt * lengths
    ground = np.interp(
        np.arange(end[-1] + 2), np.stack([start, top, end], 1).ravel(), np.stack([0 * peak, peak, 0 * peak], 1).ravel()
    )
    return waves, ground


def marched(waves, place, strength, restitution):
    corners, tops = triangles(*waves)
    long = np.diff(corners) > 1e-9
    pieces = np.stack([np.diff(corners)[long], tops[:-1][long], tops[1:][long]])
    peak = np.empty(place.size)
    for own in np.unique(place):
        lanes = place == own
        log_x = np.log(strength[lanes] * RATES[own])
        motion = SlenderGround(pieces, float(RATES[own]), wall=False)
        peak[lanes] = march_one_rate(motion, log_x, restitution[lanes], rotations=True, threads=1)
    return peak


@pytest.mark.parametrize("seed", range(1))
def test_lanes_meet_the_march_over_samples(seed):
    waves, ground = half_waves(seed)
    random = np.random.default_rng(seed)
    place = random.integers(0, 3, 600)
    restitution = random.uniform(0.0, 0.98, 600)
    strength = np.exp(random.uniform(-0.2, 2.0, 600)) / np.max(np.abs(ground))
    peak = marched(waves, place, strength, restitution)
    alpha = 1e-3
    lanes = Block.from_parameters(p=RATES[place], alpha=np.full(600, alpha), restitution=restitution, log=False)
    exact = recorded_response(lanes, ground, 0.01, equation="linear", block_scale=strength * G * alpha)
    over = exact.outcome == Outcome.OVERTURNS
    assert 0.1 < np.mean(over) < 0.9
    # Long motions with many impacts multiply rounding, and the end of a chatter: not every lane can agree.
    assert np.mean(np.isinf(peak) != over) < 0.02
    both = ~over & np.isfinite(peak) & (exact.peak_rotation_ratio > 1e-4)
    error = np.abs(peak[both] / exact.peak_rotation_ratio[both] - 1.0)
    assert np.median(error) < 1e-7
    # Here a block rests where u' < 1e-3, there where its hops end within the sample.
    assert np.mean(error > 1e-3) < 0.25
    rests = exact.outcome == Outcome.AT_REST
    assert np.array_equal(peak == 0.0, rests)


def test_a_rectangular_impulse_overturns_at_the_speed_of_the_linear_equation():
    # In the limit of a short wave u' = 1 is critical: x I = 1.
    waves = [0.0], [5e-5], [1e-4], [0.3]
    strength = np.array([0.99, 1.01]) / (0.3 * RATES[1])
    peak = marched([np.array(one) for one in waves], np.array([1, 1]), strength, np.array([0.9, 0.9]))
    assert peak[0] == pytest.approx(1.0 - math.sqrt(1.0 - 0.99**2), rel=1e-2)
    assert np.isinf(peak[1])


def test_after_one_wave_an_elastic_block_keeps_its_peak_and_a_dead_one_stays():
    waves = [np.array(one) for one in ([0.0, 1.0, 2.0], [1e-4, 1.2, 2.2], [2e-4, 1.4, 2.4], [0.2, 1e-9, 1e-9])]
    place, strength = np.array([1, 1]), np.full(2, 0.5 / (0.2 * RATES[1]))
    peak = marched(waves, place, strength, np.array([1.0, 0.0]))
    assert peak == pytest.approx(np.full(2, 1.0 - math.sqrt(0.75)), rel=1e-3)


def test_a_short_wave_has_its_impulse_as_spectrum():
    spectrum = OverturningSpectrum(half_wave_lanes([0.0], [5e-5], [1e-4], [0.3], p=RATES)).spectrum([0.9])
    lost = math.exp(0.05 * math.sqrt(2.0 / math.pi))  # the mean loss of the angle
    assert spectrum[:, 0] == pytest.approx(np.full(3, 0.3 * lost), rel=0.02)


def test_no_lane_depends_on_threads_or_on_other_frequencies():
    waves, _ = half_waves(5, count=15)
    one, two = half_wave_lanes(*waves, p=RATES, threads=1), half_wave_lanes(*waves, p=RATES, threads=2)
    alone = half_wave_lanes(*waves, p=RATES[1:2])
    for name in ("log_x", "restitution", "weight", "peak"):
        assert np.array_equal(getattr(one, name), getattr(two, name)), name
        assert np.array_equal(getattr(one, name)[1], getattr(alone, name)[0]), name


def test_zeros_are_refused():
    with pytest.raises(ValueError, match="zeros"):
        half_wave_lanes([0.0], [0.1], [0.2], [0.0])


def test_a_triangle_has_the_ends_the_impulse_and_the_centroid_of_its_half_wave():
    start, end, impulse = np.array([0.5, 2.0, 3.5, 4.0, 6.0]), np.array([2.0, 3.5, 4.0, 6.0, 6.0]), np.arange(1.0, 6.0)
    top = np.array([0.8, 2.0, 4.0, 4.9, 6.0])
    times, ground = triangles(start, (start + top + end) / 3.0, end, impulse)
    assert times == pytest.approx(np.stack([start, top, end], 1).ravel())
    peak = [2.0 * 1.0 / 1.5, 2.0 * 2.0 / 1.5, 2.0 * 3.0 / 0.5, 2.0 * 4.0 / 2.0, 0.0]  # none over no time
    assert ground == pytest.approx(np.stack([np.zeros(5), peak, np.zeros(5)], 1).ravel())
    # A centroid outside the middle third has the top at the nearer end.
    near, _ = triangles(*(np.array(one) for one in ([0.0, 3.0], [0.5, 5.5], [3.0, 6.0], [1.0, 1.0])))
    assert near.tolist() == [0.0, 0.0, 3.0, 3.0, 6.0, 6.0]


def test_half_waves_follow_one_another_with_centroids_inside():
    waves = [0.0, 1.0 - 5e-10, 2.0], [0.0, 2.0, 2.5], [1.0, 2.0, 3.0], [0.1, -0.1, 0.1]
    assert [one.tolist() for one in checked_half_waves(*waves)] == list(waves)
    assert [one.tolist() for one in checked_half_waves(0.5, 0.7, 1.0, 2.0)] == [[0.5], [0.7], [1.0], [2.0]]
    for place, value, words in (
        (0, [0.0, 1.0 - 2e-9, 2.0], "in order and without overlap"),
        (1, [-0.01, 2.0, 2.5], "start <= centroid <= end"),
        (1, [0.0, 2.001, 2.5], "start <= centroid <= end"),
        (3, [0.1, -np.inf, 0.1], "finite"),
        (3, [0.1, 0.1], r"four \(k,\) arrays, got shapes \(3,\), \(3,\), \(3,\), \(2,\)"),
        (3, [0.1, -1e8, 0.1], "times gravity"),
    ):
        with pytest.raises(ValueError, match=words):
            checked_half_waves(*waves[:place], value, *waves[place + 1 :])
    with pytest.raises(ValueError, match="four"):
        checked_half_waves(*(np.ones((2, 2)),) * 4)


BLOCK = Block.from_parameters(p=[1.0, 2.0, 4.0], alpha=[0.1, 0.15, 0.2], restitution=[0.95, 0.9, 0.9])


def even_triangles(seed, count=30, dt=0.01):
    """Half-waves that are symmetric triangles with their ends and tops on samples, and the samples."""
    random = np.random.default_rng(seed)
    halves = random.integers(3, 25, count)
    end = np.cumsum(2 * halves)
    start, peak = end - 2 * halves, random.uniform(0.2, 4.0, count) * (-1.0) ** np.arange(count)
    ground = np.interp(
        np.arange(end[-1] + 1),
        np.stack([start, start + halves, end], 1).ravel(),
        np.stack([0.0 * peak, peak, 0.0 * peak], 1).ravel(),
    )
    return (start * dt, (start + halves) * dt, end * dt, peak * halves * dt), ground


def lift(block=BLOCK):
    """g tan(alpha)/p: E of this size is a demand of one."""
    return block.gravity * np.tan(block.alpha_c) / block.p


@pytest.mark.parametrize("seed", range(2))
def test_lobes_of_triangles_are_those_of_their_samples(seed):
    waves, ground = even_triangles(seed)
    sampled = ground_demand(BLOCK, ground, 0.01)
    # 1, 2 and 4 1/s are nodes of the sampled E, which then is exact; lobes have their tops between points of either.
    for rate, speed, largest, build_up, c in zip(
        BLOCK.p, lift(), sampled.largest, sampled.build_up, BLOCK.restitution, strict=True
    ):
        sizes = np.sort(np.abs(impulse_lobes(*waves, rate).sizes))[::-1] / speed
        assert sizes[0] == pytest.approx(largest, rel=5e-3)
        assert np.sum((HANDED_ON * c) ** np.arange(sizes.size) * sizes) == pytest.approx(build_up, rel=2e-2)


def test_short_half_waves_are_a_sum_of_weighted_impulses():
    random = np.random.default_rng(3)
    centroid = np.cumsum(random.uniform(0.05, 1.0, 12))
    impulse = random.uniform(-0.5, 0.5, 12)
    rate = 1.7
    at_impulses = [np.sum(impulse[k:] * np.exp(-rate * (centroid[k:] - centroid[k]))) for k in range(12)]
    lobes = impulse_lobes(centroid - 1e-7, centroid, centroid + 1e-7, impulse, rate)
    assert np.max(np.abs(lobes.sizes)) == pytest.approx(np.max(np.abs(at_impulses)), rel=1e-5)
    assert np.all(lobes.sizes[1:] * lobes.sizes[:-1] < 0.0)
    assert np.all(np.diff(lobes.times) > 0.0)


@pytest.mark.parametrize("share", [0.4, 0.65])  # where the top stands
def test_one_wave_overturns_the_linear_block_where_its_lobe_says(share):
    dt, length = 0.002, 0.8
    time = np.arange(0.0, length + 0.5 * dt, dt)
    ground = np.interp(time, [0.0, share * length, length], [0.0, 2.0, 0.0])
    impulse, centroid = 0.5 * 2.0 * length, (1.0 + share) * length / 3.0
    factor = critical_scale(BLOCK, ground, dt, "linear", factor_max=20.0).safety_factor
    lobe = [impulse_lobes([0.0], [centroid], [length], [impulse], rate).sizes[0] for rate in BLOCK.p]
    assert factor == pytest.approx(BLOCK.gravity * BLOCK.alpha_c / (BLOCK.p * np.array(lobe)), rel=5e-3)


def test_a_march_through_one_wave_overturns_at_its_lobe():
    found = demand_of_half_waves(BLOCK, [0.0], [0.3], [0.6], [1.0])
    # Without an impact C has no part. The angle is less by 5 % of abs(N): a mean shift of 0.05 sqrt(2/pi) in ln.
    lost = np.exp(0.05 * np.sqrt(2.0 / np.pi))
    largest = [impulse_lobes([0.0], [0.3], [0.6], [1.0], rate).sizes[0] for rate in BLOCK.p] / lift()
    assert found.march == pytest.approx(lost * largest, rel=0.02)
    # ln of factor and geometry: skew-normal, of which 10 % lie below the quantile.
    shift = np.linspace(-1.0, 1.0, 20001)
    tenth = np.interp(0.9, Uncertainty().below(shift), shift)
    assert found.march_10 == pytest.approx(np.exp(tenth) * largest, rel=0.03)


@pytest.mark.sweep
def test_the_march_of_a_body_is_that_of_a_spectrum_of_its_p_within_the_error_of_their_lanes():
    """A spectrum has other lanes, 844 over all restitutions, of which a body has a tenth to a third."""
    waves, _ = even_triangles(11, count=12)
    block = Block.from_parameters(p=[0.4, 1.3, 2.9, 9.0], alpha=0.1, restitution=0.93)
    found = demand_of_half_waves(block, *waves)
    read = OverturningSpectrum(half_wave_lanes(*waves, p=block.p)).factors(block)
    assert found.march == pytest.approx(1.0 / read.factor_mean, rel=0.04)
    assert found.march_10 == pytest.approx(1.0 / read.factor_10, rel=0.08)
    assert np.all(found.march_10 > found.march)


def test_lengths_four_times_and_times_twice_as_large_have_the_same_demand():
    """p t, tan(alpha) and with them x = p f/(g tan alpha) times the impulse are the same."""
    (start, centroid, end, impulse), _ = even_triangles(11, count=12)
    large = Block.from_parameters(p=0.5 * BLOCK.p, alpha=BLOCK.alpha_c, restitution=BLOCK.restitution, log=False)
    one = demand_of_half_waves(BLOCK, start, centroid, end, impulse)
    other = demand_of_half_waves(large, 2.0 * start, 2.0 * centroid, 2.0 * end, 2.0 * impulse)
    for name in ("march", "march_10", "ratio"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9), name
    assert other.interval == pytest.approx(2.0 * one.interval, rel=1e-9, nan_ok=True)
    assert np.array_equal(other.main_count, one.main_count)


@pytest.mark.sweep
def test_every_restitution_has_a_march():
    waves, _ = even_triangles(7, count=12)
    restitution = np.array([0.0, 0.03, 0.1, 0.3, 0.5, 0.7, 0.75, 0.9, 1.0])
    block = Block.from_parameters(p=np.full(9, 2.0), alpha=0.1, restitution=restitution)
    march = demand_of_half_waves(block, *waves).march
    assert np.all(march[1:] > 0.9 * march[:-1])  # more with C, but for the scatter of the lanes
    assert march[-1] > march[0]


@pytest.mark.sweep
@pytest.mark.parametrize(("factor", "later", "seed"), [(0.013, -50.0, 3), (87.0, 7.3, 8)])
def test_demand_grows_with_the_record_and_knows_neither_its_sign_nor_its_clock(factor, later, seed):
    (start, centroid, end, impulse), _ = even_triangles(seed, count=12)
    one = demand_of_half_waves(BLOCK, start, centroid, end, impulse)
    other = demand_of_half_waves(BLOCK, start + later, centroid + later, end + later, -factor * impulse)
    for name in ("march", "march_10"):
        # A lane of 464 that flips by rounding moves the march by a thousandth at most.
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=2e-3)
    assert np.array_equal(other.main_count, one.main_count)
    assert other.ratio == pytest.approx(one.ratio, rel=1e-6)


@pytest.mark.sweep
def test_a_block_alone_gets_the_answer_it_has_among_others_on_any_number_of_threads():
    waves, _ = even_triangles(5, count=8)
    many = demand_of_half_waves(BLOCK, *waves, threads=2)
    for lane in range(0, 3, 2):
        alone = demand_of_half_waves(BLOCK.lane(lane), *waves, threads=1)
        for name in ("march", "march_10", "main_count", "ratio", "interval"):
            one, among = getattr(alone, name), getattr(many, name)[lane : lane + 1]
            assert one == pytest.approx(among, rel=1e-9, nan_ok=True), name  # levels are summed from another one on


def test_main_lobes_are_counted_with_what_lies_between_them():
    start = np.arange(5.0) * 3.0
    impulse = np.array([0.3, -0.1, 0.28, -0.29, 0.05])
    found = demand_of_half_waves(BLOCK.lane(2), start, start + 0.05, start + 0.1, impulse)
    # p = 4: after three seconds nothing of an impulse is left, so that lobes are the waves.
    assert found.main_count.tolist() == [3]
    assert found.ratio == pytest.approx([1.0 / 3.0], rel=1e-3)
    assert found.interval == pytest.approx([3.0], rel=1e-2)
    single = demand_of_half_waves(BLOCK.lane(2), [0.0], [0.05], [0.1], [0.3])
    assert (single.main_count.tolist(), single.ratio.tolist()) == ([1], [0.0])
    assert np.isnan(single.interval).all()


def test_no_half_wave_asks_for_nothing():
    found = demand_of_half_waves(BLOCK, [], [], [], [])
    assert found.march.tolist() == found.march_10.tolist() == [0.0, 0.0, 0.0]
    assert found.main_count.tolist() == [1, 1, 1]


def test_lobes_above_half_the_largest_one_are_main_ones():
    sizes, times = np.array([0.5, -0.2, 1.0, -0.3, 0.5, -0.6, 0.45]), np.array([0.0, 3.0, 6.0, 9.0, 13.0, 15.0, 22.0])
    count, ratio, interval = main_lobes(times, sizes)
    assert (count, interval) == (2, 3.0)
    assert ratio == pytest.approx(np.sqrt((0.3**2 + 0.5**2) / 2.0))
    count, ratio, interval = main_lobes(times, 2.0 * sizes * [1.02, 1, 1, 1, 1, 1, 1])
    assert (count, interval) == (3, 3.0)
    assert ratio == pytest.approx(np.sqrt((0.2**2 + 0.3**2 + 0.5**2) / 3.0))
    assert main_lobes(times[:3], np.array([0.7, -1.0, 0.8])) == (3, 0.0, 3.0)
    for few in (sizes[:0], sizes[:1], sizes[1:4]):
        assert main_lobes(times[: few.size], few)[:2] == (1, 0.0)
    waves = [0.0, 3.0, 6.0], [1e-6, 3.0 + 1e-6, 6.0 + 1e-6], [2e-6, 3.0 + 2e-6, 6.0 + 2e-6], [1.0, -0.2, 0.8]
    found = lobe_shapes(*waves, [0.01, 20.0])
    assert [column.shape for column in found] == [(2,)] * 3
    assert [column[1] for column in found] == pytest.approx([2, 0.2, 3.0], rel=1e-4)
    assert lobe_shapes(*waves, 20.0)[0].tolist() == [2]


def test_many_blocks_share_the_lanes_of_a_spectrum():
    waves = [0.0, 0.6, 1.1], [0.3, 0.8, 1.5], [0.6, 1.1, 1.8], [0.4, -0.5, 0.2]
    random = np.random.default_rng(3)
    rates, restitution = random.uniform(2.0, 2.3, 140), random.uniform(0.8, 1.0, 140)
    blocks = Block.from_parameters(p=rates, alpha=0.1, restitution=restitution, log=False)
    shared = demand_of_half_waves(blocks, *waves)
    some = np.arange(0, 140, 20)
    own = demand_of_half_waves(blocks.take(some), *waves)
    for name in ("march", "march_10"):
        ratio = getattr(shared, name)[some] / getattr(own, name)
        assert 0.0 < np.max(np.abs(np.log(ratio))) < 0.05
    fewer = demand_of_half_waves(blocks.take(np.arange(130)), *waves)
    assert np.array_equal(fewer.march, shared.march[:130])  # a block does not depend on the others


@pytest.mark.parametrize("rate", [0.0, -1.0, math.nan, math.inf])
def test_lobes_need_a_positive_frequency_parameter(rate):
    with pytest.raises(ValueError, match="rates: expected"):
        lobe_shapes([0.0], [0.3], [0.6], [1.0], [2.0, rate])
    with pytest.raises(ValueError, match="rate: expected"):
        impulse_lobes([0.0], [0.3], [0.6], [1.0], rate)


def test_half_waves_that_are_no_numbers_have_no_lobes():
    with pytest.raises(ValueError, match="expected finite numbers"):
        impulse_lobes([0.0, 1.0], [0.3, 1.3], [0.6, 1.6], [1.0, math.nan], 2.0)
