"""Numbers that record the operations applied to them, each once: the equations as a graph."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

OPERATIONS: dict[Any, str] = {
    np.add: "add", np.subtract: "subtract", np.multiply: "multiply", np.divide: "divide", np.power: "power",
    np.negative: "negative", np.absolute: "absolute", np.sqrt: "sqrt", np.exp: "exp", np.sin: "sin", np.cos: "cos",
    np.tan: "tan", np.log: "log", np.arctan: "arctan", np.arccos: "arccos", np.less: "less", np.less_equal: "less_equal",
    np.greater: "greater", np.greater_equal: "greater_equal", np.bitwise_and: "both",
}  # fmt: skip
UFUNCS = {name: ufunc for ufunc, name in OPERATIONS.items()}
OPERATORS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "divide": operator.truediv,
    "negative": operator.neg, "absolute": abs, "less": operator.lt, "less_equal": operator.le,
    "greater": operator.gt, "greater_equal": operator.ge, "both": operator.and_,
}  # fmt: skip
"""Operations that Python itself has for numbers of any kind."""
CONSTANT, PARAMETER, INPUT = 0, 1, 2
"""What a number depends on: nothing, the tyre alone, or the operating condition."""
INTEGER_POWERS = (2, 3, 4)


class Node(np.lib.mixins.NDArrayOperatorsMixin):
    """The result of one operation; arguments are nodes or plain numbers."""

    __slots__ = ("arguments", "graph", "level", "name", "number", "operation")

    def __init__(self, graph: Graph, operation: str, arguments: tuple[Any, ...], level: int, name: str = ""):
        self.graph, self.operation, self.arguments = graph, operation, arguments
        self.level, self.name, self.number = level, name, len(graph.nodes)

    @property
    def real(self) -> Node:
        """Itself, because only real numbers are recorded."""
        return self

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        if ufunc not in OPERATIONS or method != "__call__" or kwargs:
            return NotImplemented
        return self.graph.apply(OPERATIONS[ufunc], *inputs)

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        if function is np.real:
            return self
        if function is not np.where or kwargs:
            return NotImplemented
        return self.graph.apply("where", *args)


class Graph:
    """Every operation of a run, equal ones once, each after its arguments."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._known: dict[Any, Node] = {}

    def symbol(self, name: str, level: int) -> Node:
        """A node for a parameter or an input."""
        return self._node("symbol", (), level, name)

    def apply(self, operation: str, *arguments: Any) -> Any:
        """The result of an operation: a plain number if all arguments are, else a node, reused if the operation exists."""
        arguments = tuple(a if isinstance(a, Node) else _number(a) for a in arguments)
        if not any(isinstance(a, Node) for a in arguments):
            return _compute(operation, arguments)
        rule = RULES.get(operation)
        simpler = rule(self, *arguments) if rule else None
        if simpler is not None:
            return simpler
        return self._node(operation, arguments, max(level(a) for a in arguments))

    def _node(self, operation: str, arguments: tuple[Any, ...], level: int, name: str = "") -> Node:
        key = (operation, name, *(a.number if isinstance(a, Node) else (type(a), a) for a in arguments))
        if key not in self._known:
            self._known[key] = Node(self, operation, arguments, level, name)
            self.nodes.append(self._known[key])
        return self._known[key]


def level(x: Any) -> int:
    """What a number depends on: CONSTANT, PARAMETER or INPUT."""
    return x.level if isinstance(x, Node) else CONSTANT


def _number(x: Any) -> float | bool:
    return bool(x) if isinstance(x, bool | np.bool_) else float(x)


def _compute(operation: str, arguments: tuple[Any, ...]) -> float | bool:
    if operation == "where":
        chosen: float | bool = arguments[1] if arguments[0] else arguments[2]
        return chosen
    with np.errstate(all="ignore"):
        return _number(UFUNCS[operation](*arguments))


def _is(x: Any, value: float) -> bool:
    return not isinstance(x, Node) and x == value


def _made_by(x: Any, operation: str) -> bool:
    return isinstance(x, Node) and x.operation == operation


def _add(graph: Graph, a: Any, b: Any) -> Any:
    if _is(a, 0.0) or _is(b, 0.0):
        return b if _is(a, 0.0) else a
    return None


def _subtract(graph: Graph, a: Any, b: Any) -> Any:
    if _is(b, 0.0):
        return a
    return graph.apply("negative", b) if _is(a, 0.0) else None


def _multiply(graph: Graph, a: Any, b: Any) -> Any:
    if level(b) < level(a) or (level(b) == level(a) and _number_of(b) < _number_of(a)):
        a, b = b, a
    if _is(a, 1.0):
        return b
    if _is(a, -1.0):
        return graph.apply("negative", b)
    if (
        not isinstance(a, Node)
        and _made_by(b, "where")
        and level(b.arguments[1]) == level(b.arguments[2]) == CONSTANT
    ):
        return graph.apply("where", b.arguments[0], *(a * x for x in b.arguments[1:]))
    if _is_sign_of(a, b) or _is_sign_of(b, a):
        return graph.apply("absolute", a if _is_sign_of(b, a) else b)
    return _with_factors_in_front(graph, a, b)


def _with_factors_in_front(graph: Graph, a: Any, b: Any) -> Any:
    """A product with the factors of the tyre first, so that they are multiplied once per tyre."""
    if level(a) < INPUT and level(b) == INPUT and _made_by(b, "multiply") and level(b.arguments[0]) < INPUT:
        return graph.apply("multiply", graph.apply("multiply", a, b.arguments[0]), b.arguments[1])
    if level(a) == INPUT:
        for x, y in ((a, b), (b, a)):
            if _made_by(x, "multiply") and level(x.arguments[0]) < INPUT:
                return graph.apply("multiply", x.arguments[0], graph.apply("multiply", x.arguments[1], y))
    return graph._node("multiply", (a, b), max(level(a), level(b)))


def _divide(graph: Graph, a: Any, b: Any) -> Any:
    if _is(b, 1.0):
        return a
    if level(b) < INPUT and level(a) == INPUT:
        return graph.apply("multiply", graph.apply("divide", 1.0, b), a)
    return None


def _power(graph: Graph, a: Any, b: Any) -> Any:
    if _is(b, 0.0):
        return 1.0
    if _is(b, 1.0):
        return a
    if isinstance(b, Node) or b not in INTEGER_POWERS:
        return None
    square = graph.apply("multiply", a, a)
    return square if b == 2.0 else graph.apply("multiply", square, a if b == 3.0 else square)


def _negative(graph: Graph, a: Any) -> Any:
    if _made_by(a, "negative"):
        return a.arguments[0]
    if _made_by(a, "multiply") and level(a.arguments[0]) < INPUT == level(a):
        return graph.apply("multiply", graph.apply("negative", a.arguments[0]), a.arguments[1])
    return None


def _cos(graph: Graph, a: Any) -> Any:
    if not _made_by(a, "arctan"):
        return None
    (x,) = a.arguments
    return graph.apply("divide", 1.0, graph.apply("sqrt", 1.0 + x * x))


def _where(graph: Graph, chosen: Any, a: Any, b: Any) -> Any:
    if not isinstance(chosen, Node):
        return a if chosen else b
    return a if a is b or (level(a) == level(b) == CONSTANT and a == b) else None


def _both(graph: Graph, a: Any, b: Any) -> Any:
    for one, other in ((a, b), (b, a)):
        if not isinstance(one, Node):
            return other if one else False
    return None


def _is_sign_of(s: Any, x: Any) -> bool:
    """Whether s is -1 where x < 0 and else 1."""
    if not _made_by(s, "where"):
        return False
    negative, minus, plus = s.arguments
    if not (_is(minus, -1.0) and _is(plus, 1.0) and _made_by(negative, "less")):
        return False
    return negative.arguments[0] is x and _is(negative.arguments[1], 0.0)


def _number_of(x: Any) -> int:
    return x.number if isinstance(x, Node) else -1


RULES: dict[str, Callable[..., Any]] = {
    "add": _add,
    "subtract": _subtract,
    "multiply": _multiply,
    "divide": _divide,
    "power": _power,
    "negative": _negative,
    "cos": _cos,
    "where": _where,
    "both": _both,
}
"""Rules for a simpler equal expression, equal to rounding for infinity and NaN too; None if there is none."""
