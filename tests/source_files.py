"""Write records as files and zip archives, and summarise what was read."""

import zipfile
from contextlib import nullcontext

import pytest
from record_writers import at2, pulse

ONE = at2(pulse())
TWO = at2(pulse(peak=0.2))
VELOCITY = at2(pulse(), series="VELOCITY TIME SERIES IN UNITS OF CM/S")


def ids(records) -> list[str]:
    return [record.id for record in records]


def kinds(failures) -> list[tuple[str, str]]:
    return [(failure.file.rpartition("/")[2], failure.kind) for failure in failures]


def raises_if(faulty, error, match):
    """``pytest.raises`` if something is faulty; else a block that must not raise."""
    return pytest.raises(error, match=match) if faulty else nullcontext()


def make_zip(path, packing=zipfile.ZIP_DEFLATED, /, **members):
    with zipfile.ZipFile(path, "w", packing) as target:
        for name, content in members.items():
            target.writestr(name.replace("__", "/").replace("_dot_", "."), content)
    return path
