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


def array_function(made: ExportedTyre, outputs: tuple[str, ...], xp: Any) -> Callable[..., Any]:
    """The tyre as a function of arrays of ``xp``; see :meth:`tir.Tyre.array_function`."""

    def number(x: Any) -> Any:
        """A plain number, or an array of numpy, in double precision; any other array as it is, with what traces it."""
        own = hasattr(x, "dtype") and not isinstance(x, np.ndarray | np.generic)
        return x if own else xp.asarray(x, dtype=float)

    def where(chosen: Any, a: Any, b: Any) -> Any:
        return xp.where(chosen, number(a), number(b))

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
    signature = Signature(given)
    result: Any = Forces if outputs == Forces._fields else namedtuple("Outputs", outputs)

    def function(*args: Any, **more: Any) -> Any:
        bound = signature.bind(*args, **more)
        bound.apply_defaults()
        inputs = dict(zip(starts, map(number, bound.arguments.values()), strict=True))
        return result(*map(number, run(program, operations, inputs)))

    function.__signature__ = signature  # type: ignore[attr-defined]
    return function
