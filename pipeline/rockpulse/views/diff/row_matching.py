"""Matches the rows of two results files, by name or by the record, body and model to which a row belongs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from rockpulse.storage.export.long_table import POINTS_AT


@dataclass(frozen=True)
class OnlyIn:
    """Names that only the first or only the second of two files contains; ``what`` is the kind of object they name."""

    what: str
    first: tuple[str, ...]
    second: tuple[str, ...]


def add_only(only: list[OnlyIn], what: str, first: Iterable[Any], second: Iterable[Any]) -> None:
    """Add to `only` the names that only one of two lists contains, unless they were already added."""
    before, after = dict.fromkeys(map(str, first)), dict.fromkeys(map(str, second))
    gone = tuple(name for name in before if name not in after)
    new = tuple(name for name in after if name not in before)
    found = OnlyIn(what, gone, new)
    if (gone or new) and found not in only:
        only.append(found)


@dataclass(frozen=True, eq=False)
class Matched:
    """The rows along one dimension that both files contain, as indices in the first and in the second file."""

    first: np.ndarray
    second: np.ndarray
    names: Callable[[int], tuple[str, ...]]  # name of the k-th row: a label, or labels and a number
    whole: bool  # whether they include all rows of both files, in the same order


@dataclass
class RowMatcher:
    """Matches the rows of one group of two files; ``only`` and ``warnings`` list what could not be matched."""

    group: str
    one: xr.Dataset
    other: xr.Dataset
    named: dict[str, Matched]
    only: list[OnlyIn]
    warnings: list[str]
    _matched: dict[str, Matched | None] = field(default_factory=dict)

    def of(self, dim: str) -> Matched | None:
        """Return the rows along a dimension that both files contain; None if the rows cannot be matched."""
        if dim not in self._matched:
            self._matched[dim] = self._match(dim)
        return self._matched[dim]

    def _match(self, dim: str) -> Matched | None:
        if dim in self.one.coords and dim in self.other.coords:
            return self._by_label(dim)
        for name in self.one.data_vars:
            if self.one[name].attrs.get("sample_dimension") == dim and name in self.other:
                return self._by_owner(dim, str(name))
        if any(name in self.one and self.one[name].dims == (dim,) for name in POINTS_AT):
            return self._by_pointers(dim)
        size = self.one.sizes[dim]
        if size != self.other.sizes[dim]:
            self.warnings.append(
                f"/{self.group}: {dim} has {size} values in the first file and {self.other.sizes[dim]} in the second: "
                "variables along it were not compared"
            )
            return None
        every = np.arange(size)
        return Matched(every, every, lambda k: (f"{dim} {k}",), True)

    def _by_label(self, dim: str) -> Matched:
        old, new = ([str(label) for label in dataset[dim].values] for dataset in (self.one, self.other))
        add_only(self.only, f"{dim}s", old, new)
        place = {label: k for k, label in enumerate(new)}
        at = np.array([place.get(label, -1) for label in old], dtype=int)
        first, second = np.flatnonzero(at >= 0), at[at >= 0]
        matched = Matched(first, second, lambda k: (old[int(first[k])],), old == new)
        if self.group == "summary":
            self.named[dim] = matched
        return matched

    def _by_owner(self, dim: str, sizes: str) -> Matched | None:
        """Match the samples of those rows that have the same number of samples in both files."""
        owner = self.of(str(self.one[sizes].dims[0]))
        if owner is None:
            return None
        old, new = self.one[sizes].values, self.other[sizes].values
        alike = old[owner.first] == new[owner.second]
        if not alike.all():
            self.warnings.append(
                f"/{self.group}: {int((~alike).sum())} of {alike.size} differ in size along {dim}, and were not "
                f"compared (the first is {', '.join(owner.names(int(np.flatnonzero(~alike)[0])))})"
            )
        kept = np.flatnonzero(alike)
        counts = old[owner.first[kept]]
        ends = np.cumsum(counts)
        within = np.arange(int(counts.sum())) - np.repeat(ends - counts, counts)
        first, second = (
            np.repeat((np.cumsum(all_) - all_)[places[kept]], counts) + within
            for all_, places in ((old, owner.first), (new, owner.second))
        )

        def name(k: int) -> tuple[str, ...]:
            at = int(np.searchsorted(ends, k, side="right"))
            return (*owner.names(int(kept[at])), f"{dim} {int(within[k])}")

        return Matched(first, second, name, owner.whole and bool(alike.all()))

    def _by_pointers(self, dim: str) -> Matched | None:
        """Match rows that belong to the same record, body, restitution and model, in the order of the files."""
        pointers = [name for name in POINTS_AT if name in self.one and self.one[name].dims == (dim,)]
        alike = all(np.array_equal(self.one[name].values, self.other[name].values) for name in pointers)
        if alike and all(matched.whole for matched in self.named.values()):
            every = np.arange(self.one.sizes[dim])
            return Matched(every, every, self._names(dim, pointers, every), True)
        tables = []
        for dataset, side in ((self.one, "first"), (self.other, "second")):
            table = pd.DataFrame({name: self._common(dataset[name].values, POINTS_AT[name], side) for name in pointers})
            table = table[(table >= 0).all(axis=1)].sort_values(pointers, kind="stable")
            groups = table.groupby(pointers)[pointers[0]]
            tables.append(table.assign(number=groups.cumcount(), size=groups.transform("size"), row=table.index))
        one, other = (table.groupby(pointers).size() for table in tables)
        apart = int((one.sub(other, fill_value=0) != 0).sum())
        both = tables[0].merge(tables[1], on=[*pointers, "number", "size"])
        if apart:
            self.warnings.append(
                f"/{self.group}: {apart} combinations of record, block and model differ in the number of rows, and "
                "were not compared"
            )
        first, second = (both[f"row_{side}"].to_numpy() for side in "xy")
        return Matched(first, second, self._names(dim, pointers, first), False)

    def _names(self, dim: str, pointers: list[str], first: np.ndarray) -> Callable[[int], tuple[str, ...]]:
        """Return a function that gives, for a matched row, the names of its record, body and model, and its index."""
        labels = {pointer: POINTS_AT[pointer] for pointer in pointers if POINTS_AT[pointer] in self.named}

        def name(k: int) -> tuple[str, ...]:
            at, labels_of_row = int(first[k]), list[str]()
            for pointer, label in labels.items():
                pointed = self.one.variables[pointer][at : at + 1].values
                labels_of_row += self.named[label].names(int(self._common(pointed, label, "first")[0]))
            return (*labels_of_row, f"{dim} {at}")

        return name

    def _common(self, pointed: np.ndarray, at: str, side: str) -> np.ndarray:
        """Return, for each row, the index of its record, body or model among the names in both files; -1 for others."""
        if at not in self.named:
            return pointed.astype(np.int64)
        place = getattr(self.named[at], side)
        number = np.full(int(max(pointed.max(initial=-1), place.max(initial=-1))) + 2, -1, dtype=np.int64)
        number[place] = np.arange(place.size)
        return np.asarray(number[pointed])
