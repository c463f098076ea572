"""One look for all pictures: sizes for a page of A4, and colours that hold for colour-blind eyes and in grey.

Nothing here touches matplotlib's global settings: every size is set on the artist itself, so that pictures drawn side
by side in one process, or in a user's own session, do not change each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from rockpulse.model_table import MODELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

__all__ = [
    "BLACK",
    "BLUE",
    "FONT",
    "GREEN",
    "GREY",
    "INSTANTS",
    "ORANGE",
    "PALE",
    "PURPLE",
    "RED",
    "SKY",
    "SMALL",
    "WIDTH",
    "Look",
    "Panels",
    "caption",
    "dressed",
    "figure_of",
    "legend",
    "legend_above",
    "look",
    "looks",
    "one_axes",
    "panel_title",
    "plain_ticks",
    "ramp",
    "several_axes",
    "title",
]

#: Width of a picture: that of the text on a page of A4 with margins of 25 mm [in].
WIDTH = 6.3

#: Sizes of text [pt], at that width.
FONT, SMALL = 8.5, 7.5

#: Colours of Okabe & Ito (2008), told apart by colour-blind eyes, and a grey.
PALETTE = {
    "black": "#000000",
    "blue": "#0072B2",
    "orange": "#E69F00",
    "green": "#009E73",
    "red": "#D55E00",
    "sky": "#56B4E9",
    "purple": "#CC79A7",
    "grey": "#666666",
}
BLACK, BLUE, ORANGE, GREEN, RED, SKY, PURPLE, GREY = PALETTE.values()
PALE = "#DDDDDD"

#: Label of the figures that are made here.
_OURS = "rockpulse"

#: Columns by which a long history is drawn: more cannot be told apart on the page.
INSTANTS = 700


#: The Axes of a user for a picture of several panels: one, several, or those of ``plt.subplots``.
Panels: TypeAlias = "Axes | Sequence[Axes] | np.ndarray"


class Look(NamedTuple):
    """The look of a model, or of any other of a few things side by side: never its colour alone."""

    label: str
    color: str
    line: Any
    marker: str


#: For what is no model: limit states, curves of a family.
_CYCLE = [
    (BLUE, "-", "o"),
    (RED, (0, (5, 1.3)), "s"),
    (GREEN, (0, (1.2, 1.2)), "^"),
    (ORANGE, (0, (6, 1.5, 1, 1.5)), "D"),
    (PURPLE, (0, (3, 1, 1, 1, 1, 1)), "v"),
    (BLACK, (0, (8, 2)), "P"),
    (SKY, "-", "<"),
    (GREY, (0, (5, 1.3)), ">"),
]


def look(name: str) -> Look:
    """The look of a model, by its name in the results."""
    if name not in MODELS:
        return Look(name, BLACK, "-", "x")
    color, line, marker = MODELS[name].look
    return Look(MODELS[name].label, PALETTE[color], line, marker)


def looks(names: Sequence[str]) -> list[Look]:
    """The looks of named things of one family, in order; colours that come again have other lines and markers."""
    found = []
    for place, name in enumerate(names):
        turn, at = divmod(place, len(_CYCLE))
        _, line, marker = _CYCLE[(at + 2 * turn + 1) % len(_CYCLE)] if turn else _CYCLE[at]
        found.append(Look(name, _CYCLE[at][0], line, marker))
    return found


def ramp(names: Sequence[str]) -> list[Look]:
    """The looks of the named steps of one quantity, in order: from dark to light, neighbours by other lines too."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    shades = colormaps["cividis"](np.linspace(0.0, 0.88, len(names)))
    return [
        Look(name, to_hex(shade), _CYCLE[place % 4][1], _CYCLE[place % 4][2])
        for place, (name, shade) in enumerate(zip(names, shades, strict=True))
    ]


def figure_of(width: float = WIDTH, height: float = 3.4) -> Figure:
    """A figure of some size [in] that belongs to no window and no global list."""
    from rockpulse.views.plots.notebook_figure import NotebookFigure

    figure = NotebookFigure(figsize=(width, height), layout="constrained")
    figure.set_label(_OURS)
    return figure


def one_axes(ax: Axes | None, height: float = 3.4) -> Axes:
    """The Axes that were given, or new ones on a figure of their own of some height [in], dressed."""
    return dressed(figure_of(height=height).subplots() if ax is None else ax)


def several_axes(axes: Panels | None, rows: int, columns: int = 1, height: float = 5.0, **options: Any) -> np.ndarray:
    """As :func:`one_axes` for pictures of rows x columns of panels; the Axes come back in that shape.

    The options are those of :meth:`matplotlib.figure.Figure.subplots`. A ValueError for another number of Axes.
    """
    if axes is None:
        panels = figure_of(height=height).subplots(rows, columns, squeeze=False, **options)
    else:
        panels = np.asarray(axes, dtype=object)
        if panels.size != rows * columns:
            raise ValueError(f"axes: expected {rows} x {columns} of them, got {panels.size}")
        panels = panels.reshape(rows, columns)
    for ax in panels.flat:
        dressed(ax)
    return panels


def dressed(ax: Axes) -> Axes:
    """Axes with the sizes of this look."""
    ax.tick_params(which="both", labelsize=SMALL, width=0.6, length=3)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_linewidth(0.6)
    ax.grid(color=PALE, lw=0.5)
    ax.set_axisbelow(True)
    for axis in (ax.xaxis, ax.yaxis):
        axis.label.set_fontsize(FONT)
        axis.get_offset_text().set_fontsize(SMALL)
    return ax


def legend(ax: Axes, **options: Any) -> None:
    """The legend of what has a label, if anything has, with the options of :meth:`matplotlib.axes.Axes.legend`."""
    if options.get("handles") or ax.get_legend_handles_labels()[1]:
        ax.legend(**{"fontsize": SMALL, "frameon": True, "framealpha": 0.85, "edgecolor": "none", **options})


def legend_above(ax: Axes, ncols: int, across: bool = False, lift: float = 0.0, **options: Any) -> None:
    """The legend in rows of `ncols` entries above the Axes, where it hides nothing.

    With `across` it begins at the left edge of a figure of our own, for Axes that leave room for long names beside
    them. `lift` moves it further up [pt], over what else stands above the Axes.
    """
    from matplotlib.transforms import ScaledTranslation, blended_transform_factory

    figure = ax.get_figure(root=True)
    assert figure is not None
    beside = across and figure.get_label() == _OURS
    place = blended_transform_factory(figure.transFigure if beside else ax.transAxes, ax.transAxes)
    style = {"frameon": False, "columnspacing": 1.2, "handlelength": 1.9, "borderaxespad": 0.0, "borderpad": 0.25}
    legend(
        ax,
        loc="lower left",
        bbox_to_anchor=(0.005 if beside else 0.0, 1.0),
        bbox_transform=place + ScaledTranslation(0.0, lift / 72.0, figure.dpi_scale_trans),
        ncols=ncols,
        **style,
        **options,
    )


def title(ax: Axes, words: str, rows: int = 0, width: int = 74) -> None:
    """The title of a picture: above a figure of our own, else above its uppermost Axes and their own title.

    `rows` is the number of rows of a legend that stands above the Axes, `width` the longest line. Names of the user's
    stand in `words` as :func:`~rockpulse.views.plots.words.plain` gives them.
    """
    from rockpulse.views.plots.words import wrapped

    figure = ax.get_figure(root=True)
    if words and figure is not None and figure.get_label() == _OURS:
        figure.suptitle(wrapped(words, width), x=0.01, ha="left", fontsize=FONT)
    else:
        panel_title(ax, "\n".join(line for line in (words, ax.get_title(loc="left")) if line), rows)


def panel_title(ax: Axes, words: str, rows: int = 0, width: int = 92) -> None:
    """The line above one of several panels, over `rows` rows of a legend; `width` is the longest line."""
    from rockpulse.views.plots.words import wrapped

    ax.set_title(wrapped(words, width), loc="left", fontsize=FONT, pad=4.0 + 12.0 * rows)


def caption(ax: Axes, words: str, width: int = 106) -> None:
    """Small print below the label of the horizontal axis of the lowest Axes: what is uncertain, what the signs mean.

    `width` is the longest line on a figure of our own.
    """
    from rockpulse.views.plots.words import wrapped

    figure = ax.get_figure(root=True)
    if not words or figure is None:
        return
    style: dict[str, Any] = {"fontsize": SMALL, "color": "#333333", "linespacing": 1.25}
    if figure.get_label() == _OURS:
        figure.supxlabel(wrapped(words, width), x=0.01, ha="left", **style)
    else:  # somebody else's figure: its own labels stay, and there may be other pictures on it
        below = ("axes fraction", ax.xaxis.label)
        ax.annotate(
            wrapped(words, width), (0.0, 0.0), (0.0, -5.0), below, "offset points", va="top", in_layout=False, **style
        )


def plain_ticks(axis: Axis) -> None:
    """Label the ticks of a logarithmic axis with plain numbers, not powers of ten, and set enough of them."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0,) if high / low > 200.0 else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
