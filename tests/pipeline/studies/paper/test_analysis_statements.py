"""The statements about Figure 4: which hold, under which condition, and what the exceptions are."""

import math

import numpy as np
import pytest
import xarray as xr

from rockpulse.studies.paper.analysis_statements import ANALYSIS_STATEMENTS, geometry_plays_no_part
from rockpulse.studies.paper.finding import examine
from rockpulse.study import figure4


@pytest.fixture(scope="module")
def figure():
    """The values of I_s/I dense enough for the exceptions, with 20 s and blocks A and B."""
    ratios, shares = [0.1, 0.2, 0.3, 0.5, 0.7, 0.9], np.round(np.arange(0.0, 1.001, 0.02), 10)
    return figure4(impulse_ratios=ratios, secondary_ratios=shares, counts=[2, math.inf], threads=1)[
        "figure4"
    ].to_dataset()


@pytest.fixture(scope="module")
def findings(figure):
    return {statement.name: finding for statement, finding in examine(figure, ANALYSIS_STATEMENTS).items()}


def without(figure, spacing):
    return figure.sel(spacing=[name for name in figure["spacing"].values if name != spacing])


def test_the_peak_falls_with_secondary_impulses_where_the_duration_does_not_bind(findings):
    found = findings["peak_falls_with_secondary_impulses"]
    assert found.verdict == "holds_in_part"
    assert found.where.startswith("the duration binds neither of the two (")
    assert found.count > 0.98 * found.cases


def test_the_exceptions_are_inputs_that_end_too_early():
    """A larger I_s/I shortens the half-cycles, so that one more main impulse acts within 20 s."""
    tree = figure4([0.9], [0.1, 0.2], counts=[math.inf], threads=1)
    cases = tree["figure4"].to_dataset().sel(spacing="end").isel(restitution=0, intermediate_count=0)
    before, after = cases.isel(secondary_ratio=slice(0, -1)), cases.isel(secondary_ratio=slice(1, None))
    rising = after["peak_rotation_ratio"].values > before["peak_rotation_ratio"].values
    assert 5 < rising.sum() < 20
    more = after["half_cycle_count"].values - before["half_cycle_count"].values
    assert set(more[rising].tolist()) == {1}
    assert np.all(before["duration_binds"].values[rising] == 1)


def test_without_end_the_peak_falls_everywhere(figure):
    """The endless peak is the statement's own meaning; beyond alpha_c the closed form of "start" is left out."""
    peak = without(figure, "start")["endless_peak_rotation_ratio"].values
    over = np.isinf(peak[:, :, 1:]) & np.isinf(peak[:, :, :-1])
    assert np.all(over | (peak[:, :, 1:] < peak[:, :, :-1]))


@pytest.mark.parametrize("name", ["peak_rises_with_the_main_impulse", "larger_restitution_destabilises"])
def test_main_impulse_and_restitution_destabilise(figure, name):
    statement = next(statement for statement in ANALYSIS_STATEMENTS if statement.name == name)
    assert statement.check(without(figure, "start")).verdict == "holds"


def test_the_secondary_impulses_stop_the_block_at_each_impact_where_they_equal_the_main_ones(figure):
    """I_s = I: each half-cycle is the first one again, so that C plays no part."""
    peaks = figure["peak_rotation_ratio"].sel(secondary_ratio=1.0, spacing="end")
    np.testing.assert_allclose(peaks.sel(restitution=0.9), peaks.sel(restitution=0.6), rtol=1e-12)


def test_geometry_plays_no_part_at_equal_n_where_the_duration_binds_neither_block(figure, findings):
    found = findings["geometry_plays_no_part"]
    assert found.verdict == "holds_in_part"
    assert found.where.startswith("the duration binds neither block (")
    free = figure["duration_binds"] == 0
    both = free.isel(p=0) & free.isel(p=1)
    assert int((found.held.isel(p=0) & ~both).sum()) < int((~both).sum())
    assert "cases overturn one block and not the other" in found.numbers


def test_geometry_does_play_a_part_at_equal_intervals_in_seconds():
    """n follows from p dT, which differs from block to block (the extra half-cycle of Figure 5)."""
    tree = figure4([0.9], [1.0 / 1.9], [0.7], [2, 8], [1.0], threads=1)
    few, many = tree["figure4/overturning_half_cycle"].sel(spacing="end").values.ravel().tolist()
    assert (few, many) == (6, 7)


def test_one_block_says_nothing_about_geometry(figure):
    finding = geometry_plays_no_part(figure.isel(p=[0]))
    assert finding.verdict == "not_examined"


def test_large_ratios_mean_less_resonance(findings):
    assert findings["large_ratios_mean_less_resonance"].verdict == "holds"


def test_a_grid_without_large_ratios_does_not_speak_of_them(figure):
    statement = next(row for row in ANALYSIS_STATEMENTS if row.name == "large_ratios_mean_less_resonance")
    assert statement.check(figure.sel(secondary_ratio=slice(0.0, 0.5))).verdict == "not_examined"


def test_a_figure_that_says_the_opposite_fails(figure):
    turned = figure.assign(peak_rotation_ratio=(figure["peak_rotation_ratio"].dims, np.zeros(figure["outcome"].shape)))
    turned["peak_rotation_ratio"] = turned["peak_rotation_ratio"] + xr.DataArray(
        figure["secondary_ratio"] - figure["impulse_ratio"] - figure["restitution"]
    )
    for statement in ANALYSIS_STATEMENTS[:3]:
        assert statement.check(turned).verdict == "fails", statement.name
