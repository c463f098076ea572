"""What decides between two assessments: margins of the bodies, ratios that crossed one."""

import numpy as np
import pytest
import xarray as xr
from compared_trees import compare
from results_tree import RECORDS, demanding, results_tree

from rockpulse.views.diff.differences import CAPACITY, FACTOR


def demanded(factors, outcomes=None, kept=(0, 1, 2)):
    """With the factors of the nonlinear model (record, block), and demands of 1 and 5 m/s2."""
    made = results_tree()
    summary = made["summary"].to_dataset()
    summary["safety_factor"].values[..., 2] = factors
    if outcomes is not None:
        summary["outcome"].values[..., 2] = outcomes
    strength = summary["pga"].values[:, None, None, None] / np.array([1.0, 5.0])
    ratio = summary["safety_factor"].values[..., None] * strength
    summary = demanding(
        summary,
        {"SLD": 1.0, "SLV": 5.0},
        safe_up_to=(("record", "block", "model"), np.full((3, 3, 3), 10.0)),
        capacity_ratio=(("record", "block", "model", "demand"), ratio),
    )
    made["summary"] = xr.DataTree(summary.isel(record=list(kept)))
    return made


#: Capacities over 5 m/s2, with PGA 5.5574 and 4.619 m/s2: 1.41 of the column is 1.57, 1.01 is 1.12, 0.9 is 0.83.
BEFORE = [[1.41, 2.0, np.inf], [3.0, 2.0, np.inf], [np.inf] * 3]
AFTER = [[1.41, 1.01, np.inf], [3.0, 0.9, np.inf], [np.inf] * 3]


@pytest.mark.sweep
def test_changed_margins_come_first_and_capacities_that_crossed_one_are_listed():
    fallen = np.array([[0, 0, 0], [0, 2, 0], [0, 0, 0]])
    _, text = compare(demanded(BEFORE, np.zeros((3, 3))), demanded(AFTER, fallen))
    head = text.split("\n\n")[1]
    assert " ".join(head.split()) == (
        "Bodies whose margin changed (by the nonlinear model): 1 column: smallest SF 2.00 -> 0.90, smallest "
        "capacity/demand SLD 9.24 -> 4.16, smallest capacity/demand SLV 1.85 -> 0.83, overturned 0 -> 1 of 3 records"
    )
    found, text = compare(demanded(BEFORE), demanded(AFTER, kept=[0, 2]))
    assert [" ".join(line.split()) for line in found.bodies] == [
        "column: smallest SF 2.00 -> 1.01, smallest capacity/demand SLD 11.1 -> 5.61, smallest capacity/demand SLV "
        "2.22 -> 1.12, overturned 0 of the 2 records in both"
    ]
    found, _ = compare(demanded(BEFORE), demanded(AFTER), ignore=["safety_factor", "capacity_ratio"])
    assert found.bodies == []
    found, text = compare(demanded(BEFORE), demanded(AFTER))
    (one,) = found.sides[CAPACITY].named
    assert one.place == (RECORDS[1], "column", "nonlinear", "SLV")
    assert [float(value) for value in (one.before, one.after)] == pytest.approx([2 * 4.619 / 5, 0.9 * 4.619 / 5])
    told = " ".join(text.split())
    assert "that crossed 1 (below it the record overturns before it reaches the demand): 1" in told
    assert max(map(len, text.splitlines())) <= 120


def test_a_body_counts_with_its_worst_restitution_and_the_lower_bound_is_marked():
    def made(factor):
        found = results_tree(2)
        summary = found["summary"].to_dataset()
        summary["safety_factor"].values[:, 1, 2, 0] = 4.0
        summary["safety_factor"].values[:, 1, 2, 1] = factor
        resolved = xr.ones_like(summary["safety_factor"])
        resolved.values[0, 1, 2, 1] = 0.0
        found["summary"] = xr.DataTree(summary.assign(factor_resolved=resolved))
        return found

    found, _ = compare(made([1.5, 2.0, 3.0]), made([1.2, 2.0, np.inf]))
    assert found.bodies == ["column: smallest SF 1.50! -> 1.20!, overturned 0 of 3 records"]


@pytest.mark.sweep
def test_what_was_not_found_is_told_up_to_where_it_was_sought():
    def made(limit):
        found = demanded([[1.5, 2.0, np.inf], [3.0, 2.0, np.inf], [np.inf] * 3])
        found["summary"]["safe_up_to"].values[:, 2] = limit
        return found

    found, _ = compare(made(4.0), made(10.0))
    (line,) = found.bodies
    assert line.startswith("cabinet: smallest SF >4 -> >10, smallest capacity/demand SLD >18.4 -> >46.1, ")


def probable(probability, factor, **asked):
    """With a probability and a factor of 10 % of the column, and `asked`, variables along the demands."""
    found = demanded(BEFORE)
    summary = found["summary"].to_dataset()
    summary["safety_factor"][:] = np.nan
    tables = {name: np.full((3, 3), 0.01) for name in ("overturning_probability", "factor_10", "factor_10_low")}
    tables["factor_10"][:], tables["factor_10_low"][:] = 1.5, 1.4
    tables["overturning_probability"][:2, 1], tables["factor_10"][0, 1] = probability, factor
    variables = {name: (("record", "block"), table) for name, table in tables.items()}
    variables |= {name: (("record", "block", "demand"), table) for name, table in asked.items()}
    found["summary"] = xr.DataTree(summary.assign(variables))
    return found


@pytest.mark.sweep
def test_a_changed_probability_and_factor_of_ten_percent_are_told_of_every_body():
    found, text = compare(probable(0.04, 1.2), probable(0.3, 0.8))
    (line,) = found.bodies
    # Two records of one earthquake, the third of another, which has 0.01: half of the sum.
    assert " ".join(line.split()).startswith(
        "column: P 0.025 -> 0.15, smallest scale factor at P = 10 % 1.20 -> 0.80, P at SLD -, smallest cap"
    )
    (crossed,) = found.sides[FACTOR].named
    assert crossed.place == (RECORDS[0], "column")
    assert "Scale factors at P = 10 % that crossed 1" in " ".join(text.split())


@pytest.mark.sweep
def test_the_probability_at_a_demand_is_told_and_its_factor_is_that_of_the_file():
    """A factor to the demand that no PGA tells, as of a demand in PGV."""

    def made(at_slv):
        at = np.full((3, 3, 2), 0.02)
        at[:, 1, 1] = at_slv
        return probable(0.01, 1.5, demand_probability=at, demand_factor=np.full((3, 3, 2), 3.0))

    found, _ = compare(made(0.1), made(0.4))
    (line,) = found.bodies
    assert "P at SLV 0.10 -> 0.40" in line
    assert "smallest capacity/demand SLV 0.50" in line


def test_files_without_a_common_body_differ_in_their_bodies_alone():
    other = demanded(AFTER)
    summary = other["summary"].to_dataset()
    other["summary"] = xr.DataTree(summary.assign_coords(block=[f"other {name}" for name in summary["block"].values]))
    found, text = compare(demanded(BEFORE), other)
    assert found.bodies == []
    assert not found.same
    assert "blocks only in the first file: 3" in text
    assert "3 records, 3 blocks, " in text
