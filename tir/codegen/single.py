"""The model for one operating condition in Python's own floats: no array, no compiler."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np

from tir.codegen.program import INPUTS, Program, Switches, trace
from tir.codegen.source import NAMES, conditions, preparation

Run = Callable[..., tuple[float, ...]]
MATH = {given: getattr(math, given) for given in NAMES.values()}
NUMPY = {given: getattr(np, name) for name, given in NAMES.items()}


@cache
def compiled_for(switches: Switches, outputs: tuple[str, ...]) -> tuple[Any, Any]:
    """The functions of :func:`compiled` for any tyre."""
    return compiled(trace(switches, outputs))


def compiled(program: Program, inputs: Sequence[str] = INPUTS) -> tuple[Any, Any]:
    """The functions :func:`~tir.codegen.source.preparation` and :func:`~tir.codegen.source.conditions` of a program."""
    namespace = dict(MATH)
    exec(preparation(program) + conditions(program, inputs), namespace)
    return namespace["prepare"], namespace["run"]


def constants(prepare: Callable[..., tuple[float, ...]], values: Mapping[str, float]) -> tuple[float, ...]:
    """The constants of a tyre as Python floats; where Python's arithmetic raises, NaN or infinity as in numpy."""
    try:
        return prepare(values, **MATH)
    except (ArithmeticError, ValueError):
        with np.errstate(all="ignore"):
            numbers = {name: np.float64(value) for name, value in values.items()}
            return tuple(float(x) for x in prepare(numbers, **NUMPY))


def run_of(values: Mapping[str, float], switches: Switches, outputs: tuple[str, ...]) -> Run:
    """The tyre as a function of :data:`~tir.codegen.program.INPUTS` in floats.

    Raises ArithmeticError or ValueError where numpy gives NaN or infinity.
    """
    prepare, run = compiled_for(switches, outputs)
    return with_defaults(run, constants(prepare, values))


def with_defaults(run: FunctionType, last: tuple[float, ...]) -> Run:
    """A copy of the function with values for its last arguments, as defaults: Python reads arguments fastest."""
    return FunctionType(run.__code__, run.__globals__, run.__name__, last)
