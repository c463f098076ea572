"""From records, or the design sequence of a site, and bodies to the tree of results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.march.recorded import sliding_demand
from rocking.search.capacity import uplift_scale
from rocking.search.factors import ScaleIntervals
from rockpulse.assessment.probability import record_probability
from rockpulse.assessment.record_assessment import RecordAssessment
from rockpulse.assessment.results import registered
from rockpulse.assessment.scene import (
    aloft,
    extract,
    joined_responses,
    matched,
    places_of,
    senses,
    solver_options,
    turned,
)
from rockpulse.assessment.tree import EVENT, build_tree, dimension_of, nothing, record_part, template
from rockpulse.config.bodies import Bodies, Place, gather_bodies, refuse_aloft
from rockpulse.config.configuration import Config, given_config
from rockpulse.errors import ConfigError, Failure
from rockpulse.model_row import Scene
from rockpulse.model_table import MODELS, SEQUENCE_MODELS
from rockpulse.record.components import Pair
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.measures import STORED_OF_BODIES, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.remark import Remark
from rockpulse.run.analysis import Analysis, Blocks, Part, Watch, Work, run
from rockpulse.selection.directions import Motion, PlannedMotion, swept_directions
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.hdf5.atomic import ASSESSMENT

if TYPE_CHECKING:
    import xarray as xr

#: The motion of a body on the ground without a direction of its own.
RECORD_ITSELF = Place(None, ())


def assess(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Blocks | None = None,
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
    blocks : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration; full sizes in m.
    failures : iterable of Failure
        Files and channels that reading has left out, to be stored with the results.
    progress : callable, optional
        Wraps the list of channels or pairs that are assessed on its way into the loop, as ``tqdm.tqdm`` does.

    Returns
    -------
    xarray.DataTree
        /summary, /half_cycles, /overturning_intervals, /failures, for a sweep over direction /directions and, unless
        switched off, /records; see docs/schema.md. ``tree.rockpulse`` is :class:`Results`, with the verdicts.

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
    >>> tree = rp.assess([record], blocks={"pier": (1.0, 3.873)})
    >>> tree["summary"]["model"].values.tolist()
    ['sequence', 'nonlinear']
    """
    return registered(run(Assessment(given_config(config), blocks), records, failures, progress))


class Assessment(Analysis):
    """The answer of every model for every body under every motion."""

    name = "assess"
    doing = "assessing"
    kind = ASSESSMENT
    in_order_of_ids = False
    event_name = EVENT

    def __init__(self, config: Config, blocks: Blocks | None = None) -> None:
        super().__init__(config)
        self.bodies: Bodies = gather_bodies(config.blocks if blocks is None else blocks, config.records)

    @property
    def work(self) -> Work:
        """Assess all bodies."""
        return partial(assess_motion, bodies=self.bodies, config=self.config)

    @cached_property
    def nothing(self) -> Part:
        """Every variable that grows with the motions, without a row."""
        return nothing(self.bodies, self.config)

    def dimension_of(self, name: str) -> str:
        """The first dimension of a variable, given by its path."""
        return dimension_of(name)

    @property
    def template(self) -> xr.DataTree:
        """The tree of results without a motion."""
        return template(self.bodies, self.config)

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """The parts one after the other, and for a sweep the statistics over direction."""
        return build_tree(parts, self.bodies, self.config, failures, swept_directions(planned, self.config))


def assess_motion(motion: Motion, watch: Watch, bodies: Bodies, config: Config) -> Part:
    """Assess all bodies under one motion; a ValueError says that it has no intense phase, or a model refuses it."""
    with watch("condition"):
        scene = extract(motion.record, config, motion.vertical)
    with watch("solve"):
        pair = Pair(*motion.channels) if len(motion.channels) == 2 else None
        assessment = assess_scene(matched(scene, config), bodies, config, motion.pair, pair)
    with watch("pack"):
        return record_part(assessment)


def assess_scene(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record] = (), pair: Pair | None = None
) -> RecordAssessment:
    """Assess all bodies under one record that was made ready; a ValueError says that a model refuses its numbers.

    `channels` are the conditioned ones whose strengths are brought to the demands, as for :func:`record_probability`.
    Bodies on a floor are assessed under its motion, those with a direction of their own in that of the `pair` that the
    record was rotated from.
    """
    places = places_of(bodies, scene.record, pair, config)
    if len(places) == 1 and places[0][0] == RECORD_ITSELF:
        return _assess_at(scene, bodies, config, channels, 1.0)
    parts, record = [], scene.record
    for place, numbers in places:
        below = turned(scene, place, pair, config)
        there = aloft(below, place, config)
        stronger = there.record.pga / below.record.pga
        there = there if there is scene else matched(there, config)
        parts.append(_assess_at(there, bodies.chosen(numbers), config, channels or [record], stronger))
    for part in parts:
        for remark in part.record.warnings:
            record = record if remark in record.warnings else record.with_warning(remark)
    steps = [round(record.dt / part.record.dt) for part in parts]
    lanes = [(one[1][:, np.newaxis] * bodies.cases + np.arange(bodies.cases)).reshape(-1) for one in places]

    def at_lanes(tables: Sequence[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
        found = {}
        for name, first in tables[0].items():
            found[name] = np.empty((bodies.lanes.shape[0], *first.shape[1:]), dtype=first.dtype)
            for own, table in zip(lanes, tables, strict=True):
                found[name][own] = table[name]
        return found

    on_ground = parts[0] if places[0][0] == RECORD_ITSELF else None
    return RecordAssessment(
        scene=replace(scene, record=record),
        bodies=bodies,
        config=config,
        responses={
            name: joined_responses([part.responses[name] for part in parts], lanes, record.npts, steps)
            for name in parts[0].responses
        },
        scales={
            name: ScaleIntervals.join([part.scales[name] for part in parts], lanes, bodies.lanes.shape[0])
            for name in parts[0].scales
        },
        applicable=at_lanes([part.applicable for part in parts]),
        probability=at_lanes([part.probability for part in parts]),
        strength=at_lanes([part.strength for part in parts]),
        spectrum=None if on_ground is None else on_ground.spectrum,
    )


def _assess_at(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record], stronger: float
) -> RecordAssessment:
    """Assess bodies that stand on the same ground or floor, whose peak is `stronger` than that of the ground."""
    lanes = bodies.lanes
    sides = senses(bodies, scene.record)
    responses = {name: sides.worse(MODELS[name].response(sides.block, scene)) for name in config.models.use}
    for model, response in responses.items():
        contact = response.ground_contact if MODELS[model].paired else None
        if scene.sequence is not None and contact is not None and np.any(contact):
            warning = (
                f"{model}: with spacing {scene.sequence.spacing!r} and this I_s/I, {np.count_nonzero(contact)} of "
                f"{np.size(contact)} bodies touch the ground inside a half-cycle; take another spacing"
            )
            scene = replace(scene, record=scene.record.with_warning(warning))
    for model in responses:
        # In the column of the sequence a mark says it, record by record and body by body.
        rule = MODELS[model].rule(scene) if MODELS[model].fitted else None
        outside = 0 if rule is None else np.count_nonzero(~rule.applicable(lanes))
        if rule is not None and outside:
            warning = (
                f"{model}: {outside} of {np.size(lanes.p)} bodies lie outside the range that the rule was fitted on "
                f"({rule.range_text}): its rates of error do not hold for them"
            )
            scene = replace(scene, record=scene.record.with_warning(warning))
    overturning = record_probability(scene, bodies, config, channels)
    return RecordAssessment(
        scene=scene,
        bodies=bodies,
        config=config,
        responses=responses,
        scales={name: sides.smaller(_intervals(name, sides.block, scene, config)) for name in responses},
        applicable={name: MODELS[name].applicable(lanes, scene).astype(np.int8) for name in responses},
        probability=overturning.values,
        strength=_strength(scene, bodies, stronger),
        spectrum=overturning.spectrum,
    )


def _intervals(model: str, block: Block, scene: Scene, config: Config) -> ScaleIntervals:
    """The factors at which bodies overturn by a model; NaN where they are not asked for."""
    if not config.search.asks_for(model):
        return ScaleIntervals.unknown(block.shape)
    return MODELS[model].intervals(block, scene)


def _strength(scene: Scene, bodies: Bodies, stronger: float) -> dict[str, np.ndarray]:
    """The strength of the motion that bodies feel, over theirs; and the friction that it asks for."""
    lanes, record = bodies.lanes.weaker, scene.record
    on = RecordOnBodies(record, lambda: scene.waves, lanes, uplift_scale(bodies.lanes, np.array([-1.0, 1.0])))
    found = {measure.name: np.asarray(measure.value(on)) for measure in STORED_OF_BODIES}
    main = np.nan if scene.sequence is None or scene.sequence.shape else float(scene.sequence.main)
    found["impulse_ratio"] = np.asarray(main / lanes.critical_impulse)
    found["floor_amplification"] = np.full(lanes.shape, stronger)
    friction = np.repeat(bodies.friction, bodies.cases)
    asked = np.flatnonzero(~np.isnan(friction))
    for name in ("friction_required", "friction_share"):
        found[name] = np.full(lanes.shape, np.nan)
    if asked.size:
        demand = sliding_demand(
            bodies.lanes.take(asked), record.acceleration, record.dt, friction[asked], scene.vertical
        )
        found["friction_required"][asked], found["friction_share"][asked] = demand.required, demand.share
    return found


#: The name of a design sequence in place of the id of a record, unless it is given another.
NAME = "design sequence"


def assess_sequence(
    sequence: ImpulseSequence | DesignSpectrum,
    config: Config | None = None,
    blocks: Blocks | None = None,
    name: str = NAME,
    source: str = "",
) -> xr.DataTree:
    """Assess bodies under the design of a site: one sequence of impulses for all of them, or one for each.

    Parameters
    ----------
    sequence : ImpulseSequence or DesignSpectrum
        One sequence, or a design spectrum, as :func:`rockpulse.load_design` reads them.
    config : Config, optional
        Sections site, models, search and the bodies are used; a [[demand]] is one on the PGA, which a sequence has not.
    blocks : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration; full sizes in m.
    name : str
        Id of the row that stands where a record would.
    source : str
        File that the sequence comes from.

    Returns
    -------
    xarray.DataTree
        As :func:`rockpulse.assess` returns it, with one row whose columns of a record are empty. The models that need a
        record (impulsive, linear, nonlinear) are left out, and a warning of the row says so; under a design
        spectrum resonance too, and the columns of the sequence are empty: every body has its own.

    Raises
    ------
    ConfigError
        Without a body, for several sequences or one that ends by no limit, for bodies outside the design spectrum, or
        where ``[models] use`` names no model that the design can be given to.

    Examples
    --------
    >>> import rockpulse as rp
    >>> sequence = rp.models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    >>> tree = rp.assess_sequence(sequence, blocks={"pier": (1.0, 3.873)})
    >>> tree["summary"]["model"].values.tolist()
    ['sequence']
    """
    asked_for = given_config(config)
    bodies = gather_bodies(asked_for.blocks if blocks is None else blocks)
    refuse_aloft(bodies, "a design sequence is one of the ground")
    answering: tuple[str, ...] = SEQUENCE_MODELS
    what = "a sequence"
    if isinstance(sequence, DesignSpectrum):
        what, answering = "a design spectrum", tuple(name for name in SEQUENCE_MODELS if MODELS[name].paired)
        inside = np.all(bodies.per_case(sequence.covers(bodies.lanes)), axis=1)
        outside = [body for body, covered in zip(bodies.names, inside.tolist(), strict=True) if not covered]
        try:
            sequence = sequence.sequence(bodies.lanes)
        except ValueError as error:
            told = f"[[block]] {', '.join(outside)}: leave out of the assessment under this design. " if outside else ""
            raise ConfigError(f"{told}{error}") from None
    elif sequence.shape:
        raise ConfigError(f"sequence: expected one sequence, found {sequence.shape[0]}")
    asked = asked_for.models.use
    use = tuple(model for model in asked if model in answering)
    if not use:
        raise ConfigError(
            f"[models] use: {', '.join(asked)} cannot answer {what}; it is answered by {' and '.join(answering)}"
        )
    endless = [model for model in use if MODELS[model].needs_end]
    if endless and sequence.main_count is None and math.isinf(sequence.duration):
        raise ConfigError(
            f"sequence: without main_count and duration the {endless[0]} model has no end; give one of them, or leave "
            "the model out of [models] use"
        )
    dropped = [model for model in asked if model not in use]
    config = replace(
        asked_for,
        models=replace(asked_for.models, use=use, histories=False),
        records=replace(asked_for.records, components="horizontal", azimuth=None, store="none"),
        sequence=replace(asked_for.sequence, spacing=sequence.spacing),
        uncertainty=replace(asked_for.uncertainty, probability=False, azimuth=False),
        demands=(),
    )
    # The ground is at rest: the models in use take the sequence and nothing else.
    rest = Record(np.zeros(2), dt=1.0, id=name, source=source)
    nothing = np.zeros(0)
    scene = Scene(
        record=rest,
        vertical=None,
        waves=HalfWaves(nothing, nothing, nothing, nothing, nothing, nothing, dt=rest.dt, record_id=name),
        phase=IntensePhase(0.0, float(np.max(sequence.duration))),
        sequence=sequence,
        **solver_options(config),
    )
    done = replace(assess_scene(scene, bodies, config), shaken=False)
    warnings = []
    if dropped:
        verb = "is" if len(dropped) == 1 else "are"
        warnings.append(f"{what}, not a record: {', '.join(dropped)} cannot answer it and {verb} left out")
    if asked_for.demands:
        warnings.append(Remark("demand_not_compared"))
    record = replace(done.record, warnings=(*done.record.warnings, *warnings))
    done = replace(done, scene=replace(done.scene, record=record))
    tree = build_tree([record_part(done) | {EVENT: np.array([""])}], bodies, config, [])
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to a sequence of impulses"
    return registered(tree)
