"""Overturning tests on a shake table: shares told right, and the published runs where their folder is there."""

import numpy as np
import pytest

from laboratory.experiments import ANGLES, compared, judged, predicted, read_runs, rocks, thresholds


def test_runs_are_read_as_they_were_typed(tmp_path):
    (tmp_path / "runs.csv").write_text("a,b,c,d\nt,0.1,0.2,Y\nt,0.1,0.1,n\nt,0.2,0.1,.N\nt,0.2,0.3,0\n")
    runs = read_runs(tmp_path / "runs.csv")
    assert runs["toppled"].tolist() == [True, False, False]
    assert runs["pgv"].to_numpy() == pytest.approx([0.02 * 9.80665, 0.01 * 9.80665, 0.02 * 9.80665])


def test_the_rock_has_the_frequency_parameter_of_its_inertia():
    # p^2 = M g h/(I + M h^2), with h the height of its centre for a slender rock.
    upright = np.sqrt(0.403494 * 9.80665 * 0.063 / (0.5 * (0.0005253 + 0.0006321) + 0.403494 * 0.063**2))
    assert rocks(np.array([0.01])).p == pytest.approx(upright, rel=1e-3)


def test_the_best_threshold_is_the_one_between_the_classes():
    values, toppled = np.array([0.3, 0.1, 0.4, 0.2]), np.array([True, False, True, False])
    assert judged(thresholds(values), toppled)[0] == 1.0
    assert judged(thresholds(values), ~toppled)[0] == 0.5


@pytest.mark.slow
def test_the_response_tells_the_published_runs_better_than_thresholds(records_folder):
    folder = records_folder.parent / "experiments" / "shakebot"
    if not folder.is_dir():
        pytest.skip("no folder experiments/shakebot beside the records")
    table = compared(folder).set_index("file")
    assert table["runs"].tolist() == [83, 135, 136, 64]
    assert table.loc["exp0.csv", "response, left out"] > 0.95
    for measure in ("PGA", "PGV"):
        assert np.all(table["response, left out"] > table[f"{measure}, left out"])
    runs = read_runs(folder / "exp0.csv")
    assert predicted(runs[:2], ANGLES[:3]).shape == (2, 3)
