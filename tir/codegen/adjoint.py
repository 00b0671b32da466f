"""The derivatives of a program, as more operations of the same graph; the rules are those of :mod:`tir.derivatives`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from tir.codegen.graph import UFUNCS, Node
from tir.derivatives import PARTIALS, of_choice

SMOOTH = {name: PARTIALS[ufunc] for name, ufunc in UFUNCS.items() if ufunc in PARTIALS}


def derivatives(outputs: Mapping[str, Any], wrt: Collection[str]) -> dict[tuple[str, str], Any]:
    """The derivative of each output by each named symbol: a node or a number; missing pairs are zero.

    Reverse accumulation over the graph: every output belongs to one operating condition, so nothing is summed over
    conditions, and the column of a coefficient costs only its own operations.
    """
    out: dict[tuple[str, str], Any] = {}
    for name, result in outputs.items():
        if isinstance(result, Node):
            out.update({(name, symbol): d for symbol, d in _by_symbol(result, wrt).items()})
    return out


def _by_symbol(result: Node, wrt: Collection[str]) -> dict[str, Any]:
    nodes = result.graph.nodes[: result.number + 1]
    moves = _moved(nodes, wrt)
    passed: dict[int, Any] = {result.number: 1.0}
    found = {}
    for node in reversed(nodes):
        if node.number not in passed or not moves[node.number]:
            continue
        share = passed.pop(node.number)
        if node.operation == "symbol":
            found[node.name] = share
            continue
        for argument, partial in zip(node.arguments, _partials(node), strict=True):
            if isinstance(argument, Node) and moves[argument.number]:
                more = share * partial
                before = passed.get(argument.number)
                passed[argument.number] = more if before is None else before + more
    return found


def _moved(nodes: list[Node], wrt: Collection[str]) -> list[bool]:
    """Whether each node depends on a symbol in ``wrt``."""
    moves: list[bool] = []
    for node in nodes:
        by_arguments = any(isinstance(a, Node) and moves[a.number] for a in node.arguments)
        moves.append(node.name in wrt if node.operation == "symbol" else by_arguments)
    return moves


def _partials(node: Node) -> tuple[Any, ...]:
    """Partial derivatives of an operation by its arguments; zeros for a comparison."""
    if node.operation == "where":
        return 0.0, *of_choice(node.arguments[0])
    if node.operation not in SMOOTH:
        return (0.0,) * len(node.arguments)
    return SMOOTH[node.operation](node, *node.arguments)
