"""The variables of /summary in an assessment, and how each is taken: of a record, or of bodies and configuration.

The order is that of the file, and of the columns of an export.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rocking.predictability import NOT_CHECKED
from rocking.response import Outcome, Reason
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.settings import SPACINGS
from rockpulse.ladder import USED
from rockpulse.record.measures import PGA, ROWS, STORED, STORED_OF_BODIES, Measure, RecordOnBodies
from rockpulse.remark import find, with_codes
from rockpulse.storage.body_variables import BLOCK, CASE
from rockpulse.storage.fact_variables import FACTS
from rockpulse.storage.probability_variables import AT_DEMAND, PROBABILITY
from rockpulse.storage.variables import NOT_KNOWN, Declared, StoredVariable, along, flag, real, text, whole

__all__ = ["ANSWER", "BLOCK", "CASE", "DEMAND", "RECORD", "SUMMARY"]

LANES = ("record", "block", "case")


def _of_record(name: str) -> Callable[[Any], Any]:
    return lambda one: getattr(one.record, name)


def _of_sequence(name: str) -> Callable[[Any], float]:
    return lambda one: np.nan if one.sequence is None else float(getattr(one.sequence, name))


def _of_response(name: str) -> Callable[[Any], Any]:
    return lambda one: one.per_model(lambda model: getattr(one.responses[model], name))


def _of_search(name: str) -> Callable[[Any], Any]:
    return lambda one: one.per_model(lambda model: getattr(one.scales[model], name))


def _where_searched(name: str) -> Callable[[Any], Any]:
    """A whole number of the search, -1 where there was none."""
    return lambda one: one.per_model(
        lambda model: np.where(np.isnan(one.scales[model].safety_factor), -1, getattr(one.scales[model], name))
    )


def _capacity_pga(one: Any, model: str) -> np.ndarray:
    return np.asarray(one.scales[model].safety_factor * one.record.pga)


def _of_strength(name: str) -> Callable[[Any], Any]:
    return lambda one: one.per_lane(one.strength[name])


def _of_motion(measure: Measure, one: Any) -> Any:
    return measure.value(RecordOnBodies(one.record, lambda: one.scene.waves))


def _measured(measures: Iterable[Measure], take: Callable[[Measure], Callable[..., Any]]) -> dict[str, StoredVariable]:
    """The variable of each measure, and after it whether a drifting baseline puts it in doubt."""
    found = {}
    for one in measures:
        long_name = f"{one.meaning or one.long_name}{one.stored}"
        found[one.name] = real(one.unit, long_name, take(one), of_ground=True, explanation=one.explanation)
        if one.drifts:
            found[f"{one.name}_drift"] = flag(
                ("reliable", "drift"),
                "whether the ground velocity does not come back to zero, so that the "
                f"{one.title} may be off by as much",
                lambda one: find(one.record.warnings, "baseline_drift") is not None,
            )
    return found


def _vertical_channel(one: Any) -> str:
    acting = find(one.record.processing, "vertical_acceleration")
    return "" if acting is None else str(acting.values["record"])


def _of_demands(name: str) -> Callable[[Bodies, Config], Any]:
    return lambda bodies, config: [getattr(demand, name) for demand in config.demands]


RECORD = along(
    ("record",),
    {
        "source": text("file the record was read from", _of_record("source")),
        "source_sha256": text("SHA-256 of the source file", _of_record("source_sha256")),
        "format": text("file format", _of_record("format")),
        "event": text(
            "earthquake that the record is counted to, by the user's table, the title or the time",
            explanation="the table is `[records] events`; records that tell none of these are counted as one",
        ),
        "event_title": text("event as the file names it", _of_record("event")),
        "network": text("network code", _of_record("network")),
        "station": text("station code", _of_record("station")),
        "station_name": text("name of the station in words", _of_record("station_name")),
        "component": text("component as the file names it", _of_record("component")),
        "azimuth": real("degree", "azimuth of the component, clockwise from north", _of_record("azimuth")),
        "start_time": text(
            "UTC time of the first sample, ISO 8601",
            lambda one: "" if one.record.start_time is None else one.record.start_time.isoformat(),
        ),
        "npts": whole("number of samples", _of_record("npts"), of_ground=True),
        "dt": real("s", "sampling interval", _of_record("dt"), of_ground=True),
        **_measured(STORED, lambda measure: partial(_of_motion, measure)),
        "intense_start": real(
            "s",
            "start of the intense phase from the first sample",
            lambda one: one.scene.phase.start,
            of_ground=True,
        ),
        "intense_end": real(
            "s", "end of the intense phase from the first sample", lambda one: one.scene.phase.end, of_ground=True
        ),
        "main_impulse": real("m s-1", "main impulse I of the calibrated sequence", _of_sequence("main")),
        "secondary_impulse": real(
            "m s-1", "secondary impulse I_s of the calibrated sequence", _of_sequence("secondary")
        ),
        "secondary_interval": real("s", "interval dT of the secondary impulses", _of_sequence("interval")),
        "sequence_duration": real("s", "duration within which main impulses act", _of_sequence("duration")),
        "main_count": whole(
            "number of main impulses; -1 where the duration alone limits them",
            lambda one: -1 if one.sequence is None or one.sequence.main_count is None else int(one.sequence.main_count),
        ),
        "spacing": flag(
            ("not_known", *SPACINGS),
            "where the secondary impulses stand in the half-cycle; not known where there is no sequence",
            lambda one: NOT_KNOWN if one.sequence is None else SPACINGS.index(one.sequence.spacing),
            first=NOT_KNOWN,
            since=1,
        ),
        "half_wave_count": whole(
            "number of half-waves of the whole record", lambda one: one.scene.waves.impulse.size, of_ground=True
        ),
        "warnings": text(
            "remarks on the record", lambda one: with_codes(one.record.warnings)[0], explanation="one a line"
        ),
        "warning_codes": text(
            "codes of these remarks in their order; plain: a text without one",
            lambda one: with_codes(one.record.warnings)[1],
            since=1,
            explanation="with blanks between them, see below",
        ),
        "processing": text(
            "conditioning steps in their order", lambda one: "\n".join(one.record.processing), explanation="one a line"
        ),
        "vertical_channel": text(
            "id of the vertical channel whose acceleration acts too; empty without one",
            _vertical_channel,
            since=1,
        ),
        **FACTS,
    },
)

DEMAND = along(
    LANES,
    {
        **_measured(STORED_OF_BODIES, lambda measure: _of_strength(measure.name)),
        "impulse_ratio": real(
            "1",
            "I/I_1c; NaN where the record gave no sequence",
            _of_strength("impulse_ratio"),
        ),
        "floor_amplification": real(
            "1",
            "peak acceleration of the floor that the body stands on over that of the ground; 1 on the ground",
            _of_strength("floor_amplification"),
            of_ground=True,
            since=5,
        ),
        **{
            name: real("1", words, _of_strength(name), of_ground=True, since=5, explanation=explanation)
            for name, words, explanation in (
                (
                    "friction_required",
                    "largest coefficient of friction that the motion without sliding asks for",
                    "of the nonlinear model, impacts aside; inf where the normal force vanishes; NaN where the body "
                    "has no `friction`, a wall behind it, ties, loads or thrusts",
                ),
                ("friction_share", "share of the samples at which it asks for more than `friction`", "NaN as above"),
            )
        },
    },
)

ANSWER = along(
    (*LANES, "model"),
    {
        "peak_rotation_ratio": real(
            "1",
            "largest rotation over alpha_c; inf where the block overturns, 0 at rest",
            _of_response("peak_rotation_ratio"),
            explanation="theta_max/alpha_c; NaN: unresolved",
        ),
        "outcome": flag((outcome.name.lower() for outcome in Outcome), "how the motion ends", _of_response("outcome")),
        "reason": flag((reason.name.lower() for reason in Reason), "why a model cannot say", _of_response("reason")),
        "overturning_time": real(
            "s",
            "time at which overturning is certain, from the start of the model's input",
            _of_response("overturning_time"),
        ),
        "overturning_half_cycle": whole(
            "1 + impacts before overturning; -1 where it does not overturn", _of_response("overturning_half_cycle")
        ),
        "impacts": whole(
            "impacts faster than 1e-3 p alpha_c; -1 where they never end or are not known", _of_response("impacts")
        ),
        "safety_factor": real(
            "1",
            "smallest factor on the model's input that overturns; NaN where not computed",
            _of_search("safety_factor"),
            explanation="inf: none up to the end of the search",
            comment=lambda config: (
                f"searched up to a factor of {config.search.factor_max:g} in steps of search_step, edges to 1e-6; inf "
                "if none; a factor at which the model cannot answer counts as overturning (factor_resolved)"
            ),
        ),
        "factor_resolved": flag(
            ("not_computed", "no", "yes"),
            "whether the model answers at safety_factor; no: a lower bound, from there on it cannot answer",
            _where_searched("factor_resolved"),
            first=-1,
            explanation="it cannot answer in free flight, for one, which counts as overturning: what follows from "
            "`safety_factor` is a lower bound then too. Where `outcome` is unresolved the factor is at most 1, unless "
            "the bound that the search begins at already rules overturning out",
        ),
        "safe_up_to": real(
            "1", "factor on the model's input up to which the search found no overturning", _of_search("safe_up_to")
        ),
        "interval_count": whole(
            "intervals of the factor in which the block overturns; -1 where not computed",
            _where_searched("count"),
            explanation="that is where `safety_factor` is NaN",
        ),
        "search_step": real(
            "1",
            "ratio of neighbouring factors of the search; 1: nothing to miss, NaN: no search",
            _of_search("step"),
            explanation="nothing can be missed in closed form, and where nothing up to the end of the search lifts the "
            "block, or is strong enough to overturn it",
        ),
        "capacity_pga": real(
            "m s-2",
            "safety factor times PGA; NaN where not computed",
            lambda one: one.per_model(lambda model: _capacity_pga(one, model)),
            of_ground=True,
        ),
        "predictable": flag(
            ("not_checked", "no", "yes"),
            "whether the answer stays when C or the record changes in the ninth digit",
            lambda one: one.per_model(one.predictable.__getitem__),
            first=NOT_CHECKED,
            explanation="yes: outcome and peak stay when C and the record change by 1e-9; of `auto` with "
            '`output = "outcome"`: the outcome alone',
            comment=lambda config: (
                f"relative changes of C and the record by 1e-9; peaks to {config.models.tolerance:g}"
                + ("; of auto the outcome alone" if config.models.output == "outcome" else "")
            ),
        ),
        "model_used": flag(USED, "model that gave the answer", lambda one: one.per_model(one.used.__getitem__)),
        "applicable": flag(
            ("outside_range", "applicable"),
            "whether the block is within the range of the model",
            lambda one: one.per_model(one.applicable.__getitem__),
        ),
    },
)

CAPACITY_RATIO = real(
    "1",
    "safety factor over demand_factor; NaN where not computed",
    lambda one: one.per_model(
        lambda model: one.scales[model].safety_factor[:, np.newaxis] / one.probability["demand_factor"]
    ),
    dims=(*LANES, "model", "demand"),
    stored=lambda config: bool(config.demands),
)

COORDINATES = {
    "block": text("name of the body", lambda bodies, config: bodies.names, dims=("block",)),
    "model": text(
        "model, from the cheapest to the dearest; auto: the cheapest that answers, see model_used",
        lambda bodies, config: config.models.answering,
        dims=("model",),
    ),
}

SITE_DEMAND = {
    name: replace(variable, dims=("demand",), stored=CAPACITY_RATIO.stored)
    for name, variable in {
        "demand_acceleration": real(
            "m s-2",
            "ground acceleration that the site asks for, a_g S; NaN for another measure",
            lambda bodies, config: [one.strength if one.measure == PGA else np.nan for one in config.demands],
        ),
        "demand_measure": text("measure of the strength that the site asks for", _of_demands("measure"), since=4),
        "demand_value": real("1", "strength that the site asks for, in demand_units", _of_demands("strength"), since=4),
        "demand_units": text(
            "unit of demand_value",
            lambda bodies, config: [ROWS[one.measure].unit for one in config.demands],
            since=4,
        ),
        "demand_period": real(
            "s",
            "period of the oscillator whose pseudo-acceleration the site asks for; NaN for another measure",
            lambda bodies, config: [np.nan if one.period is None else one.period for one in config.demands],
            since=4,
        ),
        "limit_state": text("limit state of the demand", _of_demands("limit_state")),
        "demand": text("name of the demand", _of_demands("name")),
    }.items()
}

SUMMARY: Declared = {
    "record": text("record id", _of_record("id"), dims=("record",)),
    **RECORD,
    **DEMAND,
    **ANSWER,
    **along(LANES, PROBABILITY),
    "capacity_ratio": CAPACITY_RATIO,
    **{
        name: replace(variable, dims=(*LANES, "demand"), stored=CAPACITY_RATIO.stored)
        for name, variable in AT_DEMAND.items()
    },
    **BLOCK,
    **CASE,
    **COORDINATES,
    **SITE_DEMAND,
}
