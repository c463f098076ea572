"""Pictures of single objects: half-waves, an impulse sequence, a response, and bodies."""

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from rocking.body.block import Block
from rocking.body.outline import Outline
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.pictures import thinned
from rocking.response import Outcome, Response
from rockpulse.config.restraint_settings import floors_from_text
from rockpulse.record.half_wave import STRONG, HalfWaves
from rockpulse.views.plots import style
from rockpulse.views.plots.rotation_panels import moving_stretch
from rockpulse.views.plots.selection import block_of, one_name
from rockpulse.views.plots.style import BLACK, BLUE, DASHED, GREY, INSTANTS, ORANGE, PALE, RED, SMALL
from rockpulse.views.shared.formatting import six_digits, three_digits
from rockpulse.views.shared.words import say

#: Colours of the outcomes, and largest number of motions whose histories are drawn.
COLOURS = {Outcome.AT_REST: GREY, Outcome.ROCKS: BLUE, Outcome.OVERTURNS: RED, Outcome.UNRESOLVED: BLACK}
LANES = 6
#: Largest number of bodies in a picture and in a row; height of the bar of an overturning body, divided by alpha_c [-].
MOST, IN_ROW, TOP = 8, 4, 1.2


def half_wave_impulses(waves: HalfWaves, axes: Axes | None = None) -> Axes:
    """Draw the impulses of half-waves at their centroids; impulses above half of the largest have another colour."""
    ax = style.one_axes(axes, height=2.6)
    size = np.abs(waves.impulse)
    strong = size >= STRONG * np.max(size, initial=0.0)
    for chosen, colour, words in ((~strong, BLUE, "impulses"), (strong, RED, "strong_impulses")):
        label = say(f"plot.ground.{words}")
        ax.vlines(waves.centroid[chosen], 0.0, waves.impulse[chosen], color=colour, lw=0.9, label=label)
    ax.axhline(0.0, color=BLACK, lw=0.5)
    ax.set(xlabel=say("plot.from_first.sample"), ylabel=say("plot.object.impulse"))
    style.legend_above(ax, 2)
    style.title(ax, style.plain(waves.record_id), rows=1)
    return ax


def two_half_cycles(sequence: ImpulseSequence, axes: Axes | None = None) -> Axes:
    """Draw two half-cycles of an impulse sequence over time in units of dT; of several sequences, the first is drawn.

    If the number of intermediate impulses is not given, four are drawn; the true number depends on the half-cycles of a
    block.
    """
    ax = style.one_axes(axes, height=2.6)
    mains, others = sequence.two_half_cycles()
    secondary = float(np.ravel(sequence.secondary)[0])
    words = say("plot.sequence.main", size=three_digits(mains[0, 1]))
    ax.vlines(mains[:, 0], 0.0, mains[:, 1], color=RED, lw=2.0, label=words)
    words = say("plot.sequence.secondary", size=three_digits(secondary))
    if others.size:
        ax.vlines(others[:, 0], 0.0, others[:, 1], color=BLUE, lw=1.4, label=words)
    elif secondary > 0.0:
        ax.fill_between([0.0, 2.0 * mains[1, 0]], -secondary, secondary, color=BLUE, alpha=0.25, lw=0.0, label=words)
    ax.axhline(0.0, color=BLACK, lw=0.5)
    ax.set(xlabel=say("plot.object.intervals"), ylabel=say("plot.sequence.impulse"))
    style.legend_above(ax, 2)
    style.caption(ax, " ".join(style.notes(of_block=sequence.intermediate_count is None)))
    return ax


def block_outlines(block: Block, axes: style.Panels | None = None) -> np.ndarray:
    """Draw a block with its sizes and restraints, or the first eight blocks of an array, each at its own scale."""
    count = block.shape[0] if block.shape else 0
    names = [say("plot.object.block", number=lane + 1) for lane in range(count)]
    return _outlines([(name, block.lane(lane), []) for lane, name in enumerate(names)] or [("", block, [])], axes)


def response(answer: Response, axes: Axes | None = None) -> Axes:
    """Draw the first motions of a response over time or, if it has no history, the peak of every motion."""
    ax = style.one_axes(axes)
    codes, peaks = np.ravel(answer.outcome), np.ravel(answer.peak_rotation_ratio)
    if answer.time is None or answer.rotation is None:
        return _peaks(ax, codes, peaks)
    lanes = answer.rotation.reshape(-1, answer.time.size)
    ax.axhline(0.0, color=PALE, lw=0.8)
    first, last = moving_stretch([(answer.time, rotation) for rotation in lanes[:LANES]])
    inside = (answer.time >= first) & (answer.time <= last)
    ax.set_xlim(first, last)
    for place, rotation in enumerate(lanes[:LANES]):
        words = _word(Outcome(codes[place]))
        words = words if len(lanes) == 1 else say("plot.object.of_lane", lane=place + 1, words=words)
        ax.plot(*thinned(answer.time[inside], rotation[inside], INSTANTS), lw=1.0, label=words)
    ax.set(xlabel=say("plot.object.time"), ylabel=say("plot.object.rotation"))
    style.legend_above(ax, 3)
    style.caption(ax, say("plot.object.lanes", count=LANES, total=len(lanes)) if len(lanes) > LANES else "")
    return ax


def _word(outcome: Outcome) -> str:
    return say("grade.rocks" if outcome == Outcome.ROCKS else f"answer.{outcome.name.lower()}")


def _peaks(ax: Axes, codes: np.ndarray, peaks: np.ndarray) -> Axes:
    ax.axhline(1.0, color=BLACK, lw=0.8, ls=DASHED)
    for outcome, colour in COLOURS.items():
        own = np.flatnonzero(codes == outcome)
        if own.size:
            heights = np.nan_to_num(np.minimum(peaks[own], TOP), nan=0.0)
            ax.bar(own + 1, np.maximum(heights, 0.01), color=colour, label=_word(outcome))
    ax.set(xlabel=say("plot.object.lane"), ylabel=say("plot.object.peak"), ylim=(0.0, 1.3))
    style.legend_above(ax, 4)
    style.caption(ax, say("plot.object.bars"))
    return ax


def bodies(tree: xr.DataTree, axes: style.Panels | None = None, block: str | None = None) -> np.ndarray:
    """Draw the first eight bodies, or a selected body, from the results of an assessment, each at its own scale.

    The view is along the base, with theta > 0 to the right.
    """
    summary = tree["summary"].to_dataset()
    names = [one_name(summary, "block", block)] if block else [str(name) for name in summary["block"].values[:MOST]]
    floors = [floors_from_text(str(summary["floors"].sel(block=name).values)) for name in names]
    periods = [[mode.period for mode in floor] for floor in floors]
    drawn = [(name, block_of(summary, name), one) for name, one in zip(names, periods, strict=True)]
    return _outlines(drawn, axes)


def _outlines(drawn: Sequence[tuple[str, Block, list[float]]], axes: style.Panels | None = None) -> np.ndarray:
    """Draw the first eight bodies, each given by its name, its block and the periods of its floor [s]."""
    count = min(len(drawn), MOST)
    rows, columns = (math.ceil(count / IN_ROW), IN_ROW) if axes is None else (1, count)
    panels = style.several_axes(axes, rows, columns, height=3.2 * rows).ravel()
    for ax, one in zip(panels, drawn, strict=False):
        _draw(ax, *one)
    for ax in panels[len(drawn) :]:
        ax.set_visible(False)
    return panels


def _draw(ax: Axes, name: str, block: Block, periods: list[float]) -> None:
    body = Outline.of(block)
    height = body.height if math.isfinite(body.height) else 2.0 * body.centre
    middle = 0.5 * (body.right - body.left)
    ax.add_patch(Polygon(np.array(body.corners), closed=True, fc=PALE, ec=BLACK, lw=0.8))
    if math.isfinite(body.height):
        ax.plot([body.right + 0.08 * height] * 2, [0.0, height], color=GREY, lw=0.6, marker="_", ms=4)
        ax.text(body.right + 0.11 * height, 0.5 * height, f"{six_digits(height)} m", fontsize=SMALL, va="center")
        words = f"{six_digits(body.width)} m"
    else:
        b1, b2, h = (three_digits(length, "m") for length in (body.right, body.left, body.centre))
        words = f"b₁ {b1}, b₂ {b2}\nh {h}"
    ax.text(middle, -0.045 * height, words, fontsize=SMALL, ha="center", va="top")
    ax.plot([0.0], [body.centre], "o", ms=3, color=BLACK)
    left = -body.left - 0.12 * height
    if body.side:
        wall = [(left, 0), (-body.left, 0), (-body.left, height), (left, height)]
        ax.add_patch(Polygon(np.array(wall), closed=True, fc="white", ec=GREY, lw=0.8, hatch="////"))
    ax.plot([left - 0.1 * height, body.right + 0.35 * height], [0.0, 0.0], color=BLACK, lw=1.2)
    if periods:
        words = say("plot.object.floor", periods=", ".join(map(six_digits, periods)))
        ax.text(middle, -0.16 * height, words, fontsize=SMALL, ha="center", va="top", color=BLUE)
    for tie in body.ties:
        end = tie.edge + tie.outward * 0.3 * height
        ax.plot([tie.attached, end], [tie.height] * 2, color=BLUE, lw=1.4)
        ax.plot([end], [tie.height], "s", ms=4, color=BLUE)
    arrows = [((at, up), (at, up + 0.14 * height), ORANGE) for at, up in body.loads]
    arrows += [((at, up), (at - math.copysign(0.25 * height, force), up), RED) for at, up, force in body.thrusts]
    for tip, tail, colour in arrows:
        ax.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2})
    ax.set_aspect("equal")
    ax.set(xlim=(left - 0.25 * height, body.right + 0.45 * height), ylim=(-0.28 * height, 1.2 * height))
    ax.axis("off")
    ax.set_title(style.wrapped(style.plain(name), 20), fontsize=SMALL)
