"""The demand of half-waves: E against the sampled one and the linear equation, the march in its limits."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking import Block, OverturningSpectrum, Uncertainty, critical_scale, ground_demand
from rocking.crossing import mean_capacity
from rocking.demand import HANDED_ON
from rocking.half_wave_demand import BANDS, Lobes, _main_lobes, demand_of_half_waves, impulse_lobes, lobe_shapes
from rocking.half_wave_lanes import half_wave_lanes

G = 9.80665
BLOCK = Block.from_parameters(p=[1.0, 2.0, 4.0], alpha=[0.1, 0.15, 0.2], restitution=[0.95, 0.9, 0.9])


def triangles(seed, count=30, dt=0.01):
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


@pytest.mark.parametrize("seed", range(4))
def test_lobes_of_triangles_are_those_of_their_samples(seed):
    waves, ground = triangles(seed)
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


@pytest.mark.parametrize("share", [0.4, 0.5, 0.65])  # where the top stands
def test_one_wave_overturns_the_linear_block_where_its_lobe_says(share):
    dt, length = 0.002, 0.8
    time = np.arange(0.0, length + 0.5 * dt, dt)
    ground = np.interp(time, [0.0, share * length, length], [0.0, 2.0, 0.0])
    impulse, centroid = 0.5 * 2.0 * length, (1.0 + share) * length / 3.0
    factor = critical_scale(BLOCK, ground, dt, "linear", factor_max=20.0).safety_factor
    lobe = [impulse_lobes([0.0], [centroid], [length], [impulse], rate).sizes[0] for rate in BLOCK.p]
    assert factor == pytest.approx(BLOCK.gravity * BLOCK.alpha_c / (BLOCK.p * np.array(lobe)), rel=5e-3)


@pytest.mark.parametrize(("ratio", "least"), [(1.0, 1.322397), (2.0, 1.800724), (3.0, 2.293872), (4.0, 2.790798)])
def test_a_half_sine_of_validation_v13_is_critical(ratio, least):
    p, alpha = 2.0, 0.1
    length = np.pi / (ratio * p)
    amplitude = least * G * alpha
    lobes = impulse_lobes([0.0], [0.5 * length], [length], [2.0 * amplitude * length / np.pi], p)
    # The triangle of the same impulse for the half-sine: what that costs.
    assert p * lobes.sizes[0] / (G * alpha) == pytest.approx(1.0, abs=0.06)


@pytest.mark.parametrize(("ratio", "least"), [(2.0, 2.349903), (3.0, 3.631150), (4.0, 5.238964), (6.0, 9.416966)])
def test_a_full_sine_of_validation_v14_is_critical_without_impact_in_its_first_half(ratio, least):
    p, alpha = 2.0, 0.1
    half = np.pi / (ratio * p)
    impulse = 2.0 * least * G * alpha * half / np.pi
    lobes = impulse_lobes([0.0, half], [0.5 * half, 1.5 * half], [half, 2.0 * half], [impulse, -impulse], p)
    assert p * lobes.sizes[0] / (G * alpha) == pytest.approx(1.0, abs=0.06)
    assert abs(lobes.sizes[1]) > lobes.sizes[0]  # the second half alone, from rest, asks for more: F7


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


def test_between_the_marches_the_answer_is_that_of_the_body_itself():
    waves, _ = triangles(11, count=20)
    block = Block.from_parameters(p=[0.4, 1.3, 2.9, 9.0], alpha=0.1, restitution=0.93)
    found = demand_of_half_waves(block, *waves)
    own = OverturningSpectrum(half_wave_lanes(*waves, p=block.p)).probability([0.93])
    level = OverturningSpectrum(half_wave_lanes(*waves, p=block.p)).level
    direct = 1.0 / mean_capacity(level, own[:, 0]) / lift(block)
    assert found.march == pytest.approx(direct, rel=0.08)  # docs/decisions/009: 2 % on records
    assert np.all(found.march_10 > found.march)


def test_every_restitution_has_a_march():
    waves, _ = triangles(7, count=20)
    restitution = np.array([0.0, 0.03, 0.1, 0.3, 0.5, 0.7, 0.75, 0.9, 1.0])
    block = Block.from_parameters(p=np.full(9, 2.0), alpha=0.1, restitution=restitution)
    march = demand_of_half_waves(block, *waves).march
    assert march[0] == march[1] != march[2]  # the first two are below the last band, which begins at 0.066
    assert np.all(march[1:] > 0.9 * march[:-1])  # more with C, but for the scatter of the lanes


@settings(derandomize=True, deadline=None, max_examples=10)
@given(factor=st.floats(0.01, 100.0), later=st.floats(-50.0, 50.0), seed=st.integers(0, 20))
def test_demand_grows_with_the_record_and_knows_neither_its_sign_nor_its_clock(factor, later, seed):
    (start, centroid, end, impulse), _ = triangles(seed, count=12)
    one = demand_of_half_waves(BLOCK, start, centroid, end, impulse)
    other = demand_of_half_waves(BLOCK, start + later, centroid + later, end + later, -factor * impulse)
    for name in ("march", "march_10"):
        # A lane of 584 that flips by rounding moves the march by a thousandth at most.
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=2e-3)
    assert np.array_equal(other.main_count, one.main_count)
    assert other.ratio == pytest.approx(one.ratio, rel=1e-6)


def test_a_block_alone_gets_the_answer_it_has_among_others_on_any_number_of_threads():
    waves, _ = triangles(5)
    many = demand_of_half_waves(BLOCK, *waves, threads=2)
    for lane in range(3):
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


@pytest.mark.parametrize(
    ("waves", "words"),
    [
        (([0.0], [0.1], [0.2], [1.0, 2.0]), "four"),
        (([0.0], [0.3], [0.2], [1.0]), "start <= centroid <= end"),
        (([0.0, 0.1], [0.1, 0.2], [0.2, 0.3], [1.0, -1.0]), "one after the other"),
        (([0.0], [0.1], [0.2], [np.nan]), "finite"),
    ],
)
def test_what_makes_no_sense_is_refused(waves, words):
    with pytest.raises(ValueError, match=words):
        demand_of_half_waves(BLOCK, *waves)


def test_the_weighted_impulse_is_taken_at_eight_points_of_each_side_of_a_triangle():
    """E at the time t of a lobe, by quadrature over the triangles after it; times are eighths of a side."""
    start, top, end = np.array([0.0, 1.0]), np.array([0.4, 1.2]), np.array([1.0, 1.8])
    impulse, rate = np.array([0.3, -0.25]), 1.3
    lobes = impulse_lobes(start, (start + top + end) / 3.0, end, impulse, rate)
    corners = np.stack([start, top, end], 1).ravel()
    tops = np.stack([0.0 * start, 2.0 * impulse / (end - start), 0.0 * start], 1).ravel()
    points = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(corners)]))
    fine = np.linspace(0.0, 1.8, 180001)
    ground = np.interp(fine, corners, tops)

    def weighted(t):
        return np.trapezoid(np.where(fine >= t, ground * np.exp(-rate * (fine - t)), 0.0), fine)

    at_points = np.array([weighted(t) for t in points])
    signs = np.split(np.arange(points.size), np.flatnonzero(np.diff(np.sign(np.round(at_points, 9)))) + 1)
    expected = [part[np.argmax(np.abs(at_points[part]))] for part in signs]
    assert lobes.times == pytest.approx(points[expected[:2]])
    assert lobes.sizes == pytest.approx(at_points[expected[:2]], rel=1e-4)


def test_lobes_above_half_the_largest_one_are_main_ones():
    sizes, times = np.array([0.5, -0.2, 1.0, -0.3, 0.5, -0.6, 0.45]), np.array([0.0, 3.0, 6.0, 9.0, 13.0, 15.0, 22.0])
    count, ratio, interval = _main_lobes(Lobes(times, sizes))
    assert (count, interval) == (2, 3.0)
    assert ratio == pytest.approx(np.sqrt((0.3**2 + 0.5**2) / 2.0))
    count, ratio, interval = _main_lobes(Lobes(times, 2.0 * sizes * [1.02, 1, 1, 1, 1, 1, 1]))
    assert (count, interval) == (3, 3.0)
    assert ratio == pytest.approx(np.sqrt((0.2**2 + 0.3**2 + 0.5**2) / 3.0))
    assert _main_lobes(Lobes(times[:3], np.array([0.7, -1.0, 0.8]))) == (3, 0.0, 3.0)
    for few in (sizes[:0], sizes[:1], sizes[1:4]):
        assert _main_lobes(Lobes(times[: few.size], few))[:2] == (1, 0.0)
    waves = [0.0, 3.0, 6.0], [1e-6, 3.0 + 1e-6, 6.0 + 1e-6], [2e-6, 3.0 + 2e-6, 6.0 + 2e-6], [1.0, -0.2, 0.8]
    found = lobe_shapes(*waves, [0.01, 20.0])
    assert [column.shape for column in found] == [(2,)] * 3
    assert [column[1] for column in found] == pytest.approx([2, 0.2, 3.0], rel=1e-4)
    assert lobe_shapes(*waves, 20.0)[0].tolist() == [2]


def test_a_band_of_restitutions_begins_where_the_one_below_it_ends():
    assert len(BANDS) == 7
    for upper, lower in pairwise(BANDS):
        assert upper[0] / 0.9 == pytest.approx(lower[1])
    assert [most / least for least, most in BANDS[1:]] == pytest.approx([5.0 / 3.0] * 6)
    waves, _ = triangles(7, count=12)
    edges = np.multiply.outer([0.75, 0.5], [1.0 - 5e-13, 1.0, 1.0 + 1e-9, 1.0 - 2e-12]).ravel()
    march = demand_of_half_waves(Block.from_parameters(p=np.full(8, 2.0), alpha=0.1, restitution=edges), *waves).march
    for edge in (march[:4], march[4:]):
        assert edge[:3] == pytest.approx([edge[0]] * 3, rel=1e-7)
        assert abs(edge[3] / edge[0] - 1.0) > 1e-6
