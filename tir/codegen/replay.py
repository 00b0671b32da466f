"""A program repeated operation by operation in numpy: no compiler, and only the operations that the outputs need."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np

from tir.codegen.adjoint import derivatives
from tir.codegen.graph import INPUT, UFUNCS, Node
from tir.codegen.program import INPUTS, NUMBERS, Switches, needed, run_on_symbols

IN_FLOATS = {
    **UFUNCS,
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "negative": operator.neg,
    "less": operator.lt,
    "greater": operator.gt,
    "where": lambda chosen, a, b: a if chosen else b,
}
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

    A place is used again when nothing needs what is in it any more, so that large arrays stay in the processor's cache.
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
    """The program for some forces or states and their derivatives.

    Parameters
    ----------
    switches : options of the model
    outputs : fields of Forces and State
    wrt : parameters and inputs to differentiate by
    still : inputs that are zero

    Returns
    -------
    Replay
        of the outputs, and then for each output its derivatives by ``wrt``
    """
    if not wrt:
        found = _on_symbols(switches, outputs, still)
        return _replay([found[name] for name in outputs])
    found, slopes = _with_derivatives(switches, outputs, still)
    return _replay(
        [*(found[name] for name in outputs), *(slopes.get((name, x), 0.0) for name in outputs for x in wrt)]
    )


def _on_symbols(switches: Switches, outputs: tuple[str, ...], still: tuple[str, ...]) -> dict[str, Any]:
    found = run_on_symbols(switches, {}, dict.fromkeys(still, 0.0))
    return {name: found[name] for name in outputs}


@lru_cache(maxsize=8)
def _with_derivatives(
    switches: Switches, outputs: tuple[str, ...], still: tuple[str, ...]
) -> tuple[dict[str, Any], Mapping[tuple[str, str], Any]]:
    """The outputs, and their derivatives by every parameter and input in the same graph, which is complete then.

    A replay computes only the derivatives that it needs.
    """
    found = _on_symbols(switches, outputs, still)
    return found, derivatives(found, {*NUMBERS, *INPUTS} - set(still))


def _replay(results: Sequence[Any]) -> Replay:
    nodes = needed(results)
    symbols = [node for node in nodes if node.operation == "symbol"]
    others = [node for node in nodes if node.operation != "symbol"]
    used = (*results, *(a for node in others for a in node.arguments))
    constants = list(dict.fromkeys(_key(x) for x in used if not isinstance(x, Node)))
    place = {key: i for i, key in enumerate([*map(_key, symbols), *constants])}
    room = _allocated(others, frozenset(map(_key, results)), place)
    places = [(place[_key(node)], *(place[_key(a)] for a in node.arguments)) for node in others]
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
        tuple(place[_key(x)] for x in results),
    )


def _allocated(nodes: Sequence[Node], kept: frozenset[Any], place: dict[Any, int]) -> int:
    """Number of places, after giving the result of every operation a place that is free by then."""
    given, room = frozenset(place), len(place)
    last = {_key(a): i for i, node in enumerate(nodes) for a in node.arguments}
    free: list[int] = []
    for i, node in enumerate(nodes):
        done = {_key(a) for a in node.arguments} - given - kept
        free += [place[key] for key in done if last[key] == i]
        if free:
            place[_key(node)] = free.pop()
        else:
            place[_key(node)], room = room, room + 1
    return room


def _key(x: Any) -> Any:
    """Key of an argument; 0 and False have different keys."""
    return x.number if isinstance(x, Node) else (type(x), x)
