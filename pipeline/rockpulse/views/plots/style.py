"""The style of all pictures: size for an A4 page, colours, line styles, labels and notes; and their files.

Files are equal for equal figures; the ids of SVG elements are unique.
"""

import hashlib
import re
import textwrap
import threading
from collections.abc import Sequence
from io import BytesIO
from typing import Any, NamedTuple, TypeAlias

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, ScalarFormatter
from matplotlib.transforms import ScaledTranslation, blended_transform_factory

from rockpulse.foreign_text import escaped
from rockpulse.model_table import MODELS
from rockpulse.views.shared.formatting import six_digits
from rockpulse.views.shared.words import in_numerals, language, say, translated

#: Resolution of a PNG [dots per inch].
RESOLUTION = 200
#: Metadata that are omitted from a file, such as the time of the run.
_UNDATED: dict[str, dict[str, None]] = {
    "svg": dict.fromkeys(("Date", "Creator", "Format", "Type")),
    "pdf": {"CreationDate": None},
    "png": {},
}

#: Patterns of a tag, and of an id or a reference to an id in it.
_TAG = re.compile(r"<[a-zA-Z][^>]*>")
_ID = re.compile(r'(\bid="|\bhref="#|url\(#)')
#: Pattern of the coordinates of a path, which matplotlib writes to 1e-6 pt.
_PATH = re.compile(r'\bd="[^"]*"')
_LONG = re.compile(r"-?\d+\.\d{3,}")
#: Pattern of a style rule for the whole page, which moves to the element, and pattern of the list of fonts of a text.
_RULE = '<style type="text/css">*{stroke-linejoin: round; stroke-linecap: butt}</style>'
_FONTS = re.compile(r"font-family: 'DejaVu Sans',[^;\"]*")
#: Lock for matplotlib's settings and parser of formulas, which all threads share.
_WRITING = threading.Lock()


def picture_bytes(figure: Figure, form: str) -> bytes:
    """Return the content of a picture file of a figure; `form` is "png", "svg" or "pdf".

    Equal figures give equal bytes, without a time stamp and, in SVG, without random ids. Text remains text in SVG and
    PDF.

    >>> rp.plots.picture_bytes(rp.plots.draw(results, "bodies"), "png")[1:4]
    b'PNG'
    """
    buffer = BytesIO()
    # The writers read these settings only globally; they are restored at once, under the lock.
    with _WRITING, matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "rockpulse", "pdf.fonttype": 42}):
        figure.savefig(buffer, format=form, dpi=RESOLUTION, metadata=_UNDATED[form])
    return buffer.getvalue()


def svg(figure: Figure, name: str | None = None) -> str:
    """Return the figure as an `<svg>` element for an HTML page that may contain other pictures.

    Parameters
    ----------
    figure : matplotlib Figure
        The figure.
    name : str, optional
        Prefix of every id in the element, and of references to ids, made of letters, digits, "-" and "_", and
        different for each picture of a page. By default it is made from the content, so that only equal pictures share
        ids.

    Raises
    ------
    ValueError
        For a name that cannot start an id.

    Examples
    --------
    >>> rp.plots.svg(rp.plots.draw(results, "bodies"), "wall").count('id="wall')
    22
    """
    text = picture_bytes(figure, "svg").decode("utf-8")
    element = text[text.index("<svg") :].rstrip()
    if _RULE in element:
        element = element.replace(_RULE, "").replace("<svg", '<svg style="stroke-linejoin: round"', 1)
    element = _FONTS.sub("font-family: 'DejaVu Sans', Verdana, sans-serif", element)  # of the same width
    if name is None:
        name = "p" + hashlib.sha256(element.encode("utf-8")).hexdigest()[:12]
    if not re.fullmatch(r"[A-Za-z][\w-]*", name, flags=re.ASCII):
        raise ValueError(f"name: expected a letter, then letters, digits, '-' and '_', got {name!r}")

    def rounded(number: re.Match[str]) -> str:
        return f"{float(number.group()):.2f}".rstrip("0").rstrip(".")

    # A hundredth of a point is a tenth of the thinnest line: this halves the size without visible change.
    element = _PATH.sub(lambda path: _LONG.sub(rounded, path.group()), element)
    return _TAG.sub(lambda tag: _ID.sub(rf"\g<1>{name}-", tag.group()), element)


class NotebookFigure(Figure):
    """A figure without a window that a notebook displays."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """Return a PNG and its width on the screen [px], for display in a notebook."""
        return picture_bytes(self, "png"), {"width": round(self.get_figwidth() * self.get_dpi())}


#: Width of a picture [in] (text width of an A4 page with margins of 25 mm), and font sizes at that width [pt].
WIDTH, FONT, SMALL = 6.3, 8.5, 7.5
#: Colours of Okabe & Ito (2008), which colour-blind readers can distinguish, and a grey.
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
#: Line styles of reference lines: dashes, and dots.
DASHED, DOTTED = (0, (6, 3)), (0, (1.2, 1.2))
#: Label of figures made by this module; number of columns to which a long history is reduced.
_OURS, INSTANTS = "rockpulse", 700
#: Axes for a picture of several panels: one, several, or an array from ``plt.subplots``.
Panels: TypeAlias = Axes | Sequence[Axes] | np.ndarray


class Look(NamedTuple):
    """The style of a curve: colour, line and marker, so that curves can be distinguished without colour."""

    label: str
    color: str
    line: Any
    marker: str


#: Styles for items other than models, such as limit states.
_CYCLE = [
    (BLUE, "-", "o"),
    (RED, (0, (5, 1.3)), "s"),
    (GREEN, DOTTED, "^"),
    (ORANGE, (0, (6, 1.5, 1, 1.5)), "D"),
    (PURPLE, (0, (3, 1, 1, 1, 1, 1)), "v"),
    (BLACK, (0, (8, 2)), "P"),
    (SKY, "-", "<"),
    (GREY, (0, (5, 1.3)), ">"),
]


def look(name: str) -> Look:
    """Return the style of the curves of a model; `name` is the name of the model in the results."""
    if name not in MODELS:
        return Look(name, BLACK, "-", "x")
    color, line, marker = MODELS[name].look
    return Look(translated(f"labels.{name}", MODELS[name].label), PALETTE[color], line, marker)


def looks(names: Sequence[str]) -> list[Look]:
    """Return a style for each name; styles with the same colour differ in line and marker."""
    turns = [divmod(place, len(_CYCLE)) for place in range(len(names))]
    other = [_CYCLE[(at + 2 * turn + 1) % len(_CYCLE)] if turn else _CYCLE[at] for turn, at in turns]
    return [Look(name, _CYCLE[at][0], *one[1:]) for name, (_, at), one in zip(names, turns, other, strict=True)]


def whole_figure(what: Figure | Axes | np.ndarray) -> Figure:
    """Return the figure that contains the given Axes, or the given figure itself."""
    if isinstance(what, Figure):
        return what
    figure: Figure = np.ravel(np.array(what, dtype=object))[0].get_figure(root=True)
    return figure


def _ours(ax: Axes) -> bool:
    """Return whether rockpulse made the figure of the Axes; other figures keep their title and margins."""
    return whole_figure(ax).get_label() == _OURS


class TickNumerals(ScalarFormatter):
    """A tick formatter with the decimal sign of the current language."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick."""
        return in_numerals(super().__call__(x, pos))


def one_axes(ax: Axes | None = None, height: float = 3.4) -> Axes:
    """Return the given Axes, or the Axes of a new figure of the given height [in], in the common style."""
    found: Axes = several_axes(ax, 1, height=height)[0, 0]
    return found


def several_axes(axes: Panels | None, rows: int, columns: int = 1, height: float = 5.0, **options: Any) -> np.ndarray:
    """Return the given Axes, or those of a new figure without a window, as an array in the common style.

    `height` is in inches; `options` are passed to `Figure.subplots`.
    """
    if axes is None:
        figure = NotebookFigure(figsize=(WIDTH, height), layout="constrained")
        figure.set_label(_OURS)
        axes = figure.subplots(rows, columns, **options)
    panels = np.asarray(axes, dtype=object)
    if panels.size != rows * columns:
        raise ValueError(f"axes: expected an array of {rows} x {columns} Axes, got {panels.size}")
    for ax in panels.flat:
        ax.tick_params(which="both", labelsize=SMALL, width=0.6, length=3)
        ax.spines[["top", "right"]].set_visible(False)
        ax.spines[["left", "bottom"]].set_linewidth(0.6)
        ax.grid(color=PALE, lw=0.5)
        ax.set_axisbelow(True)
        for axis in (ax.xaxis, ax.yaxis):
            axis.label.set_fontsize(FONT)
            axis.get_offset_text().set_fontsize(SMALL)
            if language() != "en":
                axis.set_major_formatter(TickNumerals())
    return panels.reshape(rows, columns)


def colour_bar(ax: Axes, mesh: QuadMesh, ticks: np.ndarray, words: str, **options: Any) -> None:
    """Draw the colour scale of a map beside it, with a label."""
    options = {"format": TickNumerals(), **options}
    bar = whole_figure(ax).colorbar(mesh, ax=ax, ticks=ticks, pad=0.02, fraction=0.05, **options)
    bar.ax.tick_params(labelsize=SMALL, width=0.6)
    bar.set_label(words, fontsize=FONT)


def legend(ax: Axes, **options: Any) -> None:
    """Draw the legend if there are entries; `options` are passed to :meth:`matplotlib.axes.Axes.legend`."""
    if options.get("handles") or ax.get_legend_handles_labels()[1]:
        ax.legend(**{"fontsize": SMALL, "frameon": True, "framealpha": 0.85, "edgecolor": "none", **options})


def legend_above(ax: Axes, ncols: int, across: bool = False, lift: float = 0.0, **options: Any) -> None:
    """Draw the legend above the Axes in `ncols` columns, raised by `lift` [pt]; `across` uses the figure's width."""
    figure, beside = whole_figure(ax), across and _ours(ax)
    above = blended_transform_factory(figure.transFigure if beside else ax.transAxes, ax.transAxes)
    place = above + ScaledTranslation(0.0, lift / 72.0, figure.dpi_scale_trans)
    options |= {"loc": "lower left", "bbox_to_anchor": (0.005 if beside else 0.0, 1.0), "bbox_transform": place}
    options |= {"columnspacing": 1.2, "handlelength": 1.9, "borderaxespad": 0.0, "borderpad": 0.25}
    legend(ax, ncols=ncols, frameon=False, **options)


def title(ax: Axes, words: str, rows: int = 0) -> None:
    """Write the title of the figure above `rows` rows of a legend; on given Axes, write it as the title of the Axes."""
    if words and _ours(ax):
        whole_figure(ax).suptitle(wrapped(words, 74), x=0.01, ha="left", fontsize=FONT)
    else:
        panel_title(ax, "\n".join(line for line in (words, ax.get_title(loc="left")) if line), rows)


def panel_title(ax: Axes, words: str, rows: int = 0, width: int = 92) -> None:
    """Write the title of a panel above `rows` rows of a legend, with at most `width` characters in a line."""
    ax.set_title(wrapped(words, width), loc="left", fontsize=FONT, pad=4.0 + 12.0 * rows)


def caption(ax: Axes, words: str) -> None:
    """Write small print below the lowest Axes of the figure."""
    words = wrapped(words, 106)
    options: dict[str, Any] = {"fontsize": SMALL, "color": "#333333", "linespacing": 1.25}
    if words and _ours(ax):
        whole_figure(ax).supxlabel(words, x=0.01, ha="left", **options)
    elif words:  # a figure made by the caller: its labels are kept, and it may contain other pictures
        options |= {"va": "top", "in_layout": False}
        below = ("axes fraction", ax.xaxis.label)
        ax.annotate(words, (0.0, 0.0), (0.0, -5.0), below, "offset points", **options)


def notes(**held: bool) -> list[str]:
    """Return the sentences of the section [plot.note] whose keys are given with the value True."""
    return [say(f"plot.note.{key}") for key, holds in held.items() if holds]


def plain_ticks(axis: Axis, wide: float = 200.0) -> None:
    """Label a logarithmic axis with plain numbers, or with powers of ten if its ends differ by a factor of `wide`."""
    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0,) if high / low >= wide else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: six_digits(value)))
    axis.set_minor_formatter(NullFormatter())


#: Printed form of each CF unit in results.
_UNITS = {"m s^-2": "m/s²", "m s^-1": "m/s", "s^-1": "1/s", "rad s^-1": "rad/s", "degree": "°", "1": "-"}
#: Formulas for the symbols in long names; of two symbols with the same start, the longer one comes first.
_SYMBOLS = {
    "theta_max/alpha_c": r"$\theta_{max}/\alpha_c$",
    "theta/alpha_c": r"$\theta/\alpha_c$",
    "alpha_c": r"$\alpha_c$",
    "I_s/I": "$I_s/I$",
    "I/I_1c": "$I/I_{1c}$",
    "I_1c": "$I_{1c}$",
    "I_2c": "$I_{2c}$",
    "I_s": "$I_s$",
    "dT": r"$\Delta T$",
}
_SYMBOL = re.compile(rf"\b({'|'.join(map(re.escape, _SYMBOLS))})\b")
#: Pattern of matplotlib formulas, between dollar signs that are not escaped; first character of the private range.
_MATHEMATICS, _PRIVATE = re.compile(r"(?<!\\)\$[^$]+(?<!\\)\$"), 0xE000


def unit(units: str) -> str:
    """Return the printed form of a unit: "m/s²" for "m s^-2"."""
    return _UNITS.get(units, units)


def readable_name(long_name: str) -> str:
    """Return the part of a long name before the first semicolon, with its symbols written as formulas."""
    return _SYMBOL.sub(lambda found: _SYMBOLS[found.group()], long_name.split(";")[0].strip())


def label(variable: xr.DataArray, symbol: str = "") -> str:
    """Return the axis label of a variable: its long name, symbol and unit."""
    name = readable_name(translated(f"variables.{variable.name}", str(variable.attrs["long_name"])))
    return f"{name} {symbol}".rstrip() + f" [{unit(str(variable.attrs['units']))}]"


def plain(name: object) -> str:
    """Escape a name given by the user, so that matplotlib does not read it as a formula."""
    return escaped(str(name)).replace("$", r"\$")


def wrapped(words: str, width: int) -> str:
    """Wrap text to lines of `width` characters; a formula is not split, and counts as the characters it displays."""
    pieces = _MATHEMATICS.findall(words)
    # Each formula is replaced by as many private characters as it shows.
    for place, piece in enumerate(pieces):
        characters = re.sub(r"\\[A-Za-z]+", "x", piece[1:-1])
        words = words.replace(piece, chr(_PRIVATE + place) * max(len(re.sub(r"[{}_^ ]", "", characters)), 1), 1)
    text = "\n".join(textwrap.fill(line, width, break_on_hyphens=False) for line in words.split("\n"))
    for place, piece in enumerate(pieces):
        letter = chr(_PRIVATE + place)
        text = re.sub(f"{letter}(\n?{letter})*", piece.replace("\\", r"\\"), text)
    return text
