"""Files and channels that were not assessed, and warnings on records and bodies, as text."""

import re
from collections.abc import Iterable, Sequence
from textwrap import shorten

import xarray as xr

from rockpulse.errors import NO_RECORD, Failure, alike, last_part, reasons_in_words, some
from rockpulse.views.shared.files_used import failure_rows
from rockpulse.views.shared.formatting import WIDTH, paragraph, several
from rockpulse.warning_text import PLAIN

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


def failure_list(tree: xr.DataTree, kinds: Sequence[str] | None = None) -> str:
    """List everything that was not assessed, with kind, step, file and reason; `kinds` limits the list."""
    found = {kind: own for kind, own in by_kind(failure_rows(tree)).items() if kinds is None or kind in kinds}
    return "\n".join(line for kind, own in found.items() for line in _with_kind(kind, [[row] for row in own]))


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
