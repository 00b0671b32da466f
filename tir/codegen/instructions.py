"""Vectors of numbers whose operations become instructions of the machine. Imports llvmlite, so import this module late."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from llvmlite import ir

DOUBLE, INTEGER, SHORT = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
MAY_BE_ONE = ("contract",)
"""A product and a sum may become one instruction, with one rounding."""


class VectorValue(np.lib.mixins.NDArrayOperatorsMixin):
    """The result of an instruction: a vector of float64, of 64-bit integers or of truth values."""

    __slots__ = ("builder", "value")

    def __init__(self, builder: ir.IRBuilder, value: ir.Value):
        self.builder, self.value = builder, value

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any) -> VectorValue:
        type_ = self.value.type  # of numbers, which stand in every lane
        operands = (x.value if isinstance(x, VectorValue) else repeated(type_, x) for x in inputs)
        return VectorValue(self.builder, INSTRUCTIONS[ufunc](self.builder, *operands))


def _sum(builder: ir.IRBuilder, x: ir.Value, y: ir.Value) -> ir.Value:
    if x.type.element == INTEGER:
        return builder.add(x, y)
    return builder.fadd(x, y, flags=MAY_BE_ONE)


def _intrinsic(name: str, builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    name += f".v{x.type.count}f64"
    known = builder.module.globals.get(name)
    return builder.call(known or ir.Function(builder.module, ir.FunctionType(x.type, [x.type]), name), [x])


def _compared(how: str, builder: ir.IRBuilder, x: ir.Value, y: ir.Value) -> ir.Value:
    return builder.fcmp_ordered(how, x, y)


INSTRUCTIONS: dict[Any, Callable[..., ir.Value]] = {
    np.add: _sum,
    np.subtract: partial(ir.IRBuilder.fsub, flags=MAY_BE_ONE),
    np.multiply: partial(ir.IRBuilder.fmul, flags=MAY_BE_ONE),
    np.divide: ir.IRBuilder.fdiv,
    np.negative: ir.IRBuilder.fneg,
    np.absolute: partial(_intrinsic, "llvm.fabs"),
    np.sqrt: partial(_intrinsic, "llvm.sqrt"),
    np.less: partial(_compared, "<"),
    np.less_equal: partial(_compared, "<="),
    np.greater: partial(_compared, ">"),
    np.greater_equal: partial(_compared, ">="),
    np.equal: partial(_compared, "=="),
    np.bitwise_and: ir.IRBuilder.and_,
    np.bitwise_or: ir.IRBuilder.or_,
    np.bitwise_xor: ir.IRBuilder.xor,
    np.left_shift: ir.IRBuilder.shl,
    np.right_shift: ir.IRBuilder.lshr,
}


def repeated(type_: ir.VectorType, x: Any) -> ir.Constant:
    """A constant in every lane."""
    return ir.Constant(type_, [x] * type_.count)


def select(chosen: Any, a: Any, b: Any) -> Any:
    """a where chosen, else b; both are computed, so there is no branch."""
    if isinstance(chosen, bool):
        return a if chosen else b
    type_ = ir.VectorType(DOUBLE, chosen.value.type.count)
    operands = [x.value if isinstance(x, VectorValue) else repeated(type_, float(x)) for x in (a, b)]
    return VectorValue(chosen.builder, chosen.builder.select(chosen.value, *operands))


def bits(x: VectorValue) -> VectorValue:
    """The bits of a float64."""
    return _read_as(INTEGER, x)


def number(x: VectorValue) -> VectorValue:
    """The float64 of these bits."""
    return _read_as(DOUBLE, x)


def _read_as(lane: ir.Type, x: VectorValue) -> VectorValue:
    return VectorValue(x.builder, x.builder.bitcast(x.value, ir.VectorType(lane, x.value.type.count)))


def in_every_lane(builder: ir.IRBuilder, type_: ir.VectorType, x: ir.Value) -> ir.Value:
    """A vector of one float64."""
    nothing = ir.Constant(type_, ir.Undefined)
    first = builder.insert_element(nothing, x, ir.Constant(SHORT, 0))
    return builder.shuffle_vector(
        first, nothing, ir.Constant(ir.VectorType(SHORT, type_.count), [0] * type_.count)
    )
