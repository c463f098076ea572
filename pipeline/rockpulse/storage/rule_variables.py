"""The variables of a file of rule verdicts: type, unit and meaning of each column of its tables."""

from __future__ import annotations

from rockpulse.storage.variables import FAILURE, Meaning

__all__ = ["RULE_KIND", "RULE_TABLES"]

#: Root attribute `kind`.
RULE_KIND = "rule verdicts"

_CASES: dict[str, Meaning] = {
    "record": (str, "1", "record id"),
    "event": (str, "1", "earthquake"),
    "slenderness": (float, "1", "height over width"),
    "radius": (float, "m", "half-diagonal R"),
    "scale": (float, "1", "factor on the record"),
    "march": (float, "1", "1 over the factor at which the march through the half-waves overturns"),
    "build_up": (float, "1", "speed that the lobes of the exponentially weighted impulse build up"),
    "uplift_ratio": (float, "1", "PGA/(g tan alpha)"),
    "velocity_ratio": (float, "1", "p PGV/(g tan alpha)"),
    "overturns": (bool, "1", "verdict of the nonlinear model"),
    "peak": (float, "1", "theta_max/alpha_c of the nonlinear model"),
    "left_out_march": (float, "1", "march over the balanced limit fitted without the earthquake"),
    "left_out_velocity_ratio": (
        float,
        "1",
        "p PGV/(g tan alpha) over its balanced limit fitted without the earthquake",
    ),
    "flips": (int, "1", "perturbed truths that give another verdict than the nonlinear model"),
    "balanced": (bool, "1", "verdict of the balanced rule fitted without the earthquake"),
    "conservative": (bool, "1", "verdict of the conservative rule fitted without the earthquake"),
}

_SCORE: Meaning = (
    str,
    "1",
    "march (the rule), velocity_ratio (p PGV/(g tan alpha), alarms where uplift is possible) or velocity_alone "
    "(without that condition)",
)

_RATES: dict[str, Meaning] = {
    "score": _SCORE,
    "point": (str, "1", "working point"),
    "kind": (str, "1", "in-sample, left-out (limit fitted without the earthquake) or as-given (a stored rule)"),
    "overturnings": (int, "1", "cases that overturn"),
    "survivors": (int, "1", "cases that survive"),
    "missed": (int, "1", "overturnings without an alarm"),
    "false": (int, "1", "survivors with an alarm"),
    "missed_share": (float, "1", "missed over overturnings"),
    "missed_low": (
        float,
        "1",
        "missed share, lower end of the 95 % interval, earthquakes resampled and limits refitted",
    ),
    "missed_high": (
        float,
        "1",
        "missed share, upper end of the 95 % interval, earthquakes resampled and limits refitted",
    ),
    "missed_bound": (float, "1", "missed share, 95 % upper bound as if cases were independent (Clopper-Pearson)"),
    "missed_bound_clustered": (float, "1", "missed share, 95 % upper bound, earthquakes resampled and limits refitted"),
    "false_share": (float, "1", "false over survivors"),
    "false_low": (float, "1", "false share, lower end of the 95 % interval, earthquakes resampled and limits refitted"),
    "false_high": (
        float,
        "1",
        "false share, upper end of the 95 % interval, earthquakes resampled and limits refitted",
    ),
    "missed_least": (float, "1", "least missed share over the perturbed truths, limits refitted"),
    "missed_most": (float, "1", "largest missed share over the perturbed truths, limits refitted"),
    "false_least": (float, "1", "least false share over the perturbed truths, limits refitted"),
    "false_most": (float, "1", "largest false share over the perturbed truths, limits refitted"),
    "false_difference": (float, "1", "false share of the rule at this point and kind less this one"),
    "false_difference_low": (float, "1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "false_difference_high": (float, "1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "peaks": (int, "1", "survivors without an alarm whose nonlinear peak is above 0.05"),
    "peak_bias": (float, "1", "median ratio of the sequence's peak to the nonlinear one of those that move"),
    "peak_dispersion": (float, "1", "standard deviation of the logarithm of that ratio"),
}

_AT_MISSED: dict[str, Meaning] = {
    "kind": (str, "1", "in-sample or left-out scores"),
    "missed_share": (float, "1", "share of overturnings that may be missed"),
    "march": (float, "1", "false share of the rule"),
    "velocity_ratio": (float, "1", "false share of p PGV/(g tan alpha)"),
    "velocity_alone": (float, "1", "false share of p PGV/(g tan alpha) with alarms where nothing lifts"),
    "difference": (float, "1", "false share of the rule less that of p PGV/(g tan alpha)"),
    "difference_low": (float, "1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_high": (float, "1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_alone": (float, "1", "false share of the rule less that of velocity_alone"),
    "difference_alone_low": (float, "1", "lower end of its 95 % interval"),
    "difference_alone_high": (float, "1", "upper end of its 95 % interval"),
}

_AREAS: dict[str, Meaning] = {
    "kind": (str, "1", "in-sample or left-out scores"),
    "march": (float, "1", "area under the ROC curve of the rule"),
    "velocity_ratio": (float, "1", "area under the ROC curve of p PGV/(g tan alpha)"),
    "velocity_alone": (float, "1", "area under the ROC curve of p PGV/(g tan alpha) with alarms where nothing lifts"),
    "difference": (float, "1", "area of the rule less that of p PGV/(g tan alpha)"),
    "difference_low": (float, "1", "lower end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_high": (float, "1", "upper end of its 95 % interval, earthquakes resampled and limits refitted"),
    "difference_alone": (float, "1", "area of the rule less that of velocity_alone"),
    "difference_alone_low": (float, "1", "lower end of its 95 % interval"),
    "difference_alone_high": (float, "1", "upper end of its 95 % interval"),
}

_CURVES: dict[str, Meaning] = {
    "score": _SCORE,
    "kind": (str, "1", "in-sample or left-out scores"),
    "missed_share": (float, "1", "share of overturnings that are missed"),
    "false_share": (float, "1", "share of survivors that raise an alarm"),
}

#: Tables by name, columns by table.
RULE_TABLES: dict[str, dict[str, Meaning]] = {
    "rates": _RATES,
    "at_missed": _AT_MISSED,
    "areas": _AREAS,
    "curves": _CURVES,
    "cases": _CASES,
    "failures": FAILURE,
}
