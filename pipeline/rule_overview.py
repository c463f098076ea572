"""The verdicts of the rule as text, and the fitted rule as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pandas as pd

from rockpulse.terminal import ABSENT, aligned, paragraph

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["rule_overview", "rule_text"]

#: What the scores are called.
NAMES = {"march": "rule", "velocity_ratio": "p PGV/(g tan a)"}


def _percent(value: float) -> str:
    return ABSENT if pd.isna(value) else f"{100.0 * value:.1f}"


def rule_overview(tree: xr.DataTree) -> str:
    """The tables of a judgement, or the statement that there is none.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.calibration.rule_judgement.judge_rules` returns it.
    """
    if tree.attrs["statement"]:
        return paragraph(f"no verdict on the rule: {tree.attrs['statement']}")
    rates, at, areas = (tree[name].to_dataset().to_dataframe() for name in ("rates", "at_missed", "areas"))
    fallen, stood = int(rates["overturnings"].iloc[0]), int(rates["survivors"].iloc[0])
    head = (
        f"{tree.attrs['channels']} channels of {tree.attrs['earthquakes']} earthquakes: {fallen} of {fallen + stood} "
        f"cases overturn by the nonlinear model. Rule as given: {tree.attrs['rule']}. Shares in %, 95 % intervals with "
        "earthquakes resampled; [..] bound of the missed share: cases independent, earthquakes resampled."
    )
    verdicts = [
        ["point", "score", "limit", "missed", "interval", "[95 % bound]", "false", "interval", "peak bias", "disp."]
    ]
    ordered = rates.sort_values(["point", "kind", "score"], key=lambda values: values.map(_rank))
    row: Any
    for row in ordered.itertuples():
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
    curves = [["scores", "missed", "false: rule", NAMES["velocity_ratio"], "difference", "95 % interval"]]
    for row in at.itertuples():
        curves.append(
            [
                row.kind,
                _percent(row.missed_share),
                _percent(row.march),
                _percent(row.velocity_ratio),
                _percent(row.difference),
                f"{_percent(row.difference_low)} to {_percent(row.difference_high)}",
            ]
        )
    surfaces = [
        f"area under the curve, {row.kind}: rule {row.march:.3f}, {NAMES['velocity_ratio']} {row.velocity_ratio:.3f}, "
        f"difference {row.difference_low:+.3f} to {row.difference_high:+.3f}"
        for row in areas.itertuples()
    ]
    lines = [
        paragraph(head),
        "",
        *aligned(verdicts, left=3),
        "",
        "False alarms at a missed share:",
        *aligned(curves),
        "",
    ]
    return "\n".join([*lines, *surfaces])


def _rank(value: str) -> int:
    order = ("balanced", "conservative", "in-sample", "left-out", "as-given", "march", "velocity_ratio")
    return order.index(value)


def rule_text(factors: Mapping[str, float], tree: xr.DataTree, provenance: Mapping[str, Any]) -> str:
    """A fitted rule as TOML, with what it was fitted on and how it did there.

    Parameters
    ----------
    factors : mapping of str to float
        By working point.
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
    for point, factor in factors.items():
        lines += ["", f"[{point}]", f"factor = {factor:.6g}"]
        for kind in ("in-sample", "left-out"):
            row: Any = rates.loc[pd.IndexSlice["march", kind, point], :]
            name = kind.replace("-", "_")
            lines += [f"{name}_missed = {row.missed_share:.4f}", f"{name}_false = {row.false_share:.4f}"]
    return "\n".join(lines) + "\n"
