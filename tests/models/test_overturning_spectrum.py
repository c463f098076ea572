"""The overturning spectrum against pulses with known capacities, exact similarities and lanes of a body's own."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from rocking import Block, OverturningSpectrum, Uncertainty, critical_scale, spectrum_lanes
from rocking.lane_probability import lane_bells, tail_masses
from rocking.overturning_spectrum import INTERPOLATION, TWO_SIDED, covered_range, slender_within
from rockpulse.record.synthetic import synthetic_motion

DT = 0.01
MOTION = synthetic_motion(3, pga=3.0)[:2000]
P = np.array([1.5, 1.7])


def pulse(length, peak=3.0):
    """Half a sine of some length [s], and a second of rest."""
    time = np.arange(0.0, length + DT / 2, DT)
    return np.append(peak * np.sin(math.pi * time / length), np.zeros(100))


def spectrum_of(motion, p=P, uncertainty=None, dt=DT):
    return OverturningSpectrum(spectrum_lanes(motion, dt, p), uncertainty)


#: What a lane that flips by rounding moves S by at most: a stretch of 1/100 in ln x over a third of the restitutions.
ONE_LANE = 0.01


@pytest.fixture(scope="module")
def spectrum():
    return spectrum_of(MOTION)


def test_a_short_pulse_gives_its_impulse():
    """A slender block falls at I = g tan(alpha)/p, whatever its p: S = I."""
    motion = pulse(0.02, peak=50.0)
    impulse = np.sum(motion) * DT
    wide = Uncertainty(factor=0.05, restitution=(0.95, 1.0), geometry=0.0)
    found = spectrum_of(motion, [0.5], wide).spectrum([0.9])[0, 0]
    assert found == pytest.approx(impulse, rel=0.01)


def test_a_pulse_that_overturns_without_an_impact_has_its_capacity_and_its_lognormal():
    motion = pulse(0.5)
    block = Block.from_parameters(p=P, alpha=math.atan(1.0 / 8.0), restitution=0.9, log=False)
    capacity = critical_scale(block, motion, DT).safety_factor
    wide = Uncertainty(factor=0.05, restitution=(0.9, 1.0), geometry=0.0)
    read = spectrum_of(motion, uncertainty=wide).factors(block)
    assert read.capacity_mean == pytest.approx(capacity, rel=0.01)
    assert read.factor_50 == pytest.approx(capacity, rel=0.01)
    assert np.log(read.factor_10 / capacity) == pytest.approx(-1.2816 * 0.05, abs=0.012)
    assert read.at_one == pytest.approx(ndtr(-np.log(capacity) / 0.05), abs=0.03)


def test_a_record_twice_as_strong_has_twice_the_spectrum(spectrum):
    twice = spectrum_of(2.0 * MOTION).spectrum([0.85, 0.95])
    assert twice / spectrum.spectrum([0.85, 0.95]) == pytest.approx(np.full((2, 2), 2.0), rel=ONE_LANE)


def test_time_and_size_stretched_together(spectrum):
    """phi'' = phi - s - (x/p) a_g(tau/p): twice the time at half the p is the same motion at half the x."""
    stretched = spectrum_of(MOTION, 0.5 * P, dt=2.0 * DT).spectrum([0.85, 0.95])
    assert stretched / spectrum.spectrum([0.85, 0.95]) == pytest.approx(np.full((2, 2), 2.0), rel=ONE_LANE)


def test_a_bouncier_block_and_a_lower_limit_state_take_more(spectrum):
    of_overturning = spectrum.spectrum([0.75, 0.85, 0.95])
    assert np.all(np.diff(of_overturning, axis=1) > 0.0)
    assert np.all(spectrum.spectrum([0.85], rotation=0.1) > spectrum.spectrum([0.85], rotation=1.0))
    assert np.all(spectrum.spectrum([0.85], rotation=1.0) >= spectrum.spectrum([0.85]))


def test_probability_rises_from_zero_to_one(spectrum):
    found = spectrum.probability([0.9])
    assert np.all(np.diff(found, axis=-1) >= 0.0)
    assert found[..., 0] == pytest.approx(0.0, abs=1e-6)
    assert found[..., -1] == pytest.approx(1.0, abs=1e-6)


def test_a_wider_uncertainty_has_an_earlier_ten_percent():
    block = Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.95, log=False)
    lanes = spectrum_lanes(MOTION, DT, P)
    narrow, wide = (OverturningSpectrum(lanes, Uncertainty(factor=one)).factors(block) for one in (0.05, 0.3))
    assert wide.factor_10 < narrow.factor_10
    assert wide.factor_50_low < wide.factor_50 < wide.factor_50_high


def test_a_range_of_restitution_takes_the_place_of_the_shares(spectrum):
    block = Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.9, log=False)
    own, same = spectrum.factors(block), spectrum.factors(block, least=[0.81], most=[0.9])
    assert own.capacity_mean == pytest.approx(same.capacity_mean)
    lively = spectrum.factors(block, least=[0.9], most=[0.99])
    assert lively.capacity_mean < own.capacity_mean


def test_factor_beyond_the_largest_one_is_not_reached(spectrum):
    block = Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.9, log=False)
    free = spectrum.factors(block)
    limit = 0.5 * (free.factor_10[0] + free.factor_50[0])
    read = spectrum.factors(block, factor_max=limit)
    assert read.factor_10 == free.factor_10
    assert np.isinf(read.factor_50)
    assert read.factor_50_low == min(limit, free.factor_50_low[0])
    assert read.at_one == free.at_one


def test_the_interval_holds_the_error_of_the_interpolation(spectrum):
    read = spectrum.factors(Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.9, log=False))
    for name in ("factor_10", "factor_50", "capacity_mean"):
        value, low, high = (getattr(read, name + end)[0] for end in ("", "_low", "_high"))
        assert min(math.log(value / low), math.log(high / value)) >= TWO_SIDED * INTERPOLATION * (1.0 - 1e-9)


def test_the_variance_of_a_probability_is_that_of_a_weighted_share(spectrum):
    """The sum of b^2 (o - s)^2 over (sum of b)^2, for lanes of weight b that overturn (o = 1) or not; s their share."""
    lanes, logs = spectrum.lanes, np.log(spectrum.level)
    bells = lane_bells(lanes.log_x[0], lanes.weight[0], logs, spectrum.uncertainty)
    bells *= ((lanes.restitution[0] >= 0.8) & (lanes.restitution[0] <= 0.9))[:, np.newaxis]
    over, whole = np.isinf(lanes.peak[0])[:, np.newaxis], np.sum(bells, axis=0)
    below, above = tail_masses(lanes.bottom[0], lanes.top[0], logs, spectrum.uncertainty)
    share = np.sum(bells * over, axis=0) / whole
    variance = (1.0 - below - above) ** 2 * np.sum(bells**2 * (over - share) ** 2, axis=0) / whole**2
    probability, found = spectrum._at[0].overturning(np.array([0.8]), np.array([0.9]))
    middle = (probability[0] > 0.05) & (probability[0] < 0.95)
    assert np.count_nonzero(middle) > 5
    assert probability[0, middle] == pytest.approx(((1.0 - below - above) * share + above)[middle])
    assert found[0, middle] == pytest.approx(variance[middle])


@pytest.mark.parametrize("p", [(1.5, 1.7), (1.7, 1.5)])
def test_blocks_asked_for_together_have_the_factors_of_each_alone(spectrum, p):
    both = vars(spectrum.factors(Block.from_parameters(p=p, alpha=0.1, restitution=0.9, log=False)))
    for place, one in enumerate(p):
        alone = vars(spectrum.factors(Block.from_parameters(p=[one], alpha=0.1, restitution=0.9, log=False)))
        assert {name: values[place] for name, values in both.items()} == pytest.approx(
            {name: values[0] for name, values in alone.items()}, rel=1e-12
        )


def test_errors_of_the_mean_capacity_go_together_as_far_as_their_levels_share_lanes(spectrum):
    """The variance of a sum over the levels k, with the correlation exp(-(d/(2 s))^2) of two d apart in ln x."""
    block = Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.9, log=False)
    read, error = spectrum.factors(block), spectrum._of_blocks(block, None, None)[1][0]
    logs = np.log(spectrum.level)
    together = np.exp(-((np.subtract.outer(logs, logs) / (2.0 * spectrum.uncertainty.spread)) ** 2))
    deviation = math.sqrt(error @ together @ error) * (logs[1] - logs[0])
    width = TWO_SIDED * math.hypot(deviation, INTERPOLATION)
    assert np.log(read.capacity_mean_high / read.capacity_mean) == pytest.approx([width])
    assert np.log(read.capacity_mean / read.capacity_mean_low) == pytest.approx([width])
    assert deviation > 0.3 * INTERPOLATION


def test_blocks_that_the_spectrum_does_not_stand_for(spectrum):
    blocks = Block.from_parameters(
        p=[1.6, 1.6, 3.0, 1.6], alpha=[0.1, 0.4, 0.1, 0.1], restitution=[0.9, 0.8, 0.9, 0.5], log=False
    )
    covered = spectrum.covers(blocks, 0.9 * blocks.restitution, blocks.restitution)
    assert covered.tolist() == [True, False, False, False]
    with pytest.raises(ValueError, match=r"not for 3 of 4, the first one at place 1"):
        spectrum.factors(blocks)


def test_the_ends_of_what_is_covered_belong_to_it_within_rounding():
    least, most = np.array([0.675, 0.675 * (1.0 - 1e-8), 0.9, 0.9]), np.array([0.9, 0.9, 1.0, 1.0 + 1e-8])
    assert covered_range(least, most).tolist() == [True, False, True, False]
    p = np.array([0.5, 0.5 * (1.0 - 1e-8), 8.0, 8.0 * (1.0 + 1e-8)])
    blocks = Block.from_parameters(p=p, alpha=0.1, restitution=0.9, log=False)
    assert slender_within(blocks, np.array([0.5, 8.0])).tolist() == [True, False, True, False]
    slender = np.array([3.5, 3.5 * (1.0 - 1e-8)])
    blocks = Block.from_parameters(p=1.0, alpha=np.arctan(1.0 / slender), restitution=0.9, log=False)
    assert slender_within(blocks, np.array([0.5, 8.0])).tolist() == [True, False]


def test_a_range_too_narrow_for_the_lanes_is_not_covered(spectrum):
    block = Block.from_parameters(p=[1.6, 1.6], alpha=0.1, restitution=0.9, log=False)
    assert spectrum.covers(block, np.array([0.9, 0.87]), np.array([0.9, 0.9])).tolist() == [False, True]
    exact = OverturningSpectrum(spectrum.lanes, Uncertainty(restitution=(1.0, 1.0)))
    with pytest.raises(ValueError, match=r"at least 0\.029 apart"):
        exact.spectrum([0.9])


@pytest.mark.parametrize("restitution", [0.7, 1.2])
def test_restitution_outside_the_lanes(spectrum, restitution):
    with pytest.raises(ValueError, match="nominal C"):
        spectrum.spectrum([restitution])


def test_rotation_must_be_positive(spectrum):
    with pytest.raises(ValueError, match="rotation"):
        spectrum.probability([0.9], rotation=0.0)
