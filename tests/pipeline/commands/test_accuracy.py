"""``rockpulse accuracy --quick`` from nothing to files: what it writes, prints and refuses."""

import csv
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from results_tree import results_bytes

from rockpulse.cli import main
from rockpulse.storage.accuracy_variables import TABLES
from rockpulse.studies.accuracy import measurement

CSV_TABLES = {"work_precision", "synthetic_grid", "convergence", "model_form", "classifiers"}
SCHEMA = Path(__file__).parents[3] / "docs" / "schema.md"


def run(*arguments):
    return main(["accuracy", *map(str, arguments)])


@pytest.fixture(scope="module")
def done(tmp_path_factory, samples):
    """A quick report with everything, on a sample with vertical channels."""
    folder = tmp_path_factory.mktemp("accuracy")
    given = [samples / "CICCC.RAW", "-o", folder / "report.h5", "--csv", folder / "tables"]
    assert run(*given, "--plot", folder / "diagram.svg", "--quick", "--quiet") == 0
    return folder


def column(report, name):
    with h5py.File(report) as file:
        values = file[name][:]
    return values.astype(str) if values.dtype == object else values


def test_the_folder_holds_the_files_and_nothing_else(done):
    assert sorted(path.name for path in done.iterdir()) == ["diagram.svg", "report.h5", "tables"]
    assert {path.name for path in (done / "tables").iterdir()} == {f"{name}.csv" for name in CSV_TABLES}


def test_bare_h5py_finds_unit_and_long_name_on_every_variable(done):
    seen = set()

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and not item.attrs.get("NAME", b"").startswith(b"This is a netCDF dimension"):
            seen.add(name)
            assert isinstance(item.attrs["units"], str), name
            assert isinstance(item.attrs["long_name"], str), name

    with h5py.File(done / "report.h5") as file:
        file.visititems(visit)
        assert file.attrs["seed"] == 0
        assert "mpf" not in file.attrs["reference"]
        assert {"rockpulse_version", "numpy_version", "numba_version", "python_version"} <= set(file.attrs)
        assert file.attrs["title"] == "Speed and error of rocking solvers and models"
    assert seen == {f"{table}/{name}" for table, columns in TABLES.items() for name in columns}


def test_the_schema_names_every_group_and_variable_of_the_report(done):
    section = SCHEMA.read_text(encoding="utf-8").split("## The accuracy report\n")[1].split("\n## ")[0]
    with h5py.File(done / "report.h5") as file:
        for group in file:
            assert f"| `/{group}` |" in section.split("<!--")[0]
            for name in set(file[group]) - {"row"}:
                assert f"| `/{group}` | `{name}` |" in section, f"{group}/{name}"
        for attribute in ("kind", "reference", "seed", "effort", "ensembles"):
            assert attribute in file.attrs
            assert f"`{attribute}`" in section


def test_a_report_is_called_what_it_is_by_those_who_read_results(done, capsys):
    assert main(["inspect", str(done / "report.h5")]) == 2
    error = capsys.readouterr().err
    assert all(words in error for words in ("report.h5", "this is an accuracy report", "docs/schema.md")), error
    assert "not written by rockpulse" not in error


def test_a_report_is_not_written_over_results_nor_results_over_a_report(done, samples, tmp_path, monkeypatch, capsys):
    results, report = tmp_path / "results.h5", tmp_path / "report.h5"
    results.write_bytes(results_bytes())
    report.write_bytes((done / "report.h5").read_bytes())
    before = results.read_bytes(), report.read_bytes()
    monkeypatch.setattr(measurement, "accuracy", lambda *given, **options: pytest.fail("measured"))
    assert run("-o", results, "--overwrite") == 2
    assert "expected an accuracy report of rockpulse, found an assessment" in capsys.readouterr().err
    given = [samples / "CICCC.RAW", "--config", samples.parent / "site.toml", "-o", report, "--overwrite"]
    assert main(["assess", *map(str, given)]) == 2
    assert "expected an assessment of rockpulse, found an accuracy report" in capsys.readouterr().err
    assert (results.read_bytes(), report.read_bytes()) == before


def test_the_synthetic_grid_is_a_part_of_the_cases_and_as_exact(done):
    report = done / "report.h5"
    assert set(column(report, "synthetic_grid/restitution")) == {0.9}
    assert set(column(report, "synthetic_grid/step")) == {0.08}
    whole = column(report, "work_precision/cases")[column(report, "work_precision/method") == "reference"]
    assert np.all(column(report, "synthetic_grid/cases") <= whole)
    assert np.all(column(report, "synthetic_grid/flips") == 0)
    assert np.all(column(report, "synthetic_grid/p99") < 1e-6)


def test_the_report_holds_error_and_cost_of_every_solver(done):
    report = done / "report.h5"
    method = column(report, "work_precision/method")
    assert set(method) == {"reference", "rockpulse", "RK45"}
    assert set(column(report, "work_precision/equation")) == {"linear", "nonlinear"}
    measured = method != "reference"
    assert np.all(column(report, "work_precision/ns_per_active_sample")[measured] > 0.0)
    rockpulse = method == "rockpulse"
    assert np.all(column(report, "work_precision/flips")[rockpulse] == 0)
    assert np.all(
        column(report, "work_precision/median")[rockpulse & (column(report, "work_precision/compared") > 1)] < 1e-9
    )


def test_the_ensembles_are_the_records_and_the_synthetic_motions(done):
    report = done / "report.h5"
    assert set(column(report, "model_form/ensemble")) == {"records", "synthetic"}
    assert set(column(report, "classifiers/ensemble")) == {"records", "synthetic"}
    assert set(column(report, "failures/kind")) == {"vertical"}


def test_the_samples_are_cases_of_the_reference(done):
    assert any(case.startswith("CI.CCC") for case in column(done / "report.h5", "answers/case"))


def test_csv_and_hdf5_hold_the_same_numbers(done):
    for table in CSV_TABLES:
        with (done / "tables" / f"{table}.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert list(rows[0]) == list(TABLES[table])
        for name, declared in TABLES[table].items():
            stored = column(done / "report.h5", f"{table}/{name}")
            if declared.kind is str:
                assert [row[name] for row in rows] == stored.tolist()
            else:
                np.testing.assert_array_equal([float(row[name] or "nan") for row in rows], stored)


def test_the_diagram_names_its_axes_and_methods(done):
    drawing = (done / "diagram.svg").read_text()
    assert drawing.lstrip().startswith("<?xml")
    for word in (
        "cost [ns per active sample]",
        "leq 10^{-16}",
        "linear equation",
        "rockpulse by longest step",
        "solve_ivp RK45 by rtol: median",
    ):
        assert word in drawing, word


@pytest.fixture(scope="module")
def report(done):
    """The report of the fixture above."""
    with xr.open_datatree(done / "report.h5", engine="h5netcdf") as opened:
        return opened.load()


@pytest.fixture
def measured(monkeypatch, report):
    """That report in place of a new measurement."""
    monkeypatch.setattr(measurement, "accuracy", lambda *given, **options: report)


def test_the_tables_are_printed_with_error_beside_cost(measured, tmp_path, capsys):
    assert run("-o", tmp_path / "report.h5") == 0
    out = capsys.readouterr().out
    head = next(line for line in out.splitlines() if "p99" in line)
    assert [word in head for word in ("flips", "median", "ns/active", "ns/nominal", "x RK45")] == [True] * 5
    assert "solve_ivp RK45, rtol 1e-6" in out
    assert "p PGV/(g tan alpha)" in out
    assert "upper-bound type input" in out
    assert "* x RK45" in out
    assert "rockpulse on the synthetic grid" in out
    assert " nan" not in out
    assert out.endswith(f"written: {tmp_path / 'report.h5'}\n")


@pytest.mark.parametrize(
    ("existing", "arguments"),
    [
        ("report.h5", []),
        ("diagram.png", ["--plot", "diagram.png"]),
        ("tables/convergence.csv", ["--csv", "tables"]),
    ],
)
def test_what_exists_is_refused_before_anything_is_measured(existing, arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tables").mkdir()
    (tmp_path / existing).write_text("precious")
    monkeypatch.setattr(measurement, "accuracy", lambda *given, **options: pytest.fail("measured"))
    assert run("-o", "report.h5", *arguments) == 2
    assert existing in capsys.readouterr().err
    assert (tmp_path / existing).read_text() == "precious"


def test_overwrite_replaces_a_report_its_tables_and_its_diagram(measured, done, tmp_path, monkeypatch):
    shutil.copytree(done, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    arguments = ["-o", "report.h5", "--csv", "tables", "--plot", "diagram.svg", "--quiet"]
    before = {path: path.stat().st_ino for path in tmp_path.rglob("*.*")}
    assert len(before) == 7
    assert run(*arguments) == 2
    assert run(*arguments, "--overwrite") == 0
    assert set(tmp_path.rglob("*.*")) == set(before)
    assert all(path.stat().st_ino != number for path, number in before.items())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--plot", "diagram.bmp"], ["diagram.bmp", ".svg", ".bmp"]),
        (["--plot", "nowhere/diagram.svg"], ["nowhere"]),
        (["--csv", "nowhere/tables"], ["nowhere"]),
        (["--csv", "a_file"], ["a_file", "folder"]),
        (["--cases", "0"], ["cases", "at least 1", "0"]),
        (["--seed", "-1"], ["seed", "-1"]),
        (["--dt", "-0.01", "--quick"], ["dt", "-0.01"]),
    ],
)
def test_bad_arguments_are_named(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a_file").write_text("")
    assert run("-o", "report.h5", *arguments) == 2
    error = capsys.readouterr().err
    assert all(word in error for word in words), error
    assert [path.name for path in tmp_path.iterdir()] == ["a_file"]


def test_an_interrupted_run_leaves_nothing(tmp_path, monkeypatch):
    def interrupted(*given, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(measurement, "work_precision", interrupted)
    assert run("-o", tmp_path / "report.h5", "--csv", tmp_path / "tables", "--quick") == 130
    assert list(tmp_path.iterdir()) == []


def test_a_diagram_that_cannot_be_written_leaves_no_half_file(measured, tmp_path, monkeypatch, capsys):
    def full(self, content):
        self.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert run("-o", tmp_path / "report.h5", "--plot", tmp_path / "diagram.png") == 2
    assert "No space left on device" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.sweep
def test_records_that_fail_are_named_and_the_rest_goes_on(tmp_path, capsys):
    """One that is no whole file, and one that can be read but never shakes."""
    (tmp_path / "broken.AT2").write_text("PEER STRONG MOTION DATABASE RECORD\n")
    (tmp_path / "still.csv").write_text("\n".join(f"{0.01 * number:.2f},0.0" for number in range(500)))
    report = tmp_path / "report.h5"
    given = [tmp_path / "broken.AT2", tmp_path / "still.csv", "--units", "g"]
    assert run(*given, "-o", report, "--quick", "--quiet") == 1
    error = capsys.readouterr().err
    assert "broken.AT2" in error
    assert "still" in error
    assert column(report, "failures/kind").tolist() == ["failed", "failed"]
    assert column(report, "failures/stage").tolist() == ["read", "accuracy"]
    assert set(column(report, "model_form/ensemble")) == {"synthetic"}


def test_a_run_without_one_record_of_those_that_were_named_ends_at_once(tmp_path, monkeypatch, capsys):
    def measured_all_the_same(*args, **options):
        raise AssertionError

    monkeypatch.setattr(measurement, "accuracy", measured_all_the_same)
    assert main(["accuracy", str(tmp_path), "-o", str(tmp_path / "x.h5")]) == 1
    assert "not one record could be read, nothing was written" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
