"""Which files a pattern of the options of reading chooses."""

import math

import pytest

from rockpulse.errors import ConfigError, RockpulseError
from rockpulse.readers.format import FileSettings, ReadOptions
from rockpulse.record.record import Record


@pytest.mark.parametrize(
    ("pattern", "name", "chosen"),
    [
        ("ARL [1].g3", "columns/ARL [1].g3", True),
        ("ARL [1].g3", "columns/ARL 1.g3", False),
        ("*[[]1].g3", "columns/ARL [1].g3", False),
        ("site 2\\*.g3", "site 2/ARL.g3", True),
        ("./columns/*.g3", "columns/ARL.g3", True),
        (".\\columns\\?RL.g3", "columns/ARL.g3", True),
        ("./columns/*.g3", "other/ARL.g3", False),
        ("old.zip", "old.zip!sub/ARL.g3", True),
    ],
)
def test_a_pattern_has_no_signs_but_those_that_the_manual_names(pattern, name, chosen):
    assert FileSettings(match=pattern, units="g").chooses(name) == chosen


@pytest.mark.parametrize("dt", [0.0, -0.01, math.nan, math.inf, "0.01"])
def test_an_interval_that_is_none_is_refused(dt):
    with pytest.raises(ConfigError, match="option dt: expected a sampling interval in s above 0"):
        ReadOptions(dt=dt)


def test_a_row_is_held_against_what_the_file_says_of_that_property_alone():
    record = Record([0.0, 1.0, 0.0], dt=0.01, id="x", source="x.v1", source_unit="g")
    ReadOptions(files=(FileSettings(match="*", dt=0.01),)).check([record])
    ReadOptions(files=(FileSettings(match="*", units="g"),)).check([record])
    for row in (FileSettings(match="*", dt=0.02), FileSettings(match="*", units="cm/s2")):
        with pytest.raises(RockpulseError, match=r"x\.v1: "):
            ReadOptions(files=(row,)).check([record])
