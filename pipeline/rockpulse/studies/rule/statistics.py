"""Quality of a score that should tell overturning from survival: rates, curves, bounds, and events resampled.

.. note:: A case raises the alarm where its score is at or above a limit. `missed` is the share of the overturnings
   without an alarm, `false` the share of the survivors with one. Cases of one earthquake are no independent
   observations, so confidence comes from resampling earthquakes. `scores` (n,), `over` (n,) bool, `events` (n,) are the
   score of each case, whether it overturns, and the label of its earthquake.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import TypeVar

import numpy as np
from scipy.stats import beta

__all__ = [
    "RESAMPLES",
    "Resampled",
    "area",
    "curve",
    "false_at",
    "left_out",
    "limit",
    "missed_bound",
    "over_limit",
    "resampled",
]

K = TypeVar("K", bound=Hashable)

#: Resamples of the bootstrap.
RESAMPLES = 1000


def limit(fallen: np.ndarray, share: float) -> float:
    """The highest limit that misses no more than a share of the overturnings, from their scores (n,), n at least 1.

    The share is 0 to 1, 1 excluded.

    Examples
    --------
    >>> limit(np.array([3.0, 1.0, 2.0, 4.0]), 0.25)
    2.0
    """
    return float(np.sort(fallen)[int(share * fallen.size * (1.0 + 1e-12))])


def over_limit(scores: np.ndarray, lowest: float) -> np.ndarray:
    """Scores over a limit; NaN for a limit of 0, which an overturning without any score makes.

    Examples
    --------
    >>> over_limit(np.array([0.0, 3.0]), 2.0).tolist(), over_limit(np.array([0.0, 3.0]), 0.0).tolist()
    ([0.0, 1.5], [nan, nan])
    """
    return scores / lowest if lowest > 0.0 else np.full(scores.shape, np.nan)


def left_out(scores: np.ndarray, over: np.ndarray, events: np.ndarray, share: float) -> np.ndarray:
    """Scores (n,) over the limit that the cases of the other earthquakes give: an alarm at 1 and above.

    Cases overturn in at least two earthquakes. NaN where the limit is 0 (:func:`over_limit`).

    Examples
    --------
    >>> left_out(np.array([2.0, 8.0, 4.0]), np.array([True, True, False]), np.array(["a", "b", "b"]), 0.0).tolist()
    [0.25, 4.0, 2.0]
    """
    margins = np.empty(scores.size)
    for event in np.unique(events):
        out = events == event
        margins[out] = over_limit(scores[out], limit(scores[over & ~out], share))
    return margins


def curve(scores: np.ndarray, over: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Missed and false shares (k,) [-] as the limit falls through the k overturnings; `missed` falls to 0."""
    fallen, stood = np.sort(scores[over])[::-1], np.sort(scores[~over])
    missed = 1.0 - np.searchsorted(-fallen, -fallen, side="right") / fallen.size
    return missed, 1.0 - np.searchsorted(stood, fallen, side="left") / stood.size


def false_at(scores: np.ndarray, over: np.ndarray, share: float) -> float:
    """False alarms [-] at the highest limit that misses no more than a share of the overturnings [-].

    Examples
    --------
    >>> false_at(np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, False, True]), 0.0)
    0.5
    """
    return float(np.mean(scores[~over] >= limit(scores[over], share)))


def area(scores: np.ndarray, over: np.ndarray) -> float:
    """Area under the ROC curve [-]: the chance that an overturning has the larger score, ties counting half."""
    fallen, stood = scores[over], np.sort(scores[~over])
    below = np.searchsorted(stood, fallen, side="left") + np.searchsorted(stood, fallen, side="right")
    return float(0.5 * np.mean(below) / stood.size)


def missed_bound(missed: int, overturnings: int, confidence: float = 0.95) -> float:
    """Upper bound of the missed share as if all cases were independent (Clopper & Pearson 1934) [-].

    Examples
    --------
    >>> round(missed_bound(0, 100), 4), missed_bound(3, 3)
    (0.0295, 1.0)
    """
    if missed >= overturnings:
        return 1.0
    return float(beta.ppf(confidence, missed + 1, overturnings - missed))


class Resampled:
    """Values (b,) of a statistic over resamples of the earthquakes; NaN where a resample gives none."""

    def __init__(self, values: np.ndarray) -> None:
        self.values = values

    def between(self, confidence: float = 0.95) -> tuple[float, float]:
        """Both ends of the percentile interval; NaN where fewer than half of the resamples have a value."""
        known = self.values[np.isfinite(self.values)]
        if known.size < 0.5 * self.values.size:
            return float("nan"), float("nan")
        low, high = np.quantile(known, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
        return float(low), float(high)

    def below(self, confidence: float = 0.95) -> float:
        """Upper bound of the percentile kind."""
        return self.between(2.0 * confidence - 1.0)[1]

    def __sub__(self, other: Resampled) -> Resampled:
        """The difference of two statistics, resample by resample."""
        return Resampled(self.values - other.values)


def resampled(
    events: np.ndarray,
    over: np.ndarray,
    statistics: Callable[[np.ndarray], Mapping[K, float]],
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> dict[K, Resampled]:
    """Statistics over resamples of the earthquakes, each with all its cases.

    `statistics` takes the indices of the cases drawn, (k,) int, and returns numbers by name. It is not called for
    resamples that hold no survivor or overturnings of fewer than two earthquakes: a copy of an earthquake is no other
    one. All calls with one seed see the same resamples.
    """
    labels = np.unique(events)
    members = [np.flatnonzero(events == label) for label in labels]
    random = np.random.default_rng(np.random.SeedSequence([seed, *b"rule"]))
    found: list[Mapping[K, float]] = []
    for draw in random.integers(labels.size, size=(resamples, labels.size)):
        drawn = np.concatenate([members[event] for event in draw])
        fallen = over[drawn]
        enough = not fallen.all() and np.unique(events[drawn][fallen]).size >= 2
        found.append(statistics(drawn) if enough else {})
    names = dict.fromkeys(name for one in found for name in one)
    return {name: Resampled(np.array([one.get(name, np.nan) for one in found])) for name in names}
