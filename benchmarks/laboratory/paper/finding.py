"""A statement of the paper, the range in which it holds, and the numbers that show it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr


@dataclass(frozen=True, eq=False)
class Finding:
    """The result of checking one statement."""

    held: xr.DataArray  # whether the statement holds, case by case
    numbers: str  # figures that show it
    valid: xr.DataArray | None = None  # cases that count; all by default
    # under which the statement may hold throughout, in the order in which they are tried
    conditions: Mapping[str, xr.DataArray] = field(default_factory=dict)

    @property
    def cases(self) -> int:
        """Number of cases that count."""
        return int(np.size(self.held) if self.valid is None else self._valid().sum())

    @property
    def count(self) -> int:
        """Number of cases in which the statement holds."""
        return int((self.held & self._valid()).sum())

    @property
    def where(self) -> str:
        """The conditions under which the statement holds, in words."""
        if self.count in (0, self.cases):
            return "everywhere" if self.count else "nowhere"
        if "interval" in self.held.dims:
            return interval_ranges(self.held)
        for words, mask in self.conditions.items():
            cases = self._valid() & mask
            if bool(cases.any()) and bool(self.held.where(cases, True).all()):
                return f"{words} ({int(cases.sum())} of the cases, all of them)"
        return "only case by case"

    @property
    def verdict(self) -> str:
        """holds, holds in part, fails, or not examined."""
        if not self.cases:
            return "not examined"
        return "holds" if self.count == self.cases else "holds in part" if self.count else "fails"

    def _valid(self) -> xr.DataArray:
        return xr.ones_like(self.held, dtype=bool) if self.valid is None else self.valid


class Statement(NamedTuple):
    """One sentence of section 4."""

    name: str
    words: str  # of the paper
    check: Callable[[xr.Dataset], Finding]  # from the dataset of the figure to the finding


def stated(statements: list[Statement], words: str) -> Callable[..., Callable[[xr.Dataset], Finding]]:
    """Decorator that adds the check of a sentence of the paper to the statements of a figure."""

    def added(check: Callable[[xr.Dataset], Finding]) -> Callable[[xr.Dataset], Finding]:
        statements.append(Statement(check.__name__, words, check))
        return check

    return added


def examine(figure: xr.Dataset, statements: Iterable[Statement]) -> dict[Statement, Finding]:
    """The finding for each statement about a figure, in their order."""
    return {statement: statement.check(figure) for statement in statements}


def statement_table(findings: Mapping[Statement, Finding]) -> pd.DataFrame:
    """The verdict on every statement, one row each."""
    return pd.DataFrame(
        {
            "statement": statement.name,
            "words": statement.words,
            "verdict": finding.verdict,
            "cases": finding.cases,
            "held": finding.count,
            "where": finding.where if finding.cases else "",
            "numbers": finding.numbers,
        }
        for statement, finding in findings.items()
    )


def interval_ranges(held: xr.DataArray) -> str:
    """The intervals with which a statement holds, spacing by spacing, to the step of the scan.

    `held` is over interval, or over spacing and interval.

    Examples
    --------
    >>> held = xr.DataArray([[True, True, False, True]], {"spacing": ["end"], "interval": [0.1, 0.2, 0.3, 0.4]})
    >>> interval_ranges(held)
    'end: dT 0.1 to 0.2, 0.4 s'
    """
    if "spacing" not in held.dims:
        return _ranges(held)
    parts = {str(name): _ranges(held.sel(spacing=name)) for name in held["spacing"].values}
    return "; ".join(f"{name}: {words}" for name, words in parts.items() if words) or "nowhere"


def _ranges(held: xr.DataArray) -> str:
    flags, intervals = held.values.astype(bool), held["interval"].values
    if flags.all():
        return "every dT"
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(int), [0]))))
    runs = [(intervals[first], intervals[last - 1]) for first, last in edges.reshape(-1, 2)]
    words = [f"{low:.4g} to {high:.4g}" if high > low else f"{low:.4g}" for low, high in runs]
    return f"dT {', '.join(words)} s" if words else ""
