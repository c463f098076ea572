"""Escapes text from files, headers and other libraries for a terminal, a log, a table or a page."""

import re

#: Control characters (C0 except tab and line feed, C1), unusual line breaks, marks of writing direction, and unpaired
#: surrogates, which cannot be encoded.
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")
#: Pattern of the start of a formula in a spreadsheet, and pattern of numbers, which are no formulas.
_FORMULA, _NUMBER = re.compile(r"[=+\-@\t]."), re.compile(r"[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?")
#: Largest number of characters shown of a message of another library.
_LONGEST = 300


def escaped(text: str) -> str:
    """Escape each control character of a text."""
    return _UNSAFE.sub(lambda found: found[0].encode("unicode_escape").decode("ascii"), text)


def first_line(error: object) -> str:
    """Return the first line of a message of another library, at most 300 characters."""
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0] if len(lines[0]) <= _LONGEST else f"{lines[0][:_LONGEST]}..."


def not_a_formula(text: str) -> str:
    """Put an apostrophe before a text that a spreadsheet would read as a formula; numbers are unchanged."""
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def in_utf8(text: str) -> str:
    """Return a string that HDF5 and a journal can store; bytes that are not UTF-8 become the replacement character."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace").replace("\0", "\ufffd")
