"""The verdict over all motions: smallest and median factor, demands, earthquakes, directions."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import motions, summary_of, verdict

from rocking.response import Outcome
from rockpulse.motions.events import UNKNOWN
from rockpulse.views.report.events import largest_share
from rockpulse.views.report.motions import motions_of
from rockpulse.views.report.standing import Standing
from rockpulse.views.report.statements import headline
from rockpulse.views.report.verdict import Grade
from rockpulse.views.report.verdict_rows import grade_cell, verdict_table
from rockpulse.views.shared.terminal import several


def test_smallest_median_and_governing_record():
    found = verdict(summary_of([3.0, 1.5, 9.0, math.inf]))
    assert found.grade == Grade.SAFE
    assert (found.smallest, found.median, found.governing) == (1.5, 6.0, 1)
    assert found.counts[Standing.STANDS] == 4
    assert found.events_hit == 0
    assert found.largest_share == pytest.approx(1.0 - 0.1**0.25)


def test_a_body_that_rocks_is_not_safe_when_a_weaker_record_overturns_it():
    found = verdict(summary_of([0.9, 5.0], outcomes=[Outcome.ROCKS, Outcome.ROCKS]))
    assert found.grade == Grade.NOT_SAFE
    assert found.counts[Standing.WEAKER_OVERTURNS] == 1


def test_without_factors_the_margin_is_not_known():
    found = verdict(summary_of([math.nan, math.nan], outcomes=[Outcome.ROCKS, Outcome.AT_REST]))
    assert found.grade == Grade.NO_MARGIN
    assert math.isnan(found.smallest)
    assert found.governing == -1
    assert found.at_rest == 1


def test_a_smallest_factor_that_may_be_larger_is_marked():
    found = verdict(summary_of([2.0, 3.0], resolved=[0, 1]))
    assert (found.smallest, found.smallest_bound) == (2.0, True)
    found = verdict(summary_of([2.0, 2.0], resolved=[0, 1]))
    assert (found.smallest, found.smallest_bound) == (2.0, False)


def test_earthquakes_are_counted_once():
    found = verdict(summary_of([0.5, 0.6, 2.0, 3.0]), motions(4, events=["a", "a", "b", "c"]))
    assert found.events_hit == 1
    assert found.largest_share == pytest.approx(largest_share(1, 3))


@pytest.mark.parametrize(
    ("factors", "resolved", "grade"),
    [
        ([3.0, 4.0], None, Grade.SAFE),
        ([1.9, 4.0], None, Grade.NOT_SAFE),
        ([1.9, 4.0], [0, 1], Grade.NOT_KNOWN),
        ([math.nan, 4.0], None, Grade.NOT_KNOWN),
        ([math.inf, 4.0], None, Grade.SAFE),
        ([math.nan, 1.9], None, Grade.NOT_SAFE),
    ],
)
def test_a_demand_of_twice_the_pga(factors, resolved, grade):
    found = verdict(summary_of(factors, outcomes=[Outcome.ROCKS] * 2, demand=2.0, resolved=resolved))
    assert found.demands[0].grade == grade


def test_a_search_that_ends_below_the_demand_proves_nothing():
    found = verdict(summary_of([math.inf, 40.0], outcomes=[Outcome.AT_REST, Outcome.ROCKS], demand=30.0))
    assert found.grade == Grade.SAFE
    assert (found.demands[0].grade, found.demands[0].unknown) == (Grade.NOT_KNOWN, 1)


def test_a_pair_of_channels_is_as_its_worst_direction():
    of = motions(4, rows=[[0, 1], [2, 3]], kind="pair")
    found = verdict(summary_of([0.8, 5.0, 3.0, 4.0]), of)
    assert (found.counts[Standing.OVERTURNS], found.counts[Standing.STANDS]) == (1, 1)
    assert (found.smallest, found.median) == (0.8, 1.9)
    found = verdict(summary_of([3.0, 5.0, 3.0, 4.0]), motions(4, rows=[[0, 1], [2, 3]], missing=[True, False]))
    assert found.grade == Grade.NOT_KNOWN


def test_motions_of_a_sweep():
    record = [f"r{k}" for k in range(3)]
    summary = xr.Dataset({"event": ("record", ["Kobe", "Maule", "Kobe"])}, {"record": record})
    directions = xr.Dataset(
        {"record_index": (("pair", "direction"), np.array([[0, 1], [2, -1], [-1, -1]]))}, {"pair": ["a", "b", "c"]}
    )
    found = motions_of(xr.DataTree.from_dict({"/summary": summary, "/directions": directions}))
    assert (found.names, found.kind, found.directions) == (["a", "b"], "pair", 2)
    assert found.missing.tolist() == [False, True]
    assert found.events == ["Kobe", "Kobe"]
    assert "2 pairs of channels" in found.counted()


def test_the_bound_of_the_share():
    assert math.isnan(largest_share(0, 2))
    assert largest_share(3, 3) == 1.0
    # Clopper and Pearson for 1 of 10, one-sided 90 %: P(X <= 1 | p) = 0.1.
    p = largest_share(1, 10)
    assert (1.0 - p) ** 10 + 10 * p * (1.0 - p) ** 9 == pytest.approx(0.1)


def test_several():
    assert [several(count, "body") for count in (1, 3)] == ["1 body", "3 bodies"]


def test_a_capacity_that_was_not_reached_names_how_far_it_was_searched():
    """Of a record of a tenth of the demand ten times is no more than the demand: it tells nothing, others do."""
    found = verdict(summary_of([math.inf, 40.0, 60.0], outcomes=[Outcome.ROCKS] * 3, demand=20.0)).demands[0]
    assert (found.smallest, found.median, found.unknown) == (2.0, 2.5, 1)
    found = verdict(summary_of([math.inf], outcomes=[Outcome.ROCKS], demand=20.0)).demands[0]
    assert (found.smallest, found.limit) == (math.inf, 0.5)
    found = verdict(summary_of([math.inf, 40.0], outcomes=[Outcome.ROCKS] * 2, demand=5.0))
    assert (found.limit, found.demands[0].limit, found.demands[0].median) == (10.0, 2.0, math.inf)


@pytest.mark.parametrize(
    ("factors", "words"),
    [([1.0, 3.0], "stands, hardly a margin"), ([1.0999, 3.0], "stands, hardly a margin"), ([1.1, 3.0], "safe")],
)
def test_a_factor_that_a_finer_search_may_undercut_is_not_called_safe(factors, words):
    summary = summary_of(factors, outcomes=[Outcome.ROCKS] * 2)
    found = verdict(summary)
    assert grade_cell(found, "nonlinear").text == words
    assert found.events_hit == 0
    (sentence,) = headline(summary, [found], motions(2), "nonlinear")
    assert ("hardly a margin" in sentence) == (words != "safe")
    assert ("safe" in sentence) == (words == "safe")


def test_what_fails_the_demand_of_the_site_is_not_called_safe():
    summary = summary_of([1.6, 3.0], demand=2.0).assign(limit_state=(("demand",), ["collapse"]))
    found = verdict(summary)
    assert (found.grade, found.overall) == (Grade.SAFE, Grade.NOT_SAFE)
    cell = grade_cell(found, "nonlinear")
    assert (cell.text, cell.grade) == ("not safe at the demand", "bad")
    first, second = headline(summary, [found], motions(2), "nonlinear")
    assert "1 of 1 body is not safe: b (smallest SF 1.60, but capacity over demand 0.80)" in first
    assert "1 does not: b (0.80)" in second


def test_what_meets_the_demand_may_still_not_be_safe():
    summary = summary_of([0.9, 3.0], demand=0.5, outcomes=[Outcome.ROCKS] * 2)
    found = verdict(summary)
    assert (found.grade, found.demands[0].grade) == (Grade.NOT_SAFE, Grade.SAFE)
    assert grade_cell(found, "nonlinear").text == "not safe"


def test_what_stands_under_a_design_sequence_is_not_called_safe():
    summary = summary_of([1.6])
    found = verdict(summary, motions(1, kind="sequence"))
    assert (found.grade, grade_cell(found, "nonlinear").text) == (Grade.STANDS, "stands")
    (sentence,) = headline(summary, [found], motions(1, kind="sequence"), "nonlinear")
    assert "1 of 1 body stands under it: b (smallest SF 1.60)" in sentence
    assert verdict(summary_of([0.9]), motions(1, kind="sequence")).grade == Grade.NOT_SAFE
    assert verdict(summary_of([1.05]), motions(1, kind="sequence")).grade == Grade.THIN


def test_a_demand_that_is_hardly_met():
    assert verdict(summary_of([2.1, 3.0], demand=2.0)).overall == Grade.THIN
    assert verdict(summary_of([2.3, 3.0], demand=2.0)).overall == Grade.SAFE


def test_a_coarse_search_or_one_that_ended_at_once_makes_nothing_safe():
    assert verdict(summary_of([1.3, 5.0], step=1.014)).grade == Grade.SAFE
    assert verdict(summary_of([1.3, 5.0], step=1.06)).grade == Grade.THIN
    rocks = [Outcome.ROCKS]
    assert verdict(summary_of([math.inf], outcomes=rocks, up_to=1.0)).grade == Grade.THIN
    assert verdict(summary_of([math.inf], outcomes=rocks, demand=5.0)).demands[0].grade == Grade.SAFE  # twice searched
    assert verdict(summary_of([math.inf], outcomes=rocks, demand=9.5)).demands[0].grade == Grade.THIN
    assert verdict(summary_of([2.6], demand=2.0)).demands[0].grade == Grade.SAFE
    assert verdict(summary_of([2.6], demand=2.0, step=1.06)).demands[0].grade == Grade.THIN


def test_a_direction_that_overturns_is_told_though_another_is_missing():
    """Its smallest factor may be smaller still, so that the median is that of the others."""
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    summary = summary_of([0.4, math.nan, 2.0, 3.0], outcomes=[Outcome.OVERTURNS] + [Outcome.ROCKS] * 3, demand=0.5)
    found = verdict(summary, of)
    assert (found.grade, found.smallest, found.smallest_open, found.median) == (Grade.NOT_SAFE, 0.4, True, 2.0)
    assert (found.governing, found.demands[0].smallest, found.demands[0].smallest_open) == (0, 0.8, True)
    (row,) = verdict_table(summary, [found], of, "nonlinear").rows
    assert row[3].text == "≤0.40"
    whole = verdict(summary_of([0.4, 0.9, 2.0, 3.0]), motions(4, rows=[[0, 1], [2, 3]], kind="pair"))
    assert (whole.smallest, whole.smallest_open, whole.median) == (0.4, False, pytest.approx(1.2))


def test_motions_of_unknown_earthquake_make_no_earthquake_more():
    summary = summary_of([3.0, 4.0, 0.5])
    of = motions(3, events=["A", "B", UNKNOWN])
    found = verdict(summary, of)
    assert (of.event_count, found.events_hit, math.isnan(found.largest_share)) == (2, 1, True)
    assert "Not counted is: 1 motion" in of.of_unknown_event()
    of = motions(3, events=[UNKNOWN] * 3)
    assert (of.event_count, verdict(summary, of).events_hit) == (1, 1)
    assert "As one earthquake counts" in of.of_unknown_event()
    of = motions(4, events=["A", "B", "C", UNKNOWN])
    assert verdict(summary_of([0.5] * 4), of).largest_share == 1.0


def test_what_an_upper_bound_overturns_is_not_shown_to_fail_the_demand():
    summary = summary_of([0.9], demand=2.0)
    found = verdict(summary)
    sentences = headline(summary, [found], motions(1), "resonance")
    assert "not shown to be safe" in sentences[0]
    assert "1 does not for certain" in sentences[1]


def test_without_a_search_nothing_is_said_of_one():
    summary = summary_of([math.nan], outcomes=[Outcome.ROCKS], demand=2.0)
    sentences = headline(summary, [verdict(summary)], motions(1), "nonlinear")
    assert "no safety factor of this model was searched" in sentences[1]


def test_a_body_that_nothing_lifts_is_not_simply_safe():
    summary = summary_of([math.inf, math.inf], outcomes=[Outcome.AT_REST] * 2)
    found = verdict(summary)
    assert found.never_lifted
    (sentence,) = headline(summary, [found], motions(2), "nonlinear")
    assert "1 of 1 body is lifted by none of these" in sentence
    assert "safe" not in sentence
    cell = grade_cell(found, "nonlinear")
    assert (cell.text, cell.grade) == ("stands, never lifted", "fair")
    found = verdict(summary_of([math.inf, 4.0], outcomes=[Outcome.AT_REST, Outcome.ROCKS]))
    assert not found.never_lifted
    assert grade_cell(found, "nonlinear").text == "safe"
    assert not verdict(summary_of([])).never_lifted
