"""Rotation histories of a block under one record by several models, stored in the results or computed from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rocking.block import Block
from rocking.impulsive import impulsive_response
from rocking.recorded import recorded_response
from rocking.response import IMPACT_CUTOFF, Outcome
from rockpulse.assessment.places import floor_record
from rockpulse.assessment.senses import acting
from rockpulse.config.restraint_settings import floors_from_text
from rockpulse.errors import ResultsError
from rockpulse.ladder import SEQUENCE_MODELS
from rockpulse.motions.directions import FACING_WITHIN
from rockpulse.studies.paper.motion_history import HalfCycle, rotation_history
from rockpulse.views.plots.motion import STORE, had_vertical, stored_record
from rockpulse.views.plots.selection import (
    block_of,
    chosen_case,
    gain_of,
    one_name,
    ragged,
    sequence_of,
    setting,
    table_of_pair,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["DRAWN", "History", "histories"]

#: Models that have a motion in time, in the order in which they are drawn.
DRAWN = ("nonlinear", "linear", "impulsive", "sequence", "resonance")

#: Peaks that differ by more than this [-] are said to.
_SAME = 1e-3

#: Instants of the history of a sequence.
_INSTANTS = 4000


class History(NamedTuple):
    """The motion of a block by one model.

    Attributes
    ----------
    model : str
        Its name.
    time, rotation : (n,) ndarray
        Time [s] from the first sample of the record, and theta/alpha_c [-]; NaN once the block has overturned.
    impacts : (k,) ndarray
        Times of the impacts that the history shows [s].
    impact_count : int
        Impacts that the model counts; -1 where they never end or are not known.
    overturning : float
        Time from which overturning is certain [s]; NaN without.
    peak : float
        Stored theta_max/alpha_c [-]; inf where the block overturns, NaN where the model cannot say.
    remark : str
        Remark on doubts about the motion; empty without any.
    """

    model: str
    time: np.ndarray
    rotation: np.ndarray
    impacts: np.ndarray
    impact_count: int
    overturning: float
    peak: float
    remark: str


def histories(
    tree: xr.DataTree,
    record: str | None = None,
    block: str | None = None,
    models: Sequence[str] | None = None,
    case: int = 1,
) -> list[History]:
    """Motion of a block under a record by each model.

    Parameters
    ----------
    tree : xarray.DataTree
        Results of an assessment.
    record, block : str, optional
        Names; none where there is one only.
    models : sequence of str, optional
        Some of :data:`DRAWN`; by default those that the results have of "nonlinear", "linear" and "impulsive".
    case : int
        Number of the restitution, from 1.

    Returns
    -------
    list of History
        A model that could not say (UNRESOLVED) is there with an empty history and its remark.

    Raises
    ------
    ResultsError
        For a name that is not there, a model without a motion of its own, or where the file lacks what is needed.

    Notes
    -----
    "nonlinear" and "linear": as stored ([models] histories = true), else computed again from the stored accelerogram.
    "impulsive": computed again from the stored half-waves. "sequence" and "resonance" have a time of their own: their
    first main impulse is put at the beginning of the intense phase.
    """
    summary = tree["summary"].to_dataset()
    record, block = one_name(summary, "record", record), one_name(summary, "block", block)
    known = [str(name) for name in summary["model"].values]
    if models is None:
        models = [name for name in DRAWN[:3] if name in known] or [name for name in DRAWN if name in known]
    models = [one_name(summary, "model", name) for name in models]
    for name in models:
        if name not in DRAWN:
            raise ResultsError(f'model "{name}": expected one with a motion in time: {", ".join(DRAWN)}')
    return [_history(tree, record, block, name, case) for name in models]


def _history(tree: xr.DataTree, record: str, block: str, model: str, case: int) -> History:
    summary = tree["summary"].to_dataset()
    answer = summary.sel(record=record, block=block, model=model).isel(chosen_case(summary, case))
    peak, outcome = float(answer["peak_rotation_ratio"]), int(answer["outcome"])
    overturning = float(answer["overturning_time"]) if "overturning_time" in answer else np.nan
    count = int(answer["impacts"]) if "impacts" in answer else -1
    remark = [] if "applicable" not in answer or int(answer["applicable"]) else ["outside the range of the model"]
    if "predictable" in answer and int(answer["predictable"]) == 0:
        remark.append("not predictable: it changes with the ninth digit of C or the record")
    nothing = np.zeros(0)
    if outcome == Outcome.UNRESOLVED:
        return History(model, nothing, nothing, nothing, -1, np.nan, np.nan, "; ".join(["unresolved", *remark]))
    body = block_of(summary, block, case)
    if model in SEQUENCE_MODELS:
        # A design sequence stands for no record: its own time is the only one.
        start = float(np.nan_to_num(summary["intense_start"].sel(record=record)))
        time, rotation, impacts = _of_sequence(tree, record, block, model, case)
        return History(
            model, start + time, rotation, start + impacts, count, start + overturning, peak, "; ".join(remark)
        )
    time, rotation, found = _of_record(tree, record, block, body, model, case)
    if found is not None and not _equal(found, peak):
        remark.append(f"computed again the peak is {_shown(found)}, stored is {_shown(peak)}")
    return History(model, time, rotation, _impacts(time, rotation, body), count, overturning, peak, "; ".join(remark))


def _of_record(
    tree: xr.DataTree, record: str, block: str, body: Block, model: str, case: int
) -> tuple[np.ndarray, np.ndarray, float | None]:
    """Time, theta/alpha_c, and the peak where the motion was computed again (else None)."""
    summary = tree["summary"].to_dataset()
    dt = float(summary["dt"].sel(record=record))
    stored = _stored(tree, record, block, model, case)
    if stored is not None:
        return dt * np.arange(stored.size), body.ratio(stored), None
    told = str(summary["floors"].sel(block=block).values) if "floors" in summary else ""
    floors = floors_from_text(told)
    if not _in_direction(summary, record, block, tree):
        raise ResultsError(
            f"{block}: it is shaken in a direction of its own, whose motion is not in the file: assess again with "
            "[models] histories = true, or with its direction as that of [records]"
        )
    if floors and model == "impulsive":
        raise ResultsError(
            f"{block}: the half-waves of its floor are not in the file: assess again with [models] histories = true, "
            "or draw other models (--model)"
        )
    if model == "impulsive":
        waves = ragged(tree, "half_wave_row_size", ["half_wave_centroid", "half_wave_impulse"], record)
        if waves is None:
            raise ResultsError(
                f"{record}: the file does not hold the half-waves, nor histories of {model}: assess again with "
                '[records] store = "half_waves" or "all"'
            )
        duration = (int(summary["npts"].sel(record=record)) - 1) * dt
        response: Any = impulsive_response(
            body,
            waves["half_wave_centroid"].values,
            waves["half_wave_impulse"].values,
            duration=duration,
            gain=gain_of(tree),
            history_dt=dt,
        )
    else:
        if model == "nonlinear" and had_vertical(summary, record):
            raise ResultsError(
                f"{record}: the vertical channel acted and is not in the file: assess again with [models] histories = "
                "true, or draw other models (--model)"
            )
        if ragged(tree, "row_size", ["acceleration"], record) is None:
            raise ResultsError(f"{record}: {STORE}, or with [models] histories = true")
        motion = stored_record(tree, record)
        if floors:
            motion = floor_record(motion, floors)
        equation: Any = "linear" if model == "linear" else "nonlinear"
        # What is stored of a body before a wall is the worse of those senses of the record that may act.
        facing = float(summary["facing"].sel(block=block)) if "facing" in summary else np.nan
        azimuth = float(summary["azimuth"].sel(record=record))
        response = max(
            (
                recorded_response(
                    body if sense > 0 else body.mirrored(), motion.acceleration, motion.dt, equation, history=True
                )
                for sense in (acting(azimuth, facing) if body.side else (1,))
            ),
            key=lambda one: float(np.nan_to_num(one.peak_rotation_ratio, nan=np.finfo(float).max)),
        )
    return response.time, body.ratio(response.rotation), float(response.peak_rotation_ratio)


def _in_direction(summary: xr.Dataset, record: str, block: str, tree: xr.DataTree) -> bool:
    """Whether a record is what shakes a block, which may have a direction of its own."""
    own = float(summary["body_azimuth"].sel(block=block)) if "body_azimuth" in summary else np.nan
    turned = setting(tree, "records", "components", "horizontal") != "horizontal"
    apart = abs(math.remainder(own - float(summary["azimuth"].sel(record=record)), 180.0)) if np.isfinite(own) else 0.0
    return not turned or apart <= FACING_WITHIN


def _stored(tree: xr.DataTree, record: str, block: str, model: str, case: int) -> np.ndarray | None:
    """theta [rad] as /records holds it."""
    if "records" not in tree.children or "rotation" not in tree["records"]:
        return None
    summary, kept = tree["summary"].to_dataset(), tree["records"].to_dataset()
    place = [str(name) for name in summary["block"].values].index(block)
    lane = place * summary.sizes.get("case", 1) + case - 1
    rows = np.flatnonzero(
        (kept["history_record_index"].values == summary.get_index("record").get_loc(record))
        & (kept["history_lane_index"].values == lane)
        & (kept["history_model_index"].values == summary.get_index("model").get_loc(model))
    )
    if rows.size == 0:
        return None
    sizes = kept["history_row_size"].values
    first = int(np.sum(sizes[: rows[0]]))
    return np.asarray(kept["rotation"].values[first : first + int(sizes[rows[0]])])


def _of_sequence(
    tree: xr.DataTree, record: str, block: str, model: str, case: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time from the first main impulse, theta/alpha_c, impacts: from the table of half-cycles."""
    summary = tree["summary"].to_dataset()
    table = table_of_pair(tree, "half_cycles", record, block, model, case)
    order = np.argsort(table["half_cycle"])
    columns = [table[name][order] for name in ("start_velocity", "duration", "impulse_count", "interval")]
    cycles = [HalfCycle(float(u), float(t), int(n), float(dt)) for u, t, n, dt in zip(*columns, strict=True)]
    p = float(summary["p"].sel(block=block))
    sequence = sequence_of(tree, record)
    share = sequence.secondary / float(summary["critical_impulse"].sel(block=block)) if model == "sequence" else 0.0
    ends = np.cumsum([cycle.duration for cycle in cycles if np.isfinite(cycle.duration)])
    # An overturning half-cycle is followed a while beyond alpha_c, where the history ends by itself.
    last = (float(ends[-1]) if ends.size else 0.0) + (0.0 if np.isfinite(cycles[-1].duration) else 6.0 / p)
    time = np.linspace(0.0, last, _INSTANTS)
    return time, rotation_history(cycles, p, share, sequence.spacing, time), ends


def _impacts(time: np.ndarray, rotation: np.ndarray, body: Block) -> np.ndarray:
    """Times of impacts faster than `IMPACT_CUTOFF`: changes of sign, or turns that only a wall behind explains."""
    before, after = rotation[:-1], rotation[1:]
    if body.side:
        # What turns back between two samples has gone on to the other side of the wall, as in a mirror.
        after = np.where(2.0 * np.abs(before) < np.abs(np.concatenate([before[:1], before[:-1]])), -after, after)
    with np.errstate(invalid="ignore", divide="ignore"):
        crossed = before * after < 0.0
        speed = np.abs(after - before) / np.diff(time) / body.p
        at = time[:-1] + np.diff(time) * before / (before - after)
    return at[crossed & (speed > IMPACT_CUTOFF)]


def _equal(found: float, stored: float) -> bool:
    return found == stored or abs(found - stored) <= _SAME


def _shown(peak: float) -> str:
    return "overturning" if np.isinf(peak) else f"{peak:.3g}"
