"""A program and its derivatives repeated operation by operation in numpy, without a compiler: only what the outputs need.

The derivatives are more operations of the same graph; their rules are those of :mod:`tir.derivatives`.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, lru_cache
from threading import RLock
from typing import Any, NamedTuple

import numpy as np

from tir.codegen.graph import INPUT, OPERATORS, UFUNCS, Node
from tir.codegen.program import INPUTS, NUMBERS, Switches, needed, run_on_symbols, symbols_of
from tir.derivatives import PARTIALS, of_choice

SMOOTH = {name: PARTIALS[ufunc] for name, ufunc in UFUNCS.items() if ufunc in PARTIALS}


def derivatives(result: Any, wrt: Collection[str]) -> dict[str, Any]:
    """The derivative of an output by each named symbol: a node or a number, added to its graph; missing ones are zero.

    Reverse accumulation over the graph: every output belongs to one operating condition, so nothing is summed over
    conditions, and the column of a coefficient costs only its own operations.
    """
    if not isinstance(result, Node):
        return {}
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


IN_FLOATS = {**UFUNCS, **OPERATORS, "where": lambda chosen, a, b: a if chosen else b}
"""Functions for what depends on the tyre alone, usually scalars: an array function takes ten times as long."""


@cache
def in_numpy() -> dict[str, Callable[..., Any]]:
    """For arrays: numpy's; where it has the tangent as vector instructions (AVX-512), sine and cosine come from half the angle's.

    numpy computes the sine and cosine of doubles one by one, for their last bit, which takes six times as long.
    """
    found = {**UFUNCS, "where": np.where}
    return {**found, "sin": _sin, "cos": _cos} if _tangent_in_vectors() else found


def _sin(x: Any) -> Any:
    t = np.tan(0.5 * x)
    square = 1.0 + t * t
    t *= 2.0
    t /= square
    return t


def _cos(x: Any) -> Any:
    t = np.tan(0.5 * x)
    square = t * t
    cosine = 1.0 - square
    square += 1.0
    cosine /= square
    return cosine


def _tangent_in_vectors() -> bool:
    """Whether numpy reports this instruction set; False if it does not report any."""
    if not hasattr(np.lib, "introspect"):
        return False
    kinds = np.lib.introspect.opt_func_info(func_name="^tan$", signature="^d").get("tan", {}).values()
    return any("baseline" not in kind["current"] for kind in kinds)


class Replay(NamedTuple):
    """Operations on a list of places: the symbols first, then the constants, then the results of operations.

    Places are reused once their content is no longer needed, so that large arrays stay in the processor's cache.
    """

    symbols: tuple[str, ...]  #: names of the values that a run needs
    constants: tuple[Any, ...]
    room: int  #: number of places
    operations: tuple[tuple[Any, ...], ...]  #: (function, place of the result, places of the arguments)
    in_numpy: tuple[tuple[Any, ...], ...]  #: the same with array functions only
    results: tuple[int, ...]  #: places of the outputs

    def __call__(self, values: Mapping[str, Any]) -> list[Any]:
        """The outputs, from numbers by name: scalars or arrays that broadcast."""
        given = [*(values[name] for name in self.symbols), *self.constants]
        given += [None] * (self.room - len(given))
        with np.errstate(all="ignore"):
            try:
                at = _run(self.operations, given.copy())
            except (ArithmeticError, ValueError):  # a zero divisor, or a parameter for each condition
                at = _run(self.in_numpy, given)
        return [at[place] for place in self.results]


def _run(operations: tuple[tuple[Any, ...], ...], at: list[Any]) -> list[Any]:
    for operation in operations:
        if len(operation) == 4:
            function, to, a, b = operation
            at[to] = function(at[a], at[b])
        elif len(operation) == 3:
            function, to, a = operation
            at[to] = function(at[a])
        else:
            function, to, a, b, c = operation
            at[to] = function(at[a], at[b], at[c])
    return at


@lru_cache(maxsize=64)
def replay(
    switches: Switches, outputs: tuple[str, ...], wrt: tuple[str, ...] = (), still: tuple[str, ...] = ()
) -> Replay:
    """The program for some fields of Forces and State, and then for each of them its derivatives by ``wrt``; inputs ``still``
    are zero.
    """
    with _ONE_AT_A_TIME:
        found, known = _on_symbols(switches, still)
        if wrt:  # by everything at once; a replay computes only what it needs
            for name in set(outputs) - known.keys():
                known[name] = derivatives(found[name], {*NUMBERS, *INPUTS} - set(still))
        slopes = [known[name] if wrt else {} for name in outputs]
        return replayed(
            [*(found[name] for name in outputs), *(slope.get(x, 0.0) for slope in slopes for x in wrt)]
        )


_ONE_AT_A_TIME = RLock()
"""Held while a graph grows."""


@lru_cache(maxsize=16)
def _on_symbols(
    switches: Switches, still: tuple[str, ...]
) -> tuple[dict[str, Any], dict[str, Mapping[str, Any]]]:
    """Every force and state in one graph, and a place for the derivatives of each, which are of the same graph."""
    return run_on_symbols(switches, symbols_of, dict.fromkeys(still, 0.0)), {}


def replayed(results: Sequence[Any]) -> Replay:
    """The operations of nodes of one graph, or numbers."""
    nodes = needed(results)
    symbols = [node for node in nodes if node.operation == "symbol"]
    others = [node for node in nodes if node.operation != "symbol"]
    arguments = [[_key(a) for a in node.arguments] for node in others]
    kept = [_key(x) for x in results]
    constants = list(dict.fromkeys(key for keys in (kept, *arguments) for key in keys if type(key) is tuple))
    place = {key: i for i, key in enumerate([*(node.number for node in symbols), *constants])}
    room = allocated([node.number for node in others], arguments, frozenset(kept), place)
    places = [
        (place[node.number], *[place[key] for key in keys])
        for node, keys in zip(others, arguments, strict=True)
    ]
    of_inputs = in_numpy()

    def operations(of_tyre: Mapping[str, Any]) -> tuple[tuple[Any, ...], ...]:
        return tuple(
            ((of_inputs if node.level == INPUT else of_tyre)[node.operation], *where)
            for node, where in zip(others, places, strict=True)
        )

    return Replay(
        tuple(node.name for node in symbols),
        tuple(value for _, value in constants),
        room,
        operations(IN_FLOATS),
        operations(of_inputs),
        tuple(place[key] for key in kept),
    )


def allocated(
    results: Sequence[Any],
    arguments: Sequence[Sequence[Any]],
    kept: frozenset[Any],
    place: dict[Any, int],
    kind: Callable[[Any], bool] = lambda key: False,
) -> int:
    """Allocate a place for each result, reusing free ones; return the number of places.

    ``results`` and ``arguments`` are the keys of what the operations compute and use; what is in ``kept`` is never replaced.
    Keys of a different ``kind`` never share a place.
    """
    room = len(place)
    last = {key: i for i, keys in enumerate(arguments) for key in keys}
    for key in (*place, *kept):
        last.pop(key, None)
    free: dict[bool, list[int]] = {True: [], False: []}
    for i, (result, keys) in enumerate(zip(results, arguments, strict=True)):
        for key in keys:
            if last.get(key) == i:
                free[kind(key)].append(place[key])
                del last[key]  # both arguments may be the same
        if own := free[kind(result)]:
            place[result] = own.pop()
        else:
            place[result], room = room, room + 1
    return room


def _key(x: Any) -> Any:
    """Key of an argument: an integer for a node, type and value of a number, so that 0 and False differ."""
    return x.number if isinstance(x, Node) else (type(x), x)
