"""Counts the input files that the results use, and lists what was not used, with the reasons, and the warnings.

A file is used if one of its channels is assessed, or is skipped as vertical, structural or duplicate. It is not used if
it failed and the results contain none of its channels. Skipped files (texts, pictures, spectra) are not counted.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from textwrap import shorten

import xarray as xr

from rockpulse.errors import NO_RECORD, Failure, alike, last_part, reasons_in_words, some
from rockpulse.record.record import BETWEEN
from rockpulse.views.shared.formatting import WIDTH, paragraph, several
from rockpulse.views.shared.words import counted_words, language, reason_words, say
from rockpulse.warning_text import PLAIN

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
#: Largest number of rows of a kind other than "failed" in the overview, and in a brief list; equal reasons are one row.
LISTED, FEW = 12, 3
#: Kinds whose rows are grouped by reason; for other kinds the reasons name other records.
_GROUPED = frozenset({"failed", "skipped"})
#: Number of words at the start of a warning without a code that identify its kind (numbers are not counted).
_TELLING_WORDS = 4
_KINDS = {
    "failed": "failed",
    "vertical": "read, not assessed (vertical)",
    "structural": "read, not assessed (on a structure)",
    "duplicate": "duplicates skipped",
    "depth": "skipped (sensor at depth of an assessed station)",
    "skipped": "skipped (cannot be used)",
}


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
        return count_files((name for source in sources for name in _split(source)), failure_rows(tree))
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
    return [row.file] if row.stage in _OF_FILES else _split(row.file)


def _split(source: str) -> list[str]:
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


def left_out(tree: xr.DataTree, brief: bool = False) -> str:
    """List the files and channels that were not assessed, by kind, and the warnings; `brief` shortens the list."""
    summary = tree["summary"].to_dataset()
    acted = int((summary["vertical_channel"] != "").sum())
    found, beside = apart(failure_rows(tree))
    lines = []
    for kind, rows in found.items():
        entries = _entries(kind, rows)
        title = _KINDS.get(kind, kind)
        if kind == "vertical" and acted:
            title = f"vertical channels, acting on {several(acted, 'record')}"
        few, failed = (FEW, LISTED) if brief else (LISTED, len(entries))
        lines += [f"{title}: {len(rows)}", *_cut(entries, failed if kind == "failed" else few)]
    lines += _beside(beside)
    pairs = zip(summary["block"].values, summary["block_warnings"].values, strict=True)
    warned = [f"body {block}: {'; '.join(words.splitlines())}" for block, words in pairs if words]
    most = LISTED if brief else len(warned)
    lines += [paragraph(line, "      ", "") for line in warned[:most]]
    if len(warned) > most:
        lines.append(f"and {several(len(warned) - most, 'more body')} with warnings")
    if kinds := _kinds_of_warning(summary):
        count = sum(map(bool, summary["warnings"].values))
        lines.append(f"records with warnings: {count} (all warnings of one: rockpulse inspect RESULTS --record ID)")
    return "\n".join([*lines, *(paragraph(words + like, "      ", f"  {record}: ") for record, words, like in kinds)])


def skipped_summary(tree: xr.DataTree) -> str:
    """Summarise the files and channels that were not assessed, and the warnings, in a few lines."""
    found, beside = apart(failure_rows(tree))
    summary = tree["summary"].to_dataset()
    counts = [f"{_KINDS.get(kind, kind)}: {len(rows)}" for kind, rows in found.items()]
    for title, name in (("records", "warnings"), ("bodies", "block_warnings")):
        if count := sum(map(bool, summary[name].values)):
            counts.append(f"{title} with warnings: {count}")
    lines = [paragraph("; ".join(counts), "  ", "")] if counts else []
    lines += [*_cut(alike(found.get("failed", ())), LISTED), *_beside(beside)]
    kinds = _kinds_of_warning(summary)
    for record, warning, like in kinds[:FEW]:
        lines.append(f"  {shorten(f'{record}: {warning}', WIDTH - 2 - len(like), placeholder=' ...')}{like}")
    if len(kinds) > FEW:
        lines.append(f"  and {len(kinds) - FEW} more kinds of warnings")
    return "\n".join(lines)


def _cut(entries: Sequence[Sequence[Failure]], most: int) -> list[str]:
    """Return a line for each of the first groups, and a line with the number of failures in the other groups."""
    lines = [paragraph(reasons_in_words(group), "      ", "  ") for group in entries[:most]]
    if more := sum(map(len, entries[most:])):
        lines.append(f"  and {more} more (rockpulse inspect RESULTS --failures)")
    return lines


def unused(sentence: str) -> str:
    """Format a sentence on unused files as a warning; an empty sentence remains empty."""
    return paragraph(sentence, "  ", "! ") if sentence else ""


def rows_not_used(rows: Iterable[Failure], more_in: str = " (group /failures)", listed: int = LISTED) -> str:
    """List the files and channels that were not used, by kind; `more_in` states where the full list is."""
    lines = []
    found, beside = apart(rows)
    for kind, own in found.items():
        if kind != "vertical":
            entries = _entries(kind, own)
            most = len(entries) if kind == "failed" else listed
            lines += _with_kind(kind, entries[:most])
            if more := sum(map(len, entries[most:])):
                lines.append(f"{kind}: and {more} more{more_in}")
    return "\n".join([*lines, *_beside(beside)])


def failure_list(tree: xr.DataTree) -> str:
    """List everything that was not assessed, with kind, step, file and reason."""
    found = by_kind(failure_rows(tree)).items()
    return "\n".join(line for kind, own in found for line in _with_kind(kind, [[row] for row in own]))


def _with_kind(kind: str, entries: Sequence[Sequence[Failure]]) -> list[str]:
    return [paragraph(reasons_in_words(group), "      ", f"{kind} ({group[0].stage}) ") for group in entries]


def _entries(kind: str, rows: Sequence[Failure]) -> Sequence[Sequence[Failure]]:
    """Return the failures of a kind in groups with the same reason; for some kinds, each failure is a group."""
    return alike(rows) if kind in _GROUPED else [[row] for row in rows]


def apart(rows: Iterable[Failure]) -> tuple[dict[str, list[Failure]], list[str]]:
    """Return the failures by kind and, separately, the names of files that are not records."""
    found = by_kind(rows)
    beside = {row for row in found.get("skipped", ()) if row.reason == f"{row.file}: {NO_RECORD}"}
    rest = ((kind, [row for row in own if row not in beside]) for kind, own in found.items())
    names = [last_part(row.file) for row in found.get("skipped", ()) if row in beside]
    return {kind: own for kind, own in rest if own}, names


def _beside(names: Sequence[str]) -> list[str]:
    return [paragraph(some(names, LISTED), "  ", "not records: ")] if names else []


def by_kind(rows: Iterable[Failure]) -> dict[str, list[Failure]]:
    """Return the failures by kind; the kind "failed" comes first."""
    found: dict[str, list[Failure]] = {kind: [] for kind in _KINDS}
    for row in rows:
        found.setdefault(row.kind, []).append(row)
    return {kind: own for kind, own in found.items() if own}


def _kinds_of_warning(summary: xr.Dataset) -> list[tuple[str, str, str]]:
    """Return, for each kind of warning, a record, its warning, and the number of similar warnings as text."""
    found: dict[str, list[tuple[str, str]]] = {}
    names = ("record", "warnings", "warning_codes")
    for record, text, codes in zip(*(summary[name].values for name in names), strict=True):
        warnings = zip(str(text).splitlines(), str(codes).split(), strict=True)
        for kind, warning in {_kind(warning, code): warning for warning, code in warnings}.items():
            found.setdefault(kind, []).append((str(record), warning))
    return [
        (*first, f", and {len(others)} more like it" if others else "")
        for first, *others in sorted(found.values(), key=len, reverse=True)
    ]


def _kind(warning: str, code: str) -> str:
    """Return the kind of a warning: its code or, without a code, its first words."""
    if not code.endswith(PLAIN):
        return code
    return " ".join(re.sub(r"[-+]?\d[\d.e+-]*", "#", warning).split()[:_TELLING_WORDS])
