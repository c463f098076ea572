"""``rockpulse formats``."""

from rockpulse.cli import main
from rockpulse.readers import FORMATS, UNITS


def test_every_format_and_every_unit_is_listed_within_a_hundred_columns(capsys):
    assert main(["formats"]) == 0
    out = capsys.readouterr().out
    read, _, refused = out.partition("Recognised but not read")
    words = " ".join(read.split())
    rows = [row for row in FORMATS if row.unit != "-"]
    assert rows
    for row in rows:
        entry = (
            f"{row.name} - {row.what} recognised by: {row.recognised} "
            f"unit: {row.unit}; corrected: {row.processed}; such as {row.example}"
        )
        assert " ".join(entry.split()) in words
    for row in FORMATS:
        if row not in rows:
            assert f"{row.name} - {' '.join(row.what.split())}" in " ".join(refused.split())
    assert all(unit in out.splitlines()[-1] for unit in UNITS)
    assert max(map(len, out.splitlines())) <= 100
