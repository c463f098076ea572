"""Distinguishes files that may contain a record of unknown format from texts and pictures in the same folder."""

import re
from collections import defaultdict
from collections.abc import Callable, Sequence
from itertools import groupby
from pathlib import PurePath

from rockpulse.errors import RockpulseError
from rockpulse.readers.source import SourceFile

#: Suffixes of files that are ignored in folders, without a row in the table of failures, unless the user names them.
_QUIET = frozenset({".md", ".toml", ".h5", ".journal", ".journal-journal", ".part", ".html", ".pdf", ".png"})
#: Pattern of the first element of XML files that describe a station or an earthquake; other XML may contain samples.
_METADATA = re.compile(rb"<(?:\w+:)?(?:FDSNStationXML|quakeml|inventory\b[^>]*(?:geofon|seiscomp))", re.IGNORECASE)
#: Names of files that agencies add to their records, in lower case and without suffix.
_BESIDE = frozenset({"readme", "disclaimer", "license", "licence", "copyright", "citation"})
#: Beginning of the name of PEER's list of search results, which contains spectra, and so rows of numbers.
_SEARCH_RESULTS = "_searchresults"
#: Suffixes of pictures, documents, maps and programs; .log and .ini files are judged from their content, as texts.
_SUFFIXES = (
    ".avi .bib .bmp .cpg .db .dbf .dll .doc .docx .eps .exe .gif .heic .htm .html .ipynb .jpeg .jpg .kml .kmz .lnk .md "
    ".mov .mp4 .odt .parquet .pdf .png .ppt .pptx .prj .ps .py .pyc .rtf .shp .shx .sqlite .svg .tex .tif .tiff .webp"
)
_DOCUMENTS = frozenset(_SUFFIXES.split())
#: Pattern of the first bytes of files without records, whatever their name: pictures, documents, programs, databases,
#: logs such as those of ``--log-file``, responses of instruments (RESP).
_OTHER = re.compile(
    rb"\x89PNG\r\n|\xff\xd8\xff|GIF8[79]a|%PDF-|%!PS|\x7fELF|SQLite format 3\x00|"
    rb"\d{4}-\d\d-\d\d[ T]\d\d:\d\d:\d\d\S* (?:DEBUG|INFO|WARNING|ERROR|CRITICAL)\b|(?:#[^\n]*\n)*B050F03\b"
)
#: A line of PEER's list of search results, which may have any name.
_SEARCH_LINE = b"-- Summary of Metadata of Selected Records"
#: Pattern of the first two headings of tables that the program writes (``rockpulse export``) or reads (events,
#: weights). One heading is not enough: a series may have the headings "event,NS,EW".
_OWN_TABLE = re.compile(
    rb"(?:\xef\xbb\xbf)?(?:record[,;] *(?:block|case|model|demand|source|event|weight|wave|sample|rotation|pair|"
    rb"direction|half_cycle)|(?:event|weight)[,;] *record|"
    rb"block[,;] *(?:case|model|demand|limit_state|measure|width)|pair[,;] *(?:direction|block|case|model|pga_median)|"
    rb"file[,;] *stage)\b",
    re.IGNORECASE,
)
#: Pattern of headings of flat files and of lists of stations and files, one of which must be in the first line.
_PARAMETER = re.compile(
    rb"npts|pga|pgv|rrup|rjb|r_?epi|vs_?30|magnitude|mag\b|file_?name|file\b|station|rsn", re.IGNORECASE
)
_PARAMETERS = re.compile(
    r"file|files|file ?name|path|record|record (?:id|name|number)|rsn|id|npts|n ?pts|dt|duration|pga\w*|pgv\w*|pgd\w*|"
    r"(?:peak|max)(?: ground)?(?: acc\w*| vel\w*| disp\w*)?|ia|arias(?: intensity)?|cav|d5 ?95|d5 ?75|"
    r"mag(?:nitude)?|mw|ml|ms|m|"
    r"rrup|rjb|rx|repi|r epi|rhyp|r hyp|epicentral distance|distance|dist|depth|hypocentr\w+ depth|vs ?30|vs ?30 m s|"
    r"station|station (?:id|name|code)|sta|network|net|event|event (?:id|name)|eq ?id|earthquake(?: name)?|year|date|"
    r"lat(?:itude)?|lon(?:gitude)?|station latitude|station longitude|mechanism|site class|azimuth|component|channel|"
    r"orientation|scale factor|tp|pulse period"
)
#: Pattern of headings of samples: a file with them is a series, whatever its other headings are.
_SAMPLES_OF = re.compile(r"time|t|acc|accel|acceleration|ax|ay|az|accx|accy|accz")
_LONGEST_HEADING, _FEWEST_PARAMETERS = 4000, 3
_SPREADSHEETS = frozenset({".ods", ".xls", ".xlsm", ".xlsx"})
#: Pattern of suffixes of records; suffixes of texts and tables (.txt, .csv) are not characteristic.
_RECORDS = re.compile(
    r"\.(?:v[0-3][a-z]?|[avd]t2|acc|acl|vel|dis|dsp|raw|smc|m?seed|msd|sac|asc|dat|th|evt|gcf|gse2?|sg2|segy|knt|"
    r"(?:ew|ns|ud)[12]?|[ensuz]\d\w|\d{3})"
)
#: Pattern of control characters that texts do not contain: not tabs, line breaks and the end-of-file mark of DOS.
_BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1c-\x1f]")
#: Pattern of the first lines of texts whose samples are coded in letters (GSE).
_CODED = re.compile(rb"^(?:WID[12]|XW0[12]) ", re.MULTILINE)
_DECIMAL = re.compile(r"[.,]\d")
_DIGITS = re.compile(r"\d+")
_LETTERS = re.compile(r"[^\W\d_]+")
#: Pattern of letters that are part of a number, or replace one.
_OF_NUMBERS = re.compile(r"(?<=[\d.])[ed](?=[+-]?\d)|(?<![^\W\d_])(?:nan|inf|null|none|na)(?![^\W\d_])", re.IGNORECASE)
_FEWEST = 40  # smallest number of groups of digits in a series: 20 samples with decimal points
#: Number of consecutive rows of numbers that may be the beginning of data, whatever precedes them.
_RUN = 10
_COMPONENTS = 4  # largest number of channels whose rows may alternate in a series


def is_quiet(name: str, opened: Callable[[], SourceFile]) -> bool:
    """Return whether a file is ignored without a message, judged by its suffix or, for XML, by its content."""
    suffix = PurePath(name).suffix.lower()
    if suffix != ".xml":
        return suffix in _QUIET
    try:
        return _METADATA.search(opened().head) is not None
    except (RockpulseError, OSError):  # the error is reported when the file is read
        return False


def may_be_record(file: SourceFile) -> bool:
    """Return whether an unrecognised file may be a record, judged by its suffix and its content."""
    if _OTHER.match(file.head) or _METADATA.search(file.head):
        return False
    suffix = file.path.suffix.lower()
    if _RECORDS.fullmatch(suffix):
        return True
    stem = file.path.stem.lower()
    if stem in _BESIDE or stem.startswith(_SEARCH_RESULTS) or suffix in _DOCUMENTS or _SEARCH_LINE in file.head:
        return False
    if suffix in _SPREADSHEETS or _BINARY.search(file.head) or _CODED.search(file.head):
        return True
    text = file.head.decode("utf-8", errors="replace")
    if is_table(file) or len(_DIGITS.findall(text)) < _FEWEST:
        return False
    return _is_series([line for line in text.splitlines() if any(map(str.isalnum, line))])


def _is_series(lines: Sequence[str]) -> bool:
    """Return whether a text is mainly a series: rows of numbers that all contain the same words."""
    words = [_words(line) for line in lines]
    digits: dict[tuple[str, ...], int] = defaultdict(int)
    for line, key in zip(lines, words, strict=True):
        if key is not None:
            digits[key] += sum(map(len, _DIGITS.findall(line)))
    if not digits:
        return False
    common = max(digits, key=lambda key: digits[key])
    together = max(len(list(run)) for key, run in groupby(words) if key == common)
    letters = sum(len(word) for line in lines for word in _LETTERS.findall(line))
    if 2 * words.count(common) >= len(lines) or together >= _RUN:
        return True
    return digits[common] >= letters and _COMPONENTS * digits[common] >= sum(digits.values())


def _words(line: str) -> tuple[str, ...] | None:
    """Return the words of a row except those within numbers; None for a line of running text."""
    if not _DECIMAL.search(line) and len(_DIGITS.findall(line)) < len(_LETTERS.findall(line)):
        return None
    return tuple(_LETTERS.findall(_OF_NUMBERS.sub(" ", line)))


def is_table(file: SourceFile) -> bool:
    """Return whether a file is a table of results, or a flat file with parameters of one record in each row."""
    if _OWN_TABLE.match(file.head):
        return True
    end = file.head.find(b"\n", 0, _LONGEST_HEADING)
    if end < 0 or not _PARAMETER.search(file.head, 0, end):
        return False
    heading = file.head[:end].decode("utf-8", errors="replace").lower()
    delimiter = max(",;\t", key=heading.count)
    cells = [cell.strip().strip('"') for cell in heading.split(delimiter)]
    words = [" ".join(re.split(r"[\W_]+", re.sub(r"[(\[].*", "", cell))).strip() for cell in cells]
    known = {word for word in words if _PARAMETERS.fullmatch(word)}
    motion = any(_SAMPLES_OF.fullmatch(word) for cell in cells for word in re.split(r"[\W_\d]+", cell))
    return len(cells) > 2 and len(known) >= _FEWEST_PARAMETERS and not motion


def advice(file: SourceFile) -> str:
    """Return the advice in the message on a file that no reader recognises."""
    if file.path.suffix.lower() in _SPREADSHEETS:
        return "it is a spreadsheet: save it as CSV with columns of time and acceleration, and give the unit"
    return "convert it to columns of time and acceleration, and give the unit"
