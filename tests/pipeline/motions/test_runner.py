"""The runner in memory, on an analysis that measures the largest acceleration of every motion."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from rockpulse.config.configuration import Config
from rockpulse.config.settings import ConditioningSettings
from rockpulse.errors import ConfigError, TooWeak
from rockpulse.failures import Failure
from rockpulse.motions.runner import Analysis, joined, run
from rockpulse.record.record import Record

UNREAD = Failure("gone.txt", "find", "gone.txt: nothing there", "failed")


def largest(motion, watch):
    """The part of a motion; one below 1 m/s2 is too weak, one of NaN is refused."""
    with watch("solve"):
        if motion.record.id == "odd":
            raise ValueError("no number")
        if motion.record.pga < 1.0:
            raise TooWeak(f"{motion.record.id} is weak")
    return {"record": np.array([motion.record.id]), "pga": np.array([motion.record.pga])}


class Largest(Analysis):
    name = "measure"
    doing = "measuring"
    kind = "measure"

    work = staticmethod(largest)

    def collect(self, parts, planned, failures):
        tree = xr.DataTree()
        tree.attrs = {"parts": parts, "planned": [one.name for one in planned], "failures": failures}
        return tree


def record(name, size, **known):
    return Record(size * np.sin(np.arange(100.0)), dt=0.01, id=name, processed=True, source=f"{name}.txt", **known)


RECORDS = [
    record("weak", 0.5, event="Kobe"),
    record("odd", 2.0, event="Maule"),
    record("b", 2.0, event="Kobe"),
    record("a", 3.0, event="Maule"),
    record("up", 3.0, orientation="vertical"),
]


def test_every_motion_gives_a_part_with_its_earthquake_or_a_row_and_the_bar_sees_the_plan():
    seen = []

    def bar(planned):
        for one in planned:
            seen.append(one.name)
            yield one

    found = run(Largest(Config()), RECORDS, [UNREAD], bar).attrs
    assert seen == found["planned"] == ["a", "b", "odd", "weak"]
    assert [(str(part["record"][0]), str(part["event"][0])) for part in found["parts"]] == [
        ("a", "Maule"),
        ("b", "Kobe"),
    ]
    assert [(row.file, row.stage, row.kind) for row in found["failures"]] == [
        ("gone.txt", "find", "failed"),
        ("up.txt", "select", "vertical"),
        ("odd.txt", "measure", "failed"),
        ("weak.txt", "measure", "skipped"),
    ]
    assert [row.reason for row in found["failures"][2:]] == ["odd: no number", "weak is weak"]


def test_the_order_of_the_records_counts_only_where_the_analysis_says_so(monkeypatch):
    monkeypatch.setattr(Largest, "in_order_of_ids", False)
    assert run(Largest(Config()), RECORDS).attrs["planned"] == ["weak", "odd", "b", "a"]


def test_a_channel_that_cannot_be_conditioned_is_a_row_of_the_analysis():
    config = Config(conditioning=ConditioningSettings(lowpass_hz=80.0))  # above the Nyquist frequency
    (row,) = run(Largest(config), RECORDS[2:3]).attrs["failures"]
    assert (row.file, row.stage, row.kind) == ("b.txt", "measure", "failed")
    assert "50 Hz of b, got 80.0" in row.reason


def test_two_records_of_one_id_are_refused():
    with pytest.raises(ConfigError, match="more than one record with id a"):
        run(Largest(Config()), [RECORDS[3], RECORDS[3]])


def test_parts_are_joined_in_the_order_of_their_ids():
    parts = [{"record": np.array([name]), "pga": np.array([size])} for name, size in (("b", 2.0), ("a", 3.0))]
    found = joined(parts)
    assert {name: values.tolist() for name, values in found.items()} == {"record": ["a", "b"], "pga": [3.0, 2.0]}
