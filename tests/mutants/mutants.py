"""The mutants of a module: its text with one operator or constant changed, by the operators of cosmic-ray.

What no test of behaviour can see is left out: texts of messages (formatted strings, ``raise`` statements, calls of the
logger), annotations and what stands under TYPE_CHECKING, decorators, the star behind which options have to be named,
the guard ``strict`` of ``zip``, small pictures of objects and the words beside them (``_picture``, ``_facts``, and what
is drawn in a ``picture``). So are functions under njit, and all that stands outside of functions in their files: numba
compiles it into kernels that it finds again in its cache.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.operators.provider import OperatorProvider

TOP = Path(__file__).parents[2]

#: Operators that leave a program which may run: one change for each, the smallest that a test should notice.
BOTH_WAYS = (("Add", "Sub"), ("Mul", "Div"), ("BitOr", "BitAnd"))
BINARY = (*(f"{one}_{other}" for pair in BOTH_WAYS for one, other in (pair, pair[::-1])),)
BINARY += ("FloorDiv_Div", "Mod_Mul", "Pow_Mul")
COMPARED = ["Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt", "Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"]
REPLACED = ["TrueWithFalse", "FalseWithTrue", "AndWithOr", "OrWithAnd", "BreakWithContinue", "ContinueWithBreak"]
OPERATORS = (
    *(f"ReplaceBinaryOperator_{name}" for name in BINARY),
    *(f"ReplaceComparisonOperator_{name}" for name in COMPARED),
    *(f"ReplaceUnaryOperator_Delete_{name}" for name in ("USub", "Not", "Invert")),
    *(f"Replace{name}" for name in REPLACED),
    *("NumberReplacer", "AddNot", "ZeroIterationForLoop", "ExceptionReplacer"),
)


@dataclass(frozen=True)
class Mutant:
    """One change of a module, known by the text of its line: lines may be added above it and it is still the same."""

    module: str  # path below the top folder
    line: str  # without the indent
    operator: str
    occurrence: int  # among the mutants of this operator in lines of this text
    number: int  # of the line
    position: int  # among all places of this operator in the module

    @property
    def key(self) -> tuple[str, str, str, int]:
        """Module, line, operator and occurrence, by which it is drawn."""
        return self.module, self.line, self.operator, self.occurrence

    def text(self) -> str:
        """The whole module with the change."""
        changed = mutate_code((TOP / self.module).read_text(), OperatorProvider()[self.operator](), self.position)
        assert changed is not None, self
        return changed


def mutants_of(module: str) -> Iterator[Mutant]:
    """Every mutant of a module, given by its path below the top folder."""
    source = (TOP / module).read_text()
    lines, tree = source.splitlines(), get_ast(source)
    kernels = "njit" in source
    for name in OPERATORS:
        operator, position, seen = OperatorProvider()[name](), 0, Counter[str]()
        for node in ast_nodes(tree):
            for (number, _), _ in operator.mutation_positions(node):
                if not _unseen(node, kernels):
                    line = lines[number - 1].strip()
                    yield Mutant(module, line, name, seen[line], number, position)
                    seen[line] += 1
                position += 1


def _unseen(node, kernels: bool) -> bool:
    """Whether a change of a node is one that is left out."""
    if node.type == "if_stmt" and node.children[1].get_code().strip() == "TYPE_CHECKING":
        return True
    if node.type == "operator" and node.parent.type in ("parameters", "typedargslist"):
        return True
    function, child = None, node
    while (parent := child.parent) is not None:
        if (
            parent.type.startswith("fstring")
            or parent.type in ("raise_stmt", "decorator")
            or (parent.type == "annassign" and child is parent.children[1])
            or (parent.type == "tfpdef" and child is parent.children[-1])
            or (parent.type == "funcdef" and child is parent.annotation)
            or (parent.type == "argument" and parent.children[0].get_code().strip() == "strict")
            or (parent.type == "atom_expr" and parent.get_first_leaf().value in ("logger", "picture"))
        ):
            return True
        if parent.type == "funcdef":
            function = parent
            if parent.name.value in ("_picture", "_facts") or any(
                "njit" in one.get_code() for one in function.get_decorators()
            ):
                return True
        child = parent
    return kernels and function is None
