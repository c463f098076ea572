"""What may be counted as safe under one record and over all motions, on answers that are known."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import motions, summary_of, verdict

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import Grade, Standing, standings, why_unknown
from rockpulse.motions.events import largest_share

OF = ("record", "block", "model")


def one(**answers):
    """A summary of one answer: at factor 1 it rocks, with a safety factor of 2, unless said otherwise."""
    found = {"outcome": Outcome.ROCKS, "safety_factor": 2.0, "factor_resolved": 1, "predictable": 1, "applicable": 1}
    found |= {"reason": Reason.NONE} | answers
    variables = {name: (OF, np.full((1, 1, 1), value)) for name, value in found.items() if value is not None}
    variables["peak_rotation_ratio"] = (OF, np.full((1, 1, 1), 0.4))
    variables["restitution"] = (("block",), np.array([0.9]))
    return xr.Dataset(variables, {"record": ["r"], "block": ["b"], "model": ["nonlinear"]})


@pytest.mark.parametrize(
    ("answers", "expected"),
    [
        ({}, Standing.STANDS),
        ({"safety_factor": 1.0}, Standing.THIN),
        ({"safety_factor": 1.1}, Standing.STANDS),
        ({"safety_factor": np.inf, "safe_up_to": 10.0, "outcome": Outcome.AT_REST}, Standing.STANDS),
        ({"safety_factor": np.inf, "safe_up_to": 1.0}, Standing.THIN),
        ({"safety_factor": np.inf}, Standing.THIN),
        ({"safety_factor": 1.3, "search_step": 1.014}, Standing.STANDS),
        ({"safety_factor": 1.3, "search_step": 1.06}, Standing.THIN),
        ({"safety_factor": 40.0, "search_step": 48.9}, Standing.THIN),
        ({"safety_factor": np.nan}, Standing.NO_MARGIN),
        ({"safety_factor": None}, Standing.NO_MARGIN),
        ({"safety_factor": 0.9}, Standing.WEAKER_OVERTURNS),
        ({"safety_factor": 0.9, "factor_resolved": 0}, Standing.UNKNOWN),
        ({"safety_factor": 2.0, "factor_resolved": 0}, Standing.STANDS),
        ({"outcome": Outcome.OVERTURNS, "safety_factor": 0.5}, Standing.OVERTURNS),
        ({"outcome": Outcome.OVERTURNS, "predictable": 0, "applicable": 0}, Standing.OVERTURNS),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": np.nan}, Standing.UNKNOWN),
        ({"outcome": Outcome.UNRESOLVED, "safety_factor": 0.5}, Standing.WEAKER_OVERTURNS),
        ({"predictable": 0}, Standing.UNKNOWN),
        ({"predictable": -1}, Standing.STANDS),
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
        ({"outcome": Outcome.UNRESOLVED, "reason": Reason.FREE_FLIGHT}, "free flight"),
        ({"outcome": Outcome.UNRESOLVED}, "unresolved"),
        ({"predictable": 0}, "not predictable"),
        ({"applicable": 0}, "outside the range"),
        ({"safety_factor": 0.9, "factor_resolved": 0}, "a weaker copy may overturn it"),
    ],
)
def test_why_it_is_not_known(answers, words):
    summary = one(**answers)
    found = str(why_unknown(Answers(summary))[0, 0])
    assert found.startswith(words)
    assert bool(found) == bool(words)


def test_smallest_median_and_governing_record():
    found = verdict(summary_of([3.0, 1.5, 9.0, math.inf]))
    assert found.grade == Grade.SAFE
    assert (found.margin.smallest, found.margin.median, found.governing) == (1.5, 6.0, 1)
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
    assert math.isnan(found.margin.smallest)
    assert found.governing == -1
    assert found.at_rest == 1


def test_a_smallest_factor_that_may_be_larger_is_marked():
    found = verdict(summary_of([2.0, 3.0], resolved=[0, 1]))
    assert (found.margin.smallest, found.margin.bounds[0]) == (2.0, True)
    found = verdict(summary_of([2.0, 2.0], resolved=[0, 1]))
    assert (found.margin.smallest, found.margin.bounds[0]) == (2.0, False)


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
    assert (found.margin.smallest, found.margin.median) == (0.8, 1.9)
    found = verdict(summary_of([3.0, 5.0, 3.0, 4.0]), motions(4, rows=[[0, 1], [2, 3]], missing=[True, False]))
    assert found.grade == Grade.NOT_KNOWN


def test_the_bound_of_the_share():
    assert math.isnan(largest_share(0, 2))
    assert largest_share(3, 3) == 1.0
    # Clopper and Pearson for 1 of 10, one-sided 90 %: P(X <= 1 | p) = 0.1.
    p = largest_share(1, 10)
    assert (1.0 - p) ** 10 + 10 * p * (1.0 - p) ** 9 == pytest.approx(0.1)


def test_a_capacity_that_was_not_reached_names_how_far_it_was_searched():
    """Of a record of a tenth of the demand ten times is no more than the demand: it tells nothing, others do."""
    found = verdict(summary_of([math.inf, 40.0, 60.0], outcomes=[Outcome.ROCKS] * 3, demand=20.0)).demands[0]
    assert (found.margin.smallest, found.margin.median, found.unknown) == (2.0, 2.5, 1)
    found = verdict(summary_of([math.inf], outcomes=[Outcome.ROCKS], demand=20.0)).demands[0]
    assert (found.margin.smallest, found.margin.limit) == (math.inf, 0.5)
    found = verdict(summary_of([math.inf, 40.0], outcomes=[Outcome.ROCKS] * 2, demand=5.0))
    assert (found.margin.limit, found.demands[0].margin.limit, found.demands[0].margin.median) == (10.0, 2.0, math.inf)


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
