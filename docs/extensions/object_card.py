"""The directives `object-card` and `notebook`: what a notebook shows, made while the manual is built.

The body of an `object-card` is an expression of the names that the Python blocks above it on the page have set. They
are run once for each page, in a folder that has the samples where a clone of the repository has them. A `notebook` is
a file beside the page, shown cell by cell with what comes out.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from pathlib import Path
from typing import Any

from docutils import nodes
from matplotlib.figure import Figure
from notebook_cells import run
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from rockpulse.plots import svg

TOP = Path(__file__).parents[2]
PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)

TITLE = re.compile(r"\A# .*\n+")

#: The names that each page has set, and how many of its blocks have been run.
SESSIONS: dict[str, tuple[dict[str, Any], list[int]]] = {}


def session_of(page: Path, line: int) -> dict[str, Any]:
    """The names that the Python blocks of a page above a line have set."""
    names, run = SESSIONS.setdefault(str(page), ({"__name__": "__manual__"}, [0]))
    above = "".join(page.read_text(encoding="utf-8").splitlines(keepends=True)[:line])
    blocks = PYTHON.findall(above)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "data").symlink_to(TOP / "data", target_is_directory=True)
        with contextlib.chdir(folder), contextlib.redirect_stdout(None):
            for block in blocks[run[0] :]:
                exec(block, names)
    run[0] = len(blocks)
    return names


def shown(found: Any) -> nodes.Node:
    """What a notebook shows of an object: its figure or card, else its text."""
    if not isinstance(found, Figure) and not hasattr(found, "_repr_html_"):
        return nodes.literal_block("", repr(found), language="text")
    card = svg(found) if isinstance(found, Figure) else found._repr_html_()
    return nodes.raw("", f'<div class="object-card">{card}</div>', format="html")


class ObjectCard(SphinxDirective):
    """An object as a notebook shows it, its figure as SVG where it is one of matplotlib's."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The card as HTML."""
        source = Path(self.env.doc2path(self.env.docname))
        names = session_of(source, self.lineno)
        return [shown(eval("\n".join(self.content), names))]


class Notebook(SphinxDirective):
    """A notebook beside the page, without its title, which the page has."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Its cells, each followed by what it printed and the value of its last line."""
        path = Path(self.env.doc2path(self.env.docname)).parent / self.arguments[0]
        self.env.note_dependency(str(path))
        found: list[nodes.Node] = []
        for cell in run(path):
            if not cell.code:
                found += self.parse_text_to_nodes(TITLE.sub("", cell.text))
                continue
            found.append(nodes.literal_block("", cell.text, language="python"))
            if cell.printed:
                found.append(nodes.literal_block("", cell.printed, language="text"))
            if cell.value is not None:
                found.append(shown(cell.value))
        return found


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the directives known to Sphinx."""
    app.add_directive("object-card", ObjectCard)
    app.add_directive("notebook", Notebook)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
