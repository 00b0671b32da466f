"""Inputs of a call as arrays; what the equations cannot compute with is refused, with the way to the same in another form."""

import reprlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from tir.codegen.program import INPUTS, called
from tir.errors import TirError

WAYS = {
    "casadi": "for CasADi's symbols use tir.casadi_function(tyre)",
    "jax": "for what JAX traces use tyre.array_function(jax.numpy)",
    "torch": "for what torch differentiates use tyre.array_function(torch)",
}
"""By the package of an input's type."""


def arrays_of(inputs: Sequence[Any], names: Sequence[str] = INPUTS) -> list[np.ndarray]:
    """Real or complex arrays, of dtype object for numbers that record their operations; raises TirError for anything else."""
    return [_array(name, x) for name, x in zip(names, inputs, strict=True)]


def _array(name: str, x: Any) -> np.ndarray:
    if isinstance(x, np.ma.MaskedArray):
        raise _refused(
            name, x, f"its mask would be lost: give {called(name)}.filled(numpy.nan) or .compressed()"
        )
    try:
        array = np.asarray(x)
    except Exception:  # whatever a library raises where a value is asked for that it does not know yet
        array = np.empty((), dtype=object)
    if array.dtype.kind in "fiubc" or records(x):
        return array
    raise _refused(name, x, way_for(x) or "give a number or an array of numbers, such as float(x)")


def of_library(name: str, x: Any, xp: Any) -> Any:
    """An input for the array library ``xp``: its own arrays, and what it traces, as they are; else checked, in double precision.

    Raises TirError as :func:`arrays_of`, and for complex numbers, which no library differentiates as a call of the tyre does.
    """
    if _is_foreign(x) and xp is not np:
        return x if hasattr(x, "dtype") else xp.asarray(x, dtype=float)
    array = _array(name, x)
    if array.dtype.kind == "c":
        raise _refused(name, x, "for complex numbers call the tyre")
    return x if records(x) else xp.asarray(array, dtype=float)


def _is_foreign(x: Any) -> bool:
    """Whether it is an array of another library than numpy, or has one in a list."""
    if isinstance(x, list | tuple):
        return any(map(_is_foreign, x))
    return hasattr(x, "dtype") and not isinstance(x, np.ndarray | np.generic)


def switch_of(name: str, x: Any) -> bool:
    """A switch of a call; raises TirError for what is neither True nor False."""
    if isinstance(x, bool | np.bool_ | int) and x in (0, 1):
        return bool(x)
    raise TirError(f"{name} is {reprlib.repr(x)}: give True or False", name=name)


def records(x: Any) -> bool:
    """Whether a number records the operations of numpy that are applied to it."""
    return isinstance(x, np.lib.mixins.NDArrayOperatorsMixin)


def way_for(x: Any) -> str:
    """How the tyre is called with a number of another library; empty if there is no such way."""
    return WAYS.get(type(x).__module__.partition(".")[0].removesuffix("lib"), "")


def _refused(name: str, x: Any, way: str) -> TirError:
    return TirError(
        f"{called(name)} is {reprlib.repr(x)}, with which no force can be computed: {way}", name=name
    )
