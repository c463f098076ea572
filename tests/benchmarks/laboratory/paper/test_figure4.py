"""Figure 4 of the paper against closed forms, and its statements."""

import math

import numpy as np
import pytest
import xarray as xr

from laboratory.paper.__main__ import curves_text
from laboratory.paper.blocks import paper_block
from laboratory.paper.figure4 import figure4, no_motions
from laboratory.paper.figure4_statements import FIGURE4_STATEMENTS
from laboratory.paper.finding import examine
from laboratory.paper.pictures import draw_figure4
from rockpulse.models import ImpulseSequence, Outcome, sequence_response

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def figure():
    """The values of I_s/I dense enough for the exceptions, with 20 s and blocks A and B."""
    ratios, shares = [0.1, 0.2, 0.3, 0.5, 0.7, 0.9], np.round(np.arange(0.0, 1.001, 0.02), 10)
    return figure4(impulse_ratios=ratios, secondary_ratios=shares, counts=[2, math.inf])[0]


@pytest.fixture(scope="module")
def findings(figure):
    return {statement.name: finding for statement, finding in examine(figure, FIGURE4_STATEMENTS).items()}


def without(figure, spacing):
    return figure.sel(spacing=[name for name in figure["spacing"].values if name != spacing])


def test_the_peak_falls_with_secondary_impulses_where_the_duration_does_not_bind(findings):
    found = findings["peak_falls_with_secondary_impulses"]
    assert found.verdict == "holds in part"
    assert found.where.startswith("the duration binds neither of the two (")
    assert found.count > 0.98 * found.cases


def test_the_exceptions_are_inputs_that_end_too_early():
    """A larger I_s/I shortens the half-cycles, so that one more main impulse acts within 20 s."""
    cases = figure4([0.9], [0.1, 0.2], counts=[math.inf])[0]
    cases = cases.sel(spacing="end").isel(restitution=0, intermediate_count=0)
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
    statement = next(statement for statement in FIGURE4_STATEMENTS if statement.name == name)
    assert statement.check(without(figure, "start")).verdict == "holds"


def test_the_secondary_impulses_stop_the_block_at_each_impact_where_they_equal_the_main_ones(figure):
    """I_s = I: each half-cycle is the first one again, so that C plays no part."""
    peaks = figure["peak_rotation_ratio"].sel(secondary_ratio=1.0, spacing="end")
    np.testing.assert_allclose(peaks.sel(restitution=0.9), peaks.sel(restitution=0.6), rtol=1e-12)


def test_geometry_plays_no_part_at_equal_n_where_the_duration_binds_neither_block(figure, findings):
    found = findings["geometry_plays_no_part"]
    assert found.verdict == "holds in part"
    assert found.where.startswith("the duration binds neither block (")
    free = figure["duration_binds"] == 0
    both = free.isel(p=0) & free.isel(p=1)
    assert int((found.held.isel(p=0) & ~both).sum()) < int((~both).sum())
    assert "cases overturn one block and not the other" in found.numbers


def test_geometry_does_play_a_part_at_equal_intervals_in_seconds():
    """n follows from p dT, which differs from block to block (the extra half-cycle of Figure 5)."""
    found, _ = figure4([0.9], [1.0 / 1.9], [0.7], [2, 8], [1.0])
    few, many = found["overturning_half_cycle"].sel(spacing="end").values.ravel().tolist()
    assert (few, many) == (6, 7)


def test_large_ratios_mean_less_resonance(findings):
    assert findings["large_ratios_mean_less_resonance"].verdict == "holds"


def test_a_figure_that_says_the_opposite_fails(figure):
    turned = figure.assign(peak_rotation_ratio=(figure["peak_rotation_ratio"].dims, np.zeros(figure["outcome"].shape)))
    turned["peak_rotation_ratio"] = turned["peak_rotation_ratio"] + xr.DataArray(
        figure["secondary_ratio"] - figure["impulse_ratio"] - figure["restitution"]
    )
    for statement in FIGURE4_STATEMENTS[:3]:
        assert statement.check(turned).verdict == "fails", statement.name


@pytest.fixture(scope="module")
def coarse():
    """A coarse grid with the default blocks, restitutions and duration."""
    ratios, shares = [0.1, 0.3, 0.5, 0.8], np.linspace(0.0, 1.0, 11)
    return figure4(impulse_ratios=ratios, secondary_ratios=shares, counts=[2, 6, math.inf])[0]


def by_recurrence(u1, share, c, end):
    """Peak, half-cycle of overturning and half-cycles for n -> infinity, by F4 and one loop; times are p t."""
    u, start, peak, count = u1, 0.0, 0.0, 0
    while start < end:
        count += 1
        v = u - 0.5 * share * u1
        if v >= 1.0 - 1e-13:
            return math.inf, count, count
        peak = max(peak, 1.0 - math.sqrt(1.0 - v * v))
        start += 2.0 * math.atanh(v)
        u = c * (u - share * u1) + u1
    return peak, -1, count


def test_the_continuous_limit_is_the_recurrence_in_closed_form(coarse):
    limit = coarse.sel(intermediate_count=math.inf, spacing="end")
    for c in limit["restitution"].values:
        for u1 in limit["impulse_ratio"].values:
            for share in limit["secondary_ratio"].values:
                for p in limit["p"].values:
                    case = limit.sel(restitution=c, impulse_ratio=u1, secondary_ratio=share, p=p)
                    peak, overturned, count = by_recurrence(u1, share, c, 20.0 * p)
                    assert case["peak_rotation_ratio"].item() == pytest.approx(peak, rel=1e-10), (c, u1, share)
                    assert case["overturning_half_cycle"].item() == overturned
                    assert case["half_cycle_count"].item() == count


@pytest.mark.parametrize("name", ["A", "B"])
@pytest.mark.parametrize("spacing", ["end", "middle", "start", "open"])
def test_the_blocks_of_the_paper_give_the_dimensionless_curves(coarse, name, spacing):
    block = paper_block(name, 0.6)
    main = 0.5 * block.critical_impulse
    shares = coarse["secondary_ratio"].values
    sequence = ImpulseSequence(main, shares * main, np.nan, 20.0, intermediate_count=6, spacing=spacing)
    response = sequence_response(block, sequence, threads=1)
    curve = coarse.sel(restitution=0.6, impulse_ratio=0.5, spacing=spacing, intermediate_count=6).sel(
        p=float(block.p), method="nearest"
    )
    np.testing.assert_allclose(curve["peak_rotation_ratio"], response.peak_rotation_ratio, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(curve["outcome"], response.outcome)
    np.testing.assert_array_equal(curve["overturning_half_cycle"], response.overturning_half_cycle)


def test_a_duration_that_does_not_bind_gives_the_endless_peak(coarse):
    free = coarse["duration_binds"] == 0
    assert 0 < int(free.sum()) < free.size
    peak, endless = coarse["peak_rotation_ratio"], coarse["endless_peak_rotation_ratio"]
    assert bool(((peak <= endless * (1.0 + 1e-12) + 1e-12) | (peak == endless)).all())
    np.testing.assert_allclose(peak.values[free.values], endless.values[free.values], rtol=1e-9, atol=1e-12)
    over = coarse["outcome"] == Outcome.OVERTURNS
    assert bool((coarse["duration_binds"] == 0).where(over, True).all())


def test_peaks_that_no_block_can_have_are_flagged_and_reported(coarse):
    """A block beyond alpha_c does not come back, but the closed form of "start" has roots on motions that do."""
    tree = figure4([0.9], [0.5], [0.2, 0.4, 0.6, 0.9], [2, 20])[0]
    for one in (coarse, tree):
        peak, endless = one["peak_rotation_ratio"], one["endless_peak_rotation_ratio"]
        beyond = ((peak > 1.0) & np.isfinite(peak)) | ((endless > 1.0) & np.isfinite(endless))
        flagged = one["no_motion"] == 1
        assert bool((flagged == (beyond | (one["ground_contact"] == 1))).all())
        assert not bool(flagged.sel(spacing=["end", "open"]).any())
        start = one.sel(spacing="start")
        assert float(start["peak_rotation_ratio"].where(np.isfinite(start["peak_rotation_ratio"])).max()) > 1.0
        assert bool(flagged.where(one["outcome"] != Outcome.OVERTURNS, False).sel(spacing="start").any())
        told = no_motions(one).set_index("spacing")
        assert told.loc["start", "no_motion"] == int(flagged.sel(spacing="start").sum())
        assert told.loc["start", "beyond_alpha_c"] > 0
        assert told.loc["end", "no_motion"] == 0
    assert not bool(figure4([0.9], [0.3], [0.0, 0.1], [2])[0]["no_motion"].any())


def test_the_figure_is_drawn_and_reported(coarse):
    """A panel for each restitution, a line for each I/I_1c."""
    picture = draw_figure4(coarse, "end")
    assert len(picture.axes) == 2
    lines = {line.get_label(): line.get_ydata() for line in picture.axes[0].lines}
    assert np.isnan(lines["0.8"][0])  # it overturns without secondary impulses
    own = coarse.sel(restitution=0.9, impulse_ratio=0.1, spacing="end", intermediate_count=np.inf).isel(p=0)
    np.testing.assert_array_equal(lines["0.1"], own["peak_rotation_ratio"])
    assert "(4)" in curves_text(coarse)
