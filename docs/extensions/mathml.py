"""Equations as MathML, which browsers draw by themselves: no script and no network. docutils brings the translator."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

#: The name of a function with its power; what stands before it; an argument without brackets after it.
NAME = r"\\(?:arctan|cosh|cos|exp|ln|max|sinh|sin|tanh|tan|operatorname\{\w+\})(?![a-zA-Z])(?:\^\w)?"
BEFORE = re.compile(rf"(?<=[\w}}])\s*(?={NAME})")
AFTER = re.compile(rf"({NAME})\s*(?=\\[a-zA-Z]|[a-zA-Z|])")
#: Label of an equation of the paper, "paper-3-4", "paper-5-corrected": it bears the paper's numbers, others bear none.
OF_THE_PAPER = re.compile(r"paper((?:-\d+)+)(-corrected)?")
BARS = re.compile(r"\|([^|]*)\|")

#: A letter with a dot or two before its index, which docutils would put under the letter or over the dot.
DOTTED = re.compile(r"(\\d?dot\{[^{}]*\})(?=[_^])")


def translated(equation: str, as_block: bool) -> str:
    """MathML of an equation, with the thin spaces of LaTeX around functions, and bars tied to what they enclose."""
    equation = equation.replace(r"\lvert", "|").replace(r"\rvert", "|")
    equation = DOTTED.sub(r"\1{}", equation)
    equation = AFTER.sub(r"\1\\,", BEFORE.sub(r"\\,", equation))
    return tex2mathml(BARS.sub(r"\\left|\1\\right|", equation), as_block=as_block)


def visit_math(self: Any, node: nodes.math) -> None:
    """An equation in the line."""
    self.body.append(translated(node.astext(), as_block=False))
    raise nodes.SkipNode


def visit_displaymath(self: Any, node: nodes.math_block) -> None:
    """An equation of its own, with its number in the paper if it has one."""
    target = f' id="{node["ids"][0]}"' if node["ids"] else ""
    self.body.append(f'<div class="math"{target}>')
    self.body.append(translated(node.astext(), as_block=True))
    if found := OF_THE_PAPER.fullmatch(node.get("label") or ""):
        numbers = [f"({number})" for number in found[1].split("-")[1:]]
        words = f"Eq{'s' * (len(numbers) > 1)}. {', '.join(numbers)}{', corrected' * bool(found[2])}"
        self.body.append(f'<span class="eqno">{words}</span>')
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the renderer known to Sphinx under the name "mathml"."""
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_displaymath, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
