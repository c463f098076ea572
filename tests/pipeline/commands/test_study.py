"""``rockpulse study``: files, tables, text, refusals; the schema names what is in the files."""

import csv
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from record_writers import at2
from results_tree import results_bytes

from rockpulse.cli import main
from rockpulse.storage.hdf5.results_file import load
from rockpulse.storage.study_variables import AXES, FIGURE4, FIGURE5, INTERVALS, STATEMENTS
from rockpulse.studies.paper.paper_blocks import DURATION, RESTITUTIONS
from rockpulse.studies.paper.parametric_analysis import COUNTS, IMPULSE_RATIOS
from rockpulse.studies.paper.time_histories import INTERVAL, SCAN, STEP, STUDIED_RATIOS

SCHEMA = Path(__file__).parents[3] / "docs" / "schema.md"

SMALL4 = ["figure4", "--impulse-ratio", "0.1", "0.3", "--secondary-ratio", "0", "0.5", "1", "--count", "2", "inf"]
SMALL5 = ["figure5", "--secondary-ratio", "0", "0.3", "0.7", "--scan", "0.4", "0.5", "0.05", "--step", "0.5"]


def run(*arguments):
    return main(["study", *map(str, arguments)])


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    assert run(*SMALL4, "-o", folder / "figure4.h5", "--csv", folder / "four", "--quiet") == 0
    assert run(*SMALL5, "-o", folder / "figure5.h5", "--csv", folder / "five", "--quiet") == 0
    return folder


def test_the_files_are_there_and_nothing_else(done):
    assert sorted(path.name for path in done.iterdir()) == ["figure4.h5", "figure5.h5", "five", "four"]
    assert {path.name for path in (done / "four").iterdir()} == {"figure4.csv", "statements.csv"}
    assert {path.name for path in (done / "five").iterdir()} == {
        f"{name}.csv" for name in ("histories", "half_cycles", "intervals", "statements")
    }


@pytest.mark.parametrize(
    ("name", "groups"),
    [
        ("figure4", {"figure4": FIGURE4, "statements": STATEMENTS}),
        ("figure5", {"figure5": FIGURE5, "intervals": INTERVALS, "statements": STATEMENTS}),
    ],
)
def test_bare_h5py_finds_unit_and_long_name_on_every_variable(done, name, groups):
    with h5py.File(done / f"{name}.h5") as file:
        assert set(file) == set(groups)
        assert file.attrs["kind"] == "study"
        assert file.attrs["gravity"] == 9.81
        assert {"rockpulse_version", "schema_version", "title", "duration"} <= set(file.attrs)
        for group, meanings in groups.items():
            assert set(file[group]) - set(AXES) == set(meanings) - set(AXES)
            for item in file[group].values():
                assert isinstance(item.attrs["units"], str), item.name
                assert isinstance(item.attrs["long_name"], str), item.name


def test_the_schema_names_every_group_variable_and_attribute(done):
    section = SCHEMA.read_text(encoding="utf-8").split("## The study\n")[1].split("\n## ")[0]
    for name in ("figure4", "figure5"):
        with h5py.File(done / f"{name}.h5") as file:
            for group in file:
                assert f"`/{group}`" in section
                for variable in file[group]:
                    assert f"`{variable}`" in section, f"{group}/{variable}"
            for attribute in ("kind", "duration", "gravity"):
                assert attribute in file.attrs
                assert f"`{attribute}`" in section


def test_a_study_is_loaded_as_it_was_saved(done):
    tree = load(done / "figure5.h5")
    figure = tree["figure5"].to_dataset()
    assert figure["overturning_half_cycle"].sel(
        restitution=0.9, secondary_ratio=0.7, spacing="end"
    ).values.tolist() == [6, 7]
    assert figure["interval"].item() == 0.5
    assert tree["statements"]["statement"].dtype.kind == "U"
    with xr.open_dataset(done / "figure4.h5", group="figure4", engine="h5netcdf") as figure:
        assert np.isinf(figure["intermediate_count"].values[-1])


def test_csv_and_hdf5_hold_the_same_numbers(done):
    with (done / "four" / "figure4.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    figure = load(done / "figure4.h5")["figure4"].to_dataset()
    assert [float(row["peak_rotation_ratio"]) for row in rows] == figure["peak_rotation_ratio"].values.ravel().tolist()


def test_the_command_prints_what_inspect_prints(done, tmp_path, capsys):
    assert run(*SMALL4, "-o", tmp_path / "study.h5") == 0
    printed = capsys.readouterr().out
    assert main(["inspect", str(tmp_path / "study.h5")]) == 0
    assert printed == capsys.readouterr().out + f"\nwritten: {tmp_path / 'study.h5'}\n"
    assert "Figure 4" in printed


@pytest.mark.parametrize("option", [["--record", "x"], ["--block", "A"], ["--failures"]])
def test_inspect_shows_a_study_whole(done, capsys, option):
    assert main(["inspect", str(done / "figure4.h5"), *option]) == 2
    assert "this is a study" in capsys.readouterr().err


def test_nothing_is_replaced_unless_asked_for(done, tmp_path, capsys):
    target = tmp_path / "study.h5"
    target.write_bytes((done / "figure4.h5").read_bytes())
    assert run(*SMALL4, "-o", target) == 2
    assert "the file exists" in capsys.readouterr().err
    assert run(*SMALL4, "-o", target, "--overwrite", "--quiet") == 0
    assert run(*SMALL4, "-o", tmp_path / "other.h5", "--csv", done / "four") == 2
    assert not (tmp_path / "other.h5").exists()


def test_results_are_never_replaced_by_a_study(tmp_path, capsys):
    before = results_bytes()
    (tmp_path / "results.h5").write_bytes(before)
    assert run(*SMALL4, "-o", tmp_path / "results.h5", "--overwrite") == 2
    assert "expected a study of rockpulse, found an assessment" in capsys.readouterr().err
    assert (tmp_path / "results.h5").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figure4", "--count", "3"], "even numbers"),
        (["figure4", "--restitution", "1.2"], "restitution"),
        (["figure5", "--scan", "0.5", "0.1", "0.1"], "scan"),
        (["figure5", "--secondary-ratio", "0.3", "0.5", "0.7"], "of which the first is 0"),
    ],
)
def test_a_value_out_of_range_is_exit_code_two(tmp_path, capsys, arguments, words):
    assert run(*arguments, "-o", tmp_path / "x.h5") == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "x.h5").exists()


def test_the_help_names_the_defaults(capsys):
    said = {}
    for figure in ("figure4", "figure5"):
        with pytest.raises(SystemExit):
            run(figure, "--help")
        said[figure] = " ".join(capsys.readouterr().out.split())
    for text in said.values():
        assert f"default: {DURATION:g} s" in text
        assert f"default: {RESTITUTIONS[0]:g} {RESTITUTIONS[1]:g}" in text
    assert f"default: {IMPULSE_RATIOS[0]:g} to {IMPULSE_RATIOS[-1]:.1f}" in said["figure4"]
    assert f"default: {' '.join(f'{count:g}' for count in COUNTS)}" in said["figure4"]
    assert f"default: {' '.join(f'{share:g}' for share in STUDIED_RATIOS)}" in said["figure5"]
    assert f"default: {INTERVAL:g} s" in said["figure5"]
    assert f"default: {STEP:g} s" in said["figure5"]
    assert f"default: {SCAN[0]:g} {SCAN[-1]:g} {SCAN[1] - SCAN[0]:.3g} s" in said["figure5"]


@pytest.mark.parametrize("arguments", [[], ["figure6", "-o", "x.h5"], ["figure4"]])
def test_wrong_usage_ends_with_two(arguments):
    with pytest.raises(SystemExit) as end:
        run(*arguments)
    assert end.value.code == 2


def test_the_checks_of_codes_are_judged_on_records(tmp_path, capsys):
    times = 0.02 * np.arange(300)
    for number in range(2):
        rng = np.random.default_rng(number)
        waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * times + rng.uniform(0.0, 6.0)) for f in (0.6, 1.1, 2.3))
        shaking = 0.4 * waves / np.max(np.abs(waves)) * np.exp(-(((times - 3.0) / 1.5) ** 2))
        title = f"Event {number}, 1/2/2003, Station {number}, 090"
        (tmp_path / f"r{number}.AT2").write_bytes(at2(shaking.tolist(), title=title))
    target = tmp_path / "codes.h5"
    assert run("code-check", tmp_path, "-o", target, "--csv", tmp_path / "tables") == 0
    shown = capsys.readouterr().out
    assert "Checks of codes against time histories: 2 channels of 2 earthquakes, 12 bodies" in shown
    assert {path.name for path in (tmp_path / "tables").iterdir()} == {
        "code_check.csv",
        "rates.csv",
        "statements.csv",
    }
    tree = load(target)
    assert tree["code_check"].sizes["row"] == 24
    assert main(["inspect", str(target)]) == 0
    assert "displacement" in capsys.readouterr().out
    assert main(["plot", str(target), "code-check", "-o", str(tmp_path / "codes.png")]) == 0
    assert (tmp_path / "codes.png").stat().st_size > 10_000
    assert run("code-check", tmp_path, "-o", tmp_path / "other.h5", "--confidence-factor", "0.5") == 2
    assert "confidence_factor: expected a number >= 1" in capsys.readouterr().err


def test_no_strong_channel_is_told_and_nothing_is_written(tmp_path, capsys):
    (tmp_path / "weak.AT2").write_bytes(at2([0.0, 0.01, -0.01, 0.0] * 100))
    assert run("code-check", tmp_path / "weak.AT2", "-o", tmp_path / "codes.h5") == 1
    assert "no strong channel among the records" in capsys.readouterr().err
    assert not (tmp_path / "codes.h5").exists()
