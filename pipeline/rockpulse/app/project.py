"""A project folder, which contains the configuration, records and results, as for the commands."""

import re
import shutil
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import fields, replace
from filecmp import cmp
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from threading import Lock
from typing import Any, Literal, TypeAlias

from rockpulse.app.child import Command
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.body_table import read_bodies, unused_columns
from rockpulse.config.configuration import (
    Config,
    config_from_text,
    config_of,
    document_as_text,
    load_config,
    section_of,
    section_values,
)
from rockpulse.config.study_settings import HazardSettings, SelectionSettings
from rockpulse.errors import ConfigError, Failure, RockpulseError
from rockpulse.files import TOML_LIMIT, parse_toml, read_text, write_files
from rockpulse.readers.file_pairs import PairSettings
from rockpulse.readers.folders import find_files, read_all
from rockpulse.record.record import Record
from rockpulse.selection.events import event_table, events_by_id
from rockpulse.views.shared.files_used import failure_rows
from rockpulse.views.shared.words import writing

#: Names of the files of a project.
CONFIG, RECORDS, RESULTS, TABLE = "site.toml", "records", "results.h5", "results.csv"
HAZARD, FRAGILITY, RISK = "hazard.csv", "fragility.h5", "risk.csv"
SELECTION, SPECTRA = "selection.csv", "selection.png"
#: Commands that repeat what the page does.
ASSESS = ("assess", "--config", CONFIG, "-o", RESULTS)
#: First line of a configuration of the page; another one is copied before it is replaced, for its comments.
HEAD = "# Written by rockpulse app, which keeps no comments."
#: Characters of a file name that are kept, largest length [bytes], largest number of folders and file in a path,
#: and names that Windows reserves.
DEEPEST = 6
_ODD, LONGEST = re.compile(r"[^\w .()+=@,~-]+"), 120
_RESERVED = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\.|$)")


#: Kinds of files that are sent to the project.
Kind: TypeAlias = Literal["records", "bodies", "hazard"]


def safe_name(name: str) -> str:
    """Return a file name without folders and special characters; "file" if nothing remains."""
    last = _ODD.sub("_", re.split(r"[/\\]", name)[-1]).strip(" .")
    end = Path(last).suffix[:20]
    if len(last.encode()) > LONGEST:
        last = last.encode()[: LONGEST - len(end.encode())].decode(errors="ignore") + end
    return f"_{last}" if _RESERVED.match(last) else last or "file"


def safe_path(name: str) -> Path:
    """Return a relative path of safe names, made from the last parts of a path with the separator ``/``."""
    parts = [part for part in name.split("/") if part.strip(" .")][-DEEPEST:]
    return Path(*map(safe_name, parts or [name]))


def samples() -> list[Path]:
    """Return the sample records that come with the program; empty if they are not installed."""
    inside = Path(str(files("rockpulse.app"))) / "samples"
    folder = inside if inside.is_dir() else Path(__file__).parents[3] / "data" / "samples" / "records"
    return sorted(folder.iterdir()) if folder.is_dir() else []


class Project:
    """A project folder with ``site.toml``, the configuration, which the page changes and the commands read.

    Attributes
    ----------
    document : dict
        Sections and keys of the configuration as in TOML, without keys that have their default value.
    error : str
        The reason why the document is not valid and was not written; empty if it is valid.
    written : str
        Text of the configuration when it was last read or written.
    assessed : int
        Number of assessments that have ended with results.
    kept : tuple
        The records and failures that were read last.
    command : Command
        The command that is running, or that ran last.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.command = Command(self.folder)
        self.document: dict[str, Any] = {}
        self.error, self.written, self.assessed = "", "", 0
        self._reading = Lock()
        self._state: Any = None  # of the configuration and the files when the records were read
        self.kept: tuple[list[Record], list[Failure]] = [], []
        self.load()

    @property
    def path(self) -> Path:
        """Path of the configuration."""
        return self.folder / CONFIG

    def load(self) -> None:
        """Read the configuration, or start an empty one if there is no file; raise ConfigError if it is not valid."""
        self.written = read_text(self.path, TOML_LIMIT, "a TOML file") if self.path.exists() else ""
        if self.written:
            load_config(self.path)
        self.document, self.error = parse_toml(self.written, str(self.path)), ""

    @property
    def changed_outside(self) -> bool:
        """Whether another program has changed the configuration since it was last read or written."""
        return self.written != (read_text(self.path, TOML_LIMIT) if self.path.exists() else "")

    def section(self, name: str) -> dict[str, Any]:
        """Return a section, and create it if it is missing; changes to this dict change the configuration."""
        found: dict[str, Any] = self.document.setdefault(name, {})
        return found

    def several(self, name: str) -> list[dict[str, Any]]:
        """Return the list of all [[block]] or [[demand]] sections; changes to this list change the configuration."""
        found: list[dict[str, Any]] = self.document.setdefault(name, [])
        return found

    def save(self) -> str:
        """Write the configuration if it is valid, and return an empty text; otherwise return the error."""
        kept = {name: values for name, values in self.document.items() if values}
        try:
            config_of(kept, self.folder)
        except ConfigError as error:
            self.error = str(error)
            return self.error
        self.error, text = "", f"{HEAD}\n\n{document_as_text(kept)}"
        if text != self.written:
            if self.written and not self.written.startswith(HEAD):
                shutil.copy(self.path, self.path.with_name(f"{CONFIG}.bak"))
            write_files({self.path: text.encode()})
            self.written = text
        return ""

    def config(self) -> Config:
        """Return the configuration from its file."""
        return config_of(parse_toml(self.written, CONFIG), self.folder)

    def take(self, kind: Kind, name: str, path: Path) -> str:
        """Add an uploaded file, which errors call `name`; return a sentence on unused columns of a table of bodies."""
        takes: dict[str, Callable[[str, Path], str | None]]
        takes = {"records": self.add_record, "bodies": self.add_table, "hazard": self.set_hazard}
        try:
            return takes[kind](name, path) or ""
        except ConfigError as error:
            raise ConfigError(str(error).replace(str(path), name)) from None

    # Records

    def record_files(self) -> list[Path]:
        """Return the paths of the files in the folder of records and in its subfolders."""
        return sorted(path for path in (self.folder / RECORDS).rglob("*") if path.is_file())

    def add_record(self, name: str, path: Path, put: Callable[[Path, Path], object] = shutil.move) -> None:
        """Move a file into the folder of records, a path of the configuration, unless its content is there already."""
        paths = self.section("records").setdefault("paths", [])
        if RECORDS not in paths:
            paths.append(RECORDS)
            self.save()
        if any(cmp(path, other, shallow=False) for other in self.record_files()):
            return
        first = place = self.folder / RECORDS / safe_path(name)
        try:
            first.parent.mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError) as error:
            raise ConfigError(f"{error.filename}: expected a folder, found a file of this name") from None
        number = 1
        while place.exists():
            number += 1
            place = first.with_stem(f"{first.stem}-{number}")
        put(path, place)

    def add_samples(self) -> None:
        """Copy the sample records to the folder of records."""
        for path in samples():
            self.add_record(path.name, path, shutil.copyfile)

    def name_of(self, source: str) -> str:
        """Return the path of a record file as in the configuration, relative to the project folder if possible."""
        path = Path(source)
        return (path.relative_to(self.folder) if path.is_relative_to(self.folder) else path).as_posix()

    def remove(self, path: Path, ids: Collection[str] = ()) -> None:
        """Delete a record file, and the entries of the configuration for this file and for the channels `ids`."""
        name, records = self.name_of(str(path)), self.section("records")
        path.unlink(missing_ok=True)
        records["file"] = [row for row in records.get("file", []) if row["match"] != name]
        records["pair"] = self.pairs_without(name)
        records["confirm"] = [one for one in records.get("confirm", []) if one not in ids]
        self.save()

    def pairs_without(self, *names: str) -> list[dict[str, Any]]:
        """Return the pairs of the configuration that contain none of the given files."""
        paths = [str(self.folder / name) for name in names]
        pairs = self.section("records").get("pair", [])
        return [row for row in pairs if not any(map(PairSettings(**row).side, paths))]

    def remedy(self, file: str, key: str, value: Any) -> str:
        """Apply a remedy to a file; return the error if the configuration is then invalid, otherwise an empty text.

        The value is a unit for the key `units`, an interval for `dt`, the ids of channels for `confirm`, and the names
        of the north and the east file for `pair`; an empty value removes the pair of the file.
        """
        records = self.section("records")
        if key == "confirm":
            records["confirm"] = [*records.get("confirm", []), *value]
            return self.save()
        if key == "pair":
            pair = [dict(zip(("north", "east"), value, strict=True))] if value else []
            records["pair"] = self.pairs_without(file, *value) + pair
            return self.save()
        rows = records.setdefault("file", [])
        row = next((row for row in rows if row["match"] == file), None)
        if row is None:
            rows.append(row := {"match": file})
        row[key] = value
        return self.save()

    def read_records(self) -> tuple[list[Record], list[Failure]]:
        """Read all records as the commands do; raise ConfigError if a pattern of the configuration matches no file.

        All windows share the records, which are read again if a file in their folders or the configuration has changed.
        """
        given = self.config().records
        paths = [str(path) for path in self.config().record_paths()]
        if not self.record_files() and given.paths in ((), (RECORDS,)):
            return [], []
        with self._reading:
            folders = sorted({Path(one.path).parent for one in find_files(paths)[0]})
            stats = [(path, path.stat()) for folder in folders for path in sorted(folder.iterdir()) if path.exists()]
            state = given, [(path, found.st_size, found.st_mtime_ns) for path, found in stats]
            if self._state != state:
                self.kept = read_all(paths, given.units, None, given.dt, given.response, given.files, given.pairs)
                self._state = state
            return self.kept

    def earthquakes(self, records: list[Record], failures: list[Failure]) -> int:
        """Return the number of earthquakes of the records; raise ConfigError if the table of earthquakes is wrong."""
        return len(set(events_by_id(records, event_table(self.config()), failures)[0].values())) if records else 0

    def rejected(self) -> list[Failure]:
        """Return the failures after reading in the last assessment; empty if its inputs have changed since."""
        from rockpulse.storage.hdf5.results_file import open_results_file

        path = self.folder / RESULTS
        if not path.is_file() or self.outdated:
            return []
        with open_results_file(path) as file, writing("en"):  # as those of reading; the page translates all
            rows = failure_rows(file.tree("failures"))
        return [row for row in rows if row.kind == "failed" and row.stage not in ("find", "read", "pair")]

    # Bodies

    def add_table(self, name: str, path: Path) -> str:
        """Add the bodies of a table file; return a sentence on unused columns; raise ConfigError for a wrong table."""
        bodies, unused = read_bodies(path)
        known = {row.get("name") for row in self.several("block")}
        if twice := [body.name for body in bodies if body.name in known]:
            raise ConfigError(f'[[block]] name: "{twice[0]}" is given 2 times; names must differ')
        defaults = {item.name: item.default for item in fields(BlockSettings)}
        for body in bodies:
            values = section_values(body).items()
            self.several("block").append({key: value for key, value in values if value != defaults.get(key)})
        self.save()
        return unused_columns(name, unused)

    # Site

    def set_hazard(self, _: str, path: Path) -> None:
        """Use a file of hazard curves in place of a power law or another file.

        Raise ConfigError for an invalid file; the configuration is then unchanged.
        """
        from rockpulse.studies.risk.hazard_files import hazard_of

        replaced = ("k0", "k", "measure", "unit", "file")
        kept = {key: value for key, value in self.section("hazard").items() if key not in replaced}
        hazard_of(section_of(HazardSettings, kept | {"file": str(path)}), self.folder)
        path.replace(self.folder / HAZARD)
        self.document["hazard"] = kept | {"file": HAZARD}
        self.save()

    # Results

    @property
    def outdated(self) -> bool:
        """Whether there are results that are older than the last change to the configuration or to a record file."""
        return (self.folder / RESULTS).is_file() and not self.is_current(RESULTS)

    def is_current(self, name: str) -> bool:
        """Return whether a file of results exists that was made from the current records and configuration."""
        path, config = self.folder / name, self.config()
        tables = (config.records.events, config.check.file, config.fragility.selection)
        named = [self.folder / one for one in (*tables, *(one.selection for one in config.demands)) if one]
        if not path.is_file() or _newer(named, path) or self._records_changed(path):
            return False
        try:
            return _basis(_made_from(path, path.stat().st_mtime_ns)) == _basis(config)
        except RockpulseError:  # damaged, or from another version: the page offers to make it again
            return False

    def newer_than(self, made: Path) -> bool:
        """Return whether the configuration, the hazard or a file of records is newer than a file made from them."""
        inputs = (self.path, self.folder / (self.config().hazard.file or HAZARD))
        return made.is_file() and (_newer(inputs, made) or self._records_changed(made))

    def _records_changed(self, made: Path) -> bool:
        """Return whether a file of records was written, added or removed after a file was made from them."""
        folder = self.folder / RECORDS
        return _newer((folder, *folder.rglob("*")), made)  # a folder is as new as the last change of its list of files

    def report(self, language: str, suffix: str = ".html") -> Path:
        """Return the path of the report in a language."""
        return self.folder / f"report-{language}{suffix}"

    def downloads(self) -> Iterator[str]:
        """Yield the names of the files that the page offers for download."""
        yield from (path.name for path in self.folder.glob("report-??.*") if path.suffix in (".html", ".pdf"))
        made = (RESULTS, TABLE, CONFIG, FRAGILITY, RISK, SELECTION, SPECTRA)
        yield from (name for name in made if (self.folder / name).is_file())


def _newer(paths: Iterable[Path], made: Path) -> bool:
    when = made.stat().st_mtime_ns
    return any(path.stat().st_mtime_ns > when for path in paths if path.exists())


@lru_cache
def _made_from(path: Path, when: int) -> Config:
    """Return the configuration stored in a file of results; `when`, the time of the file, is a key of the cache."""
    from rockpulse.storage.hdf5.results_file import open_results_file

    with open_results_file(path) as file:
        return config_from_text(str(file.attrs.get("configuration", "")))


def _basis(config: Config) -> Config:
    """Return the configuration reduced to the options of an assessment and a fragility, without record folders."""
    records = replace(config.records, paths=tuple(Path(path).name for path in config.records.paths))
    return replace(config, records=records, hazard=HazardSettings(), selection=SelectionSettings())


def body_error(values: dict[str, Any]) -> ConfigError | None:
    """Return the error in the values of a body; None if they are correct."""
    try:
        section_of(BlockSettings, values).block()
    except ConfigError as error:
        return error
    return None
