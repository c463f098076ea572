"""Files and channels that were not assessed, and the warnings of the records, as text."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rockpulse.failures import NO_RECORD
from rockpulse.remark import PLAIN
from rockpulse.views.shared.terminal import paragraph

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["by_kind", "failure_list", "left_out", "not_used"]

#: Rows of a kind that is no failure in the overview.
LISTED = 12
#: The same in a brief one.
FEW = 3
#: Words of a warning without a code, numbers aside, by which it is known for one of a kind.
_TELLING_WORDS = 4

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
    found, beside = _apart(by_kind(tree))
    for kind, entries in found.items():
        title = f"vertical, acting on {acted} records" if kind == "vertical" and acted else _KINDS.get(kind, kind)
        lines.append(f"{title}: {len(entries)}")
        whole = len(entries) if not brief else LISTED
        shown = entries[: whole if kind == "failed" else FEW if brief else LISTED]
        lines += [paragraph(_told(file, reason), "      ", "  ") for file, _, reason in shown]
        if len(shown) < len(entries):
            lines.append(f"  and {len(entries) - len(shown)} more (rockpulse inspect RESULTS --failures shows them)")
    if beside:
        lines.append(_beside(beside))
    warned = [
        (block, str(words))
        for block, words in zip(summary["block"].values, summary["block_warnings"].values, strict=True)
        if words
    ]
    shown_blocks = warned[:LISTED] if brief else warned
    lines += [paragraph(f"block {block}: {words}", "      ", "") for block, words in shown_blocks]
    if len(shown_blocks) < len(warned):
        lines.append(f"and {len(warned) - len(shown_blocks)} more blocks with warnings")
    return "\n".join([*lines, *_warnings(summary)])


def not_used(tree: xr.DataTree) -> str:
    """Files and channels that were not used, by kind, a few of each; vertical channels are not among them."""
    lines = []
    found, beside = _apart(by_kind(tree))
    for kind, entries in found.items():
        if kind != "vertical":
            shown = entries if kind == "failed" else entries[:LISTED]
            lines += _with_kind(kind, shown)
            if len(shown) < len(entries):
                lines.append(f"{kind}: and {len(entries) - len(shown)} more (group /failures)")
    if beside:
        lines.append(_beside(beside))
    return "\n".join(lines)


def failure_list(tree: xr.DataTree, kinds: Sequence[str] | None = None) -> str:
    """Everything that was not assessed, of some kinds or all: kind, stage, file and reason; empty for nothing."""
    found = by_kind(tree)
    return "\n".join(line for kind in found if kinds is None or kind in kinds for line in _with_kind(kind, found[kind]))


def _with_kind(kind: str, entries: list[tuple[str, str, str]]) -> list[str]:
    return [paragraph(_told(file, reason), "      ", f"{kind} ({stage}) ") for file, stage, reason in entries]


def _told(file: str, reason: str) -> str:
    """Most reasons begin with the file and a line in it."""
    return reason if reason.startswith(file) else f"{file}: {reason}"


def _apart(
    found: dict[str, list[tuple[str, str, str]]],
) -> tuple[dict[str, list[tuple[str, str, str]]], list[str]]:
    """The files that might have been used, by kind, and the names of the files beside it that are no records."""
    beside = [file for file, _, reason in found.get("skipped", ()) if _is_beside(file, reason)]
    skipped = [row for row in found.get("skipped", ()) if not _is_beside(row[0], row[2])]
    rest = {kind: rows for kind, rows in (found | {"skipped": skipped}).items() if rows}
    return rest, [re.split(r"[/\\!]", file)[-1] for file in beside]


def _is_beside(file: str, reason: str) -> bool:
    return reason == f"{file}: {NO_RECORD}"


def _beside(names: Sequence[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return paragraph(f"{', '.join(names[:LISTED])}{more}", "  ", "not records: ")


def by_kind(tree: xr.DataTree) -> dict[str, list[tuple[str, str, str]]]:
    """The rows (file, stage, reason) of /failures by kind; the failed ones first."""
    failures = tree["failures"].to_dataset()
    grouped: dict[str, list[tuple[str, str, str]]] = {}
    for kind, *row in zip(*(failures[name].values for name in ("kind", "file", "stage", "reason")), strict=True):
        file, stage, reason = map(str, row)
        grouped.setdefault(str(kind), []).append((file, stage, reason))
    order = [*_KINDS, *sorted(set(grouped) - set(_KINDS))]
    return {kind: grouped[kind] for kind in order if kind in grouped}


def _warnings(summary: xr.Dataset) -> list[str]:
    """The warnings of the records: one of each kind, and on how many records there is one like it."""
    alike: dict[str, list[tuple[str, str]]] = {}
    names = ("record", "warnings", "warning_codes")
    for record, text, codes in zip(*(summary[name].values for name in names), strict=True):
        warnings = zip(str(text).splitlines(), str(codes).split(), strict=True)
        kinds = {_kind(warning, code): warning for warning, code in warnings}
        for kind, warning in kinds.items():
            alike.setdefault(kind, []).append((str(record), warning))
    if not alike:
        return []
    warned = sum(bool(text) for text in summary["warnings"].values)
    lines = [f"records with warnings: {warned} (rockpulse inspect RESULTS --record ID shows all of them)"]
    for entries in sorted(alike.values(), key=len, reverse=True):
        record, warning = entries[0]
        like = "" if len(entries) == 1 else f", and {len(entries) - 1} more like it"
        lines.append(paragraph(f"{warning}{like}", "      ", f"  {record}: "))
    return lines


def _kind(warning: str, code: str) -> str:
    """The common part of warnings that are alike: the code, or the first words of a text without one."""
    if not code.endswith(PLAIN):
        return code
    return " ".join(re.sub(r"[-+]?\d[\d.e+-]*", "#", warning).split()[:_TELLING_WORDS])
