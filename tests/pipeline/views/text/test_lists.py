"""Lists of cases, records and blocks, and the overview of results too large to be shown whole."""

import numpy as np
import pytest
import xarray as xr
from results_tree import RECORDS, demanding, results_tree

from rockpulse.assessment.answers import Answers
from rockpulse.storage.export.row_selection import Condition, RowSelection
from rockpulse.views.text import overview as overviews
from rockpulse.views.text.lists import block_list, case_list, record_list, worst_cases
from rockpulse.views.text.overview import block_details, overview, record_details


@pytest.fixture
def tree():
    """The nonlinear model searched as well."""
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    summary["safety_factor"][:, :, 2] = [[0.42, 1.3, np.nan], [2.1, 3.0, 0.84], [np.inf, np.inf, np.inf]]
    summary["capacity_pga"] = summary["safety_factor"] * summary["pga"]
    summary["capacity_pga"].attrs.update(units="m s^-2", long_name="capacity")
    tree["summary"] = xr.DataTree(summary)
    return tree


@pytest.fixture
def summary(tree):
    return tree["summary"].to_dataset()


def listed(text):
    """Cells of the lines of the table, from the last line of the headings."""
    lines = [line.split() for line in text.split("\n\n")[1].splitlines()]
    return lines[next(at for at, line in enumerate(lines) if line[0] in ("record", "body")) :]


def worst(summary, **options):
    return worst_cases(Answers(summary), RowSelection(**options))


def test_cases_are_listed_worst_first_by_the_fullest_model_and_equal_ones_once(summary):
    text = worst(summary, limit=3)
    assert text.startswith("9 cases with model nonlinear, smallest safety_factor first; 3 shown (--limit N for more)")
    head, *lines = listed(text)
    assert "nonlinear" in head
    assert "model" not in head
    assert " ".join(lines[0]) == f"{RECORDS[0]} boundary wall 0.985 0.57 2.50 1.44 OVERTURNS 0.42 0.24"
    assert " ".join(lines[1]) == f"{RECORDS[1]} cabinet 0.790 0.47 2.50 0.40 0.41 0.84 0.40"
    assert len(lines) == 3
    summary = results_tree(2)["summary"].to_dataset()
    assert worst(summary).startswith("15 cases")


def test_with_a_demand_cases_are_listed_by_the_capacity_over_it(summary):
    """The weakest demand counts: 0.84 times 0.47 g over 4 m/s2, before 0.42 times 0.57 g over 2 m/s2."""
    capacity = summary["capacity_pga"].expand_dims(demand=2, axis=-1) / xr.DataArray([2.0, 4.0], dims="demand")
    text = worst(demanding(summary, {"SLD": 2.0, "SLV": 4.0}, capacity_ratio=capacity), limit=2)
    assert "smallest capacity/demand first" in text
    head, first, second = listed(text)
    assert head[-1] == "capacity/demand"
    values = np.sort(capacity.isel(model=2).min("demand").values.ravel())
    assert [float(first[-1]), float(second[-1])] == pytest.approx(values[:2], rel=5e-3)


def test_what_a_condition_is_about_has_a_column_and_nothing_found_no_table(summary):
    selection = RowSelection(conditions=(Condition.parse("arias_intensity > 4"),), sort="intense_end")
    head, first, *_ = listed(case_list(summary, selection))
    assert head[-2:] == ["arias_intensity", "intense_end"]
    assert first[-2:] == ["5.2", "22"]
    text = case_list(summary, RowSelection(conditions=(Condition.parse("pga > 100"),)))
    assert text == "0 cases with model nonlinear; pga > 100"


def test_several_models_have_a_column_and_without_a_search_the_worst_rotate_most(summary):
    text = case_list(summary, RowSelection({"model": ("*",), "record": (RECORDS[0],), "block": ("cabinet",)}))
    head, *lines = listed(text)
    assert head[:3] == ["record", "body", "model"]
    assert [line[2] for line in lines] == ["resonance", "sequence", "nonlinear"]
    assert "OVERTURNS*" in lines[0]
    assert lines[2][-3:] == ["unresolved", "-", "-"]
    assert "*: outside the range" in text
    assert "?" not in text
    summary["safety_factor"][:] = np.nan
    text = worst(summary, limit=2)
    assert "largest peak_rotation_ratio first" in text
    assert listed(text)[1][0] == RECORDS[0]
    assert "OVERTURNS" in listed(text)[1]


def test_records_and_blocks_say_what_overturns_and_their_worst(summary):
    head, *lines = listed(record_list(summary, RowSelection()))
    assert " ".join(lines[0]) == f"{RECORDS[0]} 0.57 0.71 5.20 0.62 2 1 of 3 0.42 boundary wall"
    assert " ".join(lines[1]) == f"{RECORDS[1]} 0.47 ~0.43 3.10 0.35 0 of 3 0.84 cabinet"
    assert " ".join(lines[2]) == "weak.1 0.001 0.002 0 - 0 of 3 none"
    assert head[-3:] == ["overturned", "SF", "of"]
    weakest = record_list(summary, RowSelection(sort="pga", limit=1))
    assert weakest.startswith("1 of 3 records, smallest pga first")
    assert listed(weakest)[1][0] == "weak.1"
    falls = RowSelection(conditions=(Condition.parse("outcome = overturns"),))
    assert record_list(summary, falls).startswith("1 record\n")
    every = RowSelection({"model": ("resonance",)}, falls.conditions)
    assert record_list(summary, every).startswith("2 records\n")
    assert "by the resonance model" in record_list(summary, every)
    _, *lines = listed(block_list(summary, RowSelection()))
    assert lines[0] == f"boundary wall 0.25 2.20 0.11 2.58 0.43 0.985 1 of 3 0.42 {RECORDS[0]}".split()
    assert lines[2] == f"cabinet - - 0.38 2.60 1.54 0.790 0 of 3 0.84 {RECORDS[1]}".split()
    several = listed(block_list(results_tree(2)["summary"].to_dataset(), RowSelection({"block": ("column",)})))
    assert several[1][6:9] == ["0.830", "to", "0.930"]


def test_lists_say_how_far_was_searched_and_mark_doubtful_peaks(summary):
    factor = summary["safety_factor"]
    summary = summary.assign(safe_up_to=factor.where(np.isfinite(factor), 10.0))
    summary["pga"][2] = 98.1
    text = case_list(summary, RowSelection({"record": ("weak.1",), "block": ("column",)}))
    assert listed(text)[1][:3] == ["weak.1", "(peak?)", "column"]
    assert listed(text)[1][-2:] == [">10", ">100"]
    assert ">: no overturning up to this scale factor" in text
    assert "(peak?): a peak above 5 g" in text
    records = record_list(summary, RowSelection())
    assert listed(records)[3][:2] == ["weak.1", "(peak?)"]
    assert listed(records)[3][-1] == ">10"
    assert ">: no overturning up to this scale factor" in records
    assert "(peak?): a peak above 5 g" in records
    assert "Above 1" not in text
    summary["peak_rotation_ratio"][0, 1, 2] = 1.2
    assert "Above 1: the body rocked beyond" in case_list(
        summary, RowSelection({"record": (RECORDS[0],), "block": ("column",)})
    )


def test_where_none_was_found_and_one_answer_is_unknown_the_smallest_factor_is_unknown(summary):
    factor = summary["safety_factor"].copy()
    factor[2, 1, 2] = np.nan
    summary = summary.assign(safety_factor=factor, safe_up_to=factor.where(np.isfinite(factor), 10.0))
    assert listed(record_list(summary, RowSelection()))[3][-1] == "-"
    factor[:, 2, 2] = [np.inf, np.nan, np.inf]
    summary = summary.assign(safety_factor=factor)
    assert listed(block_list(summary, RowSelection()))[3][-1] == "-"
    assert listed(block_list(summary, RowSelection()))[1][-2:] == ["0.42", RECORDS[0]]  # what is known


def many(tree, copies=60):
    """The same records many times over."""
    summary = tree["summary"].to_dataset()
    repeated = summary.isel(record=np.tile(np.arange(3), copies))
    names = [f"{name}~{k}" for k in range(copies) for name in RECORDS]
    repeated = repeated.assign_coords(record=("record", names, summary["record"].attrs))
    tree["summary"] = xr.DataTree(repeated)
    return tree


def test_sixty_records_fit_on_one_screen_with_the_bodies_first(tree):
    text = overview(many(tree, copies=21))
    lines = text.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 132
    bodies, records = (
        next(k for k, line in enumerate(lines) if words in line) for words in ("Each body", "The worst 10")
    )
    assert bodies < records
    assert len([line for line in lines if line.startswith("  ") and "~" in line and not line.startswith("  b")]) >= 10
    legend = lines[bodies + 6 : records - 1]
    assert 1 <= len(legend) <= 4
    assert "rockpulse inspect RESULTS --all" in text


def test_large_results_are_counted_and_their_worst_shown(tree):
    text = overview(many(tree), whole=True)
    assert text.startswith("Borgo: 180 records, 3 bodies; models: resonance, sequence, nonlinear\n")
    assert len(text.splitlines()) < 80
    assert max(map(len, text.splitlines())) <= 124
    line = next(line for line in text.splitlines() if line.startswith("  nonlinear"))
    # at rest, rocks, overturns, share, unresolved, SF < 1
    assert line.split()[1:7] == ["180", "240", "60", "11.1%", "60", "120"]
    assert "not a prediction" in text
    wall = next(line for line in text.splitlines() if line.startswith("  boundary wall"))
    assert " ".join(wall.split()[2:]) == f"60 of 180 0.42 {RECORDS[0]}~0 0.11"  # overturn it, smallest factor, uplift
    assert sum(line.split()[1:5] == ["boundary", "wall", "0.985", "0.57"] for line in text.splitlines()) == 12
    assert "PGV is doubtful in 60 records" in text
    assert "--outcome overturns" in text


def test_what_is_large_is_counted_in_verdicts_that_are_shown(tree, monkeypatch):
    summary = results_tree(2)["summary"].to_dataset()
    monkeypatch.setattr(overviews, "WHOLE", 15)
    assert not overviews.is_large(Answers(summary))
    monkeypatch.setattr(overviews, "WHOLE", 14)
    assert overviews.is_large(Answers(summary))


def test_a_record_with_few_blocks_is_shown_whole_and_a_block_under_many_records_by_its_worst(tree):
    summary = many(tree, 80)["summary"].to_dataset()
    assert "SF: smallest scale factor" in record_details(summary, f"{RECORDS[0]}~7")
    text = block_details(summary, "column")
    assert len(text.splitlines()) < 50
    assert "240 verdicts by the nonlinear model: 80 at rest, 160 rocks, 0 overturns, 0 unresolved" in text
    assert "240 cases with model nonlinear, smallest safety_factor first; 20 shown" in text


def test_magnitude_and_distance_have_a_column_where_a_record_states_them(summary):
    stated = {"magnitude": [7.1, np.nan, np.nan], "epicentral_distance": [np.nan] * 3}

    def known():
        return summary.assign({name: ("record", values) for name, values in stated.items()})

    head, first, second, _ = listed(record_list(known(), RowSelection()))
    assert head.count("M") == 1
    assert (first[5], second[5]) == ("7.1", "-")
    assert "distance" not in head
    stated["epicentral_distance"] = [30500.0, np.nan, np.nan]
    selection = RowSelection(conditions=(Condition.parse("magnitude > 7"),))
    head, first = listed(record_list(known(), selection))
    assert "[km]" in head
    assert first[5:7] == ["7.1", "30.5"]
    assert head.count("magnitude") == 0
    assert "M" not in listed(record_list(summary, RowSelection()))[0]
