"""The likelihood of capacities against closed forms and a general-purpose optimiser."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import logistic, norm

from rockpulse.config.study_settings import MODELS
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, FAMILIES, NOT_ABOVE, has_maximum, maximise, scores

DISTRIBUTION = {"lognormal": norm, "logistic": logistic}


def test_the_words_of_the_configuration_are_the_names_of_the_table():
    assert tuple(FAMILIES) == MODELS


@pytest.mark.parametrize("model", FAMILIES)
def test_a_family_knows_its_distribution_and_deviation(model):
    z = np.array([-2.0, 0.3, 1.5])
    assert FAMILIES[model].cdf(z) == pytest.approx(DISTRIBUTION[model].cdf(z))
    assert FAMILIES[model].deviation == pytest.approx(DISTRIBUTION[model].std())


def mixed_rows(seed=1):
    rng = np.random.default_rng(seed)
    x = rng.standard_normal(40)
    return x, rng.choice([EXACT, ABOVE, NOT_ABOVE], size=40)


@pytest.mark.parametrize("model", FAMILIES)
def test_derivatives_are_those_of_the_log_likelihood(model):
    x, kind = mixed_rows()
    design, h = np.stack([np.ones(x.size), x], axis=1), 1e-5
    at = np.array([[0.3, 1.2]])
    value, slope, bend = scores(FAMILIES[model], design, kind, at)
    up, down = (scores(FAMILIES[model], design, kind, at + np.array([[step, 0.0]])) for step in (h, -h))
    np.testing.assert_allclose(slope, (up[0] - down[0]) / (2.0 * h), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(bend, (up[1] - down[1]) / (2.0 * h), rtol=1e-6, atol=1e-8)
    family, z = DISTRIBUTION[model], 0.3 + 1.2 * x
    expected = np.where(
        kind == EXACT, family.logpdf(z) + np.log(1.2), np.where(kind == ABOVE, family.logsf(z), family.logcdf(z))
    )
    np.testing.assert_allclose(value[0], expected, rtol=1e-12)


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in (21, 41, 42))])
@pytest.mark.parametrize("model", FAMILIES)
def test_the_maximum_is_that_of_a_direct_search(model, seed):
    """Also where the rows lie far apart, so that a whole step of Newton goes too far."""
    x, kind = mixed_rows(seed)
    x *= {1: 1.0, 21: 8.0, 41: 8.0, 42: 0.1}[seed]
    if seed == 41:
        kind[kind == EXACT] = NOT_ABOVE
        kind[x > 0.0] = np.where(np.arange(np.count_nonzero(x > 0.0)) % 5, NOT_ABOVE, ABOVE)
    family = DISTRIBUTION[model]

    def minus(parameters):
        z = parameters[0] + np.exp(parameters[1]) * x
        parts = np.select(
            [kind == EXACT, kind == ABOVE], [family.logpdf(z) + parameters[1], family.logsf(z)], family.logcdf(z)
        )
        return -np.sum(parts)

    options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000}
    direct = minimize(minus, [0.0, -np.log(np.std(x))], method="Nelder-Mead", options=options)
    a, b = maximise(FAMILIES[model], np.stack([np.ones(x.size), x], axis=1), kind, np.ones((1, x.size)))[0]
    np.testing.assert_allclose([a, b], [direct.x[0], np.exp(direct.x[1])], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("model", FAMILIES)
def test_without_known_capacities_a_curve_may_fall(model):
    """Two levels of which 3 and then 1 of 4 motions reached the state: F is 3/4 and 1/4 there."""
    x, kind = np.repeat([-1.0, 1.0], 4), np.array([*[NOT_ABOVE] * 3, ABOVE, *[ABOVE] * 3, NOT_ABOVE])
    a, b = maximise(FAMILIES[model], np.stack([np.ones(8), x], axis=1), kind, np.ones((1, 8)))[0]
    assert (a, b) == pytest.approx((0.0, -DISTRIBUTION[model].ppf(0.75)), abs=1e-9)


@pytest.mark.parametrize("model", FAMILIES)
def test_data_sets_without_a_maximum_leave_the_others_alone(model):
    """Of four weightings the first and the third separate."""
    x, kind = mixed_rows(3)
    known = kind == EXACT
    weights = np.ones((5, x.size))
    weights[0] = kind == ABOVE
    weights[1] = np.where(known, 0.5, 2.0)
    weights[2, known] = 0.0
    weights[2, ~known] = (x < 0.0)[~known] == (kind == ABOVE)[~known]
    weights[3, known] = 0.0
    weights[4] = np.random.default_rng(0).random(x.size)
    design = np.stack([np.ones(x.size), x, np.sin(3.0 * x)], axis=1)
    found = maximise(FAMILIES[model], design, kind, weights)
    assert np.isnan(found).all(axis=1).tolist() == [True, False, True, False, False]
    assert np.isfinite(found).all(axis=1).tolist() == [False, True, False, True, True]
    for row in (1, 3, 4):
        alone = maximise(FAMILIES[model], design, kind, weights[row : row + 1])[0]
        np.testing.assert_allclose(found[row], alone, rtol=1e-9)
        # Of a maximum every derivative is zero.
        _, slope, _ = scores(FAMILIES[model], design, kind, found[row : row + 1])
        gradient = (weights[row] * slope[0]) @ design
        gradient[1] += np.sum(weights[row] * known) / found[row, 1]
        np.testing.assert_allclose(gradient, 0.0, atol=1e-6)


@pytest.mark.parametrize(("apart", "there"), [(1e-6, True), (1e-7, False)])
def test_two_columns_that_are_nearly_one_have_no_maximum(apart, there):
    """Columns x and x + e y, x and y of variance 1, have a condition of about 4/e^2; beyond 1e14 it is refused."""
    x, y = np.array([1.0, 1.0, -1.0, -1.0]), np.array([1.0, -1.0, 1.0, -1.0])
    design = np.stack([np.ones(4), x, x + apart * y], axis=1)
    found = maximise(FAMILIES["lognormal"], design, np.full(4, EXACT), np.ones((1, 4)))
    assert np.all(np.isfinite(found)) == there


@pytest.mark.parametrize(
    ("x", "kind", "there"),
    [
        ([1.0, 2.0, 3.0, 4.0], [ABOVE, ABOVE, NOT_ABOVE, NOT_ABOVE], False),  # all below a level, none above it
        ([1.0, 2.0, 3.0, 4.0], [ABOVE, NOT_ABOVE, ABOVE, NOT_ABOVE], True),
        ([1.0, 2.0, 3.0, 4.0], [NOT_ABOVE, NOT_ABOVE, ABOVE, ABOVE], False),
        ([1.0, 1.0, 1.0, 1.0], [ABOVE, NOT_ABOVE, ABOVE, NOT_ABOVE], False),  # a single level
        ([1.0, 2.0], [ABOVE, ABOVE], False),
        ([1.0, 2.0], [EXACT, EXACT], True),
        ([1.0, 1.0], [EXACT, EXACT], False),
        ([1.0, 2.0], [EXACT, ABOVE], True),
        ([2.0, 1.0], [EXACT, ABOVE], False),
        ([2.0, 2.0], [EXACT, ABOVE], False),
        ([2.0, 3.0], [EXACT, NOT_ABOVE], False),
        ([2.0, 2.0], [EXACT, NOT_ABOVE], False),
        ([2.0, 1.0], [EXACT, NOT_ABOVE], True),
        ([1.0, 2.0, 2.0, 3.0], [ABOVE, ABOVE, NOT_ABOVE, NOT_ABOVE], False),  # a level of both kinds, no overlap
        ([1.0, 2.0, 2.0, 3.0], [NOT_ABOVE, NOT_ABOVE, ABOVE, ABOVE], False),
        ([1.0, 2.0, 1.5], [ABOVE, ABOVE, NOT_ABOVE], True),
        ([1.0, 2.0, 1.5], [NOT_ABOVE, NOT_ABOVE, ABOVE], True),
    ],
)
def test_a_maximum_exists_where_the_data_overlap(x, kind, there):
    x, kind = np.array(x), np.array(kind)
    assert has_maximum(x, kind, np.ones((1, x.size)))[0] == there
    # Rows that weigh nothing are not there, in whichever data set.
    more, kinds = np.append(x, [0.5, 0.6, 9.0, 9.1]), np.append(kind, [EXACT, NOT_ABOVE, ABOVE, EXACT])
    weights = np.ones((3, more.size))
    weights[1, x.size :], weights[1, : x.size] = 0.0, 0.3
    assert has_maximum(more, kinds, weights).tolist() == [True, there, True]
    centred = np.stack([np.ones(x.size), x - x.mean()], axis=1)
    assert np.all(np.isfinite(maximise(FAMILIES["lognormal"], centred, kind, np.ones((1, x.size))))) == there
