"""Tell a file that may hold a record, though no reader knows it, from a text or a picture beside the records.

A file that is taken for no record gets but a short row among others, so a file that may hold data must never be taken
for one: in doubt it is a record.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import groupby
from pathlib import PurePath

from rockpulse.errors import RockpulseError
from rockpulse.readers.source import SourceFile

__all__ = ["advice", "is_quiet", "may_be_record"]

#: Suffixes of files that lie beside records and are passed over without a row unless they are named explicitly.
_QUIET = frozenset({".md", ".toml", ".h5", ".journal", ".journal-journal", ".part", ".html", ".pdf", ".png"})
#: First element of XML files of a station or an earthquake; other XML files may hold samples.
_METADATA = re.compile(rb"<(?:\w+:)?(?:FDSNStationXML|quakeml)\b", re.IGNORECASE)

#: Names of files that agencies put beside their records, in lower letters and without suffix; PEER's list of what was
#: found holds spectra, and so rows of numbers.
_BESIDE = frozenset({"readme", "disclaimer", "license", "licence", "copyright", "citation", "_searchresults"})
#: Suffixes of pictures, documents and maps.
_SUFFIXES = (
    ".bmp .doc .docx .eps .gif .htm .html .jpeg .jpg .kml .kmz .md .odt .pdf .png .ppt .pptx .ps .rtf .svg .tif .tiff"
)
_DOCUMENTS = frozenset(_SUFFIXES.split())
_SPREADSHEETS = frozenset({".ods", ".xls", ".xlsm", ".xlsx"})
#: Suffixes that records have; those of texts and tables (.txt, .csv) tell nothing.
_RECORDS = re.compile(
    r"\.(?:v[0-3][a-z]?|[avd]t2|acc|acl|vel|dis|dsp|raw|smc|m?seed|msd|sac|asc|dat|th|evt|gcf|gse2?|sg2|segy|knt|"
    r"(?:ew|ns|ud)[12]?|[ensuz]\d\w|\d{3})"
)
#: Control characters that no text has; it has tabs and breaks, and from DOS an end-of-file mark.
_BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1c-\x1f]")
_DECIMAL = re.compile(r"[.,]\d")
_DIGITS = re.compile(r"\d+")
_LETTERS = re.compile(r"[^\W\d_]+")
#: No series has less groups of digits than 20 samples with a point have.
_FEWEST = 40
#: So many rows of numbers, one after the other, may be the beginning of data whatever stands before them.
_RUN = 10


def is_quiet(name: str, opened: Callable[[], SourceFile]) -> bool:
    """Whether a file that nobody named is passed over without a row, by its name or, for XML, by its beginning.

    The name is a path or ``archive.zip!member``; `opened` returns the file and is called for XML only.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix != ".xml":
        return suffix in _QUIET
    try:
        return _METADATA.search(opened().head) is not None
    except (RockpulseError, OSError):  # whoever reads it says why
        return False


def may_be_record(file: SourceFile) -> bool:
    """Whether a sign speaks for a record in a file that no reader has recognised: the suffix, binary data, or numbers.

    Numbers count that are half of the rows, ten rows together, or half of all letters and digits, and no mere handful;
    only the first bytes of the file are looked at.
    """
    suffix = file.path.suffix.lower()
    if _RECORDS.fullmatch(suffix):
        return True
    if file.path.stem.lower() in _BESIDE or suffix in _DOCUMENTS:
        return False
    if suffix in _SPREADSHEETS or _BINARY.search(file.head):
        return True
    text = file.head.decode("utf-8", errors="replace")
    if len(_DIGITS.findall(text)) < _FEWEST:
        return False
    rows = [_of_numbers(line) for line in text.splitlines() if any(map(str.isalnum, line))]
    together = max((len(list(run)) for numbers, run in groupby(rows) if numbers), default=0)
    digits, letters = (sum(map(len, what.findall(text))) for what in (_DIGITS, _LETTERS))
    return 2 * sum(rows) >= len(rows) or together >= _RUN or digits >= letters


def _of_numbers(line: str) -> bool:
    """Whether a line has a decimal, or as many numbers as words: columns without a gap, dates, labels, units too."""
    return bool(_DECIMAL.search(line)) or len(_DIGITS.findall(line)) >= len(_LETTERS.findall(line))


def advice(file: SourceFile) -> str:
    """The advice in the message about a file that no reader recognises."""
    if file.path.suffix.lower() in _SPREADSHEETS:
        return "it is a spreadsheet: save it as CSV, columns of time and acceleration, and give the unit"
    return "convert it to columns of time and acceleration, and give the unit"
