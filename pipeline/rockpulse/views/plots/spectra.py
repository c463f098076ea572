"""Draws rocking spectra over p and alpha_c, overturning spectra over p, and spectra of selected records."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path

from rocking.response import Outcome
from rockpulse.earthquakes import FEWEST_EVENTS, mean_weights, weighted_quantile
from rockpulse.views.plots import style
from rockpulse.views.plots.factor_rows import factors_to_demands
from rockpulse.views.plots.selection import plain_bodies
from rockpulse.views.plots.style import BLACK, BLUE, DASHED, DOTTED, FONT, GREY, PALE, RED, SMALL
from rockpulse.views.shared.formatting import restitution, shortened, six_digits
from rockpulse.views.shared.words import counted_words, say

#: Radii R that are marked along the upper axis [m].
_RADII = (0.2, 0.3, 0.5, 1.0, 2.0, 4.0, 8.0)
#: Style of blocks that overturn.
_FALLEN: dict[str, Any] = {"fc": RED, "ec": BLACK, "hatch": "/////", "hatch_linewidth": 0.25}
#: Largest number of bodies whose names are written.
_NAMED = 12


def rocking_spectrum(
    spectrum: xr.Dataset,
    axes: Axes | None = None,
    bodies: Mapping[str, tuple[float, float]] | None = None,
    note: str = "",
) -> Axes:
    """Draw the largest rotation over p and alpha_c, darker for larger rotations and hatched red for overturning.

    `bodies` are the p [1/s] and alpha_c [rad] of bodies by name, and `note` is a further sentence for the small print.
    """
    ax = style.one_axes(axes, height=4.4)
    outcome = spectrum["outcome"].transpose("alpha_c", "p").values
    peak = spectrum["peak_rotation_ratio"].transpose("alpha_c", "p").values
    # Darker means larger, also in grey, and rest is white. Overturning is hatched, in a colour not used for rotations.
    colours = colormaps["cividis_r"].with_extremes(over=_FALLEN["fc"], bad="white")
    levels = np.linspace(0.0, 1.0, 11)
    fallen = outcome == Outcome.OVERTURNS
    # Rotations of at least alpha_c without overturning have the darkest colour.
    rotation = np.minimum(peak, np.nextafter(1.0, 0.0))
    colour_values = np.where(fallen, 2.0, np.where(outcome == Outcome.ROCKS, rotation, np.nan))
    p, alpha = spectrum["p"].values, spectrum["alpha_c"].values
    cells: dict[str, Any] = {"cmap": colours, "norm": BoundaryNorm(levels, colours.N), "rasterized": True}
    mesh = ax.pcolormesh(p, alpha, np.ma.masked_invalid(colour_values), **cells)
    if np.any(fallen):
        corners = np.asarray(mesh.get_coordinates())
        ways = [(0, 0), (0, 1), (1, 1), (1, 0), (0, 0)]
        around = np.stack([corners[i : i + len(alpha), j : j + len(p)] for i, j in ways], axis=2)[fallen]
        path = Path.make_compound_path(*(Path(cell, closed=True) for cell in around))
        ax.add_patch(PathPatch(path, **_FALLEN | {"fc": "none"}, lw=0.0, rasterized=True))
    ax.grid(visible=False)
    style.colour_bar(ax, mesh, levels[::2], style.label(spectrum["peak_rotation_ratio"]))
    handles: list[Any] = []
    if np.any(fallen):
        handles.append(Patch(**_FALLEN, lw=0.5, label=say("answer.overturns")))
    if np.any(outcome == Outcome.AT_REST):
        handles.append(Patch(fc="white", ec=BLACK, lw=0.5, label=say("answer.at_rest")))
    row, column = np.nonzero(outcome == Outcome.UNRESOLVED)
    if row.size:
        ax.plot(p[column], alpha[row], ls="none", marker="x", ms=3, color=RED, label=say("answer.unresolved"))
        handles += ax.get_legend_handles_labels()[0]
    handles += body_marks(ax, dict(bodies or {}))
    ax.set(
        xlim=_edges(p),
        ylim=_edges(alpha),
        xlabel=style.label(spectrum["p"], symbol="$p$"),
        ylabel=style.label(spectrum["alpha_c"], symbol=r"$\alpha_c$"),
    )
    size_scale(ax, float(spectrum.attrs["gravity"]))
    style.legend_above(ax, 3, across=True, lift=32.0, handles=handles)
    name, factor = style.plain(spectrum.attrs["record"]), float(spectrum.attrs["scale"])
    words = name if factor == 1.0 else say("plot.spectra.times", name=name, factor=six_digits(factor))
    style.title(ax, words, rows=3 - (-len(handles) // 3))
    low, high = (restitution(float(end(spectrum["restitution"]))) for end in (np.min, np.max))
    span = low if low == high else say("plot.spectra.housner", low=low, high=high)
    warnings = [say("plot.spectra.equation", c=span)]
    warnings += style.notes(all_at_rest=bool(np.all(outcome == Outcome.AT_REST)), other_c=bool(bodies))
    style.caption(ax, " ".join([*warnings, note]).strip())
    return ax


def body_marks(ax: Axes, bodies: dict[str, tuple[float, float]]) -> list[Any]:
    """Draw a numbered mark for every body, and return the legend entries with the names of the bodies."""
    handles = []
    ring: dict[str, Any] = {"ls": "none", "marker": "o", "mfc": "white", "mec": BLACK}
    for number, (name, (p, alpha)) in enumerate(bodies.items(), start=1):
        ax.plot(p, alpha, ms=3 if number > _NAMED else 9, mew=0.8, **ring)
        if number > _NAMED:
            continue
        figure: dict[str, Any] = {"marker": rf"$\mathbf{{{number}}}$", "ms": 5, "color": BLACK, "mew": 0.2}
        ax.plot(p, alpha, ls="none", **figure)
        handles.append(Line2D([], [], ls="none", **figure, label=style.plain(shortened(name, 24))))
    if len(bodies) > _NAMED:
        handles.append(Line2D([], [], ms=3, **ring, label=say("plot.spectra.more", count=len(bodies) - _NAMED)))
    return handles


def _edges(values: np.ndarray) -> tuple[float, float]:
    steps = np.diff(values) if values.size > 1 else 0.1 * values
    return float(values[0] - 0.5 * steps[0]), float(values[-1] + 0.5 * steps[-1])


def size_scale(ax: Axes, gravity: float) -> None:
    """Draw an upper axis with the radius R of rectangles, from p^2 = 3 g/(4 R)."""

    def swapped(p: Any) -> np.ndarray:
        return 0.75 * gravity / np.maximum(np.asarray(p, dtype=float), 1e-6) ** 2

    def back(radius: Any) -> np.ndarray:
        return np.sqrt(0.75 * gravity / np.maximum(np.asarray(radius, dtype=float), 1e-6))

    low, high = ax.get_xlim()
    top = ax.secondary_xaxis("top", functions=(swapped, back))
    radii = [radius for radius in _RADII if low <= float(back(np.array(radius))) <= high]
    top.set_xticks(radii, list(map(six_digits, radii)), fontsize=SMALL)
    top.minorticks_off()
    top.tick_params(width=0.6, length=3)
    top.set_xlabel(say("plot.spectra.radius"), fontsize=FONT)


#: Largest number of drawn spectra of single records, and lowest drawn level as a share of the level of the lowest body.
_DRAWN, _DEEPEST = 200, 0.1
#: Labelled frequency parameters [1/s], and margin of the axis as a ratio of two values of p.
_TICKS, _ROOM = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0), 1.6


def overturning_spectra(
    spectra: xr.Dataset,
    axes: Axes | None = None,
    restitution: float | None = None,
    bodies: Mapping[str, tuple[float, float]] | None = None,
    events: Sequence[str] | None = None,
    demands: Mapping[str, np.ndarray] | None = None,
    gravity: float = 9.80665,
) -> Axes:
    """Draw overturning spectra S(p) at one restitution; a record overturns the bodies below its curve.

    `spectra` has `spectrum`, `spectrum_low`, `spectrum_high` [m/s] over (record, p, restitution) or (p, restitution);
    the values at the restitution nearest to the given one are drawn, by default at the largest. `bodies` are the
    p [1/s] and alpha_c [rad] of bodies by name. `events` are the earthquakes of the records, which then have equal
    weights in the quantiles; by default the records have. `demands` are the scale factors of the records for each
    demand, for the median at it. `gravity` is in m/s2.
    """
    ax = style.one_axes(axes, height=4.4)
    several = spectra if "record" in spectra.dims else spectra.expand_dims("record")
    grid = several["restitution"].values
    chosen = int(np.argmin(np.abs(grid - (grid[-1] if restitution is None else restitution))))
    at = several.isel(restitution=chosen).transpose("record", "p", ...)
    # Stored spectra may have values only next to the bodies.
    at = at.isel(p=np.flatnonzero(np.isfinite(at["spectrum"].values).any(axis=0)))
    p, curves = at["p"].values, at["spectrum"].values
    known = np.flatnonzero(np.all(np.isfinite(curves), axis=1) & (p.size > 0))
    curves = curves[known]
    straight, few = 0 < p.size < several.sizes["p"], False
    if known.size == 1:
        low, high = (at[name].values[known[0]] for name in ("spectrum_low", "spectrum_high"))
        ax.fill_between(p, low, high, color=PALE, lw=0, label=say("plot.spectra.interval"))
        ax.plot(p, curves[0], color=BLUE, label=say("plot.spectra.of_record"))
    elif known.size:
        record_lines(ax, p, curves)
        labels = np.asarray(range(several.sizes["record"]) if events is None else events)[known]
        weights, few = mean_weights(labels).mean(axis=0), events is not None and len(set(labels)) < FEWEST_EVENTS
        drawn: list[Any] = [(curves, 0.5, BLUE, "-", say("plot.spectra.median")), (curves, 0.84, BLUE, "--", "84 %")]
        for place, (name, factors) in enumerate((demands or {}).items()):
            scaled = curves * np.asarray(factors, dtype=float)[known, np.newaxis]
            dashes = (DOTTED, (0, (6, 1.5, 1, 1.5)))[place % 2]
            drawn.append((scaled, 0.5, RED, dashes, say("plot.spectra.at_demand", name=style.plain(name))))
        for own, level, color, dashes, words in drawn if not few else ():
            quantile = [weighted_quantile(column, level, weights) for column in own.T]
            ax.plot(p, quantile, color=color, ls=dashes, lw=1.8, label=words)
    points = {name: (rate, gravity * np.tan(alpha) / rate) for name, (rate, alpha) in (bodies or {}).items()}
    rows = spectrum_axes(ax, several["p"], points, gravity, columns=3)
    names = several["record"].values if "record" in several.coords else [several.attrs.get("record", "")]
    words = style.plain(names[known[0]]) if known.size == 1 else counted_words(known.size, "record")
    style.title(ax, f"{words}, $C$ = {six_digits(grid[chosen])}", rows=rows)
    warnings = [*style.notes(below_curve=True), *curves_below_axes(ax, curves)]
    warnings += style.notes(larger_c=bool(bodies), no_spectrum=not known.size, straight=straight)
    if few:
        warnings.append(say("plot.spectra.few", count=FEWEST_EVENTS))
    if known.size < len(names):
        warnings.append(say("plot.spectra.without", count=len(names) - known.size, total=len(names)))
    style.caption(ax, " ".join(warnings))
    return ax


def spectra_of_results(tree: xr.DataTree, spectra: xr.Dataset, restitution: float, axes: Axes | None = None) -> Axes:
    """Draw the overturning spectra of an assessment with its bodies, at a restitution."""
    summary = tree["summary"].to_dataset()
    own, names = summary.sel(record=spectra["record"].values), plain_bodies(summary)
    plain = summary.sel(block=names)
    # A factor that depends on the body cannot shift a whole spectrum.
    records, every = own["record"].values.tolist(), names or [str(name) for name in summary["block"].values]
    shared = [factors_to_demands(summary, records, name, np.inf) for name in every]
    needed = {name: one for name, one in shared[0].items() if all(np.array_equal(one, other[name]) for other in shared)}
    return overturning_spectra(
        spectra,
        axes,
        restitution,
        bodies=dict(zip(names, zip(plain["p"].values, plain["alpha_c"].values, strict=True), strict=True)),
        events=[str(event) for event in own["event"].values],
        demands=needed if len(records) > 1 else None,
        gravity=float(summary["gravity"][0]),
    )


def record_lines(ax: Axes, p: np.ndarray, curves: np.ndarray) -> None:
    """Draw the spectra of single records as thin lines over p, with one legend entry."""
    for place, curve in enumerate(curves[:_DRAWN]):
        ax.plot(p, curve, color=GREY, lw=0.5, alpha=0.6, label="" if place else counted_words(len(curves), "record"))


def curves_below_axes(ax: Axes, curves: np.ndarray) -> list[str]:
    """Return a sentence on the number of curves that lie entirely below the Axes; an empty list if there are none."""
    below = int(np.count_nonzero(np.all(curves < ax.get_ylim()[0], axis=1)))
    return [say("plot.spectra.below", count=below, total=len(curves))] if below else []


def spectrum_axes(
    ax: Axes, p: xr.DataArray, points: Mapping[str, tuple[float, float]], gravity: float, columns: int
) -> int:
    """Format the axes of overturning spectra, mark the bodies, and return the number of legend rows."""
    handles = [*ax.get_legend_handles_labels()[0], *body_marks(ax, dict(points))]
    ax.set(xscale="log", yscale="log")
    first, last = float(p[0]), float(p[-1])
    drawn = ax.dataLim.intervalx
    if np.all(np.isfinite(drawn)):
        first, last = max(first, float(drawn[0]) / _ROOM), min(last, float(drawn[1]) * _ROOM)
    ax.set_xlim(first, last)
    ticks = [value for value in _TICKS if first <= value <= last]
    ax.set_xticks(ticks, list(map(six_digits, ticks)))
    ax.minorticks_off()
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, _DEEPEST * min((speed for _, speed in points.values()), default=0.0)), high)
    style.plain_ticks(ax.yaxis)
    ax.set(xlabel=style.label(p, symbol="$p$"), ylabel=say("plot.spectra.effective"))
    size_scale(ax, gravity)
    style.legend_above(ax, columns, across=True, lift=32.0, handles=handles)
    return 3 - (-len(handles) // columns)


def selected_spectra(selection: xr.DataTree, ax: Axes | None = None) -> Axes:
    """Draw the response spectra of selected records, their mean, the target and its tolerance over the period.

    Parameters
    ----------
    selection : xarray.DataTree
        Result of :func:`rockpulse.select`.
    ax : matplotlib Axes, optional
        Axes to draw on; by default a new figure.

    Returns
    -------
    matplotlib Axes
        Pseudo-acceleration for 5 % damping [m/s2] over the period [s].

    Examples
    --------
    >>> check = rp.CheckSettings(spectrum="en_1998_1", ag=0.2, ground="B")
    >>> tree = rp.select(record, rp.Config(check=check, selection=rp.SelectionSettings(records=1)))
    >>> rp.plots.selected_spectra(tree).get_xlabel()
    'Period of the oscillator [s]'
    """
    ax = style.one_axes(ax, height=4.0)
    found = selection["selection"].to_dataset()
    period, target = found["period"].values, found["target"].values
    below, above = found.attrs["tolerance"]
    for row, spectrum in enumerate(found["spectrum"].values):
        ax.plot(period, spectrum, color=GREY, lw=0.6, label=None if row else say("plot.select.records"))
    limits = {"below": six_digits(100.0 * below), "above": six_digits(100.0 * above)}
    band = (1.0 - below) * target, (1.0 + above) * target
    ax.fill_between(period, *band, color=PALE, zorder=0.5, lw=0, label=say("plot.select.tolerance", **limits))
    ax.plot(period, target, color=BLACK, lw=1.4, ls=DASHED, label=say("plot.select.target"))
    ax.plot(period, found["mean"].values, color=BLUE, lw=1.8, label=say("plot.select.mean"))
    ax.set(xscale="log", xlim=(period[0], period[-1]), ylim=(0.0, None))
    style.plain_ticks(ax.xaxis)
    ax.set(xlabel=say("plot.select.period"), ylabel=say("plot.select.acceleration"))
    style.legend(ax)
    style.title(ax, f"{style.plain(selection.attrs['title'])}\n{style.plain(found.attrs['target'])}")
    return ax
