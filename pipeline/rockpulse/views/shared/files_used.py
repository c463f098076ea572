"""Counts the input files that the results use, and gives the reasons why other files are not used.

A file is used if one of its channels is assessed, or is skipped as vertical, structural or duplicate. It is not used if
it failed and the results contain none of its channels. Skipped files (texts, pictures, spectra) are not counted.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import xarray as xr

from rockpulse.errors import Failure, alike, last_part
from rockpulse.record.record import BETWEEN
from rockpulse.views.shared.words import counted_words, language, reason_words, say

#: Kinds of rows of channels that were read but not assessed, and whose file therefore is used.
_READ = frozenset({"vertical", "structural", "duplicate", "depth"})
#: Steps whose rows name a single file; rows of later steps name all files of a record.
_OF_FILES = frozenset({"find", "read"})
#: Steps whose failed rows concern a table or a pattern given by the user, not a file of records.
_OF_OPTIONS = frozenset({"events", "select"})
#: Groups with a row for each record of the results, of which the first that exists is used.
_GROUPS = ("summary", "site", "capacities")
#: Largest number of reasons in a sentence, of files per reason, and of characters per reason.
_REASONS, _NAMED, _LONGEST = 3, 10, 120


@dataclass(frozen=True)
class FilesUsed:
    """The number of used files, the failures of files that were not used, and the failures of single channels."""

    used: int | None  # None if records do not state their files
    unused: tuple[Failure, ...] = ()  # first row of each failed file
    beside: tuple[Failure, ...] = ()  # channels of used files, tables of earthquakes, patterns without a record

    @property
    def counted(self) -> str:
        """Return the numbers of used files, unused files and failed channels as text; empty if nothing failed."""
        channels = sum(row.stage not in _OF_OPTIONS for row in self.beside)
        failed = say("files.channels", channels=counted_words(channels, "channel")) if channels else ""
        return ", ".join(filter(None, (self._files, failed)))

    @property
    def _files(self) -> str:
        count = len(self.unused)
        if not count:
            return ""
        if not self.used:
            return say("files.not_used", files=counted_words(count, "file"))
        return say("files.used", used=self.used, files=counted_words(self.used + count, "file"), unused=count)

    @property
    def sentence(self) -> str:
        """Return the numbers of used and unused files, and the reasons, as text; empty if all files were used."""
        return f"{self._files}: {_reasons(self.unused)}." if self.unused else ""

    @property
    def reasons(self) -> str:
        """Return the reasons for failures as text: first for unused files, then for single channels."""
        return "; ".join(_reasons(rows) for rows in (self.unused, self.beside) if rows)

    @property
    def line(self) -> str:
        """Return all failures with their reasons on one line; empty if nothing failed."""
        channels = f"also failed: {_reasons(self.beside)}." if self.beside else ""
        return " ".join(filter(None, (self.sentence, channels if self.unused else channels.removeprefix("also "))))


def files_used(tree: xr.DataTree) -> FilesUsed:
    """Count the used and unused input files of a results file."""
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
    """Count used and unused files, given the names of the used files and the rows of /failures."""
    rows = list(rows)
    failed = {row.file for row in rows if row.kind == "failed"}
    # A skipped vertical channel does not make its file used if it or the horizontal channels failed.
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
    # A record made in Python has no file.
    return FilesUsed(None if "" in names else len(names), tuple(unused.values()), tuple(beside))


def failure_rows(tree: xr.DataTree) -> list[Failure]:
    """Return the rows of the group /failures; empty if the results have no such group."""
    if "failures" not in tree.children:
        return []
    failures = tree["failures"].to_dataset()
    columns = (failures[name].values.tolist() for name in ("file", "stage", "reason", "kind", "remedy"))
    return [translated_row(Failure(*row)) for row in zip(*columns, strict=True)]


def translated_row(row: Failure) -> Failure:
    """Return a failure with its reason translated to the current language; names of files and records are kept."""
    if language() == "en":
        return row
    place = f"{row.place}: " if row.reason.startswith(f"{row.place}: ") else ""
    return replace(row, reason=place + reason_words(row.bare))


def _named(row: Failure) -> list[str]:
    return [row.file] if row.stage in _OF_FILES else _apart(row.file)


def _apart(source: str) -> list[str]:
    """Split the joined file names of a record; do not split if a part does not look like a file name."""
    names = source.split(BETWEEN)
    inside = {any(sign in name for sign in "/\\!") for name in names}
    ending = {"." in last_part(name) for name in names}
    return names if len(inside) == len(ending) == 1 else [source]


def _files_of(source: str, checksums: str) -> list[str]:
    """Return the file names of a record; they are split only if their number equals the number of checksums."""
    names = source.split(BETWEEN)
    return names if len(names) == len(checksums.split(BETWEEN)) else [source]


def _reasons(rows: Iterable[Failure]) -> str:
    said, rest = reasons_of(rows)
    return "; ".join([*said, *([say("left_out.other", count=rest)] if rest else [])])


def reasons_of(rows: Iterable[Failure], most: int = _REASONS, longest: int = _LONGEST) -> tuple[list[str], int]:
    """Return the most frequent reasons with the names of their files, and the number of failures not listed."""
    groups = sorted(alike(rows), key=len, reverse=True)
    return [_reason(group, longest) for group in groups[:most]], sum(map(len, groups[most:]))


def _reason(group: list[Failure], longest: int) -> str:
    """Return the common reason of a group of failures, without advice, followed by the names of the files."""
    words = " ".join(group[0].found.split())
    if len(words) > longest:
        words = f"{words[:longest].rpartition(' ')[0]} ..."
    names = ", ".join(last_part(row.file) for row in group[:_NAMED]) + (", ..." if len(group) > _NAMED else "")
    return f"{words} ({f'{len(group)}: ' if len(group) > _NAMED else ''}{names})"
