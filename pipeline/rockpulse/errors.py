"""The errors of rockpulse, each made of its message alone, so that it survives pickling, and the rows of failures."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal


class RockpulseError(ValueError):
    """Base of every error whose message tells the user what was found, what was expected and what to do."""


class RecordFormatError(RockpulseError):
    """A file that claims a format but breaks its rules, or that no reader recognises."""


class RecordRefused(RockpulseError):
    """A well-formed file that holds no usable ground acceleration (velocity, spectra, counts without a gain)."""


class TooWeak(RecordRefused):
    """A record that moves too few bodies to tell anything: "skipped", for nothing is wrong with its file."""


class UnitError(RockpulseError):
    """A unit that is missing, unknown, or contradicts the file."""


class ConfigError(RockpulseError):
    """A configuration file or command-line option that cannot be used."""


class ResultsError(RockpulseError):
    """A results file that cannot be written, or is not one that this version reads.

    Attributes
    ----------
    tells_resume : bool
        Whether the message says what becomes of a run that was stopped, and how to go on with it.
    """

    def __init__(self, message: str, tells_resume: bool = False) -> None:
        super().__init__(message)
        self.tells_resume = tells_resume


class StoppedAtFailure(RockpulseError):
    """A batch that was to stop at the first file or record that fails, and did."""


#: Why a text, a table or a picture that lies beside records was passed over.
NO_RECORD = "no record"
FailureKind = Literal["failed", "skipped", "duplicate", "depth", "vertical", "structural"]
#: What a reason may begin with behind the name of its file: the line in it.
_LINE = re.compile(r":\d+(?=: )")
#: The id of a record in front of a reason; an id has a point and no blank.
_ID = re.compile(r"\S+\.\S*(?=: )")
#: Examples of a reason that several files have.
_EXAMPLES = 10


@dataclass(frozen=True)
class Failure:
    """One row of the failures table."""

    file: str  # ``archive.zip!member``
    stage: str  # that left it out
    reason: str
    # "failed": needs attention; "skipped": no record, or too weak; "duplicate", "depth": another record of the same
    # shaking is assessed in its place; "vertical", "structural": no horizontal ground motion
    kind: FailureKind

    @property
    def place(self) -> str:
        """The file, with the line or the record in it where the reason begins with one."""
        if self.reason.startswith(f"{self.file}:"):
            line = _LINE.match(self.reason, len(self.file))
            return self.reason[: line.end()] if line else self.file
        record = _ID.match(self.reason)
        return record[0] if record else self.file

    @property
    def bare(self) -> str:
        """The reason without the file, the line or the record that it is about."""
        return self.reason.removeprefix(f"{self.place}: ").replace(f": '{self.file}'", "")


def alike(rows: Iterable[Failure]) -> list[list[Failure]]:
    """The rows in groups of one reason, each group where its first row stands."""
    groups: dict[str, list[Failure]] = {}
    for row in rows:
        groups.setdefault(row.bare, []).append(row)
    return list(groups.values())


def reasons_in_words(group: Sequence[Failure]) -> str:
    """The reason of rows that are alike: of one with its place, of several with their number and two places."""
    first = group[0]
    if len(group) == 1:  # most reasons begin with the file and a line in it
        return first.reason if first.file in first.reason else f"{first.file}: {first.reason}"
    whole = len({row.file for row in group}) == len(group) and all(row.place.startswith(row.file) for row in group)
    counted = "files" if whole else "channels"
    return f"{len(group)} {counted} ({some([row.place for row in group], _EXAMPLES)}): {first.bare}"


def some(names: Sequence[str], most: int) -> str:
    """The first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) or "none") + more


def unread(rows: Iterable[Failure]) -> bool:
    """Whether a file could not be read, so that a name or a pattern that fits no record may be meant for it."""
    return any(row.kind == "failed" and row.stage in ("find", "read") for row in rows)


def last_part(file: str) -> str:
    """The last part of the name of a file, or of a member of an archive."""
    return file.replace("\\", "/").rpartition("!")[2].rpartition("/")[2] or file
