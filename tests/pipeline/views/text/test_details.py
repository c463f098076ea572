"""One record, one block as text."""

import numpy as np
import pytest
from results_tree import RECORDS, demanding, results_tree

from rockpulse.errors import ResultsError
from rockpulse.views.text.overview import block_details, record_details


@pytest.fixture
def summary():
    return results_tree()["summary"].to_dataset()


def entries(text):
    """First part of a page as (name, value) pairs."""
    lines = text.split("\n\n")[0].splitlines()[1:]
    return [tuple(part.strip() for part in line.strip().split("  ", 1)) for line in lines]


def test_a_record_shows_its_measures_its_sequence_and_every_warning(summary):
    shown = dict(entries(record_details(summary, RECORDS[0])))
    assert shown.items() >= {
        ("PGA", "5.56 m/s2 (0.567 g)"),
        ("PGV", "0.71 m/s"),
        ("Arias intensity", "5.2 m/s"),
        ("intense phase", "10 s to 22 s"),
        ("main impulse I", "0.62 m/s"),
        ("secondary impulse I_s", "0.11 m/s"),
        ("interval dT", "0.12 s"),
        ("main impulses", "5"),
        ("samples", "35430 at 0.01 s"),
        ("processing", "baseline: mean"),
    }
    warnings = [words for name, words in entries(record_details(summary, RECORDS[0])) if name == "warning"]
    assert warnings == ["mean removed", "direction unknown; check it"]


def test_what_a_record_lacks_or_has_without_a_limit_is_told_in_words(summary):
    assert "as many as fit" in record_details(summary, RECORDS[1])
    assert "-1" not in record_details(summary, RECORDS[1])
    text = record_details(summary, RECORDS[2])
    assert "nan" not in text.replace("resonance", "")
    assert {("secondary impulse I_s", "-"), ("main impulses", "-")} <= set(entries(text))


def test_capacities_over_the_demands_are_shown_for_the_record_and_for_the_block(summary):
    assert "Capacity" not in record_details(summary, RECORDS[0])
    cube = summary["safety_factor"].dims
    ratio = np.full((*summary["safety_factor"].shape, 1), np.inf)
    ratio[0, 0, 2], ratio[0, 1, 2] = 0.84, np.nan
    summary = demanding(summary, {"collapse": 2.94}, capacity_ratio=((*cube, "demand"), ratio))
    head = "Capacity (scale factor that overturns x strength, nonlinear model) over demand"
    of_record = record_details(summary, RECORDS[0]).partition(head)[2]
    assert "collapse (PGA 2.94 m/s2)" in of_record
    rows = [line.split() for line in of_record.splitlines()[2:5]]
    assert [cells[-1] for cells in rows] == ["0.84", "-", "none"]
    of_block = block_details(summary, "boundary wall").partition(head)[2]
    assert [line.split()[0] for line in of_block.splitlines()[2:5]] == list(RECORDS)


def test_a_block_and_a_record_show_their_own_verdicts_only(summary):
    text = block_details(summary, "boundary wall")
    shown = dict(entries(text))
    assert shown["width, height"] == "0.25 m, 2.2 m"
    assert shown["half the diagonal R"] == "1.11 m"
    assert shown["critical angle alpha_c"] == "0.113 rad"
    assert shown["frequency parameter p"] == "2.58 1/s"
    assert shown["slenderness"] == "8.8"
    assert shown["restitution C"] == "0.985"
    assert shown["critical impulse I_1c"] == "0.43 m/s"
    assert "column" not in text.split()  # the name of the other body
    assert all(record in text for record in RECORDS)
    text = record_details(summary, RECORDS[0])
    assert text.count("boundary wall") == 2
    assert RECORDS[1] not in text
    assert "smallest scale factor" in text


def test_a_block_lists_its_restitutions_and_warnings():
    text = block_details(results_tree(2)["summary"].to_dataset(), "cabinet")
    shown = dict(entries(text))
    assert shown["restitution C"] == "0.790, 0.690"
    assert shown["width, height"] == "-, -"
    assert shown["half the diagonal R"] == "1.2 m (of the rectangle with this p)"
    assert shown["warning"] == "slenderness 2.5 is below 3"


@pytest.mark.parametrize(
    ("radius", "shown"),
    [
        (0.75 * 9.81 / 2.6**2, "1.09 m (of the rectangle with this p)"),
        (0.96, "0.96 m (from the corner to the centre of mass)"),
    ],
)
def test_the_radius_of_a_body_that_is_no_rectangle_says_whose_it_is(radius, shown):
    summary = results_tree()["summary"].to_dataset()
    summary["radius"].values[2] = radius
    text = block_details(summary.assign(gravity=("block", [9.81] * 3)), "cabinet")
    assert dict(entries(text))["half the diagonal R"] == shown


@pytest.mark.parametrize(
    ("show", "wrong", "close"), [(record_details, "weak.2", "weak.1"), (block_details, "colum", "column")]
)
def test_an_unknown_name_is_answered_with_the_known_ones(summary, show, wrong, close):
    with pytest.raises(ResultsError, match=rf'no \w+ "{wrong}" in these results; did you mean "{close}"') as caught:
        show(summary, wrong)
    assert f"\n  {close}" in str(caught.value)


def test_what_the_file_states_of_the_earthquake_has_lines_and_what_it_does_not_state_has_none(summary):
    before = dict(entries(record_details(summary, RECORDS[0])))
    summary = summary.assign(magnitude=("record", [7.1, np.nan, np.nan]), vs30=("record", [np.nan] * 3))
    shown = dict(entries(record_details(summary, RECORDS[0])))
    assert shown["description"] == "Ridgecrest 2019-07-06 M 7.1, station CCC, E-W"
    assert shown["magnitude"] == "M 7.1"
    assert shown.keys() - before.keys() == {"magnitude"}
    assert "magnitude" not in dict(entries(record_details(summary, RECORDS[1])))
