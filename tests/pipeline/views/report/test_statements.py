"""The verdict in words: its sentences, and its table."""

import math

import numpy as np
import pytest
from report_cases import answers, motions, probable, summary_of, verdict

from rocking.response import Outcome
from rockpulse.assessment.verdict import Grade
from rockpulse.motions.events import UNKNOWN
from rockpulse.views.report.bodies import body_table, grade_cell
from rockpulse.views.report.statements import counted_by, headline, of_unknown_event


@pytest.mark.parametrize(
    ("probability", "words", "grade", "sentence"),
    [
        ([0.0, 0.0999], "rocks", "good", "1 of 1 body rocks: b (P 0.050, at most "),
        ([0.0, 0.1], "may overturn", "fair", "1 of 1 body may overturn: b (P 0.050, at most "),
        ([0.9, 0.2], "overturns", "bad", "1 of 1 body overturns: b (P 0.55, at most "),
        ([math.nan, 0.2], "not known", "unknown", "1 of 1 body cannot be judged: b (P 0.20"),
    ],
)
def test_a_body_in_a_word_and_in_a_sentence(probability, words, grade, sentence):
    summary = probable(probability)
    found = verdict(summary)
    cell = grade_cell(found)
    assert (cell.text, cell.grade) == (words, grade)
    (told,) = headline(answers(summary), [found])
    assert told.startswith(f"By the nonlinear model, under 2 records of 2 earthquakes: {sentence}")
    assert "smallest factor of 10 % " in told


def test_the_demand_of_the_site_decides():
    """Its probability at the demand, whatever the records do as they are."""
    summary = probable([0.9] * 5, at_demand=[0.0, 0.2, 0.1, 0.1, 0.0], demand=0.5)
    summary = summary.assign(limit_state=(("demand",), ["collapse"]))
    found = verdict(summary)
    assert (found.grade, found.overall) == (Grade.OVERTURNS, Grade.MAY_OVERTURN)
    cell = grade_cell(found)
    assert (cell.text, cell.grade) == ("may overturn", "fair")
    first, second = headline(answers(summary), [found])
    assert "1 of 1 body may overturn: b (P at ULS 0.080, at most " in first
    assert second == (
        "At the demand “ULS”, PGA 0.5 m/s², collapse, stand 5 records of 5 earthquakes that are brought to it."
    )
    table = body_table(answers(summary), [found])
    shown = {heading.title: cell.marked for heading, cell in zip(table.headings, table.rows[0], strict=True)}
    assert shown["P at ULS"].startswith("0.080 (")
    assert shown["P as it is"] == "0.90"


def test_fewer_than_five_earthquakes_at_the_demand_are_no_verdict():
    summary = probable(
        [0.0] * 6, at_demand=[0.9, 0.9, 0.9, 0.9, math.nan, math.nan], demand=1.0, to_demand=[1, 2, 3, 4, 5, 0.2]
    )
    found = verdict(summary)
    assert (grade_cell(found).text, grade_cell(found).grade) == ("no verdict", "unknown")
    first, second = headline(answers(summary), [found])
    assert "1 of 1 body cannot be judged: b (P at ULS 0.90, " in first
    assert "stand 4 records of 4 earthquakes that are brought to it; left out are 2, which lie farther" in second
    assert second.endswith("That is no verdict: 5 earthquakes are needed.")


def test_under_a_design_sequence_there_is_no_probability():
    summary, of = summary_of([1.6]), motions(1, kind="sequence")
    found = verdict(summary, of)
    assert (found.grade, grade_cell(found).text) == (Grade.ROCKS, "rocks")
    (sentence,) = headline(answers(summary, of), [found])
    assert "1 of 1 body rocks: b (smallest SF 1.60)" in sentence
    assert "That is not called safe" in counted_by(answers(summary, of))
    titles = [heading.title for heading in body_table(answers(summary, of), [found]).headings]
    assert not {"P", "share", "interval"} & set(titles)
    assert verdict(summary_of([0.9]), motions(1, kind="sequence")).grade == Grade.OVERTURNS


def test_what_the_words_mean_is_said_with_their_limits():
    words = counted_by(answers(probable([0.1, 0.2], demand=2.0)))
    assert "Overturns: 0.5 or more. May overturn: 0.05 or more." in words
    assert "each by one factor, a pair by the geometric mean of both; factors outside 0.25 to 4 are left out" in words
    words = counted_by(answers(summary_of([2.0])))
    assert words.startswith("The share of earthquakes")


def test_a_direction_that_overturns_is_told_though_another_is_missing():
    """Its smallest factor may be smaller still, so that the median is that of the others."""
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    summary = summary_of([0.4, math.nan, 2.0, 3.0], outcomes=[Outcome.OVERTURNS] + [Outcome.ROCKS] * 3, demand=0.5)
    found = verdict(summary, of)
    assert found.grade == Grade.OVERTURNS
    assert (found.margin.smallest, found.margin.open, found.margin.median) == (0.4, True, 2.0)
    assert (found.governing, found.demands[0].margin.smallest, found.demands[0].margin.open) == (0, 0.8, True)
    table = body_table(answers(summary, of), [found])
    shown = dict(zip((heading.title for heading in table.headings), table.rows[0], strict=True))
    assert (shown["smallest SF"].marked, shown["share as it is"].marked) == ("≤0.40", "0.50")
    whole = verdict(summary_of([0.4, 0.9, 2.0, 3.0]), motions(4, rows=[[0, 1], [2, 3]], kind="pair"))
    assert (whole.margin.smallest, whole.margin.open, whole.margin.median) == (0.4, False, pytest.approx(1.2))


def test_the_table_of_bodies_has_the_probability_with_its_interval():
    summary = probable([0.0] * 10, factor_10=np.full(10, math.inf))
    table = body_table(answers(summary), [verdict(summary)])
    shown = {heading.title: cell.marked for heading, cell in zip(table.headings, table.rows[0], strict=True)}
    assert shown["verdict"] == "rocks"
    assert (shown["P"], shown["interval"], shown["smallest factor of 10 %"]) == ("0", "0 to 0.26", ">10")
    assert [heading.note for heading in table.headings if heading.title == "interval"] == ["90%, 10 earthquakes"]


def test_motions_of_unknown_earthquake_make_no_earthquake_more():
    summary = probable([0.0, 0.0, 0.9])
    of = motions(3, events=["A", "B", UNKNOWN])
    assert of.event_count == 2
    assert verdict(summary, of).share.value == pytest.approx(0.3)
    assert "Not counted is: 1 motion" in of_unknown_event(of)
    of = motions(3, events=[UNKNOWN] * 3)
    assert (of.event_count, verdict(summary, of).share.value) == (1, pytest.approx(0.3))
    assert "As one earthquake counts" in of_unknown_event(of)


def test_what_an_upper_bound_overturns_is_not_shown_to_fail_the_demand():
    summary = summary_of([0.9] * 5, demand=2.0).assign_coords(model=["resonance"])
    found = verdict(summary, model="resonance")
    assert "1 of 1 body may overturn" in headline(answers(summary, motions(5), "resonance"), [found])[0]


def test_without_a_search_nothing_is_known_of_the_demand():
    summary = summary_of([math.nan] * 5, outcomes=[Outcome.ROCKS] * 5, demand=2.0)
    found = verdict(summary)
    assert (found.overall, found.word) == (Grade.NOT_KNOWN, "not known")


def test_a_body_that_nothing_lifts_stays_and_nothing_is_said_of_stronger_motions():
    summary = probable([0.0, 0.0], uplift=0.0, factor_10=[math.inf] * 2, outcomes=[Outcome.AT_REST] * 2)
    (sentence,) = headline(answers(summary), [verdict(summary)])
    assert "1 of 1 body stays at rest: none of these lifts it, so that they say nothing of stronger ones" in sentence
    assert grade_cell(verdict(summary)).text == "stays"
