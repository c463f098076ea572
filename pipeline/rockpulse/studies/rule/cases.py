"""The cases that the rule is fitted on and judged by: strong channels on blocks, with the nonlinear verdict.

.. note:: The protocol: channels whose conditioned peak is above 0.15 g; mean removed, no taper, pads of zeros,
   Butterworth of order 2 from 0.1 to 25 Hz, zero phase (no low-pass where the Nyquist frequency is no higher); 60 s
   from 25 s before the peak, then 8 s of zeros; PGA and PGV of that stretch; slenderness 4, 6, 8, 12 by R 1, 2, 4 m
   with Housner's restitution; factors 0.5 and 1. A case is one (record, factor, block).

   The verdict of the nonlinear model near overturning hangs on digits that no record has. So each case also has the
   verdicts of perturbed truths: record and restitution differ by a tenth of a per cent, case by case, and the ends of
   the record are treated in two other usual ways before the filter.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from scipy import signal

from rocking.block import Block
from rocking.half_wave_demand import demand_of_half_waves
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.calibration.rule import traits
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import RockpulseError
from rockpulse.failures import Failure
from rockpulse.motions.doubt import unconfirmed
from rockpulse.motions.events import group_events
from rockpulse.motions.votes import one_vote_each, unmatched_patterns
from rockpulse.record.components import select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.studies.accuracy.model_form import blocks

__all__ = [
    "PROCESSING",
    "SCALES",
    "TRUTH",
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

#: Factors on each record [-].
SCALES = (0.5, 1.0)

#: Perturbed truths: how many draws, and the standard deviation of the logarithms of record and restitution [-].
DRAWS, NOISE = 8, 1e-3

#: Prefix of the columns of perturbed truths.
TRUTH = "truth_"

logger = logging.getLogger("rockpulse")


@dataclass(frozen=True, eq=False)
class StrongMotion:
    """A channel made ready."""

    record: Record  # the stretch that is judged, zeros included
    event: str  # label of its earthquake
    # the same stretch after another treatment of the ends of the record, by name
    otherwise: dict[str, Record] = field(default_factory=dict)


def strong_motions(
    records: Iterable[Record], confirm: Sequence[str] = (), failures: Iterable[Failure] = ()
) -> tuple[list[StrongMotion], list[Failure]]:
    """The strong horizontal ground channels among records as read, one of each shaking, in the order given.

    With them come rows for the channels that are no horizontal ground motion, that another record of the same shaking
    stands for, that cannot be conditioned, or whose peak lies above 5 g and is not confirmed by a pattern of its id.
    Weak ones are not named. A pattern that fits no id is an error, or a row where `failures` tell of files that could
    not be read.
    """
    every = list(records)
    idle = unmatched_patterns("--confirm", confirm, [record.id for record in every], failures)
    voting, outvoted = one_vote_each(every, RecordSettings(confirm=tuple(confirm)), advice="")
    horizontal, left_out = select_horizontal(voting, configured=False)
    rows = [*idle, *outvoted, *left_out]
    found = []
    for record in horizontal:
        try:
            conditioned, tapered = (_filtered(record, taper) for taper in (0.0, None))
            others = {"tapered": _stretch(tapered), "reflected": _stretch(_reflected(record))}
        except (RockpulseError, ValueError) as error:  # scipy refuses records shorter than its pads
            logger.error("%s: %s", record.id, error)
            rows.append(Failure(file=record.source, stage="rule", reason=str(error), kind="failed"))
            continue
        if doubt := unconfirmed(conditioned, confirm, configured=False):
            logger.error("%s", doubt)
            rows.append(Failure(file=record.source, stage="rule", reason=doubt, kind="failed"))
        elif conditioned.pga > STRONG:
            found.append((record, _stretch(conditioned), others))
    events = group_events([record for record, _, _ in found])
    return [
        StrongMotion(stretch, event, others) for (_, stretch, others), event in zip(found, events, strict=True)
    ], rows


def _corners(record: Record) -> tuple[float, float | None]:
    low, high = BAND
    return low, high if high < 0.5 / record.dt * (1.0 - 1e-9) else None


def _filtered(record: Record, taper: float | None) -> Record:
    low, high = _corners(record)
    return condition(record, baseline="mean", highpass_hz=low, lowpass_hz=high, order=ORDER, taper_s=taper)


def _reflected(record: Record) -> Record:
    """The filter with the pads that scipy makes by default: the ends of the record, turned about their last samples."""
    low, high = _corners(record)
    sections = [signal.butter(ORDER, low, "highpass", fs=1.0 / record.dt, output="sos")]
    if high is not None:
        sections.append(signal.butter(ORDER, high, "lowpass", fs=1.0 / record.dt, output="sos"))
    centred = record.acceleration - np.mean(record.acceleration)
    return replace(record, acceleration=signal.sosfiltfilt(np.concatenate(sections), centred))


def _stretch(record: Record) -> Record:
    acceleration, dt = record.acceleration, record.dt
    first = max(0, int(np.argmax(np.abs(acceleration))) - round(BEFORE / dt))
    kept = acceleration[first : first + round(LENGTH / dt) + 1]
    return replace(record, acceleration=np.concatenate([kept, np.zeros(round(QUIET / dt))]))


def motion_cases(motion: StrongMotion, scales: Sequence[float] = SCALES, threads: int | None = None) -> pd.DataFrame:
    """The cases of one motion under some factors [-], one row a case.

    Columns: record, event, source (the file of the record), slenderness, radius [m], scale, the measures `march`,
    `build_up`, `uplift_ratio` and `velocity_ratio` = p PGV/(g tan alpha) of the scaled motion [-], `overturns`, and
    `peak`, theta_max/alpha_c of the nonlinear model. Cases that it cannot resolve are left out. Columns that begin with
    :data:`TRUTH` are the verdicts of perturbed truths. Raises ValueError where a model refuses the numbers of the
    record.
    """
    bodies, record = blocks(), motion.record
    waves = half_waves(record)
    asked = demand_of_half_waves(bodies, waves.start, waves.centroid, waves.end, waves.impulse, waves.dt, threads)
    capacity = bodies.gravity * np.tan(bodies.alpha_c)
    truth = recorded_response(bodies, record.acceleration, record.dt, scale=np.array(scales), threads=threads)
    perturbed = _perturbed_truths(bodies, motion, scales, threads)
    frames = [
        pd.DataFrame(
            {
                "record": record.id,
                "event": motion.event,
                "source": record.source,
                "slenderness": bodies.slenderness,
                "radius": bodies.radius,
                "scale": scale,
                "march": scale * asked.march,
                "build_up": scale * asked.build_up,
                "uplift_ratio": scale * record.pga / capacity,
                "velocity_ratio": scale * bodies.p * pgv(record) / capacity,
                "overturns": truth.outcome[row] == Outcome.OVERTURNS,
                "peak": truth.peak_rotation_ratio[row],
                **{f"{TRUTH}{name}": verdicts[row] for name, verdicts in perturbed.items()},
            }
        )[truth.outcome[row] != Outcome.UNRESOLVED]
        for row, scale in enumerate(scales)
    ]
    return pd.concat(frames, ignore_index=True)


def fitted_range() -> dict[str, tuple[float, float]]:
    """The range of the rules that are fitted here: least and most of each trait over the bodies."""
    return {name: (float(values.min()), float(values.max())) for name, values in traits(blocks()).items()}


def _perturbed_truths(
    bodies: Block, motion: StrongMotion, scales: Sequence[float], threads: int | None
) -> dict[str, np.ndarray]:
    """True for the cases (q, m) that overturn, by the name of the perturbation; seeded by the id of the record."""
    random = np.random.default_rng(np.random.SeedSequence([*motion.record.id.encode()]))
    truths: dict[str, np.ndarray] = {}
    for draw in range(DRAWS):
        record, restitution = np.exp(NOISE * random.standard_normal((2, *bodies.shape)))
        # Downwards only: Housner's restitution is a bound.
        changed = replace(bodies, restitution=bodies.restitution * np.minimum(restitution, 1.0 / restitution))
        truths[f"{draw}"] = _overturns(changed, motion.record, scales, record, threads)
    for name, other in motion.otherwise.items():
        truths[name] = _overturns(bodies, other, scales, np.ones(bodies.shape), threads)
    return truths


def _overturns(
    bodies: Block, record: Record, scales: Sequence[float], own: np.ndarray, threads: int | None
) -> np.ndarray:
    response = recorded_response(
        bodies, record.acceleration, record.dt, scale=np.array(scales), block_scale=own, threads=threads
    )
    return response.outcome == Outcome.OVERTURNS


def rule_cases(
    motions: Sequence[StrongMotion],
    scales: Sequence[float] = SCALES,
    progress: Callable[[Sequence[StrongMotion]], Iterable[StrongMotion]] | None = None,
) -> tuple[pd.DataFrame, list[Failure]]:
    """The cases of several motions, as :func:`motion_cases` gives them, one below the other; empty without motions.

    The failures are motions whose numbers a model refuses. `progress` wraps the list of motions, as ``tqdm.tqdm`` does.
    """
    frames, failures = [], []
    for motion in motions if progress is None else progress(motions):
        try:
            frames.append(motion_cases(motion, scales))
        except ValueError as error:
            reason = f"{motion.record.id}: {error}"
            logger.error("%s", reason)
            failures.append(Failure(file=motion.record.source, stage="rule", reason=reason, kind="failed"))
    empty = pd.DataFrame({"record": [], "event": [], "source": [], "overturns": []})
    return (pd.concat(frames, ignore_index=True) if frames else empty), failures
