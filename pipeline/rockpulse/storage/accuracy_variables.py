"""The variables of an accuracy report, which is of tables: one value of each variable per row."""

from __future__ import annotations

from rockpulse.storage.variables import FAILURE, Declared, along, real, text, whole

__all__ = ["REPORT", "TABLES"]

#: Root attribute `kind` of a report.
REPORT = "accuracy report"

_METHOD: Declared = {
    "equation": text("equation of motion"),
    "method": text(
        "rockpulse, a method of scipy's solve_ivp, or the reference under its own perturbations",
        explanation="of the reference: what a change of 1e-13 does to it",
    ),
    "option": text(
        "what the setting sets: longest step (p dt), relative tolerance, relative perturbation",
        explanation="step, rtol, perturbation",
    ),
    "setting": real("1", "step, tolerance or perturbation"),
    "call": text("lanes: all blocks and factors of a motion in a call; single: one call a case"),
}

_WORK_PRECISION: Declared = {
    **_METHOD,
    "cases": whole("cases compared with the reference"),
    "unresolved": whole("cases without an answer"),
    "flips": whole("verdicts other than the reference's"),
    "reference_flips": whole("cases whose verdict flips in the reference itself under a change of 1e-13"),
    "well_conditioned": real("1", "share of cases that move by less than 1e-10 under a change of 1e-13"),
    "compared": whole("cases that both answers call surviving"),
    "median": real("1", "median error of theta_max/alpha_c"),
    "p90": real("1", "90th percentile of the error of theta_max/alpha_c"),
    "p99": real("1", "99th percentile of the error of theta_max/alpha_c"),
    "max": real("1", "largest error of theta_max/alpha_c"),
    "compared_well": whole("well-conditioned cases among those compared"),
    "median_well": real("1", "median error, well-conditioned cases only"),
    "p90_well": real("1", "90th percentile of the error, well-conditioned cases only"),
    "p99_well": real("1", "99th percentile of the error, well-conditioned cases only"),
    "max_well": real("1", "largest error, well-conditioned cases only"),
    "lanes": whole("lanes computed in the calls that were timed; 0 where nothing was"),
    "active_samples": whole("samples in which a lane moved, all lanes together"),
    "samples": whole("lanes times samples"),
    "seconds": real("s", "time of the calls, median of whole repetitions for rockpulse"),
    "ns_per_active_sample": real("ns", "time per active sample"),
    "ns_per_sample": real("ns", "time per nominal block-sample"),
    "times_faster": real(
        "1",
        "time per active sample of RK45 at rtol 1e-6 over that of this row",
        explanation="like for like only where `call` is single",
    ),
}

_SYNTHETIC_GRID: Declared = {
    "equation": text("equation of motion"),
    "restitution": real("1", "restitution of the cases, the velocity ratio C"),
    "step": real("1", "longest step of rockpulse, as p dt"),
    "cases": whole("cases with synthetic motions and this restitution"),
    "compared": whole("cases that both answers call surviving"),
    "median": real("1", "median error of theta_max/alpha_c"),
    "p99": real("1", "99th percentile of the error of theta_max/alpha_c"),
    "flips": whole("verdicts other than the reference's"),
    "reference_p99": real("1", "99th percentile of what a change of 1e-13 does to the reference"),
    "reference_flips": whole("cases whose verdict flips in the reference itself under a change of 1e-13"),
}

_ANSWERS: Declared = {
    **_METHOD,
    "case": text("case of the reference"),
    "peak": real("1", "theta_max/alpha_c; inf where the block overturns"),
    "outcome": text("how the motion ends", explanation="AT_REST, ROCKS, OVERTURNS, UNRESOLVED"),
    "error": real("1", "error of theta_max/alpha_c; NaN unless both answers survive"),
}

_CONVERGENCE: Declared = {
    "step": real("1", "step taken, as p dt"),
    "cases": whole("cases that survive with every step"),
    "median": real("1", "median error of theta_max/alpha_c"),
    "p90": real("1", "90th percentile of the error of theta_max/alpha_c"),
    "ns_per_active_sample": real("ns", "time per active sample"),
    "order": real("1", "order of convergence observed against the row before"),
    "order_cases": whole("cases from which the order was read"),
}

_BODIES: Declared = {
    "kind": text("what the bodies have beside their size"),
    "cases": whole("bodies times factors times motions"),
    "flips": whole("verdicts that change on samples divided in four"),
    "compared": whole("cases that both call surviving"),
    "median": real("1", "median change of theta_max/alpha_c"),
    "p99": real("1", "99th percentile of the change of theta_max/alpha_c"),
    "max": real("1", "largest change of theta_max/alpha_c"),
    "max_perturbed": real("1", "largest change of theta_max/alpha_c under a change of the record of 1e-13"),
    "ns_per_active_sample": real("ns", "time per active sample"),
    "times_plain": real("1", "that time over the one of free symmetric blocks"),
}

_MODEL_FORM: Declared = {
    "ensemble": text("ensemble of records"),
    "model": text("model compared with the nonlinear response to the record"),
    "demand_low": real("1", "lower edge of the demand level, as p PGV/(g tan alpha_c)"),
    "demand_high": real("1", "upper edge of the demand level, as p PGV/(g tan alpha_c)", explanation="0 to inf: all"),
    "lanes": whole("records times factors times blocks that both models answer"),
    "unresolved": whole("lanes that one of the two cannot answer"),
    "overturn": whole("lanes that overturn by the nonlinear model"),
    "missed": whole("lanes that overturn by the nonlinear model only"),
    "false": whole("lanes that overturn by the other model only"),
    "survivors": whole("lanes that both call surviving, the nonlinear peak above 0.05"),
    "at_rest": whole("survivors that do not move in the other model, left out of bias and dispersion"),
    "bias": real("1", "median ratio of the model's peak to the nonlinear one"),
    "dispersion": real(
        "1",
        "standard deviation of the logarithm of that ratio",
        explanation="little to rely on where `survivors` less `at_rest` is small",
    ),
}

_CLASSIFIERS: Declared = {
    "ensemble": text("ensemble of records"),
    "demand": text(
        "velocity_ratio: p PGV/(g tan alpha_c); uplift_ratio: PGA/(g tan alpha_c); impulse_ratio: largest half-wave "
        "over I_1c"
    ),
    "lanes": whole("lanes that the nonlinear model answers"),
    "overturn": whole("lanes that overturn by it"),
    "auc": real("1", "area under the ROC curve"),
    "false_at_0": real("1", "share of survivors that raise the alarm where no overturning is missed"),
    "false_at_5": real("1", "share of survivors that raise the alarm where 5 % of the overturnings are missed"),
    "false_at_10": real("1", "share of survivors that raise the alarm where 10 % of the overturnings are missed"),
}

#: Variables of each table of the report.
TABLES: dict[str, Declared] = {
    name: along(("row",), table)
    for name, table in {
        "work_precision": _WORK_PRECISION,
        "synthetic_grid": _SYNTHETIC_GRID,
        "answers": _ANSWERS,
        "convergence": _CONVERGENCE,
        "bodies": _BODIES,
        "model_form": _MODEL_FORM,
        "classifiers": _CLASSIFIERS,
        "failures": FAILURE,
    }.items()
}
