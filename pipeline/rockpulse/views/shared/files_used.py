"""The number of the given files that are in the results, and why the others are not: one count for every view.

A file is used if one of its channels is assessed, or left out as vertical, on a structure or a duplicate. It is not
used if it failed and nothing of it is in the results. Skipped files (texts, pictures, spectra) do not count.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import xarray as xr

from rockpulse.errors import Failure, alike, last_part
from rockpulse.record.record import BETWEEN
from rockpulse.views.shared.words import counted_words, say

#: Kinds of rows of channels that were read, and are in the results or stand for a motion that is.
_READ = frozenset({"vertical", "structural", "duplicate", "depth"})
#: Steps that leave out the one file of a row as it was named; the rows of later ones have the files of a record.
_OF_FILES = frozenset({"find", "read"})
#: The steps whose rows of what failed are about a table or a pattern of the user, no file of records.
_OF_OPTIONS = frozenset({"events", "select"})
#: Groups with a row for each record of the results, by the kind of file; the first that is there counts.
_GROUPS = ("summary", "site", "capacities")
#: Reasons in a sentence, files named with each, and characters of each.
_REASONS, _NAMED, _LONGEST = 3, 2, 120


@dataclass(frozen=True)
class FilesUsed:
    """The number of files that were used, and the rows of failures."""

    used: int | None  # None where records do not tell their files
    unused: tuple[Failure, ...] = ()  # the first row of each file that failed
    beside: tuple[Failure, ...] = ()  # others: channels of used files, tables of earthquakes, patterns without a record

    @property
    def counted(self) -> str:
        """How many files were used and how many not, and how many channels of those used failed; empty for none."""
        failed = say("files.channels", channels=counted_words(self.channels, "channel")) if self.channels else ""
        return ", ".join(filter(None, (self._files, failed)))

    @property
    def channels(self) -> int:
        """The number of channels of files that are used which failed."""
        return sum(row.stage not in _OF_OPTIONS for row in self.beside)

    @property
    def _files(self) -> str:
        count = len(self.unused)
        if not count:
            return ""
        if self.used is None:
            return say("files.not_used", files=counted_words(count, "file"))
        return say("files.used", used=self.used, files=counted_words(self.used + count, "file"), unused=count)

    @property
    def sentence(self) -> str:
        """The numbers and the reasons; empty where all files were used."""
        return f"{self._files}: {_reasons(self.unused)}." if self.unused else ""

    @property
    def reasons(self) -> str:
        """Why something failed: files that are not used, then channels of files that are."""
        return "; ".join(_reasons(rows) for rows in (self.unused, self.beside) if rows)

    @property
    def line(self) -> str:
        """Everything that failed in one line; empty where nothing did."""
        channels = f"also failed: {_reasons(self.beside)}." if self.beside else ""
        return " ".join(filter(None, (self.sentence, channels if self.unused else channels.removeprefix("also "))))


def files_used(tree: xr.DataTree) -> FilesUsed:
    """The count of a file of results, or of its groups with the records and /failures."""
    group = next((name for name in _GROUPS if name in tree.children), None)
    if group is None:
        return count_files((), failure_rows(tree))
    records = tree[group].to_dataset()
    sources = records["source"].values.tolist()
    if "source_sha256" not in records:
        return count_files((name for source in sources for name in _apart(source)), failure_rows(tree))
    pairs = zip(sources, records["source_sha256"].values.tolist(), strict=True)
    return count_files((name for pair in set(pairs) for name in _files_of(*pair)), failure_rows(tree))


def count_files(used: Iterable[str], rows: Iterable[Failure]) -> FilesUsed:
    """The count of a run, from the files that its records were read from and the rows of what was left out."""
    rows = list(rows)
    failed = {row.file for row in rows if row.kind == "failed"}
    # The vertical channel alone, beside horizontal ones that failed, or failed itself, makes no file used.
    read = [row for row in rows if row.kind in _READ and not (row.kind == "vertical" and row.file in failed)]
    names = {*used, *(name for row in read for name in _named(row))}
    unused: dict[str, Failure] = {}
    beside = []
    for row in rows:
        if row.kind != "failed":
            continue
        missing = [] if row.stage in _OF_OPTIONS else [name for name in _named(row) if name not in names]
        if not missing:
            beside.append(row)
        for name in missing:
            unused.setdefault(name, replace(row, file=name))
    # A record that was made by hand has no file.
    return FilesUsed(None if "" in names else len(names), tuple(unused.values()), tuple(beside))


def failure_rows(tree: xr.DataTree) -> list[Failure]:
    """The rows of /failures, in their order; none where there is no such group."""
    if "failures" not in tree.children:
        return []
    failures = tree["failures"].to_dataset()
    columns = (failures[name].values.tolist() for name in ("file", "stage", "reason", "kind"))
    return [Failure(*row) for row in zip(*columns, strict=True)]


def _named(row: Failure) -> list[str]:
    return [row.file] if row.stage in _OF_FILES else _apart(row.file)


def _apart(source: str) -> list[str]:
    """The files of a record by name alone; one name where only some parts have a folder or an ending."""
    names = source.split(BETWEEN)
    inside = {any(sign in name for sign in "/\\!") for name in names}
    ending = {"." in last_part(name) for name in names}
    return names if len(inside) == len(ending) == 1 else [source]


def _files_of(source: str, checksums: str) -> list[str]:
    """The files of a record: one for each SHA-256, for the name of a file may hold the sign between them."""
    names = source.split(BETWEEN)
    return names if len(names) == len(checksums.split(BETWEEN)) else [source]


def _reasons(rows: Iterable[Failure]) -> str:
    said, rest = reasons_of(rows)
    return "; ".join([*said, *([f"{rest} more for other reasons"] if rest else [])])


def reasons_of(rows: Iterable[Failure], most: int = _REASONS, longest: int = _LONGEST) -> tuple[list[str], int]:
    """The most frequent reasons, each with some of its files, and how many rows have other ones."""
    groups = sorted(alike(rows), key=len, reverse=True)
    return [_reason(group, longest) for group in groups[:most]], sum(map(len, groups[most:]))


def _reason(group: list[Failure], longest: int) -> str:
    """The first part of a reason, which says what was found; what to do stands in the list of failures."""
    words = " ".join(group[0].bare.split()).partition("; ")[0]
    if len(words) > longest:
        words = f"{words[:longest].rpartition(' ')[0]} ..."
    names = ", ".join(last_part(row.file) for row in group[:_NAMED]) + (", ..." if len(group) > _NAMED else "")
    return f"{words} ({f'{len(group)}: ' if len(group) > _NAMED else ''}{names})"
