"""The accuracy report as text: error and cost side by side, then the models by demand level."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rockpulse.studies.accuracy.measurement import table_of
from rockpulse.views.shared.terminal import ABSENT, aligned, paragraph, ratio

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["accuracy_overview", "convergence_text", "grid_text", "model_form_text", "work_precision_text"]

#: Bias and dispersion of fewer survivors say nothing about an ensemble.
FEWEST_SURVIVORS = 5

DEMAND_NAMES = {
    "velocity_ratio": "p PGV/(g tan alpha)",
    "uplift_ratio": "PGA/(g tan alpha)",
    "impulse_ratio": "largest half-wave/I_1c",
}


def accuracy_overview(tree: xr.DataTree) -> str:
    """All tables of a report.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.studies.accuracy.measurement.accuracy` returns it.
    """
    parts = [
        work_precision_text(table_of(tree, "work_precision")),
        grid_text(table_of(tree, "synthetic_grid")),
        convergence_text(table_of(tree, "convergence")),
        model_form_text(table_of(tree, "model_form"), table_of(tree, "classifiers")),
    ]
    return "\n\n".join(parts)


def work_precision_text(rows: pd.DataFrame) -> str:
    """Error and cost of the solvers, one line each, by equation.

    Parameters
    ----------
    rows : DataFrame
        The table /work_precision.
    """
    head = ("cases", "flips", "median", "p90", "p99", "max", "p99 well", "ns/active", "ns/nominal", "x RK45 *")
    lines = ["Solvers: error of theta_max/alpha_c against the reference, and cost"]
    for equation, members in rows.groupby("equation", sort=False):
        cells: list[tuple[str, ...]] = [(str(equation), *head)]
        row: Any
        for row in members.itertuples():
            cells.append(
                (
                    _solver(row),
                    f"{row.cases}",
                    f"{row.flips}",
                    *(error(value) for value in (row.median, row.p90, row.p99, row.max, row.p99_well)),
                    cost(row.ns_per_active_sample),
                    cost(row.ns_per_sample),
                    cost(row.times_faster),
                )
            )
        lines += ["", *(f"  {line}" for line in aligned(cells))]
        first = members.iloc[0]
        lines.append(f"  well conditioned: {100.0 * first['well_conditioned']:.1f} % of {first['cases']} cases")
    notes = (
        "flips: verdicts other than the reference's. Errors: cases that both call surviving; well: those that move by "
        "less than 1e-10 when C or the record changes by 1e-13 (first line: what that change does to the reference). "
        "ns/active: per sample in which a block moves; ns/nominal: per block and sample. Steps longer than a sample "
        "change nothing. One thread. single: solve_ivp's own cases, one call each, the cost of the call included; the "
        "other lines of rockpulse: all blocks and factors of a motion in a call."
    )
    footnote = (
        "* x RK45: how many times less an active sample costs than with solve_ivp RK45 at rtol 1e-6. Like for like are "
        "only the lines of solve_ivp and those marked single: the others of rockpulse are timed on more cases."
    )
    return "\n".join([*lines, "", paragraph(notes, "  "), paragraph(footnote, "  ")])


def grid_text(rows: pd.DataFrame) -> str:
    """The kernels at the default step on the synthetic grid of one restitution, the reference's own moves beside them.

    Parameters
    ----------
    rows : DataFrame
        The table /synthetic_grid.
    """
    cells = [("equation", "cases", "median", "p99", "flips", "reference p99", "reference flips")]
    row: Any
    for row in rows.itertuples():
        cells.append(
            (
                f"{row.equation}, C = {row.restitution:g}, step {row.step:g}",
                f"{row.cases}",
                error(row.median),
                error(row.p99),
                f"{row.flips}",
                error(row.reference_p99),
                f"{row.reference_flips}",
            )
        )
    title = "rockpulse on the synthetic grid; reference: what a change of 1e-13 does to it"
    return "\n".join([title, "", *(f"  {line}" for line in aligned(cells))])


def convergence_text(rows: pd.DataFrame) -> str:
    """Order of convergence of the nonlinear kernel.

    Parameters
    ----------
    rows : DataFrame
        The table /convergence.
    """
    cells = [("step p dt", "median", "p90", "ns/active", "order", "from cases")]
    row: Any
    for row in rows.itertuples():
        order = ABSENT if math.isnan(row.order) else f"{row.order:.2f}"
        cells.append(
            (
                f"{row.step:.3f}",
                error(row.median),
                error(row.p90),
                cost(row.ns_per_active_sample),
                order,
                f"{row.order_cases}",
            )
        )
    title = (
        f"Convergence of the nonlinear kernel: {rows['cases'].iloc[0]} cases on records of 10 Hz, p dt = 0.3, without "
        "the control of the last term"
    )
    return "\n".join([title, "", *(f"  {line}" for line in aligned(cells))])


def model_form_text(rows: pd.DataFrame, classifiers: pd.DataFrame) -> str:
    """Model-form error of the cheap models, and single numbers as classifiers beside them.

    Parameters
    ----------
    rows, classifiers : DataFrame
        The tables /model_form and /classifiers.
    """
    lines = ["Models against the nonlinear response to the record"]
    for ensemble, members in rows.groupby("ensemble", sort=False):
        levels = members[["demand_low", "demand_high"]].drop_duplicates()
        whole = members.iloc[0]
        stood = whole["lanes"] - whole["overturn"]
        cells = [("demand p PGV/(g tan alpha)", *(_level(row) for row in levels.itertuples()))]
        for label, column in (("  lanes", "lanes"), ("  overturn", "overturn")):
            first = members[members["model"] == whole["model"]]
            cells.append((label, *(f"{value}" for value in first[column])))
        for model, its in members.groupby("model", sort=False):
            cells.append((str(model), *("" for _ in range(len(levels)))))
            cells.append(("  missed", *(f"{value}" for value in its["missed"])))
            cells.append(("  false", *(f"{value}" for value in its["false"])))
            cells.append(("  survivors", *(f"{value}" for value in its["survivors"])))
            if its["at_rest"].any():
                cells.append(("  at rest", *(f"{value}" for value in its["at_rest"])))
            enough = its["survivors"] - its["at_rest"] >= FEWEST_SURVIVORS
            for name in ("bias", "dispersion"):
                cells.append((f"  {name}", *(ratio(value) for value in its[name].where(enough))))
            if its["unresolved"].any():
                cells.append(("  unresolved", *(f"{value}" for value in its["unresolved"])))
        lines += ["", f"  {ensemble}: {whole['lanes']} lanes, {whole['overturn']} overturn, {stood} do not", ""]
        lines += [f"  {line}" for line in aligned(cells)]
        cells = [("as a classifier of the verdict", "AUC", "false at 0 % missed", "5 %", "10 %")]
        row: Any
        for row in classifiers[classifiers["ensemble"] == ensemble].itertuples():
            shares = (row.false_at_0, row.false_at_5, row.false_at_10)
            cells.append((DEMAND_NAMES[row.demand], ratio3(row.auc), *(percent(share) for share in shares)))
        lines += ["", *(f"  {line}" for line in aligned(cells))]
    notes = (
        "missed: overturns by the nonlinear model only; false: by the other one only. survivors: lanes that survive in "
        "both with a nonlinear peak above 0.05; at rest: those of them that do not move in the other model. bias and "
        "dispersion: median and logarithmic standard deviation of the ratio of peaks over the survivors that move; "
        f"{ABSENT} where there are fewer than {FEWEST_SURVIVORS}. Resonance is an upper-bound type "
        "input, not a prediction."
    )
    return "\n".join([*lines, "", paragraph(notes, "  ")])


def short(value: float) -> str:
    """A power of ten without needless zeros.

    Examples
    --------
    >>> short(1e-6)
    '1e-6'
    """
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def error(value: float) -> str:
    """An error with two digits.

    Examples
    --------
    >>> error(4.16e-17), error(float("nan")), error(0.0)
    ('4.2e-17', '-', '0')
    """
    if math.isnan(value):
        return ABSENT
    return f"{value:.1e}" if value else "0"


def cost(value: float) -> str:
    """A cost or a ratio of costs with three digits.

    Examples
    --------
    >>> cost(41.236), cost(187654.0), cost(float("nan"))
    ('41.2', '188,000', '-')
    """
    if math.isnan(value):
        return ABSENT
    return f"{float(f'{value:.3g}'):,.{0 if value >= 100.0 else 1 if value >= 10.0 else 2}f}"


def ratio3(value: float) -> str:
    """A share of one with three decimals."""
    return ABSENT if math.isnan(value) else f"{value:.3f}"


def percent(share: float) -> str:
    """A share in whole percent."""
    return ABSENT if math.isnan(share) else f"{100.0 * share:.0f} %"


def _solver(row: Any) -> str:
    if row.method == "reference":
        return f"reference, input changed by {short(row.setting)}"
    if row.method == "rockpulse":
        return f"rockpulse, step {row.setting:g}{', single' if row.call == 'single' else ''}"
    return f"solve_ivp {row.method}, rtol {short(row.setting)}"


def _level(row: Any) -> str:
    if math.isinf(row.demand_high):
        return "all" if row.demand_low == 0.0 else f">= {row.demand_low:g}"
    return f"{row.demand_low:g}-{row.demand_high:g}"
