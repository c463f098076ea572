"""What others have published, against the kernels: each row of docs/validation.md names its test."""

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import ks_2samp

import rockpulse as rp
from rocking import Block, OverturningSpectrum, critical_scale, recorded_response
from rocking.spectrum.slender_lanes import spectrum_lanes
from synthetic import synthetic_motion

G = 9.81
SAMPLES = 120  # of a cycle; the sine is piecewise linear, which raises thresholds by some 2e-4


def one_sine(frequency, restitution, equation="linear", alpha=0.1):
    """Edges of the amplitudes A/(g alpha), of g tan alpha in the nonlinear equation, that overturn, w = frequency p."""
    block = Block.from_parameters(p=2.0, alpha=alpha, restitution=restitution, gravity=G, log=False)
    wave = np.sin(2.0 * np.pi * np.arange(SAMPLES + 1) / SAMPLES)
    wave[-1] = 0.0
    lifting = G * (alpha if equation == "linear" else np.tan(alpha))
    found = critical_scale(block, wave * lifting, np.pi / frequency / SAMPLES, equation, points=400, factor_max=40.0)
    return found.lower, found.upper


def at_end(amplitude, frequency):
    """(x, u) at the end of one sine of a block that has turned one way ever since it lifted off (linear, derived)."""
    lift = np.arcsin(1.0 / amplitude)
    length, share = (2.0 * np.pi - lift) / frequency, 1.0 / (1.0 + frequency**2)
    total, apart = -(frequency**2) * share, amplitude * frequency * np.cos(lift) * share
    grows, falls = 0.5 * (total + apart) * np.exp(length), 0.5 * (total - apart) * np.exp(-length)
    return grows + falls + 1.0, grows - falls - amplitude * frequency * share


def without_impact(frequency):
    """A/(g alpha) from which one sine overturns a block without an impact: the growing part outlasts the pulse."""
    return brentq(lambda a: sum(at_end(a, frequency)) - 1.0, 1.0 + 1e-9, 300.0, xtol=1e-12)


def after_impact(frequency, restitution):
    """The largest A/(g alpha) that overturns after one impact, which comes behind the pulse; None where none does.

    There x^2 - 2 x - u^2 is kept, so it lands with v^2 = u^2 - (1 - x)^2 + 1 and needs C v >= 1.
    """

    def spare(amplitude):
        x, u = at_end(amplitude, frequency)
        return u * u - (1.0 - x) ** 2 + 1.0 - 1.0 / restitution**2

    grid = np.linspace(without_impact(frequency) * (1.0 - 1e-9), 1.05, 4000)
    enough = np.flatnonzero([spare(one) >= 0.0 for one in grid])
    return brentq(spare, grid[enough[0]], grid[enough[0] - 1]) if enough.size and enough[0] else None


@pytest.mark.sweep
@pytest.mark.parametrize("frequency", [2.0, 4.0, 6.0])
def test_one_sine_has_two_modes_with_a_safe_region_between(frequency):
    """Zhang & Makris (2001): with an impact, and without one from a larger amplitude; between them the block stands."""
    most = without_impact(frequency)
    for restitution in (0.95, 0.9):
        lower, upper = one_sine(frequency, restitution)
        assert lower.size == 2
        assert lower[0] < upper[0] < lower[1]
        # Both ends of the safe region in closed form.
        assert lower[1] == pytest.approx(most, rel=4e-4)
        assert upper[0] == pytest.approx(after_impact(frequency, restitution), rel=4e-4)


@pytest.mark.sweep
def test_the_shape_of_the_safe_region_depends_on_the_restitution():
    """Zhang & Makris (2001). It widens as C falls, until no amplitude overturns with an impact; its top stays."""
    regions = {ratio: one_sine(4.0, ratio) for ratio in (0.95, 0.9, 0.85, 0.8)}
    widths = [lower[1] - upper[0] for lower, upper in regions.values()]
    assert widths == pytest.approx([0.17, 0.39, 0.70, 1.20], abs=0.006)
    tops = [lower[1] for lower, _ in regions.values()]
    assert np.ptp(tops) < 1e-6 * tops[0]
    lower, _ = one_sine(5.0, 0.8)
    assert lower.size == 1
    assert lower[0] == pytest.approx(without_impact(5.0), rel=4e-4)


def test_the_safe_region_is_sensitive_to_the_nonlinear_equation():
    """Zhang & Makris (2001): with alpha the region moves while the minimum hardly does."""
    slender, squat = (one_sine(3.0, 0.9, "nonlinear", alpha) for alpha in (0.05, 0.4))
    assert squat[0][0] / slender[0][0] - 1.0 == pytest.approx(0.003, abs=5e-4)  # the minimum acceleration
    assert squat[1][0] / slender[1][0] - 1.0 == pytest.approx(0.031, abs=5e-4)  # the lower end of the safe region
    assert squat[0][1] / slender[0][1] - 1.0 == pytest.approx(0.022, abs=5e-4)  # its upper end


def test_of_similar_blocks_the_larger_bears_more_than_its_static_share():
    """Housner (1963): a scale effect makes tall slender structures more stable than might have been expected."""
    sizes = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
    alpha = np.arctan(1.0 / 6.0)
    blocks = Block(half_width=sizes * np.sin(alpha), half_height=sizes * np.cos(alpha), gravity=G)
    wave = np.sin(np.pi * np.arange(101) / 100)
    wave[-1] = 0.0
    bears = critical_scale(blocks, wave * G * np.tan(alpha), 0.5 / 100, points=200, factor_max=50.0).safety_factor
    # Times the acceleration that is all a static check allows.
    assert bears == pytest.approx([1.6, 2.0, 2.4, 3.1, 4.1], abs=0.05)


def test_similar_blocks_far_from_overturning_have_the_same_top_displacement():
    """Reggiani Manzo & Vassiliou (2019): of analytical pulses and records, if not close to overturning."""
    sizes = np.array([2.0, 4.0, 8.0])
    alpha = np.arctan(1.0 / 5.0)
    blocks = Block(
        half_width=sizes * np.sin(alpha), half_height=sizes * np.cos(alpha), restitution=0.9, gravity=G, log=False
    )
    apart = []
    for seed in range(40):
        motion = synthetic_motion(seed, duration=30.0, dt=0.01, pga=3.0)
        peak = recorded_response(blocks, motion, 0.01).peak_rotation_ratio
        if np.all((peak > 0.0) & (peak < 0.25)):
            apart.append(np.ptp(2.0 * sizes * np.sin(peak * alpha)) / np.mean(2.0 * sizes * np.sin(peak * alpha)))
    assert len(apart) == 28
    assert np.median(apart) == pytest.approx(0.09, abs=0.005)
    assert max(apart) == pytest.approx(1.44, abs=0.02)  # of the mean, in one of them


def test_similar_blocks_have_the_same_top_displacement_under_one_impulse():
    """Reggiani Manzo & Vassiliou (2019), VALIDATION V18: within 1 % for u below 0.1."""
    sizes, speed = np.array([1.0, 2.0, 4.0, 8.0]), 0.03
    alpha = np.arctan(1.0 / 5.0)
    blocks = Block(half_width=sizes * np.sin(alpha), half_height=sizes * np.cos(alpha), gravity=G)
    # An impulse gives a block the speed p^2 cos(alpha) I/g; one that is 1 sample long does the same to 1e-3.
    start = blocks.p**2 * np.cos(alpha) * speed / G
    quiet = np.zeros(2000)
    peak = recorded_response(blocks, quiet, 0.001, initial_velocity=start).peak_rotation_ratio
    assert np.all(start / (blocks.p * alpha) < 0.1)
    top = 2.0 * sizes * np.sin(peak * alpha)
    assert np.ptp(top) < 0.01 * np.mean(top)


@pytest.mark.sweep
def test_histories_differ_and_the_distribution_of_their_maxima_does_not():
    """Vassiliou et al. (2021): a model may fail on one motion and be right on the distribution over an ensemble.

    Here two models whose restitution differs by one in a hundred, under 150 synthetic motions.
    """
    alpha, half = np.arctan(1.0 / 6.0), 2.0
    size = half * np.sin(alpha), half * np.cos(alpha)
    blocks = Block(
        half_width=[size[0]] * 2, half_height=[size[1]] * 2, restitution=[0.92, 0.99 * 0.92], gravity=G, log=False
    )
    motions = [synthetic_motion(seed, duration=20.0, dt=0.01, pga=4.0) for seed in range(150)]
    peaks = np.array([recorded_response(blocks, one, 0.01).peak_rotation_ratio for one in motions])
    both = np.isfinite(peaks).all(axis=1)
    assert np.count_nonzero(np.isinf(peaks[:, 0]) != np.isinf(peaks[:, 1])) == 3
    apart = np.abs(np.diff(np.log(peaks[both]), axis=1))
    assert np.quantile(apart, 0.9) == pytest.approx(np.log(1.43), abs=0.02)
    assert np.max(apart) > np.log(5.0)
    assert ks_2samp(*np.minimum(peaks, 10.0).T).statistic == pytest.approx(0.033, abs=0.007)


@pytest.mark.slow
def test_the_overturning_acceleration_is_constant_then_falls_with_one_over_p_and_its_square(samples):
    """Overturning acceleration spectra (2026, summary): a constant, 1/p and about 1/p^2, from small blocks to large.

    The slopes of ln of PGA at overturning over ln p, medians over six Ridgecrest channels.
    """
    slopes = []
    for record in rp.read_all(samples)[0]:
        if record.orientation == "horizontal" and record.pga > 1.0:
            record = rp.condition(record)
            spectrum = OverturningSpectrum(spectrum_lanes(record.acceleration, record.dt))
            capacity = record.pga / (spectrum.p * spectrum.spectrum([0.95])[:, 0])
            slopes.append(np.gradient(np.log(capacity), np.log(spectrum.p)))
    assert len(slopes) == 6
    median = np.median(slopes, axis=0)
    large, middle, small = (
        np.mean(median[(spectrum.p > low) & (spectrum.p < high)])
        for low, high in ((0.55, 0.95), (1.2, 1.8), (6.5, 9.0))
    )
    assert (large, middle, small) == (
        pytest.approx(-1.77, abs=0.1),
        pytest.approx(-1.03, abs=0.1),
        pytest.approx(-0.22, abs=0.1),
    )


@pytest.mark.parametrize("share", [0.95, 0.67])
def test_a_lower_restitution_than_housners_lowers_amplitudes_and_periods_of_free_rocking(share):
    """ElGawady et al.: C 0.95 (concrete) and 0.67 (rubber) of Housner's at slenderness 5; models with his
    overestimate amplitudes and periods."""
    block = Block(0.2, 1.0, gravity=G)
    measured = Block(0.2, 1.0, restitution=share * block.restitution, gravity=G)
    quiet, dt = np.zeros(4000), 0.001
    cycles = []
    for one in (block, measured):
        found = recorded_response(one, quiet, dt, initial_rotation=0.5 * one.alpha_c, history=True)
        turned = found.rotation / one.alpha_c
        signs = np.flatnonzero(np.diff(np.sign(turned)) != 0)[:4]
        peaks = [np.max(np.abs(turned[a:b])) for a, b in itertools.pairwise(signs.tolist())]
        cycles.append((peaks, np.diff(signs) * dt))
    (peaks, times), (lower, shorter) = cycles
    assert np.all(np.array(lower) < np.array(peaks))
    assert np.all(shorter < times)
    # Energy at the impact: 1 - (1 - x)^2 falls with C^2 (linear; the block is slender).
    for own, ratio in ((peaks, block.restitution), (lower, measured.restitution)):
        energy = 1.0 - (1.0 - np.array([0.5, *own])) ** 2
        assert energy[1:] / energy[:-1] == pytest.approx(np.full(3, ratio**2), rel=0.02)


def test_a_restitution_above_housners_is_taken():
    """Kalliontzis et al. (2016): Housner's is consistently lower than what is measured. It is taken, with a remark."""
    housner = Block(0.6, 3.0, gravity=G, log=False)
    higher = Block(0.6, 3.0, restitution=housner.restitution + 0.03, gravity=G, log=False)
    assert any("above Housner's" in one for one in higher.warnings)
    motion = synthetic_motion(1, duration=20.0, dt=0.01, pga=4.0)
    assert recorded_response(higher, motion, 0.01).active_samples > 0
