"""The verdict in words: its sentences, and its table."""

import math

import pytest
from report_cases import answers, motions, summary_of, verdict

from rocking.response import Outcome
from rockpulse.assessment.verdict import Grade
from rockpulse.motions.events import UNKNOWN
from rockpulse.views.report.bodies import body_table, grade_cell
from rockpulse.views.report.statements import headline, of_unknown_event


@pytest.mark.parametrize(
    ("factors", "words"),
    [([1.0, 3.0], "stands, hardly a margin"), ([1.0999, 3.0], "stands, hardly a margin"), ([1.1, 3.0], "safe")],
)
def test_a_factor_that_a_finer_search_may_undercut_is_not_called_safe(factors, words):
    summary = summary_of(factors, outcomes=[Outcome.ROCKS] * 2)
    found = verdict(summary)
    assert grade_cell(found, "nonlinear").text == words
    assert found.events_hit == 0
    (sentence,) = headline(answers(summary, motions(2), "nonlinear"), [found])
    assert ("hardly a margin" in sentence) == (words != "safe")
    assert ("safe" in sentence) == (words == "safe")


def test_what_fails_the_demand_of_the_site_is_not_called_safe():
    summary = summary_of([1.6, 3.0], demand=2.0).assign(limit_state=(("demand",), ["collapse"]))
    found = verdict(summary)
    assert (found.grade, found.overall) == (Grade.SAFE, Grade.NOT_SAFE)
    cell = grade_cell(found, "nonlinear")
    assert (cell.text, cell.grade) == ("not safe at the demand", "bad")
    first, second = headline(answers(summary, motions(2), "nonlinear"), [found])
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
    (sentence,) = headline(answers(summary, motions(1, kind="sequence"), "nonlinear"), [found])
    assert "1 of 1 body stands under it: b (smallest SF 1.60)" in sentence
    assert verdict(summary_of([0.9]), motions(1, kind="sequence")).grade == Grade.NOT_SAFE
    assert verdict(summary_of([1.05]), motions(1, kind="sequence")).grade == Grade.THIN


def test_a_direction_that_overturns_is_told_though_another_is_missing():
    """Its smallest factor may be smaller still, so that the median is that of the others."""
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    summary = summary_of([0.4, math.nan, 2.0, 3.0], outcomes=[Outcome.OVERTURNS] + [Outcome.ROCKS] * 3, demand=0.5)
    found = verdict(summary, of)
    assert (found.grade, found.margin.smallest, found.margin.open, found.margin.median) == (
        Grade.NOT_SAFE,
        0.4,
        True,
        2.0,
    )
    assert (found.governing, found.demands[0].margin.smallest, found.demands[0].margin.open) == (0, 0.8, True)
    (row,) = body_table(answers(summary, of), [found]).rows
    assert row[3].marked == "≤0.40"
    whole = verdict(summary_of([0.4, 0.9, 2.0, 3.0]), motions(4, rows=[[0, 1], [2, 3]], kind="pair"))
    assert (whole.margin.smallest, whole.margin.open, whole.margin.median) == (0.4, False, pytest.approx(1.2))


def test_motions_of_unknown_earthquake_make_no_earthquake_more():
    summary = summary_of([3.0, 4.0, 0.5])
    of = motions(3, events=["A", "B", UNKNOWN])
    found = verdict(summary, of)
    assert (of.event_count, found.events_hit, math.isnan(found.largest_share)) == (2, 1, True)
    assert "Not counted is: 1 motion" in of_unknown_event(of)
    of = motions(3, events=[UNKNOWN] * 3)
    assert (of.event_count, verdict(summary, of).events_hit) == (1, 1)
    assert "As one earthquake counts" in of_unknown_event(of)
    of = motions(4, events=["A", "B", "C", UNKNOWN])
    assert verdict(summary_of([0.5] * 4), of).largest_share == 1.0


def test_what_an_upper_bound_overturns_is_not_shown_to_fail_the_demand():
    summary = summary_of([0.9], demand=2.0)
    found = verdict(summary)
    sentences = headline(answers(summary, motions(1), "resonance"), [found])
    assert "not shown to be safe" in sentences[0]
    assert "1 does not for certain" in sentences[1]


def test_without_a_search_nothing_is_said_of_one():
    summary = summary_of([math.nan], outcomes=[Outcome.ROCKS], demand=2.0)
    sentences = headline(answers(summary, motions(1), "nonlinear"), [verdict(summary)])
    assert "no safety factor of this model was searched" in sentences[1]


def test_a_body_that_nothing_lifts_is_not_simply_safe():
    summary = summary_of([math.inf, math.inf], outcomes=[Outcome.AT_REST] * 2)
    found = verdict(summary)
    assert found.never_lifted
    (sentence,) = headline(answers(summary, motions(2), "nonlinear"), [found])
    assert "1 of 1 body is lifted by none of these" in sentence
    assert "safe" not in sentence
    cell = grade_cell(found, "nonlinear")
    assert (cell.text, cell.grade) == ("stands, never lifted", "fair")
    found = verdict(summary_of([math.inf, 4.0], outcomes=[Outcome.AT_REST, Outcome.ROCKS]))
    assert not found.never_lifted
    assert grade_cell(found, "nonlinear").text == "safe"
    assert not verdict(summary_of([])).never_lifted
