"""Reads finished records from an existing results file, to which a run appends further records."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import NoReturn

import numpy as np

from rockpulse.assessment.assessment import Assessment
from rockpulse.assessment.tree import EVENT
from rockpulse.config.configuration import SECTIONS, Config, config_from_text
from rockpulse.errors import ConfigError, ResultsError, some
from rockpulse.record.record import BETWEEN
from rockpulse.run.analysis import Analysis, Part
from rockpulse.run.tasks import IDLE, OF_TASKS, Task, configuration_fingerprint
from rockpulse.storage.hdf5.netcdf4 import slab
from rockpulse.storage.hdf5.results_file import ResultsFile, open_results_file
from rockpulse.storage.hdf5.verification import verify
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS
from rockpulse.version import __version__

#: Attribute of the root of a results file: id of the run that wrote it, as in its journal.
RUN_ID = "run_id"
#: Attribute of the root: SHA-256 of all inputs of the run, from :func:`rockpulse.run.tasks.digest_of`.
RUN_DIGEST = "run_digest"
#: Attributes of the root: fingerprint of the program and the options, and the fingerprints of the tasks of
#: all rows of /summary, each shortened to DIGITS characters; PARTIAL for a task that also has a failure.
RUN_SETTINGS, RUN_ROWS = "run_settings", "run_rows"
DIGITS = 16
PARTIAL = "-" * DIGITS
#: Largest number of rows that are read at once.
ROWS = 64


@dataclass(frozen=True, eq=False)
class EarlierResults:
    """The finished tasks of an existing results file; the file is open only while it is read."""

    path: Path
    analysis: Analysis
    rows: Mapping[str, range]  # rows of /summary by key of the task
    stale: int = 0  # number of other tasks that have rows in the file, but must be processed again

    def parts(self, keys: Sequence[str], events: Mapping[str, str]) -> Iterator[Part]:
        """Yield the stored rows of the given tasks, with their earthquakes; consecutive rows are read together."""
        rows = np.array([row for key in keys for row in self.rows[key]])
        named = np.array([events[key] for key in keys for _ in self.rows[key]])
        # Blocks of consecutive rows, at most ROWS of them.
        number = np.cumsum(np.diff(rows, prepend=rows[0]) != 1) * rows.size + np.arange(rows.size) // ROWS
        begins = np.flatnonzero(np.diff(number, prepend=-1))
        with open_results_file(self.path) as file, file.reading():
            offsets = _offsets_in(file)
            for begin, end in pairwise([*begins.tolist(), rows.size]):
                part = _rows_of(file, self.analysis, offsets, int(rows[begin]), int(rows[end - 1]) + 1)
                yield {**part, EVENT: named[begin:end]}


def run_of(path: str | os.PathLike[str]) -> tuple[str, str]:
    """Return the id and the digest of the run that wrote a file; empty strings if the file does not state them."""
    import h5py

    if not Path(path).is_file() or not h5py.is_hdf5(path):
        return "", ""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs.get(RUN_ID, "")), str(file.attrs.get(RUN_DIGEST, ""))
    except (OSError, RuntimeError) as error:
        raise ResultsError(
            f"{path}: the file is damaged ({error}); remove it by hand, or give --overwrite together with --resume",
            tells_resume=True,
        ) from error


def run_to_append(path: str | os.PathLike[str], analysis: Analysis, overwrite: bool) -> str:
    """Return the id of the run that wrote an existing file; raise ResultsError if no records can be appended to it."""
    if overwrite:
        raise ResultsError(f"{path}: expected either append or overwrite, found both; leave one of them out")
    if not isinstance(analysis, Assessment):
        raise ResultsError(f"{path}: append: only results of an assessment can be extended; leave append out")
    if not Path(path).is_file():
        raise ResultsError(f"{path}: append: there is no such file; leave --append out for the first run")
    return run_of(path)[0] or _unidentified(path)


def earlier_results(
    path: str | os.PathLike[str], analysis: Analysis, tasks: Sequence[Task], read: Iterable[str]
) -> EarlierResults:
    """Return the tasks whose stored results are still valid; :func:`check_appends` has compared the options before.

    Raises ConfigError if `read` lacks a file from which a record of the results was read, as that record would be lost.
    """
    known = {piece for source in read for piece in source.split(BETWEEN)}
    with open_results_file(Path(path)) as file, file.reading():
        fingerprints, summary = _fingerprints(file), file.dataset("summary")
        sources = [str(text).split(BETWEEN) for text in summary["source"].values]
        names = [str(name) for name in summary["record"].values]
    lost = [name for name, pieces in zip(names, sources, strict=True) if not known.issuperset(pieces)]
    if lost:
        raise ConfigError(
            f"{path}: {len(lost)} of its {len(names)} records are not in the given files, and would be lost: "
            f"{some(lost, 3)}; give the paths of the earlier command too, spelled in the same way"
        )
    places: dict[str, list[int]] = {}
    for row, fingerprint in enumerate(fingerprints):
        places.setdefault(fingerprint, []).append(row)
    own = {one.key: places.get(one.fingerprint[:DIGITS]) for one in tasks}
    rows = {key: range(found[0], found[-1] + 1) for key, found in own.items() if found}
    kept = {row for found in rows.values() for row in found}
    others = {piece for row, pieces in enumerate(sources) if row not in kept for piece in pieces}
    stale = sum(one.key not in rows and others.issuperset(one.source.split(BETWEEN)) for one in tasks)
    return EarlierResults(Path(path), analysis, rows, stale)


def check_appends(path: str | os.PathLike[str], config: Config, verb: str) -> None:
    """Raise ConfigError with the differences if a results file was made with other options or by another program.

    Raises ResultsError for a damaged file, or a file that does not identify its records.
    """
    changed = verify(path, inputs=False).differences
    if changed:
        raise ResultsError(f"{path}: {changed[0]}; nothing is appended to it; run the assessment again")
    with open_results_file(Path(path)) as file:
        attrs, _ = file.attrs, _fingerprints(file)
    if attrs[RUN_SETTINGS] == configuration_fingerprint(config, verb):
        return
    if attrs["rockpulse_version"] != __version__:
        what = [f"it was written by rockpulse {attrs['rockpulse_version']}, and this is version {__version__}"]
    else:
        what = _differences(config_from_text(attrs["configuration"]), config, verb)
    what = what or ["the program, or the table of a [[demand]] selection, has changed"]
    raise ConfigError(
        f"{path}: nothing can be appended, because its rows were computed differently: {some(what, 5)}; use the "
        "settings and the version of the file, or assess all records again (--overwrite)"
    )


def _fingerprints(file: ResultsFile) -> list[str]:
    """Return the shortened fingerprint of the task of each row; raise ResultsError if the file has none."""
    text, count = str(file.attrs.get(RUN_ROWS, "")), file.dataset("summary").sizes["record"]
    if len(text) != DIGITS * count or RUN_SETTINGS not in file.attrs:
        _unidentified(file.path)
    return [text[DIGITS * row : DIGITS * (row + 1)] for row in range(count)]


def _unidentified(path: str | os.PathLike[str]) -> NoReturn:
    raise ResultsError(
        f"{path}: expected a file that `rockpulse assess RECORDS` wrote, found one that does not identify the inputs "
        "of its rows; nothing can be appended to it; run the assessment again (--overwrite)"
    )


def _differences(old: Config, new: Config, verb: str) -> list[str]:
    """Return the options that differ and affect the stored rows, each as one line of text."""
    found = []
    for name in SECTIONS:
        if name not in (*IDLE[verb], "run"):
            free = set(OF_TASKS) if name == "records" else set()
            found += _changed_keys(f"[{name}]", getattr(old, name), getattr(new, name), free)
    if old.run.seed != new.run.seed:
        found.append(f"[run] seed: {old.run.seed} in the file, {new.run.seed} now")
    for heading, before, after in (("[[block]]", old.bodies, new.bodies), ("[[demand]]", old.demands, new.demands)):
        earlier, now = ({one.name: one for one in several} for several in (before, after))
        found += [f'{heading} "{name}" is missing now' for name in earlier if name not in now]
        found += [f'{heading} "{name}" is not in the file' for name in now if name not in earlier]
        for name in earlier.keys() & now.keys():
            found += _changed_keys(f'{heading} "{name}"', earlier[name], now[name], {"confirm_size", "confirm_value"})
        if not found and [*earlier] != [*now]:
            found.append(f"{heading}: the order differs")
    return found


def _changed_keys(where: str, old: object, new: object, free: set[str]) -> list[str]:
    values = {item.name: (getattr(old, item.name), getattr(new, item.name)) for item in fields(old)}  # type: ignore[arg-type]
    return [
        f"{where} {name}: {before!r} in the file, {after!r} now"
        for name, (before, after) in values.items()
        if name not in free and before != after
    ]


def _offsets_in(file: ResultsFile) -> Callable[[str, str], np.ndarray]:
    """Return a function of group and dimension that returns the first row of each record, and the number of rows."""
    count = file.dataset("summary").sizes["record"]

    @cache
    def offsets(group: str, dim: str) -> np.ndarray:
        if dim == "record":
            return np.arange(count + 1)
        stored = file.dataset(group)
        for name, one in ASSESSMENT_GROUPS[f"/{group}"].items():
            if name.endswith("record_index") and one.dims == (dim,):
                return np.searchsorted(stored[name].values, np.arange(count + 1))
            if one.sample_dimension == dim:
                sizes = stored[name].values
                return np.concatenate([[0], np.cumsum(sizes)])[offsets(group, one.dims[0])]
        raise KeyError(dim)

    return offsets


def _rows_of(
    file: ResultsFile, analysis: Analysis, offsets: Callable[[str, str], np.ndarray], begin: int, end: int
) -> dict[str, np.ndarray]:
    """Return the rows of a results file for the records `begin` to `end` - 1, as a part; record indices start at 0."""
    part = {}
    for path, template in analysis.empty_part.items():
        if path != EVENT:
            group, _, name = path[1:].partition("/")
            dim = analysis.dimension_of(path)
            first, last = offsets(group, dim)[[begin, end]].tolist()
            values = slab(file.dataset(group)[name].variable, {dim: slice(first, last)})
            values = values.astype(str) if template.dtype.kind == "U" else values
            part[path] = values - begin if path.endswith("record_index") else values
    return part
