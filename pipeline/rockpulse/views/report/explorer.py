"""The part of the page to explore: bodies that rock in time under a few records, at five factors on each."""

import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.body.outline import Outline
from rockpulse.assessment.answers import Answers, Body
from rockpulse.assessment.spectra import overturning_curve
from rockpulse.errors import ResultsError
from rockpulse.model_table import FOLLOWING
from rockpulse.views.plots.ground_motion import stored_record
from rockpulse.views.plots.model_histories import histories, recomputed
from rockpulse.views.plots.selection import block_of, plain_bodies
from rockpulse.views.report.explorer_choice import (
    COLUMNS,
    SHARES,
    Columns,
    chosen,
    known,
    laid_through,
    packed,
    points_of,
    probability_at,
    steps_on,
)
from rockpulse.views.report.records import record_words
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.words import say, section

#: Bodies with motions on the page, those of the smallest factors first.
MOST_BODIES = 20
#: Time before and after the motion that is shown [s]; a rotation below this share of alpha_c counts as none.
BEFORE, AFTER, NO_MOTION = 1.0, 2.0, 1e-4


class Explorer(NamedTuple):
    """The JSON that the script of the page reads, empty where nothing in the results moves, and the model in words."""

    data: str
    model: str


class _Motion(NamedTuple):
    """A rotation in time at one factor: theta/alpha_c, empty where the model cannot say."""

    time: np.ndarray
    rotation: np.ndarray
    peak: float
    overturning: float


def explorer(tree: xr.DataTree, file: str = "results.h5") -> Explorer | None:
    """The motions to explore; None under a design sequence, without a record, by a model without motions in time."""
    answers, told = Answers(tree["summary"].to_dataset()), section("explorer")
    if answers.model not in FOLLOWING or not answers.bodies or not (answers["npts"] >= 0).any():
        return None
    if not ("records" in tree.children and any(name in tree["records"] for name in ("acceleration", "rotation"))):
        return Explorer("", say(f"models.{answers.model}"))
    scenes = _Scenes(tree, answers, told)
    lowest = np.fmin.reduce(known(answers[answers.factor]), axis=0)
    shown = set(np.argsort(lowest, kind="stable")[:MOST_BODIES].tolist())
    data = {
        "file": file,
        "model": answers.model,
        "words": told,
        "records": [
            {"id": record, "words": record_words(Known(answers.summary, record=record))} for record in answers.records
        ],
        "bodies": [
            {
                "name": body.name,
                "block": body.block,
                "case": body.case + 1 if body.several else 0,
                **_outline(block_of(answers.summary, body.block, body.case + 1)),
                "scenes": scenes.of_body(lane, body) if lane in shown else [],
            }
            for lane, body in enumerate(answers.bodies)
        ],
    }
    return Explorer(json.dumps(data, separators=(",", ":"), allow_nan=False), say(f"models.{answers.model}"))


class _Scenes:
    """The scenes of the bodies of one file: a body under a record, in time, at each factor."""

    def __init__(self, tree: xr.DataTree, answers: Answers, told: Mapping[str, str]) -> None:
        self._tree, self._answers, self._words = tree, answers, told
        self._plain = set(plain_bodies(answers.summary))
        self._spectra = tree["spectra"].to_dataset() if "spectra" in tree.children else None

    def of_body(self, lane: int, body: Body) -> list[dict[str, Any]]:
        """A scene for each record that is chosen, or the reason why there is none."""
        found = []
        for row, why in chosen(self._answers, lane).items():
            told = [self._words[one] for one in why]
            try:
                found.append({"record": row, "why": told, **self._scene(row, lane, body)})
            except ResultsError as reason:
                found.append({"record": row, "why": told, "reason": str(reason)})
        return found

    def _scene(self, row: int, lane: int, body: Body) -> dict[str, Any]:
        record = self._answers.records[row]
        block = block_of(self._answers.summary, body.block, body.case + 1)
        curve, points = self._curve(row, lane, block), points_of(self._answers, row, lane)
        steps = steps_on(self._answers, row, lane, self._words)
        as_it_is = histories(self._tree, record, body.block, [self._answers.model], body.case + 1)[0]
        motions = {1.0: _Motion(as_it_is.time, as_it_is.rotation, as_it_is.peak, as_it_is.overturning)}
        why_not = ""
        others = [factor for factor in steps if factor != 1.0]
        try:
            again = recomputed(self._tree, record, body.block, block, self._answers.model, others)
            rows = zip(others, again.rotation, again.peak, again.overturning, strict=True)
            motions |= {at: _Motion(again.time, one, float(top), float(end)) for at, one, top, end in rows}
        except ResultsError as reason:
            why_not = str(reason)
        if block.side:
            # The sense of the record that acts turns the body away from its wall.
            motions = {at: one._replace(rotation=np.abs(one.rotation)) for at, one in motions.items()}
        try:
            ground = stored_record(self._tree, record)
            time, acceleration = ground.time, ground.acceleration
        except ResultsError:
            time, acceleration = as_it_is.time, np.full(as_it_is.time.size, np.nan)
        if time.size < 2:
            raise ResultsError(f"{body.name} under {record}, {self._answers.model} model: {as_it_is.remark}")
        columns = _window(time, list(motions.values()))
        return {
            "start": round(columns.start, 4),
            "end": round(columns.end, 4),
            "columns": columns.count,
            "whole": round(float(time[-1]), 4),
            "remark": as_it_is.remark,
            "ground": packed(columns.extremes(time, acceleration)),
            "curve": None if curve is None else [np.round(values, 4).tolist() for values in curve],
            "points": points,
            "steps": [
                {
                    "factor": factor,
                    "label": label,
                    "probability": probability_at(factor, curve, points),
                    **(_told(motions[factor], columns) if factor in motions else {"reason": why_not}),
                }
                for factor, label in steps.items()
            ],
        }

    def _curve(self, row: int, lane: int, block: Block) -> tuple[np.ndarray, np.ndarray] | None:
        """Factors on a record and the probability at each, where the stored spectrum stands for the body."""
        read, body = self._answers.source[row, lane] == "spectrum", self._answers.bodies[lane]
        if self._spectra is None or not read or body.several or body.block not in self._plain:
            return None
        factors, probability = overturning_curve(self._spectra.sel(record=self._answers.records[row]), block)
        if not (np.isfinite(probability).all() and np.isfinite(factors).all()):
            return None
        stored = {share: float(self._answers[name][row, lane]) for share, name in SHARES.items()}
        return laid_through(factors, probability, stored)


def _window(time: np.ndarray, motions: list[_Motion]) -> Columns:
    """The stretch of a record in which the body moves at one of the factors, with some time around it."""
    moving = [one.time[np.abs(one.rotation) > NO_MOTION] for one in motions if one.time.size]
    instants = np.concatenate([*moving, np.zeros(0)])
    start, end = 0.0, float(time[-1])
    if instants.size:
        start, end = max(float(instants.min()) - BEFORE, 0.0), min(float(instants.max()) + AFTER, end)
    samples = int(np.count_nonzero((time >= start) & (time <= end)))
    return Columns(start, end, max(min(COLUMNS, samples - 1), 1))


def _told(motion: _Motion, columns: Columns) -> dict[str, Any]:
    """How a motion ends, its largest rotation and the time of overturning, and the rotation where the body moves."""
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
    """The outline of a body [m], the centre of mass above x = 0, and the angles of its corners [rad]."""
    body = Outline.of(block)
    return {
        "outline": [[round(x, 4), round(y, 4)] for x, y in body.corners],
        "centre": round(body.centre, 4),
        "alpha": [round(float(one), 6) for one in (block.alpha_c, block.alpha_2)],
        "wall": bool(body.side),
        "held": block.restraints is not None,
    }
