"""The files that were used are counted once, in every kind of results, and what was not used is listed."""

import numpy as np
import pytest
import xarray as xr
from results_tree import results_tree

from rockpulse.errors import NO_RECORD, Failure
from rockpulse.storage.variables import failure_table
from rockpulse.views.shared.files_used import (
    count_files,
    failure_list,
    failure_rows,
    files_used,
    left_out,
    rows_not_used,
)
from rockpulse.warning_text import WarningText, with_codes


def row(file, kind="failed", reason="", stage="read"):
    return Failure(file, stage, reason or f"{file}: damaged; download it again", kind)


def results(group, sources, rows=(), checksums=None):
    variables = {"source": ("record", np.array(sources))}
    if checksums is not None:
        variables["source_sha256"] = ("record", np.array(checksums))
    return xr.DataTree.from_dict({f"/{group}": xr.Dataset(variables), "/failures": failure_table(rows)})


#: Rows of a file with a channel that failed, of a file that failed, and of options.
SHORT = row("a.v1", reason="a.90: too short", stage="assess")
TABLE = row("[records] events", reason="[records] events names records that were not read: x", stage="events")
PATTERN = row("--confirm", reason="--confirm: no record has an id that fits x; correct it", stage="select")
NINE_G = [row("b.v2", reason=f"b.{code}: peak 9 g", stage="assess") for code in ("0", "90")]


@pytest.mark.parametrize("group", ["summary", "site", "capacities"])
@pytest.mark.parametrize(
    ("sources", "rows", "counted", "line"),
    [
        (["a", "b"], [row("c", "skipped")], "", ""),
        (
            ["a", "a", "b"],
            [row("c"), row("c", reason="c: other")],
            "2 of 3 files used (1 rejected)",
            "{}: damaged (c).",
        ),
        *(
            (["a"], [row("b", kind), row("c")], "2 of 3 files used (1 rejected)", "{}: damaged (c).")
            for kind in ("vertical", "structural", "duplicate", "depth")
        ),
        (["a"], [row("b", "skipped"), row("c")], "1 of 2 files used (1 rejected)", "{}: damaged (c)."),
        (["a.v1"], [SHORT], "1 channel failed", "failed: too short (a.v1)."),
        (["a"], [TABLE], "", "failed: [records] events names records that were not read: x ([records] events)."),
        (
            ["a"],
            [row("b"), PATTERN],
            "1 of 2 files used (1 rejected)",
            "{}: damaged (b). also failed: no record has an id that fits x (--confirm).",
        ),
        # a vertical channel beside horizontal ones that failed makes no file used
        (["a"], [row("b.v2", kind="vertical"), *NINE_G], "1 of 2 files used (1 rejected)", "{}: peak 9 g (b.v2)."),
        (["", "a"], [row("b")], "1 file could not be used", "{}: damaged (b)."),  # records that do not tell their file
    ],
)
def test_files_are_counted_once_and_nothing_that_failed_is_passed_over(group, sources, rows, counted, line):
    found = files_used(results(group, sources, rows))
    assert (found.counted, found.line) == (counted, line.format(counted))


@pytest.mark.parametrize("name", ["d/c; d.txt", "all.zip!c; d.txt", "c; d.txt"])
def test_a_name_that_holds_the_sign_between_files_is_one_file_at_every_step(name):
    found = files_used(results("summary", ["d/a.txt; d/b.txt"], [row(name, stage="assess")], ["1; 2"]))
    assert found.counted == "2 of 3 files used (1 rejected)"


def test_a_rotated_pair_has_the_files_of_both_channels():
    rows = [row("n; e", reason="pair: not the same length", stage="rotate"), row("c; d.txt")]
    found = files_used(results("summary", ["e; f", "g; h"], rows, ["1; 2", "3"]))
    # "g; h" has one checksum: it is one file of that name; "c; d.txt" was to be read under that name.
    assert found.counted == "3 of 5 files used (2 rejected)"
    assert [one.file for one in found.unused] == ["n", "c; d.txt"]
    assert files_used(results("capacities", ["e; f"], [row("c")])).counted == "2 of 3 files used (1 rejected)"
    assert count_files((), [row("a"), row("b")]).sentence == "2 files could not be used: damaged (a, b)."


def test_the_commonest_reasons_come_first_each_with_its_files_and_the_rest_as_a_number():
    rows = [row(f"x/odd{number}", reason=f"x/odd{number}: odd {number}") for number in range(4)]
    rows += [
        row(f"all.zip!sub/m{number}.asc", reason=f"all.zip!sub/m{number}.asc:{number}: cut") for number in range(9)
    ]
    assert count_files(["a"], rows).sentence == (
        "1 of 14 files used (13 rejected): cut (m0.asc, m1.asc, m2.asc, m3.asc, m4.asc, m5.asc, m6.asc, m7.asc, "
        "m8.asc); odd 0 (odd0); odd 1 (odd1); 2 for other reasons."
    )
    long = f"b: {'many words ' * 40}\nin lines; do this"
    assert "\n" not in (said := count_files((), [row("b", reason=long)]).sentence)
    assert said.endswith(" ... (b).")
    assert len(said) < 170


def test_left_out_lists_by_kind_with_the_failed_first_and_warnings_with_their_block():
    lines = left_out(results_tree()).splitlines()
    assert lines[0] == "failed: 1"
    assert lines[1] == "  cut.AT2:4: expected 100 samples, found 3"
    assert "read, not assessed (vertical): 1" in lines
    assert "  CCC.RAW: vertical channel 2" in lines
    assert [line for line in lines if line.startswith("records with warnings: 1 ")]
    assert "cabinet: slenderness 2.5 is below 3" in left_out(results_tree())


def test_a_long_list_of_what_is_no_failure_is_cut_and_says_so():
    tree = results_tree()
    names = [f"n{number}" for number in range(40)]
    rows = [Failure(f"{name}.AT2", "read", f"{name}.AT2:4: expected {name}", "failed") for name in names]
    rows += [Failure(f"{name}.VT2", "read", f"{name}.VT2:4: velocity {name}", "skipped") for name in names]
    tree["failures"] = xr.DataTree(failure_table(rows))
    text = left_out(tree)
    assert text.count("AT2:4: expected n") == 40
    assert text.count("VT2:4: velocity n") == 12
    assert "  and 28 more (rockpulse inspect RESULTS --failures)" in text.splitlines()
    brief = left_out(tree, brief=True)
    assert [brief.count(words) for words in ("AT2:4: expected n", "VT2:4: velocity n")] == [12, 3]


def test_one_reason_of_many_files_is_told_once_with_their_number_and_ten_of_them():
    names = [f"campaign/m{number:02}.asc" for number in range(24)]
    reason = "no reader recognises the file; convert it"
    rows = [Failure(name, "read", f"{name}: {reason}", "failed") for name in names]
    rows.insert(3, Failure("cut.AT2", "read", "cut.AT2:4: truncated", "failed"))
    tree = results_tree()
    tree["failures"] = xr.DataTree(failure_table(rows))
    told = f"24 files ({', '.join(names[:10])} and 14 more): {reason}"
    lines = left_out(tree).splitlines()
    assert lines[0] == "failed: 25"
    assert " ".join(" ".join(lines).split()).startswith(f"failed: 25 {told} cut.AT2:4: truncated")
    assert f"failed (read) {told}" in " ".join(rows_not_used(failure_rows(tree)).split())
    assert len(failure_list(tree).splitlines()) == 25


def test_files_that_are_no_records_are_one_line_and_data_that_cannot_be_used_one_each():
    names = ["DISCLAIMER.TXT", *(f"b{k}.zip!sub/n{k}.txt" for k in range(20))]
    rows = [Failure(name, "read", f"{name}: {NO_RECORD}", "skipped") for name in names]
    rows.append(Failure("a.V3", "read", "a.V3:1: expected an accelerogram of station 7, found spectra", "skipped"))
    tree = results_tree()
    told = xr.DataTree.from_dict({"/summary": tree["summary"].to_dataset(), "/failures": failure_table(rows)})
    lines = left_out(told).splitlines()
    at = lines.index("skipped (cannot be used): 1")
    assert lines[at + 1] == "  a.V3:1: expected an accelerogram of station 7, found spectra"
    assert lines[at + 2].startswith("not records: DISCLAIMER.TXT, n0.txt, n1.txt")
    assert "and 9 more" in " ".join(lines[at + 2 : at + 4])
    assert "not records: DISCLAIMER.TXT" in rows_not_used(failure_rows(told))
    assert len(failure_list(told).splitlines()) == 22


def warned(*warnings):
    """The tree with these warnings on its three records."""
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    texts, codes = zip(*(with_codes(one) for one in warnings), strict=True)
    summary["warnings"] = summary["warnings"].copy(data=np.array(texts))
    summary["warning_codes"] = summary["warning_codes"].copy(data=np.array(codes))
    return xr.DataTree.from_dict({"/summary": summary, "/failures": tree["failures"].to_dataset()})


def test_one_warning_of_each_kind_is_shown_and_the_others_are_counted():
    peak = "peak {} g if the unit is g; {} g if it is cm/s2"
    told = left_out(warned([peak.format(338, 0.344)], [peak.format(415, 0.42), "clipped for 7 samples"], []))
    assert "records with warnings: 2 " in told
    flat = " ".join(told.split())
    assert f"CI.CCC..HNE@20190706T031953: {peak.format(338, 0.344)}, and 1 more like it" in flat
    assert "415" not in flat
    assert "CI.CCC..HNN@20190706T031953: clipped for 7 samples" in flat
    assert "warnings" not in left_out(warned([], [], []))


def test_warnings_of_one_code_are_alike_whatever_they_name():
    reasons = [f"{name}.1: 1 half-waves in the intense phase" for name in ("first", "second")]
    warnings = [[WarningText("no_sequence", reason=reason), "another"] for reason in reasons]
    flat = " ".join(left_out(warned(*warnings, [WarningText("of_vertical", warning="another")])).split())
    assert f"no impulse sequence: {reasons[0]}, and 1 more like it" in flat
    assert reasons[1] not in flat
    assert ": another, and 1 more like it" in flat
    assert ": vertical channel: another" in flat


@pytest.mark.parametrize(
    ("name", "title"), [("", "read, not assessed (vertical): 1"), ("up", "vertical channels, acting on 2 records: 1")]
)
def test_a_vertical_channel_that_acted_is_reported(name, title):
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    summary["vertical_channel"] = summary["vertical_channel"].copy(data=np.array([name, name, ""]))
    acted = xr.DataTree.from_dict({"/summary": summary, "/failures": tree["failures"].to_dataset()})
    assert title in left_out(acted).splitlines()


def test_what_was_not_used_is_listed_by_kind_and_narrowed_to_one():
    rows = [Failure("up", "assess", "vertical channel", "vertical"), Failure("bad", "read", "truncated", "failed")]
    assert rows_not_used(rows) == "failed (read) bad: truncated"
    assert failure_list(results_tree()).splitlines()[0] == "failed (read) cut.AT2:4: expected 100 samples, found 3"
