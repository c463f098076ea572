"""The answers of a results file: bodies, motions, and the margins over them."""

import math

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, summary_of
from results_tree import results_tree

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, answers_of, bodies_of
from rockpulse.views.shared.verdict_notes import counted

INF, NAN = math.inf, math.nan


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


def test_the_least_factor_over_direction_and_the_row_that_has_it():
    pairs = motions(3, rows=[[0, 1], [2, 3], [4, 5]], kind="pair")
    found = answers(summary_of([3.0, 1.0, 2.0, NAN, NAN, NAN]), pairs).least_over_direction
    np.testing.assert_array_equal(found[0], [[1.0], [2.0], [NAN]])
    assert found[1].tolist() == [[1], [2], [-1]]


@pytest.mark.parametrize("count", [1, 2])
def test_answers_to_given_sequences_are_of_no_records(count):
    summary = summary_of([2.0] * count).assign(event=("record", ["given"] * count))
    for npts, kind in ((-1, "sequence"), (400, "record")):
        assert Answers(summary.assign(npts=("record", [npts] * count))).motions.kind == kind


def test_motions_of_a_sweep():
    summary = summary_of([1.0, 2.0, 3.0]).assign(event=("record", ["Kobe", "Maule", "Kobe"]))
    directions = xr.Dataset(
        {"record_index": (("pair", "direction"), np.array([[0, 1], [2, -1], [-1, -1]]))}, {"pair": ["a", "b", "c"]}
    )
    found = answers_of(xr.DataTree.from_dict({"/summary": summary, "/directions": directions})).motions
    assert (found.names, found.kind, found.index.tolist()) == (["a", "b"], "pair", [[0, 1], [2, -1]])
    assert found.events == ["Kobe", "Kobe"]
    assert "2 pairs of channels" in counted(found)


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


def test_a_median_without_what_is_not_known_is_that_of_numpy():
    for factors in ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0, 8.0], [1.0, NAN, 4.0], [INF, INF, 3.0], [NAN, NAN], [0.1, 0.3]):
        known = [factor for factor in factors if not math.isnan(factor)]
        (margin,) = answers(summary_of(factors)).margins()
        np.testing.assert_equal(margin.median, float(np.median(known)) if known else NAN)
    (margin,) = answers(summary_of([])).margins()
    assert (math.isnan(margin.smallest), math.isnan(margin.median), margin.place) == (True, True, -1)


def test_bounds_and_what_is_open():
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    (margin,) = answers(summary_of([0.4, NAN, 2.0, 3.0], resolved=[0, 1, 1, 1]), of).margins()
    assert (margin.smallest, margin.open, margin.median, margin.partial) == (0.4, True, 2.0, 1)
    assert margin.bounds == (True, False)
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


def test_a_pair_overturns_a_body_in_one_of_its_directions():
    outcomes = [Outcome.OVERTURNS, Outcome.ROCKS, Outcome.UNRESOLVED, Outcome.AT_REST]
    of = motions(4, rows=[[0, 1], [2, 3]], kind="pair")
    found = answers(summary_of([0.5, 2.0, 3.0, 4.0], outcomes=outcomes), of)
    assert (found.overturnings(), found.unresolved, found.counts) == ([1], [1], [1, 1, 1, 1])
