"""The motion of a block under a record of the results, computed again from what the file holds of the record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rocking.body.block import Block
from rocking.response import Response
from rockpulse.assessment.places import floor_record
from rockpulse.assessment.senses import acting
from rockpulse.config.block_settings import floors_from_text
from rockpulse.errors import ResultsError
from rockpulse.model_row import Scene
from rockpulse.model_table import MODELS
from rockpulse.motions.directions import FACING_WITHIN
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record
from rockpulse.views.plots.motion import STORE, had_vertical, stored_record
from rockpulse.views.plots.selection import gain_of, ragged, setting

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Recomputed", "recomputed"]


class Recomputed(NamedTuple):
    """Motions under a record times (q,) factors: ``rotation`` is theta/alpha_c, NaN once the block has overturned."""

    time: np.ndarray  # (n,) from the first sample of the record [s]
    rotation: np.ndarray  # (q, n)
    peak: np.ndarray  # (q,) the largest rotation; inf where the block overturns, NaN where the model cannot say
    outcome: np.ndarray  # (q,) rocking.Outcome
    overturning: np.ndarray  # (q,) time from which overturning is certain [s]; NaN without
    impacts: np.ndarray  # (q,) -1 where they never end or are not known


def recomputed(
    tree: xr.DataTree, record: str, block: str, body: Block, model: str, factors: Sequence[float]
) -> Recomputed:
    """Motions of a block, which is `body`, under a record times some factors, by a model that follows the record.

    A ResultsError where the file does not hold the ground motion that acts on the block.
    """
    summary, row = tree["summary"].to_dataset(), MODELS[model]
    floors = floors_from_text(str(summary["floors"].sel(block=block).values))
    if not _in_direction(summary, record, block, tree):
        raise ResultsError(
            f"{block}: it is shaken in a direction of its own, whose motion is not in the file: assess again with "
            "[models] histories = true, or with its direction as that of [records]"
        )
    if floors and row.takes == "half-waves":
        raise ResultsError(
            f"{block}: the half-waves of its floor are not in the file: assess again with [models] histories = true, "
            "or draw other models (--model)"
        )
    if row.takes == "half-waves":
        return _worse(body, [row.respond(body, _of_half_waves(tree, record, model), np.asarray(factors))])
    if row.vertical and had_vertical(summary, record):
        raise ResultsError(
            f"{record}: the vertical channel acted and is not in the file: assess again with [models] histories = "
            "true, or draw other models (--model)"
        )
    if ragged(tree, "row_size", ["acceleration"], record) is None:
        raise ResultsError(f"{record}: {STORE}, or with [models] histories = true")
    motion = stored_record(tree, record)
    if floors:
        motion = floor_record(motion, floors)
    # What is stored of a body before a wall is the worse of those senses of the record that may act.
    facing = float(summary["facing"].sel(block=block))
    azimuth = float(summary["azimuth"].sel(record=record))
    scene = _scene(tree, motion, {"impulse": np.zeros(0), "centroid": np.zeros(0)})
    senses = acting(azimuth, facing) if body.side else (1,)
    return _worse(
        body, [row.respond(body if sense > 0 else body.mirrored(), scene, np.asarray(factors)) for sense in senses]
    )


def _of_half_waves(tree: xr.DataTree, record: str, model: str) -> Scene:
    """The half-waves of a record, which need no accelerogram."""
    summary = tree["summary"].to_dataset().sel(record=record)
    waves = ragged(tree, "half_wave_row_size", ["half_wave_centroid", "half_wave_impulse"], record)
    if waves is None:
        raise ResultsError(
            f"{record}: the file does not hold the half-waves, nor histories of {model}: assess again with "
            '[records] store = "half_waves" or "all"'
        )
    still = Record(np.zeros(int(summary["npts"])), dt=float(summary["dt"]), id=record)
    return _scene(tree, still, {name: waves[f"half_wave_{name}"].values for name in ("impulse", "centroid")})


def _scene(tree: xr.DataTree, record: Record, waves: dict[str, np.ndarray]) -> Scene:
    """What a model that follows a record takes of it."""
    others = dict.fromkeys(("start", "end", "peak", "lobes"), np.zeros(waves["impulse"].size))
    return Scene(
        record=record,
        vertical=None,
        waves=HalfWaves(**waves, **others, dt=record.dt, record_id=record.id),
        phase=IntensePhase(0.0, record.duration),
        sequence=None,
        gain=gain_of(tree),
    )


def _worse(body: Block, found: Sequence[Response]) -> Recomputed:
    """Of each factor the response with the larger peak, one that cannot say counting as the largest."""
    rank = [np.nan_to_num(one.peak_rotation_ratio, nan=np.finfo(float).max) for one in found]
    worse = np.argmax(rank, axis=0)

    def of(name: str) -> np.ndarray:
        return np.stack([getattr(one, name) for one in found])[worse, np.arange(worse.size)]

    return Recomputed(
        np.asarray(found[0].time),
        body.ratio(of("rotation")),
        of("peak_rotation_ratio"),
        of("outcome"),
        of("overturning_time"),
        of("impacts"),
    )


def _in_direction(summary: xr.Dataset, record: str, block: str, tree: xr.DataTree) -> bool:
    """Whether a record is what shakes a block, which may have a direction of its own."""
    own = float(summary["body_azimuth"].sel(block=block))
    turned = setting(tree, "records", "components", "horizontal") != "horizontal"
    apart = abs(math.remainder(own - float(summary["azimuth"].sel(record=record)), 180.0)) if np.isfinite(own) else 0.0
    return not turned or apart <= FACING_WITHIN
