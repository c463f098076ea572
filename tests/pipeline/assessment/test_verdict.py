"""The verdict on a body: the answer under one record, the probability over earthquakes, and the words for it."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, probable, summary_of, verdict
from scipy.stats import beta, binom

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import (
    Grade,
    Sliding,
    Standing,
    reasons_unknown,
    sliding,
    standings,
    verdicts,
    worse_with_pedestal,
)

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


@pytest.mark.parametrize(
    ("probability", "grade"),
    [
        ([0.0], Grade.ROCKS),
        ([0.0499], Grade.ROCKS),
        ([0.05], Grade.MAY_OVERTURN),
        ([0.4999], Grade.MAY_OVERTURN),
        ([0.5], Grade.OVERTURNS),
        ([1.0, 0.0], Grade.OVERTURNS),
        ([1.0, 0.0, 0.0], Grade.MAY_OVERTURN),
        ([0.15, 0.0, 0.0], Grade.MAY_OVERTURN),
        ([0.14, 0.0, 0.0], Grade.ROCKS),
        ([NAN, 0.0], Grade.NOT_KNOWN),
    ],
)
def test_the_words_of_a_probability(probability, grade):
    assert verdict(probable(probability)).grade == grade


def test_earthquakes_weigh_alike_whatever_their_number_of_records():
    found = verdict(probable([0.9, 0.9, 0.9, 0.1]), motions(4, events=["a", "a", "a", "b"]))
    assert found.share.value == pytest.approx(0.5)
    assert found.grade == Grade.OVERTURNS
    assert verdict(probable([0.9, 0.9, 0.9, 0.1])).share.value == pytest.approx(0.7)


def test_where_none_of_ten_earthquakes_overturns_it_the_upper_end_is_the_rule_of_three():
    share = verdict(probable([0.0] * 10)).share
    assert (share.value, share.low) == (0.0, 0.0)
    assert share.high == pytest.approx(1.0 - 0.05**0.1)
    assert share.high < 3.0 / 10.0
    assert verdict(probable([1.0] * 10)).share.low == pytest.approx(0.05**0.1)


def test_the_interval_of_certain_answers_is_that_of_clopper_and_pearson():
    share = verdict(probable([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])).share
    assert binom.cdf(2, 8, share.high) == pytest.approx(0.05)
    assert binom.sf(1, 8, share.low) == pytest.approx(0.05)


@pytest.mark.slow
def test_the_interval_covers_the_mean_of_the_earthquakes_it_was_not_given():
    rng = np.random.default_rng(5)

    def drawn(size):
        """Probabilities of a body whose median capacity is 1.5, with a log-dispersion of 0.6 between earthquakes."""
        return 1.0 / (1.0 + np.exp((np.log(1.5) + 0.6 * rng.standard_normal(size)) / 0.08))

    mean = drawn(200_000).mean()
    every = [verdict(probable(drawn(9))).share for _ in range(60)]
    covered = sum(one.low <= mean <= one.high for one in every)
    assert covered >= 50  # at least 0.9 of them: fewer than 50 of 60 has a probability below 0.04


def test_a_body_stays_only_where_no_motion_lifts_any_of_its_draws():
    rest = [Outcome.AT_REST] * 2
    assert verdict(probable([0.0, 0.0], uplift=0.999e-3, outcomes=rest)).grade == Grade.AT_REST
    assert verdict(probable([0.0, 0.0], uplift=np.array([0.0, 1e-3]), outcomes=rest)).grade == Grade.ROCKS
    assert verdict(probable([0.0, 0.0], uplift=np.array([0.0, NAN]), outcomes=rest)).grade == Grade.ROCKS
    assert verdict(probable([0.0, 0.0], uplift=0.0, outcomes=rest)).at_rest == 2
    # A direction that was not assessed may lift it.
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    for summary in (probable([0.0] * 4, uplift=0.0, outcomes=rest * 2), summary_of([INF] * 4, outcomes=rest * 2)):
        assert verdict(summary).grade == Grade.AT_REST
        assert (verdict(summary, of).grade == Grade.AT_REST, verdict(summary, of).at_rest) == (False, 1)


def test_what_is_not_known_decides_nothing_where_it_makes_no_difference():
    found = verdict(probable([NAN, 1.0, 1.0, 1.0]))
    assert (found.grade, found.share.value, found.share.unknown) == (Grade.OVERTURNS, 1.0, 1)
    assert (found.share.least, found.share.most) == (0.75, 1.0)
    found = verdict(probable([NAN] + [0.0] * 30))
    assert (found.grade, found.share.value) == (Grade.ROCKS, 0.0)
    found = verdict(probable([NAN] + [0.0] * 10))
    assert found.grade == Grade.NOT_KNOWN
    found = verdict(probable([NAN, 0.8], factor_10=[NAN, INF]))
    assert (found.margin.smallest, found.margin.limit, found.margin.unknown) == (INF, 10.0, 1)


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
    found = verdict(probable([0.0, 0.3, 0.1], factor_10=[3.0, 0.7, 1.0]))
    assert (found.margin.smallest, found.margin.median, found.governing) == (0.7, 1.0, 1)
    assert verdict(probable([0.0, 0.3, 0.1], factor_10=[NAN, INF, 2.0])).governing == 2
    assert verdict(probable([0.9, 0.0], factor_10=[INF, INF])).governing == 0  # the first that overturns it
    outcomes = [Outcome.ROCKS, Outcome.UNRESOLVED, Outcome.OVERTURNS, Outcome.OVERTURNS]
    assert verdict(summary_of([INF] * 4, outcomes=outcomes)).governing == 2


@pytest.mark.parametrize(
    ("at_demand", "grade"),
    [
        ([0.0, 0.1, 0.1, 0.0, 0.0], Grade.ROCKS),
        ([0.3, 0.1, 0.1, 0.0, 0.0], Grade.MAY_OVERTURN),
        ([0.9, 0.9, 0.5, 0.2, 0.0], Grade.OVERTURNS),
        ([NAN, 0.0, 0.0, 0.0, 0.0], Grade.NOT_KNOWN),
        ([0.0] * 4, Grade.NOT_KNOWN),
    ],
)
def test_at_a_demand_the_probability_over_earthquakes_decides(at_demand, grade):
    summary = probable([0.9] * len(at_demand), at_demand=at_demand, demand=2.0)
    found = verdict(summary)
    (demand,) = found.demands
    assert (demand.grade, found.overall, found.grade) == (grade, grade, Grade.OVERTURNS)
    assert (demand.earthquakes, demand.left_out) == (len(at_demand), 0)
    assert demand.few == (len(at_demand) < 5)
    assert demand.share.value == pytest.approx(np.nanmean(at_demand))
    assert found.decides == demand.share


def test_motions_far_from_the_demand_are_left_out():
    """Of two motions of one earthquake one is left out, and an earthquake whose motions are all left out is none."""
    scale = [0.249, 1.0, 0.25, 3.0, 4.0, 1.0, 4.001]
    at_demand = [NAN, 0.5, 0.1, 0.1, 0.1, 0.1, NAN]
    summary = probable([0.0] * 7, at_demand=at_demand, demand=1.0, to_demand=scale)
    found = verdict(summary, motions(7, events=["a", "a", "b", "c", "d", "e", "f"]))
    (demand,) = found.demands
    assert (demand.earthquakes, demand.left_out, demand.share.unknown) == (5, 2, 0)
    assert demand.share.value == pytest.approx((0.5 + 4 * 0.1) / 5)
    assert demand.share.high == pytest.approx(binom_high(0.18, 5))


def binom_high(share, events):
    """The upper end of the interval of 90 % of a share (Clopper & Pearson)."""
    return beta.ppf(0.95, share * events + 1.0, events - share * events)


def test_without_probabilities_the_answers_of_the_model_count():
    """A design sequence, another model than the nonlinear one."""
    found = verdict(summary_of([3.0, 1.5, 9.0, INF]))
    assert (found.margin.smallest, found.margin.median, found.governing) == (1.5, 6.0, 1)
    assert (found.grade, found.share.value) == (Grade.ROCKS, 0.0)
    found = verdict(summary_of([0.9, 5.0, 5.0], outcomes=[Outcome.ROCKS] * 3))
    assert (found.grade, found.overturned) == (Grade.MAY_OVERTURN, 0)  # a weaker copy of one of three overturns it
    assert verdict(summary_of([0.9, 0.5])).grade == Grade.OVERTURNS
    assert verdict(summary_of([2.0, 3.0], outcomes=[Outcome.UNRESOLVED, Outcome.ROCKS])).grade == Grade.NOT_KNOWN
    assert verdict(summary_of([INF, INF], outcomes=[Outcome.AT_REST] * 2)).grade == Grade.AT_REST
    assert verdict(summary_of([])).grade == Grade.NOT_KNOWN


def test_the_probability_is_that_of_the_nonlinear_model_alone():
    summary = probable([0.9, 0.9], outcomes=[Outcome.ROCKS] * 2)
    other = summary.assign_coords(model=["balanced"])
    assert verdict(summary).grade == Grade.OVERTURNS
    assert verdict(other, model="balanced").grade == Grade.ROCKS


def test_an_upper_bound_type_input_shows_no_more_than_that_a_body_may_overturn():
    summary = summary_of([0.5, 0.6]).assign_coords(model=["resonance"])
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
        ([3.0, 4.0], None, Grade.NOT_KNOWN),
    ],
)
def test_a_demand_by_safety_factors(factors, resolved, grade):
    found = verdict(summary_of(factors, outcomes=[Outcome.ROCKS] * len(factors), demand=2.0, resolved=resolved))
    assert found.demands[0].grade == grade


@pytest.mark.parametrize(("up_to", "grade"), [(2.0, Grade.ROCKS), (1.999, Grade.NOT_KNOWN), (3.9, Grade.ROCKS)])
def test_a_search_that_reached_the_demand_has_shown_that_the_body_stands(up_to, grade):
    assert verdict(summary_of([INF] * 5, demand=2.0, up_to=up_to)).overall == grade


def test_the_verdict_rests_on_the_likelier_of_two_demands_of_one_grade():
    summary = probable([0.0] * 5, at_demand=[0.1] * 5, demand=1.0)
    both = xr.concat([summary, summary.assign_coords(demand=["SLC"])], "demand", data_vars="minimal", coords="minimal")
    for share, name in ((0.2, "SLC"), (0.07, "ULS")):
        both["demand_probability"][..., 1] = share
        found = verdict(both)
        assert (found.deciding.name, found.decides.value) == (name, pytest.approx(max(share, 0.1)))


def test_every_body_has_the_verdict_of_its_own_answers():
    summary = xr.concat(
        [probable(own, uplift=lifted, outcomes=[Outcome.AT_REST] * 3).assign_coords(block=[name])
         for name, own, lifted in (("a", [0.0] * 3, 0.0), ("b", [0.2, 0.3, 0.1], 1.0), ("c", [0.9] * 3, 1.0))],
        "block",
        data_vars="minimal",
        coords="minimal",
    )  # fmt: skip
    found = verdicts(answers(summary))
    assert [one.grade for one in found] == [Grade.AT_REST, Grade.MAY_OVERTURN, Grade.OVERTURNS]
    assert [round(one.share.value, 9) for one in found] == [0.0, 0.2, 0.9]


def test_a_capacity_that_was_not_reached_names_how_far_it_was_searched():
    """Of a record of a tenth of the demand ten times is no more than the demand: it tells nothing, others do."""
    found = verdict(summary_of([INF, 40.0, 60.0], outcomes=[Outcome.ROCKS] * 3, demand=20.0)).demands[0]
    assert (found.margin.smallest, found.margin.median) == (2.0, 2.5)
    found = verdict(probable([0.0], factor_10=[INF], demand=20.0)).demands[0]
    assert (found.margin.smallest, found.margin.limit) == (INF, 0.5)
    found = verdict(summary_of([INF, 40.0], outcomes=[Outcome.ROCKS] * 2, demand=5.0))
    assert (found.margin.limit, found.demands[0].margin.limit, found.demands[0].margin.median) == (10.0, 2.0, INF)


def test_no_motion_governs_a_body_that_all_leave_at_rest():
    found = verdict(summary_of([NAN, NAN], outcomes=[Outcome.AT_REST] * 2))
    assert (found.grade, found.governing) == (Grade.AT_REST, -1)
    assert verdict(summary_of([NAN, NAN], outcomes=[Outcome.AT_REST, Outcome.UNRESOLVED])).governing == 1


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


def test_a_body_slides_under_the_records_that_ask_for_more_friction_than_it_has():
    required = [[0.2, 0.5, NAN, 0.4], [0.4, 0.4, NAN, 0.3]]
    found = answers(
        screened(friction=("block", [0.3, 0.5, NAN, 0.2]), friction_required=(("record", "block"), required))
    )
    first, _, _, last = found.bodies
    assert list(sliding(found)) == [Sliding(first, 1, 2, 0.4, 0.3), Sliding(last, 2, 2, 0.4, 0.2)]
    assert list(sliding(answers(screened()))) == []
