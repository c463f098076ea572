"""Where the checks of codes are unsafe and where they are dear: what bodies bear over what a check allows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.views.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    PALE,
    RED,
    Panels,
    caption,
    panel_title,
    plain_ticks,
    several_axes,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["code_checks"]

#: The checks that are drawn, each on a panel, and what they are called.
PANELS = {
    "linear": "linear,\n617/2009 and 7/2019",
    "nonlinear": "nonlinear,\n617/2009",
    "displacement": "displacement,\n7/2019 (SLV)",
}

#: Ratios outside these are drawn at them [-].
ENDS = (0.4, 20.0)

#: Width over which the points of one body are spread, of the distance of two bodies.
SPREAD = 0.6


def code_checks(tree: xr.DataTree, axes: Panels | None = None) -> np.ndarray:
    """Factor at which the probability of overturning is 50 % over the factor that a check allows, by body.

    Parameters
    ----------
    tree : xarray.DataTree
        Of ``rockpulse study code-check``.
    axes : array_like of matplotlib Axes, optional
        Where to draw, one for each of three checks; by default on a figure of their own.

    Returns
    -------
    (3,) ndarray of Axes
        A point for each channel, a bar at the median of each body; below 1 the check is unsafe, above it dear.
    """
    cases = tree["code_check"].to_dataset().to_dataframe()
    panels = several_axes(axes, 1, len(PANELS), height=3.9, sharex=True, sharey=True)[0]
    sizes = cases[["slenderness", "radius"]].round(6).drop_duplicates().sort_values(["slenderness", "radius"])
    bodies = list(sizes.itertuples(index=False, name=None))
    for ax, (name, words) in zip(panels, PANELS.items(), strict=True):
        _panel(ax, cases.assign(ratio=cases["factor_50"] / cases[name]), bodies)
        panel_title(ax, words, width=40)
    panels[0].set_ylabel("$f_{50}$ over the factor that is allowed [-]")
    slender = sorted({one[0] for one in bodies})
    firsts = [next(place for place, one in enumerate(bodies) if one[0] == value) for value in slender]
    lasts = [max(place for place, one in enumerate(bodies) if one[0] == value) for value in slender]
    for ax in panels:
        ax.set_xticks([0.5 * (first + last) for first, last in zip(firsts, lasts, strict=True)])
        ax.set_xticklabels([f"{value:g}" for value in slender])
        ax.grid(visible=False, axis="x")
        for first in firsts[1:]:
            ax.axvline(first - 0.5, color=PALE, lw=0.6)
    panels[1].set_xlabel("slenderness, from left to right larger bodies")
    radii = ", ".join(f"{value:g}" for value in sorted({one[1] for one in bodies}))
    caption(
        panels[1],
        f"{tree.attrs['title']}. Of each slenderness R {radii} m; a point a channel, the bar its median; below 1 a "
        "body overturns before the check says so (unsafe), far above it stands what the check fails (dear).",
    )
    return panels


def _panel(ax: Axes, cases: Any, bodies: list[tuple[float, float]]) -> None:
    ax.axhspan(ENDS[0], 1.0, color=RED, alpha=0.08, lw=0)
    ax.axhline(1.0, color=BLACK, lw=0.8)
    for place, (slenderness, radius) in enumerate(bodies):
        own = cases[np.isclose(cases["slenderness"], slenderness) & np.isclose(cases["radius"], radius)]
        ratio = np.sort(own["ratio"].to_numpy())
        shift = SPREAD * (np.arange(ratio.size) / max(1, ratio.size - 1) - 0.5)
        shown = np.clip(ratio, *ENDS)
        ax.scatter(place + shift, shown, s=4.0, lw=0, color=np.where(ratio < 1.0, RED, BLUE), alpha=0.7)
        middle = float(np.clip(np.median(ratio), *ENDS))
        ax.plot([place - 0.4, place + 0.4], [middle, middle], color=GREEN, lw=2.0, solid_capstyle="butt")
    ax.set(yscale="log", ylim=ENDS)
    plain_ticks(ax.yaxis)
