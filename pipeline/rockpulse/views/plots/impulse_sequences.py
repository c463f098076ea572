"""Draws the limit accelerogram of a block (Casapulla & Maione 2017, Figures 1 and 2)."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import impulse_train, main_impulses_given, sequence_response
from rocking.response import Response
from rockpulse.views.plots import style
from rockpulse.views.plots.style import BLACK, BLUE, GREY, ORANGE, RED, SMALL, Panels
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import numerals, say

#: Largest number of main impulses in a picture, and shortest half-cycle whose peak is written, as a share of the width.
_MAIN_DRAWN, _NAMED = 12, 0.07
#: Options of the text next to a half-cycle.
_BESIDE: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL - 0.5}


def limit_accelerogram(
    block: Block, sequence: ImpulseSequence, axes: Panels | None = None, name: str = ""
) -> np.ndarray:
    """Draw the impulses of the limit accelerogram of a block, without and with the secondary sequence.

    Parameters
    ----------
    block, sequence : Block, ImpulseSequence
        One block, whose half-cycles determine the times of the main impulses, and one finite sequence.
    axes : array_like of two matplotlib Axes, optional
        Axes to draw on; by default a new figure with a common time axis.
    name : str
        Title, such as the names of record and body.

    Returns
    -------
    (2,) ndarray of Axes
        The main sequence alone (Figure 1 of the paper), and with the secondary sequence (Figure 2). The last of
        ``ax.lines`` are bars, one for each half-cycle of the block, labelled with the largest abs(theta)/alpha_c.

    Examples
    --------
    >>> sequence = rp.models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    >>> [ax.get_ylabel() for ax in rp.plots.limit_accelerogram(pier, sequence)]
    ['impulse of the ground [m/s]', 'impulse of the ground [m/s]']
    """
    panels = style.several_axes(axes, 2, height=5.0, sharex=True, sharey=True)[:, 0]
    drawn = [replace(sequence, secondary=0.0), sequence]
    found = [sequence_response(block, own) for own in drawn]
    last, cycles = 0.0, []
    for ax, words, own, response in zip(panels, ("alone", "both"), drawn, found, strict=True):
        times, impulses = impulse_train(block, own)
        main = np.isclose(np.abs(impulses), own.main)
        if own.secondary > 0.0 and math.isclose(own.secondary, own.main):
            main = _main_places(response, own, times)
        starts = times[main][:_MAIN_DRAWN]
        visible = times <= (starts[-1] if starts.size else 0.0)
        size = say("plot.sequence.main", size=three_digits(float(own.main)))
        _draw(ax, times[visible & main], impulses[visible & main], size, color=BLUE, lw=1.6, ms=4.5)
        if own.secondary > 0.0:
            size = say("plot.sequence.secondary", size=three_digits(float(own.secondary)))
            size = say("plot.sequence.continuous") if own.spacing == "continuous" else size
            _draw(ax, times[visible & ~main], impulses[visible & ~main], size, color=ORANGE, lw=1.0, ms=2.8)
        ax.axhline(0.0, color=BLACK, lw=0.6)
        ax.set_ylabel(say("plot.sequence.impulse"))
        style.panel_title(ax, say(f"plot.sequence.{words}"), rows=1)
        table = response.half_cycles
        assert table is not None
        # After the end of the table its last row repeats.
        rows = np.minimum(np.arange(starts.size), max(table.duration.size - 1, 0))
        durations = table.duration[rows]
        cycles.append((starts, durations, table.peak[rows]))
        last = max(last, float(np.max(starts + np.where(np.isfinite(durations), durations, 0.0), initial=0.0)))
    room = max(last, 1.0 / float(block.p))
    panels[0].set_xlim(-0.04 * room, 1.12 * room)
    limit = 1.2 * max(float(sequence.main), 1e-12)
    panels[0].set_ylim(-1.12 * limit, limit)
    for ax, bars in zip(panels, cycles, strict=True):
        _bars(ax, -1.12 * float(sequence.main), room, *bars)
        style.legend_above(ax, 3)
    panels[-1].set_xlabel(say("plot.from_first.impulse"))
    if name:
        style.title(panels[0], name, rows=1)
    style.caption(panels[-1], _warnings(found, sequence))
    return panels


def _main_places(response: Response, sequence: ImpulseSequence, times: np.ndarray) -> np.ndarray:
    """Return a mask of the main impulses among all impulses; secondary impulses may have the same size."""
    table = response.half_cycles
    assert table is not None
    main = np.zeros(times.size, dtype=bool)
    at = 0
    while at < times.size:
        row = min(int(np.count_nonzero(main)), table.impulse_count.size - 1)
        main[at] = True
        at += 1 + (2 if sequence.spacing == "continuous" else max(int(table.impulse_count[row]), 0))
    return main


def _draw(ax: Any, times: np.ndarray, sizes: np.ndarray, words: str, color: str, lw: float, ms: float) -> None:
    ax.vlines(times, 0.0, sizes, color=color, lw=lw)
    for chosen, marker, label in ((sizes > 0.0, "^", words), (sizes <= 0.0, "v", None)):
        ax.plot(times[chosen], sizes[chosen], ls="none", marker=marker, ms=ms, color=color, label=label)


def _bars(ax: Any, low: float, room: float, starts: np.ndarray, durations: np.ndarray, peaks: np.ndarray) -> None:
    for start, duration, peak in zip(starts, durations, peaks, strict=True):
        if not math.isfinite(duration):
            ax.plot(start, low, marker="x", color=RED, ms=5, mew=1.5, ls="none", label=say("limit_state.overturning"))
            words = say("answer.overturns")
            ax.annotate(words, (start, low), (7, 0), ha="left", va="center", color=RED, **_BESIDE)
            continue
        ax.plot([start, start + duration], [low, low], color=GREY, lw=1.0, marker="|", ms=6)
        if duration > _NAMED * room:
            words = numerals(f"{peak:.2f}" if peak >= 0.095 else f"{peak:.1g}")
            middle = (start + 0.5 * duration, low)
            ax.annotate(words, middle, (0, 3), ha="center", va="bottom", color="#333333", **_BESIDE)


def _warnings(found: list[Response], sequence: ImpulseSequence) -> str:
    words = style.notes(below=True)
    count = [int(main_impulses_given(one, sequence)) for one in found]
    if max(count) > _MAIN_DRAWN:
        words.append(say("plot.sequence.shown", most=_MAIN_DRAWN, one=count[0], other=count[1]))
    if sequence.secondary > 0.0:
        interval = three_digits(float(sequence.interval), "s")
        words.append(say("plot.sequence.interval", interval=interval, spacing=sequence.spacing))
    return " ".join(words + style.notes(ground_contact=bool(found[1].ground_contact)))
