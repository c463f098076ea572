"""The likelihood of capacities against closed forms and a general-purpose optimiser."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import CensoredData, logistic, norm

from rockpulse.config.fragility_settings import MODELS
from rockpulse.studies.fragility.likelihood import FAMILIES, has_maximum, maximise, scores
from rockpulse.studies.fragility.observations import ABOVE, EXACT, NOT_ABOVE

DISTRIBUTION = {"lognormal": norm, "logistic": logistic}


def test_the_words_of_the_configuration_are_the_names_of_the_table():
    assert tuple(FAMILIES) == MODELS


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


@pytest.mark.parametrize("model", FAMILIES)
def test_the_maximum_is_that_of_a_direct_search(model):
    x, kind = mixed_rows()
    family = DISTRIBUTION[model]

    def minus(parameters):
        z = parameters[0] + np.exp(parameters[1]) * x
        parts = np.select(
            [kind == EXACT, kind == ABOVE], [family.logpdf(z) + parameters[1], family.logsf(z)], family.logcdf(z)
        )
        return -np.sum(parts)

    direct = minimize(minus, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000})
    a, b = maximise(FAMILIES[model], np.stack([np.ones(x.size), x], axis=1), kind, np.ones((1, x.size)))[0]
    np.testing.assert_allclose([a, b], [direct.x[0], np.exp(direct.x[1])], rtol=1e-6)


def test_a_truncated_analysis_is_the_censored_fit_of_scipy():
    x = np.random.default_rng(3).normal(0.2, 0.7, 30)
    limit = 0.5
    kind = np.where(x > limit, ABOVE, EXACT)
    x = np.minimum(x, limit)
    a, b = maximise(FAMILIES["lognormal"], np.stack([np.ones(30), x], axis=1), kind, np.ones((1, 30)))[0]
    mean, deviation = norm.fit(CensoredData.right_censored(x, x == limit))
    np.testing.assert_allclose([-a / b, 1.0 / b], [mean, deviation], rtol=1e-4)  # as near as scipy's search goes


def test_weights_count_rows_as_often():
    x, kind = mixed_rows()
    times = np.random.default_rng(2).integers(0, 4, x.size)
    family, design = FAMILIES["lognormal"], np.stack([np.ones(x.size), x], axis=1)
    weighted = maximise(family, design, kind, np.stack([np.ones(x.size), times]))[1]
    repeated = maximise(
        family, design[np.repeat(np.arange(x.size), times)], np.repeat(kind, times), np.ones((1, times.sum()))
    )
    np.testing.assert_allclose(weighted, repeated[0], rtol=1e-10)


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
    ],
)
def test_a_maximum_exists_where_the_data_overlap(x, kind, there):
    x, kind = np.array(x), np.array(kind)
    assert has_maximum(x, kind, np.ones((1, x.size)))[0] == there
    centred = np.stack([np.ones(x.size), x - x.mean()], axis=1)
    assert np.all(np.isfinite(maximise(FAMILIES["lognormal"], centred, kind, np.ones((1, x.size))))) == there
