"""Observations of the capacities of a body: values, and levels that were reached or not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rockpulse.errors import ConfigError

__all__ = ["ABOVE", "EXACT", "NOT_ABOVE", "Observations"]

#: Kinds of knowledge about a capacity: its value, that it is above a level, that it is not.
EXACT, ABOVE, NOT_ABOVE = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Observations:
    """Observations of capacities, in the unit of one intensity measure; the rows ascend."""

    level: np.ndarray  # (n,) a capacity, or the level that it is compared with, positive
    kind: np.ndarray  # (n,) EXACT: the capacity is the level; ABOVE: it is above it; NOT_ABOVE: it is not
    cluster: np.ndarray  # (n,) number of the event of each row
    record: np.ndarray  # (n,) number of the record of each row
    events: tuple[str, ...]  # labels of the events, sorted
    qualities: np.ndarray  # (n, c) positive numbers that capacity should not depend on, NaN: not known
    weight: np.ndarray  # (n,) how much each row counts, of mean one

    @classmethod
    def of(
        cls,
        level: Any,
        kind: Any,
        clusters: Any = None,
        records: Any = None,
        qualities: Any = None,
        weight: Any = None,
    ) -> Observations:
        """Rows from levels, kinds and qualities; without labels every row is an event and a record of its own.

        Without weights all rows count alike. Raises ConfigError for levels that are not positive and finite, or arrays
        of different lengths.
        """
        level, kind = np.asarray(level, dtype=float), np.asarray(kind, dtype=np.int64)
        if level.ndim != 1 or not np.all(np.isfinite(level) & (level > 0.0)):
            raise ConfigError(f"fragility: expected (n,) positive, finite levels, got {level!r:.80}")
        alone = [f"{number:09d}" for number in range(level.size)]
        rows = [np.asarray(alone if labels is None else labels, dtype=str) for labels in (clusters, records)]
        if {kind.shape, *(labels.shape for labels in rows)} != {level.shape}:
            raise ConfigError(
                f"fragility: expected one level, kind, event and record a row, got {level.size}, {kind.size}, "
                f"{rows[0].size} and {rows[1].size}"
            )
        (events, cluster), (_, record) = (np.unique(labels, return_inverse=True) for labels in rows)
        order = np.lexsort((record, cluster, kind, level))  # sums to the last digit, whatever the order of the rows
        beside = np.empty((level.size, 0)) if qualities is None else np.asarray(qualities, dtype=float)
        counts = (
            np.ones(level.size)
            if weight is None or not level.size
            else np.asarray(weight, dtype=float) / np.mean(weight)
        )
        labels = tuple(map(str, events))
        return cls(level[order], kind[order], cluster[order], record[order], labels, beside[order], counts[order])

    @property
    def records(self) -> int:
        """Number of records."""
        return int(np.unique(self.record).size)

    def having(self, column: int) -> np.ndarray:
        """Whether (n,) a row has a quality, so that its logarithm is a number."""
        values = self.qualities[:, column]
        return np.isfinite(values) & (values > 0.0)

    def only(self, kept: np.ndarray) -> Observations:
        """The rows that a mask (n,) keeps, with their events alone."""
        clusters = np.array(self.events, dtype=str)[self.cluster]
        rows = (clusters, self.record.astype(str), self.qualities, self.weight)
        return Observations.of(self.level[kept], self.kind[kept], *(values[kept] for values in rows))

    def without_each_event(self) -> np.ndarray:
        """Weights (1 + events, n): all rows, then the rows without one event after the other."""
        left = self.cluster != np.arange(len(self.events))[:, None]
        return np.vstack([np.ones((1, self.level.size)), left]) * self.weight
