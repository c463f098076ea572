"""The cases that the rule is fitted on and judged by: strong channels on blocks, with their nonlinear capacity.

.. note:: The protocol: channels whose conditioned peak is above 0.15 g; mean removed, no taper, pads of zeros,
   Butterworth of order 2 from 0.1 to 25 Hz, zero phase (no low-pass where the Nyquist frequency is no higher); 60 s
   from 25 s before the peak, then 8 s of zeros; PGA and PGV of that stretch; slenderness 4, 6, 8, 12 by R 1, 2, 4 m
   with Housner's restitution. A case is one (record, block), with the capacity of the nonlinear equation under the
   default uncertainty (:mod:`rockpulse.studies.rule.truth`), and its verdicts at factors 0.5 and 1 without any.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from rocking.half_wave_demand import demand_of_half_waves
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.calibration.rule import traits
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure, RockpulseError, some
from rockpulse.motions.doubt import unconfirmed
from rockpulse.motions.events import group_events
from rockpulse.motions.votes import one_vote_each, unmatched_patterns
from rockpulse.record.components import select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.studies.accuracy.model_form import blocks
from rockpulse.studies.rule.measures import other_measures
from rockpulse.studies.rule.truth import nonlinear_capacity

__all__ = [
    "PROCESSING",
    "SCALES",
    "StrongMotion",
    "fitted_range",
    "motion_cases",
    "rule_cases",
    "strong_motions",
]

#: Weaker channels are left out [m/s2].
STRONG = 0.15 * STANDARD_GRAVITY

#: Corners of the band-pass [Hz] and the order of one pass.
BAND, ORDER = (0.1, 25.0), 2

#: The stretch that is judged: before the peak, in all, and the zeros after it [s].
BEFORE, LENGTH, QUIET = 25.0, 60.0, 8.0

#: The protocol in words, for the provenance of a fitted rule.
PROCESSING = (
    "mean removed, no taper, pads of zeros, Butterworth order 2, 0.1-25 Hz, zero phase; 60 s from 25 s before the "
    "peak, then 8 s of zeros; PGA and PGV of that stretch"
)

#: Factors on each record at which verdicts are compared [-], by name.
SCALES = {"half": 0.5, "one": 1.0}

#: Two channels show one shaking where their waveforms about the peak correlate by this much [-]: the same record by way
#: of two agencies, with its samples rounded, resampled or turned round. Different ones of the sets at hand: below 0.52.
SAME_WAVEFORM = 0.95

#: The stretch that is compared, from the peak [s], and the interval [s].
COMPARED, COMPARED_DT = (-5.0, 15.0), 0.01

logger = logging.getLogger("rockpulse")


@dataclass(frozen=True, eq=False)
class StrongMotion:
    """A channel made ready."""

    record: Record  # the stretch that is judged, zeros included
    event: str  # label of its earthquake


def strong_motions(
    records: Iterable[Record],
    confirm: Sequence[str] = (),
    failures: Iterable[Failure] = (),
    titles: Mapping[str, str] | None = None,
) -> tuple[list[StrongMotion], list[Failure]]:
    """The strong horizontal ground channels among records as read, one of each shaking, in the order given.

    With them come rows for the channels that are no horizontal ground motion, that another record of the same shaking
    stands for, by its station or by its waveform, that cannot be conditioned, or whose peak lies above 5 g and is not
    confirmed by a pattern of its id. Weak ones are not named. A pattern that fits no id is an error, or a row where
    `failures` tell of files that could not be read.

    `titles` name the earthquake by record id in place of what the file says, such as "Kobe 1995-01-16": records are
    then grouped by name and year as by :func:`rockpulse.motions.events.group_events`. An id that no record has is a
    ConfigError.
    """
    titles = titles or {}
    every = [replace(record, event=titles.get(record.id, record.event)) for record in records]
    if unknown := sorted(set(titles) - {record.id for record in every}):
        raise ConfigError(f"--events: no record has the id {some(unknown, 5)}")
    idle = unmatched_patterns("--confirm", confirm, [record.id for record in every], failures)
    voting, outvoted = one_vote_each(every, RecordSettings(confirm=tuple(confirm)), advice="")
    horizontal, left_out = select_horizontal(voting, configured=False)
    rows = [*idle, *outvoted, *left_out]
    found: list[tuple[Record, Record]] = []
    waveforms: list[np.ndarray] = []
    for record in horizontal:
        try:
            conditioned = _filtered(record)
        except (RockpulseError, ValueError) as error:  # scipy refuses records shorter than its pads
            logger.error("%s: %s", record.id, error)
            rows.append(Failure(file=record.source, stage="rule", reason=str(error), kind="failed"))
            continue
        if doubt := unconfirmed(conditioned, confirm, configured=False):
            logger.error("%s", doubt)
            rows.append(Failure(file=record.source, stage="rule", reason=doubt, kind="failed"))
        elif conditioned.pga > STRONG:
            waveform = _waveform(conditioned)
            alike = np.flatnonzero([abs(waveform @ other) > SAME_WAVEFORM for other in waveforms])
            if alike.size:
                reason = f"{record.id}: the same waveform as {found[alike[0]][0].id}"
                rows.append(Failure(file=record.source, stage="rule", reason=reason, kind="duplicate"))
                continue
            waveforms.append(waveform)
            found.append((record, _stretch(conditioned)))
    events = group_events([record for record, _ in found])
    return [StrongMotion(stretch, event) for (_, stretch), event in zip(found, events, strict=True)], rows


def _filtered(record: Record) -> Record:
    low, high = BAND
    below = high if high < 0.5 / record.dt * (1.0 - 1e-9) else None
    return condition(record, baseline="mean", highpass_hz=low, lowpass_hz=below, order=ORDER, taper_s=0.0)


def _waveform(record: Record) -> np.ndarray:
    """The acceleration about its peak, of length 1."""
    acceleration = record.acceleration
    time = (np.arange(acceleration.size) - int(np.argmax(np.abs(acceleration)))) * record.dt
    around = np.interp(np.arange(*COMPARED, COMPARED_DT), time, acceleration, left=0.0, right=0.0)
    return np.asarray(around / np.linalg.norm(around))


def _stretch(record: Record) -> Record:
    acceleration, dt = record.acceleration, record.dt
    first = max(0, int(np.argmax(np.abs(acceleration))) - round(BEFORE / dt))
    kept = acceleration[first : first + round(LENGTH / dt) + 1]
    return replace(record, acceleration=np.concatenate([kept, np.zeros(round(QUIET / dt))]))


def motion_cases(motion: StrongMotion, threads: int | None = None) -> pd.DataFrame:
    """The cases of one motion, one row a body.

    Columns: record, event, source (the file of the record), slenderness, radius [m]; the demands [-] of
    :data:`rockpulse.studies.rule.measures.MEASURES`; the capacities of
    :func:`~rockpulse.studies.rule.truth.nonlinear_capacity`; `overturns_half` and `overturns_one`, the nonlinear
    verdicts at the factors :data:`SCALES`. Raises ValueError where a model refuses the numbers of the record.
    """
    bodies, record = blocks(), motion.record
    waves = half_waves(record)
    asked = demand_of_half_waves(bodies, waves.start, waves.centroid, waves.end, waves.impulse, threads)
    verdict = recorded_response(
        bodies, record.acceleration, record.dt, scale=np.array(list(SCALES.values())), threads=threads
    ).outcome
    return pd.DataFrame(
        {
            "record": record.id,
            "event": motion.event,
            "source": record.source,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            "march": asked.march,
            "march_10": asked.march_10,
            **other_measures(bodies, record, waves, threads),
            **nonlinear_capacity(bodies, record.acceleration, record.dt, threads=threads),
            **{
                f"overturns_{name}": (row == Outcome.OVERTURNS) | (row == Outcome.UNRESOLVED)
                for name, row in zip(SCALES, np.asarray(verdict), strict=True)
            },
        }
    )


def fitted_range() -> dict[str, tuple[float, float]]:
    """The range of the rules that are fitted here: least and most of each trait over the bodies."""
    return {name: (float(values.min()), float(values.max())) for name, values in traits(blocks()).items()}


def rule_cases(
    motions: Sequence[StrongMotion],
    progress: Callable[[Sequence[StrongMotion]], Iterable[StrongMotion]] | None = None,
) -> tuple[pd.DataFrame, list[Failure]]:
    """The cases of several motions, as :func:`motion_cases` gives them, one below the other; empty without motions.

    The failures are motions whose numbers a model refuses. `progress` wraps the list of motions, as ``tqdm.tqdm`` does.
    """
    frames, failures = [], []
    for motion in motions if progress is None else progress(motions):
        try:
            frames.append(motion_cases(motion))
        except ValueError as error:
            reason = f"{motion.record.id}: {error}"
            logger.error("%s", reason)
            failures.append(Failure(file=motion.record.source, stage="rule", reason=reason, kind="failed"))
    empty = pd.DataFrame({"record": [], "event": [], "source": []})
    return (pd.concat(frames, ignore_index=True) if frames else empty), failures
