"""The overview of a sweep over direction: pairs of channels, their worst directions, the same figures everywhere."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from swept_motions import ACROSS, TOWER, WALL, channel, config, sweep

from rockpulse import DemandSettings, ModelSettings
from rockpulse.assessment.answers import answers_of
from rockpulse.assessment.assessment import assess
from rockpulse.assessment.verdict import verdicts
from rockpulse.models import Outcome
from rockpulse.views.report.verdict import body_table
from rockpulse.views.text import overview as overviews
from rockpulse.views.text.margins import direction_table, smallest_capacities
from rockpulse.views.text.overview import overview


@pytest.fixture(scope="module")
def tree():
    return sweep(channel(90.0), channel(0.0), models=ModelSettings(use=("resonance", "nonlinear")))


def test_the_overview_of_a_sweep_is_one_table_for_each_pair(tree):
    text = overview(tree, whole=True)
    head, tables = text.split("\n\n", 1)
    pair = tables.splitlines()[0]
    assert ": 1 pair, 9 directions, 2 bodies; models:" in head
    assert pair.startswith("CI.CCC..90-0@20190706T031953  PGA ")
    assert "(at 40°)" in pair
    assert tables.partition("Each body")[0].count("  wall") == 1
    assert "H040" not in tables.split("\n\n", 1)[0]
    assert "Median and largest over 9 directions" in text
    assert "OVERTURNS" in text
    assert "upper-bound input" in text


@pytest.mark.slow
def test_of_a_large_sweep_the_worst_pairs_are_shown(monkeypatch):
    records = [channel(azimuth, f"S{k}", id=f"S{k}.{azimuth:g}") for k in range(4) for azimuth in (90.0, 0.0)]
    records = [replace(one, acceleration=one.acceleration * (1 + 0.1 * (k // 2))) for k, one in enumerate(records)]
    tree = sweep(*records, models=ModelSettings(use=("linear",)))
    text = overview(tree, whole=True)
    assert "worst of" not in text
    monkeypatch.setattr(overviews, "WHOLE", 50)
    text = overview(tree, whole=True)
    assert ": 4 pairs, 9 directions, 2 bodies; models: linear" in text
    assert "The worst 3 of 4 pairs of channels:" in text
    assert [f"\nCI.S{k}" in text for k in range(4)] == [False, True, True, True]


def test_a_table_of_a_sweep_marks_a_doubtful_peak_and_says_how_far_was_searched(tree):
    summary, directions = (tree[name].to_dataset().copy(deep=True) for name in ("summary", "directions"))
    assert "peak?" not in direction_table(summary, directions)
    directions["pga_largest"][0] = 60.0
    summary["safety_factor"][:], summary["safe_up_to"][:] = np.inf, 10.0
    directions["smallest_safety_factor"][:], directions["safety_factor_azimuth"][:] = np.inf, np.nan
    text = direction_table(summary, directions)
    assert f"{directions['pair'].values[0]} (peak?)  PGA" in text
    assert "(peak?): a peak above 5 g" in text
    assert next(line for line in text.splitlines() if line.startswith("  wall")).split()[5:7] == [">10", "-"]
    assert ">10: no overturning up to this scale factor" in " ".join(text.split())
    one, other = directions["record_index"].values[0, :2]
    for first, second, shown in ((0.0, 10.0, ">0"), (10.0, 0.0, ">0"), (10.0, np.nan, "none"), (np.nan, 10.0, "none")):
        summary["safe_up_to"][one], summary["safe_up_to"][other] = first, second
        text = direction_table(summary, directions)
        assert next(line for line in text.splitlines() if line.startswith("  wall")).split()[5] == shown


@pytest.mark.sweep
def test_the_overview_of_a_sweep_shows_the_smallest_factor_and_capacity_over_direction():
    demands = (DemandSettings(name="collapse", value=2.5),)
    options = config("sweep", (WALL,), ModelSettings(use=("nonlinear",)), azimuth_step=20.0)
    tree = assess([channel(90.0), channel(0.0)], replace(options, demands=demands))
    summary, directions = tree["summary"].to_dataset(), tree["directions"].to_dataset()
    found = directions.isel(pair=0, block=0, model=0)
    factor, azimuth = found["smallest_safety_factor"].item(), found["safety_factor_azimuth"].item()
    text = overview(tree, whole=True)
    rows = [line.split() for line in text.splitlines() if line.startswith("  wall")]
    assert rows[0][5:7] == [f"{factor:.2f}", f"{azimuth:g}°"]
    assert "SF: smallest scale factor on the record, over direction" in text
    assert "of the pairs, each in its worst direction" in " ".join(text.split())
    capacity = f"{summary['capacity_ratio'].min().item():.2f}"
    assert rows[1][3] == capacity  # behind P and its upper end, without a verdict on one earthquake
    assert rows[2][2:] == [f"{capacity},", capacity]
    assert "SF" not in direction_table(summary.assign(safety_factor=np.nan * summary["safety_factor"]), directions)
    summary["factor_resolved"][int(np.argmin(summary["safety_factor"].values))] = 0
    marked = direction_table(summary, directions)
    assert next(line for line in marked.splitlines() if line.startswith("  wall")).split()[5] == f"{factor:.2f}!"
    lost = int(np.argmax(summary["capacity_ratio"].values[directions["record_index"].values[0]].ravel()))
    directions["record_index"][0, lost] = -1
    assert float(capacity) < 1.0
    tree["directions"] = xr.DataTree(directions)
    assert f"≤{capacity}" in smallest_capacities(answers_of(tree))  # fails whatever the lost one would say
    tree["summary"] = xr.DataTree(summary.assign(capacity_ratio=summary["capacity_ratio"] * 10.0))
    told = " ".join(smallest_capacities(answers_of(tree)).split())
    assert f"≤{10.0 * summary['capacity_ratio'].min().item():.2f}!, -" in told
    assert "because one direction has no result; left out of the median" in told


def capacity_part(text):
    """The table of capacities over demand in an overview, as far as the blank line behind its note."""
    return text[text.index("Capacity (scale factor that overturns x strength") :].split("\n\n")[:3]


@pytest.mark.sweep
def test_all_views_of_a_sweep_tell_the_same_margins(monkeypatch):
    """Over all rotated records of two pairs of different strength the median would be another than over the pairs."""
    records = [channel(azimuth, f"S{k}", across=(1.0 - 0.3 * k) * ACROSS) for k in range(2) for azimuth in (90.0, 0.0)]
    records = [replace(r, acceleration=r.acceleration * (0.7 if r.station == "S1" else 1.0)) for r in records]
    options = config("sweep", (WALL, TOWER), ModelSettings(use=("nonlinear",)), azimuth_step=45.0)
    tree = assess(records, replace(options, demands=(DemandSettings(name="collapse", value=2.5),)))
    answers = answers_of(tree)
    index = tree["directions"]["record_index"].values
    found = []
    for name in ("safety_factor", "capacity_ratio"):
        every = tree["summary"][name].sel(model="nonlinear", block="wall").values.ravel()
        pairs = every[index].min(axis=1)
        assert f"{np.median(every):.2f}" != f"{np.median(pairs):.2f}"
        found.append((f"{pairs.min():.2f}", f"{np.median(pairs):.2f}"))
    (smallest, median), capacities = found
    whole = overview(tree, whole=True)
    assert ", ".join(capacities) in " ".join(whole.split())
    monkeypatch.setattr(overviews, "WHOLE", 1)
    large = overview(tree, whole=True)
    assert "Verdicts, " in large
    assert "Verdicts, " not in whole
    assert capacity_part(large) == capacity_part(whole)
    fallen = (tree["summary"]["outcome"].sel(model="nonlinear", block="wall").values[index] == Outcome.OVERTURNS).any(1)
    blocks = large[large.index("Each body") :].splitlines()
    row = next(line.split() for line in blocks if line.startswith("  wall"))
    assert row[3] == capacities[0]
    assert median == f"{answers.margins()[0].median:.2f}"
    table = body_table(answers, verdicts(answers))
    in_report = next(row for row in table.rows if row[0].text == "wall")
    shown = dict(zip((heading.title for heading in table.headings), in_report, strict=True))
    assert shown["capacity/ demand"].marked == capacities[0]
    assert f"{fallen.sum()} " == f"{answers.overturnings()[0]} "
    assert smallest == f"{answers.margins()[0].smallest:.2f}"


def test_a_sweep_shows_the_smallest_factor_of_ten_percent_with_its_azimuth(tree):
    summary, directions = (tree[name].to_dataset().copy(deep=True) for name in ("summary", "directions"))
    shape = tuple(summary.sizes[dim] for dim in ("record", "block"))
    place = int(directions["record_index"].values[0, 4])
    factor = np.full(shape, 1.7)
    factor[place, 0] = 0.85
    values = {"overturning_probability": np.full(shape, 0.01), "factor_10": factor, "factor_10_low": 0.9 * factor}
    values["overturning_probability"][place, 0] = 0.19
    summary = summary.assign({name: (("record", "block"), table) for name, table in values.items()})
    text = direction_table(summary, directions)
    row = next(line.split() for line in text.splitlines() if line.startswith("  wall"))
    assert row[5:7] == ["0.85", f"{directions['direction_azimuth'].values[4]:g}°"]
    assert "Scale factor at P = 10 %: smallest multiplier on the record, over direction" in " ".join(text.split())
    swept = xr.DataTree.from_dict({"/summary": summary, "/directions": directions})
    (wall, _) = verdicts(answers_of(swept))
    assert wall.share.value == 0.19  # of the worst direction
    mean = directions.assign(overturning_probability_mean=("pair", [0.0]))
    (wall, _) = verdicts(answers_of(xr.DataTree.from_dict({"/summary": summary, "/directions": mean})))
    assert wall.share.value == pytest.approx((8 * 0.01 + 0.19) / 9)
