"""The tables for the terminal, on a tree whose answers are known."""

import numpy as np
import pytest
import xarray as xr
from results_tree import BLOCKS, RECORDS, demanding, results_tree

from rockpulse.assessment.answers import Answers
from rockpulse.views.shared.files_used import failure_list
from rockpulse.views.text.margins import smallest_capacities
from rockpulse.views.text.overview import overview
from rockpulse.views.text.verdicts import body_verdicts, factor_table, governing, overturned, verdict_table


def row(text, label, after=""):
    """Cells of the first line for a block below a heading."""
    lines = text[text.index(after) :].splitlines()
    line = next(line for line in lines if line.startswith(f"  {label}"))
    return line[len(label) + 2 :].split()


@pytest.fixture
def summary():
    return results_tree()["summary"].to_dataset()


def test_every_verdict_is_a_word_or_a_figure_and_resonance_an_upper_bound(summary):
    text = verdict_table(summary)
    assert row(text, "boundary wall", RECORDS[0]) == ["0.985", "2.50", "1.44", "OVERTURNS", "OVERTURNS", "OVERTURNS"]
    assert row(text, "column", RECORDS[0]) == ["0.930", "2.50", "0.63", "OVERTURNS", "0.41", "0.41"]
    assert row(text, "column", RECORDS[2])[2:] == ["-", "at", "rest", "at", "rest", "at", "rest"]
    assert "upper-bound input" in verdict_table(summary)
    assert "not a prediction" in verdict_table(summary)
    assert "upper-bound" not in verdict_table(summary.sel(model=["nonlinear"]))


def test_drift_and_a_rotation_beyond_the_critical_angle_are_marked_and_explained(summary):
    text = verdict_table(summary)
    assert f"{RECORDS[0]}  PGA 0.567 g  PGV 0.71 m/s  I 0.62 m/s\n" in text
    assert f"{RECORDS[1]}  PGA 0.471 g  PGV ~0.43 m/s (drift)  I 0.35 m/s\n" in text
    assert "  ~ (drift): the baseline of the record drifts" in text
    assert "drift" not in verdict_table(summary.sel(record=list(RECORDS[:1])))
    assert "Above 1" not in verdict_table(summary)
    summary["peak_rotation_ratio"][1, 1, 2] = 1.13
    assert "Above 1: the body rocked beyond the critical angle and came back" in verdict_table(summary)
    assert "Above 1" not in verdict_table(summary.sel(block=list(BLOCKS[:1])))


def test_what_a_model_cannot_say_is_marked_and_explained(summary):
    text = verdict_table(summary)
    assert row(text, "cabinet", RECORDS[0])[3:] == ["OVERTURNS*", "0.41*", "unresolved"]
    assert "slenderness below 3" in text
    summary["applicable"][:] = 1
    assert "*" not in verdict_table(summary)
    assert "unresolved: the model gives no result (free flight)" in verdict_table(summary)
    summary["outcome"][0, 0, 2] = -1
    assert row(verdict_table(summary), "boundary wall", RECORDS[0])[-1] == "-"


@pytest.mark.sweep
def test_nowhere_does_it_say_nan():
    for cases in (None, 3):
        tree = results_tree(cases)
        factors = factor_table(Answers(tree["summary"].to_dataset()))
        text = "".join((overview(tree), overview(tree, whole=True), factors, failure_list(tree)))
        assert "nan" not in text.lower().replace("resonance", "")


def test_five_models_fit_into_120_columns_and_restitution_cases_have_a_row_each():
    models = ["resonance", "sequence", "impulsive", "linear", "nonlinear"]
    summary = results_tree()["summary"].to_dataset()
    summary = summary.isel(record=[0] * 7, block=[0, 1, 2, 0, 1], model=[0] * 5)
    summary = summary.assign_coords(
        record=("record", [f"CI.CCC..HN{k}@20190706T031953" for k in range(7)]),
        block=("block", [f"a body with a rather long name, no. {k}" for k in range(5)]),
        model=("model", models),
    )
    lines = verdict_table(summary).splitlines()
    assert max(map(len, lines)) <= 120
    assert sum("OVERTURNS" in line for line in lines) == 35
    text = verdict_table(results_tree(2)["summary"].to_dataset().isel(record=[0]))
    assert [line.split()[1] for line in text.splitlines() if line.startswith("  column")] == ["0.930", "0.830"]
    assert sum(line.startswith("  boundary wall") for line in text.splitlines()) == 1


def test_factors_are_numbers_none_or_a_dash(summary):
    text = factor_table(Answers(summary))
    assert row(text, "column", RECORDS[0])[3:] == ["0.50", "1.70"]  # the nonlinear model was not searched
    assert row(text, "column", RECORDS[2])[3:] == ["none", "none"]
    assert factor_table(Answers(summary.assign(safety_factor=np.nan * summary["safety_factor"]))) == ""
    assert "SF" not in verdict_table(summary)


@pytest.fixture
def searched(summary):
    """The nonlinear model searched: the first record overturns the column in three intervals, and rocks it at one."""
    factor, count = summary["safety_factor"], xr.full_like(summary["outcome"], 1, dtype=np.int64)
    factor[:, :, 2], factor[0, 1, 2], factor[2, 0, 2], count[0, 1, 2] = 1.7, 0.84, np.inf, 3
    return summary.assign(interval_count=count)


def test_the_factor_of_the_fullest_model_stands_beside_the_verdicts(searched):
    text = verdict_table(searched)
    assert row(text, "column", RECORDS[0])[-2:] == ["0.41", "0.84"]
    assert row(text, "boundary wall", RECORDS[1])[-1] == "1.70"
    assert row(text, "boundary wall", RECORDS[2])[-1] == "none"
    words = " ".join(text.split())
    assert "SF: smallest scale factor on the record" in words
    assert "1 with SF below 1 rocks only: a smaller scale factor overturns the body." in words
    assert row(factor_table(Answers(searched)), "column", RECORDS[0])[-2:] == ["0.84", "(3)"]


@pytest.mark.parametrize(
    ("step", "models", "told"),
    [
        (1.047, None, "(up to 4.7%)|([search] points)."),
        (1.005, ["x", "resonance", "sequence"], "(up to 0.5%)|([search] step)."),
        (1.0, None, None),
    ],
)
def test_what_a_search_may_miss_is_said(searched, step, models, told):
    """A closed form misses nothing, and a sequence is searched in steps."""
    searched["search_step"] = xr.full_like(searched["safety_factor"], step)
    shown = searched if models is None else searched.assign_coords(model=("model", models))
    text = " ".join(verdict_table(shown).split())
    words = " may lie below SF, undetected: the second digit of SF is not reliable "
    assert told.replace("|", words) in text if told else "undetected" not in text


@pytest.mark.sweep
def test_notes_count_what_is_shown(searched):
    for shown in ({"record": [0]}, {"block": [1]}):
        text = " ".join(verdict_table(searched.isel(shown)).split())
        assert "1 with SF below 1 rocks only:" in text
    text = " ".join(verdict_table(searched.sel(record=list(RECORDS[1:]))).split())
    assert "SF: smallest" in text
    assert "SF below 1" not in text
    several = results_tree(2)["summary"].to_dataset()
    several["safety_factor"][:] = 0.9
    assert "7 with SF below 1 rock only:" in verdict_table(several.assign(interval_count=several["outcome"] * 0 + 1))
    searched["outcome"][0, 1, 2] = 2
    assert "SF below 1" not in verdict_table(searched)


def test_a_factor_at_which_the_model_cannot_answer_is_marked_and_explained(searched):
    searched["factor_resolved"] = xr.full_like(searched["outcome"], 1)
    assert "!" not in verdict_table(searched) + factor_table(Answers(searched))
    searched["factor_resolved"][0, :2, 2] = 0
    text = verdict_table(searched)
    assert row(text, "boundary wall", RECORDS[0])[-1] == "1.70!"
    assert row(text, "column", RECORDS[0])[-1] == "0.84!"
    assert (
        "!: a lower bound: from this scale factor on the model gives no result (free flight, for example; 2 of 9)"
        in " ".join(text.split())
    )
    assert "1 with SF below 1 rocks only: a smaller scale factor overturns the body, or may (!)." in " ".join(
        text.split()
    )
    assert row(factor_table(Answers(searched)), "column", RECORDS[0])[-2:] == ["0.84!", "(3)"]
    assert "!: a lower bound" in factor_table(Answers(searched))
    ends = {len(line.rstrip("!")) for line in text.splitlines() if line.startswith(("  column", "  boundary wall"))}
    assert len(ends) == 1  # the marks stand beyond the numbers


def with_demands(summary):
    """Two demands; the capacity of the first record is the smallest, and the third is too weak to be scaled to them."""
    cube = summary["safety_factor"].dims
    capacity = np.ones(summary["safety_factor"].shape) * np.array([0.6, 1.5, 2.0])[:, None, None]
    capacity[2, 0], capacity[:, 2] = np.inf, np.nan
    ratio = capacity[..., None] / np.array([1.0, 2.5])
    return demanding(summary, {"damage": 2.0, "collapse": 4.0}, capacity_ratio=((*cube, "demand"), ratio))


@pytest.mark.sweep
def test_capacities_are_compared_with_every_demand_and_shown_only_where_one_is(searched):
    assert smallest_capacities(Answers(searched)) == ""
    text = smallest_capacities(Answers(with_demands(searched)))
    assert "damage (PGA 2 m/s2)" in text
    assert "collapse (PGA 4 m/s2)" in text
    assert row(text, "boundary wall")[1:] == ["0.60,", "1.05", "0.24,", "0.42"]
    assert row(text, "column")[1:] == ["0.60,", "1.05", "0.24,", "0.42"]
    assert row(text, "cabinet")[1:] == ["-", "-"]
    tree = results_tree()
    assert "Capacity" not in overview(tree, whole=True)
    tree["summary"] = xr.DataTree(with_demands(searched))
    assert "Capacity (scale factor that overturns x strength, nonlinear model) over demand" in overview(
        tree, whole=True
    )


def test_a_capacity_that_rests_on_a_lower_bound_is_marked(searched):
    summary = with_demands(searched)
    summary["factor_resolved"] = xr.full_like(summary["outcome"], 1)
    summary["factor_resolved"][0, 0, 2], summary["factor_resolved"][1, 1, 2] = 0, 0
    text = smallest_capacities(Answers(summary))
    assert row(text, "boundary wall")[1:] == ["0.60!,", "1.05!", "0.24!,", "0.42!"]  # of 0.6 or more, and 1.5
    assert row(text, "column")[1:] == ["0.60,", "1.05!", "0.24,", "0.42!"]
    assert "!: a lower bound" in " ".join(text.split())
    assert "-: not known, left out of smallest and median (2 of the records)" in " ".join(text.split())
    summary["factor_resolved"][:] = 1
    assert "!" not in smallest_capacities(Answers(summary))


def up_to_ten(summary):
    """The search ended at a factor of 10."""
    return summary.assign(safe_up_to=summary["safety_factor"].where(np.isfinite(summary["safety_factor"]), 10.0))


def test_where_nothing_was_found_the_cell_says_up_to_where(searched):
    searched = up_to_ten(searched)
    text = verdict_table(searched)
    assert row(text, "boundary wall", RECORDS[2])[-1] == ">10"
    assert ">10: no overturning up to this scale factor, the largest one tried ([search] factor_max)" in " ".join(
        text.split()
    )
    assert "none" not in text.replace("none found", "")
    assert "none found" not in verdict_table(searched.sel(record=list(RECORDS[:2])))
    factors = factor_table(Answers(searched))
    assert row(factors, "column", RECORDS[2])[3:] == [">10", ">10", "1.70"]
    assert ">: no overturning up to this scale factor" in factors
    searched["safe_up_to"][2, 0, 2] = 12.37
    assert row(verdict_table(searched), "boundary wall", RECORDS[2])[-1] == ">12.3"  # never more than was searched


def test_a_capacity_that_was_not_found_names_how_far_it_was_searched(searched):
    """The third record has a PGA of 0.01 m/s2: it cannot be scaled to any demand, and says nothing of it."""
    summary = up_to_ten(with_demands(searched))
    text = smallest_capacities(Answers(summary))
    assert row(text, "boundary wall")[1:] == ["0.60,", "1.05", "0.24,", "0.42"]  # the third is left out
    strong = summary.assign(demand_factor=summary["demand_factor"] / 100.0).isel(record=[2])
    assert row(smallest_capacities(Answers(strong)), "boundary wall")[1:] == [">5,", ">5", ">2.5,", ">2.5"]


def test_a_record_of_a_doubtful_peak_is_marked_wherever_a_verdict_rests_on_it(summary):
    assert "peak?" not in verdict_table(summary) + overturned(Answers(summary))
    summary["pga"][0] = 981.0
    summary["warning_codes"] = ("record", ["", "plain clipped", ""])
    summary["safety_factor"].loc[{"record": RECORDS[1], "block": "column", "model": "nonlinear"}] = 0.82
    text = verdict_table(summary)
    assert f"{RECORDS[0]} (peak?)  PGA 100 g" in text
    assert f"{RECORDS[1]} (clipped?)  PGA" in text
    assert "(peak?): a peak above 5 g or below 1e-6 g" in text
    assert "(clipped?): the record stays" in text
    assert "peak?" not in verdict_table(summary.sel(record=list(RECORDS[1:])))
    assert f"boundary wall: {RECORDS[0]} (peak?)\n" in overturned(Answers(summary))
    assert f"column: {RECORDS[1]} (clipped?) (0.82)" in overturned(Answers(summary))


def test_what_overturns_is_named_and_counted_and_what_a_weaker_copy_does(summary):
    text = overturned(Answers(summary))
    assert f"boundary wall: {RECORDS[0]}\n" in text
    assert "column: none" in text
    counts = next(line for line in text.splitlines() if line.startswith("  boundary wall  "))
    assert counts.split()[2:] == ["2", "of", "3", "2", "of", "3", "1", "of", "3"]
    assert "weaker copy" not in overturned(Answers(summary))
    summary["safety_factor"].loc[{"record": RECORDS[1], "block": "column", "model": "nonlinear"}] = 0.82
    text = overturned(Answers(summary))
    assert "column: none as recorded, but see below" in text
    assert text.endswith(
        f"Records that overturn the body only if scaled down (SF in brackets):\n  column: {RECORDS[1]} (0.82)"
    )


def test_the_record_that_governs_is_told_in_words_once(summary):
    known = summary.assign(magnitude=("record", [7.1, 7.1, np.nan]))
    text = governing(Answers(known))
    assert text.splitlines()[0] == "Governing records (the one that overturns, nonlinear model):"
    assert text.count("Ridgecrest 2019-07-06 M 7.1, station CCC") == 1
    assert f"  {RECORDS[0]}: Ridgecrest 2019-07-06 M 7.1, station CCC, E-W (for boundary wall, cabinet)" in text
    tree = results_tree()
    tree["summary"] = xr.DataTree(known)
    assert text in overview(tree, whole=True)
    words = ("event", "station", "component", "start_time")
    nothing = summary.assign({name: ("record", [""] * 3) for name in words} | {"azimuth": ("record", [np.nan] * 3)})
    assert governing(Answers(nothing)) == ""


def test_a_body_without_a_demand_has_counts_and_how_to_state_one(summary):
    text = " ".join(body_verdicts(Answers(summary)).split())
    assert text.startswith("Each body, 3 records of 2 earthquakes, as recorded (nonlinear model):")
    assert "verdict " not in text.split("No verdict")[0]
    assert 'To state a demand: --demand pga=0.35g, [site] pga = "0.35 g" or ag and ground, or [[demand]].' in text
