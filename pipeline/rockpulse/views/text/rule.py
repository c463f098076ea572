"""The verdicts of the rule as text, and the fitted rule as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pandas as pd

from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import fixed, paragraph
from rockpulse.views.text.left_out import unused

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.calibration.rule import Rule

__all__ = ["rule_overview", "rule_text"]

#: What the scores are called.
NAMES = {"march": "rule", "velocity_ratio": "p PGV/(g tan a)", "velocity_alone": "p PGV, no cap"}

#: The order of the rows, by point, kind and score.
_ORDER = ("balanced", "conservative", "in-sample", "left-out", "as-given", *NAMES)


def rule_overview(tree: xr.DataTree) -> str:
    """The tables of :func:`rockpulse.studies.rule.judgement.judge_rules`, or the statement that there is none."""
    files = unused(files_used(tree).line)
    if tree.attrs["statement"]:
        return "\n".join(filter(None, (files, paragraph(f"no verdict on the rule: {tree.attrs['statement']}"))))
    rates, at, areas = (tree[name].to_dataset().to_dataframe() for name in ("rates", "at_missed", "areas"))
    fallen, stood = int(rates["overturnings"].iloc[0]), int(rates["survivors"].iloc[0])
    head = (
        f"{tree.attrs['channels']} channels of {tree.attrs['earthquakes']} earthquakes: {fallen} of {fallen + stood} "
        f"cases overturn by the nonlinear model. Rule as given: {tree.attrs['rule']}. Shares in %, 95 % intervals with "
        "earthquakes resampled and limits refitted; [..] bound of the missed share: cases independent, earthquakes "
        "resampled. p PGV raises alarms where uplift is possible, as the rule does; no cap: everywhere."
    )
    ordered = rates.sort_values(["point", "kind", "score"], key=lambda values: values.map(_ORDER.index))
    rows: list[Any] = list(ordered.itertuples())
    margins = [
        f"{row.point}, {row.kind}: false of the rule less that of {NAMES[row.score]} {_percent(row.false_difference)} "
        f"({_percent(row.false_difference_low)} to {_percent(row.false_difference_high)})"
        for row in rows
        if row.kind != "as-given" and row.score != "march"
    ]
    surfaces = [
        f"area under the curve, {row.kind}: rule {row.march:.3f}, {NAMES['velocity_ratio']} {row.velocity_ratio:.3f} "
        f"({NAMES['velocity_alone']} {row.velocity_alone:.3f}), difference "
        f"{row.difference_low:+.3f} to {row.difference_high:+.3f}"
        for row in areas.itertuples()
    ]
    perturbed = [
        f"{row.point}, {row.kind}, {NAMES[row.score]}: missed {_percent(row.missed_least)} to "
        f"{_percent(row.missed_most)} %, false {_percent(row.false_least)} to {_percent(row.false_most)} %"
        for row in rows
        if row.kind != "in-sample" and row.score != "velocity_alone"
    ]
    truth = "Over perturbed truths (record and restitution by 0.1 %, ends of the record otherwise filtered):"
    compared = ["False alarms at a missed share:", *lines(_compared(at))]
    parts = [
        [*filter(None, [files]), paragraph(head)],
        lines(_verdicts(rows)),
        margins,
        compared,
        surfaces,
        [truth, *perturbed],
    ]
    return "\n\n".join("\n".join(part) for part in parts)


def _verdicts(rows: list[Any]) -> Table:
    """Missed and false verdicts of every point, score and kind of limit."""
    heads = ("point", "score", "limit", "missed", "interval", "[95 % bound]", "false", "interval", "peak bias", "disp.")
    cells = tuple(
        (
            Cell(row.point),
            Cell(NAMES[row.score]),
            Cell(row.kind),
            Cell(f"{row.missed} = {_percent(row.missed_share)}", row.missed),
            Cell(f"{_percent(row.missed_low)}-{_percent(row.missed_high)}", row.missed_low),
            Cell(f"[{_percent(row.missed_bound)}, {_percent(row.missed_bound_clustered)}]", row.missed_bound),
            Cell(f"{row.false} = {_percent(row.false_share)}", row.false),
            Cell(f"{_percent(row.false_low)}-{_percent(row.false_high)}", row.false_low),
            number(row.peak_bias, fixed),
            number(row.peak_dispersion, fixed),
        )
        for row in rows
    )
    return Table("rule-verdicts", "", tuple(map(Heading, heads)), cells)


def _compared(at: pd.DataFrame) -> Table:
    """False alarms of the scores at the same share of missed overturnings."""
    others = {"velocity_ratio": "difference", "velocity_alone": "difference_alone"}
    heads = [head for name in others for head in (NAMES[name], "difference", "95 % interval")]
    rows = []
    for row in at.to_dict("records"):
        cells = [Cell(row["kind"]), number(row["missed_share"], _percent), number(row["march"], _percent)]
        for name, less in others.items():
            low, high = row[f"{less}_low"], row[f"{less}_high"]
            cells += [number(row[name], _percent), number(row[less], _percent)]
            cells.append(Cell(f"{_percent(low)} to {_percent(high)}", low))
        rows.append(tuple(cells))
    return Table("rule-compared", "", tuple(map(Heading, ("scores", "missed", "false: rule", *heads))), tuple(rows))


def _percent(value: float) -> str:
    return fixed(100.0 * value, 1)


def rule_text(rules: Mapping[str, Rule], tree: xr.DataTree, provenance: Mapping[str, Any]) -> str:
    """Fitted rules of one range as TOML, by working point, with their provenance and how they did on their cases."""
    rates = tree["rates"].to_dataset().to_dataframe().set_index(["score", "kind", "point"])
    lines = [
        "# The rule of rockpulse.calibration.rule: demand = factor x march, an overturning at 1 and above.",
        "# Written by `rockpulse rule fit`; missed and false shares against the nonlinear model.",
        "",
        "[provenance]",
        *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in provenance.items()),
    ]
    within = next(iter(rules.values())).within
    lines += ["", "[range]", *(f"{name} = [{least:.6g}, {most:.6g}]" for name, (least, most) in within.items())]
    for point, rule in rules.items():
        lines += ["", f"[{point}]", f"factor = {rule.factor:.6g}"]
        for kind in ("in-sample", "left-out"):
            row: Any = rates.loc[pd.IndexSlice["march", kind, point], :]
            name = kind.replace("-", "_")
            lines += [f"{name}_missed = {row.missed_share:.4f}", f"{name}_false = {row.false_share:.4f}"]
    return "\n".join(lines) + "\n"
