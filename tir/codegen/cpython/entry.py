"""The model as machine code that Python calls like its own built-in functions. Imports llvmlite, so import it late.

A function is bound to the constants of a tyre, which are its ``self``: the doubles of a ``bytes`` object, and behind them the
addresses of the types that a scalar call takes. Arguments
follow CPython's C interface METH_FASTCALL, without a converting layer between the call and the arithmetic.
"""

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from llvmlite import ir

from tir.codegen import vector_math
from tir.codegen.constants import DIVISION_TAKES
from tir.codegen.cpython import SCALARS
from tir.codegen.graph import OPERATORS, UFUNCS
from tir.codegen.instructions import DOUBLE, INTEGER, SHORT, VectorValue, in_every_lane, repeated, select
from tir.codegen.program import INPUTS, Program, computed
from tir.codegen.source import FUNCTIONS

POINTER = ir.IntType(8).as_pointer()
PAIR = ir.VectorType(DOUBLE, 2)
"""A scalar call computes the same condition twice in a vector: choices between numbers are a fifth faster there."""
SLOW = int(DIVISION_TAKES)
BUFFER = ir.ArrayType(INTEGER, 10)
"""Python's ``Py_buffer``: the address is its first word, the length in bytes its third."""
API = {
    "PyFloat_AsDouble": (DOUBLE, [POINTER]),
    "PyFloat_FromDouble": (POINTER, [DOUBLE]),
    "PyLong_AsSsize_t": (INTEGER, [POINTER]),
    "PyLong_FromLong": (POINTER, [INTEGER]),
    "PyTuple_New": (POINTER, [INTEGER]),
    "PyTuple_SetItem": (SHORT, [POINTER, INTEGER, POINTER]),
    "PyBytes_AsString": (POINTER, [POINTER]),
    "PyObject_Type": (POINTER, [POINTER]),
    "PyErr_Occurred": (POINTER, []),
    "PyErr_BadArgument": (SHORT, []),
    "PyObject_GetBuffer": (SHORT, [POINTER, POINTER, SHORT]),
    "PyBuffer_Release": (ir.VoidType(), [POINTER]),
    "PyEval_SaveThread": (POINTER, []),
    "PyEval_RestoreThread": (ir.VoidType(), [POINTER]),
    "Py_DecRef": (ir.VoidType(), [POINTER]),
}  # fmt: skip
"""Functions of Python's C interface that the machine code calls."""
OPERATIONS: dict[str, Callable[..., Any]] = {
    **OPERATORS,
    "where": select,
    **{name: getattr(vector_math, name, None) or UFUNCS[name] for name in FUNCTIONS},
}


def module(kind: str, program: Program, lanes: int) -> str:
    """The function "one" or "batch" as LLVM assembly.

    ``one(*INPUTS)`` takes numbers of the types SCALARS, raises TypeError for others, and returns the six forces as floats.
    ``batch(*INPUTS, forces, first, last)`` takes buffers of doubles, each of a single number or of one per condition, and writes
    conditions ``first`` to ``last`` of the buffer ``forces`` (6, n), ``lanes`` at a time; n is not less. Other threads may run.
    """
    text = ir.Module(name=kind)
    signature = ir.FunctionType(POINTER, [POINTER, POINTER.as_pointer(), INTEGER])
    body = ir.IRBuilder(ir.Function(text, signature, kind).append_basic_block())
    if kind == "one":
        _one(_Caller(body), program)
    else:
        _batch(_Caller(body), program, lanes)
    return str(text)


class _Caller:
    """Writes calls of Python's C interface, and reads the arguments of the function."""

    def __init__(self, builder: ir.IRBuilder):
        self.builder = builder
        self.bound, self.arguments, self.count = builder.function.args

    def call(self, name: str, *arguments: ir.Value) -> ir.Value:
        """Call a function of the interface."""
        known = self.builder.module.globals.get(name)
        result, kinds = API[name]
        return self.builder.call(
            known or ir.Function(self.builder.module, ir.FunctionType(result, kinds), name), arguments
        )

    def argument(self, i: int) -> ir.Value:
        """The i-th argument, a Python object."""
        return self.builder.load(self.builder.gep(self.arguments, [ir.Constant(INTEGER, i)]))

    def leave_if(self, failed: ir.Value, *, before: Callable[[], object] = lambda: None) -> None:
        """Return to Python with the error that is set, if ``failed``."""
        with self.builder.if_then(failed, likely=False):
            before()
            self.builder.ret(ir.Constant(POINTER, None))

    def expect(self, count: int) -> None:
        """Set an error and return unless there are ``count`` arguments."""
        wrong = self.builder.icmp_signed("!=", self.count, ir.Constant(INTEGER, count))
        self.leave_if(wrong, before=lambda: self.call("PyErr_BadArgument"))

    def expect_scalars(self, behind: int) -> None:
        """Set an error and return unless every argument is of a known type; the types are behind that many constants."""
        types = self.builder.bitcast(self.call("PyBytes_AsString", self.bound), INTEGER.as_pointer())
        known = [
            self.builder.load(self.builder.gep(types, [ir.Constant(INTEGER, behind + k)]))
            for k in range(len(SCALARS))
        ]
        every = ir.Constant(ir.IntType(1), 1)
        for i in range(len(INPUTS)):
            type_ = self.call("PyObject_Type", self.argument(i))
            address = self.builder.ptrtoint(type_, INTEGER)
            self.call("Py_DecRef", type_)
            same = [self.builder.icmp_unsigned("==", address, one) for one in known]
            every = self.builder.and_(every, functools.reduce(self.builder.or_, same))
        self.leave_if(self.builder.not_(every), before=lambda: self.call("PyErr_BadArgument"))

    def failed(self) -> ir.Value:
        """Whether an error is set."""
        return self.builder.icmp_unsigned("!=", self.call("PyErr_Occurred"), ir.Constant(POINTER, None))

    def constants(self) -> ir.Value:
        """Address of the tyre's constants."""
        return self.builder.bitcast(self.call("PyBytes_AsString", self.bound), DOUBLE.as_pointer())


def _one(python: _Caller, program: Program) -> None:
    builder = python.builder
    python.expect(len(INPUTS))
    python.expect_scalars(len(program.constants))
    given = [python.call("PyFloat_AsDouble", python.argument(i)) for i in range(len(INPUTS))]
    python.leave_if(python.failed())
    inputs = {name: in_every_lane(builder, PAIR, x) for name, x in zip(INPUTS, given, strict=True)}
    pairs = _computed(builder, program, python.constants(), inputs)
    forces = [builder.extract_element(pair, ir.Constant(SHORT, 0)) for pair in pairs]
    out = python.call("PyTuple_New", ir.Constant(INTEGER, len(forces)))
    python.leave_if(builder.icmp_unsigned("==", out, ir.Constant(POINTER, None)))
    for i, force in enumerate(forces):
        python.call("PyTuple_SetItem", out, ir.Constant(INTEGER, i), python.call("PyFloat_FromDouble", force))
    python.leave_if(python.failed(), before=lambda: python.call("Py_DecRef", out))
    builder.ret(out)


def _batch(python: _Caller, program: Program, lanes: int) -> None:
    builder, count = python.builder, len(INPUTS)
    python.expect(count + 3)
    views = [builder.alloca(BUFFER) for _ in range(count + 1)]
    for view in views:
        builder.store(ir.Constant(BUFFER, None), view)
    buffers = [builder.bitcast(view, POINTER) for view in views]

    def release() -> None:
        for buffer in buffers:
            python.call("PyBuffer_Release", buffer)  # releasing an empty buffer has no effect

    for i, buffer in enumerate(buffers):
        writable = ir.Constant(SHORT, int(i == count))
        status = python.call("PyObject_GetBuffer", python.argument(i), buffer, writable)
        python.leave_if(builder.icmp_signed("<", status, ir.Constant(SHORT, 0)), before=release)
    first, last = (python.call("PyLong_AsSsize_t", python.argument(count + i)) for i in (1, 2))
    python.leave_if(python.failed(), before=release)

    vector = ir.VectorType(DOUBLE, lanes)
    inputs = {name: _input(builder, vector, view) for name, view in zip(INPUTS, views, strict=False)}
    forces, size = _address_and_size(builder, views[-1])
    stride = builder.udiv(size, ir.Constant(INTEGER, 8 * len(program.outputs)))
    constants = python.constants()
    thread = python.call("PyEval_SaveThread")
    _loop(builder, program, constants, _Conditions(vector, inputs, forces, stride, first, last))
    python.call("PyEval_RestoreThread", thread)
    release()
    builder.ret(python.call("PyLong_FromLong", ir.Constant(INTEGER, 0)))


def _address_and_size(builder: ir.IRBuilder, view: ir.Value) -> tuple[ir.Value, ir.Value]:
    zero = ir.Constant(SHORT, 0)
    words = [builder.load(builder.gep(view, [zero, ir.Constant(SHORT, i)])) for i in (0, 2)]
    return builder.inttoptr(words[0], DOUBLE.as_pointer()), words[1]


def _input(builder: ir.IRBuilder, vector: ir.VectorType, view: ir.Value) -> tuple[ir.Value, ir.Value]:
    """Address of an input and its step between conditions; a scalar is repeated in a vector of its own."""
    address, size = _address_and_size(builder, view)
    repeated = builder.alloca(vector)
    builder.store(in_every_lane(builder, vector, builder.load(address)), repeated)
    single = builder.icmp_unsigned("==", size, ir.Constant(INTEGER, 8))
    return (
        builder.select(single, builder.bitcast(repeated, DOUBLE.as_pointer()), address),
        builder.select(single, ir.Constant(INTEGER, 0), ir.Constant(INTEGER, 1)),
    )


class _Conditions(NamedTuple):
    """Where the numbers of a loop are."""

    vector: ir.VectorType
    inputs: Mapping[str, tuple[ir.Value, ir.Value]]  #: address and step of each
    forces: ir.Value  #: their address
    stride: ir.Value  #: from one force to the next
    first: ir.Value  #: condition
    last: ir.Value  #: behind the last condition


def _loop(builder: ir.IRBuilder, program: Program, constants: ir.Value, of: _Conditions) -> None:
    """Loop over vectors; the last one overlaps the one before, so that it is full."""
    vector, inputs, address, stride, first, last = of
    before = builder.block
    loop, done = builder.append_basic_block("conditions"), builder.append_basic_block("done")
    lanes = ir.Constant(INTEGER, vector.count)
    builder.cbranch(builder.icmp_signed("<", first, last), loop, done)
    builder.position_at_end(loop)
    at = builder.phi(INTEGER)
    latest = builder.sub(last, lanes)
    latest = builder.select(
        builder.icmp_signed("<", latest, ir.Constant(INTEGER, 0)), ir.Constant(INTEGER, 0), latest
    )
    begin = builder.select(builder.icmp_signed("<", at, latest), at, latest)
    given = {
        name: builder.load(_as_vector(builder, vector, x, builder.mul(begin, step)), align=8)
        for name, (x, step) in inputs.items()
    }
    found = _computed(builder, program, constants, given)
    for i, force in enumerate(found):
        row = builder.mul(stride, ir.Constant(INTEGER, i))
        builder.store(force, _as_vector(builder, vector, address, builder.add(row, begin)), align=8)
    following = builder.add(at, lanes)
    at.add_incoming(first, before)
    at.add_incoming(following, builder.block)
    builder.cbranch(builder.icmp_signed("<", following, last), loop, done)
    builder.position_at_end(done)


def _as_vector(builder: ir.IRBuilder, vector: ir.VectorType, address: ir.Value, offset: ir.Value) -> ir.Value:
    return builder.bitcast(builder.gep(address, [offset]), vector.as_pointer())


def _computed(
    builder: ir.IRBuilder, program: Program, constants: ir.Value, inputs: Mapping[str, ir.Value]
) -> Sequence[ir.Value]:
    """The outputs of the program, one condition per lane of the inputs."""
    type_ = next(iter(inputs.values())).type
    written = builder.block.instructions
    before = len(written)
    known: dict[int, Any] = {}
    for i, node in enumerate(program.constants):
        x = builder.load(builder.gep(constants, [ir.Constant(INTEGER, i)]))
        known[node.number] = VectorValue(builder, in_every_lane(builder, type_, x))
    symbols = {name: VectorValue(builder, x) for name, x in inputs.items()}
    results = computed(program.per_point, program.outputs.values(), OPERATIONS, symbols, known)
    written[before:] = _longest_way_first(written[before:])
    return [x.value if isinstance(x, VectorValue) else repeated(type_, x) for x in results]


def _longest_way_first(instructions: Sequence[ir.Instruction]) -> list[ir.Instruction]:
    """Instructions, those with the longest way to a result first, so that neighbours seldom wait for each other.

    A processor that looks some hundred instructions ahead then always finds work. LLVM alone follows the order of the equations.
    """
    takes = [
        SLOW if i.opname == "fdiv" or (i.opname == "call" and "sqrt" in i.callee.name) else 1
        for i in instructions
    ]
    place = {id(instruction): k for k, instruction in enumerate(instructions)}
    way = takes.copy()
    for k in reversed(range(len(instructions))):
        for earlier in (place.get(id(x)) for x in instructions[k].operands):
            if earlier is not None:
                way[earlier] = max(way[earlier], takes[earlier] + way[k])
    return [instructions[k] for k in sorted(range(len(instructions)), key=lambda k: -way[k])]
