"""Which rows a selection names, on a tree whose answers are known."""

import numpy as np
import pytest
import xarray as xr
from results_tree import BLOCKS, RECORDS, results_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.export.row_selection import SHOWN, Condition, RowSelection, positions_matching, rows
from rockpulse.storage.hdf5.netcdf4 import flags_as_words, pointwise, slab
from rockpulse.storage.variables.summary import SUMMARY

DIMS = ("record", "block", "model")


@pytest.fixture
def summary():
    return results_tree()["summary"].to_dataset()


def where(*conditions, **options):
    return RowSelection(conditions=tuple(map(Condition.parse, conditions)), **options)


def lanes(summary, selection, dims=DIMS, **options):
    places, found = rows(summary, dims, selection, **options)
    assert all(place.size == places[dims[0]].size for place in places.values())
    return [tuple(int(places[dim][k]) for dim in dims) for k in range(places[dims[0]].size)], found


@pytest.mark.parametrize(
    ("words", "parsed"),
    [
        ("safety_factor<1", ("safety_factor", "<", "1")),
        (" outcome == overturns ", ("outcome", "=", "overturns")),
        ("source != *.AT2", ("source", "!=", "*.AT2")),
        ("pga >= 1e-3", ("pga", ">=", "1e-3")),
    ],
)
def test_a_condition_is_a_name_a_comparison_and_a_value(words, parsed):
    assert Condition.parse(words) == Condition(*parsed)


@pytest.mark.parametrize("words", ["", "safety_factor", "< 1", "1 < pga", "pga ~ 3"])
def test_other_words_are_no_condition(words):
    with pytest.raises(ResultsError, match="expected a condition such as 'safety_factor < 1'"):
        Condition.parse(words)


def test_flags_are_compared_by_their_words(summary):
    found, count = lanes(summary, where("outcome = overturns"))
    assert count == 7
    assert found == [tuple(place) for place in np.argwhere(summary["outcome"].values == 2).tolist()]
    assert lanes(summary, where("outcome = at-rest | Unresolved"))[1] == 9 + 1
    assert lanes(summary, where("outcome != overturns"))[1] == 27 - 7


def test_conditions_on_fewer_dimensions_are_repeated_and_all_have_to_hold(summary):
    assert lanes(summary, where("pga > 5", "slenderness < 3", "outcome = rocks"))[0] == [(0, 2, 1)]
    assert lanes(summary, where("source = *.RAW", "block_warnings = "))[1] == 2 * 2 * 3


def test_nan_meets_no_comparison(summary):
    assert lanes(summary, where("safety_factor <= 1e9"))[1] + lanes(summary, where("safety_factor > 1e9"))[1] == 18


def test_names_are_patterns_or_exact(summary):
    labels = RowSelection({"record": ("CI.*",), "block": ("c*",), "model": ("nonlinear",)})
    assert lanes(summary, labels)[0] == [(0, 1, 2), (0, 2, 2), (1, 1, 2), (1, 2, 2)]
    assert positions_matching(["wall [a]", "wall a"], ["wall [a]"], "block").tolist() == [0]
    assert positions_matching(["wall [a]", "wall a"], ["wall *", "wall a"], "block").tolist() == [0, 1]


def test_a_condition_on_a_text_takes_it_as_it_is_before_it_is_a_pattern(summary):
    summary["block"] = ("block", ["wall [north]", "wall n", "A|B"])
    for value, places in (("wall [north]", [0]), ("A|B", [2]), ("wall n | A*", [1, 2]), ("wall *|none", [0, 1])):
        found, _ = lanes(summary, where(f"block = {value}"), dims=("block",))
        assert [place for (place,) in found] == places
        found, _ = lanes(summary, where(f"block != {value}"), dims=("block",))
        assert [place for (place,) in found] == [place for place in range(3) if place not in places]


def test_a_column_of_the_tables_is_its_variable(summary):
    for shown, name in (
        ("SF < 1", "safety_factor < 1"),
        ("PGA>3", "pga > 3"),
        ("uplift ratio > 2", "uplift_ratio > 2"),
    ):
        assert Condition.parse(shown) == Condition.parse(name)
    assert Condition.parse("scale factor at P = 10 % <= 1").name == "factor_10"
    assert Condition.parse("P > 0.5").name == "overturning_probability"
    assert set(SHOWN.values()) <= set(SUMMARY)
    with pytest.raises(ResultsError, match="expected a condition"):
        Condition.parse("< 1")


def test_a_variable_that_is_known_of_no_answer_is_no_condition(summary):
    summary["safety_factor"][:] = np.nan
    with pytest.raises(ResultsError, match=r"safety_factor: all its values are unknown.*use factor_10"):
        lanes(summary, where("SF < 1"))


@pytest.mark.parametrize(
    ("selection", "message"),
    [
        (RowSelection({"block": ("colum",)}), r'no block "colum" in these results; did you mean "column"'),
        (RowSelection({"block": ("LUM",)}), r"1 of 3 names contain it; the pattern '\*lum\*' selects:\n  column$"),
        (where("outcom = rocks"), r"no variable 'outcom' .* did you mean \"outcome\""),
        (where("outcome = falls"), r"outcome: expected one of at_rest, rocks, overturns, unresolved"),
        (where("outcome = rock"), r"unresolved, found 'rock'; did you mean \"rocks\"\?$"),
        (where("pga > nan"), r"pga: expected a number, found 'nan'"),
        (where("source < a"), r"source is a text: expected = or !=, found <"),
        (RowSelection({"demand": ("collapse",)}), "this table cannot be selected by demand"),
    ],
)
def test_what_is_not_there_is_answered_with_what_there_is(summary, selection, message):
    with pytest.raises(ResultsError, match=message):
        rows(summary, DIMS, selection)


def test_rows_are_sorted_what_is_not_known_last_and_cut_after_that(summary):
    factor = summary["safety_factor"].values
    found, count = lanes(summary, RowSelection(sort="safety_factor"))
    values = [factor[place] for place in found]
    known = [value for value in values if not np.isnan(value)]
    assert known == sorted(known)
    assert len(known) == 18
    assert np.isnan(values[18:]).all()
    assert count == 27
    down, _ = lanes(summary, RowSelection(sort="safety_factor", descending=True))
    assert [factor[place] for place in down][:18] == known[::-1]
    assert lanes(summary, RowSelection(sort="safety_factor", limit=4)) == (found[:4], 27)


def test_equal_keys_keep_the_order_of_the_file(summary):
    found, _ = lanes(summary, RowSelection({"model": ("sequence",)}, sort="slenderness"))
    assert [place[1] for place in found] == [2] * 3 + [1] * 3 + [0] * 3
    assert [place[0] for place in found[:3]] == [0, 1, 2]


def test_texts_are_sorted_by_letters(summary):
    found, _ = lanes(summary, RowSelection(sort="block"), dims=("block",))
    assert [BLOCKS[place] for (place,) in found] == sorted(BLOCKS)


def test_a_condition_beyond_the_dimensions_has_to_hold_somewhere_and_sorts_by_its_worst(summary):
    names = {"model": ("nonlinear",)}
    assert lanes(summary, where("outcome = overturns", names=names), dims=("record",))[0] == [(0,)]
    assert lanes(summary, where("outcome = overturns"), dims=("record",))[0] == [(0,), (1,)]
    summary["safety_factor"][1, 2, 0] = 0.3
    found, _ = lanes(summary, RowSelection(sort="safety_factor"), dims=("record",))
    assert found == [(1,), (0,), (2,)]
    only_weak = RowSelection({"record": (RECORDS[2],), "model": ("nonlinear",)}, sort="safety_factor")
    assert lanes(summary, only_weak, dims=("record",)) == ([(2,)], 1)  # nothing is known of it


def test_a_mask_cuts_along_some_dimensions():
    summary = results_tree(2)["summary"].to_dataset()
    held = np.array([[True, False], [True, True], [True, True]])
    dims = ("record", "block", "case", "model")
    found, count = lanes(summary, RowSelection(), dims=dims, masks=[(("block", "case"), held)])
    assert count == 3 * 5 * 3
    assert all(place[1] > 0 or place[2] == 0 for place in found)


def test_boxes_and_places_are_the_same_values_as_plain_indexing():
    random = np.random.default_rng(5)
    values = random.normal(size=(7, 5, 3))
    variable = xr.Variable(("record", "block", "model"), values)
    at, of = np.array([6, 2, 2]), np.array([4, 0])
    assert (slab(variable, {"record": at, "model": of[:1] - 2, "other": at}) == values[np.ix_(at, range(5), [2])]).all()
    assert (slab(variable, {"record": slice(2, 4)}) == values[2:4]).all()
    assert slab(variable, {"record": at[:0]}).shape == (0, 5, 3)
    places = {"record": at, "block": np.array([0, 4, 1]), "model": np.array([1, 1, 0]), "case": at}
    assert pointwise(variable, places).tolist() == [values[6, 0, 1], values[2, 4, 1], values[2, 1, 0]]
    assert pointwise(variable, dict.fromkeys(variable.dims, at[:0])).shape == (0,)
    assert flags_as_words(np.zeros((0,), dtype=np.int8), {0: "no"}).shape == (0,)
