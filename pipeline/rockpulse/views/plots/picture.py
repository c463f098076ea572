"""A figure as a file, the same bytes on every run and its own ids in every SVG, and a figure for a notebook's cell."""

import hashlib
import re
import threading
from io import BytesIO

import matplotlib
from matplotlib.figure import Figure

#: Dots per inch of a PNG: 300 and more is for photographs.
RESOLUTION = 200
#: Metadata left out of a file: the time of the run, and what takes room and says nothing.
_UNDATED: dict[str, dict[str, None]] = {
    "svg": dict.fromkeys(("Date", "Creator", "Format", "Type")),
    "pdf": {"CreationDate": None},
    "png": {},
}

#: A tag, and in it an id or a reference to one.
_TAG = re.compile(r"<[a-zA-Z][^>]*>")
_ID = re.compile(r'(\bid="|\bhref="#|url\(#)')
#: Coordinates of a path, which are written to 1e-6 pt.
_PATH = re.compile(r'\bd="[^"]*"')
_LONG = re.compile(r"-?\d+\.\d{3,}")
#: A rule for the whole page, which the element can carry itself; and the list of fonts at every text.
_RULE = '<style type="text/css">*{stroke-linejoin: round; stroke-linecap: butt}</style>'
_FONTS = re.compile(r"font-family: 'DejaVu Sans',[^;\"]*")
#: matplotlib's settings, and its reader of mathematics, are the same for all threads.
_WRITING = threading.Lock()


def picture_bytes(figure: Figure, form: str) -> bytes:
    """The content of a file with the figure, as "png", "svg" or "pdf".

    The same bytes for the same figure: no time, and in SVG no random ids. Text is text in SVG and PDF.
    """
    buffer = BytesIO()
    # Read by the writers when they write, and nowhere else to be given; put back at once, one thread after the other.
    with _WRITING, matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "rockpulse", "pdf.fonttype": 42}):
        figure.savefig(buffer, format=form, dpi=RESOLUTION, metadata=_UNDATED[form])
    return buffer.getvalue()


def svg(figure: Figure, name: str | None = None) -> str:
    """The figure as an element `<svg>` to stand in an HTML page beside any number of others.

    Parameters
    ----------
    figure : matplotlib Figure
        The figure that is drawn.
    name : str, optional
        Begins every id of the element, and every reference to one: letters, digits, "-" and "_"; different for each
        picture of a page. By default made from the content, so that only pictures that are equal share their ids.

    Raises
    ------
    ValueError
        For a name that cannot begin an id.
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

    # A hundredth of a point is a tenth of the thinnest line: half the size, the same picture.
    element = _PATH.sub(lambda path: _LONG.sub(rounded, path.group()), element)
    return _TAG.sub(lambda tag: _ID.sub(rf"\g<1>{name}-", tag.group()), element)


class NotebookFigure(Figure):
    """A figure that belongs to no window: pyplot, by which notebooks show all others, does not know it."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """The picture, and the width at which it has the size of other pictures [px]."""
        return picture_bytes(self, "png"), {"width": round(self.get_figwidth() * self.get_dpi())}
