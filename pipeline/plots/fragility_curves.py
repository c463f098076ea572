"""Fragility curves of a block with their bands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.fragility.settings import OVERTURNING, UPLIFT
from rockpulse.plots.selection import chosen
from rockpulse.plots.style import Look, caption, legend_above, looks, one_axes, title
from rockpulse.plots.words import label, plain, wrapped

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["fragility"]

#: The measure that is drawn where none is asked for: it puts bodies of all sizes on one scale.
SHOWN = "velocity_ratio"

#: Probabilities below this, and above one less it, are not looked at when the range of the axis is chosen.
_TAIL = 0.002

#: Limit states whose single capacities are drawn beside the curves: more of them hide each other.
_POINTS = 3

#: Remarks that are given one by one.
_REMARKS = 4


def fragility(
    tree: xr.DataTree,
    block: str | None = None,
    measure: str | None = None,
    limit_states: Sequence[str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Probability of reaching each limit state over a measure of intensity, with the confidence bands.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.fragility_curves` returns it.
    block : str, optional
        Name; none where there is one only.
    measure : str, optional
        By default p PGV/(g tan alpha_c), or the first of the file.
    limit_states : sequence of str, optional
        Some of the file; all by default.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.

    Returns
    -------
    matplotlib Axes
        A line for every fitted curve, a filled band where there is one, and, of up to three limit states, the single
        capacities (a mark each) where every record was scaled.

    Raises
    ------
    ResultsError
        For a name that is not there.
    """
    curves = tree["fragility"].to_dataset()
    block = chosen(curves, "block", block)
    known = [str(name) for name in curves["measure"].values]
    measure = chosen(curves, "measure", measure or (SHOWN if SHOWN in known else known[0]))
    states = [chosen(curves, "limit_state", str(name)) for name in limit_states or curves["limit_state"].values]
    own = curves.sel(block=block, measure=measure)
    ax = one_axes(ax, height=4.0)
    level = own["level"].values
    remarks, reach, banded = [], [], False
    for state, style in zip(states, looks([_named(state) for state in states]), strict=True):
        one = own.sel(limit_state=state)
        if str(one["statement"].item()):
            remarks.append(f"{style.label}: {one['statement'].item()}")
        probability = one["probability"].values
        if np.all(np.isnan(probability)):
            ax.plot([], [], color=style.color, ls=style.line, label=f"{style.label}: no curve")
            continue
        words = style.label + (" (extrapolated)" if int(one["extrapolated"]) else "")
        ax.plot(level, probability, color=style.color, ls=style.line, lw=1.4, label=words)
        low, high = one["probability_low"].values, one["probability_high"].values
        if not np.all(np.isnan(low)):
            banded = True
            ax.fill_between(level, low, high, color=style.color, alpha=0.16, lw=0)
            for edge in (low, high):
                ax.plot(level, edge, color=style.color, ls=style.line, lw=0.5, alpha=0.7)
        reach.append(level[(probability > _TAIL) & (probability < 1.0 - _TAIL)])
        if len(states) <= _POINTS and tree.attrs.get("data") == "ida":
            capacities = tree["capacities"].to_dataset()
            _capacities(ax, capacities, block, state, measure, style, float(capacities.attrs["factor_max"]))
    ax.set_xscale("log")
    seen = np.concatenate([part for part in reach if part.size] or [level])
    ax.set_xlim(float(seen.min()), float(seen.max()))
    ax.set_ylim(-0.01, 1.01)
    attrs = {"long_name": str(own["measure_long_name"].item())}
    ax.set_xlabel(wrapped(label(attrs, units=str(own["measure_units"].item())), 90))
    ax.set_ylabel(label(own["probability"].attrs))
    _readable_ticks(ax)
    legend_above(ax, 3, across=True)
    title(ax, plain(block), rows=-(-len(states) // 3))
    caption(ax, _notes(tree, own, banded, remarks, len(states)))
    return ax


def _named(state: str) -> str:
    if state == UPLIFT:
        return "uplift"
    return "overturning" if state == OVERTURNING else rf"$\theta_{{max}}/\alpha_c \geq$ {state}"


def _capacities(
    ax: Axes, capacities: xr.Dataset, block: str, state: str, measure: str, style: Look, end: float
) -> None:
    """Capacity of every record at its share (Kaplan-Meier): one that does not reach the state is known to be above."""
    from scipy.stats import CensoredData, ecdf

    own = capacities.sel(block=block)
    factor = own["factor"].sel(limit_state=state).values
    value = own["measure_value"].sel(measure=measure).values
    reached = np.isfinite(factor)
    if not np.any(reached):
        return
    found = ecdf(CensoredData(uncensored=(factor * value)[reached], right=end * value[~reached])).cdf
    risen = np.diff(found.probabilities, prepend=0.0)
    ax.plot(
        found.quantiles[risen > 0.0],
        (found.probabilities - 0.5 * risen)[risen > 0.0],
        ls="none",
        marker=style.marker,
        ms=3.2,
        mfc="white",
        mec=style.color,
        mew=0.6,
        zorder=2.5,
    )


def _readable_ticks(ax: Axes) -> None:
    """Numbers as they are, not powers of ten, and enough of them."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = ax.get_xlim()
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0,) if high / low > 200.0 else (1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def _notes(tree: xr.DataTree, own: xr.Dataset, banded: bool, remarks: list[str], states: int) -> str:
    records, events = int(own["records"].max()), int(own["events"].max())
    found = f"{records} record{'s' * (records != 1)} of {events} earthquake{'s' * (events != 1)}"
    words = [f"{found}, data: {tree.attrs['data']}."]
    if banded:
        words.append(f"Bands: {100.0 * float(tree.attrs['confidence']):g} %, over earthquakes, at each level.")
    if states <= _POINTS and tree.attrs["data"] == "ida":
        words.append("Marks: records one by one, at the first factor that reaches the limit state (Kaplan-Meier).")
    words += [f"{remark}." for remark in remarks[:_REMARKS]]
    if len(remarks) > _REMARKS:
        words.append(f"{len(remarks) - _REMARKS} more remarks in the file.")
    return " ".join(words)
