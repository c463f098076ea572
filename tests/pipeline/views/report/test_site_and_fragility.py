"""Files that do not belong together: a curve of another body is never shown, other ground motions are named."""

import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from nominal import ida
from site_spectra import BLOCKS, usual_site
from site_spectra import site_of as spectrum_site

import rockpulse as rp
from rockpulse import ConditioningSettings, ModelSettings, SearchSettings, UncertaintySettings
from rockpulse.errors import Failure, ResultsError
from rockpulse.models import Block
from rockpulse.storage.variables import failure_table
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.studies.site.calibration import design_of
from rockpulse.views.report.content import page_content
from rockpulse.views.report.site_and_fragility import MatchedFile, describe_fragility, matched_file
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared.formatting import shortened
from rockpulse.views.shared.table import table_text
from rockpulse.views.text.fragility import BEYOND, fragility_overview, median_table, sufficiency_tables
from rockpulse.views.text.site import site_overview, site_tables
from rockpulse.warning_text import WarningText, as_stored

CURVES = rp.Config(
    models=ModelSettings(use=("nonlinear",)),
    search=SearchSettings(models=(), points=16),
    uncertainty=UncertaintySettings(probability=False),
    fragility=ida(limit_states=("uplift",), measures=("pga",)),
)


def changed(tree, group, **values):
    """A copy with other values of some variables."""
    found = tree.copy()
    part = found[group].to_dataset().copy(deep=True)
    for name, factor in values.items():
        part[name].values[0] = part[name].values[0] * factor
    found[group] = type(tree)(part)
    return found


def curves_of(results, fragility):
    """What the section on fragility says."""
    return page_content(results, fragility=matched_file(results, fragility, "fragility", "it")).fragility


def site_of(results, site):
    """What the section on the site says."""
    return page_content(results, matched_file(results, site, SITE_KIND, "it")).site


@pytest.mark.parametrize("number", ["p", "alpha_c", "restitution"])
def test_a_curve_of_another_body_of_the_same_name_is_refused(results, fragility, number):
    other = changed(fragility, "fragility", **{number: 1.00001})
    told = r'another body of the name "stele": p .*; in the results it has p '
    with pytest.raises(ResultsError, match=told) as caught:
        report_page(results, fragility=other)
    summary = results["summary"].sel(block="stele")
    for tree in (summary, other["fragility"].sel(block="stele")):
        assert f"{float(tree[number]):.7g}" in str(caught.value)
    assert "run 'rockpulse fragility' again" in str(caught.value)
    assert (
        matched_file(results, changed(fragility, "fragility", **{number: 1.0 + 1e-9}), "fragility", "it").missing == ()
    )


@pytest.mark.sweep
def test_a_site_of_another_body_is_refused_and_a_file_is_named(results, site, tmp_path, fragility):
    with pytest.raises(ResultsError, match=r'this site file has another body of the name "stele"'):
        report_page(results, changed(site, "site", alpha_c=1.01))
    path = tmp_path / "curves.h5"
    rp.save(changed(fragility, "fragility", p=2.0), path)
    with pytest.raises(ResultsError, match=r"curves\.h5: this fragility file has another body"):
        report_page(results, fragility=path)


@pytest.mark.sweep
def test_bodies_of_one_file_only_are_named_and_their_curves_left_out(results, bursts, bodies):
    stele, other = bodies["stele"], Block(0.6, 4.0)
    found = curves_of(results, rp.fragility(bursts, CURVES, {"stele": stele, "other": other}))
    assert "The curves of other are left out, because these bodies are not assessed here." in found.warnings
    assert any("No curves are shown for pier" in words for words in found.warnings)
    assert found.blocks == ("stele",)
    assert {row[0].text for row in found.tables[0].rows} == {"stele"}
    with pytest.raises(ResultsError, match=r"none of its bodies \(other\) is a body of the results \(stele"):
        report_page(results, fragility=rp.fragility(bursts, CURVES, {"other": other}))


def test_restitutions_are_matched_by_their_numbers(bursts):
    """A body of one restitution keeps its name beside one of two."""
    two = {"wall": Block(0.25, 2.2, restitution=np.array([0.8, 0.9])), "column": Block(1.0, 7.0, restitution=0.97)}
    curves = rp.fragility(bursts, CURVES, two)
    found = matched_file(rp.assess(bursts[:1], CURVES, two), curves, "fragility", "it")
    assert found.tree["fragility"]["block"].values.tolist() == ["wall C 0.8", "wall C 0.9", "column"]
    one = rp.assess(bursts[:1], CURVES, {"wall": Block(0.25, 2.2, restitution=0.9)})
    found = matched_file(one, curves, "fragility", "it")
    assert found.tree["capacities"]["block"].values.tolist() == ["wall C 0.9"]
    assert found.foreign == ("wall C 0.8", "column")
    other = changed(one, "summary", alpha_c=1.04)
    with pytest.raises(ResultsError, match="another body of the name"):
        matched_file(other, curves, "fragility", "it")


@pytest.mark.sweep
def test_curves_of_other_ground_motions_say_so(results, bursts, bodies, fragility):
    words = "The curves are for other ground motions than the verdict"
    assert curves_of(results, fragility).warnings == ()
    part = rp.assess(bursts[:1], CURVES, bodies)
    assert curves_of(part, rp.fragility(bursts[1:], CURVES, bodies)).warnings[0].startswith(words)
    assert matched_file(results, fragility, "fragility", "it").same == 4
    stronger = changed(results, "summary", pga=1.1)
    found = matched_file(stronger, fragility, "fragility", "it")
    assert (found.same, found.changed) == (3, ("burst0",))
    told = "Records of the same name with a different PGA: burst0."
    assert found.other_motions("fragility", 4) == [told]


@pytest.mark.slow
def test_records_that_are_compared_by_name_only_say_so(results, bursts, bodies, fragility):
    by_name = "Their records were compared by name only: PGA is not among the measures of the file."
    without = replace(CURVES, fragility=ida(limit_states=("uplift",), measures=("pgv",)))
    assert by_name in curves_of(results, rp.fragility(bursts, without, bodies)).warnings
    assert by_name not in curves_of(results, fragility).warnings


@pytest.mark.sweep
def test_other_settings_another_gravity_and_another_equation_are_reported(results, bursts, bodies, fragility):
    fragility = rp.fragility(bursts, replace(CURVES, conditioning=ConditioningSettings(order=4)), bodies)
    assert curves_of(results, fragility).warnings == (
        "The motions were processed with other settings: [conditioning] order = 4, here 2.",
    )
    here, there = results.copy(), fragility.copy()
    here.attrs["configuration"], there.attrs["configuration"] = (
        f'[[block]]\nname = "stele"\ngravity = {gravity}' for gravity in (9.80665, 9.81)
    )
    assert matched_file(here, there, "fragility", "it").settings == ("[[block]] gravity = 9.81, here 9.80665",)
    linear = replace(CURVES, fragility=replace(CURVES.fragility, equation="linear"))
    assert curves_of(results, rp.fragility(bursts, linear, bodies)).warnings == (
        "The curves are computed with the linear equation of motion, the verdict with the nonlinear model.",
    )


@pytest.mark.sweep
def test_a_site_by_the_spectrum_is_shown_beside_its_design_and_another_is_refused():
    bodies = {name: BLOCKS[name] for name in ("wall", "pier")}
    assessed = rp.assess_sequence(design_of(usual_site()), bodies=bodies)
    part = site_of(assessed, usual_site())
    assert any("quantile of the overturning spectra of 10 records of 10 earthquakes" in one for one in part.statements)
    assert "The verdict in this report is based on the design sequence of this calibration." in part.statements
    assert [table.key for table in part.tables] == ["site-design", "site-sequence", "site-records"]
    warnings = page_content(assessed, matched_file(assessed, usual_site(), SITE_KIND, "it")).warnings
    assert not [one for one in warnings if one.head.startswith("records of the site")]  # none overturns the pier
    with pytest.raises(ResultsError, match="is not from this file: the scale factor of wall is "):
        site_of(rp.assess_sequence(design_of(spectrum_site(np.linspace(0.6, 1.5, 10))), bodies=bodies), usual_site())


@pytest.fixture
def curves(fragility):
    """A copy of the node /fragility, to be changed."""
    return fragility["fragility"].to_dataset().copy(deep=True)


def with_curves(fragility, curves):
    tree = fragility.copy()
    tree["fragility"] = type(tree)(curves)
    return tree


def cells(table):
    return table.key, table.headings, [[cell.marked for cell in row] for row in table.rows]


@pytest.mark.sweep
def test_the_page_and_the_terminal_show_the_same_tables(results, site, fragility):
    """Headings with small print are explained in a note on the terminal."""
    beside = site_of(results, site), curves_of(results, fragility)
    shown = (
        (site_overview(site), site_tables(site["site"].to_dataset())),
        (fragility_overview(fragility), [median_table(fragility)]),
    )
    for part, (told, tables) in zip(beside, shown, strict=True):
        for table, own in zip(tables, part.tables, strict=False):
            assert cells(own) == cells(table)
            for row in table.rows:
                for cell, heading in zip(row, table.headings, strict=True):
                    words = shortened(cell.text, heading.width or 100)
                    assert (words.upper() if cell.grade == "bad" else words) in told
            for title in (heading.title for heading in table.headings if heading.note):
                assert re.search(rf"{re.escape(title)}[^.:]*: ", " ".join(told.split()))


def test_a_median_beyond_every_level_is_marked_and_explained_only_where_there_is_one(fragility, curves):
    curves["extrapolated"][:] = 0
    assert BEYOND.note not in table_text(median_table(with_curves(fragility, curves)))
    curves["extrapolated"][:] = 1
    curves["median"][:] = 0.5
    curves["median"].loc[{"limit_state": "overturning"}] = np.nan
    table = median_table(with_curves(fragility, curves))
    by_state = {row[1].text: row[2].marked for row in table.rows}
    assert by_state.pop("overturning") == "-"  # nothing is extrapolated where there is no median
    assert set(by_state.values()) == {"0.50!"}
    assert table.notes[-1] == BEYOND.note


def test_a_band_is_shown_with_both_ends_and_a_rotation_is_named_in_both_tables(fragility, curves):
    curves["median_low"][:], curves["median_high"][:] = 0.3, np.inf
    table = median_table(with_curves(fragility, curves))
    assert {(row[3].text, row[4].text) for row in table.rows} == {("0.30", "no limit")}
    assert [(one.title, one.note) for one in table.headings[3:5]] == [("low", "90 %"), ("high", "90 %")]
    curves = curves.assign_coords(limit_state=["0.4", "overturning"])
    curves["statement_values"][:] = as_stored([WarningText("no_maximum")])
    of = MatchedFile(with_curves(fragility, curves), (), (), 0, 0, (), ())
    medians, said, depends = describe_fragility(of, 0, "nonlinear").tables
    assert {row[1].text for row in medians.rows} == {"θ_max/α_c ≥ 0.4", "overturning"}
    assert {row[1].text for row in said.rows} == {"θ_max/α_c ≥ 0.4, overturning"}
    assert depends == sufficiency_tables(fragility["efficiency"].to_dataset())[0]


def test_the_files_that_curves_do_not_rest_on_are_said_before_them(fragility, curves):
    tree = with_curves(fragility, curves)
    tree["failures"] = xr.DataTree(failure_table([Failure("a.asc", "read", "a.asc: no reader", "failed")]))
    files = tree["capacities"].sizes["record"]
    first, *_ = describe_fragility(MatchedFile(tree, (), (), 0, 0, (), ()), 0, "nonlinear").warnings
    assert first == f"{files} of {files + 1} files used (1 rejected): no reader (a.asc)."
