"""``rockpulse select`` on files."""

import numpy as np
import pandas as pd
import pytest

CONFIG = """
[records]
events = "events.csv"
[check]
spectrum = "en_1998_1"
ag = 0.2
[selection]
records = 3
factors = [0.01, 100.0]
"""


@pytest.fixture
def site(tmp_path):
    time = np.arange(0.0, 6.0, 0.01)
    names = []
    for number in range(4):
        ground = np.sin((4.0 + 3.0 * number) * time) * np.exp(-(((time - 3.0) / 0.8) ** 2))
        table = pd.DataFrame({"time [s]": time, "acc [m/s2]": ground})
        table.to_csv(tmp_path / f"r{number}.csv", index=False)
        names.append(f"r{number}.acc")
    pd.DataFrame({"record": names, "event": ["a", "b", "c", "d"]}).to_csv(tmp_path / "events.csv", index=False)
    path = tmp_path / "site.toml"
    path.write_text(CONFIG)
    return path


@pytest.mark.sweep
def test_a_table_and_a_picture_are_written(site, tmp_path, run):
    table = tmp_path / "selection.csv"
    options = ["select", str(tmp_path / "r*.csv"), "--config", str(site), "-n", "2", "-o", str(table)]
    shown = run(*options).out
    assert "2 records of 4, 2 earthquakes" in shown
    assert "NOT WITHIN" in shown
    found = pd.read_csv(table)
    assert list(found.columns) == ["record", "factor", "event"]
    assert len(found) == 2
    assert (tmp_path / "selection.png").read_bytes()[1:4] == b"PNG"
    assert "exists" in run(*options, code=2).err
    told = run(*options, "--overwrite", "--quiet")
    assert (told.out, told.err) == ("", "rockpulse: the mean spectrum is not within the tolerance\n")
