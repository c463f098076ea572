"""Write records as files and zip archives, and summarise what was read."""

import io
import zipfile
from contextlib import nullcontext

import pytest
from record_writers import at2, pulse

from rockpulse.readers import read
from rockpulse.record.record import Record

ONE = at2(pulse())
TWO = at2(pulse(peak=0.2))
VELOCITY = at2(pulse(), series="VELOCITY TIME SERIES IN UNITS OF CM/S")


def ids(records) -> list[str]:
    return [record.id for record in records]


def kinds(failures) -> list[tuple[str, str]]:
    return [(failure.file.rpartition("/")[2], failure.kind) for failure in failures]


def got(content: bytes) -> list[Record]:
    """The records of a file in memory."""
    return read(io.BytesIO(content))


def got_one(content: bytes) -> Record:
    """The only record of a file in memory."""
    (record,) = got(content)
    return record


def raises_if(faulty, error, match):
    """``pytest.raises`` if something is faulty; else a block that must not raise."""
    return pytest.raises(error, match=match) if faulty else nullcontext()


def make_zip(path, packing=zipfile.ZIP_DEFLATED, /, **members):
    with zipfile.ZipFile(path, "w", packing) as target:
        for name, content in members.items():
            target.writestr(name.replace("__", "/").replace("_dot_", "."), content)
    return path
