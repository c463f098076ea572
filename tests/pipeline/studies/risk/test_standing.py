"""What bodies that have stood for long say of a hazard."""

import numpy as np
import pytest
import xarray as xr

import rockpulse as rp


def risk(frequency):
    low, high = 0.5 * np.array(frequency), 2.0 * np.array(frequency)
    values = {"frequency": frequency, "frequency_low": low, "frequency_high": high}
    return xr.Dataset({name: ("body", value) for name, value in values.items()}, {"body": ["a", "b", "c"]})


def test_an_age_leaves_a_largest_frequency():
    """ln 20 = 2.995732: 10,000 years leave 2.9957e-4 a year, a third of 8.9872e-4, three times 9.9858e-5."""
    found = rp.standing_test(risk([8.987197e-4, 9.985774e-5, np.nan]), 1e4)
    assert found["largest"].values == pytest.approx(2.995732e-4, rel=1e-6)
    assert found["factor"].values[:2] == pytest.approx([1.0 / 3.0, 3.0], rel=1e-6)
    assert found["contradicted"].values.tolist() == [1, 0, -1]
    # exp(-8.987197), and at half and twice the frequency.
    assert found["chance"].values[0] == pytest.approx(1.25e-4, rel=1e-3)
    assert found["chance_low"].values[0] == pytest.approx(1.25e-4**2, rel=2e-3)
    assert found["chance_high"].values[0] == pytest.approx(1.25e-4**0.5, rel=1e-3)
    # The hazard times the factor leaves the chance 5 %.
    assert np.exp(-found["factor"].values[0] * 8.987197) == pytest.approx(0.05, rel=1e-6)


@pytest.mark.parametrize("given", [{"age": 0.0}, {"age": 10.0, "confidence": 1.0}])
def test_what_is_no_age_is_refused(given):
    with pytest.raises(rp.ConfigError, match="age, confidence"):
        rp.standing_test(risk([1.0, 1.0, 1.0]), **given)
