"""Draws the calibration of a site: overturning spectra, design sequences, and limit accelerograms."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.errors import ResultsError
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.sequences.design_spectrum import critical_main
from rockpulse.views.plots import style
from rockpulse.views.plots.impulse_sequences import limit_accelerogram
from rockpulse.views.plots.selection import one_name
from rockpulse.views.plots.spectra import curves_below_axes, record_lines, spectrum_axes
from rockpulse.views.plots.style import BLUE, DOTTED, PALE, RED, Panels
from rockpulse.views.shared.formatting import six_digits, three_digits
from rockpulse.views.shared.words import say
from rockpulse.views.text.site import site_warnings


def calibration(tree: xr.DataTree, axes: Panels | None = None) -> np.ndarray:
    """Draw the calibration of a site: overturning spectra of its records, and sequences with equal effect on a body.

    Parameters
    ----------
    tree : xarray.DataTree
        Result of :func:`rockpulse.calibrate`.
    axes : array_like of one or two matplotlib Axes, optional
        Axes to draw on; by default a new figure.

    Returns
    -------
    (1,) or (2,) ndarray of Axes
        The spectra and, if there is a design spectrum, the main impulses I that overturn the body with the largest I
        at its design scale factor, as functions of I_s/I for several N.

    Examples
    --------
    >>> rp.plots.calibration(site)[0].get_xlabel()
    'frequency parameter of the blocks $p$ [1/s]'
    """
    site = tree["site"].to_dataset()
    known = site.isel(block=np.flatnonzero(np.isfinite(site["main"].values)))
    count = 2 if known.sizes["block"] else 1
    panels = style.several_axes(axes, count, height=4.4 + 2.6 * (count - 1), height_ratios=[1.0, 0.7][:count]).ravel()
    site_spectrum(tree, panels[0])
    if count > 1:
        equal_effect(known.isel(block=int(np.argmax(known["main"].values))), panels[1])
    return panels


def equal_effect(own: xr.Dataset, ax: Axes) -> None:
    """Draw main impulses and ratios I_s/I of sequences with the same effect on a body of the site (closed form)."""
    block, (low, middle, high) = _block(own), (int(own[f"main_count{end}"]) for end in ("_lower", "", "_upper"))
    ratios, interval = np.linspace(0.0, 1.0, 101), float(own["interval"])
    at, most = float(own["main"]), 0.0
    for count in sorted({low, middle, high}):
        main = critical_main(block, ratios, interval, count) / float(own["design_factor"])
        dashes = "-" if count == middle else DOTTED if count < middle else "--"
        ax.plot(ratios, main, color=BLUE, lw=1.4, ls=dashes, label=say("plot.site.equal_of", count=str(count)))
        most = max(most, float(np.interp(float(own["ratio_upper"]), ratios, main)))
    ends = np.array([[float(own["ratio"] - own["ratio_lower"])], [float(own["ratio_upper"] - own["ratio"])]])
    ax.errorbar([float(own["ratio"])], [at], xerr=np.nan_to_num(ends), fmt="o", ms=4, color=RED, lw=1.2)
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.6 * max(most, at)), xlabel="$I_s/I$ [-]", ylabel="$I$ [m/s]")
    style.panel_title(ax, say("plot.site.equal", name=str(own["block"].item())), rows=1)
    style.legend_above(ax, 3)


def site_accelerogram(tree: xr.DataTree, block: str | None = None) -> np.ndarray:
    """Draw the limit accelerogram of a body under the design sequence of the site (Figures 1 and 2 of the paper)."""
    site = tree["site"].to_dataset()
    name = one_name(site, "block", block)
    own = site.sel(block=name)
    main, ratio = float(own["main"]), float(own["ratio"])
    if not np.isfinite(main):
        raise ResultsError(f"{name}: the site has no design sequence for this body, so there is no limit accelerogram")
    sequence = ImpulseSequence(
        main, ratio * main, float(own["interval"]), np.inf, int(own["main_count"]), spacing=str(site.attrs["spacing"])
    )
    return limit_accelerogram(_block(own), sequence, name=f"{style.plain(tree.attrs.get('title', ''))}, {name}")


def _block(own: xr.Dataset) -> Block:
    p, alpha, restitution = (float(own[name]) for name in ("p", "alpha_c", "restitution"))
    return Block.from_parameters(p, alpha, restitution, log=False)


def site_spectrum(tree: xr.DataTree, ax: Axes | None = None) -> Axes:
    """Draw the overturning spectra of the records of a site, their quantiles, and the design impulse of every body."""
    ax = style.one_axes(ax, height=4.4)
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    restitution = float(np.median(site["restitution"])) if site.sizes["block"] else 0.9
    grid = spectra["restitution"].values
    nearest = float(np.clip(restitution, grid[0], grid[-1]))
    curves = {
        str(name): np.exp(one.copy(data=np.log(one.values)).interp(restitution=nearest).transpose(..., "p").values)
        for name, one in spectra.items()
        if "restitution" in one.dims
    }
    p = spectra["p"].values
    record_lines(ax, p, curves["spectrum"])
    quantile, confidence = (six_digits(100.0 * float(site[name])) for name in ("quantile", "confidence"))
    if np.all(np.isfinite(curves["spectrum_design"])):
        words = say("plot.site.of_spectrum", confidence=confidence)
        ax.fill_between(p, curves["spectrum_84_lower"], curves["spectrum_84_upper"], color=PALE, lw=0, label=words)
        ax.plot(p, curves["spectrum_50"], color=BLUE, lw=1.8, label=say("plot.site.median"))
        ax.plot(p, curves["spectrum_84"], color=BLUE, lw=1.8, ls="--", label="84 %")
    known = site.isel(block=np.flatnonzero(np.isfinite(site["effective_impulse"].values)))
    if known.sizes["block"]:
        middle, low, high = (known[f"effective_impulse{end}"].values for end in ("", "_lower", "_upper"))
        words, ends = say("plot.site.effective", quantile=quantile), (middle - low, high - middle)
        ax.errorbar(known["p"].values, middle, yerr=ends, fmt="_", ms=9, color=RED, lw=1.2, label=words)
    # g tan(alpha)/p from I_1c = g alpha/(p cos alpha).
    alpha, rates = site["alpha_c"].values, site["p"].values.tolist()
    speeds = (site["critical_impulse"].values * np.sin(alpha) / alpha).tolist()
    points = dict(zip(map(str, site["block"].values), zip(rates, speeds, strict=True), strict=True))
    rows = spectrum_axes(ax, spectra["p"], points, STANDARD_GRAVITY, columns=2)
    style.title(ax, f"{style.plain(tree.attrs.get('title', ''))}, $C$ = {three_digits(restitution)}", rows=rows)
    said = style.notes(under_design=known.sizes["block"] > 0)
    said += [f"{style.plain(line[:1].upper() + line[1:])}." for line in site_warnings(site)[:1]]
    style.caption(ax, " ".join([*said, *curves_below_axes(ax, curves["spectrum"])]))
    return ax
