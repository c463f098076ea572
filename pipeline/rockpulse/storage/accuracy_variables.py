"""The variables of an accuracy report: type, unit and meaning of each column of its tables."""

from __future__ import annotations

from rockpulse.storage.variables import FAILURE, Meaning

__all__ = ["REPORT", "TABLES"]

#: Root attribute `kind` of a report.
REPORT = "accuracy report"

_METHOD: dict[str, Meaning] = {
    "equation": (str, "1", "equation of motion"),
    "method": (str, "1", "rockpulse, a method of scipy's solve_ivp, or the reference under its own perturbations"),
    "option": (str, "1", "what the setting sets: longest step (p dt), relative tolerance, relative perturbation"),
    "setting": (float, "1", "step, tolerance or perturbation"),
    "call": (str, "1", "lanes: all blocks and factors of a motion in a call; single: one call a case"),
}

_WORK_PRECISION: dict[str, Meaning] = {
    **_METHOD,
    "cases": (int, "1", "cases compared with the reference"),
    "unresolved": (int, "1", "cases without an answer"),
    "flips": (int, "1", "verdicts other than the reference's"),
    "reference_flips": (int, "1", "cases whose verdict flips in the reference itself under a change of 1e-13"),
    "well_conditioned": (float, "1", "share of cases that move by less than 1e-10 under a change of 1e-13"),
    "compared": (int, "1", "cases that both answers call surviving"),
    "median": (float, "1", "median error of theta_max/alpha_c"),
    "p90": (float, "1", "90th percentile of the error of theta_max/alpha_c"),
    "p99": (float, "1", "99th percentile of the error of theta_max/alpha_c"),
    "max": (float, "1", "largest error of theta_max/alpha_c"),
    "compared_well": (int, "1", "well-conditioned cases among those compared"),
    "median_well": (float, "1", "median error, well-conditioned cases only"),
    "p90_well": (float, "1", "90th percentile of the error, well-conditioned cases only"),
    "p99_well": (float, "1", "99th percentile of the error, well-conditioned cases only"),
    "max_well": (float, "1", "largest error, well-conditioned cases only"),
    "lanes": (int, "1", "lanes computed in the calls that were timed; 0 where nothing was"),
    "active_samples": (int, "1", "samples in which a lane moved, all lanes together"),
    "samples": (int, "1", "lanes times samples"),
    "seconds": (float, "s", "time of the calls, median of whole repetitions for rockpulse"),
    "ns_per_active_sample": (float, "ns", "time per active sample"),
    "ns_per_sample": (float, "ns", "time per nominal block-sample"),
    "times_faster": (float, "1", "time per active sample of RK45 at rtol 1e-6 over that of this row"),
}

_SYNTHETIC_GRID: dict[str, Meaning] = {
    "equation": (str, "1", "equation of motion"),
    "restitution": (float, "1", "restitution of the cases, the velocity ratio C"),
    "step": (float, "1", "longest step of rockpulse, as p dt"),
    "cases": (int, "1", "cases with synthetic motions and this restitution"),
    "compared": (int, "1", "cases that both answers call surviving"),
    "median": (float, "1", "median error of theta_max/alpha_c"),
    "p99": (float, "1", "99th percentile of the error of theta_max/alpha_c"),
    "flips": (int, "1", "verdicts other than the reference's"),
    "reference_p99": (float, "1", "99th percentile of what a change of 1e-13 does to the reference"),
    "reference_flips": (int, "1", "cases whose verdict flips in the reference itself under a change of 1e-13"),
}

_ANSWERS: dict[str, Meaning] = {
    **_METHOD,
    "case": (str, "1", "case of the reference"),
    "peak": (float, "1", "theta_max/alpha_c; inf where the block overturns"),
    "outcome": (str, "1", "how the motion ends"),
    "error": (float, "1", "error of theta_max/alpha_c; NaN unless both answers survive"),
}

_CONVERGENCE: dict[str, Meaning] = {
    "step": (float, "1", "step taken, as p dt"),
    "cases": (int, "1", "cases that survive with every step"),
    "median": (float, "1", "median error of theta_max/alpha_c"),
    "p90": (float, "1", "90th percentile of the error of theta_max/alpha_c"),
    "ns_per_active_sample": (float, "ns", "time per active sample"),
    "order": (float, "1", "order of convergence observed against the row before"),
    "order_cases": (int, "1", "cases from which the order was read"),
}

_MODEL_FORM: dict[str, Meaning] = {
    "ensemble": (str, "1", "ensemble of records"),
    "model": (str, "1", "model compared with the nonlinear response to the record"),
    "demand_low": (float, "1", "lower edge of the demand level, as p PGV/(g tan alpha_c)"),
    "demand_high": (float, "1", "upper edge of the demand level, as p PGV/(g tan alpha_c)"),
    "lanes": (int, "1", "records times factors times blocks that both models answer"),
    "unresolved": (int, "1", "lanes that one of the two cannot answer"),
    "overturn": (int, "1", "lanes that overturn by the nonlinear model"),
    "missed": (int, "1", "lanes that overturn by the nonlinear model only"),
    "false": (int, "1", "lanes that overturn by the other model only"),
    "survivors": (int, "1", "lanes that both call surviving, the nonlinear peak above 0.05"),
    "at_rest": (int, "1", "survivors that do not move in the other model, left out of bias and dispersion"),
    "bias": (float, "1", "median ratio of the model's peak to the nonlinear one"),
    "dispersion": (float, "1", "standard deviation of the logarithm of that ratio"),
}

_CLASSIFIERS: dict[str, Meaning] = {
    "ensemble": (str, "1", "ensemble of records"),
    "demand": (
        str,
        "1",
        "velocity_ratio: p PGV/(g tan alpha_c); uplift_ratio: PGA/(g tan alpha_c); impulse_ratio: largest half-wave "
        "over I_1c",
    ),
    "lanes": (int, "1", "lanes that the nonlinear model answers"),
    "overturn": (int, "1", "lanes that overturn by it"),
    "auc": (float, "1", "area under the ROC curve"),
    "false_at_0": (float, "1", "share of survivors that raise the alarm where no overturning is missed"),
    "false_at_5": (float, "1", "share of survivors that raise the alarm where 5 % of the overturnings are missed"),
    "false_at_10": (float, "1", "share of survivors that raise the alarm where 10 % of the overturnings are missed"),
}

#: Columns of each table of the report.
TABLES: dict[str, dict[str, Meaning]] = {
    "work_precision": _WORK_PRECISION,
    "synthetic_grid": _SYNTHETIC_GRID,
    "answers": _ANSWERS,
    "convergence": _CONVERGENCE,
    "model_form": _MODEL_FORM,
    "classifiers": _CLASSIFIERS,
    "failures": FAILURE,
}
