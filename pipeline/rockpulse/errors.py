"""The errors of rockpulse, which can be pickled, and the rows of the table of failures."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

#: Advice in messages on each remedy: {choices} are its values, {first} is one of them, and {lines} are lines of the
#: configuration that set it for some files.
_ADVICE = {
    "units": "give it with the option units, one of {choices}: --units {first} on the command line, units = '{first}' "
    "under [records] of the configuration, or read(path, units='{first}'); if only some files use this unit, set it "
    "for them in the configuration:\n{lines}",
    "dt": "give it: --dt 0.01 on the command line, dt = 0.01 under [records] of the configuration, or read(path, "
    "units='g', dt=0.01); if only some files have this interval, set it for them in the configuration:\n{lines}",
    "confirm": "--confirm {options}, or confirm = [{quoted}] under [records]",
    "pair": "state which two files are a pair ([[records.pair]])",
    "confirm_size": "set confirm_size = true in its [[block]]",
    "confirm_value": "give a [[demand]] with confirm_value = true",
}


@dataclass(frozen=True)
class Remedy:
    """A key of the configuration that lets a file, a channel or a body be used, and the values to choose from.

    Attributes
    ----------
    key : str
        ``units`` or ``dt`` of a file, ``confirm`` of channels, ``pair`` of two files, ``confirm_size`` of a body,
        ``confirm_value`` of a demand.
    choices : tuple of str
        Units, intervals [s] or ids of channels without blanks; empty if any value is allowed.

    Examples
    --------
    >>> rp.errors.Remedy("confirm", ("a.E", "a.N")).advice()
    '--confirm a.E --confirm a.N, or confirm = ["a.E", "a.N"] under [records]'
    """

    key: str
    choices: tuple[str, ...] = ()

    def advice(self, name: str = "") -> str:
        """Return the text that states what to do, for a message about the file `name`."""
        first = "g" if "g" in self.choices else "".join(self.choices[:1])
        return _ADVICE[self.key].format(
            choices=", ".join(self.choices),
            first=first,
            options=" --confirm ".join(self.choices),
            quoted=", ".join(f'"{one}"' for one in self.choices),
            lines=self.lines(name, f'"{first}"' if self.key == "units" else "0.01"),
        )

    def lines(self, name: str, value: str) -> str:
        """Return lines of the configuration that set the key for all files with the suffix of `name`."""
        last = last_part(name)
        pattern = f"*.{last.rpartition('.')[2]}" if "." in last else last
        return f'[[records.file]]\nmatch = "{pattern}"\n{self.key} = {value}'


class RockpulseError(ValueError):
    """Base class of every error whose message states what was found, what was expected and what to do.

    `remedies` are the settings with which the data can be used nevertheless, if there are any.

    >>> try:
    ...     rp.assess(record)
    ... except rp.RockpulseError as error:
    ...     print(error)
    no body to assess: give [[block]] entries in the configuration or --block NAME=WIDTHxHEIGHT
    """

    def __init__(self, message: str = "", *remedies: Remedy) -> None:
        super().__init__(message)
        self.remedies = remedies


class RecordFormatError(RockpulseError):
    """Error: a file violates the rules of its format, or no reader recognises it.

    >>> rp.read("curve.csv")
    Traceback (most recent call last):
    rockpulse.errors.RecordFormatError: curve.csv:2: expected acceleration in the column 'pga [g]'...
    """


class RecordRefused(RockpulseError):
    """Error: a well-formed file contains no usable ground acceleration, but for example velocity or spectra.

    >>> rp.condition_pair(rp.Pair(record, record))
    Traceback (most recent call last):
    rockpulse.errors.RecordRefused: burst.2, burst.2: expected azimuths at least 9.79 degrees from...
    """


class TooWeak(RecordRefused):
    """Error: a record moves too few bodies to be used; it is listed as "skipped", as its file is not faulty.

    >>> config = rp.Config(fragility=rp.FragilitySettings(pga_min=6.0))
    >>> rp.fragility(record, config, {"pier": (1.0, 4.0)})["failures"]["reason"].item()
    'burst.2: PGA 3.76 m/s2 is below [fragility] pga_min = 6 m/s2'
    """


class UnitError(RockpulseError):
    """Error: a unit is missing or unknown, or contradicts the file.

    >>> rp.read("records/burst.2.AT2", units="ft")
    Traceback (most recent call last):
    rockpulse.errors.UnitError: option units: unknown unit of acceleration 'ft', which is...
    """


class ConfigError(RockpulseError):
    """Error: a configuration file or a command-line option cannot be used.

    >>> rp.BlockSettings("pier", width=1.0, height=-3.0)
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [[block]] "pier" height: expected a positive number of metres, found -3.0
    """


class ResultsError(RockpulseError):
    """Error: a results file cannot be written, or cannot be read by this version.

    Attributes
    ----------
    tells_resume : bool
        Whether the message states what happens to a stopped run, and how to continue it.

    Examples
    --------
    >>> rp.load("curve.csv")
    Traceback (most recent call last):
    rockpulse.errors.ResultsError: curve.csv: not a rockpulse results file, or damaged...
    """

    def __init__(self, message: str, tells_resume: bool = False) -> None:
        super().__init__(message)
        self.tells_resume = tells_resume


class StoppedAtFailure(RockpulseError):
    """Error: a batch with ``strict`` has stopped at the first file or record that failed.

    >>> rp.assess_files("velocity.csv", config, "none.h5", rp.BatchOptions(strict=True))
    Traceback (most recent call last):
    rockpulse.errors.StoppedAtFailure: stopped at the first failure (--strict): velocity.csv:1...
    """


#: Reason for skipping a file that is a text, a table or a picture and not a record.
NO_RECORD = "no record"
FailureKind = Literal["failed", "skipped", "duplicate", "depth", "vertical", "structural"]
#: Pattern of a line number after the file name in a reason.
_LINE = re.compile(r":\d+(?=: )")
#: Pattern of the id of a record at the start of a reason; an id contains a full stop and no blank.
_ID = re.compile(r"\S+\.\S*(?=: )")
#: Number of files named as examples for a reason that several files share.
_EXAMPLES = 10


@dataclass(frozen=True)
class Failure:
    """One row of the table of failures: a file or record that was left out, and the reason."""

    file: str  # name of the file; ``archive.zip!member`` for a file in an archive
    stage: str  # step of the run that left out the file or record
    reason: str
    # "failed": needs attention; "skipped": no record, or too weak; "duplicate", "depth": another record of the same
    # ground motion is assessed instead; "vertical", "structural": no horizontal ground motion
    kind: FailureKind
    remedy: str = ""  # stored form of the remedies, from `stored_remedies`

    @property
    def remedies(self) -> list[Remedy]:
        """The settings with which the file or channel can be used."""
        return [Remedy(key, tuple(choices)) for key, *choices in map(str.split, self.remedy.splitlines())]

    @property
    def place(self) -> str:
        """The file and line, or the record, at the start of the reason; otherwise the name of the file."""
        if self.reason.startswith(f"{self.file}:"):
            line = _LINE.match(self.reason, len(self.file))
            return self.reason[: line.end()] if line else self.file
        record = _ID.match(self.reason)
        return record[0] if record else self.file

    @property
    def bare(self) -> str:
        """The reason without the names of the file and the record and without the line number."""
        return self.reason.removeprefix(f"{self.place}: ").replace(f": '{self.file}'", "")

    @property
    def found(self) -> str:
        """The first part of the bare reason: what was found, without the advice that follows it."""
        return self.bare.partition("; ")[0]


def stored_remedies(remedies: Iterable[Remedy]) -> str:
    """Return the stored form of remedies: a line for each, with its key and its choices."""
    return "\n".join(" ".join((one.key, *one.choices)) for one in remedies)


def alike(rows: Iterable[Failure]) -> list[list[Failure]]:
    """Group rows with the same reason; the groups are in the order of their first rows."""
    groups: dict[str, list[Failure]] = {}
    for row in rows:
        groups.setdefault(row.bare, []).append(row)
    return list(groups.values())


def reasons_in_words(group: Sequence[Failure]) -> str:
    """Return the common reason of a group of rows as text, with the file of a single row, or the number of rows."""
    first = group[0]
    if len(group) == 1:  # most reasons begin with the file and a line number
        return first.reason if first.file in first.reason else f"{first.file}: {first.reason}"
    whole = len({row.file for row in group}) == len(group) and all(row.place.startswith(row.file) for row in group)
    counted = "files" if whole else "channels"
    return f"{len(group)} {counted} ({some([row.place for row in group], _EXAMPLES)}): {first.bare}"


def some(names: Sequence[str], most: int) -> str:
    """Return the first `most` names as text, and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) or "none") + more


def unread(rows: Iterable[Failure]) -> bool:
    """Return whether a file could not be read; a name that matches no record may then name a record in this file."""
    return any(row.kind == "failed" and row.stage in ("find", "read") for row in rows)


def last_part(file: str) -> str:
    """Return the last part of the name of a file or of a member of an archive."""
    return file.replace("\\", "/").rpartition("!")[2].rpartition("/")[2] or file
