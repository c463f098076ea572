"""Rotation histories of a body under one record in several models, read from the results or recomputed."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.impulses.half_cycle import CRITICAL_TOLERANCE, state
from rocking.pictures import short_repr
from rocking.response import IMPACT_CUTOFF, Outcome, Response
from rockpulse.assessment.scene import acting, floor_record
from rockpulse.config.restraint_settings import floors_from_text
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ResultsError
from rockpulse.model_table import DRAWN, FOLLOWING, MODELS, SEQUENCE_MODELS, ModelSettings, Scene
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record
from rockpulse.selection.directions import FACING_WITHIN
from rockpulse.views.plots import selection
from rockpulse.views.plots.ground_motion import STORE, had_vertical, stored_record
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import say

#: phi in the times t_k = (k - phi) dT of the secondary impulses; for "open" the number of intervals is n + 1.
_PHASE = {"end": 0.0, "middle": 0.5, "start": 1.0, "open": 0.0}


class HalfCycle(NamedTuple):
    """One half-cycle of a block; velocities are u = theta'/(p alpha_c), and the first one is towards theta < 0."""

    start_velocity: float  # u_i [-]
    duration: float  # [s], inf where the block overturns
    impulse_count: int  # number n_i of secondary impulses [-]
    interval: float  # dT_i of the secondary impulses [s]


def secondary_impulses(cycle: HalfCycle, secondary: float, spacing: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and velocity changes [-] of the secondary impulses within a half-cycle."""
    if secondary == 0.0:
        return np.zeros(0), np.zeros(0)
    if spacing == "continuous":  # the limit of infinitely many is half an impulse at the start and half at the end
        return np.array([0.0, cycle.duration]), np.array([-0.5, 0.5]) * secondary
    order = np.arange(1, cycle.impulse_count + 1)
    return (order - _PHASE[spacing]) * cycle.interval, np.where(order % 2, -secondary, secondary)


def motion_samples(cycles: list[HalfCycle], p: float, secondary: float, spacing: str, times: np.ndarray) -> np.ndarray:
    """Return the signed rotation theta/alpha_c [-] at increasing times after the first main impulse [s].

    `p` is in 1/s and `secondary` is a = u_1 I_s/I [-]. If the body overturns, no secondary impulse acts in the
    last half-cycle, and the rotation is NaN after alpha_c. At exactly the critical velocity a block never
    reaches alpha_c.
    """
    # Pieces of free motion: time of the start [s], x and x' there [-], and side.
    pieces: list[tuple[float, float, float, float]] = []
    start, side = 0.0, -1.0
    for cycle in cycles:
        pieces.append((start, 0.0, cycle.start_velocity, side))
        if not math.isfinite(cycle.duration):
            break
        offsets, changes = secondary_impulses(cycle, secondary, spacing)
        for offset, change in zip(offsets.tolist(), changes.tolist(), strict=True):
            begun, *last, _ = pieces[-1]
            rotation, velocity = state(*last, p * (start + offset - begun))
            pieces.append((start + offset, rotation, velocity + change, side))
        start, side = start + cycle.duration, -side
    table = np.array(pieces)
    of = np.searchsorted(table[:, 0], times, side="right") - 1
    begin, rotation, velocity, sides = table[of].T
    elapsed = p * (times - begin)
    growing = rotation - 1.0 + velocity
    growing = np.where(np.abs(growing) <= CRITICAL_TOLERANCE, 0.0, growing)
    decaying = rotation - 1.0 - velocity
    x = 1.0 + 0.5 * (growing * np.exp(np.minimum(elapsed, 700.0)) + decaying * np.exp(-elapsed))
    overturned = (of == len(pieces) - 1) & (not math.isfinite(cycles[-1].duration)) & (x > 1.0)
    return np.where(overturned, np.nan, sides * x)


#: Difference between stored and recomputed peak above which a history gets a warning [-], and number of points of the
#: history of a sequence.
_SAME, _INSTANTS = 1e-3, 4000
#: Advice if the file does not contain the motion of a body.
_AGAIN, _OTHERS = "assess again with [models] histories = true", "draw other models (--model)"


class ModelHistory(NamedTuple):
    """The motion of a body in one model; the arrays are empty if the model gave no result.

    >>> history = rp.plots.histories(results, "burst.2", "pier")[0]
    >>> history.model, round(history.peak, 3)
    ('nonlinear', 0.581)
    """

    model: str
    time: np.ndarray = np.zeros(0)  # (n,) time after the first sample of the record [s]
    rotation: np.ndarray = np.zeros(0)  # (n,) theta/alpha_c [-]; NaN once the block has overturned
    impacts: np.ndarray = np.zeros(0)  # (k,) times of the impacts in the history [s]
    impact_count: int = -1  # number of impacts; -1 if endless or unknown
    overturning: float = math.nan  # time at which overturning is certain [s]; NaN without overturning
    peak: float = math.nan  # theta_max/alpha_c [-]; inf if the block overturns, NaN without a result
    warning: str = ""  # doubts about the motion
    one_sided: bool = False  # whether the body turns only away from its wall, towards theta > 0

    def __repr__(self) -> str:
        return short_repr(self)


def histories(
    tree: xr.DataTree,
    record: str | None = None,
    block: str | None = None,
    models: Sequence[str] | None = None,
    case: int = 1,
    factor: float = 1.0,
) -> list[ModelHistory]:
    """Return the motion of a body under a record in each model.

    Parameters
    ----------
    tree : xarray.DataTree
        Results of an assessment.
    record, block : str, optional
        Names; not needed if there is only one.
    models : sequence of str, optional
        Any of nonlinear, linear, impulsive, sequence and resonance. The first three use the record and are the
        default, if the results contain them. A model without a result (UNRESOLVED) has an empty history and a
        warning.
    case : int
        Number of the restitution, from 1.
    factor : float
        Scale factor, positive [-]; values other than 1 are allowed only for models that use the record.

    Notes
    -----
    Histories of models that use the record are read if stored ([models] histories = true). If not, and at other scale
    factors, they are recomputed from the stored accelerogram or, for impulsive, from the stored half-waves. Sequence
    and resonance have their own time axis: their first main impulse is placed at the start of the intense phase.

    Examples
    --------
    >>> [(one.model, round(one.peak, 3)) for one in rp.plots.histories(results, "burst.2", "pier")]
    [('nonlinear', 0.581)]
    """
    summary = tree["summary"].to_dataset()
    record, block = selection.one_name(summary, "record", record), selection.one_name(summary, "block", block)
    known = [str(name) for name in summary["model"].values]
    if models is None:
        models = [name for name in FOLLOWING if name in known] or [name for name in DRAWN if name in known]
    models = [selection.one_name(summary, "model", name) for name in models]
    for name in models:
        if name not in DRAWN:
            raise ResultsError(f'model "{name}": expected a model that computes a motion: {", ".join(DRAWN)}')
        if factor != 1.0 and name not in FOLLOWING:
            raise ResultsError(f'model "{name}": expected a model that can use a scaled record: {", ".join(FOLLOWING)}')
    if not (np.isfinite(factor) and factor > 0.0):
        raise ResultsError(f"factor: expected a positive scale factor, got {factor:g}")
    if factor == 1.0:
        return [_history(tree, record, block, name, case) for name in models]
    body = selection.block_of(summary, block, case)
    scaled = [recomputed(tree, record, block, body, name, [factor])[0] for name in models]
    return [ModelHistory(one.model, warning=say("unknown.unresolved")) if np.isnan(one.peak) else one for one in scaled]


def _history(tree: xr.DataTree, record: str, block: str, model: str, case: int) -> ModelHistory:
    summary = tree["summary"].to_dataset()
    answer = summary.sel(record=record, block=block, model=model).isel(selection.chosen_case(summary, case))
    peak, outcome = float(answer["peak_rotation_ratio"]), int(answer["outcome"])
    overturning = float(answer["overturning_time"]) if "overturning_time" in answer else np.nan
    count = int(answer["impacts"]) if "impacts" in answer else -1
    warnings = [] if "applicable" not in answer or int(answer["applicable"]) else [say("unknown.outside")]
    if outcome == Outcome.UNRESOLVED:
        return ModelHistory(model, warning="; ".join([say("unknown.unresolved"), *warnings]))
    body = selection.block_of(summary, block, case)
    if model in SEQUENCE_MODELS:
        # A design sequence belongs to no record: its own time is used.
        start = float(np.nan_to_num(summary["intense_start"].sel(record=record)))
        time, rotation, hits = _of_sequence(tree, record, block, model, case)
        time, hits, overturning = start + time, start + hits, start + overturning
    elif kept := stored_history(tree, record, block, model, case):
        time, rotation = kept
        hits = _impacts(time, rotation, body)
    else:
        again = recomputed(tree, record, block, body, model, [1.0])[0]
        time, rotation, hits, found = again.time, again.rotation, again.impacts, again.peak
        if not (found == peak or abs(found - peak) <= _SAME):
            now, before = (
                say("limit_state.overturning") if np.isinf(one) else three_digits(one) for one in (found, peak)
            )
            warnings.append(say("plot.motion.again", again=now, stored=before))
    return ModelHistory(model, time, rotation, hits, count, overturning, peak, "; ".join(warnings), bool(body.side))


def stored_history(
    tree: xr.DataTree, record: str, block: str, model: str, case: int
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the stored times [s] and rotations theta/alpha_c under the unscaled record, or None if not stored."""
    if "records" not in tree.children or "rotation" not in tree["records"]:
        return None
    summary, kept = tree["summary"].to_dataset(), tree["records"].to_dataset()
    place = {"record": record, "lane": block, "model": model}
    at = {one: summary[one if one != "lane" else "block"].values.tolist().index(name) for one, name in place.items()}
    at["lane"] = at["lane"] * summary.sizes.get("case", 1) + case - 1
    rows = np.flatnonzero(np.all([kept[f"history_{one}_index"].values == own for one, own in at.items()], axis=0))
    if rows.size == 0:
        return None
    first, last = np.cumsum([0, *kept["history_row_size"].values])[rows[0] : rows[0] + 2]
    rotation = np.asarray(kept["rotation"].values[first:last])
    dt = float(summary["dt"].sel(record=record))
    return dt * np.arange(rotation.size), _ratio(selection.block_of(summary, block, case), rotation)


def _of_sequence(
    tree: xr.DataTree, record: str, block: str, model: str, case: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, rotations theta/alpha_c and times of impacts, computed from the stored half-cycles."""
    own = tree["summary"].to_dataset().sel(block=block)
    table = selection.table_of_pair(tree, "half_cycles", record, block, model, case)
    order = np.argsort(table["half_cycle"])
    cycles = [HalfCycle(*one) for one in zip(*(table[name][order].tolist() for name in HalfCycle._fields), strict=True)]
    p, sequence = float(own["p"]), selection.sequence_of(tree, record)
    share = 0.0 if MODELS[model].cycles == "main" else float(sequence.secondary) / float(own["critical_impulse"])
    ends = np.cumsum([cycle.duration for cycle in cycles if np.isfinite(cycle.duration)])
    # An overturning half-cycle is continued for some time beyond alpha_c, where the history ends.
    last = (float(ends[-1]) if ends.size else 0.0) + (0.0 if np.isfinite(cycles[-1].duration) else 6.0 / p)
    time = np.linspace(0.0, last, _INSTANTS)
    return time, motion_samples(cycles, p, share, sequence.spacing, time), ends


def _impacts(time: np.ndarray, rotation: np.ndarray, body: Block) -> np.ndarray:
    """Return the times of the impacts in a rotation history; slow impacts are left out."""
    before, after = rotation[:-1], rotation[1:]
    if body.side:
        # A reversal at the wall between two samples is found by mirroring the motion after it.
        after = np.where(2.0 * np.abs(before) < np.abs(np.concatenate([before[:1], before[:-1]])), -after, after)
    with np.errstate(invalid="ignore", divide="ignore"):
        crossed = before * after < 0.0
        speed = np.abs(after - before) / np.diff(time) / body.p
        at = time[:-1] + np.diff(time) * before / (before - after)
    return at[crossed & (speed > IMPACT_CUTOFF)]


def recomputed(
    tree: xr.DataTree, record: str, block: str, body: Block, model: str, factors: Sequence[float]
) -> list[ModelHistory]:
    """Recompute the motion of a body under a record at each scale factor; raise ResultsError if data are missing."""
    summary, row = tree["summary"].to_dataset(), MODELS[model]
    floors = floors_from_text(str(summary["floors"].sel(block=block).values))
    azimuth, own = float(summary["azimuth"].sel(record=record)), float(summary["body_azimuth"].sel(block=block))
    turned = selection.settings_of(tree, RecordSettings).components != "horizontal"
    if turned and np.isfinite(own) and not abs(math.remainder(own - azimuth, 180.0)) <= FACING_WITHIN:
        raise ResultsError(
            f"{block}: the motion in the direction of this body is not in the file: {_AGAIN}, or with "
            '[records] components = "azimuth" and the azimuth of this body'
        )
    if floors and row.takes == "half-waves":
        raise ResultsError(f"{block}: the half-waves of its floor are not in the file: {_AGAIN}, or {_OTHERS}")
    if row.takes == "half-waves":
        return _worse(model, body, [row.respond(body, _of_half_waves(tree, record, model), np.asarray(factors))])
    if row.vertical and had_vertical(summary, record):
        raise ResultsError(f"{record}: the file lacks the vertical channel, which was used: {_AGAIN}, or {_OTHERS}")
    if selection.ragged(tree, "row_size", ["acceleration"], record) is None:
        raise ResultsError(f"{record}: {STORE}, or with [models] histories = true")
    motion = stored_record(tree, record)
    motion = floor_record(motion, floors) if floors else motion
    # For a body beside a wall the worse of the possible senses of the record is stored.
    facing = float(summary["facing"].sel(block=block))
    scene = _scene(tree, motion, {"impulse": np.zeros(0), "centroid": np.zeros(0)})
    senses = acting(azimuth, facing) if body.side else (1,)
    bodies = [body if sense > 0 else body.mirrored() for sense in senses]
    return _worse(model, body, [row.respond(one, scene, np.asarray(factors)) for one in bodies])


def _of_half_waves(tree: xr.DataTree, record: str, model: str) -> Scene:
    summary = tree["summary"].to_dataset().sel(record=record)
    waves = selection.ragged(tree, "half_wave_row_size", ["half_wave_centroid", "half_wave_impulse"], record)
    if waves is None:
        raise ResultsError(
            f"{record}: the file contains neither the half-waves nor histories of {model}: assess again with "
            '[records] store = "half_waves" or "all"'
        )
    still = Record(np.zeros(int(summary["npts"])), dt=float(summary["dt"]), id=record)
    return _scene(tree, still, {name: waves[f"half_wave_{name}"].values for name in ("impulse", "centroid")})


def _scene(tree: xr.DataTree, record: Record, waves: dict[str, np.ndarray]) -> Scene:
    others = dict.fromkeys(("start", "end", "peak", "lobes"), np.zeros(waves["impulse"].size))
    return Scene(
        record=record,
        vertical=None,
        waves=HalfWaves(**waves, **others, dt=record.dt, record_id=record.id),
        phase=IntensePhase(0.0, record.duration),
        sequence=None,
        gain=selection.settings_of(tree, ModelSettings).gain,
    )


def _worse(model: str, body: Block, found: Sequence[Response]) -> list[ModelHistory]:
    """Return, for each scale factor, the motion from the response in `found` with the largest rotation."""
    rank = [np.nan_to_num(one.peak_rotation_ratio, nan=np.finfo(float).max) for one in found]
    names = ("impacts", "overturning_time", "peak_rotation_ratio")
    time, histories = np.asarray(found[0].time), []
    for lane, worse in enumerate(np.argmax(rank, axis=0)):
        rotation = _ratio(body, np.asarray(found[worse].rotation)[lane])
        values = (getattr(found[worse], name)[lane].item() for name in names)
        hits = _impacts(time, rotation, body)
        histories.append(ModelHistory(model, time, rotation, hits, *values)._replace(one_sided=bool(body.side)))
    return histories


def _ratio(body: Block, rotation: np.ndarray) -> np.ndarray:
    """Return theta/alpha_c; for a body beside a wall, rotations away from the wall are positive."""
    ratio = body.ratio(rotation)
    return np.abs(ratio) if body.side else ratio
