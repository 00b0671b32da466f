"""A tyre as a function of an array library, to be differentiated by it, from the same equations as CasADi's."""

from collections import namedtuple
from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

import numpy as np

from tir.codegen.library import operations_of, run
from tir.codegen.program import called
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.exporting import ExportedTyre
from tir.inputs import of_library

WITHOUT_VALUE = ("phi_t", "Vx", "pressure")
"""Inputs that a call takes without a value, as None."""


def array_function(made: ExportedTyre, outputs: tuple[str, ...], xp: Any) -> Callable[..., Any]:
    """The tyre as a function of arrays of ``xp``; see :meth:`tir.Tyre.array_function`."""

    def array(x: Any) -> Any:
        """A number of the program as an array, and any array as it is."""
        return x if hasattr(x, "dtype") else xp.asarray(x, dtype=float)

    def where(chosen: Any, a: Any, b: Any) -> Any:
        return xp.where(chosen, array(a), array(b))

    def absolute(x: Any) -> Any:
        """With slope 0 at zero: the mean of both sides, as in CasADi; some libraries take that of one side."""
        return x * xp.sign(x)

    try:
        operations = operations_of(xp, where, absolute=absolute)
    except AttributeError as error:
        raise TirError(
            f"{xp!r} is no array library ({error}): give numpy, jax.numpy, torch or cupy"
        ) from None
    program, starts = made.program(outputs), made.starts
    given = [Parameter(called(x), Parameter.POSITIONAL_OR_KEYWORD, default=starts[x]) for x in starts]
    signature = Signature([given[0].replace(default=Parameter.empty), *given[1:]])
    result: Any = Forces if outputs == Forces._fields else namedtuple("Outputs", outputs)

    def function(*args: Any, **more: Any) -> Any:
        bound = signature.bind(*args, **more)
        bound.apply_defaults()
        named = {
            name: starts[name] if x is None and name in WITHOUT_VALUE else x
            for name, x in zip(starts, bound.arguments.values(), strict=True)
        }
        inputs = {name: of_library(name, x, xp) for name, x in named.items()}
        with np.errstate(all="ignore"):
            return result(*map(array, run(program, operations, inputs)))

    function.__signature__ = signature  # type: ignore[attr-defined]
    return function
