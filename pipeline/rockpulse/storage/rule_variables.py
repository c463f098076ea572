"""The variables of a file of rule verdicts, which is of tables: one value of each variable per row."""

from __future__ import annotations

from rockpulse.storage.variables import FAILURE, Declared, along, flag, real, text, whole

__all__ = ["RULE_KIND", "RULE_TABLES"]

#: Root attribute `kind`.
RULE_KIND = "rule verdicts"

#: Words of a verdict.
COMPUTED = ("not_computed", "no", "yes")

_DEMANDS: Declared = {
    "march": real("1", "1 over the mean capacity of the march through the half-waves"),
    "march_10": real("1", "1 over the factor at which the march overturns with a probability of 10 %"),
    "single_ratio": real("1", "1 over the safety factor of one nonlinear analysis"),
    "change_ratio": real("1", "largest change of velocity within 2/p over g tan(alpha)/p"),
    "intensity_ratio": real("1", "mean pseudo-velocity, 5 % damping, 0.1 to 2.5 s, over g tan(alpha)/p"),
    "velocity_ratio": real("1", "p PGV/(g tan alpha)"),
    "impulse_ratio": real("1", "largest half-wave over g tan(alpha)/p"),
    "uplift_ratio": real("1", "PGA/(g tan alpha)"),
    "ishiyama_ratio": real("1", "PGV over 0.4 sqrt(8 g R (1 - cos alpha)/(3 cos^2 alpha))"),
}

_CASES: Declared = {
    "record": text("record id"),
    "event": text("earthquake"),
    "source": text("file the record was read from"),
    "slenderness": real("1", "height over width"),
    "radius": real("m", "half-diagonal R"),
    **_DEMANDS,
    "capacity_mean": real("1", "exp of the mean logarithm of the factor at which the body overturns"),
    "capacity_mean_low": real("1", "what that is at least where it is not reached"),
    "factor_10": real("1", "factor at which the body overturns with a probability of 10 %"),
    "factor_50": real("1", "factor at which the body overturns with a probability of 50 %"),
    "probability_half": real("1", "probability of overturning at a factor of 0.5"),
    "probability_one": real("1", "probability of overturning at a factor of 1"),
    "overturns_half": flag(COMPUTED, "nonlinear verdict at a factor of 0.5", first=-1),
    "overturns_one": flag(COMPUTED, "nonlinear verdict at a factor of 1", first=-1),
    "left_out_balanced": real("1", "demand of the balanced rule fitted without the earthquake"),
    "left_out_conservative": real("1", "demand of the conservative rule fitted without the earthquake"),
}

_MEASURE = text("name of the demand in /cases")

_CAPACITIES: Declared = {
    "measure": _MEASURE,
    "target": text("capacity_mean or factor_10"),
    "kind": text("left-out (coefficient fitted without the earthquake) or as-given (a stored rule)"),
    "coefficient": real("1", "coefficient of the measure; its median over earthquakes left out"),
    "bias": real("1", "median of predicted over nonlinear capacity, earthquakes alike"),
    "bias_low": real("1", "lower end of its 95 % interval, earthquakes resampled"),
    "bias_high": real("1", "upper end of its 95 % interval, earthquakes resampled"),
    "dispersion": real("1", "standard deviation of the logarithm of that ratio"),
    "within": real("1", "the same about the mean of each body"),
    "within_low": real("1", "lower end of its 95 % interval, earthquakes resampled"),
    "within_high": real("1", "upper end of its 95 % interval, earthquakes resampled"),
    "reached": whole("capacities that are reached"),
    "censored_share": real("1", "share of the capacities that are not reached by a factor of 10"),
}

_RATES: Declared = {
    "score": text("name of the demand in /cases"),
    "point": text("working point of the rule; empty for other scores"),
    "kind": text("left-out, as-given (a stored rule) or as published"),
    "overturnings": whole("cases that overturn, at factors of 0.5 and 1"),
    "survivors": whole("cases that survive"),
    "missed": whole("overturnings without an alarm"),
    "false": whole("survivors with an alarm"),
    "missed_share": real("1", "missed over overturnings"),
    "missed_low": real("1", "missed share, lower end of the 95 % interval, earthquakes resampled"),
    "missed_high": real("1", "missed share, upper end of the 95 % interval, earthquakes resampled"),
    "false_share": real("1", "false over survivors"),
    "false_low": real("1", "false share, lower end of the 95 % interval, earthquakes resampled"),
    "false_high": real("1", "false share, upper end of the 95 % interval, earthquakes resampled"),
}

_AT_MISSED: Declared = {
    "score": text("name of the demand in /cases, or limit: the probability of overturning by the nonlinear equation"),
    "missed_share": real("1", "share of overturnings that may be missed"),
    "false_share": real("1", "share of survivors that raise an alarm at that limit"),
    "false_low": real("1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "false_high": real("1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
}

#: Variables of each table.
RULE_TABLES: dict[str, Declared] = {
    name: along(("row",), table)
    for name, table in {
        "rates": _RATES,
        "capacities": _CAPACITIES,
        "at_missed": _AT_MISSED,
        "cases": _CASES,
        "failures": FAILURE,
    }.items()
}
