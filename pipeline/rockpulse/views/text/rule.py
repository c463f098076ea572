"""The verdicts of the rule as text, and the fitted rule as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pandas as pd

from rockpulse.views.shared.terminal import ABSENT, aligned, paragraph

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.calibration.rule import Rule

__all__ = ["rule_overview", "rule_text"]

#: What the scores are called.
NAMES = {"march": "rule", "velocity_ratio": "p PGV/(g tan a)", "velocity_alone": "p PGV, no cap"}


def _percent(value: float) -> str:
    return ABSENT if pd.isna(value) else f"{100.0 * value:.1f}"


def rule_overview(tree: xr.DataTree) -> str:
    """The tables of a judgement, or the statement that there is none.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.studies.rule.judgement.judge_rules` returns it.
    """
    if tree.attrs["statement"]:
        return paragraph(f"no verdict on the rule: {tree.attrs['statement']}")
    rates, at, areas = (tree[name].to_dataset().to_dataframe() for name in ("rates", "at_missed", "areas"))
    fallen, stood = int(rates["overturnings"].iloc[0]), int(rates["survivors"].iloc[0])
    head = (
        f"{tree.attrs['channels']} channels of {tree.attrs['earthquakes']} earthquakes: {fallen} of {fallen + stood} "
        f"cases overturn by the nonlinear model. Rule as given: {tree.attrs['rule']}. Shares in %, 95 % intervals with "
        "earthquakes resampled and limits refitted; [..] bound of the missed share: cases independent, earthquakes "
        "resampled. p PGV raises alarms where uplift is possible, as the rule does; no cap: everywhere."
    )
    verdicts = [
        ["point", "score", "limit", "missed", "interval", "[95 % bound]", "false", "interval", "peak bias", "disp."]
    ]
    ordered = rates.sort_values(["point", "kind", "score"], key=lambda values: values.map(_rank))
    rows: list[Any] = list(ordered.itertuples())
    compared: list[Any] = list(at.itertuples())
    for row in rows:
        verdicts.append(
            [
                row.point,
                NAMES[row.score],
                row.kind,
                f"{row.missed} = {_percent(row.missed_share)}",
                f"{_percent(row.missed_low)}-{_percent(row.missed_high)}",
                f"[{_percent(row.missed_bound)}, {_percent(row.missed_bound_clustered)}]",
                f"{row.false} = {_percent(row.false_share)}",
                f"{_percent(row.false_low)}-{_percent(row.false_high)}",
                ABSENT if pd.isna(row.peak_bias) else f"{row.peak_bias:.2f}",
                ABSENT if pd.isna(row.peak_dispersion) else f"{row.peak_dispersion:.2f}",
            ]
        )
    curves = [
        [
            "scores",
            "missed",
            "false: rule",
            NAMES["velocity_ratio"],
            "difference",
            "95 % interval",
            NAMES["velocity_alone"],
            "difference",
            "95 % interval",
        ]
    ]
    for row in compared:
        curves.append(
            [
                row.kind,
                _percent(row.missed_share),
                _percent(row.march),
                _percent(row.velocity_ratio),
                _percent(row.difference),
                f"{_percent(row.difference_low)} to {_percent(row.difference_high)}",
                _percent(row.velocity_alone),
                _percent(row.difference_alone),
                f"{_percent(row.difference_alone_low)} to {_percent(row.difference_alone_high)}",
            ]
        )
    perturbed = [
        f"{row.point}, {row.kind}, {NAMES[row.score]}: missed {_percent(row.missed_least)} to "
        f"{_percent(row.missed_most)} %, false {_percent(row.false_least)} to {_percent(row.false_most)} %"
        for row in rows
        if row.kind != "in-sample" and row.score != "velocity_alone"
    ]
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
    lines = [
        paragraph(head),
        "",
        *aligned(verdicts, left=3),
        "",
        *margins,
        "",
        "False alarms at a missed share:",
        *aligned(curves),
        "",
    ]
    truth = "Over perturbed truths (record and restitution by 0.1 %, ends of the record otherwise filtered):"
    return "\n".join([*lines, *surfaces, "", truth, *perturbed])


def _rank(value: str) -> int:
    order = (
        "balanced",
        "conservative",
        "in-sample",
        "left-out",
        "as-given",
        "march",
        "velocity_ratio",
        "velocity_alone",
    )
    return order.index(value)


def rule_text(rules: Mapping[str, Rule], tree: xr.DataTree, provenance: Mapping[str, Any]) -> str:
    """A fitted rule as TOML, with what it was fitted on and how it did there.

    Parameters
    ----------
    rules : mapping of str to Rule
        By working point; all of one range.
    tree : xarray.DataTree
        The judgement on the same cases.
    provenance : mapping
        Where it comes from; numbers, texts and lists of texts.
    """
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
