"""Vertical bars in the docstrings are absolute values and not substitutions of reStructuredText."""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx


def escape_bars(app: Sphinx, what: str, name: str, subject: Any, options: Any, lines: list[str]) -> None:
    """Escape the bars of prose; examples are left as they are."""
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else line.replace("|", r"\|") for line in lines]


def setup(app: Sphinx) -> dict[str, Any]:
    """Run before numpydoc lays the docstrings out."""
    app.connect("autodoc-process-docstring", escape_bars, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
