"""What changed between two results files, on trees whose answers are known."""

import shutil

import h5py
import numpy as np
import pytest
import xarray as xr
from compared_trees import compare
from results_tree import RECORDS, results_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.hdf5.results_file import open_results_file, save
from rockpulse.storage.variables import FAILURE
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS, HALF_CYCLE, WAVES
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.views.diff.difference_overview import difference_overview
from rockpulse.views.diff.differences import OUTCOME, SAFETY, compare_results
from rockpulse.views.diff.row_matching import OnlyIn

#: (record, block, model) that the rows of /half_cycles point at.
POINTS = [(0, 0, 1), (0, 1, 1), (0, 1, 1), (1, 0, 2), (2, 2, 1)]


def tree(cases=None):
    """With half-cycles and half-waves."""
    made = results_tree(cases)
    index = dict(zip(("record_index", "block_index", "model_index"), np.transpose(POINTS), strict=True))
    values = {name: index.get(name, np.arange(5.0) + 1) for name in HALF_CYCLE} | {"case_index": [0] * 5}
    made["half_cycles"] = xr.DataTree(
        xr.Dataset({name: one.variable(values[name]) for name, one in HALF_CYCLE.items()})
    )
    sizes = ASSESSMENT_GROUPS["/records"]["half_wave_row_size"].variable([2, 1, 3])
    sizes.attrs["sample_dimension"] = "wave"
    waves = {f"half_wave_{name}": one.variable(np.arange(6.0) + 1) for name, one in WAVES.items()}
    record = made["summary"]["record"].variable
    made["records"] = xr.DataTree(xr.Dataset({"half_wave_row_size": sizes, **waves}, {"record": record}))
    return made


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """The tree in a file."""
    path = tmp_path_factory.mktemp("saved") / "results.h5"
    save(tree(), path)
    return path


@pytest.fixture
def compare_files(tmp_path):
    """The same of two files."""

    def compared(first, second, **options):
        save(first, tmp_path / "a.h5", overwrite=True)
        save(second, tmp_path / "b.h5", overwrite=True)
        with open_results_file(tmp_path / "a.h5") as one, open_results_file(tmp_path / "b.h5") as other:
            found = compare_results(one, other, **options)
            return found, difference_overview(found, one, other, "rtol 1e-09")

    return compared


def reordered(made, order):
    """The results of these records in another order, with everything that points at them."""
    half, records = made["half_cycles"].to_dataset(), made["records"].to_dataset()
    pointed, owner = half["record_index"].values, np.repeat(np.arange(3), records["half_wave_row_size"].values)
    rows, waves = (np.concatenate([np.flatnonzero(of == k) for k in order]) for of in (pointed, owner))
    half = half.isel(row=rows)
    place = [order.index(k) for k in pointed[rows]]
    made["summary"] = xr.DataTree(made["summary"].to_dataset().isel(record=order))
    made["half_cycles"] = xr.DataTree(half.assign(record_index=("row", place, half["record_index"].attrs)))
    made["records"] = xr.DataTree(records.isel(record=order, wave=waves))
    return made


@pytest.mark.parametrize("cases", [None, 2])
def test_the_same_results_are_the_same(cases):
    found, text = compare(tree(cases), tree(cases))
    assert found.same
    assert found.sides[OUTCOME].compared == 27 * (cases or 1)
    assert text.endswith(f"The results are the same: {found.compared} values within rtol 1e-09.")
    assert "None of" in text
    assert "Bodies whose" not in text
    assert "crossed 1" not in text


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("group", "name", "place", "value", "told"),
    [
        ("summary", "pga", (1,), 4.6191, RECORDS[1]),
        ("summary", "source", (2,), "new.txt", "weak.1"),
        ("summary", "safety_factor", (0, 1, 1), 1.70001, f"{RECORDS[0]}, column, sequence"),
        ("summary", "safety_factor", (0, 0, 0), np.inf, f"{RECORDS[0]}, boundary wall, resonance"),
        ("summary", "safety_factor", (0, 0, 2), 3.0, f"{RECORDS[0]}, boundary wall, nonlinear"),
        ("half_cycles", "peak", (2,), 9.0, f"{RECORDS[0]}, column, sequence, row 2"),
        ("records", "half_wave_start", (3,), 4.1, "weak.1, wave 0"),
    ],
)
def test_a_changed_value_is_found_and_its_place_is_named(group, name, place, value, told):
    changed = tree()
    changed[group][name].values[place] = value
    found, _ = compare(tree(), reordered(changed, [2, 0, 1]))
    (one,) = found.variables
    assert (one.name, one.differing, ", ".join(one.place)) == (f"/{group}/{name}", 1, told)
    assert not found.same
    number = not isinstance(value, str)
    assert one.after == (f"{value:.9g}" if number else value)
    assert np.isnan(one.largest) != number


@pytest.mark.sweep
def test_tolerances_are_relative_to_the_larger_plus_absolute_and_an_infinity_is_beyond_them():
    changed = tree()
    changed["summary"]["pga"].values[0] *= 1.0 + 1e-6
    found, _ = compare(tree(), changed)
    assert found.variables[0].largest == pytest.approx(1e-6, rel=1e-3)
    assert compare(tree(), changed, rtol=1.01e-6)[0].same
    assert not compare(tree(), changed, rtol=0.99e-6)[0].same
    assert compare(tree(), changed, rtol=0.0, atol=6e-6)[0].same
    assert not compare(tree(), changed, rtol=0.0, atol=5e-6)[0].same
    assert compare(tree(), changed, ignore=["pga"])[0].same
    changed = tree()
    changed["summary"]["safety_factor"].values[0, 0, 0] = np.inf
    found, _ = compare(tree(), changed, rtol=1e9, atol=1e9)
    assert found.variables[0].largest == np.inf


@pytest.mark.sweep
def test_verdicts_that_flipped_are_named():
    changed = tree()
    changed["summary"]["outcome"].values[0, 1, 1:] = 2, 3
    found, text = compare(tree(), changed)
    flips = found.sides[OUTCOME]
    assert (flips.count, flips.compared) == (2, 27)
    assert [(flip.place, flip.before, flip.after) for flip in flips.named] == [
        ((RECORDS[0], "column", "nonlinear"), "rocks", "unresolved"),  # the fullest model first
        ((RECORDS[0], "column", "sequence"), "rocks", "overturns"),
    ]
    assert "\nVerdicts that changed: 2 of 27 (1 of 9 by the nonlinear model)" in text
    found, text = compare(tree(), changed, listed=1)
    assert (found.sides[OUTCOME].count, found.sides[OUTCOME].named) == (2, flips.named[:1])
    assert "and 1 more (--limit)" in text
    changed = tree()
    changed["summary"]["safety_factor"].values[0, 0, 1] = 0.6
    (line,) = [line for line in compare(tree(), changed)[1].splitlines() if "/summary/safety_factor" in line]
    for told in ("CI.CCC..HNE@…", "953, ", "boundary wall, sequence"):
        assert told in line


@pytest.mark.sweep
def test_safety_factors_that_crossed_one_are_a_group_above_all_other_differences():
    changed = tree()
    factors = changed["summary"]["safety_factor"].values
    factors[0, 1, 1], factors[1, 0, 1], factors[0, 2, 1] = 0.98, np.inf, 1.6  # of 1.7, 0.5 and 1.7
    found, text = compare(tree(), changed)
    one, other = found.sides[SAFETY].named
    assert one == ((RECORDS[0], "column", "sequence"), "1.7", "0.98")
    assert other == ((RECORDS[1], "boundary wall", "sequence"), "0.5", "inf")
    assert text.index("Smallest scale factors (SF) that crossed 1") < text.index("Variables beyond")


def test_without_the_nonlinear_model_in_both_the_last_common_model_leads():
    changed = tree()
    changed["summary"] = xr.DataTree(changed["summary"].to_dataset().isel(model=[0, 1]))
    changed["half_cycles"] = xr.DataTree(changed["half_cycles"].to_dataset().isel(row=[0, 1, 2, 4]))
    changed["summary"]["outcome"].values[2, 0] = 1, 2
    found, text = compare(tree(), changed)
    assert found.model == "sequence"
    assert "Verdicts that changed: 2 of 18 (1 of 9 by the sequence model)" in text
    assert [flip.place[2] for flip in found.sides[OUTCOME].named] == ["sequence", "resonance"]


@pytest.mark.sweep
@pytest.mark.parametrize("gone", [0, 2])
def test_what_only_one_file_has_is_named_and_the_rest_compared(gone):
    found, text = compare(tree(), reordered(tree(), [k for k in range(3) if k != gone]))
    assert found.only == [OnlyIn("records", (RECORDS[gone],), ())]
    assert found.variables == []
    assert found.others == []
    assert found.sides[OUTCOME].compared == 18
    assert f"records only in the first file: 1\n  - {RECORDS[gone]}" in text
    assert not found.same


def test_blocks_variables_groups_and_failures_of_one_file():
    other = tree()
    summary = other["summary"].to_dataset().isel(block=[0, 1]).drop_vars("pgv_drift")
    other["summary"] = xr.DataTree(summary)
    other["failures"] = xr.DataTree(other["failures"].to_dataset().isel(failure=[0, 1]))
    del other["records"]
    found, text = compare(other, tree())
    assert {one.what for one in found.only} == {"groups", "variables of /summary", "blocks", "failures"}
    assert "blocks only in the second file: 1\n  + cabinet" in text


def test_another_number_of_rows_is_told_and_the_rest_compared():
    other = tree()
    other["half_cycles"] = xr.DataTree(other["half_cycles"].to_dataset().isel(row=[0, 1, 3, 4]))
    records = other["records"].to_dataset().isel(wave=[0, 1, 2, 3, 4])
    records["half_wave_row_size"].values[2] = 2
    records["half_wave_peak"].values[0] = 7.0
    other["records"] = xr.DataTree(records)
    found, _ = compare(tree(), other)
    assert len(found.others) == 2
    assert "/half_cycles: 1 combinations of record, block and model differ in the number of rows" in found.others[0]
    assert "/records: 1 of 3 differ in size along wave" in found.others[1]
    assert [one.name for one in found.variables] == ["/records/half_wave_peak"]


@pytest.mark.sweep
def test_units_and_attributes_that_differ_are_told_and_versions_do_not_count():
    other = tree()
    other["summary"]["pga"].attrs["units"] = "g"
    other["summary"]["outcome"].attrs["flag_meanings"] = "at_rest rocks falls unresolved"
    other.attrs["data"] = "ida"
    other["summary"].attrs["method"] = "statistics"
    found, _ = compare(tree(), other)
    assert found.others == [
        "attribute data: absent in the first, ida in the second",
        "attribute method of /summary: absent in the first, statistics in the second",
        "/summary/pga: units 'm s^-2', then 'g'",
        "/summary/outcome: flag_meanings 'at_rest rocks overturns unresolved', then 'at_rest rocks falls unresolved'",
    ]
    found, _ = compare(tree(), tree(2))
    told = "/summary/outcome: record x block x model int8, then record x block x"
    assert any(line.startswith(told) for line in found.others)
    other = tree()
    block = '[[block]]\nname = "wall"\nwidth = 0.4\n'
    other.attrs.update(numpy_version="1.0", configuration=f'[site]\nname = "Borgo"\n[run]\nworkers = 2\n{block}')
    found, text = compare(tree(), other)
    assert found.same
    assert [name for name, *_ in found.about] == ["numpy_version"]
    assert found.configuration == ["+[run] workers = 2", '+[[block]] "wall" width = 0.4']
    assert '  + [[block]] "wall" width = 0.4' in text


@pytest.mark.slow
def test_values_that_another_program_has_changed_are_found_though_the_checksums_are_equal(saved, tmp_path):
    places = {"summary/pga": 0, "summary/outcome": (0, 0, 0), "half_cycles/peak": 3, "summary/source": 1}
    shutil.copy(saved, tmp_path / "b.h5")
    with h5py.File(tmp_path / "b.h5", "a") as file:
        for path, place in places.items():
            file[path][place] = "other" if "source" in path else 0
    with open_results_file(saved) as one, open_results_file(tmp_path / "b.h5") as other:
        found = compare_results(one, other)
    assert {one.name: one.differing for one in found.variables} == {f"/{path}": 1 for path in places}
    assert found.sides[OUTCOME].compared == 27
    shutil.copy(saved, tmp_path / "b.h5")
    with h5py.File(tmp_path / "b.h5", "a") as file:
        file["half_cycles/record_index"][0] = 2
    with open_results_file(saved) as one, open_results_file(tmp_path / "b.h5") as other:
        assert not compare_results(one, other).same


@pytest.mark.sweep
def test_what_is_ignored_is_named_as_it_is_or_as_it_is_printed():
    changed = tree()
    changed["summary"]["pga"].values[0] *= 1.1
    changed["summary"] = xr.DataTree(changed["summary"].to_dataset().drop_vars("pgv_drift"))
    for spelling in ("pga", "/summary/pga"):
        found, _ = compare(tree(), changed, ignore=[spelling, "pgv_drift"])
        assert found.same
    assert not compare(tree(), changed, ignore=["/half_cycles/peak", "pgv_drift"])[0].same
    with pytest.raises(ResultsError, match=r"no variable 'pgaa' in these results; .*pga"):
        compare(tree(), changed, ignore=["pgaa"])


@pytest.mark.sweep
def test_parts_are_compared_as_the_whole(monkeypatch):
    from rockpulse.views.diff import differences

    changed = tree()
    changed["summary"]["safety_factor"].values[2, 1, 0] = 1.0
    changed["summary"]["safety_factor"].values[0, 0, 0] = 0.6
    whole = compare(tree(), changed)[0].variables
    monkeypatch.setattr(differences, "PART", 9)
    assert compare(tree(), changed)[0].variables == whole


def test_files_of_different_kinds_are_refused(saved, tmp_path):
    other = xr.DataTree.from_dict({"/site": xr.Dataset()})
    other.attrs["kind"] = "site calibration"
    save(other, tmp_path / "b.h5")
    told = r"two files of one kind, found .*results\.h5 \(assessment\) and .*b\.h5 \(site"
    with (
        open_results_file(saved) as one,
        open_results_file(tmp_path / "b.h5") as two,
        pytest.raises(ResultsError, match=told),
    ):
        compare_results(one, two)


@pytest.mark.sweep
def test_failures_are_counted_whatever_the_rows_of_their_group_are_called(compare_files):
    failures = {name: variable.variable(["one", "two", "three"], ("row",)) for name, variable in FAILURE.items()}
    empty = {name: variable.variable([], ("row",)) for name, variable in FAILURE.items()}
    made = xr.DataTree.from_dict({"/site": xr.Dataset(), "/failures": xr.Dataset(failures)})
    none = xr.DataTree.from_dict({"/site": xr.Dataset(), "/failures": xr.Dataset(empty)})
    made.attrs["kind"] = none.attrs["kind"] = SITE_KIND
    same, text = compare_files(made, made)
    assert (same.same, same.compared) == (True, 3)
    assert "The results are the same: 3 values" in text
    assert compare_files(none, none)[0].same
    (one,) = compare_files(made, none)[0].only
    assert (one.what, len(one.first), one.second) == ("failures", 3, ())
