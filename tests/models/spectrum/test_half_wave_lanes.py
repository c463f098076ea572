"""Lanes through half-waves: against the march over samples, the closed form of one wave, and energy."""

import math

import numpy as np
import pytest

from rocking import Block, OverturningSpectrum, recorded_response
from rocking.response import Outcome
from rocking.spectrum.half_waves import checked_half_waves, half_wave_lanes, triangles
from rocking.spectrum.slender import march_pieces

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
    corners = triangles(*waves)
    length = np.diff(corners[0])
    pieces = length > 1e-9
    ground = np.ascontiguousarray(np.stack([corners[1, :-1], corners[1, 1:]], axis=1)[pieces])
    highest = np.max(np.abs(ground), axis=1)
    past, left = np.maximum.accumulate(highest), np.append(np.maximum.accumulate(highest[::-1])[::-1], 0.0)
    steps = np.outer(RATES, length[pieces])
    peak = np.empty(place.size)
    march_pieces(0, place.size, place, strength, restitution, steps, np.exp(steps), ground, past, left, peak, False)
    return peak


@pytest.mark.parametrize("seed", range(3))
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


def test_a_stronger_or_mirrored_motion_is_a_shift():
    (start, centroid, end, impulse), _ = half_waves(6, count=15)
    one = half_wave_lanes(start, centroid, end, impulse, p=RATES)
    other = half_wave_lanes(start + 3.0, centroid + 3.0, end + 3.0, -2.0 * impulse, p=RATES)
    assert other.log_x == pytest.approx(one.log_x - math.log(2.0), abs=1e-6)
    spectra = [OverturningSpectrum(lanes).spectrum([0.9]) for lanes in (one, other)]
    assert spectra[1] == pytest.approx(2.0 * spectra[0], rel=1e-3)


def test_zeros_are_refused():
    with pytest.raises(ValueError, match="nothing but zeros"):
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
        (0, [0.0, 1.0 - 2e-9, 2.0], "one after the other"),
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


def test_lanes_are_those_of_a_spectrum_unless_told_otherwise():
    waves, _ = half_waves(7, count=8)
    plain, told = half_wave_lanes(*waves), half_wave_lanes(*waves, np.geomspace(0.5, 8.0, 24), (0.675, 0.999))
    for name in ("log_x", "restitution", "weight", "peak"):
        assert np.array_equal(getattr(plain, name), getattr(told, name)), name
