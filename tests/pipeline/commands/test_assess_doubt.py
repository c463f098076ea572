"""``rockpulse assess`` where sizes, peaks, units or samples are in doubt: what it asks, and how that is answered."""

import numpy as np
import pytest
from assess_command import STRONG, configuration, values, write_at2
from shaking import DT, held, shaking, step

import rockpulse as rp


@pytest.fixture
def folder(tmp_path_factory):
    """One good record, apart from what a test writes."""
    folder = tmp_path_factory.mktemp("records")
    write_at2(folder / "strong.AT2", STRONG)
    return folder


@pytest.mark.sweep
def test_sizes_in_millimetres_are_exit_code_two_before_any_work_unless_confirmed(folder, quick, tmp_path, assess):
    target = tmp_path / "results.h5"
    arguments = [folder / "strong.AT2", "--block", "statue=600x1700", "-o", target, "--config", quick]
    assert assess(*arguments, code=2).err.startswith(
        'rockpulse: --block "statue=600x1700": 600 x 1700: are these millimetres? A body '
    )
    assert not target.exists()
    assess(*arguments, "--confirm-size")
    stored = tmp_path / "stored.toml"
    stored.write_text(rp.load(target).attrs["configuration"])
    assert rp.load_config(stored).bodies[0].confirm_size
    assert "600 m wide and 1700 m high" in rp.load(target)["summary"]["block_warnings"].values[0]


@pytest.mark.sweep
def test_a_record_in_the_wrong_unit_fails_until_it_is_confirmed(folder, quick, tmp_path, assess):
    write_at2(tmp_path / "odd.AT2", 1000.0 * STRONG)
    target = tmp_path / "results.h5"
    given = [folder / "strong.AT2", tmp_path / "odd.AT2", "-o", target, "--workers", "1"]
    said = " ".join(assess(*given, "--config", quick, code=1).out.split())
    assert values(target, "record") == ["strong.90"]
    assert values(target, "failures/kind") == ["failed"]
    assert "odd.90: peak 432 g if the unit is g; 0.44 g if it is cm/s2" in said
    assert "if it is right, give --confirm odd.90, or confirm" in said
    again = [*given, "--overwrite", "--config"]
    said = " ".join(assess(*again, quick, "--confirm", "strong*", "--confirm", "odd.*").out.split())
    assert sorted(values(target, "record")) == ["odd.90", "strong.90"]
    assert "odd.90 (peak?)" in said
    assert "odd_peak" in values(target, "warning_codes")[values(target, "record").index("odd.90")]
    assert 'confirm = ["strong*", "odd.*"]' in configuration(target)
    config = tmp_path / "site.toml"
    config.write_text(f'[records]\nconfirm = ["odd.90"]\n{quick.read_text()}')
    assess(*again, config)
    assert "no record id matches nothing; the ids are" in assess(*again, quick, "--confirm", "nothing", code=2).err


@pytest.mark.sweep
def test_what_is_confirmed_is_done_when_a_run_is_resumed_and_the_rest_is_kept(quick, tmp_path, assess):
    write_at2(tmp_path / "a.AT2", STRONG)
    write_at2(tmp_path / "odd.AT2", 1000.0 * STRONG)
    given = [tmp_path / "a.AT2", tmp_path / "odd.AT2", "-o", tmp_path / "results.h5", "--workers", "1"]
    given += ["--config", quick]
    assert "peak 432 g" in assess(*given, "--strict", code=1).err
    assert "1 of 2 records were finished before" in assess(*given, "--resume", "--confirm", "odd*").err
    assert len(values(tmp_path / "results.h5", "record")) == 2


@pytest.mark.sweep
def test_unit_and_interval_of_some_files_yield_to_the_command_line(quick, tmp_path, assess):
    for name in ("a.g3", "b.txt"):
        (tmp_path / name).write_text("\n".join(f"{value:.8f}" for value in STRONG * (1.0 if name == "a.g3" else 98.0)))
    config, target = tmp_path / "site.toml", tmp_path / "results.h5"
    config.write_text(
        '[records]\npaths = ["a.g3", "b.txt"]\nunits = "cm/s2"\ndt = 0.01\n'
        f'[[records.file]]\nmatch = "*.g3"\nunits = "g"\ndt = 0.02\n{quick.read_text()}'
    )
    assess("--config", config, "-o", target)
    assert values(target, "record") == ["a.1", "b.1"]
    assert values(target, "pga") == pytest.approx([0.45 * 9.80665, 0.45 * 0.98], rel=0.05)
    assert values(target, "dt") == [0.02, 0.01]
    assess("--config", config, "-o", target, "--overwrite", "--dt", "0.005")
    assert values(target, "dt") == [0.005, 0.005]
    assert values(target, "pga") == pytest.approx([0.45 * 9.80665, 0.45 * 0.98], rel=0.05)
    assert 'match = "*.g3"\nunits = "g"\n' in configuration(target)
    assess("--config", config, "-o", target, "--overwrite", "--dt", "0.005", "--units", "m/s2")
    assert "[[records.file]]" not in configuration(target)


def write(path, samples):
    rows = (f"{number * DT:.2f},{value:.6f}" for number, value in enumerate(samples))
    path.write_text("time [s],acc N [m/s2]\n" + "\n".join(rows) + "\n")
    return path


@pytest.mark.sweep
def test_a_record_whose_defect_decides_counts_once_it_is_confirmed_and_is_marked_everywhere(
    quick, tmp_path, run, assess
):
    files = [write(tmp_path / "sound.csv", shaking()), write(tmp_path / "gap.csv", held(shaking(), DT, 1.0)[0])]
    files.append(write(tmp_path / "step.csv", step(shaking(), DT, 40.0)[0]))
    files.append(write(tmp_path / "dead.csv", np.full(4000, 0.3)))
    target = tmp_path / "results.h5"
    given = [*files, "-o", target, "--config", quick]
    said = " ".join(assess(*given, code=1).out.split())
    assert values(target, "record") == ["sound.acc_N"]
    assert "give --confirm gap.acc_N, or" in said
    assert "all samples are equal: a dead channel" in said
    assert "defect?" not in said
    clean = values(target, "peak_rotation_ratio")
    said = " ".join(assess(*given, "--overwrite", "--confirm", "gap*", "--confirm", "step*", code=1).out.split())
    assert values(target, "record") == ["gap.acc_N", "sound.acc_N", "step.acc_N"]
    assert values(target, "pgv_drift")[1:] == [0, 1]
    assert values(target, "peak_rotation_ratio")[1] == clean[0]
    codes = values(target, "warning_codes")
    assert "held_value" in codes[0].split()
    assert "velocity_drift" in codes[2].split()
    assert "gap.acc_N (defect?)" in said
    report = tmp_path / "report.html"
    run("report", target, "-o", report)
    assert "(defect?)" in report.read_text()


def test_a_record_that_was_conditioned_is_not_conditioned_again(quick):
    config = rp.load_config(quick)
    record = rp.Record(shaking(), DT, id="made", processed=None)
    bodies = {"wall": rp.models.Block(0.2, 2.2)}
    before = rp.condition(record, baseline="linear", highpass_hz=0.2)
    summary = rp.assess([before], config, bodies)["summary"]
    assert float(summary["pga"][0]) == before.pga
    assert str(summary["processing"].values[0]).splitlines() == list(before.processing)
