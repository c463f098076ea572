"""The text of a site file."""

import re

import numpy as np
import pytest

import rockpulse as rp
from rockpulse.failures import Failure
from rockpulse.models import Block
from rockpulse.settings import CalibrationSettings
from rockpulse.site_overview import site_overview

TIME = 0.01 * np.arange(900)


@pytest.fixture(scope="module")
def tree():
    """Six bursts of six events, and a body that all of them overturn."""
    config = rp.Config(calibration=CalibrationSettings(method="statistics", bootstrap=100))
    records = [
        rp.Record(
            (2.0 + 0.4 * number)
            * np.sin(2.0 * np.pi * TIME * (0.8 + 0.05 * number))
            * np.exp(-(((TIME - 4) / 2) ** 2)),
            dt=0.01,
            id=f"burst{number}",
            event=f"Quake {'ABCDEF'[number] * 3}",
            processed=True,
        )
        for number in range(6)
    ]
    blocks = {"stele": Block(0.1, 1.5), "pier": Block(0.5, 2.0)}
    return rp.calibrate_site(records, config, blocks, failures=[Failure("a.AT2", "read", "why", "failed")])


def test_everything_is_there_and_nothing_is_nan(tree):
    text = site_overview(tree)
    site = tree["site"].to_dataset()
    for words in (
        "FEW RECORDS: 6",
        "6 records of 6 events: Quake AAA (1)",
        "main impulse I [m/s]",
        "correlation of logarithms",
        f"I = {float(site['design'][0]):.3g} m/s",
        "nominal 84 %",
        "stele",
        "OVERTURNS",
        "a.AT2: why",
    ):
        assert words in text, words
    assert not re.search(r"\bnan\b", text, re.I)
    assert max(map(len, text.splitlines())) <= 140


@pytest.mark.parametrize("scaled", ["pga 4 m/s2", "pgv 0.5 m/s", "impulse 0.5 m/s"])
def test_the_target_that_records_are_scaled_to_has_its_unit(tree, scaled):
    tree = tree.copy()
    site = tree["site"].to_dataset()
    tree["site"] = site.assign_attrs(scaled_to=scaled.rpartition(" ")[0])
    assert f", scaled to {scaled}." in " ".join(site_overview(tree).split())


def test_many_blocks_are_told_by_their_extremes(tree):
    site = tree["site"].to_dataset()
    many = site.isel(block=[0, 1] * 10)
    tree = tree.copy()
    tree["site"] = many
    text = site_overview(tree)
    assert "The design overturns 10 of 20 blocks" in text
    assert text.count("stele") <= 1
