"""Parts of a file that stand in it twice, as files that were joined do, or tools that write a marker line again.

A copy is read once, with a warning. Parts of the same name that differ are left to the reader, which refuses them: they
are never joined to one motion.
"""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["distinct_sections", "last_of_equal", "repeated_marker", "same_lines"]


def last_of_equal(lines: Sequence[str], at: int) -> int:
    """Index of the last of the lines that repeat the one at index `at` below it; blank lines between them count."""
    last = at
    for index in range(at + 1, len(lines)):
        if lines[index].strip() and lines[index].split() != lines[at].split():
            break
        if lines[index].strip():
            last = index
    return last


def repeated_marker(first: int, last: int) -> tuple[str, ...]:
    """A warning where a marker stands at the indices `first` and `last`."""
    return (f"line {first + 1}: the line is repeated up to line {last + 1}; it was read once",) if last > first else ()


def same_lines(lines: Sequence[str], one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two spans of lines, each the index of its first line and of the one behind its last, say the same."""
    return _said(lines, one) == _said(lines, other)


def _said(lines: Sequence[str], span: tuple[int, int]) -> list[str]:
    return [line.rstrip() for line in lines[slice(*span)] if line.strip()]


def distinct_sections(
    lines: Sequence[str], spans: Sequence[tuple[int, int]], what: str = "channel"
) -> tuple[list[tuple[int, int]], tuple[str, ...]]:
    """The sections of a file without those that are copies of earlier ones, and a warning for each copy.

    A section is the index of its first line and of the line behind its last; `what` names one in the warning.
    """
    kept: list[tuple[int, int]] = []
    notes = []
    by_content: dict[int, list[tuple[int, int]]] = {}
    for span in spans:
        alike = by_content.setdefault(hash(tuple(_said(lines, span))), [])
        copied = next((other for other in alike if same_lines(lines, other, span)), None)
        if copied is None:
            alike.append(span)
            kept.append(span)
        else:
            notes.append(
                f"line {span[0] + 1}: the {what} of line {copied[0] + 1} stands in the file again; it was read once"
            )
    return kept, tuple(notes)
