"""A recorded run of the model: the operations per tyre and those per operating condition."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

from tir.codegen.graph import INPUT, PARAMETER, Graph, Node, level
from tir.equations.normalise import OperatingCondition
from tir.equations.normalise import Switches as Switches
from tir.errors import TirError, some
from tir.evaluate import either_way, loaded_radius, zero_divisors
from tir.parameters import TABLE

INPUTS = OperatingCondition._fields
ORDER = ("Fz", "kappa", "alpha", "gamma", "phi_t", "Vx", "pressure")
"""Inputs in the order that is usual in other programs."""
CALLED = {"pressure": "p"}
"""Inputs with other names in calls and exported code than in the equations, where p is the parameters."""
LOADED = "RL"
"""The loaded radius, which is not a state of the model because many files lack what it depends on."""
NUMBERS = tuple(row.name for row in TABLE if row.kind == "number")


def called(name: str) -> str:
    """The name of an input in a call of the tyre and in exported code."""
    return CALLED.get(name, name)


@dataclass(frozen=True, slots=True)
class Program:
    """Operations in order, and their results.

    ``per_tyre`` depends on parameters only, ``per_point`` on inputs too; ``constants`` are those of ``per_tyre``, parameters
    themselves included, that the rest uses.
    """

    per_tyre: tuple[Node, ...]
    per_point: tuple[Node, ...]
    constants: tuple[Node, ...]
    outputs: Mapping[str, Any]  #: name of a force or state -> node or number

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters that the outputs depend on and that have no value in the program."""
        return tuple(node.name for node in self.per_tyre if node.operation == "symbol")


Parameters = Callable[[Graph], dict[str, Any]]
"""Gives the parameters of a run by name: symbols of a graph, or numbers."""


def symbols_of(graph: Graph) -> dict[str, Any]:
    """Every parameter as a symbol."""
    return {name: graph.symbol(name, PARAMETER) for name in NUMBERS}


def trace(switches: Switches, outputs: tuple[str, ...], parameters: Parameters = symbols_of) -> Program:
    """Run the model on symbols; ``outputs`` are fields of Forces and State, or RL."""
    found = run_on_symbols(switches, parameters, {}, radius=LOADED in outputs)
    for name in outputs:
        if name not in found:
            raise TirError(f"{name} is no force or state: use {', '.join(found)}", name=name)
    return program_of({name: found[name] for name in outputs})


def run_on_symbols(
    switches: Switches, parameters: Parameters, given: Mapping[str, float], *, radius: bool = False
) -> dict[str, Any]:
    """Every force and state as a node of one graph, or as a number.

    ``given`` are the inputs that are numbers already; ``radius`` asks for RL, the loaded radius, too: with it there are twice as
    many nodes.
    """
    graph = Graph()
    p = SimpleNamespace(**parameters(graph))
    inputs: list[Any] = [given[name] if name in given else graph.symbol(name, INPUT) for name in INPUTS]
    at = OperatingCondition(*inputs)
    forces, state = either_way(p, at.Vx < 0.0, at, switches)
    found = {**state._asdict(), **forces._asdict()}
    return found | {LOADED: loaded_radius(p, at, forces, state)} if radius else found


def refuse_zero_divisors(p: Any, switches: Switches, outputs: Sequence[str]) -> None:
    """Raise TirError if a parameter is 0 by which the equations of these forces and states divide."""
    for name in zero_divisors(p):
        need = that_need(name, switches, outputs)
        if need:
            mode = " with turn slip" if switches.turn_slip else ""
            raise TirError(
                f"{name} is 0, but the equations of {some(need)}{mode} divide by it: give its value",
                name=name,
            )


def that_need(name: str, switches: Switches, outputs: Sequence[str]) -> list[str]:
    """The outputs that depend on a parameter."""
    return [output for output in outputs if name in parameters_of((output,), switches)]


@cache
def parameters_of(outputs: tuple[str, ...], switches: Switches) -> frozenset[str]:
    """Names of the parameters that the outputs depend on."""
    return frozenset(trace(switches, outputs).parameters)


def needed(results: Collection[Any]) -> list[Node]:
    """Every node that the results depend on, in order."""
    wanted = {x.number: x for x in results if isinstance(x, Node)}
    if not wanted:
        return []
    graph = next(iter(wanted.values())).graph
    for node in reversed(graph.nodes):
        if node.number in wanted:
            wanted.update((a.number, a) for a in node.arguments if isinstance(a, Node))
    return [wanted[number] for number in sorted(wanted)]


def program_of(outputs: Mapping[str, Any]) -> Program:
    """The program of nodes, or numbers, by name of the output."""
    nodes = needed(outputs.values())
    per_point = tuple(node for node in nodes if node.level == INPUT)
    used = [*(a for node in per_point for a in node.arguments), *outputs.values()]
    constants = {a.number: a for a in used if isinstance(a, Node) and level(a) == PARAMETER}
    return Program(
        per_tyre=tuple(node for node in nodes if node.level == PARAMETER),
        per_point=per_point,
        constants=tuple(constants[number] for number in sorted(constants)),
        outputs=outputs,
    )


def computed(
    nodes: Iterable[Node],
    results: Iterable[Any],
    operations: Mapping[str, Callable[..., Any]],
    symbols: Mapping[str, Any],
    known: dict[int, Any],
) -> list[Any]:
    """The results in other numbers, by ``operations`` on ``symbols``; ``known`` holds values by the number of a node."""

    def value(x: Any) -> Any:
        return known[x.number] if isinstance(x, Node) else x

    for node in nodes:
        if node.operation == "symbol":
            known[node.number] = symbols[node.name]
        else:
            known[node.number] = operations[node.operation](*map(value, node.arguments))
    return [*map(value, results)]
