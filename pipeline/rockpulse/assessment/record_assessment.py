"""The response of every body to one record, before it is stored as rows of the results."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.response import Response
from rocking.search.capacity import uplift_scale
from rocking.search.factors import ScaleIntervals
from rocking.spectrum.overturning import OverturningSpectrum
from rockpulse.assessment.probability import record_probability, sliding_shares
from rockpulse.assessment.scene import floor_scene, joined_responses, places_of, senses, turned
from rockpulse.assessment.spectra import stored_spectrum_values
from rockpulse.config.bodies import Bodies, FeltMotion
from rockpulse.config.configuration import Config
from rockpulse.model_table import MODELS, Scene
from rockpulse.record.components import Pair
from rockpulse.record.measures import STORED_OF_BODIES, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import AXIS_SIZES, SPECTRUM


class ModelRows(NamedTuple):
    """The rows that one model adds to a table of the results."""

    model: int  # index of the model in /summary
    lane: np.ndarray  # index of body and restitution of each row
    block: np.ndarray  # body of each row
    case: np.ndarray  # index of the restitution of each row
    source: Any  # object with the values of the rows
    cycle: np.ndarray  # index of the half-cycle of each row, from 0; empty in tables without half-cycles


@dataclass(frozen=True, eq=False)
class RecordAssessment:
    """The responses of all bodies to one record; a lane is the index of one body with one of its restitutions."""

    scene: Scene  # the conditioned record with its half-waves and sequence
    bodies: Bodies
    config: Config
    responses: dict[str, Response]  # by model, for all bodies and restitutions
    scales: dict[str, ScaleIntervals]
    applicable: dict[str, np.ndarray]
    probability: dict[str, np.ndarray]  # probability of overturning by variable
    strength: dict[str, np.ndarray]  # strength of the motion relative to the bodies by variable
    spectrum: OverturningSpectrum | None = None  # None if no body uses it
    shaken: bool = True  # False if a sequence of impulses replaces the record

    @property
    def record(self) -> Record:
        """The conditioned record."""
        return self.scene.record

    @cached_property
    def spectra(self) -> dict[str, np.ndarray]:
        """Variables of the overturning spectrum; NaN at every p for which it was not computed."""
        found = {name: np.full([AXIS_SIZES[dim] for dim in one.dims], np.nan) for name, one in SPECTRUM.items()}
        if self.spectrum is not None:
            places = np.searchsorted(RATES, self.spectrum.p)
            for name, values in stored_spectrum_values(self.spectrum).items():
                axis = SPECTRUM[name].dims.index("p")
                np.moveaxis(found[name], axis, 0)[places] = np.moveaxis(values, axis, 0)
        return found

    @property
    def sequence(self) -> ImpulseSequence | None:
        """The sequence of the record; None if the record has no sequence, or every body has its own."""
        sequence = self.scene.sequence
        return None if sequence is None or sequence.shape else sequence

    def per_lane(self, values: np.ndarray) -> np.ndarray:
        """Reshape values (bodies x restitutions, ...) to (bodies, restitutions, ...)."""
        return values.reshape(len(self.bodies.names), self.bodies.cases, *values.shape[1:])

    @cached_property
    def half_cycles(self) -> list[ModelRows]:
        """The rows of /half_cycles, for each model with half-cycles."""
        found = []
        for place, response in enumerate(self.responses.values()):
            if (table := response.half_cycles) is not None:
                lane, cycle = np.nonzero(np.isfinite(table.start_velocity).T)
                found.append(self._rows(place, lane, table, cycle))
        return found

    @cached_property
    def intervals(self) -> list[ModelRows]:
        """The rows of /overturning_intervals, for each model."""
        return [self._rows(place, one.lane, one) for place, one in enumerate(self.scales.values())]

    @cached_property
    def histories(self) -> list[ModelRows]:
        """The rows of the response histories, for each model with histories."""
        return [
            self._rows(place, np.arange(len(self.bodies.names) * self.bodies.cases), response)
            for place, response in enumerate(self.responses.values())
            if response.rotation is not None and response.velocity is not None
        ]

    def _rows(self, model: int, lane: np.ndarray, source: Any, cycle: np.ndarray | None = None) -> ModelRows:
        cases = self.bodies.cases
        return ModelRows(model, lane, lane // cases, lane % cases, source, np.zeros(0, int) if cycle is None else cycle)


def assess_scene(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record] = (), pair: Pair | None = None
) -> RecordAssessment:
    """Assess all bodies under one record, which may be rotated from `pair`; raise ValueError if a model rejects it."""
    places = places_of(bodies, scene.record, pair, config)
    of_record = places[0][0] == FeltMotion(None, ())  # all bodies feel the motion of the record
    if len(places) == 1 and of_record:
        return _assess_at(scene, bodies, config, channels, 1.0)
    parts, record = [], scene.record
    for place, numbers in places:
        below = turned(scene, place, pair, config)
        there = floor_scene(below, place, config)
        stronger = there.record.pga / below.record.pga
        parts.append(_assess_at(there, bodies.chosen(numbers), config, channels or [record], stronger))
    warnings = dict.fromkeys(warning for part in parts for warning in part.record.warnings)
    record = replace(record, warnings=(*record.warnings, *(one for one in warnings if one not in record.warnings)))
    steps = [round(record.dt / part.record.dt) for part in parts]
    lanes = [(one[1][:, np.newaxis] * bodies.cases + np.arange(bodies.cases)).reshape(-1) for one in places]

    def at_lanes(table: str) -> dict[str, np.ndarray]:
        """Return the named table joined from all parts, in the order of the bodies and restitutions."""
        tables, order = [getattr(part, table) for part in parts], np.argsort(np.concatenate(lanes))
        return {name: np.concatenate([one[name] for one in tables])[order] for name in tables[0]}

    return RecordAssessment(
        scene=replace(scene, record=record),
        bodies=bodies,
        config=config,
        responses={
            name: joined_responses([part.responses[name] for part in parts], lanes, record.npts, steps)
            for name in config.models.use
        },
        scales={
            name: ScaleIntervals.join([part.scales[name] for part in parts], lanes, bodies.lanes.shape[0])
            for name in parts[0].scales
        },
        applicable=at_lanes("applicable"),
        probability=at_lanes("probability"),
        strength=at_lanes("strength"),
        spectrum=parts[0].spectrum if of_record else None,
    )


def _assess_at(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record], stronger: float
) -> RecordAssessment:
    """Assess bodies with the same base motion; `stronger` is its largest acceleration divided by the PGA."""
    lanes, sides = bodies.lanes, senses(bodies, scene.record)
    warnings: list[str] = []
    responses = {name: sides.worse(MODELS[name].response(sides.block, scene)) for name in config.models.use}
    for model, response in responses.items():
        contact = response.ground_contact if MODELS[model].paired else None
        if scene.sequence is not None and contact is not None and np.any(contact):
            warnings.append(
                f"{model}: with spacing {scene.sequence.spacing!r} and this I_s/I, {np.count_nonzero(contact)} of "
                f"{np.size(contact)} bodies touch the ground within a half-cycle; use another spacing"
            )
    for model in responses:
        # The variable `applicable` has the result for each body.
        rule = MODELS[model].rule(scene) if MODELS[model].fitted else None
        if rule is not None and (outside := np.count_nonzero(~rule.applicable(lanes))):
            warnings.append(
                f"{model}: {outside} of {np.size(lanes.p)} bodies are outside the range to which the rule was fitted "
                f"({rule.range_text}): the error rates of the rule do not apply to them"
            )
    if warnings:
        scene = replace(scene, record=replace(scene.record, warnings=(*scene.record.warnings, *warnings)))
    probability, spectrum = record_probability(scene, bodies, config, channels)
    intervals = {
        name: MODELS[name].intervals(sides.block, scene)
        if config.search.asks_for(name)
        else ScaleIntervals.unknown(sides.block.shape)
        for name in responses
    }
    return RecordAssessment(
        scene=scene,
        bodies=bodies,
        config=config,
        responses=responses,
        scales={name: sides.smaller(found) for name, found in intervals.items()},
        applicable={name: MODELS[name].applicable(lanes, scene).astype(np.int8) for name in responses},
        probability=probability,
        strength=_strength_and_friction(scene, bodies, stronger),
        spectrum=spectrum,
    )


def _strength_and_friction(scene: Scene, bodies: Bodies, stronger: float) -> dict[str, np.ndarray]:
    """Return variables on the strength of the record relative to each body, and on the friction that it requires."""
    lanes, record = bodies.lanes.weaker, scene.record
    on = RecordOnBodies(record, lambda: scene.waves, lanes, uplift_scale(bodies.lanes, np.array([-1.0, 1.0])))
    found = {measure.name: np.asarray(measure.value(on)) for measure in STORED_OF_BODIES}
    main = np.nan if scene.sequence is None or scene.sequence.shape else float(scene.sequence.main)
    found["impulse_ratio"] = np.asarray(main / lanes.critical_impulse)
    found["floor_amplification"] = np.full(lanes.shape, stronger)
    found["sliding_share"] = sliding_shares(scene, bodies, np.ones(lanes.shape))
    return found
