"""The directive `object-card`: what a notebook shows of an object, made while the manual is built.

Its body is an expression of the names that the Python blocks above it on the page have set. They are run once for each
page, in a folder that has the samples where a clone of the repository has them.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from pathlib import Path
from typing import Any

from docutils import nodes
from matplotlib.figure import Figure
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from rockpulse.plots import svg

TOP = Path(__file__).parents[2]
PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)

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


class ObjectCard(SphinxDirective):
    """An object as a notebook shows it, its figure as SVG where it is one of matplotlib's."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The card as HTML."""
        source = Path(self.env.doc2path(self.env.docname))
        names = session_of(source, self.lineno)
        found = eval("\n".join(self.content), names)
        card = svg(found) if isinstance(found, Figure) else found._repr_html_()
        return [nodes.raw("", f'<div class="object-card">{card}</div>', format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the directive known to Sphinx."""
    app.add_directive("object-card", ObjectCard)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
