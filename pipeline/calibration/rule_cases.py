"""The cases that the rule is fitted on and judged by: strong channels on blocks, with the nonlinear verdict.

.. note:: The protocol: channels whose conditioned peak is above 0.15 g; mean removed, Butterworth of order 2 from 0.1
   to 25 Hz, zero phase (no low-pass where the Nyquist frequency is no higher); 60 s from 25 s before the peak, then 8 s
   of zeros; slenderness 4, 6, 8, 12 by R 1, 2, 4 m with Housner's restitution; factors 0.5 and 1. A case is one
   (record, factor, block).
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from rockpulse.components import select_horizontal
from rockpulse.conditioning import condition
from rockpulse.errors import RockpulseError
from rockpulse.events import group_events
from rockpulse.failures import Failure
from rockpulse.half_wave import half_waves
from rockpulse.intensity import pgv
from rockpulse.model_form import blocks
from rockpulse.models.half_wave_demand import demand_of_half_waves
from rockpulse.models.recorded import recorded_response
from rockpulse.models.response import Outcome
from rockpulse.record import STANDARD_GRAVITY, Record

__all__ = ["SCALES", "StrongMotion", "motion_cases", "rule_cases", "strong_motions"]

#: Weaker channels are left out [m/s2].
STRONG = 0.15 * STANDARD_GRAVITY

#: Corners of the band-pass [Hz].
BAND = (0.1, 25.0)

#: The stretch that is judged: before the peak, in all, and the zeros after it [s].
BEFORE, LENGTH, QUIET = 25.0, 60.0, 8.0

#: Factors on each record [-].
SCALES = (0.5, 1.0)

logger = logging.getLogger("rockpulse")


@dataclass(frozen=True, eq=False)
class StrongMotion:
    """A channel made ready.

    Attributes
    ----------
    record : Record
        The stretch that is judged, zeros included.
    pgv : float
        Of the whole conditioned record [m/s].
    event : str
        Label of its earthquake.
    """

    record: Record
    pgv: float
    event: str


def strong_motions(records: Iterable[Record]) -> tuple[list[StrongMotion], list[Failure]]:
    """The strong horizontal ground channels among records.

    Parameters
    ----------
    records : iterable of Record
        As read, duplicates dropped (:func:`rockpulse.read_all`).

    Returns
    -------
    motions : list of StrongMotion
        In the order given.
    failures : list of Failure
        Channels that are no horizontal ground motion or cannot be conditioned. Weak ones are not named.
    """
    horizontal, failures = select_horizontal(records)
    found = []
    for record in horizontal:
        low, high = BAND
        try:
            conditioned = condition(
                record,
                baseline="mean",
                highpass_hz=low,
                lowpass_hz=high if high < 0.5 / record.dt * (1.0 - 1e-9) else None,
                order=2,
            )
        except RockpulseError as error:
            logger.error("%s: %s", record.id, error)
            failures.append(Failure(file=record.source, stage="rule", reason=str(error), kind="failed"))
            continue
        if conditioned.pga > STRONG:
            found.append((record, conditioned))
    events = group_events([record for record, _ in found])
    return [
        StrongMotion(_stretch(conditioned), pgv(conditioned), event)
        for (_, conditioned), event in zip(found, events, strict=True)
    ], failures


def _stretch(record: Record) -> Record:
    acceleration, dt = record.acceleration, record.dt
    first = max(0, int(np.argmax(np.abs(acceleration))) - round(BEFORE / dt))
    kept = acceleration[first : first + round(LENGTH / dt) + 1]
    return replace(record, acceleration=np.concatenate([kept, np.zeros(round(QUIET / dt))]))


def motion_cases(motion: StrongMotion, scales: Sequence[float] = SCALES, threads: int | None = None) -> pd.DataFrame:
    """The cases of one motion.

    Parameters
    ----------
    motion : StrongMotion
        The channel.
    scales : sequence of float
        Factors on it [-].
    threads : int, optional
        Threads that share the lanes; None for all available cores.

    Returns
    -------
    DataFrame
        One row a case: record, event, slenderness, radius [m], scale, the measures `march`, `build_up`, `uplift_ratio`
        and `velocity_ratio` = p PGV/(g tan alpha) of the scaled motion [-], `overturns`, and `peak`, theta_max/alpha_c
        of the nonlinear model. Cases that it cannot resolve are left out.
    """
    bodies, record = blocks(), motion.record
    waves = half_waves(record)
    asked = demand_of_half_waves(bodies, waves.start, waves.centroid, waves.end, waves.impulse, waves.dt, threads)
    capacity = bodies.gravity * np.tan(bodies.alpha_c)
    truth = recorded_response(bodies, record.acceleration, record.dt, scale=np.array(scales), threads=threads)
    frames = [
        pd.DataFrame(
            {
                "record": record.id,
                "event": motion.event,
                "slenderness": bodies.slenderness,
                "radius": bodies.radius,
                "scale": scale,
                "march": scale * asked.march,
                "build_up": scale * asked.build_up,
                "uplift_ratio": scale * record.pga / capacity,
                "velocity_ratio": scale * bodies.p * motion.pgv / capacity,
                "overturns": truth.outcome[row] == Outcome.OVERTURNS,
                "peak": truth.peak_rotation_ratio[row],
            }
        )[truth.outcome[row] != Outcome.UNRESOLVED]
        for row, scale in enumerate(scales)
    ]
    return pd.concat(frames, ignore_index=True)


def rule_cases(
    motions: Sequence[StrongMotion],
    scales: Sequence[float] = SCALES,
    progress: Callable[[Sequence[StrongMotion]], Iterable[StrongMotion]] | None = None,
) -> pd.DataFrame:
    """The cases of several motions, one below the other.

    Parameters
    ----------
    motions : sequence of StrongMotion
        The channels.
    scales : sequence of float
        Factors on them [-].
    progress : callable, optional
        Wraps the list of motions on its way into the loop, as ``tqdm.tqdm`` does.

    Returns
    -------
    DataFrame
        As :func:`motion_cases`; empty without motions.
    """
    frames = [motion_cases(motion, scales) for motion in (motions if progress is None else progress(motions))]
    return (
        pd.concat(frames, ignore_index=True) if frames else pd.DataFrame({"record": [], "event": [], "overturns": []})
    )
