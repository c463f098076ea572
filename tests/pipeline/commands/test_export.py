"""``rockpulse export``."""

import pandas as pd
import pytest
import xarray as xr
from results_tree import RECORDS, demanding, results_tree

from rockpulse.cli import main
from rockpulse.storage.hdf5.results_file import save


def test_a_table_and_its_readme(results, tmp_path, run):
    target = tmp_path / "table.csv"
    options = ["--outcome", "overturns", "--model", "nonlinear", "--sort", "safety_factor", "--columns", "pga,outcome"]
    out = run("export", results, "-o", target, *options).out.splitlines()
    assert out[0] == f"{target}: 1 rows, one per record x block x model, 5 columns"
    assert pd.read_csv(target).to_dict("records") == [
        {"record": RECORDS[0], "block": "boundary wall", "model": "nonlinear", "pga": 5.5574, "outcome": "overturns"}
    ]
    readme = (tmp_path / "table.csv.README.md").read_text()
    assert "| column | unit | empty cells of 1 | meaning |" in readme
    assert "`inf`: no limit" in readme
    # The same table in another format has its own README.
    run("export", results, "-o", tmp_path / "table.csv.gz", *options)
    assert (tmp_path / "table.csv.gz.README.md").exists()
    assert "From `results.h5` (Borgo;" in readme
    assert "Selection: model nonlinear; outcome = overturns; sorted by safety_factor, smallest first." in readme


@pytest.mark.sweep
def test_other_groups_and_rows(results, tmp_path, run):
    run("export", results, "-o", tmp_path / "f.csv", "--group", "failures", "--where", "kind=failed")
    assert pd.read_csv(tmp_path / "f.csv")["file"].tolist() == ["cut.AT2"]
    run("export", results, "-o", tmp_path / "r.csv", "--rows", "record", "--record", "CI.*")
    assert pd.read_csv(tmp_path / "r.csv")["record"].tolist() == RECORDS[:2]
    assert "l.csv: 5 of 27 rows" in run("export", results, "-o", tmp_path / "l.csv", "--limit", "5").out


@pytest.mark.sweep
def test_the_readme_has_the_demands_and_the_decimal_comma_is_an_option(tmp_path):
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    ratio = summary["safety_factor"].expand_dims(demand=2, axis=-1)
    ratio = (ratio.dims, ratio.values, {"units": "1", "long_name": "over demand"})
    tree["summary"] = xr.DataTree(demanding(summary, {"SLD": 1.0, "SLV": 2.5}, capacity_ratio=ratio))
    save(tree, tmp_path / "r.h5")
    target = tmp_path / "t.csv"
    options = ["--model", "nonlinear", "--columns", "pga,outcome,capacity_ratio", "--decimal-comma"]
    assert main(["export", str(tmp_path / "r.h5"), "-o", str(target), *options]) == 0
    assert pd.read_csv(target, sep=";", decimal=",")["pga"].tolist()[:1] == [5.5574]
    readme = (tmp_path / "t.csv.README.md").read_text(encoding="utf-8")
    assert "Demands: SLD, PGA 1 m/s2, SLV, PGA 2.5 m/s2." in readme
