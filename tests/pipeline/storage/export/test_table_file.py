"""Tables as workbooks and as Parquet: the numbers, kinds and texts of the file, and what they refuse."""

import numpy as np
import openpyxl
import pandas as pd
import pytest
import xarray as xr
from results_tree import results_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.export import table_file as typed_table
from rockpulse.storage.export.long_table import LongTable, long_table
from rockpulse.storage.export.table_file import write_table
from rockpulse.storage.hdf5.results_file import open_results_file, save

TEXTS = ["=1+1", "a\x1b[2Jb", "-2.5 and more\nline"]


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """Open results with such texts."""
    path = tmp_path_factory.mktemp("results") / "results.h5"
    tree = results_tree()
    warnings = xr.Variable("record", TEXTS, tree["summary"]["warnings"].attrs)
    tree["summary"] = xr.DataTree(tree["summary"].to_dataset().assign(warnings=warnings))
    save(tree, path)
    with open_results_file(path) as file:
        yield file


@pytest.fixture(scope="module")
def table(opened):
    return long_table(opened).frame()


def written(opened, path, columns=None, **options):
    return write_table(long_table(opened, columns=columns), path, "", **options)


@pytest.mark.sweep
def test_parquet_is_the_table_itself(opened, table, tmp_path):
    target, readme = written(opened, tmp_path / "t.parquet")
    back = pd.read_parquet(target)
    for name in table:
        assert back[name].tolist() == table[name].tolist() or np.array_equal(back[name], table[name], equal_nan=True)
    assert back["warnings"].unique().tolist() == TEXTS
    assert "Parquet, SI units, numbers with all digits" in readme.read_text()


@pytest.mark.sweep
def test_a_workbook_has_numbers_to_16_digits_and_texts_that_are_only_texts(opened, table, tmp_path, monkeypatch):
    parts = LongTable.frames
    monkeypatch.setattr(LongTable, "frames", lambda table: parts(table, 4))
    columns = ["warnings", "outcome", "pga", *table.columns[3:40:4]]
    table = table[[*table.columns[:3], *dict.fromkeys(columns)]]
    target, readme = written(opened, tmp_path / "t.xlsx", columns=table.columns[3:].tolist())
    monkeypatch.undo()
    sheet = openpyxl.load_workbook(target)["summary"]
    headings, *rows = [[cell.value for cell in row] for row in sheet.iter_rows()]
    assert sorted(headings) == sorted(table.columns)
    assert len(rows) == len(table)
    for place, name in enumerate(headings):
        if table[name].dtype.kind == "f":
            found = [np.nan if row[place] is None else float(row[place]) for row in rows]
            assert np.allclose(found, table[name], rtol=5e-16, atol=0.0, equal_nan=True), name
    column = headings.index("warnings")
    assert {cell.data_type for row in sheet.iter_rows(min_row=2) for cell in row[column : column + 1]} == {"s"}
    assert sorted({row[column] for row in rows}) == sorted(["=1+1", r"a\x1b[2Jb", TEXTS[2]])
    assert "A workbook of one sheet" in readme.read_text()
    assert readme.name == "t.xlsx.README.md"


def test_what_a_workbook_cannot_hold_is_told_before_it_is_written(opened, tmp_path, monkeypatch):
    with pytest.raises(ResultsError, match="--decimal-comma: expected a CSV file"):
        written(opened, tmp_path / "t.xlsx", decimal_comma=True)
    monkeypatch.setattr(typed_table, "SHEET_ROWS", 27)
    with pytest.raises(ResultsError, match="27 rows, but a sheet has at most 26: select fewer"):
        written(opened, tmp_path / "t.xlsx")
    assert [path.name for path in tmp_path.iterdir()] == []


@pytest.mark.parametrize(("suffix", "library"), [(".xlsx", "openpyxl"), (".parquet", "pyarrow")])
def test_a_library_that_is_missing_is_named_with_the_extra(opened, tmp_path, monkeypatch, suffix, library):
    monkeypatch.setattr(typed_table, "find_spec", lambda name: None)
    with pytest.raises(ResultsError, match=rf"{library}, which is not installed: pip install 'rockpulse\[tables\]'"):
        written(opened, tmp_path / f"t{suffix}")
