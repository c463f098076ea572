"""The variables of a file of rule verdicts, which is of tables: one value of each variable per row."""

from __future__ import annotations

from rockpulse.storage.variables import FAILURE, Declared, along, flag, real, text, whole

__all__ = ["RULE_KIND", "RULE_TABLES"]

#: Root attribute `kind`.
RULE_KIND = "rule verdicts"

#: Words of a verdict.
COMPUTED = ("not_computed", "no", "yes")

_CASES: Declared = {
    "record": text("record id"),
    "event": text("earthquake"),
    "source": text("file the record was read from", since=1),
    "slenderness": real("1", "height over width"),
    "radius": real("m", "half-diagonal R"),
    "scale": real("1", "factor on the record"),
    "march": real("1", "1 over the factor at which the march through the half-waves overturns"),
    "build_up": real("1", "speed that the lobes of the exponentially weighted impulse build up"),
    "uplift_ratio": real("1", "PGA/(g tan alpha)"),
    "velocity_ratio": real("1", "p PGV/(g tan alpha)"),
    "overturns": flag(COMPUTED, "verdict of the nonlinear model", first=-1),
    "peak": real("1", "theta_max/alpha_c of the nonlinear model"),
    "left_out_march": real("1", "march over the balanced limit fitted without the earthquake"),
    "left_out_velocity_ratio": real("1", "p PGV/(g tan alpha) over its balanced limit fitted without the earthquake"),
    "flips": whole("perturbed truths that give another verdict than the nonlinear model"),
    "balanced": flag(COMPUTED, "verdict of the balanced rule fitted without the earthquake", first=-1),
    "conservative": flag(COMPUTED, "verdict of the conservative rule fitted without the earthquake", first=-1),
}

_SCORE = text(
    "march (the rule), velocity_ratio (p PGV/(g tan alpha), alarms where uplift is possible) or velocity_alone "
    "(without that condition)"
)

_RATES: Declared = {
    "score": _SCORE,
    "point": text("working point"),
    "kind": text("in-sample, left-out (limit fitted without the earthquake) or as-given (a stored rule)"),
    "overturnings": whole("cases that overturn"),
    "survivors": whole("cases that survive"),
    "missed": whole("overturnings without an alarm"),
    "false": whole("survivors with an alarm"),
    "missed_share": real("1", "missed over overturnings"),
    "missed_low": real("1", "missed share, lower end of the 95 % interval, earthquakes resampled and limits refitted"),
    "missed_high": real("1", "missed share, upper end of the 95 % interval, earthquakes resampled and limits refitted"),
    "missed_bound": real("1", "missed share, 95 % upper bound as if cases were independent (Clopper-Pearson)"),
    "missed_bound_clustered": real("1", "missed share, 95 % upper bound, earthquakes resampled and limits refitted"),
    "false_share": real("1", "false over survivors"),
    "false_low": real("1", "false share, lower end of the 95 % interval, earthquakes resampled and limits refitted"),
    "false_high": real("1", "false share, upper end of the 95 % interval, earthquakes resampled and limits refitted"),
    "missed_least": real("1", "least missed share over the perturbed truths, limits refitted"),
    "missed_most": real("1", "largest missed share over the perturbed truths, limits refitted"),
    "false_least": real("1", "least false share over the perturbed truths, limits refitted"),
    "false_most": real("1", "largest false share over the perturbed truths, limits refitted"),
    "false_difference": real("1", "false share of the rule at this point and kind less this one"),
    "false_difference_low": real("1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "false_difference_high": real("1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "peaks": whole("survivors without an alarm whose nonlinear peak is above 0.05"),
    "peak_bias": real("1", "median ratio of the sequence's peak to the nonlinear one of those that move"),
    "peak_dispersion": real("1", "standard deviation of the logarithm of that ratio"),
}

_AT_MISSED: Declared = {
    "kind": text("in-sample or left-out scores"),
    "missed_share": real("1", "share of overturnings that may be missed"),
    "march": real("1", "false share of the rule"),
    "velocity_ratio": real("1", "false share of p PGV/(g tan alpha)"),
    "velocity_alone": real("1", "false share of p PGV/(g tan alpha) with alarms where nothing lifts"),
    "difference": real("1", "false share of the rule less that of p PGV/(g tan alpha)"),
    "difference_low": real("1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_high": real("1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_alone": real("1", "false share of the rule less that of velocity_alone"),
    "difference_alone_low": real("1", "lower end of its 95 % interval"),
    "difference_alone_high": real("1", "upper end of its 95 % interval"),
}

_AREAS: Declared = {
    "kind": text("in-sample or left-out scores"),
    "march": real("1", "area under the ROC curve of the rule"),
    "velocity_ratio": real("1", "area under the ROC curve of p PGV/(g tan alpha)"),
    "velocity_alone": real("1", "area under the ROC curve of p PGV/(g tan alpha) with alarms where nothing lifts"),
    "difference": real("1", "area of the rule less that of p PGV/(g tan alpha)"),
    "difference_low": real("1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_high": real("1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_alone": real("1", "area of the rule less that of velocity_alone"),
    "difference_alone_low": real("1", "lower end of its 95 % interval"),
    "difference_alone_high": real("1", "upper end of its 95 % interval"),
}

_CURVES: Declared = {
    "score": _SCORE,
    "kind": text("in-sample or left-out scores"),
    "missed_share": real("1", "share of overturnings that are missed"),
    "false_share": real("1", "share of survivors that raise an alarm"),
}

#: Variables of each table.
RULE_TABLES: dict[str, Declared] = {
    name: along(("row",), table)
    for name, table in {
        "rates": _RATES,
        "at_missed": _AT_MISSED,
        "areas": _AREAS,
        "curves": _CURVES,
        "cases": _CASES,
        "failures": FAILURE,
    }.items()
}
