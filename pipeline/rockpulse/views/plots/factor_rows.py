"""Draws the rows of a picture of scale factors: axis, bars of probability, and ticks of demands."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from rockpulse.assessment.site_demands import stored_demands
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.model_table import SearchSettings
from rockpulse.views.plots.selection import named_body, settings_of
from rockpulse.views.plots.style import BLACK, BLUE, DASHED, GREEN, GREY, PALE, RED, SMALL, legend_above, notes, plain
from rockpulse.views.shared.formatting import shortened, six_digits
from rockpulse.views.shared.words import listed, say

#: Largest number of rows on a page (with the smallest factors), height of a row [in], and longest name next to a row
#: [characters].
ROWS, ROW, NAME = 60, 0.155, 34
#: Largest number of listed names of rows that are merged.
LISTED = 3


def drawn_rows(
    summary: xr.Dataset, rows: Sequence[tuple[str, str, int]], factors: np.ndarray, most: int
) -> tuple[np.ndarray, list[np.ndarray], list[str], list[str]]:
    """Return the indices of the drawn rows, the rows combined in each merged row, the names of all rows, and notes."""
    groups = [np.flatnonzero(one) for one in (np.isinf(factors), np.isnan(factors))]
    merged = [group for group in groups if group.size > 1]
    lone = np.setdiff1d(np.arange(len(rows)), np.concatenate([[], *merged])).astype(int)
    records = len({record for record, _, _ in rows})
    if records > 1 or lone.size > most:  # smallest factor on top
        lone = lone[np.argsort(factors[lone], kind="stable")]
    sentences = [say("plot.rows.smallest", count=most, total=len(rows))] if lone.size > most else []
    lone = lone[:most]
    every = [named_body(summary, block, case) for _, block, case in rows]
    if records > 1:
        # One of several restitutions is named at the end: ", C = 0.98".
        ends = [name.removeprefix(block) for name, (_, block, _) in zip(every, rows, strict=True)]
        every = [shortened(row[0], NAME - len(c)) + c for row, c in zip(rows, ends, strict=True)]
    names = [every[place] for place in lone]
    noun = "bodies" if records == 1 else "records" if records == len(rows) else "rows"
    for group in merged:
        which = "all" if group.size == len(rows) else "other"
        names.append(say(f"plot.rows.{which}_{noun}", count=group.size))
        sentences.append(f"{names[-1].capitalize()}: {plain(listed([every[place] for place in group], LISTED))}.")
    return np.array([*lone, *(group[0] for group in merged)], dtype=int), merged, names, sentences


def ticks_of_rows(ticks: np.ndarray, kept: np.ndarray, merged: Sequence[np.ndarray]) -> np.ndarray:
    """Return the tick of each drawn row; NaN for a row that combines rows with different ticks."""
    found = ticks[kept]
    for place, group in enumerate(merged, start=kept.size - len(merged)):
        if np.unique(ticks[group]).size > 1:
            found[place] = np.nan
    return found


def factor_axis(ax: Axes, names: Sequence[str], begin: float, end: float, last: float | None = None) -> None:
    """Format a logarithmic axis of scale factors and name its rows; scale factors from `end` to `last` are shaded."""
    ax.set(xscale="log", xlim=(begin, end if last is None else last))
    if last is not None:
        ax.axvspan(end, last, color=PALE, alpha=0.5, lw=0)
        ax.text(np.sqrt(end * last), -0.75, f">{six_digits(end)}", fontsize=SMALL, ha="center", va="bottom", color=GREY)
    ticks = [tick for tick in (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if begin <= tick <= end]
    ax.xaxis.set_major_locator(FixedLocator(ticks))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: six_digits(value)))
    ax.axvline(1.0, color=BLACK, lw=1.0, ls=DASHED)
    ax.set_yticks(range(len(names)), [plain(shortened(name, NAME)) for name in names], fontsize=SMALL)
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)


def legend_once(ax: Axes, columns: int) -> int:
    """Draw a legend in which every label appears once, and return its number of rows."""
    handles, labels = ax.get_legend_handles_labels()
    names = list(dict.fromkeys(labels))
    legend_above(ax, columns, across=True, handles=[handles[labels.index(name)] for name in names], labels=names)
    return -(-len(names) // columns)


def factors_to_demands(
    summary: xr.Dataset, records: Sequence[str], blocks: Sequence[str] | str, end: float
) -> dict[str, np.ndarray]:
    """Return the scale factors that bring each record to each demand; NaN for scale factors above `end`."""
    bodies = [blocks] * len(records) if isinstance(blocks, str) else blocks
    at = {name: xr.DataArray(list(values), dims="row") for name, values in (("record", records), ("block", bodies))}
    found = {}
    for name in stored_demands(summary):
        asked = summary["demand_factor"].sel(at | {"demand": name})
        asked = asked.isel(case=0) if "case" in asked.dims else asked
        found[name] = asked.where(asked <= end).values
    return found


def least(needed: dict[str, np.ndarray], otherwise: float) -> float:
    """Return the smallest scale factor for any demand, but at most `otherwise`."""
    return min([otherwise, *(float(np.nanmin(factors, initial=otherwise)) for factors in needed.values())])


def demand_ticks(ax: Axes, needed: dict[str, np.ndarray]) -> None:
    """Draw in each row a tick at the scale factor for each demand; the first demand has the longest ticks."""
    for place, (name, factors) in enumerate(needed.items()):
        words, size = say("plot.rows.demand", name=plain(shortened(name, 24))), 9 - 2 * min(place, 2)
        marks: dict[str, Any] = {"ls": "none", "marker": "|", "ms": size, "mew": 1.6, "color": BLACK, "zorder": 4}
        ax.plot(factors, np.arange(factors.size), label=words, **marks)


def tick_notes(needed: dict[str, np.ndarray]) -> list[str]:
    """Return the notes that explain the ticks."""
    return notes(tick=bool(needed), no_tick=any(np.isnan(factors).any() for factors in needed.values()))


def configured_uncertainty(tree: xr.DataTree) -> str:
    """Describe the uncertainty that the probability of overturning includes, from the stored configuration."""
    known, search = settings_of(tree, UncertaintySettings), settings_of(tree, SearchSettings)
    low, high = map(six_digits, (min(known.restitution), max(known.restitution)))
    factor, less = (six_digits(100.0 * spread) for spread in (known.factor, known.geometry))
    return say("plot.uncertainty", factor=factor, low=low, high=high, less=less, most=six_digits(search.factor_max))


#: Half of the height of a bar.
HALF = 0.33
#: Styles of the bars of probability, in the order of rising probability, by the keys of their labels.
_LEVELS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("below_10", {"fc": "#E8F3EF", "ec": GREEN, "lw": 0.4}),
    ("between", {"fc": "#BBDDF3", "ec": BLUE, "lw": 0.4}),
    ("above_50", {"fc": RED, "ec": RED, "lw": 0.4}),
)


def probability_bars(ax: Axes, place: int, factors: Sequence[float], begin: float, end: float, at_end: bool) -> None:
    """Draw the bars of one row, which end at the scale factors for P = 10 % and P = 50 % and at the upper limit."""
    edges = [begin, *np.clip(factors, begin, end), end]
    for low, high, (words, style) in zip(edges[:-1], edges[1:], _LEVELS, strict=True):
        if high > low:
            bar(ax, place, low, high, words, **style)
    if np.isinf(factors[0]):
        label_without_factor(ax, place, end, at_end)


def label_without_factor(ax: Axes, place: int, end: float, at_end: bool) -> None:
    """Write "none found" in a row, at the upper limit of the search or beside the line of the scale factor 1."""
    words, (where, side) = (
        say("plot.rows.none_up_to", factor=six_digits(end)),
        (end, "right") if at_end else (1.0, "left"),
    )
    ax.text(where, place, f"  {words}  ", fontsize=SMALL - 0.5, color=BLACK, ha=side, va="center")


def bar(ax: Axes, place: int, low: float, high: float, words: str, **style: Any) -> None:
    """Draw a bar from one scale factor to another; `words` is the key of its label in the section [plot.bar]."""
    ax.barh(place, high - low, left=low, height=2.0 * HALF, label=say(f"plot.bar.{words}"), **style)
