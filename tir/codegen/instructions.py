"""Vectors of numbers whose operations become instructions of the machine. Imports llvmlite, so import this module late."""

from __future__ import annotations

from typing import Any

from llvmlite import ir

DOUBLE, INTEGER, SHORT = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
MAY_BE_ONE = ("contract",)
"""A product and a sum may become one instruction, with one rounding."""


class VectorValue:
    """The result of an instruction: a vector of float64, of 64-bit integers or of truth values."""

    __slots__ = ("builder", "value")

    def __init__(self, builder: ir.IRBuilder, value: ir.Value):
        self.builder, self.value = builder, value

    def like(self, x: Any) -> ir.Value:
        """The other operand of an operation: the value of a Number, or a constant in every lane."""
        return x.value if isinstance(x, VectorValue) else repeated(self.value.type, x)

    def _given(self, instruction: Any, *operands: Any, **options: Any) -> VectorValue:
        return VectorValue(self.builder, instruction(*operands, **options))

    def __add__(self, other: Any) -> VectorValue:
        if self.value.type.element == INTEGER:
            return self._given(self.builder.add, self.value, self.like(other))
        return self._given(self.builder.fadd, self.value, self.like(other), flags=MAY_BE_ONE)

    __radd__ = __add__

    def __sub__(self, other: Any) -> VectorValue:
        return self._given(self.builder.fsub, self.value, self.like(other), flags=MAY_BE_ONE)

    def __rsub__(self, other: Any) -> VectorValue:
        return self._given(self.builder.fsub, self.like(other), self.value, flags=MAY_BE_ONE)

    def __mul__(self, other: Any) -> VectorValue:
        return self._given(self.builder.fmul, self.value, self.like(other), flags=MAY_BE_ONE)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> VectorValue:
        return self._given(self.builder.fdiv, self.value, self.like(other))

    def __rtruediv__(self, other: Any) -> VectorValue:
        return self._given(self.builder.fdiv, self.like(other), self.value)

    def __neg__(self) -> VectorValue:
        return self._given(self.builder.fneg, self.value)

    def __abs__(self) -> VectorValue:
        return self._intrinsic("llvm.fabs")

    def sqrt(self) -> VectorValue:
        """Its square root."""
        return self._intrinsic("llvm.sqrt")

    def __lt__(self, other: Any) -> VectorValue:
        return self._compared("<", other)

    def __le__(self, other: Any) -> VectorValue:
        return self._compared("<=", other)

    def __gt__(self, other: Any) -> VectorValue:
        return self._compared(">", other)

    def __ge__(self, other: Any) -> VectorValue:
        return self._compared(">=", other)

    def __eq__(self, other: object) -> VectorValue:  # type: ignore[override]
        return self._compared("==", other)

    __hash__ = None  # type: ignore[assignment]

    def __and__(self, other: Any) -> VectorValue:
        return self._given(self.builder.and_, self.value, self.like(other))

    def __or__(self, other: Any) -> VectorValue:
        return self._given(self.builder.or_, self.value, self.like(other))

    def __xor__(self, other: Any) -> VectorValue:
        return self._given(self.builder.xor, self.value, self.like(other))

    def __lshift__(self, other: int) -> VectorValue:
        return self._given(self.builder.shl, self.value, self.like(other))

    def __rshift__(self, other: int) -> VectorValue:
        return self._given(self.builder.lshr, self.value, self.like(other))

    def _compared(self, how: str, other: Any) -> VectorValue:
        return self._given(self.builder.fcmp_ordered, how, self.value, self.like(other))

    def _intrinsic(self, name: str) -> VectorValue:
        type_, module = self.value.type, self.builder.module
        name += f".v{type_.count}f64"
        function = module.globals.get(name) or ir.Function(module, ir.FunctionType(type_, [type_]), name)
        return self._given(self.builder.call, function, [self.value])


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


def sqrt(x: VectorValue) -> VectorValue:
    """The square root, one instruction."""
    return x.sqrt()


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
