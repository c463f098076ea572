"""Figure 4 against the recurrence in closed form, the published half-cycles, real blocks, and dense grids."""

import math
import re

import numpy as np
import pytest

from rockpulse.errors import ConfigError
from rockpulse.models import ImpulseSequence, Outcome, sequence_response
from rockpulse.studies.paper.paper_blocks import paper_block
from rockpulse.study import figure4


@pytest.fixture(scope="module")
def figure():
    """A coarse grid with the default blocks, restitutions and duration."""
    ratios, shares = [0.1, 0.3, 0.5, 0.8], np.linspace(0.0, 1.0, 11)
    tree = figure4(impulse_ratios=ratios, secondary_ratios=shares, counts=[2, 6, math.inf], threads=1)
    return tree["figure4"].to_dataset()


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


def test_the_continuous_limit_is_the_recurrence_in_closed_form(figure):
    limit = figure.sel(intermediate_count=math.inf, spacing="end")
    for c in limit["restitution"].values:
        for u1 in limit["impulse_ratio"].values:
            for share in limit["secondary_ratio"].values:
                for p in limit["p"].values:
                    case = limit.sel(restitution=c, impulse_ratio=u1, secondary_ratio=share, p=p)
                    peak, overturned, count = by_recurrence(u1, share, c, 20.0 * p)
                    assert case["peak_rotation_ratio"].item() == pytest.approx(peak, rel=1e-10), (c, u1, share)
                    assert case["overturning_half_cycle"].item() == overturned
                    assert case["half_cycle_count"].item() == count


# VALIDATION V6 (derived, F2): half-cycle of overturning under the main sequence.
@pytest.mark.parametrize(
    ("c", "cycles"),
    [
        (0.9, {0.3: 4, 0.2: 7, 0.15: 11, 0.12: 18, 0.11: 23, 0.0999: -1}),
        (0.6, {0.5: 4, 0.45: 5, 0.41: 8, 0.3: -1}),
    ],
)
def test_without_secondary_impulses_it_is_the_main_sequence(c, cycles):
    ratios = sorted(cycles)
    tree = figure4([c], ratios, secondary_ratios=[0.0], counts=[2, math.inf], p=[1.0], duration=500.0, threads=1)
    found = tree["figure4/overturning_half_cycle"].sel(restitution=c, secondary_ratio=0.0, p=1.0)
    for u1 in ratios:
        assert set(found.sel(impulse_ratio=u1).values.ravel().tolist()) == {cycles[u1]}


@pytest.mark.parametrize("name", ["A", "B"])
@pytest.mark.parametrize("spacing", ["end", "middle", "start", "open"])
def test_the_blocks_of_the_paper_give_the_dimensionless_curves(figure, name, spacing):
    block = paper_block(name, 0.6)
    main = 0.5 * block.critical_impulse
    shares = figure["secondary_ratio"].values
    sequence = ImpulseSequence(main, shares * main, np.nan, 20.0, intermediate_count=6, spacing=spacing)
    response = sequence_response(block, sequence, threads=1)
    curve = figure.sel(restitution=0.6, impulse_ratio=0.5, spacing=spacing, intermediate_count=6).sel(
        p=float(block.p), method="nearest"
    )
    np.testing.assert_allclose(curve["peak_rotation_ratio"], response.peak_rotation_ratio, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(curve["outcome"], response.outcome)
    np.testing.assert_array_equal(curve["overturning_half_cycle"], response.overturning_half_cycle)


def test_the_limit_is_one_for_all_spacings_and_the_larger_n_the_nearer(figure):
    limit = figure["peak_rotation_ratio"].sel(intermediate_count=math.inf)
    assert all(
        limit.sel(spacing=name).equals(limit.sel(spacing="end").assign_coords(spacing=name)) for name in ("open",)
    )
    case = {"restitution": 0.6, "impulse_ratio": 0.3, "p": figure["p"].values[0]}
    apart = np.abs(figure["peak_rotation_ratio"].sel(case) - limit.sel(case)).sel(secondary_ratio=slice(0.2, 0.8))
    assert bool((apart.sel(intermediate_count=6) < apart.sel(intermediate_count=2)).all())


def test_a_duration_that_does_not_bind_gives_the_endless_peak(figure):
    free = figure["duration_binds"] == 0
    assert 0 < int(free.sum()) < free.size
    peak, endless = figure["peak_rotation_ratio"], figure["endless_peak_rotation_ratio"]
    assert bool(((peak <= endless * (1.0 + 1e-12) + 1e-12) | (peak == endless)).all())
    np.testing.assert_allclose(peak.values[free.values], endless.values[free.values], rtol=1e-9, atol=1e-12)
    over = figure["outcome"] == Outcome.OVERTURNS
    assert bool((figure["duration_binds"] == 0).where(over, True).all())


def test_a_longer_input_frees_what_a_short_one_binds():
    def bound(duration):
        tree = figure4([0.6], [0.3], [0.0, 0.3, 0.6], [2], [1.0], duration=duration, threads=1)
        return int(tree["figure4/duration_binds"].sum())

    assert bound(5.0) == 12
    assert bound(200.0) == 0


def test_start_and_middle_are_flagged_where_the_march_leaves_the_ground_behind(figure):
    contact = figure["ground_contact"].sel(intermediate_count=2) == 1
    share = figure["secondary_ratio"]
    assert not bool(contact.sel(spacing=["end", "open"]).any())
    assert not bool(contact.sel(spacing="start").where(share < 2.0 / 3.0, False).any())
    assert not bool(contact.sel(spacing="middle").where(share < 6.0 / 7.0, False).any())
    assert bool(contact.sel(spacing="start").where(share > 0.75, True).all())


def test_peaks_that_no_block_can_have_are_flagged_and_told(figure):
    """A block beyond alpha_c does not come back, but the closed form of "start" has roots on motions that do."""
    tree = figure4([0.9], [0.5], [0.2, 0.4, 0.6, 0.9], [2, 20], threads=1)["figure4"].to_dataset()
    for one in (figure, tree):
        peak, endless = one["peak_rotation_ratio"], one["endless_peak_rotation_ratio"]
        beyond = ((peak > 1.0) & np.isfinite(peak)) | ((endless > 1.0) & np.isfinite(endless))
        flagged = one["no_motion"] == 1
        assert bool((flagged == (beyond | (one["ground_contact"] == 1))).all())
        assert not bool(flagged.sel(spacing=["end", "open"]).any())
        start = one.sel(spacing="start")
        assert float(start["peak_rotation_ratio"].where(np.isfinite(start["peak_rotation_ratio"])).max()) > 1.0
        assert bool(flagged.where(one["outcome"] != Outcome.OVERTURNS, False).sel(spacing="start").any())
        assert re.search(
            r"no_motion\): .*start \d+ of \d+ cases, \d+ peaks beyond alpha_c, up to", one.attrs["comment"]
        )
    free = figure4([0.9], [0.3], [0.0, 0.1], [2], threads=1)["figure4"]
    assert "no_motion" not in free.attrs["comment"]
    assert not bool(free["no_motion"].any())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"counts": [3]}, "different even numbers"),
        ({"counts": [0]}, "different even numbers"),
        ({"counts": [2, 2]}, "different even numbers"),
        ({"counts": [math.nan]}, "different even numbers"),
        ({"secondary_ratios": [0.0, 1.2]}, "I_s/I: expected numbers from 0 to 1"),
        ({"secondary_ratios": [0.5, 0.2]}, "increasing order"),
        ({"impulse_ratios": [0.0, 0.2]}, "I/I_1c: expected positive numbers"),
        ({"restitutions": [1.5]}, "restitution: expected numbers from 0 to 1"),
        ({"restitutions": []}, "got none"),
        ({"p": [-1.0]}, "p: expected numbers from 0.01 to 100"),
        ({"duration": math.inf}, "duration: expected numbers from 0.01 to 10000"),
    ],
)
def test_a_value_out_of_range_is_named(options, words):
    with pytest.raises(ConfigError, match=words):
        figure4(**options)


@pytest.mark.slow
def test_dense_curves_are_monotonic_wherever_the_duration_does_not_bind():
    shares, ratios = np.linspace(0.0, 1.0, 201), np.round(np.arange(0.1, 1.2001, 0.1), 10)
    tree = figure4(impulse_ratios=ratios, secondary_ratios=shares, counts=[2, 4, 40, math.inf], threads=1)
    figure = tree["figure4"].to_dataset()
    peak, free = figure["peak_rotation_ratio"].values, figure["duration_binds"].values == 0
    both = free[:, :, 1:] & free[:, :, :-1]
    over = np.isinf(peak[:, :, 1:]) & np.isinf(peak[:, :, :-1])
    assert np.all(~both | over | (peak[:, :, 1:] < peak[:, :, :-1]))
    both, over = free[:, 1:] & free[:, :-1], np.isinf(peak[:, 1:]) & np.isinf(peak[:, :-1])
    spacing = figure["spacing"].values.tolist()
    usual = [spacing.index(name) for name in ("end", "middle", "open")]
    rising = (~both | over | (peak[:, 1:] > peak[:, :-1]))[..., usual, :, :]
    assert np.all(rising)
