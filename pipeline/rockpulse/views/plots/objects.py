"""Pictures of single objects: half-waves, an impulse sequence, blocks, a response."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.pictures import thinned
from rocking.response import Outcome, Response
from rockpulse.record.half_wave import STRONG, HalfWaves
from rockpulse.views.plots.bodies import outlines
from rockpulse.views.plots.rotation import moving_stretch
from rockpulse.views.plots.style import BLACK, BLUE, GREY, INSTANTS, PALE, RED, caption, legend_above, one_axes, title
from rockpulse.views.plots.words import plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["block_outlines", "half_wave_impulses", "response", "two_half_cycles"]

#: Colours of the outcomes, and lanes of a response whose histories are drawn.
COLOURS = {Outcome.AT_REST: GREY, Outcome.ROCKS: BLUE, Outcome.OVERTURNS: RED, Outcome.UNRESOLVED: BLACK}
LANES = 6

#: Height of the bar of a body that overturns, in the units of alpha_c of all others [-].
TOP = 1.2


def half_wave_impulses(waves: HalfWaves, ax: Axes | None = None) -> Axes:
    """Impulses of half-waves at their centroids, those above half the largest in another colour.

    Parameters
    ----------
    waves : HalfWaves
        Of one record.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.

    Returns
    -------
    matplotlib Axes
        Time in s, impulses in m/s.
    """
    ax = one_axes(ax, height=2.6)
    size = np.abs(waves.impulse)
    strong = size >= STRONG * np.max(size, initial=0.0)
    for chosen, colour, words in ((~strong, BLUE, "impulses"), (strong, RED, "above half the largest")):
        ax.vlines(waves.centroid[chosen], 0.0, waves.impulse[chosen], color=colour, lw=0.9, label=words)
    ax.axhline(0.0, color=BLACK, lw=0.5)
    ax.set_xlabel("time from the first sample [s]")
    ax.set_ylabel("impulse [m/s]")
    legend_above(ax, 2)
    title(ax, plain(waves.record_id), rows=1)
    return ax


def two_half_cycles(sequence: ImpulseSequence, ax: Axes | None = None) -> Axes:
    """Two half-cycles of an impulse sequence, the first of several, without the times that a block would give them.

    Parameters
    ----------
    sequence : ImpulseSequence
        With four intermediate impulses a half-cycle where it does not say how many; a block says that by how long its
        half-cycles last, see :func:`limit_accelerogram`.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.

    Returns
    -------
    matplotlib Axes
        Intervals dT after the first main impulse, impulses in m/s.
    """
    ax = one_axes(ax, height=2.6)
    mains, others = sequence.two_half_cycles()
    secondary = float(np.ravel(sequence.secondary)[0])
    ax.vlines(mains[:, 0], 0.0, mains[:, 1], color=RED, lw=2.0, label=f"main impulses, $I$ = {mains[0, 1]:.3g} m/s")
    words = f"secondary impulses, $I_s$ = {secondary:.3g} m/s"
    if others.size:
        ax.vlines(others[:, 0], 0.0, others[:, 1], color=BLUE, lw=1.4, label=words)
    elif secondary > 0.0:
        ax.fill_between([0.0, 2.0 * mains[1, 0]], -secondary, secondary, color=BLUE, alpha=0.25, lw=0.0, label=words)
    ax.axhline(0.0, color=BLACK, lw=0.5)
    ax.set_xlabel(r"intervals $\Delta T$ after the first main impulse [-]")
    ax.set_ylabel("impulse of the ground [m/s]")
    legend_above(ax, 2)
    if sequence.intermediate_count is None:
        caption(ax, "How many secondary impulses there are in a half-cycle depends on the block; drawn are four.")
    return ax


def block_outlines(block: Block) -> Figure:
    """A block, or the first eight of several, with their sizes and what holds them.

    Parameters
    ----------
    block : Block
        One block, or (m,).

    Returns
    -------
    matplotlib Figure
        Seen along the base, theta > 0 to the right; each to a scale of its own.
    """
    count = block.shape[0] if block.shape else 0
    return outlines([(f"block {lane + 1}", block.lane(lane), []) for lane in range(count)] or [("", block, [])])


def response(answer: Response, ax: Axes | None = None) -> Axes:
    """The rotation of a response in time, of the first lanes of several; without a history the peak of every lane.

    Parameters
    ----------
    answer : Response
        Of any model; with a history where `history=True` was asked for.
    ax : matplotlib Axes, optional
        Where to draw; by default on a figure of its own.

    Returns
    -------
    matplotlib Axes
        Rotation in rad over time in s, or theta_max/alpha_c over the number of the lane.
    """
    ax = one_axes(ax)
    codes, peaks = np.ravel(answer.outcome), np.ravel(answer.peak_rotation_ratio)
    if answer.time is None or answer.rotation is None:
        ax.axhline(1.0, color=BLACK, lw=0.8, ls=(0, (6, 3)))
        for outcome, colour in COLOURS.items():
            own = np.flatnonzero(codes == outcome)
            if own.size:
                heights = np.nan_to_num(np.minimum(peaks[own], TOP), nan=0.0)
                ax.bar(own + 1, np.maximum(heights, 0.01), color=colour, label=outcome.word.replace("_", " "))
        ax.set_xlabel("lane")
        ax.set_ylabel(r"peak $\theta_{max}/\alpha_c$ [-]")
        ax.set_ylim(0.0, 1.3)
        legend_above(ax, 4)
        caption(ax, "Dashed: alpha_c. A bar that reaches beyond it overturns.")
        return ax
    lanes = answer.rotation.reshape(-1, answer.time.size)
    ax.axhline(0.0, color=PALE, lw=0.8)
    first, last = moving_stretch([(answer.time, rotation) for rotation in lanes[:LANES]])
    shown = (answer.time >= first) & (answer.time <= last)
    ax.set_xlim(first, last)
    for place, rotation in enumerate(lanes[:LANES]):
        words = Outcome(codes[place]).word.replace("_", " ")
        words = words if len(lanes) == 1 else f"lane {place + 1}: {words}"
        ax.plot(*thinned(answer.time[shown], rotation[shown], INSTANTS), lw=1.0, label=words)
    ax.set_xlabel("time [s]")
    ax.set_ylabel(r"rotation $\theta$ [rad]")
    legend_above(ax, 3)
    if len(lanes) > LANES:
        caption(ax, f"Drawn are the first {LANES} of {len(lanes)} lanes.")
    return ax
