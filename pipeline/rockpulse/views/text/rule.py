"""The verdicts of the rule as text, and the fitted rule as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rockpulse.sequences.rule import POINTS
from rockpulse.studies.rule.judgement import LIMIT
from rockpulse.studies.rule.measures import MEASURES
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import fixed, paragraph
from rockpulse.views.text.left_out import unused

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from rockpulse.sequences.rule import Rule

__all__ = ["rule_overview", "rule_text"]

#: What the capacities are called.
TARGETS = {"capacity_mean": "mean capacity", "factor_10": "factor of 10 %"}

#: What the scores are called.
NAMES = MEASURES | {LIMIT: "the limit: P, nonlinear"}


def rule_overview(tree: xr.DataTree) -> str:
    """The tables of :func:`rockpulse.studies.rule.judgement.judge_rules`, or the statement that there is none."""
    files = unused(files_used(tree).line)
    if tree.attrs["statement"]:
        return "\n".join(filter(None, (files, paragraph(f"no verdict on the rule: {tree.attrs['statement']}"))))
    capacities, rates, at_missed = (
        tree[name].to_dataset().to_dataframe() for name in ("capacities", "rates", "at_missed")
    )
    fallen, stood = int(rates["overturnings"].iloc[0]), int(rates["survivors"].iloc[0])
    head = (
        f"{tree.attrs['channels']} channels of {tree.attrs['earthquakes']} earthquakes on twelve bodies, against the "
        "nonlinear equation with 10 % on the factor, C times U(0.9, 1), alpha less 5 % |N|. Rule as given: "
        f"{tree.attrs['rule']}. Each measure has one coefficient, fitted without the earthquake that it is judged on. "
        "Intervals: 95 %, earthquakes resampled."
    )
    parts = [[*filter(None, [files]), paragraph(head)]]
    for target, words in TARGETS.items():
        rows = capacities[capacities["target"] == target]
        share = _percent(float(rows["censored_share"].iloc[0]))
        told = f"Against the {words} ({int(rows['reached'].iloc[0])} reached by a factor of 10, {share} % not):"
        parts.append([told, *lines(_capacities(rows))])
    told = f"Verdicts at factors of 0.5 and 1, where {fallen} of {fallen + stood} cases overturn, in %:"
    parts += [[told, *lines(_rates(rates))], ["False alarms in % at a missed share:", *lines(_at_missed(at_missed))]]
    return "\n\n".join("\n".join(part) for part in parts)


def _capacities(rows: pd.DataFrame) -> Table:
    heads = ("measure", "coefficient", "times", "bias", "interval", "log-dispersion", "within a body", "interval")
    cells = tuple(
        (
            Cell(NAMES[row.measure]),
            Cell(row.kind),
            number(row.coefficient, fixed),
            number(row.bias, fixed),
            Cell(f"{fixed(row.bias_low)}-{fixed(row.bias_high)}", row.bias_low),
            number(row.dispersion, _three),
            number(row.within, _three),
            Cell(f"{_three(row.within_low)}-{_three(row.within_high)}", row.within_low),
        )
        for row in _tuples(rows)
    )
    return Table("rule-capacities", "", tuple(map(Heading, heads)), cells)


def _rates(rates: pd.DataFrame) -> Table:
    heads = ("verdict", "coefficient", "missed", "interval", "false", "interval")
    cells = tuple(
        (
            Cell(row.point or NAMES[row.score]),
            Cell(row.kind),
            Cell(f"{row.missed} = {_percent(row.missed_share)}", row.missed),
            Cell(f"{_percent(row.missed_low)}-{_percent(row.missed_high)}", row.missed_low),
            Cell(f"{row.false} = {_percent(row.false_share)}", row.false),
            Cell(f"{_percent(row.false_low)}-{_percent(row.false_high)}", row.false_low),
        )
        for row in _tuples(rates)
    )
    return Table("rule-verdicts", "", tuple(map(Heading, heads)), cells)


def _at_missed(at_missed: pd.DataFrame) -> Table:
    shares = sorted(at_missed["missed_share"].unique())
    heads = ["score", *(words for share in shares for words in (f"at {_percent(share)}", "interval"))]
    cells = []
    for score, rows in at_missed.groupby("score", sort=False):
        row = [Cell(NAMES[str(score)])]
        for one in _tuples(rows.sort_values("missed_share")):
            row.append(number(one.false_share, _percent))
            row.append(Cell(f"{_percent(one.false_low)}-{_percent(one.false_high)}", one.false_low))
        cells.append(tuple(row))
    return Table("rule-compared", "", tuple(map(Heading, heads)), tuple(cells))


def _tuples(rows: pd.DataFrame) -> list[Any]:
    return list(rows.itertuples())


def _percent(value: float) -> str:
    return fixed(100.0 * value, 1)


def _three(value: float) -> str:
    return fixed(value, 3)


def rule_text(rules: Mapping[str, Rule], tree: xr.DataTree, provenance: Mapping[str, Any]) -> str:
    """Fitted rules of one range as TOML, by working point, with their provenance and how they did on their cases."""
    capacities = tree["capacities"].to_dataset().to_dataframe().set_index(["measure", "target", "kind"])
    measured: dict[Any, Any] = capacities.to_dict("index")
    lines = [
        "# The rule of rockpulse.sequences.rule: demand = factor x march, an overturning at 1 and above.",
        "# Written by `rockpulse rule fit`; bias and log-dispersion of 1/demand against the nonlinear capacity, on",
        "# earthquakes left out.",
        "",
        "[provenance]",
        *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in provenance.items()),
    ]
    within = next(iter(rules.values())).within
    lines += ["", "[range]", *(f"{name} = [{least:.6g}, {most:.6g}]" for name, (least, most) in within.items())]
    for point, rule in rules.items():
        measure, target = POINTS[point]
        row = measured[measure, target, "left-out"]
        lines += ["", f"[{point}]", f"factor = {rule.factor:.6g}", f"target = {json.dumps(target)}"]
        lines += [f"{name} = {row[name]:.4f}" for name in ("bias", "dispersion", "within", "within_low", "within_high")]
    return "\n".join(lines) + "\n"
