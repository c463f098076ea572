"""Warnings: the text made of a code and values, which are stored with it."""

import copy
import pickle
from string import Formatter

import pytest

from rockpulse.warning_text import (
    TEMPLATES,
    WarningText,
    as_stored,
    code_of,
    counted,
    find,
    has_warning,
    restored,
    with_codes,
)

#: Values for what the templates name, by the form that they are shown in.
FORMS = {"": "HNE", "d": 8, "g": 0.25, "f": 1.5, "%": 0.125}
CASES = [
    WarningText(code, **{name: FORMS[form[-1:]] for _, name, form, _ in Formatter().parse(template) if name})
    for code, template in TEMPLATES.items()
]


@pytest.mark.parametrize("warning", CASES, ids=TEMPLATES)
def test_a_warning_is_its_text_and_survives_every_copy_and_being_stored(warning):
    assert isinstance(warning, str)
    copies = (pickle.loads(pickle.dumps(warning)), copy.deepcopy(warning), *restored(as_stored([warning])))
    for other in copies:
        assert (other, other.code, other.values) == (warning, warning.code, warning.values)
    assert code_of(str(warning)) == "plain"


def test_warnings_within_warnings_and_other_texts_are_stored_too():
    groups = [counted(1, "record"), WarningText("of_channel", channel="b", warning=WarningText("dead_channel"))]
    every = [WarningText("outside_spectrum", names=groups), "another"]
    found, text = restored(as_stored(every))
    assert str(found) == str(every[0])
    assert str(found).endswith("range of the spectrum: 1 record, b: all samples are equal: a dead channel")
    assert found.values["names"][1].code == "of_channel/dead_channel"
    assert (text.code, str(text)) == ("plain", "another")
    assert restored("") == []
    assert [str(counted(count, "event")) for count in (1, 2)] == ["1 earthquake", "2 earthquakes"]


def test_a_warning_on_another_record_has_both_codes():
    inner = WarningText("clipped", count=5, end="largest")
    for warning, code in (
        (WarningText("of_vertical", warning=inner), "of_vertical/clipped"),
        (WarningText("of_channel", channel="HNE", warning=inner), "of_channel/clipped"),
        (WarningText("of_vertical", warning="another"), "of_vertical/plain"),
    ):
        assert warning.code == code
        assert warning.values["warning"] == warning.partition(": ")[2]
    assert find([WarningText("of_vertical", warning=inner)], "clipped") is None
    assert find(["another", inner], "clipped") is inner


def test_codes_stand_beside_the_lines_of_the_texts():
    warnings = [
        "two\nlines",
        "",
        WarningText("of_vertical", warning=WarningText("vertical_missing")),
        WarningText("dead_channel"),
    ]
    text, codes = with_codes(warnings)
    assert text.splitlines() == ["two", "lines", *map(str, warnings[2:])]
    assert codes.split() == ["plain", "plain", "of_vertical/vertical_missing", "dead_channel"]
    assert has_warning(codes, "vertical_missing")
    assert has_warning(codes, "clipped", "dead_channel")
    assert not has_warning(codes, "clipped", "dead")
    assert with_codes([]) == ("", "")
