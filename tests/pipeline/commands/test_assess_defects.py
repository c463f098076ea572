"""``rockpulse assess`` on records with a defect: in the screen, in the file and in the report, and once confirmed."""

import numpy as np
import pytest
from assess_command import assess, values
from shaking import DT, held, shaking, step

import rockpulse as rp
from rockpulse.cli import main


def write(path, samples):
    rows = (f"{number * DT:.2f},{value:.6f}" for number, value in enumerate(samples))
    path.write_text("time [s],acc N [m/s2]\n" + "\n".join(rows) + "\n")
    return path


@pytest.mark.sweep
def test_a_record_whose_defect_decides_counts_once_it_is_confirmed_and_is_marked_everywhere(quick, tmp_path, capsys):
    files = [write(tmp_path / "sound.csv", shaking()), write(tmp_path / "gap.csv", held(shaking(), DT, 1.0)[0])]
    files.append(write(tmp_path / "step.csv", step(shaking(), DT, 40.0)[0]))
    files.append(write(tmp_path / "dead.csv", np.full(4000, 0.3)))
    target = tmp_path / "results.h5"
    given = [*files, "-o", target, "--config", quick]
    assert assess(*given) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert values(target, "record") == ["sound.acc_N"]
    assert "give --confirm gap.acc_N, or" in said
    assert "all samples are equal: a dead channel" in said
    assert "defect?" not in said
    clean = values(target, "peak_rotation_ratio")
    assert assess(*given, "--overwrite", "--confirm", "gap*", "--confirm", "step*") == 1
    said = " ".join(capsys.readouterr().out.split())
    assert values(target, "record") == ["gap.acc_N", "sound.acc_N", "step.acc_N"]
    assert values(target, "pgv_drift")[1:] == [0, 1]
    assert values(target, "peak_rotation_ratio")[1] == clean[0]
    codes = values(target, "warning_codes")
    assert "held_value" in codes[0].split()
    assert "velocity_drift" in codes[2].split()
    assert "gap.acc_N (defect?)" in said
    report = tmp_path / "report.html"
    assert main(["report", str(target), "-o", str(report)]) == 0
    assert "(defect?)" in report.read_text()


def test_a_record_that_was_conditioned_is_not_conditioned_again(quick):
    config = rp.load_config(quick)
    record = rp.Record(shaking(), DT, id="made", processed=None)
    bodies = {"wall": rp.models.Block(0.2, 2.2)}
    before = rp.condition(record, baseline="linear", highpass_hz=0.2)
    summary = rp.assess([before], config, bodies)["summary"]
    assert float(summary["pga"][0]) == before.pga
    assert str(summary["processing"].values[0]).splitlines() == list(before.processing)
