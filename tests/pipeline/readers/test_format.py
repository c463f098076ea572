"""Which files a pattern of the options of reading chooses."""

import math

import pytest

from rockpulse.errors import ConfigError, RockpulseError
from rockpulse.readers.format import FileSettings, ReadOptions, same_step
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
        ("sub/ARL.g3", "old.zip!sub/ARL.g3", True),
        ("new.zip", "old.zip!new.zip.g3", False),
        ("*.g3", "old.zip.gz!ARL.G3", False),
        ("ARL.g3", "columns/ARL.g3.gz", True),
        ("ARL.g3", "columns/ARL.g3.GZ", True),
        ("ARL.g", "columns/ARL.g3", False),
        ("old.zip", "old.zip.gz!ARL.g3", True),
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


@pytest.mark.parametrize(
    ("unit", "dt", "fits"),
    [
        ("gal", None, True),
        ("mm/s2", None, False),
        (None, 0.01001, True),
        (None, 0.0100101, False),
        (None, 0.0099, False),
    ],
)
def test_a_row_may_spell_a_unit_otherwise_and_print_fewer_digits(unit, dt, fits):
    record = Record([0.0, 1.0, 0.0], dt=0.01, id="x", source="x.v1", source_unit="cm/s2")
    options = ReadOptions(files=(FileSettings(match="*", units=unit, dt=dt),))
    if fits:
        options.check([record])
        return
    with pytest.raises(RockpulseError, match=r"x\.v1: the file states .*correct the wrong one, or the pattern"):
        options.check([record])


def test_intervals_of_few_digits_are_one():
    assert [same_step(steps) for steps in ([1.0, 1.001], [1.0011, 1.0], [0.5])] == [True, False, True]


def test_the_options_of_one_file_are_those_of_the_last_row_that_gives_them():
    first, second = FileSettings(match="*.a", units="g", dt=0.5), FileSettings(match="*.a", units="cm/s2")
    third, other = FileSettings(match="*.a", units="m/s2", dt=0.25), FileSettings(match="*.b", dt=2.0)
    options = ReadOptions("mm/s2", 0.125, files=(third, first, second, other))
    found = [options.of_file(f"folder/x.{end}") for end in "abc"]
    assert [(one.units, one.dt) for one in found] == [("cm/s2", 0.5), ("mm/s2", 2.0), ("mm/s2", 0.125)]
    assert [one.files for one in found] == [(first, second), (other,), ()]
    assert [one.said_by("units") for one in found] == [second.where, "the option units", "the option units"]
    assert [one.said_by("dt") for one in found] == [first.where, other.where, "the option dt"]
    assert [one.advice("dt") for one in found[:2]] == ["correct the wrong one, or the pattern"] * 2
    assert "--dt 0.125 is meant for other files" in found[2].advice("dt")
    assert "--units mm/s2 is meant for other files" in found[2].advice("units")
    plain = ReadOptions("g", 0.5)
    assert plain.of_file("x.a") is plain


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({}, "expected units, dt or both, found neither"),
        ({"units": "stone"}, r"option units of \[\[records.file\]\] match = .x.: unknown unit"),
        ({"dt": 0.0}, "dt"),
        ({"match": " ", "units": "g"}, "a pattern that is not empty"),
        ({"match": 3, "units": "g"}, "a pattern that is not empty"),
    ],
)
def test_a_row_that_says_nothing_or_no_sense_is_refused(row, message):
    with pytest.raises(ConfigError, match=message):
        FileSettings(**{"match": "x"} | row)


def test_a_way_to_remove_the_response_is_one_of_two():
    assert [ReadOptions(response=way).response for way in ("sensitivity", "remove")] == ["sensitivity", "remove"]
    with pytest.raises(ConfigError, match="option response: expected one of sensitivity, remove, found 'none'"):
        ReadOptions(response="none")
