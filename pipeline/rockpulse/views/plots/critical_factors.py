"""Pictures of the scale factors at which bodies overturn: all intervals, or the smallest of each record."""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rockpulse.assessment.answers import fullest_model
from rockpulse.errors import ResultsError
from rockpulse.model_table import SEQUENCE_MODELS, SearchSettings, is_full, is_upper_bound
from rockpulse.views.plots import factor_rows, style
from rockpulse.views.plots.selection import chosen_case, named_body, one_name, settings_of, table_of_pair
from rockpulse.views.plots.style import BLACK, GREEN, GREY, RED, SMALL
from rockpulse.views.shared.formatting import six_digits
from rockpulse.views.shared.verdict_table import factor_name
from rockpulse.views.shared.words import listed, numerals, say, translated

#: Style of a gap between two intervals of overturning, in which the body survives: hatched, or light grey if narrow.
_AGAIN: dict[str, Any] = {"fc": "#BBDDF3", "ec": BLACK, "lw": 0.0, "hatch": "////", "hatch_linewidth": 0.6}
#: Styles of an interval of overturning, and of an interval without a result.
_OVERTURNS: dict[str, Any] = {"fc": RED, "ec": RED}
_UNKNOWN: dict[str, Any] = {"fc": "white", "ec": GREY, "hatch": "xxxx"}
#: Smallest drawn width of an interval of overturning [pt], so that narrow intervals remain visible.
_THINNEST = 1.0
#: Left end of the axis divided by the smallest factor, and position of the mark of each model in a row without a factor
#: divided by the upper limit of the search.
_BELOW, _NONE = 0.7, 1.09
_SEARCH = "assess again with the model in [search] models and with [search] intervals = true"


def overturning_map(
    tree: xr.DataTree,
    record: str | None = None,
    block: str | None = None,
    models: Sequence[str] | None = None,
    axes: Axes | None = None,
    most: int = factor_rows.ROWS,
) -> Axes:
    """Draw the intervals of scale factors in which bodies overturn, and the intervals in which they survive.

    If intervals of overturning were not searched, the scale factors at P = 10 % and P = 50 % are drawn. Rows without a
    scale factor are merged into one row that shows their number. A line marks a scale factor of 1, and a tick the scale
    factor of each demand. With `record` there is a row per body (and restitution), with `block` a row per record; the
    model is the most complete one by default.
    """
    summary = tree["summary"].to_dataset()
    if models is not None and len(models) != 1:
        raise ResultsError(f"overturning-map: expected one model, got {', '.join(models)}")
    model = fullest_model(summary) if models is None else one_name(summary, "model", models[0])
    blocks, records = ([str(name) for name in summary[one].values] for one in ("block", "record"))
    blocks = blocks if block is None else [one_name(summary, "block", block)]
    records = records if block is not None and record is None else [one_name(summary, "record", record)]
    rows = list(product(records, blocks, range(1, summary.sizes.get("case", 1) + 1)))
    searched = not is_full(model) or bool(summary["safety_factor"].sel(model=model).notnull().any())
    name = "safety_factor" if searched else "factor_10"
    wanted = (name, "factor_resolved", "search_step", "applicable", "factor_50", "factor_10_low", "factor_10_high")
    own, unknown = summary.sel(record=records, block=blocks, model=model), np.full(len(rows), np.nan)
    factors, resolved, steps, inside, half, *ends = (
        own[one].transpose("record", "block", ...).values.ravel().astype(float) if one in own else unknown
        for one in wanted
    )
    if np.all(np.isnan(factors)):
        raise ResultsError(f"{model}: no scale factors in these results; {_SEARCH}")
    kept, merged, names, notes = factor_rows.drawn_rows(summary, rows, factors, most)
    outside = [body for (_, body, _), within in zip(rows, inside, strict=True) if within == 0]
    end = settings_of(tree, SearchSettings).factor_max
    asked = factor_rows.factors_to_demands(summary, [one for one, _, _ in rows], [body for _, body, _ in rows], end)
    needed = {demand: factor_rows.ticks_of_rows(ticks, kept, merged) for demand, ticks in asked.items()}
    rows, factors, half, bound = [rows[place] for place in kept], factors[kept], half[kept], resolved[kept] == 0
    ax = style.one_axes(axes, height=1.5 + factor_rows.ROW * max(len(rows), 3))
    lowest = factor_rows.least(needed, float(np.nanmin(np.where(factors > 0.0, factors, np.nan), initial=1.0)))
    begin = _BELOW * lowest
    for place, (one, body, case) in enumerate(rows):
        if np.isnan(factors[place]):
            ax.text(1.0, place, f" {say('grade.not_known')}", fontsize=SMALL, color=GREY, va="center")
            continue
        at_end = not any(ticks[place] > np.sqrt(end) for ticks in needed.values())  # otherwise below the text
        if searched:
            found = table_of_pair(tree, "overturning_intervals", one, body, model, case)
            _bars(ax, place, found, begin, end, at_end)
        else:
            factor_rows.probability_bars(ax, place, [factors[place], half[place]], begin, end, at_end)
    if not searched:  # the interval of each factor
        low, high = (np.clip(one[kept], begin, end) for one in ends)
        ax.hlines(np.arange(low.size), low, high, color=BLACK, lw=0.9, zorder=2.5)
    _smallest(ax, factors, bound & searched, say("plot.factor.smallest") if searched else factor_name(name))
    factor_rows.demand_ticks(ax, needed)
    factor_rows.factor_axis(ax, names, begin, end)
    ax.set_xlabel(say(f"plot.factor.on_{'sequence' if model in SEQUENCE_MODELS else 'record'}"))
    legend_rows = factor_rows.legend_once(ax, columns=4)
    heading = style.plain(records[0]) if len(records) == 1 else style.plain(blocks[0])
    style.title(ax, say("plot.factor.title", name=heading, model=style.look(model).label), rows=legend_rows)
    if searched:
        notes += _map_notes(model, end, float(np.nanmax(steps, initial=1.0)), outside, bool(np.any(bound)))
    else:
        notes.append(say("plot.factor.probability", uncertainty=factor_rows.configured_uncertainty(tree)))
    style.caption(ax, " ".join([*notes, *factor_rows.tick_notes(asked)]))
    return ax


def critical_scale(
    tree: xr.DataTree,
    block: str | None = None,
    models: Sequence[str] | None = None,
    case: int = 1,
    axes: Axes | None = None,
) -> Axes:
    """Draw, for every record, the smallest scale factor at which a body overturns in each model.

    If no search was made with the nonlinear model, its scale factor at P = 10 % is drawn. Rows are sorted by the most
    complete model, with the smallest scale factor on top; `case` is the number of the restitution, from 1.
    """
    summary = tree["summary"].to_dataset()
    block = one_name(summary, "block", block)
    own = summary.sel(block=block).isel(chosen_case(summary, case))
    factors, without = own["safety_factor"], own["safety_factor"].isnull().all("record")
    probable = [name for name in map(str, own["model"].values) if is_full(name) and bool(without.sel(model=name))]
    own["safety_factor"] = factors.where(~own["model"].isin(probable), own["factor_10"])
    asked = [one_name(summary, "model", str(name)) for name in models or summary["model"].values]
    searched = [name for name in asked if bool(own["safety_factor"].sel(model=name).notnull().any())]
    if not searched:
        raise ResultsError(f"{block}: no scale factors in these results; {_SEARCH}")
    full = fullest_model(summary)
    leading = full if full in searched else searched[-1]
    order = np.argsort(own["safety_factor"].sel(model=leading).values, kind="stable")[: factor_rows.ROWS]
    end = settings_of(tree, SearchSettings).factor_max
    ax = style.one_axes(axes, height=1.6 + factor_rows.ROW * max(order.size, 4))
    drawn = own.isel(record=order)
    records = [str(name) for name in drawn["record"].values]
    none_at = [end * _NONE ** (1 + place) for place in range(len(searched) + 1)]
    lowest = [_markers(ax, drawn.sel(model=name), name, at) for name, at in zip(searched, none_at, strict=False)]
    needed = factor_rows.factors_to_demands(summary, records, block, end)
    factor_rows.demand_ticks(ax, needed)
    factor_rows.factor_axis(ax, records, _BELOW * factor_rows.least(needed, min([1.0, *lowest])), end, none_at[-1])
    ax.set_xlabel(style.wrapped(style.label(factors), 64))
    legend_rows = factor_rows.legend_once(ax, columns=3)
    name = style.plain(named_body(summary, block, case))
    style.title(ax, say("plot.scale.title", name=name), rows=legend_rows)
    notes = _scale_notes(own, drawn, searched, leading, end)
    labels = [style.look(name).label.capitalize() for name in searched if name in probable]
    notes += [say("plot.scale.probable", model=model) for model in labels]
    style.caption(ax, " ".join([*notes, *factor_rows.tick_notes(needed)]))
    return ax


def _bars(ax: Axes, place: int, found: dict[str, np.ndarray], begin: float, end: float, at_end: bool) -> None:
    lower, upper = found["lower"], found["upper"]
    first = float(lower[0]) if lower.size else end
    factor_rows.bar(ax, place, begin, first, "stands", fc="#E8F3EF", ec=GREEN, lw=0.4)
    if not lower.size:
        factor_rows.label_without_factor(ax, place, end, at_end)
    for low, high, resolved in zip(lower, upper, found["resolved"], strict=True):
        words = "overturns" if resolved else "no_answer"
        factor_rows.bar(ax, place, low, high, words, lw=0.4, **(_OVERTURNS if resolved else _UNKNOWN))
    for answered, color in ((found["resolved"] != 0, RED), (found["resolved"] == 0, GREY)):
        middle = np.sqrt(lower * upper)[answered]
        ax.vlines(middle, place - factor_rows.HALF, place + factor_rows.HALF, color=color, lw=_THINNEST, zorder=1.5)
    for low, high in zip(upper, [*lower[1:], end], strict=False):
        if low < end:
            factor_rows.bar(ax, place, low, high, "stands_again", **_AGAIN)


def _smallest(ax: Axes, factors: np.ndarray, bound: np.ndarray, words: str) -> None:
    """Draw a dot at the scale factor of every row; a hollow dot is a lower bound."""
    dots: dict[str, Any] = {"ls": "none", "marker": "o", "ms": 3.6, "mec": BLACK, "mew": 0.7, "zorder": 3}
    for rows, face in ((~bound, BLACK), (bound, "white")):
        drawn = rows & np.isfinite(factors)
        if np.any(drawn):
            ax.plot(factors[drawn], np.flatnonzero(drawn), label=words, mfc=face, **dots)


def _markers(ax: Axes, answers: xr.Dataset, model: str, none_at: float) -> float:
    appearance, factor = style.look(model), answers["safety_factor"].values
    places = np.arange(factor.size)
    inside, bound = answers["applicable"].values != 0, answers["factor_resolved"].values == 0
    finite, none = np.isfinite(factor), np.isinf(factor)
    common: dict[str, Any] = {"ls": "none", "color": appearance.color, "mec": appearance.color, "mew": 0.9, "zorder": 3}
    ax.plot([], [], marker=appearance.marker, ms=4.5, label=appearance.label, **common)
    for chosen_rows, face in ((finite & inside, appearance.color), (finite & ~inside, "white")):
        ax.plot(factor[chosen_rows], places[chosen_rows], marker=appearance.marker, ms=4.5, mfc=face, **common)
    arrow = {**common, "mew": 0.2}
    ax.plot(1.06 * factor[finite & bound], places[finite & bound], marker=r"$\rightarrow$", ms=8, **arrow)
    ax.plot(np.full(int(none.sum()), none_at), places[none], marker=appearance.marker, ms=3.2, mfc="none", **common)
    return float(np.min(factor[finite], initial=1.0))


def _map_notes(model: str, end: float, step: float, outside: Sequence[str], bound: bool) -> list[str]:
    words = style.notes(as_calibrated=model in SEQUENCE_MODELS, as_recorded=model not in SEQUENCE_MODELS)
    width = numerals(f"{100.0 * (step - 1.0):.2g}")
    searched = "searched_in_steps" if step > 1.0 else "searched"
    words.append(say(f"plot.factor.{searched}", factor=six_digits(end), **{"width": width} if step > 1.0 else {}))
    words.append(say("plot.factor.thinnest", width=six_digits(_THINNEST)))
    words += style.notes(hollow_bound=bound)
    if outside:
        names = listed(list(dict.fromkeys(outside)), factor_rows.LISTED)
        words.append(say("plot.factor.outside", names=style.plain(names)))
    return words + _bounds([model])


def _scale_notes(own: xr.Dataset, drawn: xr.Dataset, searched: Sequence[str], leading: str, end: float) -> list[str]:
    rows, every, answers = drawn.sizes["record"], own.sizes["record"], drawn.sel(model=list(searched))
    values = answers["safety_factor"].values
    unknown = int(np.count_nonzero(np.isnan(values)))
    words = [say("plot.scale.smallest", count=rows, total=every)] if rows < every else []
    words.append(say("plot.scale.order", model=translated(f"models.{leading}", leading)))
    words += [say("plot.scale.none", factor=six_digits(end))] if np.isinf(values).any() else []
    words += style.notes(
        hollow_outside=bool((answers["applicable"].values == 0).any()),
        arrow=bool((answers["factor_resolved"].values == 0).any()),
    )
    words += [say("plot.scale.unknown", count=unknown)] if unknown else []
    return words + _bounds(searched)


def _bounds(models: Sequence[str]) -> list[str]:
    names = [say(f"models.{name}") for name in models if is_upper_bound(name)]
    return [say("plot.factor.upper_bound", name=name.capitalize()) for name in names]
