"""The variables of a fragility file, in the order of the file."""

from enum import IntEnum

from rockpulse.storage.variables import FAILURE, NOT_KNOWN, Declared, along, flag, real, text, whole
from rockpulse.storage.variables.bodies import BLOCK, CASE
from rockpulse.storage.variables.summary import FACTS, RECORD

#: Root attribute `kind` of a fragility file, and its first group.
FRAGILITY = "fragility"
#: Text in place of a unit, for values in the unit of the intensity measure.
OWN = "see measure_units"
#: Name of the property of a record that is the value of the intensity measure at scale factor 1.
STRENGTH = "strength"
#: Properties of a record that are known only if its file states them; each is the name of a field of a record.
STATED = ("magnitude", "epicentral_distance", "vs30")
#: Properties other than intensity that are known for every record.
QUALITIES = ("duration", "period", "strong_half_waves")
#: Properties for which the dependence of capacity is tested, in the order of the results.
TESTED = (*QUALITIES, STRENGTH, *STATED)


#: Status of a curve, with the reason why a curve is missing.
Status = IntEnum(
    "Status",
    "FITTED NO_RECORD ONE_RECORD NOTHING_REACHED EVERYTHING_REACHED ONE_REACHED STEP SEPARATED NOT_INCREASING "
    "NO_MAXIMUM",
    start=0,
)


#: Status of a confidence band, with the reason why a band is missing.
Band = IntEnum("Band", "GIVEN NO_CURVE ONE_EVENT FEW_EVENTS RESTS_ON_ONE_EVENT", start=0)


#: Position of the median relative to the levels analysed.
Extrapolated = IntEnum("Extrapolated", "NO ABOVE BELOW", start=0)


_LANES = ("block", "limit_state", "measure")

COORDINATES: Declared = {
    "record": text("record id", dims=("record",)),
    "block": text("name of the body", dims=("block",), explanation="with the restitution if a body has several"),
    "limit_state": text("limit state: uplift, theta_max/alpha_c, overturning", dims=("limit_state",)),
    "measure": text("intensity measure", dims=("measure",)),
    "quality": text(
        "property of the record; strength: the intensity measure of the unscaled record",
        dims=("quality",),
        explanation="magnitude, epicentral_distance and vs30 only where the files state them",
    ),
}

_FIT: Declared = {
    "median": real("measure at which the limit state is reached with probability 1/2", OWN),
    "median_low": real("lower confidence limit of the median", OWN),
    "median_high": real("upper confidence limit of the median", OWN),
    "beta": real("dispersion: standard deviation of ln capacity"),
    "beta_low": real("lower confidence limit of the dispersion"),
    "beta_high": real("upper confidence limit of the dispersion"),
}
_JUDGED: Declared = {
    "extrapolated": flag(Extrapolated, "whether the median lies beyond every level analysed"),
    "statement": text("explanation of status, band and extrapolation, if any"),
    "statement_values": text("the explanation as codes and values, in JSON"),
}

#: Variables of the fit of a curve, and of its data, for each body, limit state and intensity measure.
CURVE = along(
    _LANES,
    **_FIT,
    status=flag(Status, "whether a curve was fitted, or why not"),
    band=flag(Band, "whether there are confidence limits, or why there are none"),
    **_JUDGED,
    records=whole("number of records"),
    events=whole("number of earthquakes, over which the confidence limits are taken"),
    observations=whole("number of capacities, or of scaled motions"),
    reached=whole("number of observations that reached the limit state; the others are censored"),
)

CURVES: Declared = {
    **CURVE,
    "level": real(
        "values of the measure at which the curves are given",
        OWN,
        dims=("block", "measure", "point"),
        explanation="the same for all limit states of a body",
    ),
    **along(
        ("block", "limit_state", "measure", "point"),
        probability=real("probability of reaching the limit state", explanation="at `level`"),
        probability_low=real("lower confidence limit of the probability", explanation="the band is pointwise"),
        probability_high=real("upper confidence limit of the probability"),
    ),
    "measure_units": text("unit of each measure", dims=("measure",)),
    "measure_long_name": text("meaning of each measure", dims=("measure",)),
    **along(("block",), alpha_c=BLOCK["alpha_c"], p=BLOCK["p"], restitution=CASE["restitution"]),
    "uplift_acceleration": real(
        "smallest horizontal acceleration of the ground that lifts the body",
        "m s^-2",
        dims=("block",),
        explanation="NaN on a floor of a building, and where a vertical channel acts",
    ),
}

#: Variables of an incremental dynamic analysis.
IDA: Declared = {
    "factor": real(
        "smallest scale factor found that reaches the limit state; inf if none does",
        dims=("record", "block", "limit_state"),
        explanation="up to the end of the search",
    ),
    "reached": flag(
        ("above_the_search", "reached"),
        "whether the limit state was reached up to the end of the search",
        dims=("record", "block", "limit_state"),
    ),
    "search_step": real(
        "ratio of neighbouring scale factors of the search for rotations and overturning; 1: no interval is missed",
        dims=("record", "block"),
        explanation="uplift has a closed form; if a limit state is reached only in an interval narrower than this "
        "step, `factor` is too large",
    ),
}

STRIPES: Declared = {
    "factor": real("scale factor on the record; NaN for unused stripes", dims=("record", "block", "stripe")),
    "weight": real(
        "weight of the record at this scale factor in the fits",
        dims=("record", "stripe"),
        explanation="1 without a selection of records",
    ),
    "reached": flag(
        ("not_known", "not_reached", "reached"),
        "whether the limit state was reached; -1 if the model gives no result",
        first=NOT_KNOWN,
        dims=("record", "block", "limit_state", "stripe"),
    ),
}

#: Variables of the records in every analysis.
CAPACITIES: Declared = {
    "measure_value": real(
        "intensity measure of the unscaled record",
        OWN,
        dims=("record", "block", "measure"),
        explanation="multiplied by `factor` it is the capacity in this measure",
    ),
    **along(
        ("record",),
        event=text("earthquake of the record"),
        source=text(RECORD["source"].long_name),
        duration=real("length of the intense phase", "s"),
        period=real("2 pi PGV/PGA", "s"),
        strong_half_waves=real("number of half-waves of the intense phase above half the largest"),
        **FACTS,
    ),
}

_RATIO: Declared = {
    "beta_ratio": real("dispersion divided by the dispersion for p PGV/(g tan alpha_c)"),
    "beta_ratio_low": real("lower confidence limit of the ratio of dispersions"),
    "beta_ratio_high": real("upper confidence limit of the ratio of dispersions"),
}
_QUALITY: Declared = {
    "slope": real(
        "slope of ln median over ln of a property of the record, or over the magnitude itself",
        explanation="from the records for which the property is known",
    ),
    "p_value": real("p-value of a slope of zero, by the jackknife over earthquakes; not corrected for multiple tests"),
}
_POOLED_FIT: Declared = {**_FIT, **_JUDGED}


def _pooled(declared: Declared) -> Declared:
    return {f"pooled_{name}": variable for name, variable in declared.items()}


#: Variables for each body, and for all bodies together (these only for dimensionless intensity measures).
EFFICIENCY: Declared = {
    **along(_LANES, **_RATIO),
    **along((*_LANES, "quality"), **_QUALITY),
    **along(("limit_state", "measure"), **_pooled(_RATIO)),
    **along(("limit_state", "measure", "quality"), **_pooled(_QUALITY)),
    "quality_records": whole("number of records for which the property is known", dims=("quality",)),
    "quality_events": whole("number of earthquakes of these records", dims=("quality",)),
    "most_efficient": text(
        "measure with the smallest dispersion; empty if no dispersion is known", dims=("block", "limit_state")
    ),
    **along(("limit_state", "measure"), **_pooled(_POOLED_FIT)),
}

#: Variables of /efficiency for fits of all bodies together.
POOLED = tuple(_POOLED_FIT)


def _with(names: str, declared: Declared) -> Declared:
    return {name: COORDINATES[name] for name in names.split()} | dict(declared)


#: Every variable of a fragility file, by group.
FRAGILITY_GROUPS: dict[str, Declared] = {
    "/fragility": _with("block limit_state measure", CURVES),
    "/capacities, ida": _with("record block limit_state measure", {**IDA, **CAPACITIES}),
    "/capacities, stripes and cloud": _with("record block limit_state measure", {**STRIPES, **CAPACITIES}),
    "/efficiency": _with("block limit_state measure quality", EFFICIENCY),
    "/failures": FAILURE,
}
