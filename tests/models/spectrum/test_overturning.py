"""The overturning spectrum against pulses with known capacities, exact similarities and lanes of a body's own."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from rocking import Block, OverturningSpectrum, Tie, Uncertainty, critical_scale, overturning_probability
from rocking.spectrum.overturning import OverturningFactors, covered, covered_range, slender_within
from rocking.spectrum.probability import NO_LANE, factor_at, mean_capacity, rising
from rocking.spectrum.slender_lanes import BEYOND, SpectrumLanes, spectrum_lanes
from synthetic import synthetic_motion

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


def test_verdicts_alone_give_the_same_spectrum_and_no_rotations(spectrum):
    verdicts = OverturningSpectrum(spectrum_lanes(MOTION, DT, P, rotations=False))
    assert np.array_equal(verdicts.spectrum([0.8, 0.95]), spectrum.spectrum([0.8, 0.95]))
    with pytest.raises(ValueError, match=r"rotation: expected inf, .*, got 0.5"):
        verdicts.spectrum([0.8], rotation=0.5)


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
    read = OverturningSpectrum(spectrum_lanes(motion, DT, P, second=1600), wide).factors(block)
    assert read.factor_mean == pytest.approx(capacity, rel=0.01)
    assert read.factor_50 == pytest.approx(capacity, rel=0.01)
    assert np.log(read.factor_10 / capacity) == pytest.approx(-1.2816 * 0.05, abs=0.012)
    assert read.at_one == pytest.approx(ndtr(-np.log(capacity) / 0.05), abs=0.03)


@pytest.mark.parametrize("nominal", [0.9, 0.985])
def test_bodies_whose_restitution_may_exceed_1_have_no_other_error_than_others(nominal):
    """P of the spectrum against samples of each body, at the frequency parameters of the spectrum."""
    block = Block.from_parameters(p=P, alpha=0.08, restitution=nominal, log=False)
    factor = np.geomspace(0.2, 2.0, 40)
    errors = []
    for seed in range(4):
        motion = synthetic_motion(seed, pga=4.0)[:2000]
        spectrum = OverturningSpectrum(spectrum_lanes(motion, DT, P, rotations=False, second=6400))
        own = overturning_probability(block, motion, DT, factor_max=1e3)
        every = np.outer(np.ones(P.size), factor)
        errors.append(spectrum.overturning(block, every) - own.overturning(every))
    assert abs(np.mean(errors)) < 0.006


def test_a_record_twice_as_strong_has_twice_the_spectrum(spectrum):
    twice = spectrum_of(2.0 * MOTION).spectrum([0.85, 0.95])
    assert twice / spectrum.spectrum([0.85, 0.95]) == pytest.approx(np.full((2, 2), 2.0), rel=ONE_LANE)


def test_time_and_size_stretched_together(spectrum):
    """phi'' = phi - s - (x/p) a_g(tau/p): twice the time at half the p is the same motion at half the x."""
    stretched = spectrum_of(MOTION, 0.5 * P, dt=2.0 * DT).spectrum([0.85, 0.95])
    assert stretched / spectrum.spectrum([0.85, 0.95]) == pytest.approx(np.full((2, 2), 2.0), rel=ONE_LANE)


def test_blocks_that_the_spectrum_does_not_stand_for(spectrum):
    blocks = Block.from_parameters(
        p=[1.6, 1.6, 3.0, 1.6], alpha=[0.1, 0.4, 0.1, 0.1], restitution=[0.9, 0.8, 0.9, 0.5], log=False
    )
    assert spectrum.covers(blocks).tolist() == [True, False, False, False]
    with pytest.raises(ValueError, match=r"not to 3 of 4 blocks, the first at index 1"):
        spectrum.factors(blocks)


def test_the_ends_of_what_is_covered_belong_to_it_within_rounding():
    least, lower = np.array([0.7125, 0.7125 * (1.0 - 1e-8)]), Uncertainty(restitution=(1.0, 1.1))
    assert covered_range(least, lower).tolist() == [True, False]
    most = np.array([0.55, 0.55 * (1.0 + 1e-8)])
    assert covered_range(most, Uncertainty(restitution=(0.9, 1.0)), (0.25, 0.55)).tolist() == [True, False]
    # What lies above 1 counts as 1, which is inside; not if all of it lies there.
    assert covered_range([1.0, 1.05, 1.06], Uncertainty()).tolist() == [True, True, False]
    p = np.array([0.5, 0.5 * (1.0 - 1e-8), 8.0, 8.0 * (1.0 + 1e-8)])
    blocks = Block.from_parameters(p=p, alpha=0.1, restitution=0.9, log=False)
    assert slender_within(blocks, np.array([0.5, 8.0])).tolist() == [True, False, True, False]
    slender = np.array([3.5, 3.5 * (1.0 - 1e-8)])
    blocks = Block.from_parameters(p=1.0, alpha=np.arctan(1.0 / slender), restitution=0.9, log=False)
    assert slender_within(blocks, np.array([0.5, 8.0])).tolist() == [True, False]


def test_a_range_too_narrow_for_the_lanes_and_measured_values_are_not_covered(spectrum):
    """0.09 of the range of the lanes, 0.2875, are 0.0259."""
    block = Block.from_parameters(p=[1.6], alpha=0.1, restitution=0.9, log=False)
    for shares, expected in (
        ((1.0, 1.0), False),
        ((0.9713, 1.0), False),
        ((0.9711, 1.0), True),
        ((0.9, 0.95, 1.0), False),
    ):
        own = OverturningSpectrum(spectrum.lanes, Uncertainty(restitution=shares))
        assert own.covers(block).tolist() == [expected]
        if not expected:
            with pytest.raises(ValueError, match=r"at least 0\.026 apart"):
                own.spectrum([0.9])


@pytest.mark.parametrize("restitution", [0.7, 1.2])
def test_restitution_outside_the_lanes(spectrum, restitution):
    with pytest.raises(ValueError, match="nominal C"):
        spectrum.spectrum([restitution])


def test_rotation_must_be_positive(spectrum):
    with pytest.raises(ValueError, match="rotation"):
        spectrum.probability([0.9], rotation=0.0)


#: Uncertainties of the spectra of the lanes made by hand: restitutions below 1, and above it in part.
KNOWN = Uncertainty(factor=0.08, restitution=(0.85, 0.95), geometry=0.06)
ABOVE = Uncertainty(factor=0.08, restitution=(0.85, 1.15), geometry=0.06)


@pytest.fixture(scope="module", params=[KNOWN, ABOVE], ids=["below", "above"])
def by_hand(request):
    """Few lanes of uneven weight at three frequency parameters, each from and to an x of its own."""
    rng = np.random.default_rng(8)
    p, bottom, top = np.array([1.0, 1.3, 2.0]), np.array([-1.01, -0.83, -0.41]), np.array([1.02, 0.77, 1.31])
    restitution = np.sort(rng.uniform(0.675, BEYOND, (3, 60)), axis=1)
    restitution[0, 20], restitution[2, 50] = 0.85 * 0.93, 0.95 * 0.93
    log_x = bottom[:, np.newaxis] + (top - bottom)[:, np.newaxis] * rng.random((3, 60))
    weight = (top - bottom)[:, np.newaxis] / 60 * rng.uniform(0.5, 2.0, (3, 60))
    over = rng.random((3, 60)) < ndtr((log_x - np.array([[-0.2], [-0.1], [0.4]])) / 0.3)
    peak = np.where(over, np.inf, rng.uniform(0.1, 1.2, (3, 60)))
    peak[1, np.flatnonzero(~over[1])[7]] = 0.7
    lanes = SpectrumLanes(p, log_x, np.sort(restitution, axis=1), weight, peak, bottom, top, (0.675, 1.0))
    return OverturningSpectrum(lanes, request.param)


def lane_by_lane(spectrum, place, least, most, rotation=np.inf):
    """P and its variance at the levels, (k,) each, from the lanes of one p with a restitution from least to most."""
    lanes, known, found = spectrum.lanes, spectrum.uncertainty, []
    columns = (lanes.log_x, lanes.weight, lanes.restitution, lanes.peak)
    rows = zip(*(one[place] for one in columns), strict=True)
    own = [(t, w, peak >= rotation) for t, w, c, peak in rows if least <= c <= most]
    for level in np.log(spectrum.level):
        heights = known.density(np.array([t - level for t, _, _ in own])).tolist()
        counts = [(w * height, over) for height, (_, w, over) in zip(heights, own, strict=True)]
        whole = sum(b for b, _ in counts)
        seen = whole > NO_LANE
        share = sum(b for b, over in counts if over) / whole if seen else 0.0
        variance = sum((b * (over - share)) ** 2 for b, over in counts) / whole**2 if seen else 0.0
        below, above = (
            float(known.below(lanes.bottom[place] - level)),
            1.0 - float(known.below(lanes.top[place] - level)),
        )
        inside = 1.0 - below - above
        found.append((inside * share + above, inside**2 * variance))
    return np.array(found).T


#: Of the blocks: at the ends of the p of the lanes and one rounding outside, at one between and among them.
BLOCKS = Block.from_parameters(
    p=[1.0, 1.15, 1.3, 1.9, 2.0, 2.0 * (1.0 + 5e-10)],
    alpha=[0.2, 0.1, 0.15, 0.2, 0.25, 0.05],
    restitution=[0.93, 0.92, 0.9, 0.87, 0.95, 0.97],
    log=False,
)


def of_nominal(spectrum, place, nominal, rotation=np.inf):
    """P and its variance (k,) at one p for a nominal C: what lies above 1 of its range has the lanes above 1."""
    least, most = (share * nominal for share in spectrum.uncertainty.restitution)
    over = max(most - 1.0, 0.0) / (most - least)
    inside, variance = lane_by_lane(spectrum, place, least, min(most, 1.0), rotation)
    if over == 0.0:
        return inside, variance
    at_one, its_variance = lane_by_lane(spectrum, place, 1.0, BEYOND, rotation)
    return (1.0 - over) * inside + over * at_one, (1.0 - over) ** 2 * variance + over**2 * its_variance


def interpolated(spectrum, p, nominal):
    """P (k,) of one block and its standard error: linear in ln p between the two frequency parameters beside it."""
    above = 1 if p <= 1.3 else 2
    ends = spectrum.p[above - 1 : above + 1]
    share = min(math.log(p / ends[0]) / math.log(ends[1] / ends[0]), 1.0)
    low, high = (of_nominal(spectrum, place, nominal) for place in (above - 1, above))
    return (1.0 - share) * low[0] + share * high[0], np.sqrt((1.0 - share) ** 2 * low[1] + share**2 * high[1])


@pytest.mark.sweep
def test_the_factors_of_a_block_are_those_of_its_lanes_added_one_by_one(by_hand):
    found = by_hand.factors(BLOCKS)
    levels = np.log(by_hand.level)
    step = levels[1] - levels[0]
    alike = np.exp(-(np.subtract.outer(levels, levels) ** 2) / (2.0 * by_hand.uncertainty.spread) ** 2)
    asked = np.exp(np.linspace(-4.0, 4.0, 33))
    overturning = by_hand.overturning(BLOCKS, np.outer(np.ones(6), asked))
    for place in range(6):
        block = BLOCKS.lane(place)
        speed = block.gravity * math.tan(block.alpha_c) / block.p
        probability, error = interpolated(by_hand, block.p, block.restitution)
        upper = np.maximum.accumulate(np.minimum(probability + 1.6448536 * error, 1.0))
        lower = np.minimum.accumulate(np.maximum(probability - 1.6448536 * error, 0.0)[::-1])[::-1]
        fitted = rising(probability)
        ones = [np.interp(-math.log(speed), levels, one) for one in (probability, lower, upper)]
        expected = dict(zip(("at_one", "at_one_low", "at_one_high"), ones, strict=True))
        of_mean = step * math.sqrt(error @ alike @ error)
        mean = float(mean_capacity(by_hand.level, probability)) * speed
        widths = {"factor_mean": (mean, 1.6448536 * of_mean, 1.6448536 * of_mean)}
        for name, share in (("factor_10", 0.1), ("factor_50", 0.5)):
            value, early, late = (float(factor_at(share, by_hand.level, one)) for one in (fitted, upper, lower))
            widths[name] = value * speed, math.log(value / early), math.log(late / value)
        for name, (value, below, above) in widths.items():
            expected[name] = value
            expected[f"{name}_low"] = value * math.exp(-math.hypot(below, 1.6448536 * 0.02))
            expected[f"{name}_high"] = value * math.exp(math.hypot(above, 1.6448536 * 0.02))
        assert {name: values[place] for name, values in vars(found).items()} == pytest.approx(expected, rel=1e-6)
        assert overturning[place] == pytest.approx(np.interp(np.log(asked / speed), levels, probability), abs=1e-7)


@pytest.mark.parametrize("rotation", [0.3, 0.7, np.inf])
def test_the_probability_of_a_limit_state_is_that_of_its_lanes_added_one_by_one(by_hand, rotation):
    nominal = np.array([0.93, 0.97])
    found = by_hand.probability(nominal, rotation)
    for place in range(3):
        for row, one in enumerate(nominal):
            expected, _ = of_nominal(by_hand, place, one, rotation)
            assert found[place, row] == pytest.approx(expected, abs=1e-7)
    assert by_hand.spectrum(nominal, rotation) == pytest.approx(1.0 / mean_capacity(by_hand.level, found))
    assert by_hand.spectrum(0.93, rotation)[:, 0].tolist() == by_hand.spectrum(nominal, rotation)[:, 0].tolist()


def test_a_spectrum_of_one_frequency_parameter_stands_for_it_alone(by_hand):
    lanes = by_hand.lanes
    columns = (lanes.p, lanes.log_x, lanes.restitution, lanes.weight, lanes.peak, lanes.bottom, lanes.top)
    one = OverturningSpectrum(SpectrumLanes(*(values[1:2] for values in columns), lanes.between), by_hand.uncertainty)
    blocks = BLOCKS.take(np.array([2, 3]))
    assert one.covers(blocks).tolist() == [True, False]
    alone, among = vars(one.factors(blocks.lane(0).lanes(1))), vars(by_hand.factors(blocks.lane(0).lanes(1)))
    assert {name: values[0] for name, values in alone.items()} == pytest.approx(
        {name: values[0] for name, values in among.items()}, rel=1e-6
    )


def test_only_factors_above_the_largest_one_are_not_reached():
    """Of two blocks: the largest factor asked for is just reached by what equals it."""
    names = ("at_one", "factor_10", "factor_50", "factor_mean")
    values = {name: np.array([0.2, 3.0]) + 2.0 * k for k, name in enumerate(names)}
    both = OverturningFactors(
        **values,
        **{f"{name}_low": 0.5 * one for name, one in values.items()},
        **{f"{name}_high": 2.0 * one for name, one in values.items()},
    )
    found = both.up_to(5.0)
    for name in ("at_one", "at_one_low", "at_one_high"):
        assert getattr(found, name).tolist() == getattr(both, name).tolist()
    assert (found.factor_10.tolist(), found.factor_50.tolist()) == ([2.2, 5.0], [4.2, np.inf])
    assert found.factor_mean.tolist() == [np.inf, np.inf]
    assert found.factor_10_low.tolist() == [1.1, 2.5]
    assert (found.factor_50_low.tolist(), found.factor_mean_low.tolist()) == ([2.1, 3.5], [3.1, 4.5])
    assert (found.factor_10_high.tolist(), both.up_to(10.0).factor_10_high.tolist()) == ([4.4, np.inf], [4.4, 10.0])


def test_only_free_bodies_alike_on_both_sides_or_those_before_a_wall_are_covered():
    """Of a restitution of 0.9, but for a rebound of 0.4."""
    free, wide = (Block(half_width=0.3, half_height=a, restitution=0.9, log=False).lanes(1) for a in (1.5, 0.9))
    leaning = Block(0.6, 3.0, restitution=0.9, offset=0.02, log=False).lanes(1)
    tied = Block(
        half_width=0.3, half_height=1.5, restitution=0.9, mass=1000.0, ties=[Tie(height=1.0, stiffness=1e5)], log=False
    ).lanes(1)
    wall = Block(0.6, 3.0, rebound=0.4, one_sided=True, log=False).lanes(1)
    skewed = Block(0.6, 3.0, rebound=0.4, one_sided=True, offset=0.02, log=False).lanes(1)
    known = Uncertainty()
    assert [covered(one, known).tolist() for one in (free, wide, leaning, tied, wall)] == [
        [True], [False], [False], [False], [False]
    ]  # fmt: skip
    for one, side, expected in (
        (wall, 1, True),
        (skewed, 1, True),
        (wall, -1, False),
        (free, 1, False),
        (wall, 0, False),
    ):
        assert covered(one, known, between=(0.25, 0.55), side=side).tolist() == [expected]


def test_a_wide_loss_of_angle_leaves_every_error_finite(by_hand):
    """The shift hardly goes below zero then: at the highest levels no mass of it is left inside the lanes."""
    wide = OverturningSpectrum(by_hand.lanes, Uncertainty(factor=0.02, restitution=(0.85, 0.95), geometry=0.3))
    found = wide.factors(BLOCKS)
    for name in ("at_one", "factor_10", "factor_50", "factor_mean"):
        low, value, high = (getattr(found, f"{name}{end}") for end in ("_low", "", "_high"))
        assert np.all((low <= value) & (value <= high) & (high < np.inf))


def test_limits_of_restitution_may_be_given_as_a_list(by_hand):
    listed = OverturningSpectrum(by_hand.lanes, Uncertainty(restitution=list(by_hand.uncertainty.restitution)))
    plain = OverturningSpectrum(by_hand.lanes, Uncertainty(restitution=by_hand.uncertainty.restitution))
    assert listed.factors(BLOCKS).factor_10.tolist() == plain.factors(BLOCKS).factor_10.tolist()
