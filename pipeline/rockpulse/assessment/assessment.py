"""From records and bodies to the tree of results."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from rocking.block import Block
from rocking.predictability import NOT_CHECKED, predictable
from rocking.response import Response
from rockpulse.assessment.directions import (
    Motion,
    PlannedMotion,
    motions_of,
    plan_motions,
    rotation_failures,
    swept_directions,
)
from rockpulse.assessment.events import event_table, events_by_id
from rockpulse.assessment.record_assessment import RecordAssessment
from rockpulse.assessment.record_columns import main_impulse, record_scalars
from rockpulse.assessment.scene import extract, prepare
from rockpulse.assessment.tree import build_tree
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.bodies import Bodies, gather_bodies
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError, TooWeak
from rockpulse.failures import Failure
from rockpulse.ladder import MODELS, USED, Scene, auto_response, critical_scales
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "Watch",
    "assess",
    "assess_planned",
    "assess_record",
    "assess_scene",
    "motion_failure",
    "unwatched",
]

logger = logging.getLogger("rockpulse")

Result = TypeVar("Result")

#: Measures the time of a step, by its name: ``with watch("solve"): ...``
Watch = Callable[[str], AbstractContextManager[None]]

PER_MODEL = ("peak_rotation_ratio", "outcome", "reason", "overturning_time", "overturning_half_cycle", "impacts")


def assess(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Mapping[str, Block] | Sequence[BlockSettings] | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
) -> xr.DataTree:
    """Assess bodies under records with every model of the configuration.

    Parameters
    ----------
    records : iterable of Record
        All channels, as :func:`rockpulse.read` returns them. Vertical channels are listed, not assessed, and so are
        structural ones unless asked for. Pairs of horizontal channels are rotated where ``[records] components`` asks
        for it.
    config : Config, optional
        Options; the defaults without.
    blocks : mapping of str to Block, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration.
    failures : iterable of Failure
        What reading has left out, to be stored with the results.
    progress : callable, optional
        Wraps the list of channels or pairs that are assessed on its way into the loop, as ``tqdm.tqdm`` does.

    Returns
    -------
    xarray.DataTree
        /summary, /half_cycles, /overturning_intervals, /failures, for a sweep over direction /directions and, unless
        switched off, /records;
        see docs/schema.md.

    Raises
    ------
    ConfigError
        Without a body, for two records of one id, or a table of events that does not fit. A record that cannot be
        assessed is a row of /failures instead.

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> record = rp.Record(3.0 * np.sin(2.0 * np.pi * t), dt=0.01, id="sine", processed=True)
    >>> tree = rp.assess([record], blocks={"pier": rp.models.Block(half_width=0.5, half_height=1.9365)})
    >>> tree["summary"].sizes["model"]
    5
    """
    config = config or Config()
    bodies = gather_bodies(config.blocks if blocks is None else blocks)
    for name, warning in zip(bodies.names, bodies.warnings, strict=True):
        if warning:
            logger.warning("block %s: %s", name, warning)
    every = list(records)
    twice = sorted(name for name, times in Counter(record.id for record in every).items() if times > 1)
    if twice:
        raise ConfigError(f"records: expected different ids, found more than one record with id {', '.join(twice)}")
    rows = list(failures)
    event_of, unread = events_by_id(every, event_table(config), rows)
    rows += unread
    planned, left_out = plan_motions(every, config)
    rows += left_out
    done = []
    for one in planned if progress is None else progress(planned):
        for outcome in assess_planned(one, bodies, config):
            if isinstance(outcome, Failure):
                rows.append(outcome)
            else:
                event = {"event": event_of[one.channels[0].id]}
                done.append(replace(outcome, record=outcome.record | event))
    return build_tree(done, bodies, config, rows, swept_directions(planned, config))


def unwatched(step: str) -> AbstractContextManager[None]:
    """The :data:`Watch` of those who do not want to know.

    Parameters
    ----------
    step : str
        Its name.
    """
    return nullcontext()


def assess_planned(
    planned: PlannedMotion, bodies: Bodies, config: Config, watch: Watch = unwatched
) -> Iterator[RecordAssessment | Failure]:
    """Assess all bodies under a channel, or under a pair of channels in every direction that is asked for.

    Parameters
    ----------
    planned : PlannedMotion
        With the samples of its channels.
    bodies : Bodies
        As in :func:`assess_record`.
    config : Config
        Options.
    watch : callable, optional
        Measures the steps "condition" and "solve".

    Yields
    ------
    RecordAssessment or Failure
        One for each motion, or the rows of a pair that cannot be rotated.
    """

    def assessed(motion: Motion) -> RecordAssessment:
        with watch("condition"):
            scene = (extract if motion.pair else prepare)(motion.record, config, motion.vertical)
        with watch("solve"):
            return assess_scene(scene, bodies)

    return each_motion(planned, config, "assess", assessed, watch)


def each_motion(
    planned: PlannedMotion, config: Config, stage: str, work: Callable[[Motion], Result], watch: Watch
) -> Iterator[Result | Failure]:
    """Do the same with every motion of a channel or pair.

    Parameters
    ----------
    planned : PlannedMotion
        With the samples of its channels.
    config : Config
        Options.
    stage : str
        What is done, as rows of failures name it.
    work : callable
        From a motion to its result; a ValueError that it raises becomes a row.
    watch : callable
        Measures the step "condition", of which the rotation of a pair is a part.

    Yields
    ------
    object or Failure
        One for each motion, or the rows of a pair that cannot be rotated.
    """
    try:
        with watch("condition"):
            motions = motions_of(planned, config)
    except ValueError as error:
        yield from rotation_failures(planned, error)
        return
    for motion in motions:
        try:
            result = work(motion)
        except ValueError as error:  # RockpulseError, and what a model says of numbers it cannot take
            yield motion_failure(motion.record, stage, error)
        else:
            yield result


def motion_failure(record: Record, stage: str, error: Exception) -> Failure:
    """The row for a motion that could not be dealt with.

    Parameters
    ----------
    record : Record
        The motion.
    stage : str
        As in :class:`rockpulse.failures.Failure`.
    error : Exception
        Why.
    """
    weak = isinstance(error, TooWeak)
    reason = str(error) if record.id in str(error) else f"{record.id}: {error}"
    logger.log(logging.WARNING if weak else logging.ERROR, "%s", reason)
    return Failure(file=record.source, stage=stage, reason=reason, kind="skipped" if weak else "failed")


def assess_record(record: Record, bodies: Bodies, config: Config, vertical: Record | None = None) -> RecordAssessment:
    """Assess all bodies under one record.

    Parameters
    ----------
    record : Record
        As read.
    bodies : Bodies
        The bodies, b of them with c restitution cases.
    config : Config
        Options.
    vertical : Record, optional
        The vertical channel that belongs to it, as read.

    Raises
    ------
    ValueError
        Where the record cannot be conditioned or has no intense phase, or a model refuses its numbers.
    """
    return assess_scene(prepare(record, config, vertical), bodies)


def assess_scene(scene: Scene, bodies: Bodies) -> RecordAssessment:
    """Assess all bodies under one record that was made ready.

    Parameters
    ----------
    scene : Scene
        The record and the options.
    bodies : Bodies
        As in :func:`assess_record`.

    Raises
    ------
    ValueError
        Where a model refuses its numbers.
    """
    lanes = bodies.lanes
    responses = {name: MODELS[name].respond(lanes, scene) for name in scene.models.use}
    used = {name: np.full(lanes.shape, USED.index(name), dtype=np.int8) for name in responses}
    if scene.models.auto:
        responses["auto"], used["auto"] = auto_response(lanes, scene)
    contact = responses["sequence"].ground_contact if "sequence" in responses else None
    if scene.sequence is not None and contact is not None and np.any(contact):
        warning = (
            f"sequence: with spacing {scene.sequence.spacing!r} and this I_s/I, {np.count_nonzero(contact)} of "
            f"{np.size(contact)} bodies touch the ground inside a half-cycle; take another spacing"
        )
        scene = replace(scene, record=scene.record.with_warning(warning))
    for model in responses:
        rule = MODELS[model].rule
        outside = 0 if rule is None else np.count_nonzero(~rule.applicable(lanes))
        if rule is not None and outside:
            warning = (
                f"{model}: {outside} of {np.size(lanes.p)} bodies lie outside the range that the rule was fitted on "
                f"({rule.range_text}): its rates of error do not hold for them"
            )
            scene = replace(scene, record=scene.record.with_warning(warning))
    scales = critical_scales(lanes, scene)
    per_lane = {
        **{field: {name: getattr(one, field) for name, one in responses.items()} for field in PER_MODEL},
        "safety_factor": {name: one.safety_factor for name, one in scales.items()},
        "safe_up_to": {name: one.safe_up_to for name, one in scales.items()},
        "search_step": {name: one.step for name, one in scales.items()},
        "interval_count": {name: np.where(np.isnan(one.safety_factor), -1, one.count) for name, one in scales.items()},
        "factor_resolved": {
            name: np.where(np.isnan(one.safety_factor), -1, one.factor_resolved) for name, one in scales.items()
        },
        "applicable": {name: MODELS[name].applicable(lanes).astype(np.int8) for name in responses},
        "predictable": {name: _predictable(name, lanes, scene, one) for name, one in responses.items()},
        "model_used": used,
    }
    return RecordAssessment(
        scene=scene,
        record=record_scalars(scene),
        per_block={name: bodies.per_case(values) for name, values in _demand(scene, lanes).items()},
        per_model={
            field: np.stack([bodies.per_case(values[name]) for name in responses], axis=-1)
            for field, values in per_lane.items()
        },
        responses=responses,
        scales=scales,
    )


def _predictable(model: str, block: Block, scene: Scene, response: Response) -> np.ndarray:
    settings = scene.models
    if not settings.predictability or not MODELS[model].checkable:
        return np.full(block.shape, NOT_CHECKED, dtype=np.int8)

    def respond(blocks: Block, scale: np.ndarray) -> Response:
        return MODELS[model].respond(blocks, scene, scale)

    # With output = "outcome" the peak of auto is that of whichever rung answered: no promise that could be broken.
    verdict_only = model == "auto" and settings.output == "outcome"
    return np.asarray(predictable(response, respond, block, tolerance=None if verdict_only else settings.tolerance))


def _demand(scene: Scene, block: Block) -> dict[str, np.ndarray]:
    capacity = block.gravity * np.tan(block.alpha_c)
    return {
        "uplift_ratio": scene.record.pga / capacity,
        "velocity_ratio": block.p * pgv(scene.record) / capacity,
        "impulse_ratio": main_impulse(scene) / block.critical_impulse,
    }
