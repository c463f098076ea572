"""Draws the spectra of selected records with their mean, the target and its tolerance."""

import xarray as xr
from matplotlib.axes import Axes

from rockpulse.views.plots import style
from rockpulse.views.plots.style import BLACK, BLUE, DASHED, GREY, PALE
from rockpulse.views.shared.formatting import six_digits
from rockpulse.views.shared.words import say


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
    ax.set_xscale("log")
    ax.set_xlim(period[0], period[-1])
    ax.set_ylim(bottom=0.0)
    style.plain_ticks(ax.xaxis)
    ax.set_xlabel(say("plot.select.period"))
    ax.set_ylabel(say("plot.select.acceleration"))
    style.legend(ax)
    style.title(ax, f"{style.plain(selection.attrs['title'])}\n{style.plain(found.attrs['target'])}")
    return ax
