"""The accelerogram with its half-waves, and the impulses that stand for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.pictures import thinned
from rockpulse.views.plots.style import (
    BLACK,
    BLUE,
    FONT,
    GREY,
    INSTANTS,
    ORANGE,
    RED,
    SKY,
    Panels,
    caption,
    dressed,
    figure_of,
    legend_above,
    several_axes,
    title,
)
from rockpulse.views.plots.words import label, plain, wrapped

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["accelerogram"]

#: Part of the intense phase that is shown before and after it, and at least so many seconds.
_AROUND, _LEAST = 0.1, 1.0

#: A half-wave above this part of the largest one is strong (as `main_count = "half-largest"` counts them).
_STRONG = 0.5

#: Stretches of time that the whole record is drawn by: it is an overview.
_WHOLE = 450

#: Impulses below this part of the largest are thinner than a line.
_VISIBLE = 0.01


def accelerogram(motion: xr.Dataset, axes: Panels | None = None) -> np.ndarray:
    """The whole record, its intense phase with the half-waves, and their impulses at the centroids.

    Parameters
    ----------
    motion : xarray.Dataset
        As :func:`~rockpulse.plots.stored_motion` or :func:`~rockpulse.plots.motion_of_record` returns it.
    axes : array_like of three matplotlib Axes, optional
        Where to draw; by default on a figure of their own.

    Returns
    -------
    (3,) ndarray of Axes
        The record, the intense phase, the impulses.
    """
    if axes is None:
        figure = figure_of(height=5.6)
        panels = figure.subplots(3, 1, height_ratios=[0.55, 1.0, 1.0])
        panels[2].sharex(panels[1])
        panels = np.array([dressed(ax) for ax in panels])
    else:
        panels = several_axes(axes, 3)[:, 0]
    phase = float(motion["intense_start"]), float(motion["intense_end"])
    around = max(_AROUND * (phase[1] - phase[0]), _LEAST)
    end = float(motion["time"][-1])
    window = max(phase[0] - around, 0.0), min(phase[1] + around, end)
    for ax in panels:
        ax.axhline(0.0, color=BLACK, lw=0.5)
        ax.axvspan(*phase, color=SKY, alpha=0.2, lw=0, label="intense phase")
    _whole(motion, panels[0])
    _half_waves(motion, phase, window, panels[1])
    _impulses(motion, phase, window, panels[2])
    names = [motion.attrs["record"], *([motion.attrs["words"]] if axes is None and motion.attrs["words"] else [])]
    title(panels[0], "\n".join(map(plain, names)))
    panels[0].set_xlim(0.0, end)
    for ax in panels[1:]:
        ax.set_xlim(*window)
    panels[2].set_xlabel(label(motion["time"].attrs))
    for ax, words in zip(panels, ("whole record", "intense phase", "impulses"), strict=True):
        ax.set_gid(f"panel-{words.replace(' ', '-')}")
    return panels


def _whole(motion: xr.Dataset, ax: Axes) -> None:
    time, acceleration = motion["time"].values, motion["acceleration"].values
    ax.plot(*thinned(time, acceleration, _WHOLE), color=GREY, lw=0.5)
    strongest = int(np.argmax(np.abs(acceleration)))
    ax.plot(time[strongest], acceleration[strongest], marker="o", ms=3.5, mfc="none", color=RED, ls="none")
    peak = abs(acceleration[strongest])
    ax.annotate(
        f"PGA {peak:.3g} m/s² at {time[strongest]:.2f} s",
        (0.995, 0.95),
        xycoords="axes fraction",
        ha="right",
        va="top",
        fontsize=FONT - 1.0,
        color=RED,
    )
    ax.set_ylabel("[m/s²]")


def _half_waves(motion: xr.Dataset, phase: tuple[float, float], window: tuple[float, float], ax: Axes) -> None:
    """The acceleration, with the strong half-waves of the phase filled."""
    time, acceleration = motion["time"].values, motion["acceleration"].values
    inside = (time >= window[0]) & (time <= window[1])
    ax.plot(*thinned(time[inside], acceleration[inside], INSTANTS), color=GREY, lw=0.6)
    first = True
    for start, end in zip(*_strong_waves(motion, phase), strict=True):
        within = (time > start) & (time < end)
        instants = np.concatenate([[start], time[within], [end]])
        values = np.interp(instants, time, acceleration)
        words = "half-waves above half the largest impulse" if first else None
        ax.fill_between(instants, values, color=ORANGE, alpha=0.85, lw=0.4, ec=ORANGE, label=words, zorder=3)
        first = False
    ax.set_ylabel(wrapped(label(motion["acceleration"].attrs), 24))
    legend_above(ax, 2)


def _strong_waves(motion: xr.Dataset, phase: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    impulse, centroid = np.abs(motion["impulse"].values), motion["centroid"].values
    within = (centroid >= phase[0]) & (centroid <= phase[1])
    strong = within & (impulse >= _STRONG * np.max(impulse[within], initial=0.0)) & (impulse > 0.0)
    return motion["start"].values[strong], motion["end"].values[strong]


def _impulses(motion: xr.Dataset, phase: tuple[float, float], window: tuple[float, float], ax: Axes) -> None:
    impulse, centroid = motion["impulse"].values, motion["centroid"].values
    largest = float(np.max(np.abs(impulse), initial=0.0))
    shown = (centroid >= window[0]) & (centroid <= window[1]) & (np.abs(impulse) > _VISIBLE * largest)
    within = (centroid >= phase[0]) & (centroid <= phase[1])
    ax.plot(*_stems(centroid[shown], impulse[shown]), color=BLUE, lw=0.9, label="impulses")
    strong = within & (np.abs(impulse) >= _STRONG * np.max(np.abs(impulse[within]), initial=0.0)) & shown
    if np.any(strong):
        ax.plot(centroid[strong], impulse[strong], "o", color=BLUE, ms=3.0, label="above half the largest")
    for name, symbol, style in (("main_impulse", "I", "-"), ("secondary_impulse", "I_s", (0, (1.2, 1.2)))):
        size = float(motion[name])
        if np.isfinite(size):
            ax.axhline(size, color=RED, ls=style, lw=1.0, label=rf"$\pm {symbol}$ = {size:.3g} m/s")
            ax.axhline(-size, color=RED, ls=style, lw=1.0)
    limit = max(largest, 1e-12) * 1.15
    ax.set_ylim(-limit, limit)
    ax.set_ylabel(wrapped(label(motion["impulse"].attrs), 24))
    handles, words = ax.get_legend_handles_labels()
    kept = [place for place, word in enumerate(words) if word != "intense phase"]
    legend_above(ax, 4, handles=[handles[place] for place in kept])
    if not np.isfinite(float(motion["main_impulse"])):
        caption(ax, "No impulse sequence was calibrated: the intense phase holds too few half-waves.")


def _stems(places: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines from zero to every height, as one broken line."""
    nothing = np.full(places.size, np.nan)
    return (
        np.stack([places, places, nothing], axis=1).ravel(),
        np.stack([np.zeros(places.size), heights, nothing], axis=1).ravel(),
    )
