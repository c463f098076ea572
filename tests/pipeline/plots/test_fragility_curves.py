"""Fragility curves show the fit, its band where there is one, and the records behind it."""

import numpy as np
import pytest

from rockpulse.errors import ResultsError
from rockpulse.plots.fragility_curves import fragility


def banded(tree):
    """The same with a band, which one earthquake does not give."""
    copy = tree.copy(deep=True)
    curves = copy["fragility"].to_dataset()
    half = 0.8 * curves["probability"]
    filled = curves.assign(
        probability_low=curves["probability_low"].copy(data=half.values),
        probability_high=curves["probability_high"].copy(data=np.minimum(1.0, 1.2 * curves["probability"].values)),
    )
    copy["fragility"] = type(tree)(filled)
    return copy


def test_every_limit_state_has_its_curve(fragility_tree):
    ax = fragility(fragility_tree, block="wall")
    own = fragility_tree["fragility"].to_dataset().sel(block="wall", measure="velocity_ratio")
    words = ["uplift", r"$\theta_{max}/\alpha_c \geq$ 0.4", "overturning"]
    lines = {line.get_label(): line for line in ax.lines}
    for word, state in zip(words, own["limit_state"].values, strict=True):
        assert np.array_equal(lines[word].get_ydata(), own["probability"].sel(limit_state=state).values)
    assert len({lines[word].get_marker() + str(lines[word]._dash_pattern) for word in words}) == 3
    assert ax.get_xlabel() == r"p PGV/(g tan $\alpha_c$) [-]"
    assert ax.get_ylabel() == "probability of reaching the limit state [-]"
    assert ax.get_ylim() == pytest.approx((-0.01, 1.01))


def test_the_records_stand_beside_the_curve(fragility_tree):
    ax = fragility(fragility_tree, block="wall", limit_states=["overturning"])
    capacities = fragility_tree["capacities"].to_dataset().sel(block="wall")
    value = capacities["factor"].sel(limit_state="overturning") * capacities["measure_value"].sel(
        measure="velocity_ratio"
    )
    points = [line for line in ax.lines if line.get_linestyle() == "None"]
    assert np.sort(points[0].get_xdata()) == pytest.approx(np.sort(value.values))
    assert points[0].get_ydata() == pytest.approx([0.25, 0.75])


def test_a_record_that_never_reaches_the_state_is_not_counted_as_reaching_it(fragility_tree):
    tree = fragility_tree.copy(deep=True)
    tree["capacities"]["factor"].values[0] = np.inf
    ax = fragility(tree, block="wall", limit_states=["overturning"])
    points = next(line for line in ax.lines if line.get_linestyle() == "None")
    assert len(points.get_xdata()) == 1


def test_bands_are_filled_and_said(fragility_tree):
    without = fragility(fragility_tree, block="wall")
    assert not without.collections
    assert "no band" in without.figure.get_supxlabel()
    ax = fragility(banded(fragility_tree), block="wall")
    assert len(ax.collections) == 3
    assert "Bands: 90 %, over earthquakes" in ax.figure.get_supxlabel()


def test_a_measure_brings_its_own_unit(fragility_tree):
    assert fragility(fragility_tree, block="wall", measure="pga").get_xlabel() == "PGA [m/s²]"


def test_unknown_names_are_refused(fragility_tree):
    with pytest.raises(ResultsError, match="nearest: velocity_ratio"):
        fragility(fragility_tree, measure="velocity")
    with pytest.raises(ResultsError, match=r'no limit_state "0\.5"'):
        fragility(fragility_tree, limit_states=["0.5"])


def test_what_has_no_curve_says_so(fragility_tree):
    tree = fragility_tree.copy(deep=True)
    tree["fragility"]["probability"].values[:] = np.nan
    ax = fragility(tree, block="wall")
    assert next(line.get_label() for line in ax.lines if "no curve" in line.get_label()) == "uplift: no curve"
