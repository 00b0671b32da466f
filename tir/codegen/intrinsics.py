"""Single instructions that numba does not offer as functions. Imports numba, so import this module late."""

from __future__ import annotations

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

OPTIONS = {"fastmath": {"contract"}, "error_model": "numpy"}
"""Products and sums may be one instruction; a division by zero is inf or NaN."""
compiled = njit(forceinline=True, **OPTIONS)


@intrinsic
def select(typing, chosen, a, b):
    """a where chosen, else b; both are computed, so that no branch stands in the way of vector instructions."""

    def code(context, builder, signature, arguments):
        chosen, a, b = (
            context.cast(builder, value, given, wanted)
            for value, given, wanted in zip(
                arguments, signature.args, (types.boolean, types.float64, types.float64), strict=True
            )
        )
        return builder.select(chosen, a, b)

    return types.float64(types.boolean, types.float64, types.float64), code


@intrinsic
def bits(typing, x):
    """The bits of a float64."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), code


@intrinsic
def number(typing, x):
    """The float64 of these bits."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), code
