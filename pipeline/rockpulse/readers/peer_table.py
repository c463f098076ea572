"""PEER's list of what a search found, ``_SearchResults.csv``, which its database puts beside the AT2 files.

Below lines about the search a row of headings, "Record Sequence Number" among them, begins the table of the records:
one row each, with the names of its files. Spectra follow. Rjb and Rrup are distances to the rupture, not to the
epicentre, and are not used.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import lru_cache

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers.facts import NOTHING, Facts, stated
from rockpulse.readers.fields import text_lines
from rockpulse.readers.source import SourceFile

__all__ = ["Listed", "listed"]

_NAME = "_SearchResults.csv"
_FIRST = "record sequence number"


@dataclass(frozen=True)
class Listed:
    """What the list says of a record; fields as of `Record`."""

    event: str = ""
    station_name: str = ""
    facts: Facts = NOTHING


def listed(file: SourceFile) -> tuple[Listed, list[str]]:
    """The row of a file in the list beside it, by its name, and a warning where there is a list that cannot be read."""
    try:
        content = file.beside(_NAME)
        rows = {} if content is None else _rows(content)
    except (RockpulseError, OSError) as fault:
        return Listed(), [f"{_NAME} beside the file cannot be read, magnitude and Vs30 stay unknown: {fault}"]
    return rows.get(file.path.name.lower(), Listed()), []


@lru_cache(maxsize=4)
def _rows(content: bytes) -> dict[str, Listed]:
    """The rows of the list by the names of their files, in lower letters; one list serves all files of a folder."""
    found: dict[str, Listed] = {}
    heads: list[str] = []
    try:
        for row in csv.reader(text_lines(content), skipinitialspace=True):
            cells = [cell.strip() for cell in row]
            if not heads:
                heads = [cell.lower() for cell in cells] if _FIRST in map(str.lower, cells) else []
                continue
            if len(cells) < len(heads) or not any(cells):
                break
            entries = dict(zip(heads, cells, strict=False))
            names = [value for head, value in entries.items() if "filename" in head.replace(" ", "")]
            found |= {name.replace("\\", "/").rpartition("/")[2].lower(): _listed(entries) for name in names}
    except csv.Error as fault:
        raise RecordFormatError(f"{_NAME}: cannot be read as CSV: {fault}; download it again") from fault
    return found


def _listed(entries: dict[str, str]) -> Listed:
    vs30 = next((value for head, value in entries.items() if head.startswith("vs30")), "")
    return Listed(
        event=" ".join(filter(None, (entries.get("earthquake name"), entries.get("year")))),
        station_name=entries.get("station name", ""),
        facts=stated(magnitude=(entries.get("magnitude", ""), ""), vs30=vs30),
    )
