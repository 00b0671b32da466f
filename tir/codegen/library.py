"""A program in the functions of another library: CasADi's symbols, or the arrays of numpy, JAX, torch and CuPy."""

import operator
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from tir.codegen.graph import OPERATORS
from tir.codegen.program import Program, computed
from tir.codegen.source import FUNCTIONS

GUARDED = {"sqrt": (0.0, 0.0), "arccos": (1.0, 0.0)}
"""Functions with an infinite slope at the end of their range: that end, and the value there. At it the slope is taken as 0."""
Operations = Mapping[str, Callable[..., Any]]


def operations_of(library: Any, where: Callable[..., Any], **others: Callable[..., Any]) -> Operations:
    """The operations of a program: the library's functions, its choice between two numbers, and ``others``."""
    found = {name: getattr(library, name) for name in FUNCTIONS if name != "power"}
    guarded = {name: partial(_guarded, found[name], where, *ends) for name, ends in GUARDED.items()}
    return {**OPERATORS, "power": operator.pow, **found, **guarded, "where": where, **others}


def _guarded(
    function: Callable[..., Any], where: Callable[..., Any], end: float, there: float, x: Any
) -> Any:
    """The function with slope 0 at the end of its range: an infinite slope times the 0 behind it would be NaN."""
    at_end = x == end
    return where(at_end, there, function(where(at_end, 0.5, x)))


def run(program: Program, operations: Operations, symbols: Mapping[str, Any]) -> list[Any]:
    """The outputs of the program."""
    return computed(
        (*program.per_tyre, *program.per_point), program.outputs.values(), operations, symbols, {}
    )
