"""Equations as MathML, which browsers draw by themselves: no script and no network. docutils brings the translator."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number

#: The name of a function with its power; what stands before it; an argument without brackets after it.
NAME = r"\\(?:arctan|cosh|cos|exp|ln|max|sinh|sin|tanh|tan|operatorname\{\w+\})(?![a-zA-Z])(?:\^\w)?"
BEFORE = re.compile(rf"(?<=[\w}}])\s*(?={NAME})")
AFTER = re.compile(rf"({NAME})\s*(?=\\[a-zA-Z]|[a-zA-Z|])")
BARS = re.compile(r"\|([^|]*)\|")


def translated(equation: str, as_block: bool) -> str:
    """MathML of an equation, with the thin spaces of LaTeX around functions, and bars tied to what they enclose."""
    equation = equation.replace(r"\lvert", "|").replace(r"\rvert", "|")
    equation = AFTER.sub(r"\1\\,", BEFORE.sub(r"\\,", equation))
    return tex2mathml(BARS.sub(r"\\left|\1\\right|", equation), as_block=as_block)


def visit_math(self: Any, node: nodes.math) -> None:
    """An equation in the line."""
    self.body.append(translated(node.astext(), as_block=False))
    raise nodes.SkipNode


def visit_displaymath(self: Any, node: nodes.math_block) -> None:
    """An equation of its own, with its number if it has a label."""
    target = f' id="{node["ids"][0]}"' if node["ids"] else ""
    self.body.append(f'<div class="math"{target}>')
    self.body.append(translated(node.astext(), as_block=True))
    if node["number"]:
        self.body.append(f'<span class="eqno">({get_node_equation_number(self, node)})</span>')
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the renderer known to Sphinx under the name "mathml"."""
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_displaymath, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
