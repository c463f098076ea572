"""Figures 4 and 5 of Casapulla & Maione (2017), from the datasets of the study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.pictures import thinned
from rocking.response import Outcome
from rockpulse.errors import ResultsError
from rockpulse.option import hint
from rockpulse.views.plots.style import (
    BLACK,
    INSTANTS,
    PALE,
    SMALL,
    Panels,
    caption,
    legend,
    looks,
    panel_title,
    ramp,
    several_axes,
)
from rockpulse.views.plots.words import label, wrapped

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["figure4", "figure5"]

#: I_s/I that the paper draws.
_PAPER = (0.3, 0.7)

#: Upper end of the rotation axis of a history, theta/alpha_c [-].
_TOP = 1.1


def figure4(
    tree: xr.DataTree, axes: Panels | None = None, spacing: str | None = None, count: float = np.inf
) -> np.ndarray:
    """Largest rotation against I_s/I for every I/I_1c, a panel for each restitution.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.study.figure4` returns it.
    axes : array_like of matplotlib Axes, optional
        Where to draw, one for each restitution; by default on a figure of their own.
    spacing : str, optional
        Where the secondary impulses act; the first of the file by default.
    count : int or inf
        Secondary impulses n in every half-cycle.

    Returns
    -------
    (c,) ndarray of Axes
        A line for every I/I_1c, of NaN where the block overturns or the closed form stands for no motion.

    Raises
    ------
    ResultsError
        For a spacing or a count that the file does not hold.
    """
    data = tree["figure4"].to_dataset()
    spacing = _known(data, "spacing", spacing)
    counts = data["intermediate_count"].values
    if count not in counts:
        raise ResultsError(f"count: expected one of {', '.join(f'{n:g}' for n in counts)}, got {count:g}")
    own = data.sel(spacing=spacing, intermediate_count=count).isel(p=0)
    cases = own["restitution"].values
    panels = several_axes(axes, 1, cases.size, height=3.6, sharex=True, sharey=True)[0]
    styles = ramp([f"{ratio:g}" for ratio in own["impulse_ratio"].values])
    whole = True
    for ax, c, letter in zip(panels, cases, "abcdefgh", strict=False):
        ax.axvspan(*_PAPER, color=PALE, alpha=0.5, lw=0)
        for style, ratio in zip(styles, own["impulse_ratio"].values, strict=True):
            curve = own.sel(restitution=c, impulse_ratio=ratio)
            whole &= not _curve(ax, curve, style)
        ax.set_xlim(0.0, 1.0)
        ax.set_ylim(0.0, 1.05)
        ax.axhline(1.0, color=BLACK, lw=0.8, ls=(0, (6, 3)))
        ax.set_xlabel(wrapped(label(own["secondary_ratio"].attrs), 40))
        panel_title(ax, f"({letter}) $C$ = {c:g}", width=40)
    panels[0].set_ylabel(wrapped(label(own["peak_rotation_ratio"].attrs), 46))
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
        f'Spacing "{spacing}", {n}, p = {float(own["p"]):.4g} 1/s, input of {float(tree.attrs["duration"]):g} s. '
        "A curve begins where the block stands (circle); left of it, and without a curve, it overturns. "
        "Grey: the range of the paper."
    )
    if not whole:
        words += " Gaps: the closed form stands for no motion of a block."
    caption(panels[0], words)
    return panels


def _curve(ax: Axes, curve: xr.Dataset, style: Any) -> bool:
    """Draw the curve of one I/I_1c, and return whether the closed form stands for no motion somewhere in it."""
    ratio, peak = curve["secondary_ratio"].values, curve["peak_rotation_ratio"].values.copy()
    empty = curve["no_motion"].values == 1
    peak[np.isinf(peak) | empty] = np.nan
    stands = np.isfinite(peak)
    ax.plot(ratio, peak, color=style.color, ls=style.line, lw=1.2, label=style.label)  # all NaN where it overturns
    if np.any(stands):
        first = int(np.flatnonzero(stands)[0])
        if first > 0:
            ax.plot(ratio[first], peak[first], "o", ms=3.5, mfc="white", mec=style.color, ls="none")
    return bool(np.any(empty))


def figure5(tree: xr.DataTree, axes: Panels | None = None, spacing: str | None = None) -> np.ndarray:
    """Time histories of the two blocks for every I_s/I: a column for each block, a row for each restitution.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.study.figure5` returns it.
    axes : array_like of matplotlib Axes, optional
        Where to draw, restitutions x blocks; by default on a figure of their own.
    spacing : str, optional
        Where the secondary impulses act; the first of the file by default.

    Returns
    -------
    (c, b) ndarray of Axes

    Raises
    ------
    ResultsError
        For a spacing that the file does not hold.
    """
    data = tree["figure5"].to_dataset()
    own = data.sel(spacing=_known(data, "spacing", spacing))
    cases, blocks = own["restitution"].values, [str(name) for name in own["block"].values]
    panels = several_axes(axes, cases.size, len(blocks), height=2.3 * cases.size + 0.9, sharex=True, sharey=True)
    styles = looks([f"{ratio:g}" for ratio in own["secondary_ratio"].values])
    letters = iter("abcdefghijklmnop")
    for row, c in zip(panels, cases, strict=True):
        for ax, block in zip(row, blocks, strict=True):
            lane = own.sel(restitution=c, block=block)
            _histories(ax, lane, styles)
            words = f"({next(letters)}) {block}, $R$ = {float(lane['radius']):g} m, $C$ = {c:g}, "
            panel_title(ax, words + f"$I$ = {float(lane['main_impulse']):.3g} m/s", width=60)
    ax = panels[0, 0]
    ax.set_xlim(0.0, float(own["time"][-1]))
    ax.set_ylim(-_TOP, _TOP)
    for ax in panels[-1]:
        ax.set_xlabel(label(own["time"].attrs))
    for ax in panels[:, 0]:
        ax.set_ylabel(r"$\theta/\alpha_c$ [-]")
    figure = panels[0, 0].get_figure()
    handles, names = panels[0, 0].get_legend_handles_labels()
    if axes is None and figure is not None:
        figure.legend(
            handles,
            [f"$I_s/I$ = {name}" for name in names],
            loc="outside upper left",
            ncols=len(names),
            fontsize=SMALL,
            frameon=False,
        )
    else:
        legend(panels[0, 0], title="$I_s/I$", ncols=2)
    sizes = [
        f"{name} {float(own['width'].sel(block=name)):g} x {float(own['height'].sel(block=name)):.3g} m"
        for name in blocks
    ]
    words = (
        f"Blocks (width x height): {', '.join(sizes)}. "
        f'Spacing "{own["spacing"].item()}", trial interval {float(own["interval"]):g} s, $I = I_{{2c}}$: without '
        r"secondary impulses the second half-cycle is exactly critical and creeps to $\alpha_c$. "
        "Cross: the block overturns."
    )
    if bool((own["no_motion"] == 1).any()):
        words += " Not drawn: motions through the ground, for which the closed form does not stand."
    caption(panels[-1, 0], words)
    return panels


def _histories(ax: Axes, lane: xr.Dataset, styles: list[Any]) -> None:
    time = lane["time"].values
    ax.axhline(0.0, color=BLACK, lw=0.5)
    for level in (-1.0, 1.0):
        ax.axhline(level, color=BLACK, lw=0.8, ls=(0, (6, 3)))
    for place, style in enumerate(styles):
        one = lane.isel(secondary_ratio=place)
        if int(one["no_motion"]) == 1:
            ax.plot([], [], color=style.color, ls=style.line, lw=1.1, label=style.label)
            continue
        rotation = one["rotation_ratio"].values
        ax.plot(*thinned(time, rotation, INSTANTS), color=style.color, ls=style.line, lw=1.1, label=style.label)
        seen = np.flatnonzero(np.isfinite(rotation))
        if int(one["outcome"]) == Outcome.OVERTURNS and seen.size < rotation.size:
            at = seen[-1]
            ax.plot(time[at], rotation[at], marker="X", ms=7, color=style.color, mec="white", mew=0.6, ls="none")


def _known(data: xr.Dataset, dimension: str, name: str | None) -> str:
    known = [str(item) for item in data[dimension].values]
    if name is None:
        return known[0]
    if name not in known:
        raise ResultsError(f'{dimension}: expected one of {", ".join(known)}, got "{name}"{hint(name, known)}')
    return name
