"""The answers of a results file: bodies, motions, and the margins and means over them."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, probable, summary_of
from results_tree import results_tree

from rockpulse.assessment.answers import Answers, Motions, answers_of, bodies_of, searched_up_to
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.variables.probability import MEAN

INF, NAN = math.inf, math.nan


@pytest.mark.sweep
def test_bodies_and_lanes_of_restitution_cases():
    summary = results_tree(cases=2)["summary"].to_dataset()
    bodies = bodies_of(summary)
    # The first block has the same restitution twice: one body.
    assert [body.name for body in bodies] == [
        "boundary wall",
        "column, C = 0.930",
        "column, C = 0.830",
        "cabinet, C = 0.790",
        "cabinet, C = 0.690",
    ]
    answers = Answers(summary, model="sequence")
    factor = answers["safety_factor"]
    assert factor.shape == (3, 5)
    expected = summary["safety_factor"].sel(block="cabinet", model="sequence").isel(case=1)
    np.testing.assert_array_equal(factor[:, 4], expected)
    assert answers["uplift_ratio"].shape == (3, 5)
    assert answers["pga"].shape == (3,)
    assert np.all(answers["interval_count"] == -1)  # results that lack it
    with pytest.raises(KeyError):
        answers["no such variable"]


def least_and_median(values):
    """Worked out again, one motion after the other."""
    known = [[one for one in of if not math.isnan(one)] for of in values]
    least = [min(of) for of in known if of]
    whole = [min(of) for of, every in zip(known, values, strict=True) if len(of) == len(every)]
    return (min(least) if least else NAN), (float(np.median(whole)) if whole else NAN)


@pytest.mark.parametrize("seed", range(8))
def test_margins_are_those_of_the_motions_taken_one_by_one(seed):
    rng = np.random.default_rng(seed)
    factors = rng.choice([0.3, 0.7, 1.2, 2.5, INF, NAN], size=12, p=[0.1, 0.2, 0.2, 0.2, 0.2, 0.1])
    pairs = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]
    for of, rows in ((motions(12), [[k] for k in range(12)]), (motions(12, rows=pairs, kind="pair"), pairs)):
        (margin,) = answers(summary_of(factors), of).margins()
        expected = least_and_median([factors[row] for row in rows])
        np.testing.assert_array_equal((margin.smallest, margin.median), expected)
        assert margin.unknown == sum(bool(np.isnan(factors[row]).all()) for row in rows)
        assert margin.partial == sum(bool(np.isnan(factors[row]).any()) for row in rows) - margin.unknown
        if not math.isnan(margin.smallest):
            assert np.nanmin(factors[rows[margin.place]]) == margin.smallest


@pytest.mark.parametrize("factors", [[], [NAN, NAN]])
def test_without_a_known_factor_there_is_no_margin(factors):
    (margin,) = answers(summary_of(factors)).margins()
    assert (math.isnan(margin.smallest), math.isnan(margin.median), margin.place) == (True, True, -1)


def test_bounds_and_what_is_open():
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    (margin,) = answers(summary_of([0.4, NAN, 2.0, 3.0], resolved=[0, 1, 1, 1]), of).margins()
    assert (margin.smallest, margin.open, margin.median, margin.partial) == (0.4, True, 2.0, 1)
    assert margin.bounds == (True, False)
    (margin,) = answers(summary_of([0.4, 0.9, 2.0, 3.0]), motions(4, rows=[[0, 1], [2, 3]], kind="pair")).margins()
    assert (margin.smallest, margin.open, margin.median) == (0.4, False, pytest.approx(1.2))
    (margin,) = answers(summary_of([2.0, 2.0, 9.0], resolved=[0, 1, 0])).margins()
    assert margin.bounds == (False, True)  # of 2 or more, 2, and 9 or more
    (margin,) = answers(summary_of([2.0, 5.0, 9.0], resolved=[1, 0, 1])).margins()
    assert margin.bounds == (False, True)


def test_a_block_counts_with_the_worst_of_its_restitutions_and_a_motion_with_the_worst_block():
    summary = results_tree(cases=2)["summary"].to_dataset()
    factor = summary["safety_factor"].sel(model="sequence")
    factor[:, 1, 1] = [0.9, 3.0, NAN]
    summary["safety_factor"].loc[{"model": "sequence"}] = factor
    found = Answers(summary, model="sequence")
    assert [margin.smallest for margin in found.margins("block")] == [0.5, 0.9, 1.7]
    assert [margin.smallest for margin in found.margins("motion")] == [0.5, 0.5, INF]
    assert [margin.place for margin in found.margins("motion")][:2] == [0, 0]
    assert [margin.partial for margin in found.margins("motion")] == [0, 0, 1]
    assert found.overturnings("block") == [2, 0, 0]
    assert found.overturnings("motion") == [1, 1, 0]


def test_every_model_has_answers_under_the_same_motions():
    summary = results_tree()["summary"].to_dataset()
    of = motions(3, events=["a", "a", "b"])
    found = answers(summary, of, "sequence")
    assert list(found.of_models) == ["resonance", "sequence", "nonlinear"]
    assert found.of_models["sequence"] is found
    for name, one in found.of_models.items():
        assert one.motions is of
        np.testing.assert_array_equal(one["outcome"], summary["outcome"].sel(model=name))


def test_without_a_search_or_a_probability_nothing_is_reported():
    found = Answers(summary_of([np.nan, np.nan]))
    assert (found.motions.kind, found.motions.event_count) == ("record", 1)
    assert (found.searched, found.has_factor, found.probable, found.factor) == (False, False, False, "safety_factor")
    assert (found.source.tolist(), found.demands) == ([["none"]] * 2, {})


def two_demands(summary, other):
    """The same with a second demand, whose variables are other multiples of those of the first."""
    second = summary.assign({name: times * summary[name] for name, times in other.items()}).assign_coords(
        demand=["SLC"]
    )
    return xr.concat([summary, second], "demand", data_vars="minimal", coords="minimal")


def test_factors_are_taken_over_what_brings_a_record_to_each_demand():
    times = {"demand_value": 3.0, "demand_factor": 3.0, "capacity_ratio": 1.0 / 3.0}
    found = answers(two_demands(summary_of([3.0, INF], demand=2.0, to_demand=[2.0, 0.5]), times))
    assert [one.value for one in found.demands.values()] == [2.0, 6.0]
    assert found.of_demand("demand_factor", "ULS").tolist() == [[2.0], [0.5]]
    assert found.of_demand("demand_factor", "SLC").tolist() == [[6.0], [1.5]]
    assert found.ratios().tolist() == [[3.0], [INF]]
    assert found.ratios("SLC").tolist() == [[0.5], [INF]]  # the capacity_ratio of the results
    assert found.proven().tolist() == [[3.0], [10.0]]
    assert found.proven("SLC") == pytest.approx(np.array([[0.5], [10.0 / 1.5]]))
    assert np.isnan(found.of_demand("demand_probability", "SLC")).all()
    assert found.of_demand("demand_probability", "SLC").shape == (2, 1)
    likely = probable([0.2, 0.1], factor_10=[0.7, INF], low=8.0, demand=2.0, to_demand=[2.0, 0.5], at_demand=[0.4, 0.3])
    found = answers(two_demands(likely, {"demand_factor": 3.0, "demand_probability": 0.5}))
    assert found.of_demand("demand_probability", "ULS").tolist() == [[0.4], [0.3]]
    assert found.of_demand("demand_probability", "SLC").tolist() == [[0.2], [0.15]]
    assert found.ratios("ULS") == pytest.approx(np.array([[0.35], [INF]]))
    assert found.proven("ULS") == pytest.approx(np.array([[0.35], [16.0]]))
    assert (found.probable, found.factor, found.has_factor, found.searched) == (True, "factor_10", True, False)


def test_a_bound_is_where_the_model_cannot_answer():
    found = answers(summary_of([2.0, 3.0, 4.0], resolved=[0, 1, -1]))
    assert found.bound.tolist() == [[True], [False], [False]]
    assert (found.searched, found.has_factor) == (True, True)
    likely = probable([0.1, 0.2], resolved=[0, 1])
    assert answers(likely).bound.tolist() == [[False], [False]]
    assert answers(likely.assign_coords(model=["linear"]), model="linear").probable is False
    assert answers(probable([NAN, 0.2])).probable is True
    assert answers(probable([NAN, NAN])).probable is False


def test_a_variable_is_read_whatever_the_order_of_its_dimensions():
    summary = results_tree(cases=2)["summary"].to_dataset()
    summary["more"] = summary["safety_factor"] * xr.DataArray([1.0, 10.0], dims="demand")
    for order in (("record", "block", "case", "demand", "model"), ("model", "demand", "case", "block", "record")):
        values = Answers(summary.transpose(*order, missing_dims="ignore"), model="sequence")["more"]
        assert values.shape == (3, 5, 2)
        cell = summary["more"].sel(block="column", model="sequence")
        for record in range(3):
            expected = cell.isel(record=record, case=1).transpose("demand").values
            np.testing.assert_array_equal(values[record, 2], expected)


def test_directions_that_were_not_assessed_tell_no_earthquake():
    summary = summary_of([1.0, 2.0, 3.0]).assign(event=("record", ["Kobe", "Maule", "Napa"]))
    index = np.array([[-1, -1], [-1, 2], [1, 0]])
    directions = xr.Dataset({"record_index": (("direction", "pair"), index.T)}, {"pair": ["a", "b", "c"]})
    for any_azimuth in (False, True):
        if any_azimuth:
            directions[MEAN] = ("pair", [0.0] * 3)
        found = answers_of(xr.DataTree.from_dict({"/summary": summary, "/directions": directions})).motions
        assert (found.names, found.events, found.any_azimuth) == (["b", "c"], ["Napa", "Maule"], any_azimuth)
        assert found.index.tolist() == index[1:].tolist()
    first = xr.Dataset({"record_index": (("pair", "direction"), [[0, -1]])}, {"pair": ["a"]})
    assert answers_of(xr.DataTree.from_dict({"/summary": summary, "/directions": first})).motions.events == ["Kobe"]


def test_motions_too_weak_to_tell_are_left_out_of_a_margin():
    (margin,) = answers(summary_of([INF, 3.0, 5.0], up_to=0.99)).margins()
    assert (margin.smallest, margin.median, margin.weak, margin.unknown, margin.place) == (3.0, 4.0, 1, 0, 1)
    assert math.isnan(margin.limit)
    (margin,) = answers(summary_of([INF, 3.0, 5.0], up_to=1.0)).margins()
    assert (margin.smallest, margin.median, margin.weak, margin.limit) == (3.0, 5.0, 0, 1.0)
    (margin,) = answers(summary_of([INF, INF, NAN], up_to=0.5)).margins()
    assert (margin.smallest, margin.weak, margin.unknown, margin.limit, margin.place) == (INF, 2, 1, 0.5, 0)
    searched = summary_of([INF, INF, 2.0])
    searched["safe_up_to"][:, 0, 0] = [9.0, 6.0, 2.0]
    (margin,) = answers(searched).margins()
    assert (margin.limit, margin.median, margin.open) == (6.0, INF, False)


def test_every_body_and_direction_has_the_least_factor_of_its_own():
    summary = results_tree()["summary"].to_dataset()
    summary["safety_factor"].loc[{"model": "sequence"}] = [[3.0, INF, NAN], [2.0, INF, 4.0], [1.0, INF, INF]]
    of = motions(3, rows=[[0, 1], [2, 2]], kind="pair")
    least, row = answers(summary, of, "sequence").least_over_direction
    np.testing.assert_array_equal(least, [[2.0, INF, 4.0], [1.0, INF, INF]])
    assert row.tolist() == [[1, -1, 1], [2, -1, -1]]


def test_outcomes_are_counted_over_records_and_over_motions():
    outcomes = [2, 1, 3, 3, 0, 3, 2]
    found = answers(summary_of([1.0] * 7, outcomes=outcomes))
    assert found.counts == [1, 1, 2, 3]
    of = motions(7, rows=[[0, 6], [2, 3], [4, 5]], kind="pair")
    found = answers(summary_of([1.0] * 7, outcomes=outcomes), of)
    assert (found.overturnings(), found.unresolved) == ([1], [2])
    whole = Answers(results_tree()["summary"].to_dataset(), model="nonlinear")
    assert (whole.overturnings(), whole.unresolved, whole.overturnings("motion")) == ([1, 0, 0], [0, 0, 1], [1, 0, 0])


def test_how_far_was_searched_is_the_smallest_of_those_without_a_factor():
    assert searched_up_to(np.array([INF, 1.3, INF]), np.array([8.0, 1.3, 6.0])) == 6.0
    assert math.isnan(searched_up_to(np.array([1.3, NAN]), np.array([1.3, NAN])))


#: Three motions of two directions from five records; of the last one a direction was not assessed.
INDEX = np.array([[0, 1], [2, 3], [4, -1]])
PAIRS = Motions(["x", "y", "z"], INDEX, ["a", "b", "a"], "pair")


@pytest.mark.parametrize(
    ("events", "count"), [(["a", "b", "a", UNKNOWN], 2), ([UNKNOWN] * 3, 1), (["a"], 1), ([], 0), ([UNKNOWN, "a"], 1)]
)
def test_earthquakes_that_are_known_are_counted_or_one(events, count):
    assert Motions(["x"] * len(events), np.zeros((len(events), 1), int), events, "record").event_count == count


def test_a_motion_overturns_in_any_of_its_directions_but_not_in_one_that_was_not_assessed():
    assert PAIRS.in_any_direction(np.array([False, True, False, False, False])).tolist() == [True, False, False]


@pytest.mark.parametrize("any_azimuth", [False, True])
def test_the_share_of_each_body_is_over_its_motions(any_azimuth):
    """The worst direction, or the mean over them; a missing one may be 0 or 1."""
    probability = np.array([[0.2, 1.0], [0.4, 0.5], [0.1, 0.0], [0.3, NAN], [0.6, 1.0]])
    of = Motions(PAIRS.names, INDEX, PAIRS.events, "pair", any_azimuth)
    first, second = of.shares(probability)
    if any_azimuth:  # 0.3, 0.2 and 0.3 to 0.8; 0.75, 0 to 0.5 and 0.5 to 1
        expected = [((0.3 + 0.2) / 2, (0.3 + 0.2) / 2, (0.55 + 0.2) / 2, 1), (0.75, 0.625 / 2, (0.875 + 0.5) / 2, 2)]
    else:  # 0.4, 0.3 and 0.6 to 1; 1, 0 to 1 and 1
        expected = [((0.4 + 0.3) / 2, (0.5 + 0.3) / 2, (0.7 + 0.3) / 2, 1), (1.0, 0.5, 1.0, 1)]
    for share, (value, least, most, unknown) in zip((first, second), expected, strict=True):
        assert (share.value, share.least, share.most, share.unknown) == pytest.approx((value, least, most, unknown))
        assert share.low < share.value <= share.high
    left_out = np.array([[True, False]] * 2 + [[False, False]] * 3)
    first, _ = of.shares(probability, left_out)
    assert first.unknown == 1
    assert first.least == pytest.approx((0.2 + 0.3) / 2 if any_azimuth else (0.3 + 0.6) / 2)
