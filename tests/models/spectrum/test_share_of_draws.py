"""P is the share of draws that overturn at every factor: safe windows, exact symmetries, distributions of C."""

import numpy as np
import pytest

from rocking import Block, Outcome, Uncertainty, recorded_response
from rocking.spectrum.body_probability import overturning_probability
from rocking.spectrum.probability import rising
from rocking.spectrum.slender_lanes import spectrum_lanes

DT = 0.01
#: One sine of 0.6 s and 1 m/s2: between two ranges of factors that overturn the slab it survives.
SINE = np.append(np.sin(2.0 * np.pi * np.arange(61) * DT / 0.6), np.zeros(20))
SLAB = Block(half_width=0.06, half_height=1.2, restitution=0.85, log=False)
DRAWS = 4096
LIMIT_OR_EQUATION = pytest.mark.parametrize("limit", [True, False], ids=["slender limit", "nonlinear"])


def values(found):
    return np.array([found.at_one, found.factor_10, found.factor_50, found.factor_mean])


def share_of_draws(block, factors, known):
    """Share of plain draws of factor, C and alpha that the nonlinear equation overturns at each factor."""
    random = np.random.default_rng(1)
    loss = np.abs(random.standard_normal((len(factors), DRAWS)))
    lanes = Block.from_parameters(
        p=np.full(loss.size, block.p),
        alpha=block.alpha_c * np.exp(-known.geometry * loss.ravel()),
        restitution=np.minimum(block.restitution * random.uniform(*known.restitution, loss.size), 0.999),
        log=False,
    )
    strength = np.multiply.outer(factors, np.exp(known.factor * random.standard_normal(DRAWS))).ravel()
    outcome = recorded_response(lanes, SINE, DT, block_scale=strength).outcome.reshape(loss.shape)
    return np.mean(outcome == Outcome.OVERTURNS, axis=1)


@pytest.mark.sweep
@LIMIT_OR_EQUATION
def test_in_a_safe_window_p_is_the_share_of_draws_and_no_fit_of_it(limit):
    """Four binomial standard errors of 4096 draws; P falls from 0.94 to 0.5 and the fit that never falls is 0.78."""
    found = overturning_probability(SLAB, SINE, DT, factor_max=10.0, slender_limit=limit)
    factors = np.array([1.38, 2.41, 2.61])
    (read,), share = found.overturning([factors]), share_of_draws(SLAB, factors, Uncertainty())
    error = np.sqrt(share * (1.0 - share) / DRAWS)
    assert np.all(np.abs(read - share) < 4.0 * error)
    fitted = np.interp(np.log(factors), np.log(found.level), rising(found.probability[0]))
    assert np.all(np.abs(fitted - share) > 10.0 * error)
    assert found.slender.tolist() == [limit]


@pytest.mark.sweep
@LIMIT_OR_EQUATION
def test_lengths_four_times_and_times_twice_as_large_have_the_same_probability(limit):
    """The accelerations are the same, and so is p t."""
    large = Block.from_parameters(0.5 * SLAB.p, SLAB.alpha_c, SLAB.restitution, log=False)
    one, other = (
        overturning_probability(block, 1.1 * SINE, dt, slender_limit=limit)
        for block, dt in ((SLAB, DT), (large, 2.0 * DT))
    )
    assert values(other) == pytest.approx(values(one), rel=1e-9)
    assert 0.05 < one.at_one[0] < 0.95
    assert other.level == pytest.approx(one.level)
    assert other.probability == pytest.approx(one.probability, rel=1e-9, abs=1e-12)


@LIMIT_OR_EQUATION
def test_the_mirror_image_of_a_record_has_the_same_probability(limit):
    one, other = (overturning_probability(SLAB, sign * SINE, DT, slender_limit=limit) for sign in (1.0, -1.0))
    assert np.array_equal(values(one), values(other))
    assert np.array_equal(one.probability, other.probability)


@LIMIT_OR_EQUATION
def test_restitutions_above_1_count_as_1(limit):
    lively = Block.from_parameters(SLAB.p, SLAB.alpha_c, 0.98, log=False)
    one, other, below = (
        overturning_probability(lively, SINE, DT, Uncertainty(restitution=ends), slender_limit=limit)
        for ends in ((1.03, 1.04), (1.5, 2.0), (0.7, 0.71))
    )
    assert np.array_equal(values(one), values(other))
    assert below.factor_mean[0] > one.factor_mean[0]


@pytest.mark.sweep
@LIMIT_OR_EQUATION
def test_measured_restitutions_are_followed(limit):
    """A value that was measured twice or thrice is that value; half of each of two have the mean of both."""

    def of(*shares):
        return overturning_probability(SLAB, SINE, DT, Uncertainty(restitution=shares), slender_limit=limit)

    assert np.array_equal(values(of(0.9, 0.9, 0.9)), values(of(0.9, 0.9)))
    # Evenly spaced values are a uniform distribution.
    assert values(of(1.1, 0.9, 1.0)) == pytest.approx(values(of(0.9, 1.1)), rel=1e-9)
    factors = np.array([[1.2, 1.4, 2.0, 2.4, 2.8]])
    halves = of(*[0.9] * 50, *[1.1] * 50).overturning(factors)
    apart = [of(share, share).overturning(factors) for share in (0.9, 1.1)]
    assert halves == pytest.approx(np.mean(apart, axis=0), abs=0.05)
    assert np.max(np.abs(apart[0] - apart[1])) > 0.3


@pytest.mark.parametrize("side", [0, 1])
def test_what_falls_back_after_the_end_of_a_record_is_followed_on_the_still_ground(side):
    """A sine that ends while blocks swing back fast: a rest of three seconds after it changes no outcome."""
    cut, whole = (spectrum_lanes(np.append(SINE[:61], np.zeros(rest)), DT, [1.7, 3.0], side=side) for rest in (1, 300))
    assert np.array_equal(cut.log_x, whole.log_x)
    over = np.isinf(whole.peak)
    assert np.array_equal(np.isinf(cut.peak), over)
    assert cut.peak[~over] == pytest.approx(whole.peak[~over], rel=1e-6, abs=1e-6)
    assert 0.1 < np.mean(over) < 0.9
