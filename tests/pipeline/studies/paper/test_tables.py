"""The groups of a study as flat tables."""

import numpy as np
import pytest

from rockpulse.studies.paper.tables import study_tables
from rockpulse.study import figure4, figure5


@pytest.fixture(scope="module")
def four():
    return figure4([0.9, 0.6], [0.1, 0.3], [0.0, 0.5, 1.0], [2, np.inf], threads=1)


@pytest.fixture(scope="module")
def five():
    return figure5(secondary_ratios=[0.0, 0.3, 0.7], intervals=[0.3, 0.5], step=0.5, threads=1)


def test_the_tables_hold_every_number_of_figure_4(four):
    table = study_tables(four)["figure4"]
    figure = four["figure4"].to_dataset()
    assert len(table) == figure["outcome"].size
    row = table[(table["restitution"] == 0.6) & (table["spacing"] == "open") & (table["impulse_ratio"] == 0.3)].iloc[7]
    where = {name: row[name] for name in ("secondary_ratio", "intermediate_count", "p")}
    case = figure.sel(restitution=0.6, spacing="open", impulse_ratio=0.3, **where)
    assert row["peak_rotation_ratio"] == case["peak_rotation_ratio"].item()


def test_the_tables_of_figure_5(five):
    tables = study_tables(five)
    assert set(tables) == {"statements", "histories", "half_cycles", "intervals"}
    figure = five["figure5"].to_dataset()
    assert len(tables["histories"]) == figure["rotation_ratio"].size
    assert len(tables["half_cycles"]) == int(np.isfinite(figure["start_velocity"]).sum())
    assert len(tables["intervals"]) == 2 * figure["outcome"].size
    assert tables["statements"]["statement"].tolist() == five["statements"]["statement"].values.tolist()
