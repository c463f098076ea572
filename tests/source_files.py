"""Write records as files and zip archives, and summarise what was read."""

import zipfile

from record_writers import at2, pulse

ONE = at2(pulse())
TWO = at2(pulse(peak=0.2))
VELOCITY = at2(pulse(), series="VELOCITY TIME SERIES IN UNITS OF CM/S")


def ids(records) -> list[str]:
    return [record.id for record in records]


def kinds(failures) -> list[tuple[str, str]]:
    return [(failure.file.rpartition("/")[2], failure.kind) for failure in failures]


def make_zip(path, **members):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in members.items():
            target.writestr(name.replace("__", "/").replace("_dot_", "."), content)
    return path
