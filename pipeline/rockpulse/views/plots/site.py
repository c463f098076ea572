"""Draws the records and the design of a site: sequence parameters, or overturning spectra."""

import textwrap
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, NullLocator
from scipy.special import ndtr

from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.plots import style
from rockpulse.views.plots.spectra import curves_below_axes, record_lines, spectrum_axes
from rockpulse.views.plots.style import BLACK, BLUE, DOTTED, GREY, PALE, RED, SKY, SMALL, Panels
from rockpulse.views.shared.formatting import six_digits, three_digits
from rockpulse.views.shared.words import say, translated
from rockpulse.views.text.site import site_warnings

#: Largest ratio of the design to the range of the records at which the axis includes both; longest warning
#: [characters].
_NEAR, _WARNING = 3.0, 230
#: Symbols of the parameters of a sequence.
_SYMBOLS = {"main": "$I$", "ratio": "$I_s/I$", "interval": r"$\Delta T$"}


def calibration(tree: xr.DataTree, axes: Panels | None = None) -> np.ndarray:
    """Draw the design of a site together with the overturning spectra or the sequence parameters of its records.

    Parameters
    ----------
    tree : xarray.DataTree
        Result of :func:`rockpulse.calibrate`.
    axes : array_like of six matplotlib Axes, optional
        Axes to draw on; by default a new figure. A site with a spectrum uses the first Axes.

    Returns
    -------
    (6,) ndarray of Axes
        Main impulse, I_s/I, interval, number of main impulses, duration, and the legend. Each step of a distribution is
        a record, with its weight as height; an interval from the calibration of a single record is a horizontal line.
        The shape is (1,) for a site with a spectrum.

    Examples
    --------
    >>> rp.plots.calibration(site)[0].get_xlabel()
    'frequency parameter of the blocks $p$ [1/s]'
    """
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        return np.array([site_spectrum(tree, None if axes is None else np.ravel(np.array(axes, dtype=object))[0])])
    panels = style.several_axes(axes, 3, 2, height=7.2).ravel()
    for ax, name in zip(panels, site["parameter"].values.tolist(), strict=False):
        _parameter(ax, site.sel(parameter=name), name, site["weight"].values)
    for ax in panels[0::2]:
        ax.set_ylabel(say("plot.site.share"))
    last = panels[-1]
    last.set_axis_off()
    handles, words = panels[0].get_legend_handles_labels()
    last.legend(handles, words, loc="center left", fontsize=SMALL, frameon=False, handlelength=2.4, labelspacing=0.8)
    counts = style.record_counts(int(site["record_count"]), int(site["event_count"]))
    name = style.plain(tree.attrs.get("title", ""))
    style.title(
        panels[0],
        say(
            "plot.site.title",
            name=name,
            records=counts,
            method=translated(f"options.{site.attrs['method']}", site.attrs["method"]),
        ),
    )
    style.caption(panels[-2], " ".join(_warnings(site)))
    return panels


def _parameter(ax: Axes, own: xr.Dataset, name: str, weight: np.ndarray) -> None:
    """Draw the distribution of a sequence parameter over the records, its lognormal fit, and its design value."""
    value, confidence = own["value"].values, six_digits(100.0 * float(own["confidence"]))
    known = np.isfinite(value) & (weight > 0.0)
    words = style.readable_name(translated(f"parameters.{name}", str(own["parameter_name"].item())))
    style.panel_title(ax, words.replace(", $I_s/I$", ""), width=52)
    symbol = _SYMBOLS.get(name) or say(f"plot.site.{name}")
    ax.set_xlabel(f"{symbol} [{style.unit(str(own['parameter_unit'].item()))}]")
    ax.set_ylim(0.0, 1.02)
    ax.set_xscale("log")
    beside: dict[str, Any] = {"transform": ax.transAxes, "fontsize": SMALL, "color": GREY}
    if not np.any(known):
        ax.text(0.5, 0.5, say("plot.site.no_value"), ha="center", **beside)
        return
    order = np.argsort(value[known], kind="stable")
    ordered, share = value[known][order], np.cumsum(weight[known][order]) / np.sum(weight[known])
    steps = np.r_[ordered[0], ordered], np.r_[0.0, share]
    ax.step(*steps, where="post", color=BLACK, lw=0.9, label=say("plot.site.records"))
    ax.plot(ordered, share, "o", color=BLACK, ms=2.6)
    _fit(ax, own, confidence)
    design, low, high = (float(own[name]) for name in ("design", "design_lower", "design_upper"))
    if np.isfinite(design):
        ax.axvline(design, color=RED, lw=1.3, ls=(0, (5, 1.5)), label=say("plot.site.design"))
        if np.isfinite(low) and np.isfinite(high):
            words = say("plot.site.of_design", confidence=confidence)
            ax.axvspan(low, high, color=RED, alpha=0.13, lw=0, label=words)
    ax.set_xlim(_range(ordered, design))
    style.plain_ticks(ax.xaxis, 100.0)
    low, high = ax.get_xlim()
    if high / low < 6.0:  # round numbers for less than a decade
        ax.xaxis.set_major_locator(MaxNLocator(5, integer=name == "main_count"))
        ax.xaxis.set_minor_locator(NullLocator())
    missing = int(np.count_nonzero(~np.isfinite(value) & (weight > 0.0)))
    if missing:
        ax.text(0.02, 0.97, say("plot.site.without_limit", count=missing), va="top", **beside)


def _range(values: np.ndarray, design: float) -> tuple[float, float]:
    """Return the limits of the axis: the values of the records, and the design value if it is near them."""
    low, high = float(values[0]), float(values[-1])
    if low / _NEAR <= design <= high * _NEAR:
        low, high = min(low, design), max(high, design)
    if low == high:
        low, high = 0.7 * low, 1.4 * high
    room = (high / low) ** 0.08
    return low / room, high * room


def _fit(ax: Axes, own: xr.Dataset, confidence: str) -> None:
    """Draw the lognormal distribution of a parameter, and the confidence interval of its median."""
    median, dispersion = float(own["median"]), float(own["dispersion"])
    if np.isfinite(median) and np.isfinite(dispersion) and dispersion > 0.0:
        values = median * np.exp(np.linspace(-2.6, 2.6, 101) * dispersion)
        shares = ndtr(np.log(values / median) / dispersion)
        ax.plot(values, shares, color=BLUE, lw=1.2, ls=DOTTED, label=say("plot.site.fit"))
    low, high = float(own["median_lower"]), float(own["median_upper"])
    if np.isfinite(low) and np.isfinite(high):
        words = say("plot.site.of_median", confidence=confidence)
        ax.plot([low, high], [0.5, 0.5], color=SKY, lw=4.0, solid_capstyle="butt", zorder=2.5, label=words)


def _warnings(site: xr.Dataset) -> list[str]:
    """Return sentences for the caption: the quantile of the design, and the most serious warning."""
    words = [say("plot.site.quantile", quantile=six_digits(float(site["quantile"])))]
    warnings = _sentences(site)
    for one in warnings[:1]:
        first = textwrap.shorten(one, _WARNING, placeholder=" …")
        words.append(style.plain(first if first.endswith("…") else f"{first}."))
    return words + ([say("plot.more_warnings", count=len(warnings) - 1)] if len(warnings) > 1 else [])


def _sentences(site: xr.Dataset) -> list[str]:
    return [line[:1].upper() + line[1:] for line in site_warnings(site)]


def site_spectrum(tree: xr.DataTree, ax: Axes | None = None) -> Axes:
    """Draw the spectra of the records of a site, their quantiles, and the design impulse of every body."""
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
    said += [f"{style.plain(one)}." for one in _sentences(site)[:1]]
    style.caption(ax, " ".join([*said, *curves_below_axes(ax, curves["spectrum"])]))
    return ax
