"""The records, factors, probabilities and curves that the part to explore shows of a body."""

import base64
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rocking.spectrum.probability import factor_at
from rockpulse.assessment.answers import Answers

#: Factors on each record.
STEPS = 5
#: Factors beside those that have a meaning, and how near to each other two may be.
OTHERS, APART = (0.5, 0.7, 1.4, 2.0, 3.0, 5.0), 0.03
#: Probabilities whose factors the results hold, by the variables that hold them.
SHARES = {0.1: "factor_10", 0.5: "factor_50"}
#: The smallest and the largest factor that is shown.
SHOWN = (0.05, 20.0)


#: Columns of a stretch of time, more than a screen shows.
COLUMNS = 1500
#: The largest 16-bit number, and the one that stands for no value.
LARGEST, NONE = 32767, -32768


def chosen(answers: Answers, lane: int) -> dict[int, list[str]]:
    """Rows of the records that are shown of a body, and why: the worst, that of f_50 nearest to 1, the median.

    Among factors that are not known, or not reached, the record that shakes the body more strongly is the worse.
    """
    factor, strength = known(answers[answers.factor][:, lane]), answers["uplift_ratio"][:, lane]
    order = np.lexsort((-np.nan_to_num(strength), factor))
    half = answers["factor_50" if answers.probable else "safety_factor"][:, lane]
    found: dict[int, list[str]] = {int(order[0]): ["worst"]}
    if np.isfinite(half).any():
        apart = np.where(np.isfinite(half), np.abs(np.log(np.where(half > 0.0, half, np.inf))), np.inf)
        found.setdefault(int(np.argmin(apart)), []).append("nearest" if answers.probable else "nearest_factor")
    found.setdefault(int(order[(order.size - 1) // 2]), []).append("median")
    return found


def steps_on(answers: Answers, row: int, lane: int, words: Mapping[str, str]) -> dict[float, str]:
    """The factors on a record in their order, with what those that have a meaning stand for."""
    meaning = tuple(SHARES.values()) if answers.probable else ("safety_factor",)
    named = [(1.0, words["as_recorded"])]
    named += [(float(answers[name][row, lane]), words[name]) for name in meaning]
    for name in answers.demands:
        named.append((float(answers.to_demand(name)[row, lane]), words["demand"].format(name=name)))
    found: dict[float, str] = {}
    for value, label in named:
        factor = float(f"{value:.3g}")
        if SHOWN[0] <= factor <= SHOWN[1] and len(found) < STEPS and _distance(factor, found) > APART:
            found[factor] = label
    low, high = 0.5 * min(found), 2.0 * max(found)
    while len(found) < STEPS:
        found[max((one for one in OTHERS if low <= one <= high), key=lambda one: _distance(one, found))] = ""
    return dict(sorted(found.items()))


def _distance(factor: float, others: Mapping[float, str]) -> float:
    """How far a factor is from the nearest of others, as a logarithm."""
    return min((abs(math.log(factor / one)) for one in others), default=math.inf)


def points_of(answers: Answers, row: int, lane: int) -> list[list[float]]:
    """Factors on a record and probabilities of overturning there, as far as the results hold them one by one."""
    if not answers.probable:
        return []
    found = [(float(answers[name][row, lane]), share) for share, name in SHARES.items()]
    found.append((1.0, float(answers["overturning_probability"][row, lane])))
    for name in answers.demands:
        found.append((float(answers.to_demand(name)[row, lane]), float(answers.at_demand(name)[row, lane])))
    told = [pair for pair in found if all(map(math.isfinite, pair)) and pair[0] > 0.0]
    return [[round(factor, 4), round(probability, 4)] for factor, probability in sorted(told)]


def laid_through(
    factors: np.ndarray, probability: np.ndarray, stored: Mapping[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """A curve of the probability with its factors moved, linearly in the logarithm, onto stored ones of some shares.

    What is read between the numbers of a stored spectrum differs by some percent from what the body was given there.
    """
    pairs = [(float(factor_at(share, factors, probability)), factor) for share, factor in stored.items()]
    logs = np.log([pair for pair in pairs if all(map(math.isfinite, pair))]).reshape(-1, 2)
    if not len(logs):
        return factors, probability
    (read, moved), (last_read, last_moved) = logs[0], logs[-1]
    slope = (last_moved - moved) / (last_read - read) if last_read > read else 1.0
    return np.exp(moved + slope * (np.log(factors) - read)), probability


def probability_at(
    factor: float, curve: tuple[np.ndarray, np.ndarray] | None, points: list[list[float]]
) -> float | None:
    """The probability at a factor: where the results hold that factor itself, else from the curve."""
    for at, probability in points:
        if math.isclose(at, factor, rel_tol=0.005):
            return probability
    return None if curve is None else round(float(np.interp(math.log(factor), np.log(curve[0]), curve[1])), 4)


def known(factor: np.ndarray) -> np.ndarray:
    """Factors, inf where one is not known."""
    return np.where(np.isnan(factor), np.inf, factor)


@dataclass(frozen=True)
class Columns:
    """A stretch of time from `start` to `end` [s], divided into `count` columns of one width."""

    start: float
    end: float
    count: int

    def extremes(self, time: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(2, count) smallest and largest value of each column; of one without a sample the value before it.

        NaN where all of a column is NaN, and before and after the first and the last value.
        """
        edges = np.linspace(self.start, self.end, self.count + 1)
        first = np.searchsorted(time, edges - 1e-9 * self.end)
        inside = values[: max(int(first[-1]), 1)]
        places = np.minimum(first[:-1], inside.size - 1)
        found = np.stack([one.reduceat(inside, places) for one in (np.fmin, np.fmax)])
        found[:, edges[:-1] > time[-1]] = np.nan
        return found


def packed(extremes: np.ndarray) -> dict[str, float | str]:
    """Extremes as JSON: base64 of int16, all minima before all maxima, and the value of one unit."""
    largest = float(np.nanmax(np.abs(extremes), initial=0.0))
    scale = largest / LARGEST or 1.0
    whole = np.where(np.isnan(extremes), NONE, np.rint(extremes / scale))
    return {"scale": scale, "data": base64.b64encode(whole.astype("<i2").tobytes()).decode("ascii")}
