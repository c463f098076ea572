"""The verdict on a body: the answer under one record, the probability over earthquakes, and the words for it."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, probable, summary_of, turned, verdict

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import (
    Grade,
    Standing,
    reasons_unknown,
    slides_first,
    standings,
    verdicts,
    worse_with_pedestal,
)
from rockpulse.earthquakes import probability_interval
from rockpulse.views.shared.table import Cell
from rockpulse.views.shared.table_columns import filled, grade_cell
from rockpulse.views.shared.verdict_table import verdict_columns, verdict_rows
from rockpulse.views.text.verdicts import body_verdicts

OF = ("record", "block", "model")
INF, NAN = math.inf, math.nan


def one(**answers):
    """A summary of one answer: at factor 1 it rocks, with a safety factor of 2, unless said otherwise."""
    found = {"outcome": Outcome.ROCKS, "safety_factor": 2.0, "factor_resolved": 1, "applicable": 1}
    found |= {"reason": Reason.NONE} | answers
    variables = {name: (OF, np.full((1, 1, 1), value)) for name, value in found.items() if value is not None}
    variables["peak_rotation_ratio"] = (OF, np.full((1, 1, 1), 0.4))
    variables["restitution"] = (("block",), np.array([0.9]))
    return xr.Dataset(variables, {"record": ["r"], "block": ["b"], "model": ["nonlinear"]})


@pytest.mark.parametrize(
    ("answers", "expected"),
    [
        ({}, Standing.STANDS),
        ({"safety_factor": 1.0}, Standing.STANDS),
        ({"safety_factor": np.inf, "safe_up_to": 10.0, "outcome": Outcome.AT_REST}, Standing.STANDS),
        ({"safety_factor": np.nan}, Standing.STANDS),
        ({"safety_factor": 0.9}, Standing.WEAKER_OVERTURNS),
        ({"safety_factor": 0.9, "factor_resolved": 0}, Standing.UNKNOWN),
        ({"safety_factor": 1.0, "factor_resolved": 0}, Standing.STANDS),
        ({"safety_factor": 2.0, "factor_resolved": 0}, Standing.STANDS),
        ({"outcome": Outcome.OVERTURNS, "safety_factor": 0.5}, Standing.OVERTURNS),
        ({"outcome": Outcome.OVERTURNS, "applicable": 0}, Standing.OVERTURNS),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": np.nan}, Standing.UNKNOWN),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": 0.5}, Standing.WEAKER_OVERTURNS),
        ({"applicable": 0}, Standing.UNKNOWN),
    ],
    ids=lambda value: str(value),
)
def test_the_standing_of_an_answer(answers, expected):
    summary = one(**answers)
    assert standings(Answers(summary))[0, 0] == expected


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({}, ""),
        ({"outcome": Outcome.UNRESOLVED, "reason": Reason.FREE_FLIGHT}, "free_flight"),
        ({"outcome": Outcome.UNRESOLVED}, "unresolved"),
        ({"applicable": 0}, "outside"),
        ({"safety_factor": 0.9, "factor_resolved": 0}, "weaker"),
    ],
)
def test_why_it_is_not_known(answers, words):
    summary = one(**answers)
    assert str(reasons_unknown(Answers(summary))[0, 0]) == words


def judged(probability, of=None, **options):
    """The verdict at a demand on a body with the probabilities at that demand."""
    options = {"demand": 1.0} | options
    return verdict(probable([0.0] * len(probability), at_demand=probability, **options), of)


@pytest.mark.parametrize(
    ("probability", "grade"),
    [
        ([0.0] * 5, Grade.ROCKS),
        ([0.0499] * 5, Grade.ROCKS),
        ([0.05] * 5, Grade.MAY_OVERTURN),
        ([0.4999] * 5, Grade.MAY_OVERTURN),
        ([0.5] * 5, Grade.OVERTURNS),
        ([1.0, 1.0, 1.0, 0.0, 0.0], Grade.OVERTURNS),
        ([0.25, 0.0, 0.0, 0.0, 0.0], Grade.MAY_OVERTURN),
        ([0.24, 0.0, 0.0, 0.0, 0.0], Grade.ROCKS),
        ([NAN, 0.0, 0.0, 0.0, 0.0], Grade.NOT_KNOWN),
        ([0.9] * 4, Grade.NO_VERDICT),
    ],
)
def test_the_words_of_a_probability_at_a_demand(probability, grade):
    found = judged(probability)
    assert (found.grade, found.deciding.few) == (grade, len(probability) < 5)
    assert (found.deciding.word == "") == (grade == Grade.NO_VERDICT)


def test_without_a_demand_there_is_no_word_but_all_numbers():
    found = verdict(probable([0.9, 0.8, 0.1, 0.0, 0.0, 0.0]))
    assert (found.grade, found.deciding.word) == (Grade.NO_VERDICT, "")
    assert (found.deciding.overturned, found.deciding.motions, found.deciding.margin.smallest) == (2, 6, 0.9)


def test_earthquakes_weigh_alike_whatever_their_number_of_records():
    assert verdict(probable([0.9, 0.9, 0.9, 0.1]), motions(4, events=["a", "a", "a", "b"])).share.value == 0.5
    assert verdict(probable([0.9, 0.9, 0.9, 0.1])).share.value == pytest.approx(0.7)


def weighted(ratios, probability=None, **options):
    """A summary at a demand whose records, scaled to it, have these PGA over the uplift PGA of the body."""
    summary = probable([0.0] * len(ratios), at_demand=probability or [0.0] * len(ratios), demand=1.0, **options)
    return summary.assign(uplift_ratio=(OF[:2], np.array(ratios, dtype=float)[:, None]))


def test_a_body_stays_only_where_no_motion_lifts_it_at_the_demand():
    assert verdict(weighted([0.63] * 5)).grade == Grade.AT_REST
    found = verdict(weighted([0.63] * 4 + [0.65])).deciding
    assert (found.grade, found.weak, found.motions) == (Grade.NO_VERDICT, 4, 1)
    assert verdict(weighted([0.65] * 5)).grade == Grade.ROCKS
    assert verdict(weighted([NAN] * 5)).grade == Grade.ROCKS
    rest = [Outcome.AT_REST] * 2
    assert verdict(probable([0.0, 0.0], uplift=0.0, outcomes=rest)).deciding.at_rest == 2
    # A direction that was not assessed may lift it.
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    for summary in (probable([0.0] * 4, uplift=0.0, outcomes=rest * 2), summary_of([INF] * 4, outcomes=rest * 2)):
        assert verdict(summary, of).deciding.at_rest == 1


def test_a_weak_record_is_counted_apart_and_changes_nothing_else():
    """Whether the P of a record that lifts nothing is known or not, the others decide; of equal ones all count."""
    strong, likely = [2.0, 1.5, 1.2, 3.0, 0.7], [0.9, 0.3, 0.1, 0.9, 0.0]
    plain, more = (verdict(weighted(strong + weak, likely + [0.0] * len(weak))).deciding for weak in ([], [0.5, 0.1]))
    assert (plain.weak, more.weak) == (0, 2)
    assert (more.grade, more.share, more.motions, more.earthquakes) == (
        plain.grade, plain.share, plain.motions, plain.earthquakes
    )  # fmt: skip
    # As recorded likewise; a weak record of another probability than 0 is one of all.
    summary = probable([0.9, 0.0, 0.0]).assign(uplift_ratio=(OF[:2], [[2.0], [1.0], [0.4]]))
    assert verdict(summary).share.value == pytest.approx(0.45)
    assert verdict(weighted([*strong, 0.5], [*likely, 0.01])).deciding.weak == 0


@pytest.mark.parametrize("order", [[4, 3, 2, 1, 0], [0, 1, 2, 3, 4, 0, 1, 2, 3, 4]], ids=["order", "duplicates"])
def test_order_and_duplicates_change_neither_word_nor_probability(order):
    likely, ratios = np.array([0.9, 0.3, 0.1, 0.9, 0.0]), np.array([2.0, 1.5, 1.2, 3.0, 0.7])
    events = [f"e{k}" for k in order]
    plain = verdict(weighted(ratios, likely.tolist())).deciding
    other = verdict(weighted(ratios[order], likely[order].tolist()), motions(len(order), events=events)).deciding
    assert other.grade == plain.grade
    assert other.share[:3] == pytest.approx(plain.share[:3])


def test_what_is_not_known_decides_nothing_where_it_makes_no_difference():
    found = judged([NAN, 1.0, 1.0, 1.0, 1.0])
    assert (found.grade, found.share.value, found.share.unknown) == (Grade.OVERTURNS, 1.0, 1)
    assert (found.share.least, found.share.most) == (0.8, 1.0)
    assert judged([NAN] + [0.0] * 30).grade == Grade.ROCKS
    assert judged([NAN] + [0.0] * 10).grade == Grade.NOT_KNOWN
    margin = verdict(probable([NAN, 0.8], factor_10=[NAN, INF])).deciding.margin
    assert (margin.smallest, margin.limit, margin.unknown) == (INF, 10.0, 1)


def test_a_pair_of_channels_has_the_probability_of_its_worst_direction_or_the_mean():
    rows = [[0, 1], [2, 3]]
    summary = probable([0.8, 0.2, 0.0, 0.4])
    assert verdict(summary, motions(4, rows=rows, kind="pair")).share.value == pytest.approx(0.6)
    assert verdict(summary, motions(4, rows=rows, kind="pair", any_azimuth=True)).share.value == pytest.approx(0.35)
    lost = motions(4, rows=rows, kind="pair", missing=[True, False])
    share = verdict(probable([1.0, 0.2, 0.0, 0.4]), lost).share
    assert (share.value, share.unknown) == (pytest.approx(0.7), 0)  # it cannot be more likely
    share = verdict(summary, lost).share
    assert (share.value, share.least, share.most) == (pytest.approx(0.4), pytest.approx(0.6), pytest.approx(0.7))


def test_the_record_of_the_smallest_factor_governs():
    found = verdict(probable([0.0, 0.3, 0.1], factor_10=[3.0, 0.7, 1.0])).deciding
    assert (found.margin.smallest, found.margin.median, found.governing) == (0.7, 1.0, 1)
    assert verdict(probable([0.0, 0.3, 0.1], factor_10=[NAN, INF, 2.0])).deciding.governing == 2
    assert verdict(probable([0.9, 0.0], factor_10=[INF, INF])).deciding.governing == 0  # the first that overturns it
    outcomes = [Outcome.ROCKS, Outcome.UNRESOLVED, Outcome.OVERTURNS, Outcome.OVERTURNS]
    assert verdict(summary_of([INF] * 4, outcomes=outcomes)).deciding.governing == 2
    found = verdict(probable([0.0] * 2, at_demand=[0.1] * 2, factor_10=[1.0, 0.8], demand=3.0, to_demand=[2.0, 1.0]))
    assert (found.deciding.governing, found.recorded.governing, found.deciding.margin.smallest) == (0, 1, 0.5)


def test_rotations_at_the_demand_with_overturned_ones_counted_as_such():
    found = verdict(turned([0.1, INF, 0.3, 0.2, NAN])).deciding
    assert (found.overturned, found.motions, found.others_rotation, found.largest_rotation) == (1, 5, 0.3, INF)
    assert found.median_rotation == pytest.approx(0.25)
    assert verdict(turned([INF, INF, 0.3])).deciding.median_rotation == INF
    assert verdict(turned([0.1, 0.3], to_demand=[1.0, 5.0])).deciding.largest_rotation == 0.1  # too far from it
    assert math.isnan(verdict(probable([0.1], at_demand=[0.1], demand=1.0)).deciding.largest_rotation)


def test_the_largest_rotation_does_not_fall_when_a_record_begins_to_overturn():
    assert [verdict(turned([0.1, 0.2, last])).deciding.largest_rotation for last in (0.9, 1.2, INF)] == [0.9, 1.2, INF]


def test_at_a_demand_the_records_as_recorded_have_no_effect():
    found = verdict(probable([0.9] * 5, at_demand=[0.3, 0.1, 0.1, 0.0, 0.0], demand=2.0))
    assert (found.grade, found.recorded.grade, found.recorded.share.value) == (
        Grade.MAY_OVERTURN, Grade.NO_VERDICT, pytest.approx(0.9)
    )  # fmt: skip
    assert found.share == found.demands[0].share
    assert (found.deciding.earthquakes, found.deciding.left_out) == (5, 0)


def test_motions_far_from_the_demand_are_left_out():
    """Of two motions of one earthquake one is left out, and an earthquake whose motions are all left out is none."""
    scale = [0.249, 1.0, 0.25, 3.0, 4.0, 1.0, 4.001]
    at_demand = [NAN, 0.5, 0.1, 0.1, 0.1, 0.1, NAN]
    summary = probable([0.0] * 7, at_demand=at_demand, demand=1.0, to_demand=scale)
    found = verdict(summary, motions(7, events=["a", "a", "b", "c", "d", "e", "f"]))
    (demand,) = found.demands
    assert (demand.earthquakes, demand.left_out, demand.share.unknown) == (5, 2, 0)
    assert demand.share.value == pytest.approx((0.5 + 4 * 0.1) / 5)
    assert demand.share[1:3] == pytest.approx([float(end) for end in probability_interval([0.5, 0.1, 0.1, 0.1, 0.1])])


def test_without_probabilities_the_answers_of_the_model_count():
    """A design sequence is its own demand; other models than the nonlinear one have no probability."""
    found = verdict(summary_of([3.0, 1.5, 9.0, INF])).deciding
    assert (found.margin.smallest, found.margin.median, found.governing) == (1.5, 6.0, 1)
    assert (found.grade, found.share.value) == (Grade.NO_VERDICT, 0.0)
    found = verdict(summary_of([0.9, 5.0, 5.0], outcomes=[Outcome.ROCKS] * 3)).deciding
    assert (found.share.value, found.overturned) == (pytest.approx(1 / 3), 0)  # a weaker copy of one overturns it
    for factor, outcome, grade in (
        (0.9, Outcome.ROCKS, Grade.OVERTURNS),
        (2.0, Outcome.UNRESOLVED, Grade.NOT_KNOWN),
        (2.0, Outcome.ROCKS, Grade.ROCKS),
        (INF, Outcome.AT_REST, Grade.AT_REST),
    ):
        assert verdict(summary_of([factor], outcomes=[outcome]), motions(1, kind="sequence")).grade == grade
    assert verdict(summary_of([])).grade == Grade.NO_VERDICT


def test_the_probability_is_that_of_the_nonlinear_model_alone():
    summary = probable([0.9, 0.9], outcomes=[Outcome.ROCKS] * 2)
    other = summary.assign_coords(model=["balanced"])
    assert (verdict(summary).share.value, verdict(other, model="balanced").share.value) == (pytest.approx(0.9), 0.0)


def test_an_upper_bound_type_input_shows_no_more_than_that_a_body_may_overturn():
    summary = summary_of([0.5] * 6, demand=1.0).assign_coords(model=["resonance"])
    assert verdict(summary, model="resonance").grade == Grade.MAY_OVERTURN
    summary["outcome"][1], summary["safety_factor"][1] = Outcome.UNRESOLVED, NAN
    assert verdict(summary, model="resonance").grade == Grade.MAY_OVERTURN  # whatever the other one would do


@pytest.mark.parametrize(
    ("factors", "resolved", "grade"),
    [
        ([3.0, 4.0, 4.0, 4.0, 4.0], None, Grade.ROCKS),
        ([1.9, 4.0, 4.0, 4.0, 4.0], None, Grade.MAY_OVERTURN),
        ([1.9, 4.0, 4.0, 4.0, 4.0], [0, 1, 1, 1, 1], Grade.NOT_KNOWN),
        ([INF, 4.0, 4.0, 4.0, 4.0], None, Grade.ROCKS),
        ([2.0, 2.0, 4.0, 4.0, 4.0], [0, 1, 1, 1, 1], Grade.ROCKS),
        ([1.9, 1.8, 1.7, 4.0, 4.0], None, Grade.OVERTURNS),
        ([NAN] * 5, None, Grade.NOT_KNOWN),
        ([3.0, 4.0], None, Grade.NO_VERDICT),
    ],
)
def test_a_demand_by_safety_factors(factors, resolved, grade):
    found = verdict(summary_of(factors, outcomes=[Outcome.ROCKS] * len(factors), demand=2.0, resolved=resolved))
    assert found.demands[0].grade == grade


@pytest.mark.parametrize(("up_to", "grade"), [(2.0, Grade.ROCKS), (1.999, Grade.NOT_KNOWN), (3.9, Grade.ROCKS)])
def test_a_search_that_reached_the_demand_has_shown_that_the_body_stands(up_to, grade):
    assert verdict(summary_of([INF] * 5, demand=2.0, up_to=up_to)).grade == grade


def test_the_verdict_rests_on_the_likelier_of_two_demands_of_one_grade():
    summary = probable([0.0] * 5, at_demand=[0.1] * 5, demand=1.0)
    both = xr.concat([summary, summary.assign_coords(demand=["SLC"])], "demand", data_vars="minimal", coords="minimal")
    for share, name in ((0.2, "SLC"), (0.07, "ULS")):
        both["demand_probability"][..., 1] = share
        found = verdict(both)
        assert (found.deciding.demand, found.share.value) == (name, pytest.approx(max(share, 0.1)))


def test_every_body_has_the_verdict_of_its_own_answers():
    summary = xr.concat(
        [weighted([ratio] * 5, [own] * 5).assign_coords(block=[name])
         for name, own, ratio in (("a", 0.0, 0.1), ("b", 0.2, 1.0), ("c", 0.9, 2.0))],
        "block",
        data_vars="minimal",
        coords="minimal",
    )  # fmt: skip
    found = verdicts(answers(summary))
    assert [one.grade for one in found] == [Grade.AT_REST, Grade.MAY_OVERTURN, Grade.OVERTURNS]
    assert [round(one.share.value, 9) for one in found] == [0.0, 0.2, 0.9]


def test_a_capacity_that_was_not_reached_names_how_far_it_was_searched():
    """Of a record of a tenth of the demand ten times is no more than the demand: it tells nothing, others do."""
    found = verdict(summary_of([INF, 40.0, 60.0], outcomes=[Outcome.ROCKS] * 3, demand=20.0, pga=6.0)).demands[0]
    assert (found.margin.smallest, found.margin.limit) == (pytest.approx(12.0), pytest.approx(3.0))
    found = verdict(probable([0.0], factor_10=[INF], demand=20.0, to_demand=4.0)).demands[0]
    assert (found.margin.smallest, found.margin.limit) == (INF, 2.5)
    found = verdict(summary_of([INF, 40.0], outcomes=[Outcome.ROCKS] * 2, demand=4.0))
    assert (found.recorded.margin.limit, found.demands[0].margin.limit, found.demands[0].margin.median) == (
        10.0,
        2.5,
        INF,
    )


def test_no_motion_governs_a_body_that_all_leave_at_rest():
    assert verdict(summary_of([NAN, NAN], outcomes=[Outcome.AT_REST] * 2)).deciding.governing == -1
    assert verdict(summary_of([NAN, NAN], outcomes=[Outcome.AT_REST, Outcome.UNRESOLVED])).deciding.governing == 1


SCREENED = ["chest", "statue", "statue with pedestal", "lone with pedestal"]


def screened(**variables):
    """Four bodies under two records, which overturn them with 0.1, 0.3, 0.2 and 0.9."""
    each = [
        probable([share] * 2).assign_coords(block=[name])
        for name, share in zip(SCREENED, (0.1, 0.3, 0.2, 0.9), strict=True)
    ]
    return xr.concat(each, "block", data_vars="minimal", coords="minimal").assign(variables)


@pytest.mark.parametrize(("shares", "worse"), [([0.3, 0.2], 1), ([0.01, 0.04], 2)])
def test_the_worse_of_both_screens_counts(shares, worse):
    summary = screened(pedestal_of=("block", ["", "", "statue", "lone"]))
    summary["overturning_probability"][:, 1:3] = shares
    found = answers(summary)
    every = verdicts(found)
    # Of the last one there is the screen with its pedestal alone.
    assert list(worse_with_pedestal(found, every)) == [("statue", every[worse])]


def rubbing(friction, shares, *, demand=1.0, restraints="", probability=0.0):
    """Five records at a demand; the body lifts at 0.25 g, and its friction is exceeded in a share of each record."""
    summary = probable([0.0] * 5, at_demand=[probability] * 5, demand=demand)
    own = {"friction": friction, "uplift_acceleration": 0.25 * 9.80665, "gravity": 9.80665, "restraints": restraints}
    variables = {name: ("block", [value]) for name, value in own.items()}
    variables["sliding_share"] = (OF[:2], np.array(shares)[:, np.newaxis])
    if demand is not None:
        variables["demand_sliding_share"] = ((*OF[:2], "demand"), 0.5 * np.array(shares)[:, np.newaxis, np.newaxis])
    return answers(summary.assign(variables))


@pytest.mark.parametrize(("friction", "first"), [(0.2499, True), (0.25, False), (0.6, False), (NAN, False)])
def test_a_body_slides_first_below_the_friction_at_which_it_lifts(friction, first):
    """Whatever its probability of overturning, there is no verdict on rocking."""
    found = rubbing(friction, [0.0] * 5, probability=0.9)
    assert slides_first(found).tolist() == [first]
    (body,) = verdicts(found)
    assert body.grade == (Grade.SLIDES_FIRST if first else Grade.OVERTURNS)
    assert not slides_first(rubbing(friction, [0.0] * 5, restraints="{}")).any()


def test_the_largest_share_at_the_demand_counts():
    (body,) = verdicts(rubbing(0.3, [0.0, 0.02, 0.2, 0.0, NAN]))
    assert (body.deciding.sliding, body.recorded.sliding) == (0.1, 0.2)
    assert grade_cell(body.deciding).grade == "good"
    (body,) = verdicts(rubbing(0.2, [0.0] * 5))
    assert grade_cell(body.deciding) == Cell("slides first", float(Grade.SLIDES_FIRST), grade="unknown")


@pytest.mark.parametrize(
    ("friction", "share", "words"),
    [(0.2, 0.2, "first"), (0.3, 0.2, "10 %"), (0.3, 0.002, "<1 %"), (0.3, 0.0, "no"), (NAN, NAN, None)],
)
def test_sliding_is_one_column_without_infinities(friction, share, words):
    found = rubbing(friction, [share] * 5)
    every = verdicts(found)
    selected = verdict_columns(found, [one.deciding for one in every])
    cells = {one.name: cell.text for one, cell in zip(selected, row(found, every, selected), strict=True)}
    assert cells.get("sliding") == words
    said = " ".join(body_verdicts(found).split())
    assert ("Sliding: largest share of the time" in said) == (words is not None)
    assert "inf" not in said


def row(found, every, selected):
    """The cells of the only body of a table of verdicts."""
    values = verdict_rows(found, [(one, one.deciding) for one in every], lambda record: Cell(""))
    (cells,) = filled(selected, values)
    return cells
