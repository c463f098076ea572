"""``rockpulse formats``."""

from rockpulse.cli import main
from rockpulse.readers import FORMATS, UNITS


def test_every_format_and_every_unit_is_listed(capsys):
    assert main(["formats"]) == 0
    out = capsys.readouterr().out
    lines = out.splitlines()
    read = [row for row in FORMATS if row.unit != "-"]
    assert read
    for row in read:
        assert any(line.startswith(f"{row.name} ") and row.unit in line for line in lines), row.name
    for row in FORMATS:
        assert " ".join(row.what.split()) in " ".join(out.split())
    assert all(unit in lines[-1] for unit in UNITS)
