"""The likelihood of censored peaks against closed forms and a plain maximisation."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import norm

from rockpulse.models import Block, Outcome
from rockpulse.sequences.response_search import SMALLEST_SPREAD, log_likelihood
from rockpulse.sequences.response_targets import ResponseTargets


def targets(numbers, overturned=0, small=0):
    peaks = np.concatenate([numbers, np.full(overturned, np.inf), np.full(small, 0.01)])
    outcomes = np.full(peaks.size, Outcome.ROCKS)
    outcomes[len(numbers) : len(numbers) + overturned] = Outcome.OVERTURNS
    return ResponseTargets(Block.from_parameters(np.full(peaks.size, 2.0), 0.2, 0.9), peaks, outcomes)


def test_without_censoring_the_spread_is_the_rms_residual():
    rng = np.random.default_rng(1)
    numbers = 0.3 * np.exp(0.2 * rng.standard_normal(20))
    residuals = np.log(numbers / 0.3)
    found, spread = log_likelihood(np.full((1, 20), 0.3), targets(numbers))
    assert spread[0] == pytest.approx(np.sqrt(np.mean(residuals**2)), rel=1e-12)
    assert found[0] == pytest.approx(norm(scale=spread[0]).logpdf(residuals).sum(), rel=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_with_censoring_the_spread_is_that_of_a_plain_maximisation(seed):
    rng = np.random.default_rng(seed)
    data = targets(np.exp(rng.uniform(-2.5, -0.1, 10)), overturned=6, small=5)
    peaks = np.exp(rng.uniform(-4.0, -0.05, (1, 21)))
    peaks[0, [2, 11, 18]] = np.inf
    residuals = data.residuals(peaks)[0, :10]
    margins = np.concatenate([np.log(peaks[0, 10:16]), np.log(0.05 / np.minimum(peaks[0, 16:], 1.0))])

    def negative(logarithm):
        spread = np.exp(logarithm)
        return -norm(scale=spread).logpdf(residuals).sum() - norm.logcdf(margins / spread).sum()

    best = minimize_scalar(negative, bounds=(-3.0, 3.0), method="bounded", options={"xatol": 1e-10})
    found, spread = log_likelihood(np.concatenate([peaks, peaks[:, ::-1]]), data)  # each sequence has its own spread
    assert found[0] == pytest.approx(-best.fun, abs=1e-8)
    assert spread[0] == pytest.approx(np.exp(best.x), rel=1e-4)


@pytest.mark.parametrize(("noise", "reached"), [(0.02, 0.97), (0.002, 0.985), (0.02, 0.02), (0.0, 0.05)])
def test_a_spread_far_from_that_of_the_numbers_alone_is_found(noise, reached):
    """Blocks that should overturn reach less than 1, be it by little or by far."""
    numbers = np.linspace(0.1, 0.8, 8)
    signs = noise * np.where(np.arange(8) % 2, 1.0, -1.0)
    data = targets(numbers, overturned=2, small=1)
    peaks = np.concatenate([numbers * np.exp(signs), [reached, reached, 0.01]])[np.newaxis]

    def negative(logarithm):
        spread = np.exp(logarithm)
        parts = norm.logcdf(np.array([np.log(reached), np.log(reached), np.log(5.0)]) / spread)
        return -norm(scale=spread).logpdf(signs).sum() - parts.sum()

    best = minimize_scalar(negative, bounds=(np.log(0.01), 3.0), method="bounded", options={"xatol": 1e-12})
    found, spread = log_likelihood(peaks, data)
    assert found[0] == pytest.approx(-best.fun, abs=1e-6)
    assert spread[0] == pytest.approx(np.exp(best.x), rel=1e-4)


@pytest.mark.parametrize("overturned", [0, 1])
def test_a_perfect_fit_stops_at_the_smallest_spread(overturned):
    numbers = np.linspace(0.1, 0.8, 8)
    peaks = np.append(numbers, [np.inf] * overturned)[np.newaxis]
    found, spread = log_likelihood(peaks, targets(numbers, overturned))
    assert spread[0] == SMALLEST_SPREAD == 0.01  # one per cent of a peak
    assert found[0] == pytest.approx(8.0 * norm(scale=0.01).logpdf(0.0))


def test_a_sequence_that_moves_no_block_has_a_likelihood_all_the_same():
    numbers = np.linspace(0.1, 0.8, 8)
    found, spread = log_likelihood(np.zeros((1, 11)), targets(numbers, overturned=2, small=1))
    assert np.isfinite(found[0])
    assert spread[0] > 1.0


def test_an_overturned_target_likes_larger_peaks_and_is_indifferent_once_certain():
    numbers = np.linspace(0.1, 0.8, 8)
    peaks = np.tile(np.append(1.2 * numbers, 0.0), (4, 1))
    peaks[:, -1] = [0.2, 0.8, 1e9, np.inf]
    found, _ = log_likelihood(peaks, targets(numbers, overturned=1))
    assert np.all(np.diff(found[:3]) > 0.0)
    assert found[2] == found[3]
