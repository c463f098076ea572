"""The verdict in words: its sentences, and its table."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from markupsafe import Markup
from report_cases import answers, motions, probable, summary_of, verdict
from results_tree import results_tree

from rocking.response import Outcome
from rockpulse.assessment.verdict import Grade
from rockpulse.errors import ResultsError
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.variables.summary import SUMMARY
from rockpulse.views.report.verdict import (
    Drawing,
    basis,
    body_drawings,
    body_table,
    by_severity,
    cards,
    counted_by,
    motions_words,
    priorities,
    sentence,
)
from rockpulse.views.shared.table_columns import grade_cell
from rockpulse.views.shared.verdict_table import of_unknown_event, verdict_legend


def headed(answers_, found):
    """The cells of the first row of the table of bodies, by heading."""
    table = body_table(answers_, [found])
    titles = (heading.title.replace("\N{NO-BREAK SPACE}", " ") for heading in table.headings)
    return {title: cell.marked for title, cell in zip(titles, table.rows[0], strict=True)}


@pytest.mark.parametrize(
    ("probability", "words", "grade", "value"),
    [
        ([0.0, 0.24, 0.0, 0.0, 0.0], "rocks", "good", "0.048"),
        ([0.0, 0.25, 0.0, 0.0, 0.0], "may overturn", "fair", "0.050"),
        ([0.9, 0.2, 0.9, 0.5, 0.25], "overturns", "bad", "0.55"),
        ([math.nan, 0.49, 0.49, 0.49, 0.49], "not known", "unknown", "0.49"),
    ],
)
def test_a_body_in_a_word_and_in_a_sentence(probability, words, grade, value):
    summary = probable([0.0] * 5, at_demand=probability, demand=1.0)
    found = verdict(summary)
    cell = grade_cell(found.deciding)
    assert (cell.text, cell.grade) == (words, grade)
    shown = sentence(answers(summary), found)
    assert shown.startswith(f"Probability of overturning {value}, upper 90 % ")
    assert shown.endswith("at the demand “ULS”, from 5 earthquakes. 0 of 5 records overturn the nominal body.")


def test_each_body_has_one_row_for_its_governing_demand_and_the_annex_has_all():
    summary = probable([0.0] * 5, at_demand=[0.9, 0.2, 0.9, 0.5, 0.25], demand=1.0)
    found = verdict(summary)
    milder = replace(found.deciding, demand="SLE", grade=Grade.ROCKS)
    both = replace(found, demands=(milder, found.deciding))
    shown, cases = body_table(answers(summary), [both]), body_table(answers(summary), [both], every=True)
    assert [len(shown.rows), len(cases.rows)] == [1, 2]
    assert "overturns" in [cell.text for cell in shown.rows[0]]
    assert shown.footnotes == ("One row per body: its governing demand and restitution; the annex has every case.",)
    assert (body_table(answers(summary), [found]).footnotes, cases.footnotes) == ((), ())


def test_a_body_that_slides_first_comes_last():
    found = verdict(probable([0.0] * 5, at_demand=[0.9, 0.2, 0.9, 0.5, 0.25], demand=1.0))
    grades = (Grade.ROCKS, Grade.SLIDES_FIRST, Grade.OVERTURNS, Grade.MAY_OVERTURN)
    every = [replace(found, demands=(replace(found.deciding, grade=grade),)) for grade in grades]
    assert [one.grade for one in sorted(every, key=by_severity)] == [grades[2], grades[3], grades[0], grades[1]]


def test_the_priorities_state_an_action_for_each_body():
    """A capacity below the demand is never graded as good, whatever P is."""
    summary = probable([0.0] * 5, at_demand=[0.2, 0.0, 0.0, 0.0, 0.0], demand=1.0, factor_10=[0.95, 2, 2, 2, 2])
    found = verdict(summary)
    rows = {"b": found}
    for name, changes in {"c": {"grade": Grade.SLIDES_FIRST}, "d": {"grade": Grade.OVERTURNS}}.items():
        rows[name] = replace(found, body=found.body._replace(block=name), demands=(replace(found.deciding, **changes),))
    every = xr.concat([summary.assign_coords(block=[name]) for name in rows], "block", data_vars="minimal")
    placed = [replace(one, body=one.body._replace(place=k)) for k, one in enumerate(rows.values())]
    shown = priorities(answers(every), placed)
    assert [[cell.text for cell in row[1:]] for row in shown.rows] == [
        ["d", "overturns", "Anchor it or widen its base."],
        ["b", "rocks, no margin", "Look into its governing record: capacity/demand is 0.95."],
        ["c", "slides first", "Check how far it may slide, which is not computed here."],
    ]
    assert [row[2].grade for row in shown.rows] == ["bad", "fair", "unknown"]
    assert verdict_legend(answers(summary), found.findings)[0].count("but capacity/demand is below 1") == 1


def test_without_a_demand_the_records_that_overturn_are_counted():
    summary = probable([0.9, 0.0, 0.1], factor_10=[0.4, 3.0, 1.0])
    found = verdict(summary)
    shown = sentence(answers(summary), found)
    assert shown == "1 of 3 records overturn it as recorded; smallest scale factor at P = 10 %: 0.40."
    assert grade_cell(found.deciding).text == "-"
    shown = headed(answers(summary), found)
    assert (shown["records that overturn"], shown["scale factor at P = 10 %"]) == ("1 of 3", "0.40")
    assert not {"P", "verdict"} & set(shown)


def test_of_bodies_without_a_verdict_that_of_the_smaller_factor_comes_first():
    """Whether the probability at the demand is not known at all, or that of the records that are known is 0."""
    summary = probable([0.0] * 5, factor_10=[3.0] * 5, at_demand=[0.0, *[math.nan] * 4], demand=1.0)
    high = verdict(summary)
    low = verdict(probable([0.0] * 5, factor_10=[0.9] * 5, at_demand=[math.nan] * 5, demand=1.0))
    low = replace(low, body=low.body._replace(block="low", place=1))
    assert high.grade == low.grade == Grade.NOT_KNOWN
    assert (high.share.value, math.isnan(low.share.value)) == (0.0, True)
    drawn = [Drawing(Markup("<svg/>"), "")] * 2
    summary = xr.concat([summary, summary.assign_coords(block=["low"])], "block", data_vars="minimal", coords="minimal")
    assert [card.name for card in cards(answers(summary), [high, low], drawn)] == ["low", high.body.block]


def test_the_demand_of_the_site_decides_from_five_earthquakes_on():
    """Every number is at the demand, whatever the records do as they are."""
    summary = probable([0.9] * 5, at_demand=[0.0, 0.2, 0.1, 0.1, 0.0], demand=0.5)
    own = {"demand_rotation_ratio": [0.1, math.inf, 0.3, 0.2, 0.2], "demand_outcome": [1, 2, 1, 1, 1]}
    dims = ("record", "block", "demand")
    summary = summary.assign({name: (dims, np.array(values)[:, None, None]) for name, values in own.items()})
    summary = summary.assign(alpha_c=("block", [0.1]), height=("block", [2.0]))
    shown = headed(answers(summary), verdict(summary))
    assert shown["verdict"] == "may overturn"
    assert (shown["P"], shown["records that overturn"], shown["capacity/ demand"]) == ("0.080", "1 of 5", "1.80")
    assert (shown["median rotation"], shown["largest rotation without overturning"]) == ("0.20", "0.30")
    assert shown["top displ. at that rotation"] == "6.00"
    shown = sentence(answers(summary), verdict(summary))
    assert shown.startswith("Probability of overturning 0.080, upper 90 % ")
    assert shown.endswith(
        "1 of 5 records overturn the nominal body; the largest rotation under the other records is 0.30 α_c, 6.00 cm "
        "at the top."
    )
    summary = probable(
        [0.0] * 6, at_demand=[0.9, 0.9, 0.9, 0.9, math.nan, math.nan], demand=1.0, to_demand=[1, 2, 3, 4, 5, 0.2]
    )
    found = verdict(summary)
    assert (grade_cell(found.deciding).text, grade_cell(found.deciding).grade) == ("-", "unknown")
    shown = sentence(answers(summary), found)
    assert shown.startswith("Probability of overturning 0.90, upper 90 % ")
    assert shown.endswith(
        "from 4 earthquakes. 0 of 4 records overturn the nominal body. No verdict: 5 earthquakes are needed."
    )
    legend = verdict_legend(answers(summary), found.findings)
    assert "Not counted: 2 motions with a scale factor for the demand “ULS” outside 0.25 to 4." in legend


def test_under_a_design_sequence_there_is_no_probability():
    summary, of = summary_of([1.6]), motions(1, kind="sequence")
    found = verdict(summary, of)
    assert (found.grade, grade_cell(found.deciding).text) == (Grade.ROCKS, "rocks")
    shown = sentence(answers(summary, of), found)
    assert shown.startswith(
        "Neither the design sequence nor a weaker one overturns it; smallest scale factor on its main"
    )
    assert shown.endswith("impulse at which it overturns: 1.60.")
    assert "This does not prove safety" in counted_by(answers(summary, of))
    titles = [heading.title for heading in body_table(answers(summary, of), [found]).headings]
    assert not {"P", "share", "interval"} & set(titles)
    for factor, outcome, words in (
        (0.9, Outcome.OVERTURNS, "The design sequence, or a weaker one, overturns it; smallest scale factor on its"),
        (math.nan, Outcome.OVERTURNS, "The design sequence, or a weaker one, overturns it."),
        (math.nan, Outcome.ROCKS, "Neither the design sequence nor a weaker one overturns it."),
    ):
        summary = summary_of([factor], outcomes=[outcome])
        assert sentence(answers(summary, of), verdict(summary, of)).startswith(words)


def test_a_body_that_nothing_overturns_has_its_interval_and_one_that_nothing_lifts_stays():
    summary = probable([0.0] * 10, factor_10=np.full(10, math.inf), at_demand=[0.0] * 10, demand=1.0)
    shown = headed(answers(summary), verdict(summary))
    assert (shown["verdict"], shown["P"], shown["P, upper 90 %"], shown["capacity/ demand"]) == (
        "rocks", "0", "0.17", ">10"
    )  # fmt: skip
    summary = summary.assign(uplift_ratio=(("record", "block"), np.full((10, 1), 0.3)))
    shown = sentence(answers(summary), verdict(summary))
    assert shown.startswith("None of 10 records lifts the body at the demand “ULS”; no conclusion can be drawn")
    assert grade_cell(verdict(summary).deciding).text == "at rest"


def test_motions_of_unknown_earthquake_make_no_earthquake_more():
    summary = probable([0.0, 0.0, 0.9])
    of = motions(3, events=["A", "B", UNKNOWN])
    assert verdict(summary, of).share.value == pytest.approx(0.3)
    assert "not among those that a verdict needs: 1 motion" in of_unknown_event(of)
    of = motions(3, events=[UNKNOWN] * 3)
    assert verdict(summary, of).share.value == pytest.approx(0.3)
    assert "Counted as one earthquake" in of_unknown_event(of)


def test_the_motions_are_counted_by_their_kind():
    known = {"events": ["A", "B", "A"]}
    assert motions_words(motions(3, **known)) == "3 records of 2 earthquakes"
    pairs = {"rows": [[0, 1], [2, 3], [4, 5]], "kind": "pair"}
    worst, mean = (motions_words(motions(6, any_azimuth=any_, **known, **pairs)) for any_ in (False, True))
    assert worst == "3 pairs of channels of 2 earthquakes, each in the worst of 2 directions"
    assert mean == "3 pairs of channels of 2 earthquakes, each averaged over 2 directions"
    sequence = motions_words(motions(1, kind="sequence"))
    assert sequence == "one design sequence, which represents the records of its site calibration"


def test_what_the_verdicts_rest_on_and_what_their_words_mean_is_said():
    summary = probable([0.1, 0.2], demand=2.0)
    plain = basis(answers(summary), "")
    assert plain.startswith("By the nonlinear model, under 2 records of 2 earthquakes. The demand “ULS”: ")
    assert plain.count("m/s²") == 1
    assert basis(answers(summary), "one file unused") == plain.replace(
        "earthquakes.", "earthquakes; one file unused.", 1
    )
    stated = summary.assign(limit_state=(("demand",), ["collapse"]))
    assert basis(answers(stated), "") == plain.removesuffix(".") + ", collapse."
    assert basis(answers(probable([0.1, 0.2])), "") == "By the nonlinear model, under 2 records of 2 earthquakes."
    words = counted_by(answers(probable([0.1, 0.2], demand=2.0)))
    assert "Overturns: 0.5 or more. May overturn: 0.05 or more." in words
    assert counted_by(answers(summary_of([2.0]))).startswith("The share of earthquakes")


def test_a_body_is_drawn_with_its_first_pedestal_and_with_both():
    """The second and the third body of the results are the first one with a part of what it stands on."""
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    wall = str(summary["block"].values[0])
    pedestals = "".join(f"[[block.pedestal]]\nwidth = {w}\nheight = 0.5\nmass = 900.0\n" for w in (1.1, 0.9))
    tree.attrs["configuration"] = f'[[block]]\nname = "{wall}"\nwidth = 0.5\nheight = 2.0\nmass = 500.0\n{pedestals}'
    names = np.array(["", wall, wall], dtype=object)
    tree["summary"] = xr.DataTree(summary.assign(pedestal_of=SUMMARY["pedestal_of"].variable(names)))
    assert [one.svg.count('class="pedestal"') for one in body_drawings(tree)] == [2, 1, 0]
    tree["summary"]["pedestal_of"].values[0] = "nobody"
    with pytest.raises(ResultsError, match="/summary/pedestal_of: expected the name of a body, found 'nobody'"):
        body_drawings(tree)
