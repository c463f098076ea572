"""Selection of rows of a results file by name and condition, with sorting and a limit."""

import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any, Self

import numpy as np
import xarray as xr

from rockpulse.errors import ResultsError, some
from rockpulse.option import hint
from rockpulse.record.measures import STORED, STORED_OF_BODIES
from rockpulse.storage.hdf5.netcdf4 import flag_words, slab

#: Largest number of names that are listed in a message.
LISTED = 12

#: For each heading of a printed table, the name of the variable that it shows.
SHOWN = {
    "P": "overturning_probability",
    "SF": "safety_factor",
    "scale factor at P = 10 %": "factor_10",
    "scale factor at P = 50 %": "factor_50",
    "mean scale factor": "factor_mean",
    "I": "main_impulse",
    "C": "restitution",
    "I/I_1c": "impulse_ratio",
    "theta_max/alpha_c": "peak_rotation_ratio",
    **{measure.column[0]: measure.name for measure in (*STORED, *STORED_OF_BODIES)},
}

_COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}


@dataclass(frozen=True)
class Condition:
    """A condition on a variable, such as ``SF < 1`` or ``source = *.AT2``; "|" separates alternative values."""

    name: str
    comparison: str
    value: str

    @classmethod
    def parse(cls, words: str) -> Self:
        """Read a condition: a variable or its heading, a comparison sign and a value.

        >>> Condition.parse("scale factor at P = 10 % < 1")
        Condition(name='factor_10', comparison='<', value='1')
        """
        heading = next((one for one in SHOWN if "=" in one and words.strip().startswith(one)), "")
        words = words.replace(heading, SHOWN[heading], 1) if heading else words
        found = re.fullmatch(r"\s*([A-Za-z][^<>=!]*?)\s*(<=|>=|!=|==|<|>|=)\s*(.*?)\s*", words)
        if found is None:
            raise ResultsError(
                "expected a condition such as 'safety_factor < 1' or 'outcome = overturns' (with one of = != "
                f"{' '.join(_COMPARISONS)}), found {words!r}"
            )
        name, comparison, value = found.groups()
        return cls(SHOWN.get(name, name), "=" if comparison == "==" else comparison, value)

    def holds(self, variable: xr.Variable, values: np.ndarray) -> np.ndarray:
        """Return a mask of the values that meet the condition; raise ResultsError if the types do not match."""
        if self.comparison in ("=", "!="):
            if variable.dtype.kind in "OU":
                alike = self._named(values.astype(str))
            else:
                several = [part.strip() for part in self.value.split("|")]
                alike = np.isin(values, [self._number(part, flag_words(variable)) for part in several])
            return alike if self.comparison == "=" else ~alike
        if variable.dtype.kind in "OU":
            raise ResultsError(f"{self.name} is a text: expected = or !=, found {self.comparison}")
        return np.asarray(_COMPARISONS[self.comparison](values, self._number(self.value, flag_words(variable))))

    def _named(self, texts: np.ndarray) -> np.ndarray:
        """Return a mask of the strings that match one of the alternatives of the condition."""
        every, inverse = np.unique(texts, return_inverse=True)
        known = set(every.tolist())
        # A text may contain pattern characters, such as the brackets of "wall [north]" or the "|" of "A|B".
        several = [self.value] if self.value in known else [part.strip() for part in self.value.split("|")]
        met = [any(text == one if one in known else fnmatchcase(text, one) for one in several) for text in every]
        return np.array(met, dtype=bool)[inverse].reshape(texts.shape)

    def _number(self, value: str, words: Mapping[int, str]) -> float:
        codes = {name: code for code, name in words.items()}
        word = value.lower().replace(" ", "_").replace("-", "_")
        if word in codes:
            return codes[word]
        try:
            number = float(value)
        except ValueError:
            number = np.nan
        if np.isnan(number):  # NaN is neither smaller than nor equal to a number
            expected = f"one of {', '.join(codes)}" if codes else "a number"
            raise ResultsError(f"{self.name}: expected {expected}, found {value!r}{hint(word, codes)}")
        return number


@dataclass(frozen=True)
class RowSelection:
    """A selection of table rows by names, conditions and a limit, with their order; by default all rows."""

    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    conditions: tuple[Condition, ...] = ()
    sort: str | None = None
    descending: bool = False
    limit: int | None = None

    @property
    def words(self) -> list[str]:
        """Return a description of each part of the selection, as used in a heading or a README."""
        parts = [f"{dim} {' or '.join(patterns)}" for dim, patterns in self.names.items() if patterns]
        parts += [f"{item.name} {item.comparison} {item.value}" for item in self.conditions]
        if self.sort is not None:
            parts.append(f"sorted by {self.sort}, {'largest' if self.descending else 'smallest'} first")
        if self.limit is not None:
            parts.append(f"at most {self.limit} rows")
        return parts


def positions_matching(known: Sequence[str], patterns: Sequence[str], what: str) -> np.ndarray:
    """Return the indices of the labels that match a pattern (all without patterns); `what` is the kind of label."""
    if not patterns:
        return np.arange(len(known))
    exact = {label: place for place, label in enumerate(known)}
    found: set[int] = set()
    for pattern in patterns:
        # A label may contain pattern characters, such as the brackets of "wall [north]".
        matching = (at for at, label in enumerate(known) if fnmatchcase(label, pattern))
        places = [exact[pattern]] if pattern in exact else [*matching]
        if not places:
            raise unknown(pattern, known, what)
        found.update(places)
    return np.array(sorted(found))


def unknown(name: str, known: Sequence[str], what: str) -> ResultsError:
    """Return the error for an unknown name, with the known names; `what` is the kind of name, such as "record"."""
    within = [label for label in known if name.lower() in label.lower()]
    choices = "there are:"
    if within:
        start = within[0].lower().index(name.lower())
        pattern = f"*{within[0][start : start + len(name)]}*"
        choices = f"{len(within)} of {len(known)} names contain it; the pattern '{pattern}' selects:"
    listed = within or known
    shown = "\n".join(f"  {label}" for label in listed[:LISTED])
    more = f"\n  and {len(listed) - LISTED} more" if len(listed) > LISTED else ""
    return ResultsError(f'no {what} "{name}" in these results{hint(name, known, choices)}\n{shown}{more}')


def rows(
    dataset: xr.Dataset,
    dims: Sequence[str],
    selection: RowSelection,
    masks: Iterable[tuple[tuple[str, ...], np.ndarray]] = (),
) -> tuple[dict[str, np.ndarray], int]:
    """Return the indices of the selected rows along each of `dims`, and their number before the limit is applied.

    If a variable has other dimensions, at least one value along them must meet the condition. Rows are sorted by the
    smallest value (the largest if `descending`) that meets all conditions and `masks`.
    """
    used = [(item, _variable(dataset, item.name)) for item in selection.conditions]
    key = None if selection.sort is None else _variable(dataset, selection.sort)
    every = list(dims)
    for variable in [*(variable for _, variable in used), *([] if key is None else [key])]:
        every += [str(dim) for dim in variable.dims if dim not in every]
    among: dict[Any, np.ndarray] = {}
    for dim in [*every, *(dim for dim in selection.names if dim not in every and selection.names[dim])]:
        patterns = selection.names.get(dim, ())
        if patterns and dim not in dataset.coords:
            raise ResultsError(f"the rows of this table cannot be selected by {dim}, because it has no such column")
        if patterns:
            among[dim] = positions_matching([str(label) for label in dataset[dim].values], patterns, dim)
        else:
            among[dim] = np.arange(dataset.sizes[dim])
    mask = xr.DataArray(np.ones([among[dim].size for dim in every], dtype=bool), dims=every)
    for item, variable in used:
        values = slab(variable, among)
        if values.dtype.kind == "f" and values.size and np.isnan(values).all():
            beside = "; use factor_10, or assess with [search] intervals = true"
            why = beside if item.name == "safety_factor" else ""
            raise ResultsError(f"{item.name}: all its values are unknown{why}")
        mask &= xr.DataArray(item.holds(variable, values), dims=variable.dims)
    for along, held in masks:
        mask &= xr.DataArray(held[np.ix_(*(among[dim] for dim in along))], dims=along)
    beyond = every[len(dims) :]
    kept = np.flatnonzero(mask.any(beyond) if beyond else mask)
    if key is not None:
        values = slab(key, among)
        if values.dtype.kind in "OU":
            values = np.unique(values.astype(str), return_inverse=True)[1].reshape(values.shape)
        known = xr.DataArray(values, dims=key.dims).where(mask)
        if beyond:
            known = known.max(beyond) if selection.descending else known.min(beyond)
        order = known.transpose(*dims).values.ravel()[kept]
        kept = kept[np.argsort(-order if selection.descending else order, kind="stable")]  # unknown values last
    places = np.unravel_index(kept[: selection.limit], [among[dim].size for dim in dims])
    return {dim: among[dim][place] for dim, place in zip(dims, places, strict=True)}, kept.size


def _variable(dataset: xr.Dataset, name: str) -> xr.Variable:
    if name not in dataset.variables:
        known = [str(other) for other in dataset.variables]
        choices = f"there are: {some(known, 5)} (the manual lists all on the page of the schema)"
        raise ResultsError(f"no variable {name!r} in these results{hint(name, known, choices)}")
    return dataset.variables[name]
