"""The limit accelerogram and its secondary sequence (Casapulla & Maione 2017, Figures 1 and 2)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import impulse_train, sequence_response
from rocking.response import Outcome
from rockpulse.views.plots import style
from rockpulse.views.plots.style import BLACK, BLUE, GREY, ORANGE, RED, SMALL, Panels

#: Longest stretch that is shown, in main impulses: more of them are the same again.
_MAIN_SHOWN = 12

#: Half-cycles shorter than this part of the picture have no room for their peak.
_NAMED = 0.07

#: Words beside a half-cycle.
_BESIDE: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL - 0.5}

_TITLES = (
    "(a) main impulses $I$ right after each impact (resonance: an upper-bound type input)",
    "(b) with the secondary sequence: impulses $I_s$ of alternating sign, the first against $I$",
)


def limit_accelerogram(
    block: Block, sequence: ImpulseSequence, axes: Panels | None = None, name: str = ""
) -> np.ndarray:
    """Impulses of the limit accelerogram of a block, without and with the secondary sequence.

    Parameters
    ----------
    block, sequence : Block, ImpulseSequence
        One block, whose half-cycles set the times of the main impulses, and one sequence that ends.
    axes : array_like of two matplotlib Axes, optional
        Where to draw; by default on a figure of their own, with a common time.
    name : str
        Stands above: the record and the block.

    Returns
    -------
    (2,) ndarray of Axes
        The main sequence alone (Figure 1 of the paper), and with the secondary one (Figure 2). The last of ``lines``
        of each is the half-cycles of the block, abs(theta)/alpha_c at their peaks.
    """
    panels = style.several_axes(axes, 2, height=5.0, sharex=True, sharey=True)[:, 0]
    last, cycles = 0.0, []
    for ax, words, own in zip(panels, _TITLES, (replace(sequence, secondary=0.0), sequence), strict=True):
        times, impulses = impulse_train(block, own)
        main = np.isclose(np.abs(impulses), own.main)
        if own.secondary > 0.0 and math.isclose(own.secondary, own.main):
            main = _main_places(block, own, times)
        starts = times[main][:_MAIN_SHOWN]
        shown = times <= (starts[-1] if starts.size else 0.0)
        legend = f"main impulses, $I$ = {own.main:.3g} m/s"
        _draw(ax, times[shown & main], impulses[shown & main], legend, color=BLUE, lw=1.6, ms=4.5)
        if own.secondary > 0.0:
            legend = f"secondary impulses, $I_s$ = {own.secondary:.3g} m/s"
            if own.spacing == "continuous":
                legend = r"limit of infinitely many secondary impulses: $I_s/2$ at either end"
            _draw(ax, times[shown & ~main], impulses[shown & ~main], legend, color=ORANGE, lw=1.0, ms=2.8)
        ax.axhline(0.0, color=BLACK, lw=0.6)
        ax.set_ylabel("impulse of the ground [m/s]")
        style.panel_title(ax, words, rows=1)
        table = sequence_response(block, own).half_cycles
        assert table is not None
        # Where the table ends, its last row repeats itself.
        rows = np.minimum(np.arange(starts.size), max(table.duration.size - 1, 0))
        durations = table.duration[rows]
        cycles.append((starts, durations, table.peak[rows]))
        last = max(last, float(np.max(starts + np.where(np.isfinite(durations), durations, 0.0), initial=0.0)))
    room = max(last, 1.0 / float(block.p))
    panels[0].set_xlim(-0.04 * room, 1.12 * room)
    for ax, bars in zip(panels, cycles, strict=True):
        _bars(ax, -1.12 * float(sequence.main), room, *bars)
    limit = 1.2 * max(float(sequence.main), 1e-12)
    panels[0].set_ylim(-1.12 * limit, limit)
    for ax in panels:
        style.legend_above(ax, 3)
    panels[-1].set_xlabel("time from the first main impulse [s]")
    if name:
        style.title(panels[0], name, rows=1)
    style.caption(panels[-1], _remarks(block, sequence))
    return panels


def _main_places(block: Block, sequence: ImpulseSequence, times: np.ndarray) -> np.ndarray:
    """Places of the main impulses in the train where I_s = I: n secondary ones follow each."""
    table = sequence_response(block, sequence).half_cycles
    assert table is not None
    main = np.zeros(times.size, dtype=bool)
    at = 0
    while at < times.size:
        row = min(int(np.count_nonzero(main)), table.impulse_count.size - 1)
        main[at] = True
        at += 1 + (2 if sequence.spacing == "continuous" else max(int(table.impulse_count[row]), 0))
    return main


def _draw(ax: Any, times: np.ndarray, sizes: np.ndarray, words: str, color: str, lw: float, ms: float) -> None:
    """Impulses as arrows: a line with a head that points away from zero."""
    ax.vlines(times, 0.0, sizes, color=color, lw=lw)
    for chosen, marker, label in ((sizes > 0.0, "^", words), (sizes <= 0.0, "v", None)):
        ax.plot(times[chosen], sizes[chosen], ls="none", marker=marker, ms=ms, color=color, label=label)


def _bars(ax: Any, low: float, room: float, starts: np.ndarray, durations: np.ndarray, peaks: np.ndarray) -> None:
    """Draw the half-cycles as bars along the bottom: their length sets the time of the next main impulse."""
    for start, duration, peak in zip(starts, durations, peaks, strict=True):
        if not math.isfinite(duration):
            ax.plot(start, low, marker="x", color=RED, ms=5, mew=1.5, ls="none", label="overturning")
            ax.annotate("overturns", (start, low), (7, 0), ha="left", va="center", color=RED, **_BESIDE)
            continue
        ax.plot([start, start + duration], [low, low], color=GREY, lw=1.0, marker="|", ms=6)
        if duration > _NAMED * room:
            words = f"{peak:.2f}" if peak >= 0.095 else f"{peak:.1g}"
            middle = (start + 0.5 * duration, low)
            ax.annotate(words, middle, (0, 3), ha="center", va="bottom", color="#333333", **_BESIDE)


def _remarks(block: Block, sequence: ImpulseSequence) -> str:
    found = [sequence_response(block, own) for own in (replace(sequence, secondary=0.0), sequence)]
    words = r"Below each: half-cycles of the block with their peak $\theta/\alpha_c$."
    count = [_main_count(one, sequence) for one in found]
    if max(count) > _MAIN_SHOWN:
        words += f" Shown: the first {_MAIN_SHOWN} main impulses of {' and '.join(map(str, count))}."
    if sequence.secondary > 0.0:
        words += f' Trial interval $\\Delta T$ = {sequence.interval:.3g} s, spacing "{sequence.spacing}".'
    if found[1].ground_contact:
        words += (
            " The corrected march passes through the ground inside a half-cycle: the closed form stands for no motion."
        )
    return words


def _main_count(response: Any, sequence: ImpulseSequence) -> int:
    durations = response.half_cycles.duration
    if durations.size == 0:
        return 0
    if response.outcome == Outcome.OVERTURNS:
        return int(response.overturning_half_cycle)
    left = max(math.ceil((sequence.duration - float(np.sum(durations))) / float(durations[-1])), 0)
    most = math.inf if sequence.main_count is None else sequence.main_count
    return int(min(durations.size + left, most))
