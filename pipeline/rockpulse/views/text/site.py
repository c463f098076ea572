"""A site file as text: what it cannot tell first, then the parameters, the design sequence and its coverage."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, ratio, shortened
from rockpulse.views.text.left_out import not_used

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["site_overview"]

#: Rows of a table of blocks, and names of events, that are listed one by one.
LISTED = 12

#: Longest name in a table.
NAME_WIDTH = 34

_PARAMETERS = {
    "main": "main impulse I",
    "ratio": "I_s/I",
    "interval": "interval dT",
    "main_count": "main impulses",
    "duration": "duration",
}
_UNITS = {"m s-1": "m/s", "s": "s", "1": ""}


def site_overview(tree: xr.DataTree) -> str:
    """Remarks, parameters, correlation, design sequence, coverage, and what was left out.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.calibrate_site` returns it.
    """
    site = tree["site"].to_dataset()
    parts = [_remarks(site), _records(site), _parameters(site), _correlation(site), _design(site), _coverage(site)]
    parts += [_warnings(site), not_used(tree)]
    return "\n\n".join(part for part in parts if part)


def _number(site: xr.Dataset, name: str) -> float:
    return float(site[name])


def _remarks(site: xr.Dataset) -> str:
    remarks = [line for line in str(site["remarks"].item()).splitlines() if line]
    return "\n".join(paragraph(line, "  ", "! ") for line in remarks)


def _scaled(words: str) -> str:
    """Measure and value, with the unit that the target has."""
    return f"{words} {'m/s2' if words.startswith('pga') else 'm/s'}"


def _records(site: xr.Dataset) -> str:
    counts = dict(zip(site["site_event"].values.tolist(), site["event_records"].values.tolist(), strict=True))
    listed = [f"{name} ({count})" for name, count in list(counts.items())[:LISTED]]
    more = f", and {len(counts) - LISTED} more" if len(counts) > LISTED else ""
    attributes = site.attrs
    scaled = "" if attributes["scaled_to"] == "none" else f", scaled to {_scaled(attributes['scaled_to'])}"
    lines = [
        f"{_count(site.sizes['record'], 'record')} of {_count(len(counts), 'event')}: {', '.join(listed)}{more}",
        f"Sequence of each record by {attributes['method']}; weights: {attributes['weights']}{scaled}. Its misfit "
        f"(ln, median over records) is {figure(_median(site['misfit']))}; its rotation is below the recorded one for "
        f"{_percent(_median(site['unsafe_share']))} of the blocks (median).",
    ]
    return "\n".join(paragraph(line, "  ", "") for line in lines)


def _parameters(site: xr.Dataset) -> str:
    level = f"{_number(site, 'confidence'):.0%}"
    rows = [["parameter", "median", level, "dispersion", level, "16", "50", "84 % of records", "design"]]
    for name in site["parameter"].values.tolist():
        one = site.sel(parameter=name)
        unit = _UNITS[str(one["parameter_unit"].item())]
        rows.append(
            [
                f"{_PARAMETERS[name]} [{unit}]" if unit else _PARAMETERS[name],
                figure(_number(one, "median")),
                _range(one, "median"),
                figure(_number(one, "dispersion")),
                _range(one, "dispersion"),
                *(figure(_number(one, f"quantile_{percent}")) for percent in (16, 50, 84)),
                figure(_number(one, "design")),
            ]
        )
    note = f"  Dispersion: of the logarithm. {level}: interval clustered by event; -: not known."
    return "\n".join(["Parameters (lognormal):", *("  " + line for line in aligned(rows)), note])


def _correlation(site: xr.Dataset) -> str:
    names = site["parameter"].values.tolist()
    rows = [["correlation of logarithms", *names[:-1]]]
    for place, name in enumerate(names[1:], start=1):
        found = site["correlation"].values[place, :place].tolist()
        cells = [ABSENT if math.isnan(value) else f"{value:.2f}" for value in found]
        rows.append([name, *cells, *[""] * (len(names) - 1 - place)])
    return "\n".join("  " + line for line in aligned(rows))


def _design(site: xr.Dataset) -> str:
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    count = "main impulses without limit" if math.isnan(value["main_count"]) else f"{value['main_count']:.0f} main"
    within = "for ever" if math.isnan(value["duration"]) else f"within {figure(value['duration'], 's')}"
    main = site.sel(parameter="main")
    words = (
        f"Design sequence, quantile {_number(site, 'quantile'):g} by {site.attrs['design']}: "
        f"I = {figure(value['main'], 'm/s')} ({_number(site, 'confidence'):.0%}: {_range(main, 'design')}), "
        f"I_s = {figure(value['ratio'] * value['main'], 'm/s')}, dT = {figure(value['interval'], 's')}, {count} "
        f'impulses {within}, spacing "{site.attrs["spacing"]}".'
    )
    return paragraph(words, "  ", "")


def _coverage(site: xr.Dataset) -> str:
    lines = [
        _shares(site),
        f"{_percent(_number(site, 'lifted_share'))} of the pairs of record and block count (the record lifts the "
        f"block), {_percent(_number(site, 'standing_share'))} of these on blocks that the design leaves standing.",
    ]
    lines = [paragraph(line, "  ", "") for line in lines]
    shares = site["block_coverage"]
    if site.sizes["block"] <= LISTED:
        rows = [["block", "design", "coverage"]]
        for name in site["block"].values.tolist():
            one = site.sel(block=name)
            peak = _number(one, "design_rotation_ratio")
            verdict = "OVERTURNS" if math.isinf(peak) else ratio(peak)
            rows.append([shortened(name, NAME_WIDTH), verdict, _percent(_number(one, "block_coverage"))])
        lines += ["  " + line for line in aligned(rows)]
        lines.append("  design: theta_max/alpha_c under the design sequence.")
    elif shares.notnull().any():
        worst = str(shares.idxmin().item())
        fallen = int(np.isinf(site["design_rotation_ratio"].values).sum())
        lines.append(
            f"  By block: from {_percent(float(shares.min()))} ({worst}) over {_percent(_median(shares))} (median) to "
            f"{_percent(float(shares.max()))}. The design overturns {fallen} of {site.sizes['block']} blocks."
        )
    return "\n".join(lines)


def _shares(site: xr.Dataset) -> str:
    """What the design covers, in words where it is not known."""
    in_sample, nominal = (_percent(_number(site, name)) for name in ("coverage_in_sample", "quantile"))
    if math.isnan(_number(site, "coverage")):
        why = (
            "with one event none can be left out"
            if site.sizes["site_event"] == 1
            else "no event could be judged by a design that was made without it"
        )
        words = (
            f"Coverage of other earthquakes: not known, for {why}. The design covers {in_sample} of the recorded "
            f"rotations that it was made from, of blocks that it leaves standing; nominal {nominal}."
        )
    else:
        interval = _range(site, "coverage", _percent)
        level = f"{_number(site, 'confidence'):.0%}: {interval}" if interval != ABSENT else "one event: no interval"
        words = (
            f"Coverage: a design made without the event of a record covers {_percent(_number(site, 'coverage'))} "
            f"({level}) of the recorded rotations of the blocks that it leaves standing; nominal {nominal}; the design "
            f"of all records {in_sample}."
        )
    if not math.isnan(_number(site, "coverage_all")):
        words += (
            " With the blocks that it overturns, which are covered whatever the records do: "
            f"{_percent(_number(site, 'coverage_all'))}."
        )
    judged = int(site["judged_pairs"])
    if judged:
        words += (
            f" Judged: {_count(judged, 'pair')} of record and block of {_count(int(site['judged_events']), 'event')}."
        )
    return words


def _warnings(site: xr.Dataset) -> str:
    texts = [str(text) for text in site["warnings"].values]
    warned = [(str(name), text) for name, text in zip(site["record"].values, texts, strict=True) if text]
    if not warned:
        return ""
    lines = [f"records with warnings: {len(warned)} (variable warnings of /site holds all of them)"]
    lines += [paragraph(text.splitlines()[0], "      ", f"  {name}: ") for name, text in warned[:LISTED]]
    return "\n".join(lines)


def _range(one: xr.Dataset, name: str, shown: Callable[[float], str] = figure) -> str:
    low, high = _number(one, f"{name}_lower"), _number(one, f"{name}_upper")
    return ABSENT if math.isnan(low) and math.isnan(high) else f"{shown(low)} to {shown(high)}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _median(values: xr.DataArray) -> float:
    known = values.values[~np.isnan(values.values)]
    return float(np.median(known)) if known.size else math.nan


def _percent(value: float) -> str:
    return ABSENT if math.isnan(value) else f"{100.0 * value:.0f} %"
