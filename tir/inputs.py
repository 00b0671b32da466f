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
