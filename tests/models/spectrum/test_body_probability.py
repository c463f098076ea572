"""The probability of overturning by lanes of a body's own: lane by lane, closed forms, symmetries."""

from dataclasses import fields
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import ndtr

from rocking import Block, Outcome, critical_scale, recorded_response
from rocking.spectrum.body_lanes import BodyLanes, LaneMarch, probability_lanes
from rocking.spectrum.body_probability import LEVEL_STEP, _counts, lane_factors, overturning_probability
from rocking.spectrum.probability import Uncertainty, factor_at, mean_capacity, rising

#: Shift of ln f with a standard deviation of 0.1.
NORMAL = Uncertainty(factor=0.1, geometry=0.0)


@pytest.mark.parametrize("over", [False, True])
def test_lanes_that_agree_leave_a_twentieth_to_the_other_answer(over):
    """n like answers have 0.05^(1/n) as the lower end of their share, and n is the effective number of lanes.

    The lanes lie between -1 and 1 standard deviations: what is above them overturns, what is below them stands.
    """
    logs = np.linspace(-0.1, 0.1, 41)
    every = np.full(41, over)
    lanes = BodyLanes(logs, np.full(41, 0.005), every, np.zeros(41, dtype=bool), -0.1, 0.1, open=False)
    found = lane_factors(lanes, NORMAL, 0.6, 10.0).found
    above, inside = ndtr(-1.0), ndtr(1.0) - ndtr(-1.0)
    bells = np.exp(-0.5 * (logs / 0.1) ** 2)
    sure = 0.05 ** (np.sum(bells**2) / np.sum(bells) ** 2)
    if over:
        expected = (above + inside * sure, above + inside, above + inside)
    else:
        expected = (above, above, above + inside * (1.0 - sure))
    assert [found[f"at_one{end}"] for end in ("_low", "", "_high")] == pytest.approx(expected, abs=1e-9)


#: Lanes between these ln f, of an uneven weight; verdicts are mixed from -0.3 to 0.4.
BOTTOM, TOP, REACH = -0.85, 0.95, 0.35


def mixed_lanes(still_open=False):
    rng = np.random.default_rng(4)
    logs, weight = rng.uniform(BOTTOM, TOP, 50), rng.uniform(0.4, 1.6, 50) * (TOP - BOTTOM) / 50
    over = rng.random(50) < np.clip((logs + 0.3) / 0.7, 0.0, 1.0)
    return BodyLanes(logs, weight, over, np.zeros(50, dtype=bool), BOTTOM, TOP, still_open)


def lane_by_lane(lanes, times, level):
    """P at one ln f, where lane i is counted so many times."""
    counts = lanes.weight * NORMAL.density(lanes.log_factor - level) * times
    share = sum(counts[lanes.over]) / sum(counts)
    above = 1.0 - NORMAL.below(TOP - level)
    return (1.0 - above - NORMAL.below(BOTTOM - level)) * share + above


def ends(name, values):
    """The first one, and the 10th from below and from above of the 200 others: a twentieth lies outside of each."""
    low, high = np.sort(values[1:])[[9, 190]]
    return {name: values[0], f"{name}_low": low, f"{name}_high": high}


@pytest.mark.sweep
@pytest.mark.parametrize("still_open", [False, True])
def test_the_factors_of_a_body_are_those_of_its_lanes_added_one_by_one(still_open):
    lanes = mixed_lanes(still_open)
    read = lane_factors(lanes, NORMAL, REACH, 1e3)
    lowest, highest = min(lanes.log_factor[lanes.over]), max(lanes.log_factor[~lanes.over])
    end = TOP - REACH if still_open else highest + REACH
    # The levels next to where nothing has overturned yet and where all have, multiples of 0.04.
    assert 0.04 * read.first <= lowest - REACH < 0.04 * (read.first + 1)
    assert 0.04 * (read.first + read.probability.size - 2) < end <= 0.04 * (read.first + read.probability.size - 1)
    logs = 0.04 * np.arange(read.first, read.first + read.probability.size)
    rows = np.array([[lane_by_lane(lanes, times, level) for level in logs] for times in _counts(50)])
    # P is the share as it is; the factors are read from a fit that never falls.
    assert read.probability == pytest.approx(rows[0], abs=1e-12)
    expected = ends("at_one", rows[:, -read.first])
    expected |= ends("factor_10", factor_at(0.1, np.exp(logs), rising(rows)))
    expected |= ends("factor_50", factor_at(0.5, np.exp(logs), rising(rows)))
    if still_open:
        areas = [sum(0.04 * (1.0 - 0.5 * (a + b)) for a, b in pairwise(row)) for row in rows]
        least = ends("least", np.exp(logs[0] + np.array(areas)))["least_low"]
        expected |= {"factor_mean": np.inf, "factor_mean_low": least, "factor_mean_high": np.inf}
    else:
        expected |= ends("factor_mean", mean_capacity(np.exp(logs), rows))
    assert read.found == pytest.approx(expected, rel=1e-9)
    shown = read.at(np.array([read.first - 3, read.first - 1, read.first, read.first + 5, read.first + 500]))
    assert shown.tolist() == [0.0, 0.0, read.probability[0], read.probability[5], read.probability[-1]]


def test_factors_above_the_largest_one_are_not_reached():
    lanes = mixed_lanes()
    free = lane_factors(lanes, NORMAL, REACH, 1e3).found
    limit = free["factor_50"]
    found = lane_factors(lanes, NORMAL, REACH, limit).found
    assert found["factor_50"] == limit
    assert found["factor_50_low"] == free["factor_50_low"] < limit
    assert found["factor_50_high"] == np.inf
    assert [found[name] for name in free if "10" in name or "at_one" in name] == [
        free[name] for name in free if "10" in name or "at_one" in name
    ]
    less = lane_factors(lanes, NORMAL, REACH, 0.9 * free["factor_10_low"]).found
    assert (less["factor_10"], less["factor_10_low"]) == (np.inf, 0.9 * free["factor_10_low"])


def test_a_body_that_nothing_lifts_never_overturns():
    found = lane_factors(None, NORMAL, REACH, 7.0)
    assert [found.found[f"at_one{end}"] for end in ("", "_low", "_high")] == [0.0, 0.0, 0.0]
    for name in ("factor_10", "factor_50", "factor_mean"):
        assert [found.found[f"{name}{end}"] for end in ("", "_low", "_high")] == [np.inf, 7.0, np.inf]
    assert found.at(np.array([-3, 0, 3])).tolist() == [0.0, 0.0, 0.0]


def edge_lanes(edge, bottom, top):
    """41 lanes that overturn above an edge."""
    logs = np.linspace(bottom, top, 41)
    return BodyLanes(logs, np.full(41, (top - bottom) / 41), logs > edge, np.zeros(41, dtype=bool), bottom, top, False)


@pytest.mark.parametrize(("edge", "first"), [(0.125, 0), (0.165, 1), (0.085, -1)])
def test_the_probability_at_one_is_zero_below_the_first_level(edge, first):
    """The first lane that overturns lies less than 0.01 above the edge, the first level 0.1 below it or more."""
    lanes = edge_lanes(edge, 0.0, 0.4)
    found = lane_factors(lanes, NORMAL, 0.1, 10.0)
    assert found.first == first
    assert (found.found["at_one"] > 0.0) == (first <= 0)
    assert found.found["at_one"] == (0.0 if first > 0 else found.probability[-first])
    assert (found.found["at_one_high"] > 0.0) == (first <= 0)


@pytest.mark.parametrize(("apart", "alone"), [(0.32, True), (0.29, False)])
@pytest.mark.parametrize("over", [False, True])
def test_lanes_that_count_less_than_a_hundredth_of_the_most_do_not_disagree(apart, alone, over):
    """exp(-x^2/2) is 0.01 at x = 3.03 standard deviations."""
    logs = np.append(np.linspace(-0.1, 0.1, 21), -apart if over else apart)
    verdicts = np.append(np.full(21, over), not over)
    lanes = BodyLanes(logs, np.full(22, 0.01), verdicts, np.zeros(22, dtype=bool), -0.5, 0.5, open=False)
    found = lane_factors(lanes, NORMAL, 0.6, 10.0).found
    bells = np.exp(-0.5 * (logs / 0.1) ** 2)
    sure = 0.05 ** (np.sum(bells**2) / np.sum(bells) ** 2)
    above = ndtr(-5.0)
    inside = 1.0 - 2.0 * above
    bound = inside * sure + above if over else inside * (1.0 - sure) + above
    assert (found["at_one_low" if over else "at_one_high"] == pytest.approx(bound, abs=1e-12)) == alone


DT = 0.01
PULSE = np.append(np.sin(np.linspace(0.0, np.pi, 51)), np.zeros(50))  # half a sine of 0.5 s, 1 m/s2
TRAIN = np.sin(2.0 * np.pi * np.arange(0.0, 4.005, DT)) * np.hanning(401)
WALL = Block(0.6, 2.4)
FACTOR_ONLY = Uncertainty(factor=0.1, restitution=(1.0, 1.0), geometry=0.0)
FACTORS = ("factor_10", "factor_50", "factor_mean")
NUMBERS = [f"{name}{end}" for name in ("at_one", *FACTORS) for end in ("", "_low", "_high")]


def values(found, names=NUMBERS):
    return np.array([getattr(found, name) for name in names])


@pytest.fixture(scope="module")
def one_edge():
    """The wall under the pulse: it overturns above one factor, and everywhere above it."""
    edges = critical_scale(WALL, PULSE, DT, factor_max=100.0)
    assert edges.count.tolist() == [1]
    assert edges.open[0]
    return float(edges.lower[0])


def test_one_edge_under_an_uncertain_factor_is_a_lognormal(one_edge):
    """The lanes know the edge to their distance, 0.005 of ln f."""
    found = overturning_probability(WALL, PULSE, DT, FACTOR_ONLY, factor_max=100.0)
    exact = ndtr(np.log(found.level / one_edge) / 0.1)
    assert np.allclose(found.probability[0], exact, atol=0.03)
    assert found.factor_50[0] == pytest.approx(one_edge, rel=0.006)
    assert found.factor_10[0] == pytest.approx(one_edge * np.exp(-0.1 * 1.2815516), rel=0.01)
    assert found.factor_mean[0] == pytest.approx(one_edge, rel=0.006)
    assert found.unresolved[0] == 0.0


def test_a_slender_body_of_uncertain_angle_has_the_skew_normal_shift(one_edge):
    """tan(alpha) in place of alpha moves the capacity by some per cent of the loss, which is 4 % in the mean."""
    known = Uncertainty(factor=0.1, restitution=(1.0, 1.0), geometry=0.05)
    found = overturning_probability(WALL, PULSE, DT, known, factor_max=100.0)
    exact = 1.0 - known.below(np.log(one_edge / found.level))
    assert np.allclose(found.probability[0], exact, atol=0.04)
    assert found.factor_50[0] < one_edge * 0.985


def test_a_squat_body_under_a_vertical_against_fresh_draws():
    """P at the factors of 10 and 50 %: 1500 draws of factor, C and alpha each, four standard errors and the lanes'."""
    block, up = Block(1.2, 2.0), -0.4 * np.cos(3.0 * np.pi * np.arange(TRAIN.size) * DT)
    found = overturning_probability(block, TRAIN, DT, vertical=up, factor_max=30.0)
    rng, known, n = np.random.default_rng(3), Uncertainty(), 1500
    lanes = Block.from_parameters(
        block.p,
        block.alpha_c * np.exp(-known.geometry * np.abs(rng.normal(size=n))),
        np.minimum(block.restitution * rng.uniform(0.95, 1.05, n), 0.999),
    )
    factors = np.exp(known.factor * rng.normal(size=n))
    for factor, share, error in ((found.factor_10[0], 0.1, 0.06), (found.factor_50[0], 0.5, 0.1)):
        outcome = recorded_response(lanes, TRAIN, DT, vertical=up, block_scale=factor * factors).outcome
        assert np.mean(outcome == Outcome.OVERTURNS) == pytest.approx(share, abs=error)


def test_free_flight_counts_as_overturning():
    """A vertical of 2 g leaves the ground from the factor 0.5 on, and no horizontal moves the block below it."""
    up = -2.0 * WALL.gravity * np.sin(np.linspace(0.0, np.pi, 101))
    found = overturning_probability(WALL, np.zeros(101), DT, vertical=up)
    assert np.allclose(found.probability[0], ndtr(np.log(found.level / 0.5) / 0.1), atol=1e-3)
    assert found.factor_50[0] == pytest.approx(0.5, rel=2e-3)
    assert found.unresolved[0] == 1.0


def test_a_vertical_of_zeros_is_none():
    """And the marches that end where their verdict is settled tell the same as whole ones."""
    blocks = Block(half_width=[0.3, 0.6], half_height=[1.2, 1.5])
    without = overturning_probability(blocks, TRAIN, DT, factor_max=30.0, slender_limit=False)
    assert np.array_equal(values(without), values(overturning_probability(blocks, TRAIN, DT, None, 0.0 * TRAIN, 30.0)))
    assert not without.slender.any()


def test_a_stronger_record_has_lower_factors():
    """By a step between levels, so that these fall on each other."""
    times = np.exp(20 * LEVEL_STEP)
    weak, strong = (
        overturning_probability(WALL, gain * TRAIN, DT, factor_max=100.0 / gain, seed=4) for gain in (1.0, times)
    )
    names = [name for name in NUMBERS if not name.startswith("at_one")]
    assert np.allclose(values(weak, names), times * values(strong, names), rtol=1e-6)
    at = np.argmin(abs(weak.level - times))
    assert weak.probability[0, at] == pytest.approx(strong.at_one[0], abs=1e-6)


def test_a_larger_body_of_the_same_shape_and_restitution_has_larger_factors():
    """As it does under each lane: P falls with the size (Yim, Chopra & Penzien 1980)."""
    sizes = np.array([0.5, 1.0, 2.0, 4.0])
    found = overturning_probability(Block(half_width=0.2 * sizes, half_height=sizes), PULSE, DT, factor_max=1000.0)
    for name in FACTORS:
        assert np.all(np.diff(getattr(found, name)) > 0.0)
    assert np.all(np.diff(found.probability, axis=0) <= 1e-4)  # no mass beyond four standard deviations is looked at


@pytest.mark.sweep
def test_the_draws_of_a_seed_are_the_same_and_those_of_another_one_are_not():
    """The lanes of slender bodies are a lattice without random numbers."""

    def of_seed(seed, **how):
        return overturning_probability(WALL, TRAIN, DT, factor_max=30.0, seed=seed, **how)

    first, again, other = (of_seed(one, slender_limit=False) for one in (1, 1, 2))
    assert np.array_equal(values(first), values(again))
    assert first.factor_50[0] != other.factor_50[0]
    assert other.factor_50[0] == pytest.approx(first.factor_50[0], rel=0.05)
    assert np.array_equal(values(of_seed(1)), values(of_seed(2)))


@pytest.mark.sweep
def test_a_body_has_the_same_answer_alone_among_others_and_on_any_threads():
    blocks = Block(half_width=[0.3, 0.1, 0.9], half_height=[1.2, 1.5, 1.5])
    together = overturning_probability(blocks, TRAIN, DT, factor_max=30.0, threads=2)
    assert np.array_equal(
        values(together), values(overturning_probability(blocks, TRAIN, DT, factor_max=30.0, threads=1))
    )
    for place in range(3):
        alone = overturning_probability(blocks.lane(place), TRAIN, DT, factor_max=30.0)
        assert np.array_equal(values(alone)[:, 0], values(together)[:, place])


@pytest.mark.parametrize("guess", [0.02, 1e4])
def test_a_poor_guess_costs_lanes_and_no_more(guess):
    found = overturning_probability(WALL, TRAIN, DT, factor_max=30.0, guess=guess, slender_limit=False)
    plain = overturning_probability(WALL, TRAIN, DT, factor_max=30.0, slender_limit=False)
    assert found.factor_50[0] == pytest.approx(plain.factor_50[0], rel=0.08)


def test_a_body_that_no_draw_lifts_stays():
    """Four standard deviations below the uplift of the weakest draw, 9.8 tan(alpha) = 2.45 times this record."""
    known = Uncertainty(geometry=0.0)
    stays = overturning_probability(WALL, PULSE, DT, known, factor_max=2.4519 * np.exp(-0.401))
    lifts = overturning_probability(WALL, PULSE, DT, known, factor_max=2.4519 * np.exp(-0.3))
    assert stays.at_one_high[0] == 0.0
    assert stays.factor_10_low[0] == pytest.approx(2.4519 * np.exp(-0.401))
    assert not np.any(stays.probability)
    assert lifts.factor_10[0] == np.inf  # it rocks there, and does not overturn


def test_a_factor_that_is_not_reached_is_at_least_the_largest():
    found = overturning_probability(WALL, PULSE, DT, FACTOR_ONLY, factor_max=3.0)
    assert values(found, [*FACTORS, *(f"{name}_high" for name in FACTORS)]).tolist() == [[np.inf]] * 6
    assert found.factor_10_low.tolist() == found.factor_50_low.tolist() == [3.0]
    assert found.factor_mean_low[0] == pytest.approx(3.0, rel=0.01)


def test_a_factor_that_is_reached_beside_one_that_is_not(one_edge):
    """Censored at the edge itself: half of the capacities lie above it."""
    found = overturning_probability(WALL, PULSE, DT, FACTOR_ONLY, factor_max=one_edge * 0.95)
    assert found.factor_10[0] == pytest.approx(one_edge * np.exp(-0.1 * 1.2815516), rel=0.01)
    assert found.factor_50[0] == np.inf
    assert found.level[-1] <= one_edge * 0.95
    assert found.factor_mean[0] == np.inf
    assert 0.85 * one_edge < found.factor_mean_low[0] <= 0.95 * one_edge


def test_a_body_that_bounces_without_loss_is_answered():
    """C = 1 is drawn as 0.999."""
    elastic = Block.from_parameters(WALL.p, WALL.alpha_c, 1.0, log=False)
    found = overturning_probability(elastic, TRAIN, DT, Uncertainty(restitution=(1.0, 1.0)), factor_max=30.0)
    assert 0.0 < found.factor_10[0] <= found.factor_50[0] < 30.0


def test_intervals_hold_their_value():
    found = overturning_probability(Block(half_width=[0.3, 0.1, 0.9], half_height=[1.2, 1.5, 1.5]), 5.0 * TRAIN, DT)
    for name in ("at_one", *FACTORS):
        low, value, high = (getattr(found, f"{name}{end}") for end in ("_low", "", "_high"))
        assert np.all(low <= value)
        assert np.all(value <= high)
    assert {one.name for one in fields(found)} == {*NUMBERS, "level", "probability", "slender", "unresolved"}


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"factor_max": 0.0}, "factor_max"),
        ({"guess": -1.0}, "guess"),
        ({"seed": -1}, "seed"),
        ({"vertical": np.zeros(3)}, "vertical"),
    ],
)
def test_an_argument_out_of_range_is_named(change, named):
    with pytest.raises(ValueError, match=named):
        overturning_probability(WALL, PULSE, DT, **change)


@pytest.mark.parametrize(("share", "expected"), [(0.5, True), (0.9, True), (10.0, False)])
def test_the_lanes_of_a_body_that_stands_at_the_largest_factor_are_open(one_edge, share, expected):
    body = Block(half_width=np.array([0.3]), half_height=np.array([1.2]))
    march = LaneMarch(body, PULSE, DT, None, FACTOR_ONLY, 1, 1)
    (found,) = probability_lanes(march, float(np.log(share * one_edge)))
    assert found.open == expected
    assert found.over.any() != expected


def test_levels_are_those_from_uplift_to_the_largest_factor():
    """From four scales of the shift below the uplift of a body that lost exp(-0.2) of its angle, or from 1."""
    uplift = np.log(9.80665 * np.tan(np.arctan(0.25) * np.exp(-0.2)))
    weak, strong = overturning_probability(WALL, PULSE, DT), overturning_probability(WALL, 5.0 * PULSE, DT)
    assert weak.level[0] == 1.0
    assert np.log(strong.level[0]) / 0.04 == pytest.approx(
        np.floor((uplift - np.log(5.0) - 4.0 * np.hypot(0.1, 0.05)) / 0.04)
    )
    # The largest factor is a level where it is one within rounding; 10 is none.
    assert np.log(weak.level[-1]) / 0.04 == pytest.approx(np.floor(np.log(10.0) / 0.04))
    least = overturning_probability(WALL, PULSE, DT, factor_max=np.exp(0.04 * 55) * (1.0 - 1e-11))
    assert np.log(least.level[-1]) / 0.04 == pytest.approx(55)
    # One is asked for, too, where the largest factor lies below it.
    assert overturning_probability(WALL, 5.0 * PULSE, DT, factor_max=0.5).level[-1] == 1.0
    assert overturning_probability(WALL, 1000.0 * PULSE, DT).level[-1] == 1.0


def test_probabilities_between_levels_are_linear_in_the_logarithm_of_the_factor():
    blocks = Block(half_width=[0.3, 0.2], half_height=[1.2, 1.2])
    found = overturning_probability(blocks, 2.0 * TRAIN, DT, factor_max=30.0)
    k = int(np.argmax(found.probability[1] > 0.3))
    low, high = np.log(found.level[k : k + 2])
    asked = np.exp([[low, 0.75 * low + 0.25 * high, high, 9.0], [low, 0.5 * low + 0.5 * high, high, -9.0]])
    read = found.overturning(asked)
    for row, share in ((0, 0.25), (1, 0.5)):
        one, two = found.probability[row, k : k + 2]
        assert read[row, :3] == pytest.approx([one, (1.0 - share) * one + share * two, two], rel=1e-9, abs=1e-12)
    assert read[0, 3] == found.probability[0, -1]
    assert read[1, 3] == 0.0
