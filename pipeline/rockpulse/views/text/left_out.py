"""Files and channels that were not assessed, and the warnings of the records, as text."""

import re
from collections.abc import Sequence
from textwrap import shorten

import xarray as xr

from rockpulse.errors import NO_RECORD, Failure, alike, last_part, some, told
from rockpulse.remark import PLAIN
from rockpulse.views.shared.files_used import failure_rows
from rockpulse.views.shared.terminal import WIDTH, paragraph

#: Rows of a kind that is no failure in the overview, those of one reason as one.
LISTED = 12
#: The same in a brief one.
FEW = 3
#: Kinds whose rows of one reason are told once; the reasons of the others name other records.
_TOLD_ONCE = frozenset({"failed", "skipped"})
#: Words of a warning without a code, numbers aside, by which it is known for one of a kind.
_TELLING_WORDS = 4

#: The variables that hold warnings, by what bears them.
_WARNED = {"records": "warnings", "bodies": "block_warnings"}

_KINDS = {
    "failed": "failed",
    "vertical": "read, not assessed (vertical)",
    "structural": "read, not assessed (on a structure)",
    "duplicate": "skipped, the same shaking twice",
    "depth": "skipped, the same shaking at depth",
    "skipped": "skipped, cannot be used",
}


def left_out(tree: xr.DataTree, brief: bool = False) -> str:
    """Everything that was read or found but not assessed, by kind, and the warnings of the records.

    A brief text has a few of each kind, also of what failed.
    """
    lines = []
    summary = tree["summary"].to_dataset()
    acted = int((summary["vertical_channel"] != "").sum())
    found, beside = apart(by_kind(tree))
    for kind, rows in found.items():
        entries = _entries(kind, rows)
        title = f"vertical, acting on {acted} records" if kind == "vertical" and acted else _KINDS.get(kind, kind)
        lines.append(f"{title}: {len(rows)}")
        whole = len(entries) if not brief else LISTED
        shown = entries[: whole if kind == "failed" else FEW if brief else LISTED]
        lines += [paragraph(told(group), "      ", "  ") for group in shown]
        if len(shown) < len(entries):
            more = sum(map(len, entries[len(shown) :]))
            lines.append(f"  and {more} more (rockpulse inspect RESULTS --failures shows them)")
    if beside:
        lines.append(_beside(beside))
    warned = [
        (block, str(words))
        for block, words in zip(summary["block"].values, summary["block_warnings"].values, strict=True)
        if words
    ]
    shown_blocks = warned[:LISTED] if brief else warned
    lines += [
        paragraph(f"block {block}: {'; '.join(words.splitlines())}", "      ", "") for block, words in shown_blocks
    ]
    if len(shown_blocks) < len(warned):
        lines.append(f"and {len(warned) - len(shown_blocks)} more blocks with warnings")
    return "\n".join([*lines, *_warnings(summary)])


def left_out_in_short(tree: xr.DataTree) -> str:
    """How much was left out, of each kind, and what failed by its reasons; a line for a few kinds of warnings."""
    found, beside = apart(by_kind(tree))
    summary = tree["summary"].to_dataset()
    counts = [f"{_KINDS.get(kind, kind)}: {len(rows)}" for kind, rows in found.items()]
    warned = {what: sum(map(bool, summary[name].values)) for what, name in _WARNED.items()}
    counts += [f"{what} with warnings: {count}" for what, count in warned.items() if count]
    lines = [paragraph("; ".join(counts), "  ", "")] if counts else []
    failed = alike(found.get("failed", ()))
    lines += [paragraph(told(group), "      ", "  ") for group in failed[:LISTED]]
    if len(failed) > LISTED:
        lines.append(f"  and {sum(map(len, failed[LISTED:]))} more (rockpulse inspect RESULTS --failures shows them)")
    lines += [_beside(beside)] if beside else []
    kinds = _by_kind_of_warning(summary)
    for record, warning, like in kinds[:FEW]:
        lines.append(f"  {shorten(f'{record}: {warning}', WIDTH - 2 - len(like), placeholder=' ...')}{like}")
    return "\n".join([*lines, *([f"  and {len(kinds) - FEW} more kinds of warnings"] if len(kinds) > FEW else [])])


def unused(sentence: str) -> str:
    """The sentence of `rockpulse.views.shared.files_used` as a loud line; empty where all files were used."""
    return paragraph(sentence, "  ", "! ") if sentence else ""


def not_used(tree: xr.DataTree) -> str:
    """Files and channels that were not used, by kind, a few of each; vertical channels are not among them."""
    return rows_not_used(failure_rows(tree))


def rows_not_used(rows: Sequence[Failure], more_in: str = " (group /failures)", listed: int = LISTED) -> str:
    """The text of :func:`not_used` for some rows; `more_in` says where those are that are not `listed`."""
    lines = []
    found, beside = apart(_grouped(rows))
    for kind, own in found.items():
        if kind != "vertical":
            entries = _entries(kind, own)
            shown = entries if kind == "failed" else entries[:listed]
            lines += _with_kind(kind, shown)
            if len(shown) < len(entries):
                lines.append(f"{kind}: and {sum(map(len, entries[len(shown) :]))} more{more_in}")
    if beside:
        lines.append(_beside(beside))
    return "\n".join(lines)


def failure_list(tree: xr.DataTree, kinds: Sequence[str] | None = None) -> str:
    """Everything that was not assessed, of some kinds or all: kind, stage, file and reason; empty for nothing."""
    found = by_kind(tree)
    named = [kind for kind in found if kinds is None or kind in kinds]
    return "\n".join(line for kind in named for line in _with_kind(kind, [[row] for row in found[kind]]))


def _with_kind(kind: str, entries: Sequence[Sequence[Failure]]) -> list[str]:
    return [paragraph(told(group), "      ", f"{kind} ({group[0].stage}) ") for group in entries]


def _entries(kind: str, rows: Sequence[Failure]) -> Sequence[Sequence[Failure]]:
    """The rows of a kind as they are told: those of one reason together, or each alone."""
    return alike(rows) if kind in _TOLD_ONCE else [[row] for row in rows]


def apart(found: dict[str, list[Failure]]) -> tuple[dict[str, list[Failure]], list[str]]:
    """The files that might have been used, by kind, and the names of the files beside it that are no records."""
    beside = [row.file for row in found.get("skipped", ()) if _is_beside(row)]
    skipped = [row for row in found.get("skipped", ()) if not _is_beside(row)]
    rest = {kind: rows for kind, rows in (found | {"skipped": skipped}).items() if rows}
    return rest, [last_part(file) for file in beside]


def _is_beside(row: Failure) -> bool:
    return row.reason == f"{row.file}: {NO_RECORD}"


def _beside(names: Sequence[str]) -> str:
    return paragraph(some(names, LISTED), "  ", "not records: ")


def by_kind(tree: xr.DataTree) -> dict[str, list[Failure]]:
    """The rows of /failures by kind; the failed ones first."""
    return _grouped(failure_rows(tree))


def _grouped(rows: Sequence[Failure]) -> dict[str, list[Failure]]:
    grouped: dict[str, list[Failure]] = {}
    for row in rows:
        grouped.setdefault(row.kind, []).append(row)
    order = [*_KINDS, *sorted(set(grouped) - set(_KINDS))]
    return {kind: grouped[kind] for kind in order if kind in grouped}


def _warnings(summary: xr.Dataset) -> list[str]:
    """The warnings of the records: one of each kind, and on how many records there is one like it."""
    kinds = _by_kind_of_warning(summary)
    if not kinds:
        return []
    warned = sum(bool(text) for text in summary["warnings"].values)
    lines = [f"records with warnings: {warned} (rockpulse inspect RESULTS --record ID shows all of them)"]
    return lines + [paragraph(f"{warning}{like}", "      ", f"  {record}: ") for record, warning, like in kinds]


def _by_kind_of_warning(summary: xr.Dataset) -> list[tuple[str, str, str]]:
    """Of each kind of warning a record that bears it, the warning, and how many more records bear one like it."""
    alike: dict[str, list[tuple[str, str]]] = {}
    names = ("record", "warnings", "warning_codes")
    for record, text, codes in zip(*(summary[name].values for name in names), strict=True):
        warnings = zip(str(text).splitlines(), str(codes).split(), strict=True)
        kinds = {_kind(warning, code): warning for warning, code in warnings}
        for kind, warning in kinds.items():
            alike.setdefault(kind, []).append((str(record), warning))
    return [
        (*entries[0], "" if len(entries) == 1 else f", and {len(entries) - 1} more like it")
        for entries in sorted(alike.values(), key=len, reverse=True)
    ]


def _kind(warning: str, code: str) -> str:
    """The common part of warnings that are alike: the code, or the first words of a text without one."""
    if not code.endswith(PLAIN):
        return code
    return " ".join(re.sub(r"[-+]?\d[\d.e+-]*", "#", warning).split()[:_TELLING_WORDS])
