"""The map of the probability of overturning has the stored numbers, the likeliest record on top."""

from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from drawn import in_legend, named_rows, small_print
from report_cases import probable, summary_of

from rocking.response import Outcome
from rockpulse.errors import ResultsError
from rockpulse.views.plots.probability_map import COLUMNS, ROWS, probability_map


def tree_of(summary, **groups):
    return xr.DataTree.from_dict({"/summary": summary, **{f"/{name}": group for name, group in groups.items()}})


def bodies(summary, *factors):
    """The same records on several bodies, whose probabilities are those of the first one times a factor."""
    every = summary.isel(block=[0] * len(factors)).assign_coords(block=[f"body {k}" for k in range(len(factors))])
    return every.assign(overturning_probability=every["overturning_probability"] * np.array(factors))


def drawn(ax):
    """Names of the records, and what is drawn of each."""
    values = ax.collections[0].get_array()
    return named_rows(ax), values.filled(np.nan)


@pytest.mark.sweep
def test_every_record_has_the_stored_probability_of_every_body():
    ax = probability_map(tree_of(bodies(probable([0.02, 0.9, 0.3]), 1.0, 0.5)))
    names, values = drawn(ax)
    assert names == ["r1", "r2", "r0"]
    assert values == pytest.approx(np.array([[0.9, 0.45], [0.3, 0.15], [0.02, 0.01]]))
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["body 0", "body 1"]
    assert [text.get_text() for text in ax.texts] == ["0.90", "0.45", "0.30", "0.15", "0.020", "0.010"]
    assert ax.figure.axes[1].get_ylabel() == "probability P [-]"
    mesh = ax.collections[0]
    shades = mesh.cmap(mesh.norm(np.array([0.04, 0.06, 0.49, 0.51, 0.95])))[:, :3].sum(axis=1)
    assert np.all(np.diff(shades) < 0.0)  # the verdicts change at 0.05 and 0.5
    ax = probability_map(tree_of(probable([0.9, np.nan])))
    names, values = drawn(ax)
    assert names == ["r0", "r1"]
    assert np.isnan(values[1, 0])
    assert in_legend(ax) == ["not known"]


def test_at_a_demand_it_is_the_probability_there_without_records_that_are_scaled_too_far():
    summary = probable([0.9, 0.1, 0.1], demand=3.0, at_demand=[0.4, 0.7, 0.2], to_demand=[1.0, 2.0, 4.1])
    ax = probability_map(tree_of(summary), demand="UL*")
    names, values = drawn(ax)
    assert names[:2] == ["r1", "r0"]
    assert values[:, 0] == pytest.approx([0.7, 0.4, np.nan], nan_ok=True)
    assert "scaled to the demand ULS" in ax.figure.get_suptitle()
    with pytest.raises(ResultsError, match="the results have no demand"):
        probability_map(tree_of(probable([0.9])), demand="ULS")


def test_without_probabilities_it_is_the_verdict_of_the_model():
    outcomes = [Outcome.OVERTURNS, Outcome.ROCKS, Outcome.UNRESOLVED]
    ax = probability_map(tree_of(summary_of([0.8, 1.5, np.nan], outcomes=outcomes)))
    names, values = drawn(ax)
    assert dict(zip(names, values[:, 0].tolist(), strict=True)) == pytest.approx(
        {"r0": 1.0, "r1": 0.0, "r2": np.nan}, nan_ok=True
    )
    assert in_legend(ax) == ["overturns", "does not overturn", "not known"]
    assert not ax.texts
    assert len(ax.figure.axes) == 1
    assert "No probability is known; the map shows whether the body overturns" in small_print(ax)
    with pytest.raises(ResultsError, match="do not state whether the records, as recorded, overturn a body"):
        probability_map(tree_of(summary_of([np.nan], outcomes=[Outcome.UNRESOLVED])))


def test_of_a_pair_of_channels_the_worst_direction_counts():
    pairs = xr.Dataset({"record_index": (("pair", "direction"), [[0, 1], [2, -1]])}, {"pair": ["p", "q"]})
    summary = probable([0.1, 0.6, 0.9]).assign(event=("record", ["a", "a", "b"]))
    names, values = drawn(ax := probability_map(tree_of(summary, directions=pairs)))
    assert names == ["q", "p"]
    assert values[:, 0] == pytest.approx([0.9, 0.6])
    assert "Each pair of channels is drawn in the direction" in small_print(ax)


@pytest.mark.sweep
def test_of_many_the_likeliest_are_shown_on_a_page():
    rng = np.random.default_rng(0)
    chance, factors = rng.uniform(0.0, 1.0, ROWS + 10), rng.uniform(0.0, 1.0, COLUMNS + 10)
    ax = probability_map(tree_of(bodies(probable(chance), *factors)))
    names, _ = drawn(ax)
    assert names == [f"r{k}" for k in np.argsort(-chance)[:ROWS]]
    shown = [tick.get_text() for tick in ax.get_xticklabels()]
    assert shown == [f"body {k}" for k in sorted(np.argsort(-factors)[:COLUMNS])]
    told = small_print(ax)
    assert f"The {ROWS} of {ROWS + 10} records" in told
    assert f"The {COLUMNS} of {COLUMNS + 10} bodies" in told
    assert ax.figure.get_size_inches()[1] < 11.7
    ax.figure.draw_without_rendering()
    boxes = [tick.get_window_extent() for tick in ax.get_xticklabels()]
    assert all(left.x1 <= right.x0 for left, right in pairwise(boxes))
