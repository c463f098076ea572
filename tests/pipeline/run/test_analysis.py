"""The runner in memory, on an analysis that measures the largest acceleration of every motion."""

from dataclasses import replace
from datetime import UTC, datetime
from types import MappingProxyType

import numpy as np
import pytest
import xarray as xr

from rockpulse.config.configuration import Config
from rockpulse.config.settings import ConditioningSettings, RecordSettings
from rockpulse.errors import ConfigError, Failure, TooWeak
from rockpulse.readers import UNITS
from rockpulse.record.record import Record
from rockpulse.run.analysis import Analysis, run
from rockpulse.storage.variables import failure_table
from rockpulse.views.shared.files_used import failure_rows

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
    empty_part = MappingProxyType(
        {"record": np.zeros(0, dtype=str), "event": np.zeros(0, dtype=str), "pga": np.zeros(0)}
    )

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


def test_a_channel_that_cannot_be_conditioned_is_a_row_of_the_analysis():
    config = Config(conditioning=ConditioningSettings(lowpass_hz=80.0))  # above the Nyquist frequency
    (row,) = run(Largest(config), RECORDS[2:3]).attrs["failures"]
    assert (row.file, row.stage, row.kind) == ("b.txt", "measure", "failed")
    assert "50 Hz of b, got 80.0" in row.reason


def seen(records, **settings):
    """Ids of the motions that were worked on, and (file, stage, kind, reason) of the rows."""
    found = run(Largest(Config(records=RecordSettings(**settings))), records).attrs
    names = [str(part["record"][0]) for part in found["parts"]]
    return names, [(row.file, row.stage, row.kind, row.reason) for row in found["failures"] if row.kind == "failed"]


def test_a_peak_above_five_g_does_not_count_before_it_is_confirmed():
    odd = record("XX.A..HNE@20230206T011732", 611.0, source_unit="g", unit_factor=9.80665)
    names, ((file, stage, kind, reason),) = seen([odd, record("b", 49.0)])
    assert names == ["b"]
    assert (file, stage, kind) == (odd.source, "measure", "failed")
    assert reason == (
        "XX.A..HNE@20230206T011732: peak 62.3 g if the unit is g; 0.0635 g if it is cm/s2 or "
        "0.00635 g if it is mm/s2; a peak above 5 g after conditioning is rejected unless it is confirmed: "
        "correct the unit (--units, units under [records] or [[records.file]], or the file), or, if it is right, give "
        '--confirm XX.A..HNE@20230206T011732, or confirm = ["XX.A..HNE@20230206T011732"] under [records]'
    )
    assert seen([odd], confirm=("XX.A*",)) == ([odd.id], [])
    with pytest.raises(ConfigError, match=r"confirm: no record id matches XX.A; the ids are XX.A\.\."):
        seen([odd], confirm=("XX.A",))


def test_a_large_offset_that_conditioning_takes_away_is_no_doubt():
    offset = Record(60.0 + np.sin(np.arange(100.0)), dt=0.01, id="offset", processed=False)
    assert seen([offset])[0] == ["offset"]


def test_a_vertical_channel_above_five_g_keeps_its_neighbours_from_counting_where_it_acts():
    near = {"station": "A", "source": "a.txt", "start_time": datetime(2023, 2, 6, tzinfo=UTC)}
    east = replace(record("a.E", 2.0), **near, channel="HNE", orientation="horizontal", azimuth=90.0)
    up = replace(record("a.Z", 60.0), **near, channel="HNZ", orientation="vertical")
    assert seen([east, up]) == (["a.E"], [])
    apart = [east, replace(up, source="up.txt")]
    names, (row, beside) = seen(apart, include_vertical=True)
    assert (names, row[0]) == ([], "up.txt")
    assert beside == (
        "a.txt",
        "measure",
        "failed",
        "a.E: left out together with a.Z, whose peak of 6.12 g has not been confirmed",
    )
    assert row[3].startswith("a.E: its vertical channel a.Z: peak 6.1")
    assert seen([east, up], include_vertical=True, confirm=("a.Z",)) == (["a.E"], [])


def pair(first, second):
    near = {"station": "A", "source": "a.txt", "start_time": datetime(2023, 2, 6, tzinfo=UTC)}
    east = replace(record("a.E", first), **near, channel="HNE", orientation="horizontal", azimuth=90.0)
    return [east, replace(record("a.N", second), **near, channel="HNN", orientation="horizontal", azimuth=0.0)]


def test_a_pair_counts_where_each_channel_above_five_g_is_confirmed():
    turned = {"components": "azimuth", "azimuth": 0.0}
    names, rows = seen(pair(60.0, 20.0), **turned)
    name = ".A..HNE-HNN@20230206T000000"
    assert (names, [row[3][:40] for row in rows]) == ([], [f"{name}: a.E: peak 6", f"{name}: a.N: left o"])
    rows = seen(pair(60.0, 60.0), **turned, confirm=("a.E",))[1]
    assert [row[3][:33] for row in rows] == [f"{name}: a.N:", f"{name}: a.E:"]
    assert rows[1][3].startswith(f"{name}: a.E: left out together with a.N, whose peak of 6.1")
    assert len(seen(pair(60.0, 60.0), **turned, confirm=("a.?",))[0]) == 1


def test_a_pair_that_only_its_turning_brings_above_five_g_needs_both_confirmed():
    swept = {"components": "sweep", "azimuth_step": 45.0}
    names, (row,) = seen(pair(40.0, 40.0), **swept)
    assert names == []
    assert row[3].startswith(".A..HNE-HNN@20230206T000000: peak 5.77 g, turned to 45 degrees; a peak above 5 g")
    assert 'give --confirm a.E --confirm a.N, or confirm = ["a.E", "a.N"] under [records]' in row[3]
    assert "give --confirm a.N, or" in seen(pair(40.0, 40.0), **swept, confirm=("a.E",))[1][0][3]
    (left,) = run(Largest(Config(records=RecordSettings(**swept))), pair(40.0, 40.0)).attrs["failures"]
    assert [(one.key, one.choices) for one in left.remedies] == [("units", tuple(UNITS)), ("confirm", ("a.E", "a.N"))]
    assert failure_rows(xr.DataTree.from_dict({"/failures": failure_table([left])})) == [left]
    assert len(seen(pair(40.0, 39.0), **swept, confirm=("a.*",))[0]) == 3  # at 135 degrees nothing is left
    assert len(seen(pair(40.0, 10.0), **swept)[0]) == 4
