"""The overturning spectra of records as curves over p, with the bodies as points that stand or fall by them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.earthquakes import FEWEST_EVENTS, weighted_quantile
from rockpulse.views.plots.demand_marks import factors_to_demands
from rockpulse.views.plots.selection import plain_bodies
from rockpulse.views.plots.spectrum_map import body_marks, size_scale
from rockpulse.views.plots.style import BLUE, GREY, PALE, RED, caption, legend_above, one_axes, plain_ticks, title
from rockpulse.views.plots.words import label, plain

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["below_the_picture", "overturning_spectra", "record_lines", "spectra_of_results", "spectrum_axes"]

#: Spectra of single records that are drawn; more are a grey area.
_DRAWN = 200

#: Frequency parameters that are written along p [1/s].
_TICKS = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)

#: Room beside what is drawn, as a ratio of p.
_ROOM = 1.6

#: Curves are followed down to this share of the lowest body.
_DEEPEST = 0.1

#: The higher of the two quantiles over the records of a site.
_UPPER = 0.84


def overturning_spectra(
    spectra: xr.Dataset,
    ax: Axes | None = None,
    restitution: float | None = None,
    bodies: Mapping[str, tuple[float, float]] | None = None,
    events: Sequence[str] | None = None,
    demands: Mapping[str, np.ndarray] | None = None,
    gravity: float = 9.80665,
) -> Axes:
    """Overturning spectra S(p) at one restitution; a body overturns where S lies above its point.

    Parameters
    ----------
    spectra : xarray.Dataset
        `spectrum`, `spectrum_low`, `spectrum_high` [m/s] over (record, p, restitution), /spectra of a results file, or
        over (p, restitution) as :func:`rockpulse.overturning_spectrum` returns it.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.
    restitution : float, optional
        C of the blocks [-]; the nearest one of the spectra is drawn. Without, the largest one.
    bodies : mapping of str to (float, float), optional
        p [1/s] and alpha_c [rad] of bodies, by their names.
    events : sequence of str, optional
        The earthquake of each record; earthquakes weigh alike in the quantiles. Without, the records do.
    demands : mapping of str to (records,) ndarray, optional
        Factors on the records that bring each to a demand, by its name: the median spectrum there is drawn as well.
    gravity : float
        At the bodies [m/s2].

    Returns
    -------
    matplotlib Axes
        Logarithmic in p and S.
    """
    ax = one_axes(ax, height=4.4)
    several = spectra if "record" in spectra.dims else spectra.expand_dims("record")
    grid = several["restitution"].values
    chosen = int(np.argmin(np.abs(grid - (grid[-1] if restitution is None else restitution))))
    at = several.isel(restitution=chosen).transpose("record", "p", ...)
    # Stored spectra may have numbers next to the bodies alone.
    at = at.isel(p=np.flatnonzero(np.isfinite(at["spectrum"].values).any(axis=0)))
    p, curves = at["p"].values, at["spectrum"].values
    known = np.flatnonzero(np.all(np.isfinite(curves), axis=1) & (p.size > 0))
    curves = curves[known]
    left_out = ""
    if 0 < p.size < several.sizes["p"]:
        left_out = " Straight where no body lies: [uncertainty] spectrum = all marches the whole curve."
    if known.size == 1:
        low, high = (at[name].values[known[0]] for name in ("spectrum_low", "spectrum_high"))
        ax.fill_between(p, low, high, color=PALE, lw=0, label="90 % interval")
        ax.plot(p, curves[0], color=BLUE, label="spectrum of the record")
    elif known.size:
        record_lines(ax, p, curves)
        labels = None if events is None else [events[int(place)] for place in known]
        weights, few = _alike(labels, known.size), labels is not None and len(set(labels)) < FEWEST_EVENTS
        for level, dashes, name in ((0.5, "-", "median"), (_UPPER, "--", "84 %")) if not few else ():
            ax.plot(p, _quantile(curves, level, weights), color=BLUE, ls=dashes, lw=1.8, label=name)
        for place, (name, factors) in enumerate((demands or {}).items() if not few else ()):
            scaled = curves * np.asarray(factors, dtype=float)[known, np.newaxis]
            style = ((0, (1.2, 1.2)), (0, (6, 1.5, 1, 1.5)))[place % 2]
            words = f"median at the demand {plain(name)}"
            ax.plot(p, _quantile(scaled, 0.5, weights), color=RED, ls=style, lw=1.8, label=words)
        if few:
            left_out += f" Fewer than {FEWEST_EVENTS} earthquakes have no median."
    points = {name: (rate, gravity * np.tan(alpha) / rate) for name, (rate, alpha) in (bodies or {}).items()}
    rows = spectrum_axes(ax, several["p"], points, gravity, columns=3)
    names = several["record"].values if "record" in several.coords else [several.attrs.get("record", "")]
    words = plain(names[known[0]]) if known.size == 1 else f"{known.size} records"
    if known.size < len(names):
        left_out += f" {len(names) - known.size} of {len(names)} records have no spectrum."
    title(ax, f"{words}, $C$ = {grid[chosen]:g}", rows=rows)
    remarks = ["A body overturns, at its mean capacity, under a record whose curve lies above its point."]
    remarks += below_the_picture(ax, curves)
    if bodies:
        remarks.append("A body with a larger C falls under a higher curve, one with a smaller C under a lower one.")
    caption(ax, " ".join(remarks) + ("" if known.size else " No spectrum was stored.") + left_out)
    return ax


def spectra_of_results(tree: xr.DataTree, spectra: xr.Dataset, restitution: float | None = None) -> Axes:
    """Draw spectra of an assessment, with its bodies, its earthquakes and what its demands ask of the records.

    Without a `restitution` at the median one: half of the bodies have a larger C than the curve, half a smaller one.
    """
    summary = tree["summary"].to_dataset()
    own, names = summary.sel(record=spectra["record"].values), plain_bodies(summary)
    # A factor that differs from body to body moves no spectrum as a whole.
    records, every = own["record"].values.tolist(), names or [str(name) for name in summary["block"].values]
    shared = [factors_to_demands(summary, records, name, np.inf) for name in every]
    needed = {name: one for name, one in shared[0].items() if all(np.array_equal(one, other[name]) for other in shared)}
    return overturning_spectra(
        spectra,
        restitution=float(summary["restitution"].median()) if restitution is None else restitution,
        bodies={
            name: (float(summary["p"].sel(block=name)), float(summary["alpha_c"].sel(block=name))) for name in names
        },
        events=[str(event) for event in own["event"].values],
        demands=needed if len(records) > 1 else None,
        gravity=float(summary["gravity"][0]),
    )


def record_lines(ax: Axes, p: np.ndarray, curves: np.ndarray) -> None:
    """Draw the spectra of single records (records, a) [m/s] over p (a,) thinly, with one entry in the legend."""
    for place, curve in enumerate(curves[:_DRAWN]):
        ax.plot(p, curve, color=GREY, lw=0.5, alpha=0.6, label="" if place else f"{len(curves)} records")


def below_the_picture(ax: Axes, curves: np.ndarray) -> list[str]:
    """How many curves (records, a) lie below the Axes of :func:`spectrum_axes`, in a sentence; none where none does."""
    below = int(np.count_nonzero(np.all(curves < ax.get_ylim()[0], axis=1)))
    return [f"Below the picture, far from every body: {below} of {len(curves)} curves."] if below else []


def spectrum_axes(
    ax: Axes, p: xr.DataArray, points: Mapping[str, tuple[float, float]], gravity: float, columns: int
) -> int:
    """Dress the Axes of spectra over p, mark the bodies at their p and g tan(alpha)/p, and put the legend above.

    Returns the rows that a title has to leave for the legend.
    """
    handles = [*ax.get_legend_handles_labels()[0], *body_marks(ax, dict(points))]
    ax.set_xscale("log")
    ax.set_yscale("log")
    first, last = float(p[0]), float(p[-1])
    drawn = ax.dataLim.intervalx
    if np.all(np.isfinite(drawn)):
        first, last = max(first, float(drawn[0]) / _ROOM), min(last, float(drawn[1]) * _ROOM)
    ax.set_xlim(first, last)
    ticks = [value for value in _TICKS if first <= value <= last]
    ax.set_xticks(ticks, [f"{value:g}" for value in ticks])
    ax.minorticks_off()
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, _DEEPEST * min((speed for _, speed in points.values()), default=0.0)), high)
    plain_ticks(ax.yaxis)
    ax.set_xlabel(label(p.attrs, symbol="$p$"))
    ax.set_ylabel(r"effective impulse $S$, or $g\,\tan\alpha_c/p$ of a body [m/s]")
    size_scale(ax, gravity)
    legend_above(ax, columns, across=True, lift=32.0, handles=handles)
    return 3 - (-len(handles) // columns)


def _alike(events: Sequence[str] | None, count: int) -> np.ndarray:
    """Weights (records,) with which every earthquake counts the same, that sum up to one."""
    if events is None:
        return np.full(count, 1.0 / count)
    _, place, sizes = np.unique(np.asarray(events, dtype=str), return_inverse=True, return_counts=True)
    return 1.0 / (sizes[place] * sizes.size)


def _quantile(curves: np.ndarray, level: float, weights: np.ndarray) -> np.ndarray:
    return np.array([weighted_quantile(column, level, weights) for column in curves.T])
