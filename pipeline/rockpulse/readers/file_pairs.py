"""Pairs of files with the two horizontal components of one recording, for files that state no direction."""

import math
import os
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import MISSING, dataclass, replace
from pathlib import Path

from rockpulse.errors import ConfigError, Failure, RecordFormatError, Remedy, some, stored_remedies
from rockpulse.option import KeyType, Section, key
from rockpulse.readers.kit.spacing import same_step
from rockpulse.record.record import Record
from rockpulse.warning_text import WarningText

_NAME = KeyType(
    "the name of one file, without wildcards",
    lambda value: isinstance(value, str) and bool(value.strip()) and not set("*?") & set(value),
    str,
)
#: Directions of the two files, clockwise from north [degrees], and tolerance of a direction that a file states.
SIDES = {"north": 0.0, "east": 90.0}
SAME_LINE = 5.0
#: Remedy for a file without a partner, or with a wrong one.
PAIR = Remedy("pair")


@dataclass(frozen=True)
class PairSettings(Section):
    """Two files with the horizontal components of one recording, one in each; section [[records.pair]] in TOML.

    The channels get the directions north and east, and are used as a pair that one instrument recorded in one
    earthquake. If the true directions are unknown, the two axes of the instrument may be called north and east.

    Attributes
    ----------
    north, east : str
        Name, or end of the path, of a file or of a member of a zip archive, such as ``a.csv`` or ``hall/a.csv``.

    Raises
    ------
    ConfigError
        For an empty name, a wildcard, or the same name twice.

    Examples
    --------
    >>> pair = PairSettings(north="120111.txt", east="120112.txt")
    >>> pair.side("far_field.zip!120112.txt"), pair.side("a.csv")
    ('east', '')
    """

    heading = "[[records.pair]]"
    north: str = key(MISSING, _NAME)
    east: str = key(MISSING, _NAME)

    @property
    def where(self) -> str:
        """Return the text by which messages refer to this section."""
        return f'[[records.pair]] north = "{self.north}"' if isinstance(self.north, str) else self.heading

    def __post_init__(self) -> None:
        super().__post_init__()
        if _plain(self.north) == _plain(self.east):
            raise ConfigError(f'{self.where}: expected two files, found "{self.east}" twice')

    def side(self, name: str) -> str:
        """Return "north" or "east" for a file of this pair, named as in `Record.source`; empty for other files."""
        spellings = path_spellings(name)
        for side in SIDES:
            wanted = _plain(self[side])
            if any(part == wanted or part.endswith(f"/{wanted}") for part in spellings):
                return side
        return ""

    def directed(self, name: str, records: Sequence[Record]) -> list[Record]:
        """Return the channel of a file of this pair with its direction; raise an error if the file contradicts it."""
        side = self.side(name)
        if len(records) != 1:
            raise RecordFormatError(
                f"{name}: expected one channel, because {self.where} calls the file {side}, found {len(records)}; "
                "remove the entry, and state the directions in the headings",
                PAIR,
            )
        (record,) = records
        stated = "" if record.orientation in ("unknown", "horizontal") else f"the orientation {record.orientation}"
        if math.isfinite(record.azimuth):
            off = abs(math.remainder(record.azimuth - SIDES[side], 180.0))
            stated = f"the direction {record.azimuth:g} degrees" if off > SAME_LINE else ""
        if stated:
            raise RecordFormatError(
                f"{name}: the file states {stated}, but {self.where} calls it {side}; correct one of them", PAIR
            )
        record = replace(record, orientation="horizontal", together=f"{self.north} and {self.east}")
        if math.isfinite(record.azimuth):
            return [record]
        given = (*record.warnings, WarningText("direction_given", side=side))
        return [replace(record, azimuth=SIDES[side], warnings=given)]


def _plain(name: str) -> str:
    return name.replace("\\", "/").removeprefix("./")


def path_spellings(name: str) -> list[str]:
    """Return the absolute path of a file; for a member of an archive, also the path of the archive and the path in it.

    Paths that end in ``.gz`` are also returned without this suffix.
    """
    path = Path(os.path.abspath(name)).as_posix().replace("\\", "/")  # noqa: PTH100 - links stay what they are
    archive, _, member = path.partition("!")
    parts = [path, archive, f"/{member}"] if member else [path]
    return parts + [part[:-3] for part in parts if part.lower().endswith(".gz")]


def check_pairs(names: Sequence[str], pairs: Iterable[PairSettings]) -> None:
    """Raise ConfigError unless each name in `pairs` matches exactly one of the files, and no file is in two pairs."""
    taken: dict[str, str] = {}
    for pair in pairs:
        for side in SIDES:
            found = [name for name in names if pair.side(name) == side]
            where = f'[[records.pair]] {side} = "{pair[side]}"'
            if not found:
                advice = "correct the name, or add the folder that contains the file to the paths of the command"
                raise ConfigError(f"{where}: no such file among the files to read ({len(names)} in all); {advice}")
            if len(found) > 1:
                several = f"{len(found)} files have this name: {some(found, 2)}"
                raise ConfigError(f"{where}: {several}; give a longer part of the path")
            if found[0] in taken:
                raise ConfigError(f"{where}: the file is already in {taken[found[0]]}; it can be in one pair only")
            taken[found[0]] = pair.where


def without_unlike(records: Sequence[Record]) -> tuple[list[Record], list[Failure]]:
    """Return the records, and failures for pairs that are left out because interval, length or start time differ."""
    groups: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        if record.together:
            groups[record.together].append(record)
    reasons: dict[int, str] = {}
    for group in groups.values():
        if len(group) == 2 and (unlike := _difference(*group)):
            reasons |= {id(record): unlike for record in group}
    rows = [
        Failure(one.source, "pair", f"{one.id}: {reasons[id(one)]}", "failed", stored_remedies([PAIR]))
        for one in records
        if id(one) in reasons
    ]
    return [record for record in records if id(record) not in reasons], rows


def _difference(one: Record, other: Record) -> str:
    """Return why two files cannot be the components of one recording; empty if they can."""
    files = f"{one.together} ([[records.pair]])"
    if not same_step((one.dt, other.dt)):
        return f"expected equal intervals in {files}, found {one.dt:g} and {other.dt:g} s; correct the wrong one"
    if one.npts != other.npts:
        return (
            f"expected equal numbers of samples in {files}, found {one.npts} and {other.npts}; if both begin at the "
            "same time, shorten the longer one, otherwise remove the entry"
        )
    if one.start_time != other.start_time and None not in (one.start_time, other.start_time):
        return f"expected equal start times in {files}, found {one.start_time} and {other.start_time}"
    return ""
