"""The overturning spectrum of a site over p, with the bodies as points that stand or fall by it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.plots.overturning_curves import below_the_picture, record_lines, spectrum_axes
from rockpulse.views.plots.style import BLUE, PALE, RED, caption, one_axes, title
from rockpulse.views.plots.words import plain

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["site_spectrum"]

#: C at which the spectrum is drawn without bodies.
_RESTITUTION = 0.9


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
    record_lines(ax, p, curves["spectrum"])
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
    rows = spectrum_axes(ax, spectra["p"], points, STANDARD_GRAVITY, columns=2)
    title(ax, f"{plain(tree.attrs.get('title', ''))}, $C$ = {restitution:.3g}", rows=rows)
    said = ["A body overturns under the design where the middle of its bar lies above its point."]
    remarks = [line[:1].upper() + line[1:] for line in str(site["remarks"].item()).splitlines() if line]
    said = [*said[: known.sizes["block"]], *(f"{plain(one)}." for one in remarks[:1])]
    caption(ax, " ".join([*said, *below_the_picture(ax, curves["spectrum"])]))
    return ax
