"""Text from files, headers and other libraries, on its way to a terminal, a log, a table or a page."""

import re

#: Control characters (C0 less tab and the end of a line, C1), ends of lines that only some programs know, marks that
#: turn the direction of writing, and halves of surrogate pairs, which no encoding has.
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")
#: Beginnings of what a spreadsheet computes, and numbers, which it may read as such.
_FORMULA, _NUMBER = re.compile(r"[=+\-@\t]."), re.compile(r"[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?")
#: The longest part of a foreign message that is shown.
_LONGEST = 300


def escaped(text: str) -> str:
    """The text with each character that a terminal or a page would obey as an escape."""
    return _UNSAFE.sub(lambda found: found[0].encode("unicode_escape").decode("ascii"), text)


def first_line(error: object) -> str:
    """The first line of a message of another library, no longer than 300 characters."""
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0] if len(lines[0]) <= _LONGEST else f"{lines[0][:_LONGEST]}..."


def not_a_formula(text: str) -> str:
    """The text of a cell, after an apostrophe where a spreadsheet would take it for a formula; a number stays one."""
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text
