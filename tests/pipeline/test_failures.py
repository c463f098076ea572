"""Reasons that are told once, whatever file, line or record they are about."""

import pytest

from rockpulse.errors import Failure, alike, reasons_in_words


def failed(file, reason, stage="read"):
    return Failure(file, stage, reason, "failed")


@pytest.mark.parametrize(
    ("file", "reason", "place", "bare"),
    [
        ("a.AT2", "a.AT2: damaged: cut", "a.AT2", "damaged: cut"),
        ("a.AT2", "a.AT2:42: expected 3", "a.AT2:42", "expected 3"),
        ("all.zip!sub/a.AT2", "all.zip!sub/a.AT2:4: expected 3", "all.zip!sub/a.AT2:4", "expected 3"),
        ("a.AT2", "a.090: too short", "a.090", "too short"),
        ("a.AT2", "out of memory: use fewer", "a.AT2", "out of memory: use fewer"),
        ("x/a.AT2", "[Errno 13] Permission denied: 'x/a.AT2'", "x/a.AT2", "[Errno 13] Permission denied"),
    ],
)
def test_a_reason_is_bare_without_what_it_is_about(file, reason, place, bare):
    row = failed(file, reason)
    assert (row.place, row.bare) == (place, bare)


def test_rows_of_one_reason_are_one_group_where_the_first_of_them_stands():
    rows = [failed("a", "a:3: cut"), failed("b", "b: no unit"), failed("c", "c:9: cut")]
    assert alike(rows) == [[rows[0], rows[2]], [rows[1]]]
    assert [reasons_in_words(group) for group in alike(rows)] == ["2 files (a:3, c:9): cut", "b: no unit"]


def test_channels_of_one_file_are_counted_as_channels():
    rows = [failed("a.v1", f"a.{number}: too short", "assess") for number in range(3)]
    assert reasons_in_words(rows) == "3 channels (a.0, a.1, a.2): too short"


def test_a_single_reason_that_does_not_name_its_file_gets_it():
    assert reasons_in_words([failed("a.AT2", "out of memory")]) == "a.AT2: out of memory"
    assert reasons_in_words([failed("a.AT2", "cannot open 'a.AT2'")]) == "cannot open 'a.AT2'"
