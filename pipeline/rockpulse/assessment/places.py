"""Bodies in directions of their own and on floors: the motion that each of them feels, and all answers put together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rocking.body.supports import floor_motion
from rocking.response import Response
from rockpulse.assessment.scene import extract
from rockpulse.config.block_settings import FloorSettings
from rockpulse.config.bodies import Bodies, Place
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.model_row import Scene
from rockpulse.motions.directions import FACING_WITHIN
from rockpulse.record.components import Pair
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.record.rotation import rotate

#: The oscillations of a floor are followed until they are below so much of gravity: a thousandth of the uplift of a
#: body of slenderness 10.
QUIET = 1e-4


def places_of(bodies: Bodies, record: Record, pair: Pair | None, config: Config) -> list[tuple[Place, np.ndarray]]:
    """The different motions that bodies feel under a record, each with the numbers of its bodies.

    `pair` are the channels that the record was rotated from; with `components = "horizontal"` nothing is rotated. A
    RecordRefused where a body asks for a direction that a channel without a partner does not face.
    """
    if config.records.components == "horizontal":
        return bodies.places(None)
    azimuth = math.nan if record.azimuth is None else float(record.azimuth)
    found = bodies.places(azimuth, 1e-6 if pair is not None else FACING_WITHIN)
    others = [place for place, _ in found if place.azimuth is not None]
    if others and pair is None:
        raise RecordRefused(
            f"{record.id}: no other channel goes with it, and it faces {azimuth:g} degrees: it cannot be taken in the "
            f"direction {others[0].azimuth:g} of a body"
        )
    return found


def turned(scene: Scene, place: Place, pair: Pair | None, config: Config) -> Scene:
    """The scene in the direction of a place, from the channels that its record was rotated from."""
    if place.azimuth is None:
        return scene
    assert pair is not None
    return replace(extract(rotate(pair, place.azimuth), config), vertical=scene.vertical)


def aloft(scene: Scene, place: Place, config: Config) -> Scene:
    """The scene on the floor of a place: its motion, half-waves and sequence; the vertical is that of the ground."""
    if not place.floors:
        return scene
    record, found = scene.record, floor_record(scene.record, place.floors)
    there = extract(found, config)
    if scene.vertical is None:
        return there
    times = found.dt * np.arange(found.npts)
    lift = np.interp(times, record.dt * np.arange(scene.vertical.size), scene.vertical, right=0.0)
    return replace(there, vertical=lift)


def floor_record(record: Record, floors: Sequence[FloorSettings]) -> Record:
    """The motion of a floor under a conditioned record, by the modes of its building."""
    found = floor_motion(
        record.acceleration,
        record.dt,
        [one.period for one in floors],
        [one.damping for one in floors],
        [one.participation for one in floors],
        quiet=QUIET * STANDARD_GRAVITY,
    )
    return replace(record, acceleration=found.acceleration, dt=found.dt)


def joined_responses(
    parts: Sequence[Response], lanes: Sequence[np.ndarray], samples: int, steps: Sequence[int]
) -> Response:
    """Responses of some lanes each, at their places, as one; histories at the (n,) samples of the ground.

    `steps` are the samples of the motion of each part in one interval of the ground's; it may last longer.
    """
    whole = []
    for part, step in zip(parts, steps, strict=True):
        motion = {"rotation": part.rotation, "velocity": part.velocity}
        motion = {name: None if one is None else one[:, ::step][:, :samples] for name, one in motion.items()}
        whole.append(part.changed(time=None, **motion))
    return Response.join(whole, lanes, sum(places.size for places in lanes))
