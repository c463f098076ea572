"""The cells of a notebook, run one after the other in one session, as Jupyter runs them."""

from __future__ import annotations

import ast
import contextlib
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

__all__ = ["Cell", "run"]


class Cell(NamedTuple):
    """A cell: its text, and of code what it printed and the value of its last line, None without one."""

    code: bool
    text: str
    printed: str
    value: Any


def run(notebook: Path) -> Iterator[Cell]:
    """The cells of a notebook, of which the code is run in the folder of the notebook."""
    session: dict[str, Any] = {"__name__": "__main__"}
    for number, cell in enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"], 1):
        text = "".join(cell["source"])
        if cell["cell_type"] != "code":
            yield Cell(False, text, "", None)
            continue
        tree = ast.parse(text, f"{notebook.name}, cell {number}")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        with contextlib.chdir(notebook.parent), contextlib.redirect_stdout(io.StringIO()) as output:
            exec(compile(tree, f"{notebook.name}, cell {number}", "exec"), session)
            value = last and eval(
                compile(ast.Expression(last.value), f"{notebook.name}, cell {number}", "eval"), session
            )
        yield Cell(True, text, output.getvalue(), value)
