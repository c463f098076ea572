"""The motion of a block under a record of the results, computed again from what the file holds of the record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rocking.block import Block
from rocking.impulsive import impulsive_response
from rocking.recorded import recorded_response
from rocking.response import Response
from rockpulse.assessment.places import floor_record
from rockpulse.assessment.senses import acting
from rockpulse.config.block_settings import floors_from_text
from rockpulse.errors import ResultsError
from rockpulse.motions.directions import FACING_WITHIN
from rockpulse.views.plots.motion import STORE, had_vertical, stored_record
from rockpulse.views.plots.selection import gain_of, ragged, setting

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["RECOMPUTED", "Recomputed", "recomputed"]

#: Models whose motion follows from the record itself.
RECOMPUTED = ("nonlinear", "linear", "impulsive")


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
    """Motions of a block, which is `body`, under a record times some factors, by one of :data:`RECOMPUTED`.

    A ResultsError where the file does not hold the ground motion that acts on the block.
    """
    summary = tree["summary"].to_dataset()
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
        return _worse(body, [_under_half_waves(tree, record, body, factors)])
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
    # What is stored of a body before a wall is the worse of those senses of the record that may act.
    facing = float(summary["facing"].sel(block=block)) if "facing" in summary else np.nan
    azimuth = float(summary["azimuth"].sel(record=record))
    found = [
        recorded_response(
            body if sense > 0 else body.mirrored(),
            motion.acceleration,
            motion.dt,
            "linear" if model == "linear" else "nonlinear",
            scale=np.asarray(factors),
            history=True,
        )
        for sense in (acting(azimuth, facing) if body.side else (1,))
    ]
    return _worse(body, found)


def _under_half_waves(tree: xr.DataTree, record: str, body: Block, factors: Sequence[float]) -> Response:
    summary = tree["summary"].to_dataset()
    waves = ragged(tree, "half_wave_row_size", ["half_wave_centroid", "half_wave_impulse"], record)
    if waves is None:
        raise ResultsError(
            f"{record}: the file does not hold the half-waves, nor histories of impulsive: assess again with "
            '[records] store = "half_waves" or "all"'
        )
    dt = float(summary["dt"].sel(record=record))
    return impulsive_response(
        body,
        waves["half_wave_centroid"].values,
        waves["half_wave_impulse"].values,
        duration=(int(summary["npts"].sel(record=record)) - 1) * dt,
        gain=gain_of(tree),
        scale=np.asarray(factors),
        history_dt=dt,
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
    own = float(summary["body_azimuth"].sel(block=block)) if "body_azimuth" in summary else np.nan
    turned = setting(tree, "records", "components", "horizontal") != "horizontal"
    apart = abs(math.remainder(own - float(summary["azimuth"].sel(record=record)), 180.0)) if np.isfinite(own) else 0.0
    return not turned or apart <= FACING_WITHIN
