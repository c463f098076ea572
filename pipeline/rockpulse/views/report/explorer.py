"""Data of the interactive part of the report: motions of bodies under a few records at five scale factors."""

import base64
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.body.outline import Outline
from rocking.spectrum.body_probability import overturning_probability
from rockpulse.assessment.answers import Answers, Body
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.errors import ResultsError
from rockpulse.model_table import FOLLOWING, SearchSettings
from rockpulse.record.record import Record
from rockpulse.views.plots.ground_motion import stored_record
from rockpulse.views.plots.model_histories import ModelHistory, histories, recomputed
from rockpulse.views.plots.selection import block_of, plain_bodies, settings_of
from rockpulse.views.report.record_tables import record_words
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.words import body_name, result_text, say, section
from rockpulse.warning_text import PLAIN

#: Number of scale factors of each record.
STEPS = 5
#: Scale factors that are added if fewer are meaningful, and smallest distance between two scale factors.
OTHERS, APART = (0.5, 0.7, 1.4, 2.0, 3.0, 5.0), 0.03
#: Probabilities for which scale factors are stored, and their variables.
SHARES = {0.1: "factor_10", 0.5: "factor_50"}
#: Smallest and largest scale factor that is shown.
FACTOR_RANGE = (0.05, 20.0)
#: Number of columns of a time window, which exceeds the resolution of a screen.
COLUMNS = 1500
#: Largest 16-bit integer, and the integer that means a missing value.
LARGEST, NONE = 32767, -32768
#: Largest number of bodies with motions on the page, which are those with the smallest scale factors.
MOST_BODIES = 20
#: Time shown before and after the motion [s]; share of alpha_c below which a rotation is treated as rest.
BEFORE, AFTER, NO_MOTION = 1.0, 2.0, 1e-4


@dataclass(frozen=True)
class TimeColumns:
    """A time window [s], divided into columns of equal width."""

    start: float
    end: float
    count: int

    def extremes(self, time: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Return smallest and largest value in each column (2, count); NaN in columns after the end of the motion."""
        edges = np.linspace(self.start, self.end, self.count + 1)
        first = np.searchsorted(time, edges - 1e-9 * self.end)
        inside = values[: max(int(first[-1]), 1)]
        places = np.minimum(first[:-1], inside.size - 1)
        found = np.stack([one.reduceat(inside, places) for one in (np.fmin, np.fmax)])
        found[:, edges[:-1] > time[-1]] = np.nan
        return found


class Explorer(NamedTuple):
    """The data for the script of the page as JSON (empty if no motions are stored), and the name of the model."""

    data: str
    model: str


def explorer(tree: xr.DataTree, file: str = "results.h5", stored: Sequence[str] = ()) -> Explorer | None:
    """Return the data of the interactive part, or None if the model or the results provide no motions."""
    answers, words = Answers(tree["summary"].to_dataset()), section("explorer")
    if answers.model not in FOLLOWING or not answers.bodies or not (answers["npts"] >= 0).any():
        return None
    if not ("records" in tree.children and any(name in tree["records"] for name in ("acceleration", "rotation"))):
        return Explorer("", say(f"models.{answers.model}"))
    scenes = _Scenes(tree, answers, words)
    lowest = np.fmin.reduce(known(answers[answers.factor]), axis=0)
    animated = set(np.argsort(lowest, kind="stable")[:MOST_BODIES].tolist())
    data = {
        "file": file,
        "model": answers.model,
        "words": words,
        "records": [
            {"id": record, "words": record_words(Known(answers.summary, record=record))} for record in answers.records
        ],
        "bodies": [
            {
                "name": body_name(body.name),
                "block": stored[body.place] if stored else body.block,
                "case": body.case + 1 if body.several else 0,
                **_outline(block_of(answers.summary, body.block, body.case + 1)),
                "scenes": scenes.of_body(lane, body) if lane in animated else [],
            }
            for lane, body in enumerate(answers.bodies)
        ],
    }
    return Explorer(json.dumps(data, separators=(",", ":"), allow_nan=False), say(f"models.{answers.model}"))


class _Scenes:
    """Makes the scenes of the page; a scene is the motion of a body under one record at several scale factors."""

    def __init__(self, tree: xr.DataTree, answers: Answers, words: Mapping[str, str]) -> None:
        self._tree, self._answers, self._words = tree, answers, words
        self._plain = set(plain_bodies(answers.summary))

    def of_body(self, lane: int, body: Body) -> list[dict[str, Any]]:
        """Return a scene for each of a body's selected records; a scene without motions contains the reason."""
        found = []
        for row, why in selected_records(self._answers, lane).items():
            reasons = [self._words[one] for one in why]
            try:
                found.append({"record": row, "why": reasons, **self._scene(row, lane, body)})
            except ResultsError as reason:
                found.append({"record": row, "why": reasons, "reason": result_text(str(reason), PLAIN)})
        return found

    def _scene(self, row: int, lane: int, body: Body) -> dict[str, Any]:
        record = self._answers.records[row]
        block = block_of(self._answers.summary, body.block, body.case + 1)
        points = points_of(self._answers, row, lane)
        steps = factor_steps(self._answers, row, lane, self._words)
        as_it_is = histories(self._tree, record, body.block, [self._answers.model], body.case + 1)[0]
        motions = {1.0: as_it_is}
        why_not = ""
        others = [factor for factor in steps if factor != 1.0]
        try:
            again = recomputed(self._tree, record, body.block, block, self._answers.model, others)
            motions |= dict(zip(others, again, strict=True))
        except ResultsError as reason:
            why_not = result_text(str(reason), PLAIN)
        try:
            ground = stored_record(self._tree, record)
            time, acceleration, curve = ground.time, ground.acceleration, self._curve(row, lane, block, ground)
        except ResultsError:
            time, acceleration, curve = as_it_is.time, np.full(as_it_is.time.size, np.nan), None
        if time.size < 2:
            raise ResultsError(as_it_is.warning)
        columns = _window(time, list(motions.values()))
        return {
            "start": round(columns.start, 4),
            "end": round(columns.end, 4),
            "columns": columns.count,
            "whole": round(float(time[-1]), 4),
            "warning": as_it_is.warning,
            "ground": packed(columns.extremes(time, acceleration)),
            "curve": None if curve is None else [np.round(values, 4).tolist() for values in curve],
            "points": points,
            "steps": [
                {
                    "factor": factor,
                    "label": label,
                    "probability": probability_at(factor, curve, points),
                    **(_packed_motion(motions[factor], columns) if factor in motions else {"reason": why_not}),
                }
                for factor, label in steps.items()
            ],
        }

    def _curve(self, row: int, lane: int, block: Block, ground: Record) -> tuple[np.ndarray, np.ndarray] | None:
        """Return scale factors and probabilities of overturning of a free slender body; None for other bodies."""
        slender = self._answers.source[row, lane] in ("slender_limit", "spectrum", "shared_spectrum")
        if not slender or self._answers.bodies[lane].block not in self._plain:
            return None
        uncertainty = settings_of(self._tree, UncertaintySettings).of_draws()
        limit = settings_of(self._tree, SearchSettings).factor_max
        found = overturning_probability(block, ground.acceleration, ground.dt, uncertainty, factor_max=limit)
        return found.level, found.probability[0]


def _window(time: np.ndarray, motions: list[ModelHistory]) -> TimeColumns:
    """Return the time window, with a margin, in which the body moves at any of the scale factors."""
    moving = [one.time[np.abs(one.rotation) > NO_MOTION] for one in motions if one.time.size]
    instants = np.concatenate([*moving, np.zeros(0)])
    start, end = 0.0, float(time[-1])
    if instants.size:
        start, end = max(float(instants.min()) - BEFORE, 0.0), min(float(instants.max()) + AFTER, end)
    samples = int(np.count_nonzero((time >= start) & (time <= end)))
    return TimeColumns(start, end, max(min(COLUMNS, samples - 1), 1))


def _packed_motion(motion: ModelHistory, columns: TimeColumns) -> dict[str, Any]:
    """Return outcome, largest rotation, time of overturning, and the smallest and largest rotation in each column."""
    ends = "unresolved" if math.isnan(motion.peak) else "overturns" if math.isinf(motion.peak) else "rocks"
    found: dict[str, Any] = {"ends": "rest" if motion.peak == 0.0 else ends}
    if ends == "rocks":
        found["peak"] = round(motion.peak, 4)
    if math.isfinite(motion.overturning):
        found["overturning"] = round(motion.overturning, 3)
    if motion.time.size and motion.peak != 0.0:
        found["rotation"] = packed(columns.extremes(motion.time, motion.rotation))
    return found


def _outline(block: Block) -> dict[str, Any]:
    """Return the outline of a body [m], the height of its centre of mass, and the angles alpha of its corners [rad]."""
    body = Outline.of(block)
    return {
        "outline": [[round(x, 4), round(y, 4)] for x, y in body.corners],
        "centre": round(body.centre, 4),
        "alpha": [round(float(one), 6) for one in (block.alpha_c, block.alpha_2)],
        "wall": bool(body.side),
        "held": block.restraints is not None,
    }


def selected_records(answers: Answers, lane: int) -> dict[int, list[str]]:
    """Return the records selected for a body, by row of /summary, each with the reasons for its selection."""
    factor, strength = known(answers[answers.factor][:, lane]), answers["uplift_ratio"][:, lane]
    order = np.lexsort((-np.nan_to_num(strength), factor))
    half = answers["factor_50" if answers.probable else "safety_factor"][:, lane]
    found: dict[int, list[str]] = {int(order[0]): ["worst"]}
    if np.isfinite(half).any():
        apart = np.where(np.isfinite(half), np.abs(np.log(np.where(half > 0.0, half, np.inf))), np.inf)
        found.setdefault(int(np.argmin(apart)), []).append("nearest" if answers.probable else "nearest_factor")
    found.setdefault(int(order[(order.size - 1) // 2]), []).append("median")
    return found


def factor_steps(answers: Answers, row: int, lane: int, words: Mapping[str, str]) -> dict[float, str]:
    """Return five scale factors for a record, in ascending order, each with its label or an empty text."""
    meaning = tuple(SHARES.values()) if answers.probable else ("safety_factor",)
    named = [(1.0, words["as_recorded"])]
    named += [(float(answers[name][row, lane]), words[name]) for name in meaning]
    for name in answers.demands:
        named.append((float(answers.of_demand("demand_factor", name)[row, lane]), words["demand"].format(name=name)))
    found: dict[float, str] = {}
    for value, label in named:
        factor = float(f"{value:.3g}")
        if FACTOR_RANGE[0] <= factor <= FACTOR_RANGE[1] and len(found) < STEPS and _distance(factor, found) > APART:
            found[factor] = label
    low, high = 0.5 * min(found), 2.0 * max(found)
    while len(found) < STEPS:
        found[max((one for one in OTHERS if low <= one <= high), key=lambda one: _distance(one, found))] = ""
    return dict(sorted(found.items()))


def _distance(factor: float, others: Mapping[float, str]) -> float:
    """Return the smallest difference between the logarithms of a scale factor and of any of the others."""
    return min((abs(math.log(factor / one)) for one in others), default=math.inf)


def points_of(answers: Answers, row: int, lane: int) -> list[list[float]]:
    """Return the pairs of scale factor and probability of overturning that are stored in the results."""
    if not answers.probable:
        return []
    found = [(float(answers[name][row, lane]), share) for share, name in SHARES.items()]
    found.append((1.0, float(answers["overturning_probability"][row, lane])))
    for name in answers.demands:
        factor, share = (answers.of_demand(f"demand_{what}", name)[row, lane] for what in ("factor", "probability"))
        found.append((float(factor), float(share)))
    finite = [pair for pair in found if all(map(math.isfinite, pair)) and pair[0] > 0.0]
    return [[round(factor, 4), round(probability, 4)] for factor, probability in sorted(finite)]


def probability_at(
    factor: float, curve: tuple[np.ndarray, np.ndarray] | None, points: list[list[float]]
) -> float | None:
    """Return the stored probability of overturning at a scale factor or, if none is stored, the value of the curve."""
    for at, probability in points:
        if math.isclose(at, factor, rel_tol=0.005):
            return probability
    return None if curve is None else round(float(np.interp(math.log(factor), np.log(curve[0]), curve[1])), 4)


def known(factor: np.ndarray) -> np.ndarray:
    """Return the scale factors with NaN replaced by inf."""
    return np.where(np.isnan(factor), np.inf, factor)


def packed(extremes: np.ndarray) -> dict[str, float | str]:
    """Return minima, then maxima, as 16-bit integers in base64, and the value of one unit of these integers."""
    largest = float(np.nanmax(np.abs(extremes), initial=0.0))
    scale = largest / LARGEST or 1.0
    whole = np.where(np.isnan(extremes), NONE, np.rint(extremes / scale))
    return {"scale": scale, "data": base64.b64encode(whole.astype("<i2").tobytes()).decode("ascii")}
