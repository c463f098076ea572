"""Writes the results file from the parts of all records, completely or not at all, with few parts in memory."""

import os
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, groupby

import numpy as np
import xarray as xr

from rockpulse.assessment.assessment import Assessment
from rockpulse.assessment.tree import direction_statistics, joined_parts
from rockpulse.errors import Failure
from rockpulse.record.measures import PGA
from rockpulse.run.analysis import Analysis, Part, Plan
from rockpulse.run.earlier_results import DIGITS, PARTIAL, RUN_DIGEST, RUN_ID, RUN_ROWS, RUN_SETTINGS, EarlierResults
from rockpulse.run.frames import unpack
from rockpulse.run.journal import Journal
from rockpulse.run.tasks import configuration_fingerprint
from rockpulse.selection.directions import swept_directions
from rockpulse.storage.hdf5.atomic import replacing
from rockpulse.storage.hdf5.results_file import check_described, provenance, save
from rockpulse.storage.hdf5.writer import TreeWriter, add_dataset
from rockpulse.storage.variables import failure_table
from rockpulse.storage.variables.probability import MEAN

#: Largest size of the values that are written at once [bytes].
CHUNK = 8 * 1024**2
#: Number of rows of /failures that are written at once.
FAILURES_AT_ONCE = 1024
#: Overhead per array in memory, and per string in the file [bytes].
PER_ARRAY, PER_TEXT = 500, 32
#: Variables of /summary from which /directions is computed.
SWEPT = ("record", PGA, "main_impulse", "peak_rotation_ratio", "outcome", "overturning_time", "safety_factor")


@dataclass(frozen=True)
class JournalParts:
    """The parts of finished tasks, read from a journal or from the results file to which the run appends.

    It can be iterated several times.
    """

    journal: Journal
    analysis: Analysis
    fingerprints: Mapping[str, str]  # fingerprint of each finished task by its key, in the order of the rows
    events: Mapping[str, str]
    earlier: EarlierResults | None = field(default=None, kw_only=True)

    def __iter__(self) -> Iterator[Part]:
        known = {} if self.earlier is None else self.earlier.rows
        for kept, keys in groupby(self.fingerprints, known.__contains__):
            if kept and self.earlier is not None:
                yield from self.earlier.parts([*keys], self.events)
                continue
            for key in keys:
                packed = list(self.journal.parts(key))
                while packed:  # the bytes of a part are freed before it is used
                    yield self.analysis.of_event(unpack(packed.pop(0)), self.events[key])

    @property
    def run(self) -> dict[str, str]:
        """Root attributes that identify the options and the task of each row, for a later run that appends records."""
        known = {} if self.earlier is None else self.earlier.rows
        failed = self.journal.failures()
        rows = [
            (PARTIAL if key in failed and key not in known else fingerprint[:DIGITS])
            * (len(known[key]) if key in known else self.journal.count(key))
            for key, fingerprint in self.fingerprints.items()
        ]
        settings = configuration_fingerprint(self.analysis.config, self.analysis.name)
        return {RUN_SETTINGS: settings, RUN_ROWS: "".join(rows)}


def write_results(
    output: str | os.PathLike[str],
    parts: JournalParts,
    plan: Plan,
    failures: list[Failure],
    overwrite: bool,
    digest: str,
) -> int:
    """Write the results of a run and return the number of records; if there are no records, write no file."""
    analysis, run = parts.analysis, {RUN_ID: parts.journal.run_id, RUN_DIGEST: digest}
    if isinstance(analysis, Assessment):
        if not any(True for _ in parts):
            return 0
        empty, swept = analysis.template, swept_directions(plan.planned, analysis.config)
        return assemble(output, empty, parts, failures, swept, overwrite, run | parts.run)
    found = list(parts)
    tree = analysis.collect(found, plan.planned, failures)
    if found:
        tree.attrs.update(run)
        save(tree, output, overwrite)
    return len(found)


def assemble(
    path: str | os.PathLike[str],
    template: xr.DataTree,
    parts: Iterable[Part],
    failures: Sequence[Failure] = (),
    swept: Mapping[str, Sequence[str]] | None = None,
    overwrite: bool = False,
    run: Mapping[str, str] | None = None,
) -> int:
    """Write the same file as :func:`rockpulse.save`, but piece by piece; return the number of records.

    `template` is the tree of results without records. The `parts`, in the order of the rows, are read twice, first for
    their sizes. At most CHUNK bytes of arrays, or one
    larger part, are in memory; `run` contains the attributes for :func:`run_of`. Raises ResultsError if the file
    exists (it is then not changed) or cannot be written.
    """
    records: list[str] = []
    lengths: dict[str, int] = defaultdict(int)
    size = 0  # of the values in the file [bytes]
    for part in parts:
        records += part["/summary/record"].tolist()
        for name, values in part.items():
            lengths[name] += len(values)
            size += _stored_bytes(values)
    known = set(records)
    pairs = {pair: ids for pair, ids in (swept or {}).items() if not known.isdisjoint(ids)}
    if "directions" in template.children:
        of_pairs = [one for one in template["directions"].variables.values() if one.dims[0] == "pair"]
        size += len(pairs) * sum(one.dtype.itemsize * int(np.prod(one.shape[1:])) for one in of_pairs)
    check_described(template, path)
    attrs = provenance(template.attrs) | dict(run or {})
    with replacing(path, overwrite, attrs["kind"], size) as target, TreeWriter(target, attrs) as writer:
        _create_variables(writer, template, lengths, failures, len(pairs))
        _write_parts(writer, parts)
        if "directions" in template.children:
            _write_directions(writer, template, pairs, records)
    return len(records)


def _stored_bytes(values: np.ndarray) -> int:
    if values.dtype.kind != "U":
        return values.nbytes
    return sum(PER_TEXT + len(text.encode("utf-8", "surrogateescape")) for text in values.ravel().tolist())


def _create_variables(
    writer: TreeWriter, template: xr.DataTree, totals: Mapping[str, int], failures: Sequence[Failure], pairs: int
) -> None:
    """Create every variable with its final size, and write the values that are the same for all records."""
    for node in template.subtree:
        dataset = node.to_dataset(inherit=False)
        if node.path == "/":
            continue
        sizes = {"/directions": {"pair": pairs}, "/failures": {"failure": len(failures)}}.get(node.path, {})
        growing = [name for name in dataset.variables if f"{node.path}/{name}" in totals]
        sizes |= {str(dataset[name].dims[0]): totals[f"{node.path}/{name}"] for name in growing}
        add_dataset(writer, node.path, dataset, dataset.attrs, sizes)
        for name, variable in dataset.variables.items():
            if name not in growing and variable.dims[:1] not in (("pair",), ("failure",)):
                writer.append(f"{node.path}/{name}", variable.values)
    for begin in range(0, len(failures), FAILURES_AT_ONCE):
        for name, variable in failure_table(failures[begin : begin + FAILURES_AT_ONCE]).variables.items():
            writer.append(f"/failures/{name}", variable.values)


def _write_parts(writer: TreeWriter, parts: Iterable[Part]) -> None:
    gathered: list[Part] = []
    size = before = 0
    for part in chain(parts, [None]):
        if part is not None:
            gathered.append(part)
            size += sum(PER_ARRAY + values.nbytes for values in part.values())
        if gathered and (part is None or size >= CHUNK):
            for path, values in joined_parts(gathered, before).items():
                writer.append(path, values)
            before += sum(len(one["/summary/record"]) for one in gathered)
            gathered, size = [], 0


def _write_directions(
    writer: TreeWriter, template: xr.DataTree, pairs: Mapping[str, Sequence[str]], records: Sequence[str]
) -> None:
    """Write the statistics over the directions of each pair of channels, one pair after the other."""
    place = {record: number for number, record in enumerate(records)}
    empty, summary = template["directions"].to_dataset(), template["summary"].to_dataset()
    with_probability = MEAN in empty
    names = (*SWEPT, "overturning_probability") if with_probability else SWEPT
    for pair, ids in pairs.items():
        rows = [place[record] for record in ids if record in place]
        begin, end = min(rows), max(rows) + 1
        values = {name: (summary[name].dims, writer.read(f"/summary/{name}", begin, end)) for name in names}
        own = xr.Dataset(values, {name: empty[name].variable for name in ("block", "model")})
        found = direction_statistics(own, empty["direction_azimuth"].values, {pair: ids}, with_probability)
        found["record_index"] = xr.where(found["record_index"] < 0, -1, found["record_index"] + begin)
        for name, variable in found.variables.items():
            if variable.dims[:1] == ("pair",):
                writer.append(f"/directions/{name}", variable.values)
