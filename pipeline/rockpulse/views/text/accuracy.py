"""The accuracy report as text: error and cost side by side, then the models by demand level."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rockpulse.studies.accuracy.measurement import table_of
from rockpulse.views.shared.table import Cell, Heading, Table, number, text
from rockpulse.views.shared.terminal import ABSENT, fixed, paragraph, ratio, share

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = [
    "accuracy_overview",
    "bodies_text",
    "convergence_text",
    "grid_text",
    "model_form_text",
    "work_precision_text",
]

#: Bias and dispersion of fewer survivors say nothing about an ensemble.
FEWEST_SURVIVORS = 5

DEMAND_NAMES = {
    "velocity_ratio": "p PGV/(g tan alpha)",
    "uplift_ratio": "PGA/(g tan alpha)",
    "impulse_ratio": "largest half-wave/I_1c",
}


def accuracy_overview(tree: xr.DataTree) -> str:
    """All tables of the tree of :func:`rockpulse.studies.accuracy.measurement.accuracy`."""
    parts = [
        work_precision_text(table_of(tree, "work_precision")),
        grid_text(table_of(tree, "synthetic_grid")),
        convergence_text(table_of(tree, "convergence")),
        *([bodies_text(table_of(tree, "bodies"))] if "bodies" in tree.children else []),
        model_form_text(table_of(tree, "model_form"), table_of(tree, "classifiers")),
    ]
    return "\n\n".join(parts)


def work_precision_text(rows: pd.DataFrame) -> str:
    """Error and cost of the solvers, of the table /work_precision, one line each, by equation."""
    heads = ("cases", "flips", "median", "p90", "p99", "max", "p99 well", "ns/active", "ns/nominal", "x RK45 *")
    parts = ["Solvers: error of theta_max/alpha_c against the reference, and cost"]
    for equation, members in rows.groupby("equation", sort=False):
        cells = tuple(
            (
                Cell(_solver(row)),
                number(row.cases, str),
                number(row.flips, str),
                *(number(value, error) for value in (row.median, row.p90, row.p99, row.max, row.p99_well)),
                *(number(value, cost) for value in (row.ns_per_active_sample, row.ns_per_sample, row.times_faster)),
            )
            for row in _rows(members)
        )
        first = members.iloc[0]
        note = f"well conditioned: {100.0 * first['well_conditioned']:.1f} % of {first['cases']} cases"
        parts.append(_text("", (str(equation), *heads), cells, note))
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
    return "\n\n".join([*parts, "\n".join(paragraph(note, "  ") for note in (notes, footnote))])


def grid_text(rows: pd.DataFrame) -> str:
    """The kernels at the default step on the grid of one restitution (/synthetic_grid), beside the reference."""
    heads = ("equation", "cases", "median", "p99", "flips", "reference p99", "reference flips")
    cells = tuple(
        (
            Cell(f"{row.equation}, C = {row.restitution:g}, step {row.step:g}"),
            number(row.cases, str),
            number(row.median, error),
            number(row.p99, error),
            number(row.flips, str),
            number(row.reference_p99, error),
            number(row.reference_flips, str),
        )
        for row in _rows(rows)
    )
    return _text("rockpulse on the synthetic grid; reference: what a change of 1e-13 does to it", heads, cells)


def convergence_text(rows: pd.DataFrame) -> str:
    """Order of convergence of the nonlinear kernel, of the table /convergence."""
    cells = tuple(
        (
            Cell(f"{row.step:.3f}"),
            number(row.median, error),
            number(row.p90, error),
            number(row.ns_per_active_sample, cost),
            number(row.order, fixed),
            number(row.order_cases, str),
        )
        for row in _rows(rows)
    )
    title = (
        f"Convergence of the nonlinear kernel: {rows['cases'].iloc[0]} cases on records of 10 Hz, p dt = 0.3, without "
        "the control of the last term"
    )
    return _text(title, ("step p dt", "median", "p90", "ns/active", "order", "from cases"), cells)


def bodies_text(rows: pd.DataFrame) -> str:
    """What shorter steps change in the answers of each kind of body, and its cost, of the table /bodies."""
    cells = tuple(
        (
            Cell(row.kind),
            number(row.cases, str),
            number(row.flips, str),
            *(number(value, error) for value in (row.median, row.p99, row.max, row.max_perturbed)),
            number(row.ns_per_active_sample, cost),
            number(row.times_plain, cost),
        )
        for row in _rows(rows)
    )
    title = (
        "Bodies by kind: change of theta_max/alpha_c on samples divided in four and by 1e-13 of the record, and cost"
    )
    heads = ("nonlinear", "cases", "flips", "median", "p99", "max", "by 1e-13", "ns/active", "x free")
    return _text(title, heads, cells)


def model_form_text(rows: pd.DataFrame, classifiers: pd.DataFrame) -> str:
    """Errors of the cheap models (/model_form), and single numbers as classifiers (/classifiers) beside them."""
    parts = ["Models against the nonlinear response to the record"]
    for ensemble, members in rows.groupby("ensemble", sort=False):
        levels = members[["demand_low", "demand_high"]].drop_duplicates()
        whole = members.iloc[0]
        stood = whole["lanes"] - whole["overturn"]
        first = members[members["model"] == whole["model"]]
        cells = [_line(name, first[name], str) for name in ("lanes", "overturn")]
        for model, its in members.groupby("model", sort=False):
            cells.append((Cell(str(model)), *(Cell("") for _ in range(len(levels)))))
            cells += [_line(name, its[name], str) for name in ("missed", "false", "survivors")]
            if its["at_rest"].any():
                cells.append(_line("at rest", its["at_rest"], str))
            enough = its["survivors"] - its["at_rest"] >= FEWEST_SURVIVORS
            cells += [_line(name, its[name].where(enough), ratio) for name in ("bias", "dispersion")]
            if its["unresolved"].any():
                cells.append(_line("unresolved", its["unresolved"], str))
        parts.append(f"  {ensemble}: {whole['lanes']} lanes, {whole['overturn']} overturn, {stood} do not")
        heads = ("demand p PGV/(g tan alpha)", *(_level(row) for row in _rows(levels)))
        parts.append(_text("", heads, tuple(cells)))
        told = tuple(
            (
                Cell(DEMAND_NAMES[row.demand]),
                number(row.auc, lambda value: fixed(value, 3)),
                *(number(value, share) for value in (row.false_at_0, row.false_at_5, row.false_at_10)),
            )
            for row in _rows(classifiers[classifiers["ensemble"] == ensemble])
        )
        heads = ("as a classifier of the verdict", "AUC", "false at 0 % missed", "5 %", "10 %")
        parts.append(_text("", heads, told))
    notes = (
        "missed: overturns by the nonlinear model only; false: by the other one only. survivors: lanes that survive in "
        "both with a nonlinear peak above 0.05; at rest: those of them that do not move in the other model. bias and "
        "dispersion: median and logarithmic standard deviation of the ratio of peaks over the survivors that move; "
        f"{ABSENT} where there are fewer than {FEWEST_SURVIVORS}. Resonance is an upper-bound type "
        "input, not a prediction."
    )
    return "\n\n".join([*parts, paragraph(notes, "  ")])


def _text(title: str, heads: tuple[str, ...], rows: tuple[tuple[Cell, ...], ...], *notes: str) -> str:
    return text(Table("", title, tuple(map(Heading, heads)), rows, notes))


def _rows(frame: pd.DataFrame) -> list[Any]:
    return list(frame.itertuples())


def _line(name: str, values: pd.Series, show: Callable[[Any], str]) -> tuple[Cell, ...]:
    return Cell(f"  {name}"), *(number(value, show) for value in values)


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
