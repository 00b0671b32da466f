"""Calls of a tyre: a scalar call in Python floats, arrays in blocks, other numbers directly through the equations.

Real numbers use code generated from the equations where that is faster. Complex and traced numbers, which derivatives
need, use :func:`tir.evaluate.evaluate`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from itertools import repeat
from operator import itemgetter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from tir import constants, kernels
from tir.codegen import single
from tir.codegen.cpython import SCALARS, kernel
from tir.codegen.cpython.kernel import LANES
from tir.codegen.program import INPUTS, NUMBERS, Switches, refuse_zero_divisors
from tir.codegen.replay import Replay, replay
from tir.equations.forces import Forces, State
from tir.equations.normalise import OperatingCondition
from tir.errors import TirError
from tir.evaluate import unchecked
from tir.inputs import arrays_of
from tir.record import TyreRecord

if TYPE_CHECKING:
    from tir.codegen.lag import ContactLag

Function = Callable[..., Any]
Made = TypeVar("Made")
BLOCK = int(constants.CONDITIONS_PER_BLOCK)
PER_CALL = int(constants.CONDITIONS_PER_CALL)
FEW = int(constants.CONDITIONS_ONE_BY_ONE)
FORCES, STATE = Forces._fields, State._fields
OF_CONTACT = ("K_xk", "K_ya", "mu_x", "mu_y", "sigma_x", "sigma_y")
"""States that the lag of the contact needs."""
DOUBLE = np.dtype(float)
ONLY_DOUBLES = {DOUBLE}
ROWS = itemgetter(*range(len(FORCES)))
"""The rows of an array, in half the time of unpacking it."""


def compile_kernels(*, turn_slip: bool | None = None, star: bool = False, limits: bool = False) -> None:
    """Compile the model to machine code, or load it from the cache, for all later calls in this process.

    Otherwise this happens automatically after some thousand scalar calls or some hundred thousand conditions; until then arrays
    use numpy and scalar calls Python's floats.

    Parameters
    ----------
    turn_slip : True: for calls with turn slip; False: without; None: both
    star, limits : for calls with these switches

    Raises
    ------
    TirError
        If llvmlite is not installed (``pip install llvmlite``) or cannot be used here.
    """
    for on in (False, True) if turn_slip is None else (turn_slip,):
        for kind in kernel.KINDS:
            kernels.meter(kind, Switches(on, star, limits)).load()


def forces(tyre: TyreRecord, inputs: Sequence[Any], switches: Switches) -> Forces[Any]:
    """Forces for :data:`~tir.codegen.program.INPUTS`, every one given; see :meth:`tir.Tyre.__call__`."""
    found = _by_formula(tyre, inputs, switches)
    return found if tyre.correction is None else tyre.correction.added(found, inputs, limits=switches.limits)


def _by_formula(tyre: TyreRecord, inputs: Sequence[Any], switches: Switches) -> Forces[Any]:
    arrays = arrays_of(inputs)
    if {a.dtype for a in arrays} != ONLY_DOUBLES:
        if not _real(arrays):
            return Forces(*_evaluated(tyre, _of_any_kind(inputs, arrays), switches, FORCES))
        arrays = [a.astype(float, copy=False) for a in arrays]
    shapes = {a.shape for a in arrays}
    shapes.discard(())
    if not shapes:
        return Forces(*_one(tyre, arrays, switches, FORCES))
    shape = shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes, *(a.shape for a in arrays))
    flat = arrays
    if shapes or len(shape) > 1:
        flat = [a if a.ndim == 0 else np.broadcast_to(a, shape).reshape(-1) for a in arrays]
    out = _many(tyre, flat, math.prod(shape), switches)
    if out is None:
        return Forces(*_evaluated(tyre, arrays, switches, FORCES))
    return tuple.__new__(Forces, ROWS(out if len(shape) == 1 else out.reshape(len(FORCES), *shape)))


def state(tyre: TyreRecord, inputs: Sequence[Any], switches: Switches) -> State[Any]:
    """State for the same; see :meth:`tir.Tyre.state`."""
    arrays = arrays_of(inputs)
    if _real(arrays) and all(a.shape == () for a in arrays):
        return State(*_one(tyre, arrays, switches, STATE))
    return State(*_evaluated(tyre, _of_any_kind(inputs, arrays), switches, STATE))


def _of_any_kind(inputs: Sequence[Any], arrays: Sequence[np.ndarray]) -> list[Any]:
    """Inputs for the equations: numpy numbers, except traced ones, which are passed on unchanged."""
    return [x if a.dtype == object else a[()] for x, a in zip(inputs, arrays, strict=True)]


def _real(arrays: Sequence[np.ndarray]) -> bool:
    return all(a.dtype.kind in "fiub" for a in arrays)


def _one(
    tyre: TyreRecord, inputs: Sequence[np.ndarray], switches: Switches, outputs: tuple[str, ...]
) -> tuple[Any, ...]:
    """Outputs of a scalar call as floats; NaN or infinity, as numpy has them, where Python's arithmetic raises."""
    numbers = [float(x) for x in inputs]
    run = function_of(tyre, switches, outputs)
    try:
        if run is not None:
            found: tuple[Any, ...] = run(*numbers)
            return found
    except (ArithmeticError, ValueError):
        pass
    return tuple(map(_plain, _evaluated(tyre, [np.float64(x) for x in numbers], switches, outputs)))


def _evaluated(
    tyre: TyreRecord, inputs: Sequence[Any], switches: Switches, outputs: tuple[str, ...]
) -> tuple[Any, ...]:
    """Outputs by the equations in numpy; with parameters as numpy numbers if Python's arithmetic raises."""
    refuse_zero_divisors(tyre.p, switches, outputs)
    at = OperatingCondition(*inputs)
    with np.errstate(all="ignore"):
        try:
            forces, state = unchecked(tyre.p, at, switches)
        except ArithmeticError:
            numbers = {k: np.float64(v) if type(v) in (float, int) else v for k, v in vars(tyre.p).items()}
            forces, state = unchecked(SimpleNamespace(**numbers), at, switches)
    return tuple(getattr(forces if name in FORCES else state, name) for name in outputs)


def _plain(x: Any) -> Any:
    return x.item() if isinstance(x, np.ndarray | np.generic) and np.ndim(x) == 0 else x


def function_of(tyre: TyreRecord, switches: Switches, outputs: tuple[str, ...] = FORCES) -> Function | None:
    """The tyre as a function of floats, cached in the tyre; None if a parameter is not a real number."""

    def made(values: dict[str, float]) -> Function:
        if key is not switches:
            return single.run_of(values, switches, outputs)
        loaded = kernels.meter("one", switches).kernel()
        if loaded is not None:
            return loaded.run_of(values)
        return _counted(tyre.prepared, single.run_of(values, switches, outputs), values, switches)

    key = switches if outputs is FORCES and tyre.correction is None else (outputs, switches)
    return _prepared(tyre, key, switches, outputs, made)


def _counted(
    prepared: dict[Any, Any], run: Function, values: dict[str, float], switches: Switches
) -> Function:
    """The function for plain numbers, which replaces itself in ``prepared`` by the kernel once that is loaded.

    Like the kernel, it raises TypeError for arguments that are not :data:`~tir.codegen.cpython.SCALARS`.
    """
    meter = kernels.meter("one", switches)

    def counting(*given: Any) -> tuple[float, ...]:
        if not SCALARS.issuperset(map(type, given)):
            raise TypeError("only plain numbers are computed here")
        meter.left -= 1
        if meter.left <= 0:
            loaded = meter.kernel()
            if loaded is not None:
                prepared[switches] = faster = loaded.run_of(values)
                return faster(*given)  # type: ignore[no-any-return]
        return run(*map(float, given))  # type: ignore[no-any-return]

    return counting


def _kernel_for(tyre: TyreRecord, n: int, switches: Switches) -> Function | None:
    """The array kernel bound to the tyre, cached in the tyre; None if it is not loaded or a parameter is not a real number."""
    bound: Function | None = tyre.prepared.get(("batch", switches))
    if bound is not None:
        return bound
    meter = kernels.meter("batch", switches)
    if meter.loaded is None:
        meter.left -= n + PER_CALL * min(1.0, n / FEW)
    loaded = meter.kernel()
    return None if loaded is None else _prepared(tyre, ("batch", switches), switches, FORCES, loaded.run_of)


def lag_of(tyre: TyreRecord, switches: Switches) -> ContactLag:
    """The lag of the tyre's contact, cached in the tyre; without a correction.

    Raises
    ------
    TirError
        If a parameter is not a real number.
    """

    def lag(values: dict[str, float]) -> ContactLag:
        from tir.codegen.lag import lag_functions  # imported late, so that import tir is quick

        return lag_functions(values, switches)

    if ("lag", switches) not in tyre.prepared:
        tyre.leave_correction("the lag of the contact")
    found = _prepared(tyre, ("lag", switches), switches, (*FORCES, *OF_CONTACT), lag)
    if found is None:
        raise TirError("the lag of the contact is computed for real parameters only")
    return found


def _prepared(
    tyre: TyreRecord,
    key: Hashable,
    switches: Switches,
    outputs: tuple[str, ...],
    made: Callable[[dict[str, float]], Made],
) -> Made | None:
    """A function prepared from the parameters as floats, cached in the tyre; None if one is not a real number."""
    if key not in tyre.prepared:
        values = _values(tyre, switches, outputs)
        tyre.prepared[key] = None if values is None else made(values)
    found: Made | None = tyre.prepared[key]
    return found


def _values(tyre: TyreRecord, switches: Switches, outputs: tuple[str, ...]) -> dict[str, float] | None:
    """The parameters as floats; None if one is not a real number. Refuses zeros by which the outputs are divided."""
    refuse_zero_divisors(tyre.p, switches, outputs)
    given = {name: tyre.values[name] for name in NUMBERS}
    if not all(isinstance(x, float | int | np.floating | np.integer) for x in given.values()):
        return None
    return {name: float(x) for name, x in given.items()}


def _many(tyre: TyreRecord, inputs: Sequence[np.ndarray], n: int, switches: Switches) -> np.ndarray | None:
    """Forces (6, n) of inputs that are scalars or (n,); None if a parameter is not a real number."""
    run = _kernel_for(tyre, n, switches)
    if run is not None:
        return _in_vectors(run, inputs, n)
    if 0 < n < FEW and (found := _one_by_one(tyre, inputs, switches)) is not None:
        return found
    values = _prepared(tyre, ("values", switches), switches, FORCES, dict)
    return None if values is None else _in_numpy(replay(switches, FORCES), values, inputs, n)


def _one_by_one(tyre: TyreRecord, inputs: Sequence[np.ndarray], switches: Switches) -> np.ndarray | None:
    """Forces (6, n) by scalar calls; None if a parameter is not a real number, or Python's arithmetic raises."""
    run = function_of(tyre, switches)
    if run is None:
        return None
    rows = zip(*(x.tolist() if x.ndim else repeat(x.item()) for x in inputs), strict=False)
    try:
        return np.array([*zip(*(run(*row) for row in rows), strict=True)])
    except (ArithmeticError, ValueError):
        return None


def _in_numpy(program: Replay, values: dict[str, float], inputs: Sequence[np.ndarray], n: int) -> np.ndarray:
    out = np.empty((len(FORCES), n))
    for start in range(0, n, BLOCK):
        block = (x[()] if x.ndim == 0 else x[start : start + BLOCK] for x in inputs)
        found = program({**values, **dict(zip(INPUTS, block, strict=True))})
        for row, force in zip(out, found, strict=True):
            row[start : start + BLOCK] = force
    return out


def _in_vectors(run: Function, inputs: Sequence[np.ndarray], n: int) -> np.ndarray:
    out = np.empty((len(FORCES), max(n, LANES)))
    if n < LANES:
        padded = [x if x.ndim == 0 else np.append(x, np.ones(LANES - n)) for x in inputs]
        run(*padded, out, 0, LANES)
        return out[:, :n]
    try:
        run(*inputs, out, 0, n)
    except (ValueError, BufferError):  # the numbers of an array are not one behind the other
        run(*(np.asarray(x, order="C") for x in inputs), out, 0, n)
    return out
