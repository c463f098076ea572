"""The description of a variable of a results file, declared once for whoever writes, checks or describes it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config
    from rockpulse.errors import Failure


#: Value of a flag that is not known.
NOT_KNOWN = -1
NO_YES = ("no", "yes")


@dataclass(frozen=True)
class StoredVariable:
    """A variable of a file: type, unit and meaning of its values, and what few variables have besides."""

    kind: type  # str, int, float, or int8 for a flag
    units: str
    long_name: str
    #: Gives the values in an assessment: from a `RecordAssessment` where the first dimension grows with the records,
    #: else from the bodies and the configuration. None where they are put together from the values of others.
    take: Callable[..., Any] | None = None
    _: KW_ONLY
    dims: tuple[str, ...] = ()  # `case` is absent where every block has one restitution
    words: tuple[str, ...] = ()  # of a flag, for its values, which count up from `first`
    first: int = 0
    explanation: str = ""  # what docs/schema.md says beyond the long name
    stored: Callable[[Config], bool] | None = None  # whether an assessment by a configuration has it; None: every one
    comment: Callable[[Config], str] | None = None  # its attribute in an assessment by a configuration
    of_ground: bool = False  # whether it is absent where a sequence of impulses stands in place of a record
    sample_dimension: str = ""  # of the numbers of values in a ragged array (CF): the dimension that they count

    @property
    def absent(self) -> Any:
        """The value that stands for none: NaN, an empty text, -1."""
        return {float: np.nan, str: ""}.get(self.kind, -1)

    def values(self, values: Any) -> np.ndarray:
        """The values in the type of the variable."""
        return np.asarray(values, dtype=self.kind)

    def variable(self, values: Any, dims: tuple[str, ...] | None = None, config: Config | None = None) -> xr.Variable:
        """The values, along other dimensions than the declared ones if need be, with all that describes them."""
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


#: Variables by their names.
Declared = Mapping[str, StoredVariable]


def text(long_name: str, take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """A variable of texts."""
    return StoredVariable(str, "1", long_name, take, **more)


def real(long_name: str, units: str = "1", take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """A variable of real numbers."""
    return StoredVariable(float, units, long_name, take, **more)


def whole(long_name: str, take: Callable[..., Any] | None = None, **more: Any) -> StoredVariable:
    """A variable of whole numbers: counts and indices."""
    return StoredVariable(int, "1", long_name, take, **more)


def flag(
    words: Iterable[str], long_name: str, take: Callable[..., Any] | None = None, first: int = 0, **more: Any
) -> StoredVariable:
    """A variable whose values, counted up from `first`, stand for words."""
    return StoredVariable(np.int8, "1", long_name, take, words=tuple(words), first=first, **more)


def along(
    dims: tuple[str, ...],
    by: Callable[[str], Callable[..., Any] | None] | None = None,
    stored: Callable[[Config], bool] | None = None,
    /,
    **declared: StoredVariable,
) -> dict[str, StoredVariable]:
    """Variables along the same dimensions, `stored` alike, each without a `take` of its own taken `by` its name."""
    return {
        name: replace(one, dims=dims, take=one.take or (by and by(name)), stored=stored or one.stored)
        for name, one in declared.items()
    }


def with_values(declared: Declared, values: Mapping[str, Any]) -> dict[str, xr.Variable]:
    """Every declared variable with its values; a KeyError where one has none, or values are of none."""
    if unmatched := declared.keys() ^ values.keys():
        raise KeyError(f"not both declared and given: {', '.join(sorted(unmatched))}")
    return {name: variable.variable(values[name]) for name, variable in declared.items()}


FAILURE = along(
    ("failure",),
    file=text("file"),
    stage=text("step at which it was left"),
    reason=text("why, and what to do"),
    kind=text("failed, skipped, duplicate, depth, vertical or structural"),
)


def failure_table(failures: Iterable[Failure]) -> xr.Dataset:
    """The node /failures of a file of any kind."""
    import xarray as xr

    rows = list(failures)
    return xr.Dataset(with_values(FAILURE, {name: [getattr(row, name) for row in rows] for name in FAILURE}))
