"""Fragility curves show the fit, its band where there is one, and the records behind it."""

import numpy as np
import pytest
from drawn import in_legend, labelled, small_print
from matplotlib.colors import same_color

from rockpulse.views.plots.fragility_curves import fragility_panels
from rockpulse.views.plots.style import looks


def fragility(tree, measure="velocity_ratio", limit_states=None):
    """The panel of one measure."""
    return fragility_panels(tree, "wall", measure, limit_states)[0]


def banded(tree, low=0.8, high=1.2):
    """The same with bands, which one earthquake does not give."""
    copy = tree.copy(deep=True)
    probability = copy["fragility"]["probability"].values
    copy["fragility"]["probability_low"].values[:] = low * probability
    copy["fragility"]["probability_high"].values[:] = np.minimum(1.0, high * probability)
    return copy


def test_every_limit_state_has_its_curve(fragility_tree):
    ax = fragility(fragility_tree)
    own = fragility_tree["fragility"].to_dataset().sel(block="wall", measure="velocity_ratio")
    words = ["uplift", r"$\theta_{max}/\alpha_c \geq$ 0.4", "overturning"]
    lines = {line.get_label(): line for line in ax.lines}
    for word, state in zip(words, own["limit_state"].values, strict=True):
        line, stored = lines[word], own.sel(limit_state=state)
        at = np.searchsorted(line.get_xdata(), stored["level"].values * (1.0 - 1e-9))
        assert line.get_xdata()[at] == pytest.approx(stored["level"].values)
        assert line.get_ydata()[at] == pytest.approx(stored["probability"].values, abs=1e-12)
        assert np.all(np.diff(line.get_ydata()) >= -1e-12)
    assert len({lines[word].get_marker() + str(lines[word]._dash_pattern) for word in words}) == 3
    assert ax.get_xlabel() == r"p PGV/(g tan $\alpha_c$) [-]"
    assert ax.get_ylabel() == "probability of reaching the\nlimit state [-]"
    assert ax.get_ylim() == pytest.approx((-0.01, 1.01))
    assert ax.get_xscale() == "log"
    level, probability = own["level"].values, own["probability"].values
    rising = np.any((probability > 0.002) & (probability < 0.998), axis=own["probability"].dims.index("limit_state"))
    assert ax.get_xlim() == pytest.approx((level[rising].min(), level[rising].max()))
    assert ax.figure.get_suptitle() == "wall"
    assert "2 records of 1 earthquake" in small_print(ax)
    ax = fragility(fragility_tree, measure="pga", limit_states=["uplift"])
    own = fragility_tree["fragility"].to_dataset().sel(block="wall", measure="pga", limit_state="uplift")
    assert float(own["beta"]) == 0.0
    (line,) = (line for line in ax.lines if line.get_label().startswith("uplift"))
    assert line.get_xdata()[1:3].tolist() == [float(own["median"])] * 2
    assert line.get_ydata().tolist() == [0.0, 0.0, 1.0, 1.0]


@pytest.mark.sweep
def test_the_records_and_the_acceleration_that_lifts_stand_beside_the_curve(fragility_tree):
    ax = fragility(fragility_tree, limit_states=["overturning"])
    capacities = fragility_tree["capacities"].to_dataset().sel(block="wall")
    measure = capacities["measure_value"].sel(measure="velocity_ratio")
    value = capacities["factor"].sel(limit_state="overturning") * measure
    points = [line for line in ax.lines if line.get_linestyle() == "None"]
    assert np.sort(points[0].get_xdata()) == pytest.approx(np.sort(value.values))
    assert points[0].get_ydata() == pytest.approx([0.25, 0.75])
    tree = fragility_tree.copy(deep=True)
    tree["capacities"]["factor"].values[0] = np.inf  # never reaches the state
    ax = fragility(tree, limit_states=["overturning"])
    assert [len(line.get_xdata()) for line in ax.lines if line.get_linestyle() == "None"] == [1]
    tree = fragility_tree.copy(deep=True)
    tree["fragility"]["uplift_acceleration"].values[:] = 3.0
    assert labelled(fragility(tree, measure="pga"))["lifts from here on"].get_xdata()[0] == 3.0
    assert "lifts from here on" not in labelled(fragility(tree))
    tree["fragility"]["uplift_acceleration"].values[:] = np.nan  # on a floor
    assert "lifted" not in small_print(fragility(tree, measure="pga"))


def test_what_holds_for_all_limit_states_is_said_once(fragility_tree):
    ax = fragility(fragility_tree)
    assert not ax.collections
    assert small_print(ax).count("no band") == 1
    assert "All: no band" in small_print(ax)
    tree = banded(fragility_tree)
    tree["fragility"]["probability_low"].values[:] = 0.02
    tree["fragility"]["probability_high"].values[:] = 0.99
    ax = fragility(tree)
    assert not ax.collections
    assert "The band of the curve of overturning is not drawn: with so few" in small_print(ax)


@pytest.mark.parametrize(
    ("asked", "expected"), [(None, "overturning"), (["0.4", "uplift"], "0.4"), (["uplift"], "uplift")]
)
def test_one_band_is_filled_and_said(fragility_tree, asked, expected):
    tree = banded(fragility_tree)
    ax = fragility(tree, limit_states=asked)
    (band,) = ax.collections
    own = tree["fragility"].to_dataset().sel(block="wall", measure="velocity_ratio", limit_state=expected)
    corners = band.get_paths()[0].vertices
    for name in ("probability_low", "probability_high"):
        for corner in zip(own["level"].values, own[name].values, strict=True):
            assert np.min(np.abs(corners - corner)) < 1e-9
    word = rf"$\theta_{{max}}/\alpha_c \geq$ {expected}" if expected == "0.4" else expected
    assert f"Band of the curve of {word}: 90 %, over earthquakes" in small_print(ax)
    color = next(line.get_color() for line in ax.lines if line.get_label() == word)
    assert same_color(band.get_facecolor()[0][:3], color)


@pytest.mark.sweep
def test_a_curve_above_that_of_a_milder_state_is_said(fragility_tree):
    words = "where it lies above that of a milder limit state it has no meaning"

    def said(above, states=None):
        tree = fragility_tree.copy(deep=True)
        probability = tree["fragility"]["probability"].transpose("block", "measure", "limit_state", "point").values
        probability[:] = np.clip(np.linspace(-0.1, 1.1, probability.shape[-1]), 0.0, 1.0)
        probability[:, :, 2, probability.shape[-1] // 2] += above  # overturning
        ax = fragility(tree, limit_states=states)
        return words in small_print(ax)

    assert said(0.02, ["overturning", "uplift"])
    assert not said(0.009)
    assert not said(0.02, ["uplift", "0.4"])


def test_a_dozen_limit_states_are_told_apart_without_colour_alone():
    drawn = looks([str(k) for k in range(16)])
    assert len({(one.color, str(one.line)) for one in drawn}) == 16
    assert len({(one.color, one.marker) for one in drawn}) == 16


def test_pga_stands_beside_the_measure_that_is_shown(fragility_tree):
    tree = banded(fragility_tree)
    tree["fragility"]["uplift_acceleration"].values[:] = 3.0
    left, right = fragility_panels(tree, "wall")
    assert (left.get_xlabel(), right.get_xlabel()) == (r"p PGV/(g tan $\alpha_c$) [-]", "PGA [m/s²]")
    for ax, measure in ((left, "velocity_ratio"), (right, "pga")):
        line = next(line for line in ax.lines if line.get_label().startswith("overturning"))
        own = tree["fragility"].to_dataset().sel(block="wall", measure=measure)
        assert line.get_xdata()[0] == pytest.approx(own["level"].values[0])
        assert len(ax.collections) == 1
    names = in_legend(left)
    assert names == ["uplift", r"$\theta_{max}/\alpha_c \geq$ 0.4", "overturning", "lifts from here on"]
    assert right.get_legend() is None
    words = small_print(left)
    assert words.count("2 records of 1 earthquake") == 1
    assert "In PGA: Below the grey line the body is never lifted" in words


@pytest.mark.parametrize(
    ("hazard", "expected"),
    [("", ["velocity_ratio", "pga"]), ('[hazard]\nk0 = 1e-4\nk = 2.5\nmeasure = "pgv"\n', ["velocity_ratio"])],
)
def test_the_measure_of_the_hazard_stands_beside_where_the_file_has_it(fragility_tree, hazard, expected):
    tree = fragility_tree.copy(deep=True)
    tree.attrs["configuration"] = hazard
    long_name = tree["fragility"]["measure_long_name"]
    panels = fragility_panels(tree, "wall")
    units = [str(long_name.sel(measure=name).item()).split()[0] for name in expected]
    assert [ax.get_xlabel().split()[0] for ax in panels] == units


@pytest.mark.sweep
def test_what_a_curve_lacks_is_said_in_the_legend(fragility_tree):
    assert not any("(" in words for words in labelled(fragility(fragility_tree)))
    tree = fragility_tree.copy(deep=True)
    tree["fragility"]["extrapolated"].values[:] = 1
    assert all(words.endswith("(extrapolated)") for words in labelled(fragility(tree)))
    tree["fragility"]["probability"].values[:] = np.nan
    assert next(iter(labelled(fragility(tree)))) == "uplift: no curve"
    copy = fragility_tree.copy(deep=True)
    curves = copy["fragility"].to_dataset()
    copy["fragility"] = type(copy)(curves.assign({name: np.nan * curves[name] for name in ("level", "probability")}))
    ax = fragility(copy)
    ax.figure.canvas.draw()
    assert ax.figure.get_suptitle() == "wall"
