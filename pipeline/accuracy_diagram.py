"""The work-precision diagram: error of theta_max/alpha_c against the cost of an active sample."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["diagram", "draw_equation"]

#: Smaller errors are drawn here: no double holds them next to a rotation of alpha_c [-].
FLOOR = 1e-16

#: Steps with errors within this factor share one text.
NEIGHBOURS = 2.5


class _Style(NamedTuple):
    """Colour of Okabe & Ito, told apart by colour-blind eyes and, with the marker, in grey."""

    label: str
    color: str
    marker: str


STYLES = {
    ("rockpulse", "lanes"): _Style("rockpulse by longest step p dt", "#0072B2", "o"),
    ("rockpulse", "single"): _Style("rockpulse, one call a case", "#56B4E9", "s"),
    ("RK45", "single"): _Style("solve_ivp RK45 by rtol", "#D55E00", "^"),
    ("DOP853", "single"): _Style("solve_ivp DOP853 by rtol", "#222222", "D"),
}


def diagram(rows: pd.DataFrame) -> Figure:
    """Both equations side by side.

    Parameters
    ----------
    rows : DataFrame
        The table /work_precision of a report.

    Returns
    -------
    matplotlib Figure
        Bound to no window.
    """
    from matplotlib.figure import Figure

    equations = list(rows["equation"].unique())
    figure = Figure(figsize=(5.6 * len(equations), 5.2), layout="constrained")
    panels = figure.subplots(1, len(equations), sharex=True, sharey=True, squeeze=False)[0]
    for equation, ax in zip(equations, panels, strict=True):
        draw_equation(rows[rows["equation"] == equation], ax)
        ax.set_title(_title(equation, rows[rows["equation"] == equation]), loc="left", fontsize=10)
    for ax in panels[1:]:
        ax.set_ylabel("")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    return figure


def draw_equation(rows: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """One equation: a line per method, the median filled, the 90th percentile hollow, the setting beside the median.

    Errors below 1e-16 are drawn there; the label of that tick says so.

    Parameters
    ----------
    rows : DataFrame
        Rows of /work_precision of one equation.
    ax : matplotlib Axes, optional
        Where to draw; on a figure of its own without.

    Returns
    -------
    matplotlib Axes
    """
    from matplotlib.ticker import LogLocator, NullLocator

    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(layout="constrained").subplots()
    for (method, call), style in STYLES.items():
        points = rows[(rows["method"] == method) & (rows["call"] == call)].dropna(subset=["median"])
        if points.empty:
            continue
        costs = points["ns_per_active_sample"].to_numpy()
        median, p90 = (np.maximum(points[name].to_numpy(), FLOOR) for name in ("median", "p90"))
        ax.plot(costs, median, color=style.color, marker=style.marker, lw=1.4, ms=6, label=f"{style.label}: median")
        label = f"{style.label}: p90"
        ax.plot(costs, p90, color=style.color, marker=style.marker, mfc="white", ls="--", lw=1.0, ms=6, label=label)
        if (method, call) != ("rockpulse", "single"):
            _annotate(ax, str(points["option"].iloc[0]), points["setting"].to_numpy(), costs, median)
    spread = rows.loc[rows["method"] == "reference", "p90"]
    if spread.notna().any():
        name = "reference under a change of 1e-13: p90"
        ax.axhline(float(spread.iloc[0]), color="#777777", lw=1.0, ls=":", label=name)
    ax.set(xscale="log", yscale="log", xlabel="cost [ns per active sample]")
    ax.margins(x=0.2, y=0.06)
    ax.set_ylabel(r"error of $\theta_{max}/\alpha_c$ [-]")
    ax.yaxis.set_major_locator(LogLocator(base=100.0, numticks=30))  # the floor is an even power of ten
    ax.yaxis.set_major_formatter(_power_of_ten)
    ax.yaxis.set_minor_locator(NullLocator())
    ax.grid(which="major", color="#DDDDDD", lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _title(equation: str, rows: pd.DataFrame) -> str:
    integrators = rows.loc[rows["option"] == "rtol", "cases"]
    beside = f", {integrators.max()} of them by solve_ivp" if integrators.size else ""
    return f"{equation} equation: {rows['cases'].max()} cases{beside}"


def _annotate(ax: Axes, option: str, settings: np.ndarray, costs: np.ndarray, errors: np.ndarray) -> None:
    """The setting beside each point; steps of about the same error, and they cost about the same, share a text."""
    order = np.argsort(errors)
    apart = (np.diff(np.log(errors[order])) > np.log(NEIGHBOURS)) | (option == "rtol")
    breaks = np.flatnonzero(apart) + 1
    for same in np.split(order, breaks):
        first, last = settings[same].min(), settings[same].max()
        words = _power if option == "rtol" else "{:g}".format
        ax.annotate(
            words(first) if first == last else f"{words(first)}–{words(last)}",
            (costs[same].min(), np.exp(np.mean(np.log(errors[same])))),
            # Of two points of about the same error the dearer one has its text lower: side by side they would touch.
            xytext=(-8, 0) if option != "rtol" or (settings.size > 1 and first == settings[0]) else (-4, -12),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=8,
            color="#333333",
        )


def _power_of_ten(value: float, place: float) -> str:
    """Label of a tick of the errors; what is smaller than the floor stands there too."""
    exponent = round(np.log10(value))
    return rf"$\leq 10^{{{exponent}}}$" if exponent == round(np.log10(FLOOR)) else rf"$10^{{{exponent}}}$"


def _power(value: float) -> str:
    """1e-6 as a power of ten."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return ("" if mantissa == "1" else rf"{mantissa}$\times$") + f"$10^{{{int(exponent)}}}$"
