"""The model for many operating conditions in numpy: only what the forces need, and no array longer than it is needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from tir.codegen.program import Switches, trace
from tir.codegen.single import NUMPY, constants
from tir.codegen.source import COMMON, Dialect, conditions, preparation
from tir.equations.forces import Forces

Run = Callable[..., tuple[Any, ...]]
DIALECT = Dialect(
    {**COMMON, "where": "where({}, {}, {})", "both": "({} & {})", "absolute": "absolute({})"}, release=True
)


@cache
def _compiled(switches: Switches) -> tuple[Any, Any]:
    program, namespace = (
        trace(switches, Forces._fields),
        {**NUMPY, "where": np.where, "absolute": np.absolute},
    )
    exec(preparation(program) + conditions(program, DIALECT), namespace)
    return namespace["prepare"], namespace["make"]


def run_of(values: Mapping[str, float], switches: Switches) -> Run:
    """The tyre's forces as a function of :data:`~tir.codegen.program.INPUTS` in arrays (n,) and numpy's floats."""
    prepare, make = _compiled(switches)
    run: Run = make(constants(prepare, values))
    return run
