"""Whether a file that no reader knows may be a record all the same, or is a text, a table or a picture."""

from __future__ import annotations

import re

from rockpulse.readers.source import SourceFile

__all__ = ["may_be_record"]

#: Names of files that agencies put beside their records, in lower letters and without suffix; PEER's list of what was
#: found holds spectra, and so rows of numbers.
_BESIDE = frozenset({"readme", "disclaimer", "license", "licence", "copyright", "citation", "_searchresults"})
#: Suffixes of pictures, documents and maps.
_SUFFIXES = (
    ".bmp .doc .docx .eps .gif .htm .html .jpeg .jpg .json .kml .kmz .md .ods .odt .pdf .png .ppt .pptx .ps .rtf .svg "
    ".tif .tiff .xls .xlsx .xml .yaml .yml"
)
_DOCUMENTS = frozenset(_SUFFIXES.split())
#: Suffixes that records have; those of texts and tables (.txt, .csv) tell nothing.
_RECORDS = re.compile(
    r"\.(?:v[0-3][a-z]?|[avd]t2|acc|acl|vel|dis|dsp|raw|smc|m?seed|msd|sac|asc|dat|th|evt|gcf|gse2?|sg2|segy|knt|"
    r"(?:ew|ns|ud)[12]?|[ensuz]\d\w|\d{3})"
)
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[ed][-+]?\d+)?", re.IGNORECASE | re.ASCII)
_BETWEEN = re.compile(r"[\s,;|]+")


def may_be_record(file: SourceFile) -> bool:
    """Whether something speaks for a record: the suffix, binary data, or as many rows of numbers as of words.

    Parameters
    ----------
    file : SourceFile
        A file that no reader has recognised; its first bytes are looked at.
    """
    suffix = file.path.suffix.lower()
    if file.path.stem.lower() in _BESIDE or suffix in _DOCUMENTS:
        return False
    if _RECORDS.fullmatch(suffix) or b"\x00" in file.head:
        return True
    lines = [line.strip() for line in file.head.decode("utf-8", errors="replace").splitlines() if line.strip()]
    numbers = sum(all(_NUMBER.fullmatch(field) for field in _BETWEEN.split(line) if field) for line in lines)
    return 2 * numbers >= len(lines)
