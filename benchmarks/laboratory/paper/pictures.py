"""Figures 4 and 5 of Casapulla & Maione (2017), from the datasets of the study."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from rocking.pictures import thinned
from rocking.response import Outcome
from rockpulse.views.plots.style import (
    BLACK,
    INSTANTS,
    PALE,
    SMALL,
    Look,
    caption,
    legend,
    looks,
    panel_title,
    several_axes,
)

#: I_s/I that the paper draws.
_PAPER = (0.3, 0.7)
#: Upper end of the rotation axis of a history, theta/alpha_c [-].
_TOP = 1.1


def _ramp(names: list[str]) -> list[Look]:
    """The looks of the named steps of one quantity, in order: from dark to light, neighbours by other lines too."""
    shades = colormaps["cividis"](np.linspace(0.0, 0.88, len(names)))
    return [Look(name, to_hex(shades[place]), *looks(names[:4])[place % 4][2:]) for place, name in enumerate(names)]


def draw_figure4(figure: xr.Dataset, spacing: str, count: float = np.inf) -> Figure:
    """Largest rotation against I_s/I: a panel for each restitution, a line for each I/I_1c (first p of the dataset).

    A line has gaps where the block overturns or the closed form is no physical motion.
    """
    own = figure.sel(spacing=spacing, intermediate_count=count).isel(p=0)
    cases = own["restitution"].values
    panels = several_axes(None, 1, cases.size, height=3.6, sharex=True, sharey=True)[0]
    styles = _ramp([f"{ratio:g}" for ratio in own["impulse_ratio"].values])
    for ax, c, letter in zip(panels, cases, "abcdefgh", strict=False):
        ax.axvspan(*_PAPER, color=PALE, alpha=0.5, lw=0)
        for style, ratio in zip(styles, own["impulse_ratio"].values, strict=True):
            _curve(ax, own.sel(restitution=c, impulse_ratio=ratio), style)
        ax.axhline(1.0, color=BLACK, lw=0.8, ls=(0, (6, 3)))
        ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.05), xlabel="$I_s/I$, secondary over main impulse [-]")
        panel_title(ax, f"({letter}) $C$ = {c:g}", width=40)
    panels[0].set_ylabel("largest $\\theta/\\alpha_c$ under the limited input [-]")
    legend(
        panels[-1],
        title="$I/I_{1c}$",
        title_fontsize=SMALL,
        loc="upper left",
        bbox_to_anchor=(1.0, 1.0),
        handlelength=2.6,
    )
    n = "n to infinity" if np.isinf(count) else f"n = {count:g}"
    words = (
        f'Spacing "{spacing}", {n}, p = {float(own["p"]):.4g} 1/s, input of {figure.attrs["duration"]:g} s. '
        "A curve begins where the block stands (circle); left of it, and without a curve, it overturns. "
        "Grey: the range of the paper."
    )
    if bool(own["no_motion"].any()):
        words += " Gaps: there the closed form is not a motion of a block."
    caption(panels[0], words)
    return panels[0].get_figure()


def _curve(ax: Axes, curve: xr.Dataset, style: Any) -> None:
    ratio, peak = curve["secondary_ratio"].values, curve["peak_rotation_ratio"].values.copy()
    peak[np.isinf(peak) | curve["no_motion"].values] = np.nan
    stands = np.flatnonzero(np.isfinite(peak))
    ax.plot(ratio, peak, color=style.color, ls=style.line, lw=1.2, label=style.label)
    if stands.size and stands[0] > 0:
        ax.plot(ratio[stands[0]], peak[stands[0]], "o", ms=3.5, mfc="white", mec=style.color, ls="none")


def draw_figure5(figure: xr.Dataset, spacing: str) -> Figure:
    """Time histories of the two blocks for every I_s/I: a column for each block, a row for each restitution."""
    own = figure.sel(spacing=spacing)
    cases, blocks = own["restitution"].values, [str(name) for name in own["block"].values]
    panels = several_axes(None, cases.size, len(blocks), height=2.3 * cases.size + 0.9, sharex=True, sharey=True)
    styles = looks([f"{ratio:g}" for ratio in own["secondary_ratio"].values])
    letters = iter("abcdefghijklmnop")
    for row, c in zip(panels, cases, strict=True):
        for ax, block in zip(row, blocks, strict=True):
            lane = own.sel(restitution=c, block=block)
            _histories(ax, lane, styles)
            words = f"({next(letters)}) {block}, $R$ = {float(lane['radius']):g} m, $C$ = {c:g}, "
            panel_title(ax, words + f"$I$ = {float(lane['main_impulse']):.3g} m/s", width=60)
    panels[0, 0].set(xlim=(0.0, float(own["time"][-1])), ylim=(-_TOP, _TOP))
    for ax in panels[-1]:
        ax.set_xlabel("time from the first main impulse [s]")
    for ax in panels[:, 0]:
        ax.set_ylabel(r"$\theta/\alpha_c$ [-]")
    picture = panels[0, 0].get_figure()
    handles, names = panels[0, 0].get_legend_handles_labels()
    labels = [f"$I_s/I$ = {name}" for name in names]
    picture.legend(handles, labels, loc="outside upper left", ncols=len(names), fontsize=SMALL, frameon=False)
    sizes = [
        f"{name} {float(own['width'].sel(block=name)):g} x {float(own['height'].sel(block=name)):.3g} m"
        for name in blocks
    ]
    words = (
        f"Blocks (width x height): {', '.join(sizes)}. "
        f'Spacing "{spacing}", trial interval {float(own["interval"]):g} s, $I = I_{{2c}}$: without '
        r"secondary impulses the second half-cycle is exactly critical and creeps to $\alpha_c$. "
        "Cross: the block overturns."
    )
    if bool(own["no_motion"].any()):
        words += " Not drawn: motions through the ground, for which the closed form does not stand."
    caption(panels[-1, 0], words)
    return picture


def _histories(ax: Axes, lane: xr.Dataset, styles: list[Any]) -> None:
    time = lane["time"].values
    ax.axhline(0.0, color=BLACK, lw=0.5)
    for level in (-1.0, 1.0):
        ax.axhline(level, color=BLACK, lw=0.8, ls=(0, (6, 3)))
    for place, style in enumerate(styles):
        one = lane.isel(secondary_ratio=place)
        if bool(one["no_motion"]):
            ax.plot([], [], color=style.color, ls=style.line, lw=1.1, label=style.label)
            continue
        rotation = one["rotation_ratio"].values
        ax.plot(*thinned(time, rotation, INSTANTS), color=style.color, ls=style.line, lw=1.1, label=style.label)
        seen = np.flatnonzero(np.isfinite(rotation))
        if int(one["outcome"]) == Outcome.OVERTURNS and seen.size < rotation.size:
            at = seen[-1]
            ax.plot(time[at], rotation[at], marker="X", ms=7, color=style.color, mec="white", mew=0.6, ls="none")
