"""Writes pictures as files that are equal for equal figures, and as SVG elements whose ids are unique."""

import hashlib
import re
import threading
from io import BytesIO

import matplotlib
from matplotlib.figure import Figure

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

    >>> rp.plots.picture_bytes(rp.plots.bodies(results), "png")[1:4]
    b'PNG'
    """
    buffer = BytesIO()
    # The writers read these settings only globally; they are restored at once, under the lock.
    with _WRITING, matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "rockpulse", "pdf.fonttype": 42}):
        figure.savefig(buffer, format=form, dpi=RESOLUTION, metadata=_UNDATED[form])
    return buffer.getvalue()


def svg(figure: Figure, name: str | None = None) -> str:
    """Return the figure as an `<svg>` element for an HTML page that may contain others.

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
    >>> rp.plots.svg(rp.plots.bodies(results), "wall").count('id="wall')
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
