"""The origin of the numbers: files with their hashes, versions, what failed, and every warning."""

from __future__ import annotations

import hashlib
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.errors import alike
from rockpulse.views.report.records_used import earthquake_words
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table, number
from rockpulse.views.text.left_out import by_kind

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["failure_table", "hash_of", "input_table", "versions", "warning_table"]

_VERSION = "_version"

#: Attributes of the root that end in "_version" and are no packages.
_NO_PACKAGES = {"schema_version"}


def hash_of(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def input_table(words: Words, summary: xr.Dataset) -> Table:
    """The files that the records came from."""
    columns = [summary[name].values.tolist() for name in ("source", "source_sha256", "format")]
    found = Counter(zip(*columns, strict=True))
    of_file: dict[str, dict[str, None]] = {}
    for record, source in zip(summary["record"].values, columns[0], strict=True):
        known = Known(summary, record=str(record))
        if told := ", ".join(filter(None, (earthquake_words(words, known), known.place))):
            of_file.setdefault(source, {})[told] = None
    rows = tuple(
        (*map(Cell, row), number(count, str), *([Cell("; ".join(of_file.get(row[0], ())))] if of_file else []))
        for row, count in found.items()
    )
    titles = ("file", "sha256", "format", "records", *(["occasion"] if of_file else []))
    return Table("inputs", words("caption.inputs"), tuple(Heading(words(f"head.{one}")) for one in titles), rows)


def failure_table(words: Words, tree: xr.DataTree) -> Table:
    """Files and channels that were not assessed, and why, those of one reason together; those that failed first."""
    rows = tuple(
        (
            Cell(words(f"left_out.{kind}"), grade="bad" if kind == "failed" else ""),
            Cell(words.shared(group[0].stage)),
            Cell(", ".join(dict.fromkeys(row.place for row in group))),
            Cell(group[0].bare),
        )
        for kind, entries in by_kind(tree).items()
        for group in alike(entries)
    )
    headings = tuple(Heading(words(f"head.{one}")) for one in ("kind", "step", "file", "reason"))
    return Table("failures", words("caption.left_out"), headings, rows)


def warning_table(words: Words, summary: xr.Dataset) -> Table:
    """Every warning of a record or a body."""
    rows = []
    for kind, name in (("block", "block_warnings"), ("record", "warnings")):
        if name not in summary:
            continue
        for place, (label, text) in enumerate(zip(summary[kind].values, summary[name].values, strict=True)):
            key = f"{'body' if kind == 'block' else 'record'}-{place}"
            rows += [(Cell(str(label), link=key), Cell(line)) for line in str(text).splitlines() if line]
    headings = (Heading(words("head.of_what")), Heading(words("head.warning")))
    return Table("warnings", words("page.warnings"), headings, tuple(rows))


def versions(tree: xr.DataTree) -> tuple[Fact, ...]:
    """The packages that computed the results."""
    found = {str(name): str(value) for name, value in tree.attrs.items() if name not in _NO_PACKAGES}
    return tuple(
        Fact(name.removesuffix(_VERSION), (version,)) for name, version in found.items() if name.endswith(_VERSION)
    )
