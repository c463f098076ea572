"""The sections on the site and on fragility: the tables of the terminal, with their marks and notes."""

import html

import numpy as np
import pytest
import xarray as xr
from report_cases import WORDS

from rockpulse.failures import Failure
from rockpulse.storage.variables import failure_table
from rockpulse.views.report.beside import Paired, describe_fragility
from rockpulse.views.report.writing import typeset
from rockpulse.views.shared.table import text
from rockpulse.views.shared.terminal import shortened
from rockpulse.views.text.fragility import BEYOND, fragility_overview, median_table, sufficiency_tables
from rockpulse.views.text.site import block_table, parameter_table, site_overview


@pytest.fixture
def curves(fragility):
    """A copy of the node /fragility, to be changed."""
    return fragility["fragility"].to_dataset().copy(deep=True)


def with_curves(fragility, curves):
    tree = fragility.copy()
    tree["fragility"] = type(tree)(curves)
    return tree


def test_the_page_and_the_terminal_show_the_same_cells(whole_page, site, fragility):
    page = html.unescape(whole_page)
    of_site = site["site"].to_dataset()
    tables = {
        site_overview(site): (parameter_table(of_site), block_table(of_site)),
        fragility_overview(fragility): (median_table(fragility),),
    }
    for shown, of_file in tables.items():
        for table in of_file:
            assert f'<table id="{table.key}">' in page
            for row in table.rows:
                for cell, heading in zip(row, table.headings, strict=True):
                    assert f">{cell.marked}<" in page
                    told = shortened(cell.text, heading.width or 100)
                    assert (told.upper() if cell.grade == "bad" else told) in shown


def test_a_median_beyond_every_level_is_marked_and_explained_only_where_there_is_one(fragility, curves):
    curves["extrapolated"][:] = 0
    assert BEYOND.note not in text(median_table(with_curves(fragility, curves)))
    curves["extrapolated"][:] = 1
    curves["median"][:] = 0.5
    curves["median"].loc[{"limit_state": "overturning"}] = np.nan
    table = median_table(with_curves(fragility, curves))
    by_state = {row[1].text: row[2].marked for row in table.rows}
    assert by_state.pop("overturning") == "-"  # nothing is extrapolated where there is no median
    assert set(by_state.values()) == {"0.50!"}
    assert table.notes[-1] == BEYOND.note


def test_a_band_is_shown_with_both_ends(fragility, curves):
    curves["median_low"][:], curves["median_high"][:] = 0.3, np.inf
    table = median_table(with_curves(fragility, curves))
    assert {(row[3].text, row[4].text) for row in table.rows} == {("0.30", "no limit")}
    assert [(one.title, one.note) for one in table.headings[3:5]] == [("low", "90 %"), ("high", "90 %")]


def test_a_limit_state_of_rotation_is_named_in_both_tables(fragility, curves):
    curves = curves.assign_coords(limit_state=["0.4", "overturning"])
    curves["statement"][:] = "why"
    of = Paired(with_curves(fragility, curves), (), (), 0, 0, (), ())
    medians, said, depends = describe_fragility(WORDS, of, 0, "nonlinear").tables
    assert {row[1].text for row in medians.rows} == {"θ_max/α_c ≥ 0.4", "overturning"}
    assert {row[1].text for row in said.rows} == {"θ_max/α_c ≥ 0.4, overturning"}
    assert depends == sufficiency_tables(fragility["efficiency"].to_dataset())[0]


def test_small_print_of_the_headings_is_a_note_on_the_terminal(site, fragility, whole_page):
    page, of_site = html.unescape(whole_page), site["site"].to_dataset()
    tables = {
        site_overview(site): (parameter_table(of_site), block_table(of_site)),
        fragility_overview(fragility): (median_table(fragility),),
    }
    for shown, of_file in tables.items():
        told = " ".join(shown.split())
        for heading in (one for table in of_file for one in table.headings if one.note):
            assert f"<small>{typeset(heading.note)}</small>" in page
            assert f": {heading.note}." in told
    assert "dispersion, low, high: of the logarithm." in " ".join(site_overview(site).split())


def test_the_files_that_curves_do_not_rest_on_are_said_before_them(fragility, curves):
    tree = with_curves(fragility, curves)
    tree["failures"] = xr.DataTree(failure_table([Failure("a.asc", "read", "a.asc: no reader", "failed")]))
    files = tree["capacities"].sizes["record"]
    first, *_ = describe_fragility(WORDS, Paired(tree, (), (), 0, 0, (), ()), 0, "nonlinear").remarks
    assert first == f"{files} of {files + 1} files used, 1 not: no reader (a.asc)."
