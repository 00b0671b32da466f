"""Exact derivatives of the equations by reverse accumulation: one formula, any number of columns.

The equations run once on :class:`Traced` numbers, which record the operations applied to them. Every output of the Magic
Formula belongs to one operating condition. So the reverse pass costs a few evaluations of the formula, however many inputs
and coefficients are differentiated, and nothing is summed over conditions.

>>> from tir.derivatives import gradient, traced
>>> x, = traced({"x": 2.0}).values()
>>> gradient(x * x, [x])
array([4.])
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from heapq import heappop, heappush
from typing import Any

import numpy as np

Rule = Callable[..., tuple[Any, ...]]

PARTIALS: dict[Any, Rule] = {
    np.negative: lambda out, a: (-1.0,),
    np.positive: lambda out, a: (1.0,),
    np.absolute: lambda out, a: (np.where(a < 0.0, -1.0, 1.0),),
    np.sin: lambda out, a: (np.cos(a),),
    np.cos: lambda out, a: (-np.sin(a),),
    np.tan: lambda out, a: (1.0 + out * out,),
    np.arctan: lambda out, a: (1.0 / (1.0 + a * a),),
    np.arccos: lambda out, a: (-1.0 / np.sqrt(np.where(a * a < 1.0, 1.0 - a * a, 1e-300)),),
    np.exp: lambda out, a: (out,),
    np.sqrt: lambda out, a: (0.5 / np.where(out <= 0.0, np.inf, out),),
    np.add: lambda out, a, b: (1.0, 1.0),
    np.subtract: lambda out, a, b: (1.0, -1.0),
    np.multiply: lambda out, a, b: (b, a),
    np.divide: lambda out, a, b: (1.0 / b, -out / b),
    np.power: lambda out, a, b: (b * a ** (b - 1.0), out * np.log(np.where(np.real(a) > 0.0, a, 1.0))),
    np.maximum: lambda out, a, b: (np.where(a >= b, 1.0, 0.0), np.where(a >= b, 0.0, 1.0)),
}
"""Partial derivatives of each elementary operation, from its result and its arguments."""

COMPARISONS = {np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal}


class Traced(np.lib.mixins.NDArrayOperatorsMixin):
    """A number, or an array with one per operating condition, that records how it was computed."""

    __slots__ = ("parents", "place", "tape", "value")

    def __init__(self, value: Any, tape: list[Traced], parents: tuple[tuple[Traced, Any], ...] = ()) -> None:
        self.value, self.tape, self.parents, self.place = value, tape, parents, len(tape)
        tape.append(self)

    @property
    def real(self) -> Any:
        """The plain value, which comparisons in the equations use."""
        return self.value

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        values = [plain(x) for x in inputs]
        out = ufunc(*values)
        if ufunc in COMPARISONS:
            return out
        if ufunc not in PARTIALS or method != "__call__" or kwargs:
            return NotImplemented
        return self._derived(out, inputs, PARTIALS[ufunc](out, *values))

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        if function is np.real:
            return self.value
        if function is not np.where or kwargs:
            return NotImplemented
        chosen, a, b = args
        out = np.where(chosen, plain(a), plain(b))
        return self._derived(out, (a, b), of_choice(chosen))

    def derived(self, value: Any, partial: Any) -> Traced:
        """A number computed from this one, with the derivative given."""
        return Traced(value, self.tape, ((self, partial),))

    def _derived(self, value: Any, inputs: Sequence[Any], partials: Sequence[Any]) -> Traced:
        parents = tuple((x, d) for x, d in zip(inputs, partials, strict=True) if isinstance(x, Traced))
        return Traced(value, self.tape, parents)


def of_choice(chosen: Any) -> tuple[Any, Any]:
    """Partial derivatives of ``where`` by its two alternatives."""
    return np.where(chosen, 1.0, 0.0), np.where(chosen, 0.0, 1.0)


def plain(x: Any) -> Any:
    """The value without its record."""
    return x.value if isinstance(x, Traced) else x


def traced(values: Mapping[str, Any]) -> dict[str, Traced]:
    """The numbers (floats, scalar or (n,) each; not integers) to differentiate by, on a new tape."""
    tape: list[Traced] = []
    return {name: Traced(value, tape) for name, value in values.items()}


def gradient(output: Any, wrt: Sequence[Traced]) -> np.ndarray:
    """Derivative of an output, scalar or (n,), by k traced numbers: (k,) or (n, k); an array (n,) has one element per
    condition.

    The n derivatives by one number are next to each other in memory.
    """
    rows = np.zeros((len(wrt), *np.shape(plain(output))))
    out = np.moveaxis(rows, 0, -1)
    if not isinstance(output, Traced) or not wrt:
        return out
    column = {x.place: k for k, x in enumerate(wrt)}
    sensitivity: dict[int, Any] = {output.place: 1.0}
    latest = [-output.place]  # a heap: only numbers that the output depends on, each after all that use it
    while latest:
        place = -heappop(latest)
        passed = sensitivity.pop(place)
        if place in column:
            rows[column[place]] = passed
        for parent, partial in output.tape[place].parents:
            key = parent.place
            share = partial if isinstance(passed, float) and passed == 1.0 else passed * partial
            if key in sensitivity:
                sensitivity[key] = sensitivity[key] + share
            else:
                sensitivity[key] = share
                heappush(latest, -key)
    return out
