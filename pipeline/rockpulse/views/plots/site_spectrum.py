"""The overturning spectrum of a site over p, with the bodies as points that stand or fall by it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockpulse.views.plots.spectrum_map import body_marks, size_scale
from rockpulse.views.plots.style import BLUE, GREY, PALE, RED, caption, legend_above, one_axes, title
from rockpulse.views.plots.words import label, plain

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["site_spectrum"]

#: Spectra of single records that are drawn.
_DRAWN = 200

#: C at which the spectrum is drawn without bodies.
_RESTITUTION = 0.9

_TICKS = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)


def site_spectrum(tree: xr.DataTree, ax: Axes | None = None) -> Axes:
    """Median and 84 % spectrum of a site at the median C of its bodies, and the design of each body beside its point.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.calibrate_site` returns it with the method "spectrum".
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.

    Returns
    -------
    matplotlib Axes
        Logarithmic in p and S.
    """
    ax = one_axes(ax, height=4.4)
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    restitution = float(np.median(site["restitution"])) if site.sizes["block"] else _RESTITUTION
    grid = spectra["restitution"].values
    nearest = float(np.clip(restitution, grid[0], grid[-1]))
    curves = {
        str(name): np.exp(one.copy(data=np.log(one.values)).interp(restitution=nearest).transpose(..., "p").values)
        for name, one in spectra.items()
        if "restitution" in one.dims
    }
    p = spectra["p"].values
    ax.set_xscale("log")
    ax.set_yscale("log")
    count = site.sizes["record"]
    for place, curve in enumerate(curves["spectrum"][:_DRAWN]):
        ax.plot(p, curve, color=GREY, lw=0.5, alpha=0.5, label="" if place else f"{count} records")
    quantile, confidence = (100.0 * float(site[name]) for name in ("quantile", "confidence"))
    designed = bool(np.all(np.isfinite(curves["spectrum_design"])))
    if designed:
        words = f"{confidence:g} % interval of the 84 % spectrum"
        ax.fill_between(p, curves["spectrum_84_lower"], curves["spectrum_84_upper"], color=PALE, lw=0, label=words)
        ax.plot(p, curves["spectrum_50"], color=BLUE, lw=1.8, label="median over earthquakes")
        ax.plot(p, curves["spectrum_84"], color=BLUE, lw=1.8, ls="--", label="84 %")
    known = site.isel(block=np.flatnonzero(np.isfinite(site["effective_impulse"].values)))
    if known.sizes["block"]:
        middle, low, high = (known[f"effective_impulse{end}"].values for end in ("", "_lower", "_upper"))
        words = f"$I_{{eff}}$ of the design ({quantile:g} %) at the body's own C"
        ax.errorbar(
            known["p"].values, middle, yerr=(middle - low, high - middle), fmt="_", ms=9, color=RED, lw=1.2, label=words
        )
    # g tan(alpha)/p from I_1c = g alpha/(p cos alpha).
    alpha, rates = site["alpha_c"].values, site["p"].values.tolist()
    speeds = (site["critical_impulse"].values * np.sin(alpha) / alpha).tolist()
    points = dict(zip(map(str, site["block"].values), zip(rates, speeds, strict=True), strict=True))
    handles = [*ax.get_legend_handles_labels()[0], *body_marks(ax, points)]
    ax.set_xlim(p[0], p[-1])
    ticks = [value for value in _TICKS if p[0] <= value <= p[-1]]
    ax.set_xticks(ticks, [f"{value:g}" for value in ticks])
    ax.minorticks_off()
    ax.set_xlabel(label(spectra["p"].attrs, symbol="$p$"))
    ax.set_ylabel(r"effective impulse $S$, or $g\,\tan\alpha_c/p$ of a body [m/s]")
    size_scale(ax, 9.80665)
    columns = 2
    legend_above(ax, columns, across=True, lift=32.0, handles=handles)
    title(ax, f"{plain(tree.attrs.get('title', ''))}, $C$ = {restitution:.3g}", rows=3 - (-len(handles) // columns))
    said = ["A body overturns under the design where the middle of its bar lies above its point."]
    remarks = [line[:1].upper() + line[1:] for line in str(site["remarks"].item()).splitlines() if line]
    caption(ax, " ".join([*said[: known.sizes["block"]], *(f"{plain(one)}." for one in remarks[:1])]))
    return ax
