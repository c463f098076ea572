"""Declarations of the variables of results files, used by the writer, the checks and the documentation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config
    from rockpulse.errors import Failure


#: Integer that is stored for a flag whose value is not known.
NOT_KNOWN = -1
NO_YES = ("no", "yes")


@dataclass(frozen=True)
class StoredVariable:
    """A variable of a file: type, unit and meaning of its values, and optional properties."""

    kind: type  # str, int, float, or int8 for flags
    units: str
    long_name: str
    #: Function that returns the values in an assessment: from a `RecordAssessment` if the first dimension grows with
    #: the records, else from bodies and configuration. None if they are computed from other variables.
    take: Callable[..., Any] | None = None
    _: KW_ONLY
    dims: tuple[str, ...] = ()  # without `case` if every block has one restitution
    words: tuple[str, ...] = ()  # words of a flag; their values count up from `first`
    first: int = 0
    explanation: str = ""  # further text for docs/schema.md
    stored: Callable[[Config], bool] | None = None  # whether a configuration requires the variable; None: always stored
    comment: Callable[[Config], str] | None = None  # attribute `comment` of the variable for a configuration
    of_ground: bool = False  # whether the variable needs a record, and is absent for a sequence of impulses
    sample_dimension: str = ""  # for counts of values in a ragged array (CF): the dimension that is counted

    @property
    def absent(self) -> Any:
        """The value that marks missing data: NaN, an empty string or -1."""
        return {float: np.nan, str: ""}.get(self.kind, -1)

    def values(self, values: Any) -> np.ndarray:
        """Convert values to the type of the variable."""
        return np.asarray(values, dtype=self.kind)

    def variable(self, values: Any, dims: tuple[str, ...] | None = None, config: Config | None = None) -> xr.Variable:
        """Return values as an xarray variable with the declared attributes, along `dims` or the declared dimensions."""
        import xarray as xr

        attrs: dict[str, Any] = {"units": self.units, "long_name": self.long_name}
        if self.words:
            attrs["flag_values"] = np.arange(self.first, self.first + len(self.words), dtype=np.int8)
            attrs["flag_meanings"] = " ".join(self.words)
        if self.sample_dimension:
            attrs["sample_dimension"] = self.sample_dimension
        if self.comment is not None and config is not None:
            attrs["comment"] = self.comment(config)
        return xr.Variable(self.dims if dims is None else dims, self.values(values), attrs)


#: Declarations of variables, by the names of the variables.
Declared = Mapping[str, StoredVariable]


def text(long_name: str, take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """Declare a variable of strings."""
    return StoredVariable(str, "1", long_name, take, **more)


def real(long_name: str, units: str = "1", take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """Declare a variable of real numbers."""
    return StoredVariable(float, units, long_name, take, **more)


def whole(long_name: str, take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """Declare a variable of whole numbers, such as counts and indices."""
    return StoredVariable(int, "1", long_name, take, **more)


def flag(
    words: Iterable[str | Enum], long_name: str, take: Callable[..., Any] | None = None, first: int = 0, **more: Any
) -> StoredVariable:
    """Declare a variable of integers, each of which represents a word or an enumeration member, from `first` on."""
    names = tuple(word.name.lower() if isinstance(word, Enum) else word for word in words)
    return StoredVariable(np.int8, "1", long_name, take, words=names, first=first, **more)


def along(
    dims: tuple[str, ...],
    by: Callable[[str], Callable[..., Any] | None] | None = None,
    stored: Callable[[Config], bool] | None = None,
    of_ground: bool = False,
    /,
    **declared: StoredVariable,
) -> dict[str, StoredVariable]:
    """Declare variables with the same dimensions; `by(name)` returns `take` for variables declared without it."""
    found = {}
    for name, one in declared.items():
        found[name] = replace(one, dims=dims, take=one.take or (by and by(name)), stored=stored or one.stored)
        found[name] = replace(found[name], of_ground=of_ground or one.of_ground)
    return found


def with_ends(name: str, declared: StoredVariable, **ends: str) -> dict[str, StoredVariable]:
    """Declare a variable and the ends of its interval, such as `low` and `high`, each with its meaning."""
    others = {f"{name}_{end}": replace(declared, long_name=words, explanation="") for end, words in ends.items()}
    return {name: declared, **others}


def with_values(declared: Declared, values: Mapping[str, Any]) -> dict[str, xr.Variable]:
    """Return every declared variable with its values; KeyError unless `values` contains exactly the declared names."""
    lacking, undeclared = (
        ", ".join(sorted(one)) for one in (declared.keys() - values.keys(), values.keys() - declared.keys())
    )
    if lacking or undeclared:
        raise KeyError(f"declared without values: {lacking or '-'}; values without a declaration: {undeclared or '-'}")
    return {name: variable.variable(values[name]) for name, variable in declared.items()}


FAILURE = along(
    ("failure",),
    file=text("file"),
    stage=text("step at which the file or record was left out"),
    reason=text("reason, and what to do"),
    kind=text("failed, skipped, duplicate, depth, vertical or structural"),
    remedy=text("keys of the configuration with which the data can be used, each with its choices"),
)


def failure_table(failures: Iterable[Failure]) -> xr.Dataset:
    """Return the group /failures of a results file, with one row for each failure."""
    import xarray as xr

    rows = list(failures)
    return xr.Dataset(with_values(FAILURE, {name: [getattr(row, name) for row in rows] for name in FAILURE}))
