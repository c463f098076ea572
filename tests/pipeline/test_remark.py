"""Remarks: the text made of a code and values, and the code found in the texts of before."""

import copy
import pickle
from string import Formatter

import pytest

from rockpulse.remark import TEMPLATES, Remark, code_of, find, recognised, remarked, with_codes

#: Values for what the templates name.
VALUES = {
    **dict.fromkeys(("count", "counts", "part"), 8),
    **dict.fromkeys(("stated", "found", "peak", "interval", "velocity", "pgv", "factor", "low", "high"), -1.0 / 3.0),
    "share": 12.5,
    "sense": "less",
    "told": "an azimuth of 0 degrees",
    "missing": 1.23456e-7,
    "end": "largest",
    "unit": "g",
    "readings": "0.344 g if it were cm/s2 or 0.0344 g if it were mm/s2",
    "reason": "CI.CLC..HNE: 3 half-waves, a sequence needs at least 5; leave the record out",
    "record": "CI.CLC..Up@20190706T031608",
    "channel": "HNE",
    "remark": Remark("clipped", count=5, end="smallest"),
}
CASES = [
    Remark(code, **{name: VALUES[name] for _, name, _, _ in Formatter().parse(template) if name})
    for code, template in TEMPLATES.items()
]


@pytest.mark.parametrize("remark", CASES, ids=TEMPLATES)
def test_a_remark_is_its_text_survives_every_copy_and_is_found_in_its_text(remark):
    assert isinstance(remark, str)
    for other in (pickle.loads(pickle.dumps(remark)), copy.deepcopy(remark), recognised(remark)):
        assert other == remark
        assert (other.code, other.values) == (remark.code, remark.values)
    found = recognised(str(remark))
    assert found == remark
    assert code_of(found) == remark.code
    assert code_of(str(remark)) == "plain"


def test_numbers_are_found_with_the_digits_that_are_shown():
    drift = recognised(str(Remark("baseline_drift", velocity=-0.123456, pgv=1234.5)))
    assert drift.values == {"velocity": -0.123, "pgv": 1230.0}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "line 361: 2 rows beyond the declared count were left out",
        "HNE: 3 rows beyond",
        "many samples in a row at the largest value: the record may be clipped",
        "8 samples in a row at the largest value: the record may be clipped, or not",
        "baseline drift: the ground velocity ends at 0.33333 m/s, the PGV of 1 m/s may be off by as much; compare with "
        "another baseline or a high-pass",
    ],
)
def test_other_texts_stay_what_they_are(text):
    assert recognised(text) is text


def test_a_remark_on_another_record_has_both_codes():
    inner = Remark("clipped", count=5, end="largest")
    for remark, code in (
        (Remark("of_vertical", remark=inner), "of_vertical/clipped"),
        (Remark("of_channel", channel="HNE", remark=inner), "of_channel/clipped"),
        (Remark("of_vertical", remark="another"), "of_vertical/plain"),
    ):
        assert remark.code == code == code_of(recognised(str(remark)))
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
