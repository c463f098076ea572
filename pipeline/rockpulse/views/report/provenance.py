"""Where the numbers come from: files with their hashes, versions, what failed, and every warning."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.views.shared.table import Cell, Fact, Heading, Table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["failure_table", "hash_of", "input_table", "versions", "warning_table"]

_VERSION = "_version"

#: Attributes of the root that end in "_version" and are no packages.
_NO_PACKAGES = {"schema_version"}

#: The gravest first.
_KINDS = ("failed", "structural", "duplicate", "skipped", "vertical")


def hash_of(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def input_table(summary: xr.Dataset) -> Table:
    """The files that the records came from."""
    found: dict[tuple[str, ...], int] = {}
    columns = [
        summary[name].values.tolist() if name in summary else [""] * summary.sizes["record"]
        for name in ("source", "source_sha256", "format")
    ]
    for row in zip(*columns, strict=True):
        found[row] = found.get(row, 0) + 1
    rows = tuple((*(Cell(str(word)) for word in row), Cell(str(count), float(count))) for row, count in found.items())
    headings = (Heading("file"), Heading("SHA-256"), Heading("format"), Heading("records"))
    return Table("inputs", "Files that were assessed", headings, rows)


def failure_table(tree: xr.DataTree) -> Table:
    """What was not assessed, and why: what failed first."""
    failures = tree["failures"].to_dataset()
    rows = sorted(
        zip(*(map(str, failures[name].values) for name in ("kind", "stage", "file", "reason")), strict=True),
        key=lambda row: (_KINDS.index(row[0]) if row[0] in _KINDS else len(_KINDS), row[2]),
    )
    cells = tuple(
        (Cell(kind, grade="bad" if kind == "failed" else ""), Cell(stage), Cell(file), Cell(reason))
        for kind, stage, file, reason in rows
    )
    headings = (Heading("kind"), Heading("step"), Heading("file"), Heading("reason"))
    return Table("failures", "Files and channels that are not part of the verdict", headings, cells)


def warning_table(summary: xr.Dataset) -> Table:
    """Every warning of a record or a body."""
    rows = []
    for kind, name in (("block", "block_warnings"), ("record", "warnings")):
        if name not in summary:
            continue
        for place, (label, text) in enumerate(zip(summary[kind].values, summary[name].values, strict=True)):
            key = f"{'body' if kind == 'block' else 'record'}-{place}"
            rows += [(Cell(str(label), link=key), Cell(line)) for line in str(text).splitlines() if line]
    headings = (Heading("of"), Heading("warning"))
    return Table("warnings", "Warnings", headings, tuple(rows))


def versions(tree: xr.DataTree) -> tuple[Fact, ...]:
    """The packages that computed the results."""
    attributes = {str(name): str(value) for name, value in tree.attrs.items()}
    found = {
        name.removesuffix(_VERSION): version
        for name, version in attributes.items()
        if name.endswith(_VERSION) and name not in _NO_PACKAGES
    }
    return tuple(Fact(name, (version,)) for name, version in found.items())
