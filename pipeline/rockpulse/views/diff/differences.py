"""Compares two results files: rows that only one of them has, values that differ, and changed verdicts."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches, unified_diff
from itertools import chain
from typing import Any

import numpy as np
import xarray as xr

from rockpulse.errors import ResultsError
from rockpulse.storage.export.long_table import POINTS_AT
from rockpulse.storage.hdf5.netcdf4 import flag_words, slab
from rockpulse.storage.hdf5.results_file import ResultsFile
from rockpulse.views.diff.answer_changes import Changes, Flip, body_changes, leading_model
from rockpulse.views.diff.row_matching import Matched, OnlyIn, RowMatcher, add_only

#: Number of values of a variable that are read at once; more are slower, as their memory is allocated each time.
PART = 1_000_000
#: Variables whose changes are listed: all changes of the first variable, and crossings of 1 for the others.
OUTCOME = "/summary/outcome"
SAFETY = "/summary/safety_factor"
CAPACITY = "/summary/capacity_ratio"
FACTOR = "/summary/factor_10"
#: Largest number of variables in a message, if no name is similar.
LISTED = 8
#: Root attributes on the origin of a file, in which a change is not a difference.
ABOUT = ("title", "site_description")
OF_THE_RUN = ("run_id", "run_digest", "run_settings", "run_rows")
APART = ("history", "configuration", "kind", "Conventions", "_NCProperties", *OF_THE_RUN, *ABOUT)


@dataclass(frozen=True)
class VariableDifference:
    """The differences of one variable: how many values differ, and where the largest difference is."""

    name: str  # group and variable
    differing: int  # number of values beyond the tolerance
    compared: int
    largest: float  # relative difference; inf between a number and NaN or inf; NaN for texts and flags
    place: tuple[str, ...]  # of the largest (texts, flags: first) difference: record, block, model, other names
    before: str
    after: str


@dataclass(repr=False)
class Differences:
    """All differences between two files; ``sides`` has the changed verdicts and ratios that crossed 1, by variable."""

    about: list[tuple[str, str, str]] = field(default_factory=list)  # root attributes: name, before, after
    configuration: list[str] = field(default_factory=list)
    only: list[OnlyIn] = field(default_factory=list)  # groups, rows and variables in only one file
    others: list[str] = field(default_factory=list)  # other differences as text
    variables: list[VariableDifference] = field(default_factory=list)
    model: str = ""  # most complete model of both; empty for none
    bodies: list[str] = field(default_factory=list)  # changes of margins by that model
    sides: dict[str, Changes] = field(default_factory=dict)
    compared: int = 0  # number of values
    text: str = field(default="", repr=False)  # of :func:`rockpulse.diff`

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        found = f"{len(self.variables)} variables differ" if not self.same else "the same"
        return f"<Differences {found}, {self.compared} values compared>"

    @property
    def same(self) -> bool:
        """Whether the results are equal; versions and configurations may differ."""
        return not (self.only or self.others or self.variables)


def compare_results(
    first: ResultsFile,
    second: ResultsFile,
    rtol: float = 1e-9,
    atol: float = 0.0,
    ignore: Sequence[str] = (),
    listed: int = 20,
) -> Differences:
    """Compare two open results files; raise ResultsError for different kinds or an unknown name in `ignore`.

    Two numbers are equal if they differ by at most `atol` + `rtol` times the larger number, or if both are NaN or the
    same infinity; texts, integers and flags must be identical. Variables in `ignore` (``name`` or ``/group/name``) are
    not compared. At most `listed` changed verdicts and `listed` ratios that crossed 1 are named.
    """
    if first.kind != second.kind:
        raise ResultsError(
            f"expected two files of one kind, found {first.path} ({first.kind}) and {second.path} ({second.kind})"
        )
    _check_ignored(ignore, first, second)
    found = Differences(sides={name: Changes(listed) for name in (OUTCOME, FACTOR, SAFETY, CAPACITY)})
    _compare_attributes(found, first.attrs, second.attrs)
    add_only(found.only, "groups", first.groups, second.groups)
    named: dict[str, Matched] = {}
    for group in sorted(set(first.groups) & set(second.groups), key=lambda name: (name != "summary", name)):
        with first.reading(), second.reading():
            one, other = first.dataset(group), second.dataset(group)
            if group == "failures":
                _compare_failures(found, one, other)
                continue
            if group == "summary":
                found.model = leading_model(one, other)
            _compare_group(found, RowMatcher(group, one, other, named, found.only, found.others), ignore, rtol, atol)
            if group == "summary" and found.model and {"record", "block"} <= set(named):
                found.bodies = body_changes(one, other, named, found.model, ignore)
    return found


def _check_ignored(ignore: Sequence[str], *files: ResultsFile) -> None:
    if not ignore:
        return
    known = {f"/{group}/{name}" for file in files for group in file.groups for name in file.dataset(group).data_vars}
    spelt = known | {path.rpartition("/")[2] for path in known}
    for name in ignore:
        if name not in spelt:
            close = get_close_matches(name, sorted(spelt), n=5) or sorted(known)[:LISTED]
            raise ResultsError(f"no variable {name!r} in these results; the closest: {', '.join(close)}")


def _compare_attributes(found: Differences, first: Mapping[str, Any], second: Mapping[str, Any]) -> None:
    before, after = (_placed(str(attrs.get("configuration", ""))) for attrs in (first, second))
    changes = list(unified_diff(before, after, n=0, lineterm=""))[2:]
    found.configuration = [line for line in changes if not line.startswith("@@")]
    for name in sorted(set(first) | set(second)):
        old, new = (str(attrs.get(name, "absent")) for attrs in (first, second))
        if old != new and (name.endswith("_version") or name in ABOUT):
            found.about.append((name, old, new))
        elif old != new and name not in APART and "sha256" not in name:
            found.others.append(f"attribute {name}: {old} in the first, {new} in the second")


def _placed(configuration: str) -> list[str]:
    """Return the lines of a configuration, each preceded by the name of its section and, if it has one, of its body."""
    where, lines = "", []
    for line in configuration.splitlines():
        if line.startswith("["):
            where = line
        elif where.startswith("[[") and line.startswith("name = "):
            where = f"{where} {line.removeprefix('name = ')}"
        elif line:
            lines.append(f"{where} {line}".strip())
    return lines


def _compare_failures(found: Differences, one: xr.Dataset, other: xr.Dataset) -> None:
    """Compare the rows of the two tables of failures; their order does not matter."""
    first, second = (
        list(map("{} ({}) {}: {}".format, *(dataset[name].values for name in ("kind", "stage", "file", "reason"))))
        for dataset in (one, other)
    )
    add_only(found.only, "failures", first, second)
    found.compared += one["kind"].size


def _compare_group(found: Differences, rows: RowMatcher, ignore: Sequence[str], rtol: float, atol: float) -> None:
    one, other, group = rows.one, rows.other, rows.group
    for name in sorted(set(one.attrs) | set(other.attrs)):
        old, new = (str(dataset.attrs.get(name, "absent")) for dataset in (one, other))
        if old != new:
            found.others.append(f"attribute {name} of /{group}: {old} in the first, {new} in the second")
    names, others = (
        [str(name) for name in dataset.data_vars if not {str(name), f"/{group}/{name}"} & set(ignore)]
        for dataset in (one, other)
    )
    add_only(found.only, f"variables of /{group}", names, others)
    for name in names:
        if name not in others:
            continue
        before, after = one.variables[name], other.variables[name]
        title = f"/{group}/{name}"
        if reason := _not_alike(before, after):
            found.others.append(f"{title}: {reason}")
        elif name not in POINTS_AT and "sample_dimension" not in before.attrs:  # the rows are matched by these
            matched = [rows.of(str(dim)) for dim in before.dims]
            if None not in matched:  # otherwise reported when the rows were matched
                _compare_values(found, title, before, after, [row for row in matched if row is not None], rtol, atol)


def _not_alike(before: xr.Variable, after: xr.Variable) -> str:
    """Return why two variables cannot be compared (units, flags, dimensions or type); otherwise an empty text."""
    for what in ("units", "flag_meanings"):
        if str(before.attrs.get(what)) != str(after.attrs.get(what)):
            return f"{what} {before.attrs.get(what)!r}, then {after.attrs.get(what)!r}"
    if before.dims != after.dims or (before.dtype.kind in "OU") != (after.dtype.kind in "OU"):
        return ", then ".join(f"{' x '.join(map(str, one.dims))} {one.dtype}" for one in (before, after))
    return ""


def _compare_values(
    found: Differences,
    title: str,
    before: xr.Variable,
    after: xr.Variable,
    rows: list[Matched],
    rtol: float,
    atol: float,
) -> None:
    words = flag_words(before)
    sides = found.sides.get(title)
    differing = compared = 0
    largest, worst = -1.0, None
    for start, old, new in _parts(before, after, rows):

        def change_at(at: int, start: int = start, old: np.ndarray = old, new: np.ndarray = new) -> Flip:
            place = np.unravel_index(at, old.shape)
            labels = (row.names(int(k) + (start if row is rows[0] else 0)) for row, k in zip(rows, place, strict=True))
            return Flip(tuple(chain(*labels)), _shown(old[place], words), _shown(new[place], words))

        compared += old.size
        apart = _apart(old, new, rtol, atol)
        if sides is not None:
            changed = apart if title == OUTCOME else _crossed(apart, old, new)
            leads = np.ones(old.shape, dtype=bool)
            if "model" in before.dims:
                axis = before.dims.index("model")
                own = np.array([rows[axis].names(k)[0] == found.model for k in range(old.shape[axis])], dtype=bool)
                leads = np.moveaxis(np.broadcast_to(own, (*np.delete(old.shape, axis), own.size)), -1, axis)
            sides.compared += old.size
            sides.compared_by_model += int(leads.sum())
            sides.add(changed, leads.ravel()[changed], change_at)
        if apart.size:
            differing += apart.size
            sizes = _relative(old.reshape(-1)[apart], new.reshape(-1)[apart])
            at = int(sizes.argmax())
            if sizes[at] > largest:
                largest, worst = float(sizes[at]), change_at(apart[at])
    found.compared += compared
    if worst is not None:
        size = largest if before.dtype.kind == "f" else math.nan
        found.variables.append(VariableDifference(title, differing, compared, size, *worst))


def _parts(
    before: xr.Variable, after: xr.Variable, rows: list[Matched]
) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yield a variable in parts: the index of the first row of the part, and the values of both files."""
    if not rows:
        yield 0, np.asarray(before.values), np.asarray(after.values)
        return
    step = max(1, PART // max(int(np.prod([row.first.size for row in rows[1:]])), 1))
    for start in range(0, rows[0].first.size, step):
        pair = []
        for variable, side in ((before, "first"), (after, "second")):
            where: dict[Any, Any] = {}
            for number, (dim, row) in enumerate(zip(variable.dims, rows, strict=True)):
                at = getattr(row, side)
                at = at[start : start + step] if number == 0 else at
                run = row.whole or bool((np.diff(at) == 1).all())
                where[dim] = slice(int(at[0]), int(at[-1]) + 1) if run and at.size else at
            pair.append(slab(variable, where))
        yield start, pair[0], pair[1]


def _apart(old: np.ndarray, new: np.ndarray, rtol: float, atol: float) -> np.ndarray:
    """Return the flat indices at which two arrays differ by more than the tolerance."""
    if old.dtype == new.dtype and old.dtype.kind in "biuf":
        bits = f"u{old.dtype.itemsize}"
        if np.array_equal(old.view(bits), new.view(bits)):  # also for NaN; faster than the comparison below
            return np.zeros(0, dtype=int)
    places = np.flatnonzero(old != new)
    if old.dtype.kind != "f" or new.dtype.kind != "f" or not places.size:
        return places
    one, other = old.reshape(-1)[places], new.reshape(-1)[places]
    close = [np.isclose(*pair, rtol, atol, equal_nan=True) for pair in ((one, other), (other, one))]
    return places[~np.any(close, axis=0)]


def _crossed(places: np.ndarray, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return the indices in `places` at which a ratio crossed 1."""
    one, other = old.reshape(-1)[places], new.reshape(-1)[places]
    return places[((one < 1.0) != (other < 1.0)) & ~np.isnan(one) & ~np.isnan(other)]


def _relative(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return the relative differences: inf if only one number is finite, and 1 for texts and integers."""
    if old.dtype.kind != "f" or new.dtype.kind != "f":
        return np.ones(old.shape)
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.abs(old - new) / np.maximum(np.abs(old), np.abs(new))
    return np.where(np.isfinite(old) & np.isfinite(new), size, np.inf)


def _shown(value: Any, words: dict[int, str]) -> str:
    if words:
        return words.get(int(value), str(value))
    return f"{value:.9g}" if isinstance(value, float) else str(value)
