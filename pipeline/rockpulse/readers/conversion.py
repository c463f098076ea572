"""Writes records to files for other programs; if one file cannot be written, no file is written."""

import logging
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rockpulse.errors import ConfigError, RecordFormatError, RecordRefused, RockpulseError
from rockpulse.files import FileSet
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers.formats.obspy_formats import is_miniseed
from rockpulse.readers.source import HEAD, SourceFile, check_link, folder_station_files, open_source
from rockpulse.readers.writers import at2_bytes, azimuth_of, csv_bytes, miniseed_bytes, orientation_of
from rockpulse.record.record import Record

logger = logging.getLogger("rockpulse")
_UNDERFLOW = 1e-97  # largest error of a sample that is written as zero [m/s2]
#: Largest relative change of a sampling interval by writing and reading: miniSEED stores the rate in single precision.
_STEP_TOLERANCE = 1e-7
_AZIMUTH_TOLERANCE = 1e-4  # largest change of an azimuth by writing and reading [degrees]


@dataclass(frozen=True)
class Writer:
    """A format in which records can be written."""

    suffix: str  # suffix of the files that it writes
    suffixes: tuple[str, ...]  # all suffixes of the format, in lower case
    lost: str  # describes the properties of a record that the files cannot contain
    # returns the content of the file of one record; None if all records go into one file
    one: Callable[[Record], bytes] | None = None
    digits: float = 0.0  # largest relative rounding error of a sample; 0 if samples are stored exactly
    # whether every azimuth and state of processing is stored; if not, reading may lose but never change them
    whole: bool = True
    structure: bool = False  # whether a file states that its channel is on a structure


_AT2 = "AT2 stores accelerations in g to 8 digits, plus event, date, station and direction, but not the start time, "
_AT2 += "the codes, the processing or the warnings"
_CSV = "CSV stores accelerations in m/s2 at full precision, the interval and the direction (in whole degrees), and "
_CSV += "nothing else"
_MSEED = "miniSEED stores accelerations in m/s2 at full precision, start times, and codes as far as they fit; its "
_MSEED += "StationXML, which has the same name, stores the directions and whether a record is raw; the event, the "
_MSEED += "processing and the warnings are not stored"
#: The formats by their names for ``rockpulse convert --format``.
WRITERS = {
    "at2": Writer(".AT2", (".at2",), _AT2, at2_bytes, digits=0.51e-7, structure=True),
    "csv": Writer(".csv", (".csv",), _CSV, csv_bytes, whole=False),
    "mseed": Writer(".mseed", (".mseed", ".miniseed", ".ms"), _MSEED),
}


class Written(NamedTuple):
    """A written file, the ids of its records, and their names in the file (empty for a single record)."""

    path: Path
    records: tuple[tuple[str, str], ...]


def write(
    records: Record | Sequence[Record], out: str | os.PathLike[str], format: str | None = None, overwrite: bool = False
) -> list[Written]:
    """Write records as AT2, CSV or miniSEED.

    Parameters
    ----------
    records : Record or sequence of Record
        Records to write, at least one, with distinct ids. Samples are written unchanged: a raw record remains raw.
    out : path
        A file, whose suffix gives the format, or for AT2 and CSV a folder. An AT2 or CSV file contains one record:
        for several records, the channel (or the id) is inserted before the suffix of ``out``; in a folder, each file is
        named by the id of its record. A miniSEED file contains all records, and a StationXML of the same name is
        written next to it.
    format : {"at2", "csv", "mseed"}, optional
        Required for a folder; by default the format of the suffix.
    overwrite : bool
        Whether existing files may be replaced. A StationXML is replaced only if rockpulse wrote it; the files from
        which the records were read are never replaced.

    Returns
    -------
    list of Written
        The files in the order of the records. Only AT2 states that a channel is on a structure; for the other formats
        a warning is logged.

    Raises
    ------
    ConfigError
        If there is no record, the format is unknown, a file exists already, or a folder does not exist.
    RecordRefused
        If a record would not be the same after writing and reading; nothing is written.
    OSError
        For an error of the operating system; all files remain unchanged.

    Examples
    --------
    >>> rp.write(record, "burst.AT2", overwrite=True)[0].path.name
    'burst.AT2'
    """
    records = [records] if isinstance(records, Record) else list(records)
    if not records:
        raise ConfigError(f"{out}: no record to write")
    writer, folder = _format(Path(out), format)
    targets = _targets(records, Path(out), writer, folder)
    parent = Path(out).absolute().parent
    if not parent.is_dir():
        raise ConfigError(f"{out}: there is no folder {parent}; create it first")
    _check_targets([*targets, *_companions(targets, writer)], _sources(records), overwrite)
    with ExitStack() as made, FileSet() as files:
        if folder and not Path(out).is_dir():
            Path(out).mkdir()
            made.callback(_remove_empty, Path(out))
        written = []
        for path, items in targets.items():
            contents, names = _contents(path, items, writer)
            for target, content in contents.items():
                files.add(target, content)
            _check_comes_back(path, contents, dict(zip(names, items, strict=True)), writer)
            written.append(Written(path, tuple((record.id, code) for record, code in zip(items, names, strict=True))))
        files.commit()
    for record in records:
        if record.orientation == "structural" and not writer.structure:
            logger.warning("%s: the sensor is on a structure, which %s files cannot state", record.id, writer.suffix)
    return written


def _sources(records: Sequence[Record]) -> set[str]:
    """Return the paths of all files from which the records may have been read."""
    sources = set()
    for text in {record.source for record in records if record.source}:
        # "; " separates the files of a joined record, "!" follows an archive; file names may contain both marks, too.
        parts = text.split("; ")
        for first, last in combinations(range(len(parts) + 1), 2):
            name = "; ".join(parts[first:last])
            ends = [*(match.start() for match in re.finditer("!", name)), len(name)]
            sources |= {os.path.realpath(name[:end]) for end in ends if end}
    return sources


def check_output(out: str | os.PathLike[str], format: str | None = None) -> Writer:
    """Return the writer for a path or a format name; raise ConfigError as `write` does."""
    return _format(Path(out), format)[0]


def _format(out: Path, name: str | None) -> tuple[Writer, bool]:
    """Return the writer of the format, and whether `out` is a folder rather than a file."""
    by_suffix = next((key for key, row in WRITERS.items() if out.suffix.lower() in row.suffixes), None)
    folder = out.is_dir() or by_suffix is None
    key = name or (None if out.is_dir() else by_suffix)
    if key not in WRITERS:
        raise ConfigError(
            f"{out}: expected a format, one of {', '.join(WRITERS)}, found {name or out.suffix or 'none'!r}; "
            "give the format (--format), or a file name that ends in one of "
            f"{', '.join(suffix for row in WRITERS.values() for suffix in row.suffixes)}"
        )
    if by_suffix is None and out.suffix and not out.is_dir():
        ends, advice = WRITERS[key].suffix, "correct the name, or, if it is meant as a folder, create it first"
        raise ConfigError(f"{out}: expected the suffix {ends} for the format {key}, found {out.suffix!r}; {advice}")
    if not folder and by_suffix != key:
        raise ConfigError(
            f"{out}: the suffix belongs to the format {by_suffix}, but the format is {key}; correct one of them"
        )
    if folder and out.exists() and not out.is_dir():
        raise ConfigError(
            f"{out}: expected a folder, or a name that ends in {WRITERS[key].suffix}, found a file; choose another name"
        )
    if folder and WRITERS[key].one is None:
        raise ConfigError(
            f"{out}: miniSEED holds all records in one file; name that file, such as {out / 'records.mseed'}"
        )
    return WRITERS[key], folder


def _targets(records: Sequence[Record], out: Path, writer: Writer, folder: bool) -> dict[Path, list[Record]]:
    if writer.one is None or (len(records) == 1 and not folder):
        return {out: list(records)}
    ids = [record.id.lstrip(".") for record in records]  # a file that begins with a point is hidden
    if len({name.lower() for name in ids}) < len(ids):
        raise ConfigError(f"{out}: expected records with different ids, found {', '.join(ids)}; write fewer at a time")
    if folder:
        return {out / f"{name}{writer.suffix}": [record] for name, record in zip(ids, records, strict=True)}
    channels = [re.sub(r"[^A-Za-z0-9_~-]+", "_", record.channel) for record in records]
    distinct = len({channel.lower() for channel in channels}) == len(records) and all(channels)
    labels = channels if distinct else ids
    named = zip(labels, records, strict=True)
    return {out.with_name(f"{out.stem}.{label}{out.suffix}"): [record] for label, record in named}


def _companions(targets: dict[Path, list[Record]], writer: Writer) -> Iterator[Path]:
    """Yield the path of the StationXML of each miniSEED file; raise an error if another file would use it, too."""
    if writer.one is not None:
        return
    for path in targets:
        own = path.with_suffix(".xml")
        twin = next((other for other in path.parent.iterdir() if _shares_station_file(other, path)), None)
        if twin is not None:
            raise ConfigError(
                f"{path}: its StationXML, {own.name}, would also be read with {twin.name}; choose another name"
            )
        yield own


def _shares_station_file(other: Path, path: Path) -> bool:
    """Return whether `other` is a miniSEED file whose StationXML has the same path as the StationXML of `path`."""
    if SourceFile(other.name, b"", bytes).path.stem != path.stem or not other.is_file():
        return False
    if path.exists() and other.samefile(path):
        return False
    try:
        return is_miniseed(open_source(other).head, other.name)
    except RockpulseError:  # an empty or damaged file or an archive is not miniSEED
        return False


def _check_targets(paths: Sequence[Path], sources: set[str], overwrite: bool) -> None:
    """Raise an error if a file to write exists and may not be replaced, or if a record was read from it."""
    for path in paths:
        check_link(path)
        if os.path.realpath(path) in sources:
            raise ConfigError(f"{path}: this is an input file; choose another name for the output")
        if path.exists() and not path.is_file():
            raise ConfigError(f"{path}: expected the name of a file, found a folder or a device")
        if path.exists() and not overwrite:
            raise ConfigError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
        if path.exists() and path.suffix == ".xml" and b"<Source>rockpulse" not in path.read_bytes()[:HEAD]:
            found = "a StationXML that rockpulse did not write is never replaced"
            raise ConfigError(f"{path}: {found}; choose another name")


def _remove_empty(folder: Path) -> None:
    if not any(folder.iterdir()):
        folder.rmdir()


def _contents(path: Path, records: Sequence[Record], writer: Writer) -> tuple[dict[Path, bytes], list[str]]:
    """Return the content of a file and of its StationXML by path, and the names of the records in the file."""
    if writer.one is not None:
        return {path: writer.one(records[0])}, [""]
    own = path.with_suffix(".xml")
    beside = [(name, content) for name, content in folder_station_files(path.parent) if name != str(own)]
    try:
        content, metadata, names = miniseed_bytes(records, beside)
    except RecordFormatError as fault:
        raise RecordRefused(f"{path}: a StationXML in its folder is damaged ({fault}); repair or remove it") from fault
    return {path: content, own: metadata}, names


def _check_comes_back(path: Path, contents: dict[Path, bytes], records: dict[str, Record], writer: Writer) -> None:
    """Read a written file again, as a user would; raise an error if a record differs from the written record."""

    def station_files() -> list[tuple[str, bytes]]:
        own = {str(name): content for name, content in contents.items() if name != path}
        others = [(name, content) for name, content in folder_station_files(path.parent) if name not in own]
        return [*others, *own.items()]

    content = contents[path]
    try:
        back = read_source(SourceFile(str(path), content[:HEAD], lambda: content, station_files), ReadOptions("m/s2"))
    except RockpulseError as fault:
        found = f"the file could not be read back ({fault}); no file was kept: write into another folder"
        raise RecordRefused(f"{path}: {found}") from fault
    if len(back) != len(records):
        raise RecordRefused(f"{path}: only {len(back)} of {len(records)} records can be read back; use another format")
    for again in back:
        # A file of one record has no name for it.
        code = f"{again.network}.{again.station}.{again.location}.{again.channel}"
        record = records[code if writer.one is None else ""]
        tolerance = writer.digits * np.abs(record.acceleration) + (_UNDERFLOW if writer.digits else 0.0)
        if again.npts != record.npts or np.any(np.abs(again.acceleration - record.acceleration) > tolerance):
            raise RecordRefused(f"{path}: the samples of {record.id} would differ after reading; use another format")
        if abs(again.dt / record.dt - 1.0) > _STEP_TOLERANCE:
            reason = f"the sampling interval of {record.id}, {record.dt!r} s, would be read back as {again.dt!r} s"
            raise RecordRefused(f"{path}: {reason}; use another format, or resample the record")
        lost = _wrong(record, again, writer.whole)
        if lost:
            raise RecordRefused(f"{path}: {record.id}: {lost}; no file was kept: use another format")


def _wrong(record: Record, again: Record, whole: bool) -> str:
    """Return how the record read back, `again`, differs in direction or processing, or, if `whole`, lacks them."""
    lies, azimuth, back = orientation_of(record), azimuth_of(record), again.azimuth
    stated = lies != "unknown"  # otherwise, the file name may state a direction
    if stated and again.orientation not in (lies, record.orientation, "unknown"):
        return f"the orientation would be read back as {again.orientation!r} instead of {lies!r}"
    known = record.orientation != "vertical" and np.isfinite(azimuth)
    off = abs((back - azimuth + 180.0) % 360.0 - 180.0) if known else np.nan
    if stated and not (off <= _AZIMUTH_TOLERANCE if np.isfinite(back) else not (known and whole)):
        return f"the azimuth would be read back as {back:g} instead of {azimuth:g}"
    if again.processed != record.processed and (whole or again.processed is not None):
        return f"its property processed would be read back as {again.processed} instead of {record.processed}"
    return ""
