"""docs/validation.md: every row has a source and a test that exists."""

import re
from pathlib import Path

TOP = Path(__file__).parents[2]


def rows():
    first = (TOP / "docs" / "validation.md").read_text(encoding="utf-8").partition("\n## ")[0]
    table = [line for line in first.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in table[2:]]


def test_every_row_names_a_test_that_exists():
    for row in rows():
        found = re.fullmatch(r"`(tests/[\w/]+\.py)::(test_\w+)`", row[-1])
        assert found, row
        assert f"def {found[2]}(" in (TOP / found[1]).read_text(encoding="utf-8"), row


def test_there_are_rows_and_sources_enough_and_each_has_a_verdict():
    found = rows()
    assert len(found) >= 12
    assert all(len(row) == 6 and all(row) for row in found)
    assert len({row[1].split(",")[0].split()[0] for row in found}) >= 6
