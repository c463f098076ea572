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
