"""The variables of /summary in an assessment file, in their order, each with the function that returns its values."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.settings import SPACINGS
from rockpulse.record.defects import drifts
from rockpulse.record.measures import PGA, ROWS, STORED, STORED_OF_BODIES, Measure, RecordOnBodies
from rockpulse.storage.variables import NOT_KNOWN, Declared, StoredVariable, along, flag, real, text, whole
from rockpulse.storage.variables.bodies import BLOCK, CASE
from rockpulse.storage.variables.probability import AT_DEMAND, OF_TIES, PROBABILITY, of_lanes
from rockpulse.warning_text import find, with_codes

LANES = ("record", "block", "case")


def _of_record(name: str) -> Callable[[Any], Any]:
    return lambda one: getattr(one.record, name)


def _time(name: str) -> Callable[[Any], str]:
    return lambda one: "" if (time := getattr(one.record, name)) is None else time.isoformat()


#: Variables of the earthquake and the site of a record, with the names of its fields; every study stores them. Their
#: values are taken from an object with the attribute `record`.
FACTS: Declared = along(
    ("record",),
    _of_record,
    event_id=text("event ID of the agency"),
    origin_time=text("UTC time of the earthquake, ISO 8601", _time("origin_time")),
    magnitude=real("magnitude of the earthquake"),
    magnitude_type=text("scale of the magnitude as stated in the file: Mw, ML"),
    hypocentre_latitude=real("latitude of the hypocentre", "degrees_north"),
    hypocentre_longitude=real("longitude of the hypocentre", "degrees_east"),
    hypocentre_depth=real("depth of the hypocentre", "m"),
    epicentral_distance=real("distance of the station from the epicentre, as stated in the file", "m"),
    station_latitude=real("latitude of the station", "degrees_north"),
    station_longitude=real("longitude of the station", "degrees_east"),
    vs30=real("time-averaged velocity of shear waves in the upper 30 m", "m s^-1"),
    site_class=text("class of the ground as stated in the file"),
    sensor_depth=real("depth of the sensor below the ground, as stated in the file", "m"),
)


def facts_of(one: Any) -> dict[str, Any]:
    """Return the earthquake and site data (:data:`FACTS`) of an object with the attribute `record`."""
    return {name: fact.take(one) for name, fact in FACTS.items() if fact.take is not None}


def _of_sequence(name: str, absent: float = np.nan) -> Callable[[Any], Any]:
    """Return a function that reads a field of the sequence; `absent` without a sequence, or if the field is None."""
    return lambda one: absent if (value := getattr(one.sequence, name, None)) is None else value


def _vertical_channel(one: Any) -> str:
    acting = find(one.record.processing, "vertical_acceleration")
    return "" if acting is None else str(acting.values["record"])


def _per_model(pick: Callable[[Any, str], Any]) -> Callable[[Any], Any]:
    """Return a function that stacks `pick(record, model)` for every model into one array (block, case, model, ...)."""
    return lambda one: one.per_lane(np.stack([np.asarray(pick(one, model)) for model in one.responses], axis=1))


def _of_search(name: str) -> Callable[[Any], Any]:
    return _per_model(lambda one, model: getattr(one.scales[model], name))


def _where_searched(name: str) -> Callable[[Any], Any]:
    """Return a function that reads an integer result of the search for scale factors; -1 if no search was made."""
    return _per_model(lambda one, model: np.where(np.isnan(_factor(one, model)), -1, getattr(one.scales[model], name)))


def _factor(one: Any, model: str) -> np.ndarray:
    return np.asarray(one.scales[model].safety_factor)


def _of_strength(name: str) -> Callable[[Any], Any]:
    return lambda one: one.per_lane(one.strength[name])


def _measured(measures: Iterable[Measure], take: Callable[[Measure], Callable[..., Any]]) -> dict[str, StoredVariable]:
    """Declare each measure and, if baseline drift affects it, a flag for doubtful values."""
    found = {}
    for one in measures:
        long_name = f"{one.meaning or one.long_name}{one.stored}"
        found[one.name] = real(long_name, one.unit, take(one), of_ground=True, explanation=one.explanation)
        if one.drifts:
            found[f"{one.name}_drift"] = flag(
                ("reliable", "drift"),
                f"whether the ground velocity does not return to zero, so that the {one.title} may have the same error",
                lambda one: drifts(one.record),
            )
    return found


RECORD = along(
    ("record",),
    _of_record,
    source=text("file the record was read from"),
    source_sha256=text("SHA-256 of the source file"),
    format=text("file format"),
    event=text(
        "earthquake of the record, from the user's table, the title or the time",
        explanation="the table is `[records] events`; all records without this information count as one earthquake",
    ),
    event_title=text("name of the earthquake in the file", _of_record("event")),
    network=text("network code"),
    station=text("station code"),
    station_name=text("name of the station in words"),
    component=text("name of the component in the file"),
    azimuth=real("azimuth of the component, clockwise from north", "degree"),
    start_time=text("UTC time of the first sample, ISO 8601", _time("start_time")),
    npts=whole("number of samples", of_ground=True),
    dt=real("sampling interval", "s", of_ground=True),
    **_measured(STORED, lambda measure: lambda one: measure.value(RecordOnBodies(one.record, lambda: one.scene.waves))),
    intense_start=real(
        "start of the intense phase from the first sample", "s", lambda one: one.scene.phase.start, of_ground=True
    ),
    intense_end=real(
        "end of the intense phase from the first sample", "s", lambda one: one.scene.phase.end, of_ground=True
    ),
    main_impulse=real("main impulse I of the calibrated sequence", "m s^-1", _of_sequence("main")),
    secondary_impulse=real("secondary impulse I_s of the calibrated sequence", "m s^-1", _of_sequence("secondary")),
    secondary_interval=real("interval dT of the secondary impulses", "s", _of_sequence("interval")),
    sequence_duration=real("duration within which main impulses act", "s", _of_sequence("duration")),
    main_count=whole("number of main impulses; -1 if only the duration limits it", _of_sequence("main_count", -1)),
    spacing=flag(
        ("not_known", *SPACINGS),
        "positions of the secondary impulses in the half-cycle; not known without a sequence",
        lambda one: NOT_KNOWN if one.sequence is None else SPACINGS.index(one.sequence.spacing),
        first=NOT_KNOWN,
    ),
    half_wave_count=whole(
        "number of half-waves of the whole record", lambda one: one.scene.waves.impulse.size, of_ground=True
    ),
    warnings=text("warnings on the record", lambda one: with_codes(one.record.warnings)[0], explanation="one per line"),
    warning_codes=text(
        "codes of these warnings in the same order; plain: a warning without a code",
        lambda one: with_codes(one.record.warnings)[1],
        explanation="separated by blanks; listed below",
    ),
    processing=text(
        "conditioning steps in their order", lambda one: "\n".join(one.record.processing), explanation="one per line"
    ),
    vertical_channel=text("id of the vertical channel that is used; empty if there is none", _vertical_channel),
) | dict(FACTS)

DEMAND = along(
    LANES,
    _of_strength,
    **_measured(STORED_OF_BODIES, lambda measure: _of_strength(measure.name)),
    impulse_ratio=real("I/I_1c; NaN if no sequence could be derived from the record"),
    floor_amplification=real(
        "peak acceleration of the floor divided by that of the ground; 1 on the ground", of_ground=True
    ),
    sliding_share=real(
        "share of the time in which the rocking block would need more than `friction`",
        of_ground=True,
        explanation="by the nonlinear model, without impacts; NaN if the body has no `friction`, a wall behind it, "
        "ties, loads or thrusts",
    ),
)

ANSWER = along(
    (*LANES, "model"),
    lambda name: _per_model(lambda one, model: getattr(one.responses[model], name)),
    peak_rotation_ratio=real(
        "largest rotation over alpha_c; inf if the block overturns, 0 at rest",
        explanation="theta_max/alpha_c; NaN: unresolved",
    ),
    outcome=flag(Outcome, "how the motion ends"),
    reason=flag(Reason, "why a model gives no result"),
    overturning_time=real("time at which overturning is certain, from the start of the model's input", "s"),
    overturning_half_cycle=whole("half-cycle in which the block overturns, from 1; -1 if it does not overturn"),
    impacts=whole("number of impacts faster than 1e-3 p alpha_c; -1 if infinite or not known"),
    safety_factor=real(
        "smallest scale factor on the model's input that overturns the block; NaN if not computed",
        take=_of_search("safety_factor"),
        explanation="inf: none up to the end of the search",
        comment=lambda config: (
            f"searched up to a factor of {config.search.factor_max:g} in steps of search_step, limits to 1e-6; "
            "inf if none; a factor at which the model gives no result counts as overturning (factor_resolved)"
        ),
    ),
    factor_resolved=flag(
        ("not_computed", "no", "yes"),
        "whether the model gives a result at safety_factor; no: it is a lower bound, above which the model gives none",
        _where_searched("factor_resolved"),
        first=-1,
        explanation="in free flight, for example, it gives none, which counts as overturning: values computed from "
        "`safety_factor` are then lower bounds too. If `outcome` is unresolved, the factor is at most 1, unless the "
        "lower bound at which the search begins already excludes overturning",
    ),
    safe_up_to=real(
        "scale factor on the model's input up to which the search found no overturning", take=_of_search("safe_up_to")
    ),
    interval_count=whole(
        "number of intervals of the scale factor in which the block overturns; -1 if not computed",
        _where_searched("count"),
        explanation="`safety_factor` is then NaN",
    ),
    search_step=real(
        "ratio of neighbouring scale factors of the search; 1: no interval can be missed; NaN: no search",
        take=_of_search("step"),
        explanation="1 also for a closed form, and if no scale factor up to the end of the search lifts the block or "
        "can overturn it",
    ),
    capacity_pga=real(
        "safety factor times PGA; NaN if not computed",
        "m s^-2",
        _per_model(lambda one, model: _factor(one, model) * one.record.pga),
        of_ground=True,
    ),
    applicable=flag(
        ("outside_range", "applicable"),
        "whether the block is within the range of the model",
        _per_model(lambda one, model: one.applicable[model]),
    ),
)


def _demanded(config: Config) -> bool:
    return bool(config.demands)


def _of_demands(pick: Callable[[Any], Any]) -> Callable[[Bodies, Config], Any]:
    return lambda bodies, config: [pick(demand) for demand in config.demands]


CAPACITY_RATIO = real(
    "safety factor divided by demand_factor; NaN if not computed",
    take=_per_model(lambda one, model: _factor(one, model)[:, np.newaxis] / one.probability["demand_factor"]),
    dims=(*LANES, "model", "demand"),
    stored=_demanded,
)

COORDINATES = {
    "block": text("name of the body", lambda bodies, config: bodies.names, dims=("block",)),
    "model": text("model, in order of increasing cost", lambda bodies, config: config.models.use, dims=("model",)),
}

SITE_DEMAND = along(
    ("demand",),
    None,
    _demanded,
    demand_acceleration=real(
        "ground acceleration of the demand, a_g S; NaN for another measure",
        "m s^-2",
        _of_demands(lambda demand: demand.strength if demand.measure == PGA else np.nan),
    ),
    demand_measure=text("intensity measure of the demand", _of_demands(lambda demand: demand.measure)),
    demand_value=real("value of the demand, in demand_units", take=_of_demands(lambda demand: demand.strength)),
    demand_units=text("unit of demand_value", _of_demands(lambda demand: ROWS[demand.measure].unit)),
    demand_period=real(
        "period of the oscillator whose pseudo-acceleration is the demand; NaN for another measure",
        "s",
        _of_demands(lambda demand: np.nan if demand.period is None else demand.period),
    ),
    limit_state=text("limit state of the demand", _of_demands(lambda demand: demand.limit_state)),
    demand=text("name of the demand", _of_demands(lambda demand: demand.name)),
)

SUMMARY: Declared = {
    "record": text("record id", _of_record("id"), dims=("record",)),
    **RECORD,
    **DEMAND,
    **ANSWER,
    **along(LANES, of_lanes, **PROBABILITY),
    "capacity_ratio": CAPACITY_RATIO,
    **along((*LANES, "demand"), of_lanes, _demanded, True, **AT_DEMAND),
    **along((*LANES, "demand", "tie"), of_lanes, _demanded, True, **OF_TIES),
    **BLOCK,
    **CASE,
    **COORDINATES,
    **SITE_DEMAND,
}
