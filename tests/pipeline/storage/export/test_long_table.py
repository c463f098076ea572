"""Groups of results as long tables and CSV files, on a tree whose answers are known."""

import gzip
from functools import cache

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from results_tree import BLOCKS, MODELS, RECORDS, demanding, results_tree, small_tree

import rockpulse as rp
from rockpulse.errors import ResultsError
from rockpulse.storage.export.long_table import long_table, results_table
from rockpulse.storage.export.row_selection import Condition, RowSelection
from rockpulse.storage.export.table_file import readme_of, write_table
from rockpulse.storage.hdf5.results_file import open_results_file, save
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS, HALF_CYCLE, WAVES
from rockpulse.storage.variables.summary import SUMMARY


@cache
def full_tree(cases=None):
    """With demands, half-cycles and half-waves."""
    tree = results_tree(cases)
    summary = tree["summary"].to_dataset()
    ratio = summary["safety_factor"].values[..., np.newaxis] * np.array([1.0, 0.4])
    ratio = SUMMARY["capacity_ratio"].variable(ratio, (*summary["safety_factor"].dims, "demand"))
    summary = demanding(summary, {"damage": 1.0, "collapse": 2.5}, capacity_ratio=ratio)
    tree["summary"] = xr.DataTree(summary)
    index = {"record_index": [0, 0, 2], "block_index": [1, 1, 0], "case_index": [0] * 3, "model_index": [1, 1, 2]}
    values = {name: index.get(name, np.arange(3.0) + 1) for name in HALF_CYCLE}
    tree["half_cycles"] = xr.DataTree(
        xr.Dataset({name: one.variable(values[name]) for name, one in HALF_CYCLE.items()})
    )
    sizes = ASSESSMENT_GROUPS["/records"]["half_wave_row_size"].variable([2, 0, 1])
    sizes.attrs["sample_dimension"] = "wave"
    waves = {f"half_wave_{name}": one.variable([0.1, -0.2, 0.3]) for name, one in WAVES.items()}
    tree["records"] = xr.DataTree(
        xr.Dataset({"half_wave_row_size": sizes, **waves}, {"record": summary["record"].variable})
    )
    return tree


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "results.h5"
    save(full_tree(), path)
    return path


@pytest.fixture(scope="module")
def opened(results):
    """The results, open for all tests."""
    with open_results_file(results) as file:
        yield file


@pytest.fixture(scope="module")
def table(results):
    """Of the whole summary."""
    return results_table(results)


def selected(opened, group=None, dims=None, columns=None, where=(), **names):
    """A table of the open results, as of results_table."""
    patterns = {dim: (pattern,) for dim, pattern in names.items()}
    selection = RowSelection(patterns, tuple(map(Condition.parse, where)))
    return long_table(opened, group, dims, selection, columns).frame()


def test_every_answer_is_a_row_and_every_variable_a_column(table):
    summary = full_tree()["summary"].to_dataset()
    assert len(table) == 27
    assert table.columns[:3].tolist() == ["record", "block", "model"]
    alone = {str(name) for name, one in summary.data_vars.items() if "demand" in one.dims}
    spread = {f"{name}[{demand}]" for name in alone for demand in ("damage", "collapse") if summary[name].ndim > 1}
    assert set(table.columns) == {"record", "block", "model"} | {*map(str, summary.data_vars)} - alone | spread
    frame = summary.drop_dims("demand").to_dataframe().reset_index()  # xarray's own way, in the same order
    for name in ("record", "block", "model", "pga", "warnings", "width", "uplift_ratio", "safety_factor"):
        pd.testing.assert_series_equal(table[name], frame[name], check_dtype=False, check_names=False)
    assert table["outcome"].tolist()[:4] == ["overturns"] * 4
    assert set(table["outcome"]) == {"overturns", "rocks", "at_rest", "unresolved"}
    collapse = summary["capacity_ratio"].sel(demand="collapse").values.ravel()
    assert np.array_equal(table["capacity_ratio[collapse]"], collapse, equal_nan=True)


@pytest.mark.sweep
def test_restitution_cases_have_a_column(tmp_path):
    save(full_tree(2), tmp_path / "results.h5")
    table = results_table(tmp_path / "results.h5", block="column", model="nonlinear")
    assert table["case"].tolist() == [0, 1] * 3
    assert table["restitution"].round(9).tolist() == [0.93, 0.83] * 3


@pytest.mark.sweep
def test_a_selection_takes_names_conditions_order_and_limit(results, opened):
    table = rp.results_table(results, block="c*", where=["outcome = overturns"], sort="pga", limit=2, columns=["pga"])
    assert table.to_dict("list") == {
        "record": [RECORDS[0]] * 2,
        "block": ["column", "cabinet"],
        "model": ["resonance"] * 2,
        "pga": [5.5574] * 2,
    }
    assert len(selected(opened, where=["pga > 1e9"])) == 0
    names, one, other = ["record", "block", "model"], "capacity_ratio[damage]", "capacity_ratio[collapse]"
    assert selected(opened, columns=["pga", other]).columns.tolist() == [*names, "pga", other]
    assert selected(opened, columns=["capacity_ratio"]).columns.tolist() == [*names, one, other]


@pytest.mark.parametrize(
    ("dims", "rows", "has", "lacks"),
    [(["record"], 3, "pga", "width"), (["block"], 3, "width", "pga"), (["demand"], 2, "demand_acceleration", "pga")],
)
def test_other_dimensions_make_other_tables(opened, dims, rows, has, lacks):
    table = selected(opened, dims=dims)
    assert len(table) == rows
    assert has in table
    assert lacks not in table


def test_an_index_becomes_the_name_that_it_points_at(opened):
    table = selected(opened, "half_cycles")
    assert table["record"].tolist() == [RECORDS[0], RECORDS[0], RECORDS[2]]
    assert table["block"].tolist() == [BLOCKS[1], BLOCKS[1], BLOCKS[0]]
    assert table["model"].tolist() == [MODELS[1], MODELS[1], MODELS[2]]
    assert selected(opened, "half_cycles", record="weak*")["peak"].tolist() == [3.0]
    assert len(selected(opened, "half_cycles", block="column", where=["peak < 2"])) == 1


def test_the_rows_of_a_ragged_array_say_whose_they_are(opened):
    table = selected(opened, "records", dims=["wave"])
    assert table["record"].tolist() == [RECORDS[0], RECORDS[0], RECORDS[2]]
    assert table["half_wave_impulse"].tolist() == [0.1, -0.2, 0.3]
    assert selected(opened, "/records", ["wave"], record="weak.1")["half_wave_peak"].tolist() == [0.3]


def test_a_group_of_several_tables_asks_which(opened):
    with pytest.raises(
        ResultsError, match=r"/records contains several tables: .*--rows.* the tables have record; wave"
    ):
        selected(opened, "records")


def test_unknown_groups_dimensions_and_columns_are_answered_with_the_known_ones(opened):
    with pytest.raises(ResultsError, match=r"no group 'half_cycle'; did you mean \"half_cycles\""):
        selected(opened, "half_cycle")
    with pytest.raises(ResultsError, match=r"/summary has no dimension 'recrd'; did you mean \"record\""):
        selected(opened, dims=["recrd"])
    with pytest.raises(ResultsError, match=r"no column 'pgx'; did you mean \"pg[av]\""):
        selected(opened, columns=["pgx"])


def written(opened, target, group=None, **options):
    table = long_table(opened, group, selection=options.pop("selection", None))
    return write_table(table, target, "From a test.", **options)


@pytest.mark.sweep
@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_the_csv_reads_back_the_same(opened, table, tmp_path, suffix):
    target, _ = written(opened, tmp_path / f"table{suffix}")
    texts = {name: str for name in table if table[name].dtype.kind == "O"}
    back = pd.read_csv(target, keep_default_na=False, na_values=[""], dtype=texts)
    assert back.columns.tolist() == table.columns.tolist()
    for name in table:
        if table[name].dtype.kind == "f":
            assert np.array_equal(back[name], table[name], equal_nan=True), name  # to the last digit
        else:
            told = [str(one).replace("\n", " | ") if isinstance(one, str) else one for one in table[name]]
            assert back[name].fillna("").tolist() == told, name
    opened = gzip.open if suffix.endswith("gz") else open
    with opened(target, "rt") as lines:
        assert sum(1 for _ in lines) == 28  # a row is a line, whatever the texts


@pytest.mark.sweep
def test_a_table_for_spreadsheets_with_decimal_commas(opened, table, tmp_path):
    target, readme = written(opened, tmp_path / "t.csv.gz", decimal_comma=True)
    content = gzip.decompress(target.read_bytes())
    assert content.startswith(b"\xef\xbb\xbfrecord;block;model;")
    assert content.count(b"\xef\xbb\xbf") == 1
    assert ";5,5574;" in content.decode()
    told = readme.read_text(encoding="utf-8")
    assert "UTF-8 with a byte order mark, semicolons between columns, decimal commas, one line" in told
    options = eval(f"dict({told.partition('read_csv(name, ')[2].partition(')`')[0]})")
    back = pd.read_csv(target, **options)
    for name in table:
        if table[name].dtype.kind == "f":
            assert np.array_equal(back[name], table[name], equal_nan=True), name


@pytest.mark.sweep
def test_parts_make_the_same_table_as_the_whole(opened):
    table = long_table(opened, selection=RowSelection(sort="safety_factor"))
    parts = list(table.frames(4))
    assert [len(part) for part in parts] == [4] * 6 + [3]
    pd.testing.assert_frame_equal(pd.concat(parts, ignore_index=True), table.frame())


@pytest.mark.sweep
def test_the_readme_names_every_column_with_unit_meaning_and_what_is_missing(opened, table, tmp_path):
    target, readme = written(opened, tmp_path / "table.csv", selection=RowSelection(limit=9))
    assert readme == readme_of(target) == tmp_path / "table.csv.README.md"
    text = readme.read_text()
    lines = [[cell.strip(" `") for cell in line.split("|")] for line in text.splitlines() if line.startswith("| `")]
    rows = {cells[1]: cells[2:5] for cells in lines}
    assert set(rows) == set(table.columns)
    assert rows["pga"] == ["m s^-2", "0", "peak ground acceleration after conditioning"]
    assert rows["safety_factor"][1] == "3"
    assert rows["outcome"][2] == "how the motion ends (at_rest, rocks, overturns, unresolved)"
    assert "9 rows, one per record x block x model" in text
    assert "`demand_acceleration`" in text.split("Not in this table")[1]


@pytest.mark.sweep
def test_nothing_is_replaced_unless_asked_for(opened, tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("mine")
    with pytest.raises(ResultsError, match=r"table\.csv: the file exists.*--overwrite"):
        written(opened, target)
    assert target.read_text() == "mine"
    written(opened, target, overwrite=True)
    target.unlink()
    with pytest.raises(ResultsError, match=r"table\.csv\.README\.md: the file exists"):
        written(opened, target)
    assert not target.exists()


@pytest.mark.parametrize(
    ("name", "said"), [("table.ods", "ends in .csv, .csv.gz, .xlsx or .parquet"), ("none/t.csv", "no folder")]
)
def test_other_names_are_refused(opened, tmp_path, name, said):
    with pytest.raises(ResultsError, match=said):
        written(opened, tmp_path / name)


def test_a_line_of_the_file_is_a_row_whatever_ends_a_line_in_a_text(tmp_path):
    tree = small_tree()
    ends = ["a\r\nb", "a\rb\vc", "a\fb\x85c\u2028d\u2029e"]
    tree["site"] = xr.DataTree(xr.Dataset({"word": ("y", ends, tree["site"]["word"].attrs)}))
    save(tree, tmp_path / "site.h5")
    with open_results_file(tmp_path / "site.h5") as file:
        write_table(long_table(file, dims=["y"]), tmp_path / "t.csv", "")
    assert pd.read_csv(tmp_path / "t.csv")["word"].tolist() == ["a | b", "a | b | c", "a | b | c | d | e"]
    assert len((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()) == 4


@pytest.mark.sweep
def test_results_that_cannot_be_read_are_no_fault_of_the_table(results, tmp_path, monkeypatch):
    def unread(table, size=0):
        raise OSError("Can't synchronously read data")

    with open_results_file(results) as file:
        table = long_table(file, dims=["record"])
        monkeypatch.setattr(type(table), "frames", unread)
        with pytest.raises(ResultsError, match=r"results\.h5: the results file is damaged"), file.reading():
            write_table(table, tmp_path / "t.csv", "")
    assert list(tmp_path.iterdir()) == []
