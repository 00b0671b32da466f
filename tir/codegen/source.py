"""A program as text: assignments in the syntax of a language."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tir.codegen.constants import LONGEST_INLINED_EXPRESSION
from tir.codegen.graph import Node
from tir.codegen.program import INPUTS, Program, called

FUNCTIONS = ("sqrt", "exp", "sin", "cos", "tan", "arctan", "arccos", "power")
NAMES = {name: name for name in FUNCTIONS} | {"arctan": "atan", "arccos": "acos", "power": "pow"}
"""Functions by their names in C, Python and most other languages."""
COMPARISONS = ("less", "less_equal", "greater", "greater_equal", "both")


@dataclass(frozen=True, slots=True)
class SourceDialect:
    """Syntax of a language: for each operation a template with braces for the arguments."""

    templates: Mapping[str, str]
    truth: tuple[str, str] = ("False", "True")
    number: str = "{} = {}"  #: assignment of a number
    flag: str = ""  #: assignment of a truth value, if it is another one
    beyond: tuple[str, str] = ("inf", "nan")  #: infinity and NaN
    inline: bool = True  #: whether an expression used once is written inside the expression that uses it

    def literal(self, x: float | bool) -> str:
        """A number as text that reads back as the same number."""
        if isinstance(x, bool):
            return self.truth[x]
        if math.isfinite(x):
            return repr(x)
        return self.beyond[1] if math.isnan(x) else "-" * (x < 0) + self.beyond[0]


COMMON = {
    "add": "({} + {})",
    "subtract": "({} - {})",
    "multiply": "({} * {})",
    "divide": "({} / {})",
    "negative": "(-{})",
    "less": "({} < {})",
    "less_equal": "({} <= {})",
    "greater": "({} > {})",
    "greater_equal": "({} >= {})",
    "absolute": "abs({})",
    **{name: f"{given}({{}})" for name, given in NAMES.items()},
    "power": "pow({}, {})",
}
"""Templates that all languages share."""
PYTHON = SourceDialect({**COMMON, "where": "({1} if {0} else {2})", "both": "({} and {})"})


def name_of(node: Node) -> str:
    """The name of the variable that holds the result of an operation."""
    return called(node.name) if node.operation == "symbol" else f"v{node.number}"


def assignments(
    nodes: Iterable[Node], results: Iterable[Any], dialect: SourceDialect
) -> tuple[list[str], list[str]]:
    """Lines that compute the nodes, and the expressions of the results; symbols and other nodes are taken for existing
    variables.
    """
    nodes, results = [node for node in nodes if node.operation != "symbol"], list(results)
    uses = Counter(a.number for node in nodes for a in node.arguments if isinstance(a, Node))
    uses.update({x.number: 2 for x in results if isinstance(x, Node)})
    inside: dict[int, str] = {}

    def written(x: Any) -> str:
        if not isinstance(x, Node):
            return dialect.literal(x)
        return inside.pop(x.number) if x.number in inside else name_of(x)

    lines = []
    for node in nodes:
        text = dialect.templates[node.operation].format(*map(written, node.arguments))
        if dialect.inline and uses[node.number] == 1 and len(text) < LONGEST_INLINED_EXPRESSION:
            inside[node.number] = text
            continue
        form = (dialect.flag if node.operation in COMPARISONS else "") or dialect.number
        lines.append(form.format(name_of(node), text))
    return lines, [written(x) for x in results]


def preparation(program: Program) -> str:
    """Python source of ``prepare(p, <functions>)``: the constants of the program for a tyre, from its values by name."""
    lines, results = assignments(program.per_tyre, program.constants, PYTHON)
    given = [f'{name} = p["{name}"]' for name in program.parameters]
    return function(f"prepare(p, {', '.join(NAMES.values())})", [*given, *lines, _returned(results)])


def conditions(program: Program, inputs: Sequence[str] = INPUTS) -> str:
    """Python source of ``run(<inputs>, <constants>)``: the outputs at an operating condition."""
    lines, results = assignments(program.per_point, program.outputs.values(), PYTHON)
    given = (*map(called, inputs), *map(name_of, program.constants))
    return function(f"run({', '.join(given)})", [*lines, _returned(results)])


def function(head: str, lines: Iterable[str]) -> str:
    """A Python function as text."""
    return f"def {head}:\n" + "".join(f"    {line}\n" for line in lines)


def _returned(results: Iterable[str]) -> str:
    return f"return ({', '.join(results)},)"
