"""The model for many operating conditions in numpy: only what the forces need, and no array longer than it is needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from tir.codegen.program import Switches, trace
from tir.codegen.single import NUMPY, Run, constants, with_defaults
from tir.codegen.source import COMMON, Dialect, conditions, preparation
from tir.equations.forces import Forces

DIALECT = Dialect(
    {**COMMON, "where": "where({}, {}, {})", "both": "({} & {})", "absolute": "absolute({})"}, release=True
)


def _sin(x: Any) -> Any:
    t = np.tan(0.5 * x)
    square = 1.0 + t * t
    t *= 2.0
    t /= square
    return t


def _cos(x: Any) -> Any:
    t = np.tan(0.5 * x)
    square = t * t
    cosine = 1.0 - square
    square += 1.0
    cosine /= square
    return cosine


def _functions() -> dict[str, Callable[..., Any]]:
    """numpy's; where it has the tangent as vector instructions (AVX-512), sine and cosine come from that of half the angle.

    numpy computes the sine and cosine of doubles one by one, for their last bit, which takes six times as long.
    """
    found = {**NUMPY, "where": np.where, "absolute": np.absolute}
    return {**found, "sin": _sin, "cos": _cos} if _tangent_in_vectors() else found


def _tangent_in_vectors() -> bool:
    """Whether numpy says so; older ones do not say."""
    if not hasattr(np.lib, "introspect"):
        return False
    kinds = np.lib.introspect.opt_func_info(func_name="^tan$", signature="^d").get("tan", {}).values()
    return any("baseline" not in kind["current"] for kind in kinds)


@cache
def _compiled(switches: Switches) -> tuple[Any, Any]:
    program, namespace = trace(switches, Forces._fields), _functions()
    exec(preparation(program) + conditions(program, DIALECT), namespace)
    return namespace["prepare"], namespace["run"]


def run_of(values: Mapping[str, float], switches: Switches) -> Run:
    """The tyre's forces as a function of :data:`~tir.codegen.program.INPUTS` in arrays (n,) and numpy's floats."""
    prepare, run = _compiled(switches)
    return with_defaults(run, constants(prepare, values))
