"""Verdicts, conditions and ranges, on cases made by hand."""

import numpy as np
import pytest
import xarray as xr

from rockpulse.studies.paper.finding import Finding, Statement, examine, interval_ranges, statement_table

CASES = ("case",)


def flags(*values):
    return xr.DataArray(np.array(values, dtype=bool), dims=CASES)


@pytest.mark.parametrize(
    ("held", "valid", "verdict", "where"),
    [
        ((1, 1), None, "holds", "everywhere"),
        ((0, 0), None, "fails", "nowhere"),
        ((0, 1), (0, 1), "holds", "everywhere"),
        ((0, 1), (1, 0), "fails", "nowhere"),
        ((0, 1), None, "holds_in_part", "only case by case"),
        ((0, 1), (0, 0), "not_examined", "everywhere"),
    ],
)
def test_the_verdict_counts_valid_cases_only(held, valid, verdict, where):
    finding = Finding(flags(*held), "", valid=None if valid is None else flags(*valid))
    assert finding.verdict == verdict
    if verdict != "not_examined":
        assert finding.where == where


def test_the_first_condition_under_which_all_hold_is_named():
    conditions = {"it rains": flags(1, 1, 0), "it snows": flags(0, 0, 0), "it is dry": flags(0, 1, 1)}
    finding = Finding(flags(0, 1, 1), "", conditions=conditions)
    assert finding.where == "it is dry (2 of the cases, all of them)"


def test_ranges_by_spacing():
    held = xr.DataArray(
        [[1, 1, 1], [0, 1, 1], [1, 0, 1], [0, 0, 0]],
        {"spacing": ["end", "middle", "open", "start"], "interval": [0.1, 0.2, 0.3]},
    ).astype(bool)
    assert interval_ranges(held) == "end: every dT; middle: dT 0.2 to 0.3 s; open: dT 0.1, 0.3 s"
    assert interval_ranges(held & False) == "nowhere"
    assert Finding(held, "").where.startswith("end: every dT")


def test_the_table_has_a_row_a_statement():
    statements = (
        Statement("first", "it holds", lambda figure: Finding(flags(1, 1), "2 of 2")),
        Statement("second", "nothing to see", lambda figure: Finding(flags(1, 1), "", valid=flags(0, 0))),
    )
    table = statement_table(examine(xr.Dataset(), statements))
    assert table["statement"].values.tolist() == ["first", "second"]
    assert table["verdict"].values.tolist() == [2, 3]
    assert table["cases"].values.tolist() == [2, 0]
    assert table["where"].values.tolist() == ["everywhere", ""]
    assert table["verdict"].attrs["flag_meanings"] == "fails holds_in_part holds not_examined"
