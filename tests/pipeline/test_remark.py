"""Remarks: the text made of a code and values, which are stored with it."""

import copy
import pickle
from string import Formatter

import pytest

from rockpulse.remark import TEMPLATES, Remark, as_stored, code_of, counted, find, remarked, restored, with_codes

#: Values for what the templates name, by the form that they are shown in.
FORMS = {"": "HNE", "d": 8, "g": 0.25, "f": 1.5, "%": 0.125}
CASES = [
    Remark(code, **{name: FORMS[form[-1:]] for _, name, form, _ in Formatter().parse(template) if name})
    for code, template in TEMPLATES.items()
]


@pytest.mark.parametrize("remark", CASES, ids=TEMPLATES)
def test_a_remark_is_its_text_and_survives_every_copy_and_being_stored(remark):
    assert isinstance(remark, str)
    copies = (pickle.loads(pickle.dumps(remark)), copy.deepcopy(remark), *restored(as_stored([remark])))
    for other in copies:
        assert (other, other.code, other.values) == (remark, remark.code, remark.values)
    assert code_of(str(remark)) == "plain"


def test_remarks_within_remarks_and_other_texts_are_stored_too():
    groups = [Remark("unlifted", names="a"), Remark("no_design", names=Remark("and_more", names="b", count=2))]
    every = [Remark("coverage_unknown", without=Remark("not_judged", groups=groups)), "another"]
    found, text = restored(as_stored(every))
    assert str(found) == str(every[0])
    assert str(found).endswith("not judged: a (lifts no block), b and 2 more (the others alone make no design)")
    assert found.values["without"].values["groups"][1].values["names"].code == "and_more"
    assert (text.code, str(text)) == ("plain", "another")
    assert restored("") == []
    assert [str(counted(count, "event")) for count in (1, 2)] == ["1 event", "2 events"]


def test_a_remark_on_another_record_has_both_codes():
    inner = Remark("clipped", count=5, end="largest")
    for remark, code in (
        (Remark("of_vertical", remark=inner), "of_vertical/clipped"),
        (Remark("of_channel", channel="HNE", remark=inner), "of_channel/clipped"),
        (Remark("of_vertical", remark="another"), "of_vertical/plain"),
    ):
        assert remark.code == code
        assert remark.values["remark"] == remark.partition(": ")[2]
    assert find([Remark("of_vertical", remark=inner)], "clipped") is None
    assert find(["another", inner], "clipped") is inner


def test_codes_stand_beside_the_lines_of_the_texts():
    remarks = ["two\nlines", "", Remark("of_vertical", remark=Remark("vertical_missing")), Remark("dead_channel")]
    text, codes = with_codes(remarks)
    assert text.splitlines() == ["two", "lines", *map(str, remarks[2:])]
    assert codes.split() == ["plain", "plain", "of_vertical/vertical_missing", "dead_channel"]
    assert remarked(codes, "vertical_missing")
    assert remarked(codes, "clipped", "dead_channel")
    assert not remarked(codes, "clipped", "dead")
    assert with_codes([]) == ("", "")
