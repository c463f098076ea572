"""The rocking spectrum as a map over p and alpha_c, with the bodies of an assessment on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.views.plots.style import BLACK, FONT, RED, SMALL, caption, legend_above, one_axes, title
from rockpulse.views.plots.words import label, plain
from rockpulse.views.shared.terminal import shortened

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["body_marks", "rocking_spectrum", "size_scale"]

#: Sizes whose p is marked along the top [m].
_RADII = (0.2, 0.3, 0.5, 1.0, 2.0, 4.0, 8.0)

#: Blocks that overturn.
_FALLEN: dict[str, Any] = {"fc": RED, "ec": BLACK, "hatch": "/////", "hatch_linewidth": 0.25}

#: Bodies that are named one by one.
_NAMED = 12


def rocking_spectrum(
    spectrum: xr.Dataset,
    ax: Axes | None = None,
    bodies: Mapping[str, tuple[float, float]] | None = None,
    note: str = "",
) -> Axes:
    """Largest rotation over p and alpha_c: the darker, the further; red and hatched where blocks overturn.

    Parameters
    ----------
    spectrum : xarray.Dataset
        As :func:`rockpulse.rocking_spectrum` returns it.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.
    bodies : mapping of str to (float, float), optional
        p [1/s] and alpha_c [rad] of bodies, by their names.
    note : str
        Further words for the small print.

    Returns
    -------
    matplotlib Axes
        Its first collection is the map, its first patch the hatching of what overturns.
    """
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm
    from matplotlib.patches import Patch, PathPatch
    from matplotlib.path import Path

    ax = one_axes(ax, height=4.4)
    outcome = spectrum["outcome"].transpose("alpha_c", "p").values
    peak = spectrum["peak_rotation_ratio"].transpose("alpha_c", "p").values
    # Darker is worse, in grey as well, and rest is white. What overturns is hatched, in a colour of no rotation.
    colours = colormaps["cividis_r"].with_extremes(over=_FALLEN["fc"], bad="white")
    levels = np.linspace(0.0, 1.0, 11)
    fallen = outcome == Outcome.OVERTURNS
    # A rotation of alpha_c and beyond that does not overturn has the darkest colour.
    rotation = np.minimum(peak, np.nextafter(1.0, 0.0))
    shown = np.where(fallen, 2.0, np.where(outcome == Outcome.ROCKS, rotation, np.nan))
    p, alpha = spectrum["p"].values, spectrum["alpha_c"].values
    mesh = ax.pcolormesh(
        p, alpha, np.ma.masked_invalid(shown), cmap=colours, norm=BoundaryNorm(levels, colours.N), rasterized=True
    )
    if np.any(fallen):
        corners = np.asarray(mesh.get_coordinates())
        ways = [(0, 0), (0, 1), (1, 1), (1, 0), (0, 0)]
        around = np.stack([corners[i : i + len(alpha), j : j + len(p)] for i, j in ways], axis=2)[fallen]
        cells = Path.make_compound_path(*(Path(cell, closed=True) for cell in around))
        ax.add_patch(PathPatch(cells, **_FALLEN | {"fc": "none"}, lw=0.0, rasterized=True))
    ax.grid(visible=False)
    figure = ax.get_figure()
    assert figure is not None
    bar = figure.colorbar(mesh, ax=ax, ticks=levels[::2], pad=0.02, fraction=0.05)
    bar.ax.tick_params(labelsize=SMALL, width=0.6)
    bar.set_label(label(spectrum["peak_rotation_ratio"].attrs), fontsize=FONT)
    handles: list[Any] = []
    if np.any(fallen):
        handles.append(Patch(**_FALLEN, lw=0.5, label="overturns"))
    if np.any(outcome == Outcome.AT_REST):
        handles.append(Patch(fc="white", ec=BLACK, lw=0.5, label="at rest"))
    if np.any(outcome == Outcome.UNRESOLVED):
        row, column = np.nonzero(outcome == Outcome.UNRESOLVED)
        ax.plot(p[column], alpha[row], ls="none", marker="x", ms=3, color=RED, label="unresolved")
        handles += ax.get_legend_handles_labels()[0]
    handles += body_marks(ax, dict(bodies or {}))
    ax.set_xlim(_edges(p))
    ax.set_ylim(_edges(alpha))
    ax.set_xlabel(label(spectrum["p"].attrs, symbol="$p$"))
    ax.set_ylabel(label(spectrum["alpha_c"].attrs, symbol=r"$\alpha_c$"))
    size_scale(ax, float(spectrum.attrs["gravity"]))
    columns = 3
    legend_above(ax, columns, across=True, lift=32.0, handles=handles)
    factor = float(spectrum.attrs["scale"])
    words = plain(spectrum.attrs["record"]) + ("" if factor == 1.0 else f", times {factor:g}")
    title(ax, words, rows=3 - (-len(handles) // columns))
    c = spectrum["restitution"].values
    span = f"{c.min():.3f}" if np.ptp(c) == 0.0 else f"{c.min():.3f} to {c.max():.3f}, with $\\alpha_c$ (Housner)"
    remarks = [f"Nonlinear equation, $C$ = {span}."]
    if np.all(outcome == Outcome.AT_REST):
        remarks.append("Every block stays at rest.")
    if bodies:
        remarks.append("Bodies with another $C$ rock differently from the blocks of the map.")
    caption(ax, " ".join([*remarks, note]).strip())
    return ax


def body_marks(ax: Axes, bodies: dict[str, tuple[float, float]]) -> list[Any]:
    """Draw numbers on the map for the bodies, and list their names in the legend."""
    from matplotlib.lines import Line2D

    handles = []
    for number, (name, (p, alpha)) in enumerate(bodies.items(), start=1):
        if number > _NAMED:
            ax.plot(p, alpha, "o", ms=3, mfc="white", mec=BLACK, mew=0.8)
            continue
        mark = rf"$\mathbf{{{number}}}$"
        ax.plot(p, alpha, ls="none", marker="o", ms=9, mfc="white", mec=BLACK, mew=0.8)
        ax.plot(p, alpha, ls="none", marker=mark, ms=5, color=BLACK, mew=0.2)
        handles.append(
            Line2D([], [], ls="none", marker=mark, ms=5, color=BLACK, mew=0.2, label=plain(shortened(name, 24)))
        )
    if len(bodies) > _NAMED:
        handles.append(
            Line2D(
                [], [], ls="none", marker="o", ms=3, mfc="white", mec=BLACK, label=f"{len(bodies) - _NAMED} more bodies"
            )
        )
    return handles


def _edges(values: np.ndarray) -> tuple[float, float]:
    """The outer edges of the cells around the first and the last value."""
    first = values[1] - values[0] if values.size > 1 else 0.1 * values[0]
    last = values[-1] - values[-2] if values.size > 1 else 0.1 * values[0]
    return float(values[0] - 0.5 * first), float(values[-1] + 0.5 * last)


def size_scale(ax: Axes, gravity: float) -> None:
    """Draw a scale of R of a rectangle along the top: p^2 = 3 g/(4 R)."""

    def swapped(values: Any) -> np.ndarray:
        return 0.75 * gravity / np.maximum(np.asarray(values, dtype=float), 1e-6) ** 2

    def back(values: Any) -> np.ndarray:
        return np.sqrt(0.75 * gravity / np.maximum(np.asarray(values, dtype=float), 1e-6))

    low, high = ax.get_xlim()
    top = ax.secondary_xaxis("top", functions=(swapped, back))
    shown = [radius for radius in _RADII if low <= float(back(np.array(radius))) <= high]
    top.set_xticks(shown, [f"{radius:g}" for radius in shown], fontsize=SMALL)
    top.minorticks_off()
    top.tick_params(width=0.6, length=3)
    top.set_xlabel("half the diagonal R of a rectangle [m]", fontsize=FONT)
