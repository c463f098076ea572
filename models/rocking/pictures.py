"""Small SVG pictures and summary cards of objects for notebooks, in data units, x to the right and y upwards."""

import html
from abc import ABC, abstractmethod
from dataclasses import fields, is_dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

#: Colours: the colour of the surrounding text, three colours of Okabe & Ito (2008), and a grey.
INK = "currentColor"
BLUE, ORANGE, RED, GREY = "#0072B2", "#E69F00", "#D55E00", "#808080"
#: Size of a picture and margin around the drawing [px].
WIDTH, HEIGHT, MARGIN = 380.0, 120.0, 14.0
#: Largest length of a repr, and largest number of list values in it.
LINE, FEW = 120, 4
#: Number of columns to which a long line is thinned; more would not be visible.
COLUMNS = 300


class Picture:
    """A small SVG drawing of lines, polygons and labels in a rectangle of data coordinates."""

    def __init__(
        self,
        x_limits: tuple[float, float],
        y_limits: tuple[float, float],
        width: float = WIDTH,
        height: float = HEIGHT,
        equal: bool = False,
    ) -> None:
        """Set the limits of the axes; `equal` uses one scale for both axes, the smaller of the two."""
        self.width: float = width
        self.height: float = height
        low, high = np.array([x_limits[0], y_limits[0]]), np.array([x_limits[1], y_limits[1]])
        room = np.array([width, height]) - 2.0 * MARGIN
        scale = room / np.where(high > low, high - low, 1.0)
        self._scale = np.full(2, scale.min()) if equal else scale
        self._centre = 0.5 * (low + high)
        self._parts: list[str] = []

    def line(self, x: ArrayLike, y: ArrayLike, colour: str = INK, width: float = 1.0, dashes: str = "") -> None:
        """Draw a line through points."""
        dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
        self._parts.append(
            f'<polyline points="{self._points(x, y)}" fill="none" stroke="{colour}" stroke-width="{width:g}"{dashed}/>'
        )

    def polygon(self, x: ArrayLike, y: ArrayLike, colour: str = INK, opacity: float = 0.2) -> None:
        """Draw a filled polygon with these corner points and an outline."""
        self._parts.append(
            f'<polygon points="{self._points(x, y)}" fill="{colour}" fill-opacity="{opacity:g}" stroke="{colour}"/>'
        )

    def stems(self, x: ArrayLike, y: ArrayLike, colour: str = INK, width: float = 1.0) -> None:
        """Draw a vertical line from zero to every point, all lines as one element."""
        x, y = np.atleast_1d(x), np.atleast_1d(y)
        (feet, base), (_, tips) = self._placed(x, np.zeros(x.size)), self._placed(x, y)
        path = "".join(f"M{at:.1f} {low:.1f}V{tip:.1f}" for at, low, tip in zip(feet, base, tips, strict=True))
        self._parts.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>')

    def dot(self, x: float, y: float, colour: str = INK, radius: float = 3.0) -> None:
        """Draw a dot with a radius in pixels at a point."""
        (at,), (up,) = self._placed([x], [y])
        self._parts.append(f'<circle cx="{at:.1f}" cy="{up:.1f}" r="{radius:g}" fill="{colour}"/>')

    def words(self, text: str, x: float, y: float, anchor: str = "middle", colour: str = INK) -> None:
        """Write a label that begins at, ends at or is centred on a point (anchor "start", "end" or "middle")."""
        (at,), (up,) = self._placed([x], [y])
        self._parts.append(
            f'<text x="{at:.1f}" y="{up:.1f}" text-anchor="{anchor}" fill="{colour}">{html.escape(text)}</text>'
        )

    def svg(self, label: str) -> str:
        """Return the picture as an `<svg>` element with a label for screen readers."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'width="{self.width:g}" height="{self.height:g}" role="img" aria-label="{html.escape(label)}" '
            f'font-size="10" font-family="sans-serif">{"".join(self._parts)}</svg>'
        )

    def _placed(self, x: ArrayLike, y: ArrayLike) -> tuple[list[float], list[float]]:
        """Convert points from data coordinates to pixels from the upper left corner."""
        right = 0.5 * self.width + (np.asarray(x, dtype=float) - self._centre[0]) * self._scale[0]
        down = 0.5 * self.height - (np.asarray(y, dtype=float) - self._centre[1]) * self._scale[1]
        return right.tolist(), down.tolist()

    def _points(self, x: ArrayLike, y: ArrayLike) -> str:
        return " ".join(f"{right:.1f},{down:.1f}" for right, down in zip(*self._placed(x, y), strict=True))


class Shown(ABC):
    """Base class of objects that print as one line in a terminal and as a table with a picture in a notebook."""

    __slots__ = ()

    @abstractmethod
    def _facts(self) -> dict[str, str]:
        """Return the main values of the object as text, by their short names; a name may be an empty string."""

    @abstractmethod
    def _picture(self) -> Picture | None:
        """Return the picture of the object, or None if there is nothing to draw."""

    def __repr__(self) -> str:
        facts = ", ".join(f"{name} {value}".strip() for name, value in self._facts().items())
        return shortened_line(f"<{type(self).__name__} {facts}>")

    def _repr_html_(self) -> str:
        """Return the HTML for notebooks: a table of the main values beside the picture."""
        title, picture = type(self).__name__, self._picture()
        rows = "".join(
            f'<tr><th style="text-align:left;font-weight:normal;opacity:0.7">{html.escape(name)}</th>'
            f'<td style="text-align:left">{html.escape(value)}</td></tr>'
            for name, value in self._facts().items()
        )
        drawn = "" if picture is None else picture.svg(f"{title}: {', '.join(self._facts().values())}")
        side_by_side = "display:flex;flex-wrap:wrap;align-items:center;gap:1em"
        return f'<div><strong>{title}</strong><div style="{side_by_side}"><table>{rows}</table>{drawn}</div></div>'


def shortened_line(text: str) -> str:
    """Shorten a repr to one line of at most LINE characters."""
    text = " ".join(text.split())
    return text if len(text) <= LINE else f"{text[: LINE - 4]}...{text[-1]}"


def short_repr(thing: Any) -> str:
    """Return one line for a dataclass (without fields equal to defaults) or a named tuple; arrays show their shape."""
    if isinstance(thing, tuple):
        known = thing._asdict()  # type: ignore[attr-defined]
    else:
        printed = [item for item in fields(thing) if item.repr]
        values = {item.name: (getattr(thing, item.name), item.default) for item in printed}
        known = {
            name: value for name, (value, usual) in values.items() if value is not usual and not _same(value, usual)
        }
    listed = ", ".join(f"{name}={_short_value(value)}" for name, value in known.items())
    return shortened_line(f"{type(thing).__name__}({listed})")


def _same(value: Any, usual: Any) -> bool:
    return isinstance(value, str | int | float | tuple | None) and value == usual


def _short_value(value: Any) -> str:
    """Return a short text for a value: the shape of an array, the length of a long list, else a shortened repr."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"<{' x '.join(map(str, value.shape))} {value.dtype}>"
    if isinstance(value, list | tuple) and (len(value) > FEW or any(map(is_dataclass, value))):
        return f"<{len(value)} {type(value[0]).__name__}>"
    return f"{value!r:.60}" if not isinstance(value, np.generic | np.ndarray) else repr(value.item())


def brief(values: ArrayLike, unit: str = "", digits: int = 4) -> str:
    """Format a number with its unit, or several numbers as a range; return "unknown" if all are NaN."""
    known = np.asarray(values, dtype=float).ravel()
    known = known[~np.isnan(known)]
    if known.size == 0:
        return "unknown"
    low, high = f"{known.min():.{digits}g}", f"{known.max():.{digits}g}"
    return f"{low if low == high else f'{low} to {high}'} {unit}".rstrip()


def thinned(x: np.ndarray, y: np.ndarray, columns: int = COLUMNS) -> tuple[np.ndarray, np.ndarray]:
    """Reduce a line of n points to the lowest and the highest point in each of `columns` columns of the picture."""
    if y.size <= 2 * columns:
        return x, y
    kept: list[int] = []
    for first, last in pairwise(np.linspace(0, y.size, columns + 1).astype(int).tolist()):
        stretch = y[first:last]
        if np.all(np.isnan(stretch)):
            kept.append(first)
        else:
            kept += sorted({first + int(np.nanargmin(stretch)), first + int(np.nanargmax(stretch))})
    return x[kept], y[kept]
