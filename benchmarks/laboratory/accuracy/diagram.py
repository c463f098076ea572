"""The work-precision diagram: error of theta_max/alpha_c against the cost of an active sample."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from rockpulse.views.plots.style import BLACK, BLUE, GREY, RED, SKY, SMALL, Look, panel_title, several_axes

#: Smaller errors are drawn here: no double holds them next to a rotation of alpha_c [-].
FLOOR = 1e-16
#: Steps with errors within this factor share one text.
NEIGHBOURS = 2.5
METHODS = {
    ("rockpulse", "lanes"): Look("rockpulse by longest step p dt", BLUE, "-", "o"),
    ("rockpulse", "single"): Look("rockpulse, one call a case", SKY, "-", "s"),
    ("RK45", "single"): Look("solve_ivp RK45 by rtol", RED, "-", "^"),
    ("DOP853", "single"): Look("solve_ivp DOP853 by rtol", BLACK, "-", "D"),
}


def diagram(rows: pd.DataFrame) -> Figure:
    """Every equation side by side: a line per method, the median filled, the 90th percentile hollow.

    The setting stands beside the median. Errors below 1e-16 are drawn there; the label of that tick says so.
    """
    equations = list(rows["equation"].unique())
    panels = several_axes(None, 1, len(equations), height=4.6, sharex=True, sharey=True)[0]
    for equation, ax in zip(equations, panels, strict=True):
        own = rows[rows["equation"] == equation]
        _draw_equation(own, ax)
        integrators = own.loc[own["option"] == "rtol", "cases"]
        beside = f",\n{integrators.max()} of them by solve_ivp" if integrators.size else ""
        panel_title(ax, f"{equation} equation: {own['cases'].max()} cases{beside}", width=50)
    panels[0].set_ylabel(r"error of $\theta_{max}/\alpha_c$ [-]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure = panels[0].get_figure()
    place = {"loc": "outside lower center", "ncols": 2, "columnspacing": 1.2}
    figure.legend(handles, labels, frameon=False, fontsize=SMALL, **place)
    return figure


def _draw_equation(rows: pd.DataFrame, ax: Axes) -> None:
    for (method, call), style in METHODS.items():
        points = rows[(rows["method"] == method) & (rows["call"] == call)].dropna(subset=["median"])
        if points.empty:
            continue
        costs = points["ns_per_active_sample"].to_numpy()
        median, p90 = (np.maximum(points[name].to_numpy(), FLOOR) for name in ("median", "p90"))
        common: dict[str, Any] = {"color": style.color, "marker": style.marker, "ms": 4.5}
        ax.plot(costs, median, lw=1.3, label=f"{style.label}: median", **common)
        ax.plot(costs, p90, mfc="white", ls="--", lw=0.9, label=f"{style.label}: p90", **common)
        if (method, call) != ("rockpulse", "single"):
            _annotate(ax, str(points["option"].iloc[0]), points["setting"].to_numpy(), costs, median)
    spread = rows.loc[rows["method"] == "reference", "p90"]
    if spread.notna().any():
        name = "reference under a change of 1e-13: p90"
        ax.axhline(float(spread.iloc[0]), color=GREY, lw=1.0, ls=":", label=name)
    ax.set(xscale="log", yscale="log", xlabel="cost [ns per active sample]")
    ax.margins(x=0.22, y=0.06)
    ax.yaxis.set_major_locator(LogLocator(base=100.0, numticks=30))  # the floor is an even power of ten
    ax.yaxis.set_major_formatter(_power_of_ten)
    ax.yaxis.set_minor_locator(NullLocator())


def _annotate(ax: Axes, option: str, settings: np.ndarray, costs: np.ndarray, errors: np.ndarray) -> None:
    """Write the setting beside each point; neighbours of about the same error, and hence cost, share a text."""
    order = np.argsort(errors)
    apart = (np.diff(np.log(errors[order])) > np.log(NEIGHBOURS)) | (option == "rtol")
    breaks = np.flatnonzero(apart) + 1
    for same in np.split(order, breaks):
        first, last = settings[same].min(), settings[same].max()
        words = _power if option == "rtol" else "{:g}".format
        ax.annotate(
            words(first) if first == last else f"{words(first)}–{words(last)}",
            (costs[same].min(), np.exp(np.mean(np.log(errors[same])))),
            # The dearer of two points of about the same error has its text lower: side by side the texts would touch.
            xytext=(-6, 0) if option != "rtol" or (settings.size > 1 and first == settings[0]) else (-3, -10),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=SMALL - 1.0,
            color="#333333",
        )


def _power_of_ten(value: float, place: float) -> str:
    """Label of a tick of the errors; the tick at the floor also stands for all smaller ones."""
    exponent = round(np.log10(value))
    return rf"$\leq 10^{{{exponent}}}$" if exponent == round(np.log10(FLOOR)) else rf"$10^{{{exponent}}}$"


def _power(value: float) -> str:
    """1e-6 as a power of ten."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return ("" if mantissa == "1" else rf"{mantissa}$\times$") + f"$10^{{{int(exponent)}}}$"
