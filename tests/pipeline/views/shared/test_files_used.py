"""The files that were used are counted once, in every kind of results, and nothing that failed is passed over."""

import numpy as np
import pytest
import xarray as xr

from rockpulse.errors import Failure
from rockpulse.storage.variables import failure_table
from rockpulse.views.shared.files_used import count_files, files_used


def row(file, kind="failed", reason="", stage="read"):
    return Failure(file, stage, reason or f"{file}: damaged; download it again", kind)


def results(group, sources, rows=(), checksums=None):
    variables = {"source": ("record", np.array(sources))}
    if checksums is not None:
        variables["source_sha256"] = ("record", np.array(checksums))
    return xr.DataTree.from_dict({f"/{group}": xr.Dataset(variables), "/failures": failure_table(rows)})


@pytest.mark.parametrize("group", ["summary", "site", "capacities"])
def test_a_file_is_counted_once_whatever_its_channels(group):
    found = files_used(results(group, ["a", "a", "b"], [row("c"), row("c", reason="c: another reason")]))
    assert found.counted == "2 of 3 files used, 1 not"
    assert found.sentence == "2 of 3 files used, 1 not: damaged (c)."


def test_where_every_file_was_used_nothing_is_said():
    found = files_used(results("summary", ["a", "b"], [row("c", "skipped")]))
    assert (found.counted, found.sentence, found.line) == ("", "", "")


@pytest.mark.parametrize("kind", ["vertical", "structural", "duplicate", "depth"])
def test_a_channel_that_was_read_makes_a_used_file(kind):
    found = files_used(results("summary", ["a"], [row("b", kind), row("c")]))
    assert found.counted == "2 of 3 files used, 1 not"


def test_a_skipped_file_counts_neither_way():
    assert files_used(results("summary", ["a"], [row("b", "skipped"), row("c")])).counted == "1 of 2 files used, 1 not"


def test_a_channel_that_failed_in_a_used_file_is_no_file_but_is_told_in_the_line():
    found = files_used(results("summary", ["a.v1"], [row("a.v1", reason="a.90: too short", stage="assess")]))
    assert (found.counted, found.sentence) == ("1 channel failed", "")
    assert found.line == "failed: too short (a.v1)."
    both = files_used(results("summary", ["a.v1"], [row("a.v1", reason="a.90: too short", stage="assess"), row("b")]))
    assert both.line == "1 of 2 files used, 1 not: damaged (b). also failed: too short (a.v1)."


def test_a_vertical_channel_beside_horizontal_ones_that_failed_makes_no_file_used():
    failed = [row("b.v2", reason=f"b.{code}: peak 9 g", stage="assess") for code in ("0", "90")]
    found = files_used(results("summary", ["a.v1"], [row("b.v2", reason="b.up: vertical", kind="vertical"), *failed]))
    assert found.counted == "1 of 2 files used, 1 not"


def test_a_table_of_earthquakes_is_no_file_of_records():
    reason = "[records] events names records that were not read: x"
    found = files_used(results("summary", ["a"], [row("[records] events", reason=reason, stage="events")]))
    assert found.counted == ""
    assert found.line == f"failed: {reason} ([records] events)."


@pytest.mark.parametrize("option", ["[records] keep", "[records] confirm", "--confirm"])
def test_a_pattern_that_fits_no_record_is_no_file(option):
    reason = f"{option}: no record has an id that fits x; correct it"
    found = files_used(results("summary", ["a"], [row("b"), row(option, reason=reason, stage="select")]))
    assert found.counted == "1 of 2 files used, 1 not"
    assert found.line.endswith(f"also failed: no record has an id that fits x ({option}).")


@pytest.mark.parametrize("name", ["d/c; d.txt", "all.zip!c; d.txt", "c; d.txt"])
def test_a_name_that_holds_the_sign_between_files_is_one_file_at_every_step(name):
    found = files_used(results("summary", ["d/a.txt; d/b.txt"], [row(name, stage="assess")], ["1; 2"]))
    assert found.counted == "2 of 3 files used, 1 not"


def test_a_rotated_pair_has_the_files_of_both_channels():
    rows = [row("n; e", reason="pair: not the same length", stage="rotate"), row("c; d.txt")]
    found = files_used(results("summary", ["e; f", "g; h"], rows, ["1; 2", "3"]))
    # "g; h" has one checksum: it is one file of that name; "c; d.txt" was to be read under that name.
    assert found.counted == "3 of 5 files used, 2 not"
    assert [one.file for one in found.unused] == ["n", "c; d.txt"]
    assert files_used(results("capacities", ["e; f"], [row("c")])).counted == "2 of 3 files used, 1 not"


def test_records_that_do_not_tell_their_file_leave_the_number_of_used_ones_open():
    assert files_used(results("summary", ["", "a"], [row("b")])).counted == "1 file not used"


def test_without_any_record_the_count_is_of_what_failed():
    assert count_files((), [row("a"), row("b")]).sentence == "0 of 2 files used, 2 not: damaged (a, b)."


def test_the_commonest_reasons_come_first_each_with_two_files_and_the_rest_as_a_number():
    rows = [row(f"x/odd{number}", reason=f"x/odd{number}: odd {number}") for number in range(4)]
    rows += [
        row(f"all.zip!sub/m{number}.asc", reason=f"all.zip!sub/m{number}.asc:{number}: cut") for number in range(9)
    ]
    assert count_files(["a"], rows).sentence == (
        "1 of 14 files used, 13 not: cut (9: m0.asc, m1.asc, ...); odd 0 (odd0); odd 1 (odd1); "
        "2 more for other reasons."
    )


def test_a_reason_is_one_short_line_without_the_advice():
    long = f"b: {'many words ' * 40}\nin lines; do this"
    assert "\n" not in (said := count_files((), [row("b", reason=long)]).sentence)
    assert said.endswith(" ... (b).")
    assert len(said) < 170
