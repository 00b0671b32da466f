"""Read, write and evaluate MF-6.2 tyre property files.

>>> import tir
>>> tyre = tir.Tyre.from_values({"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3})
>>> bool(tyre(1500.0, alpha=0.02).Fy < 0)
True
"""

from tir import transient
from tir.calls import compile_kernels
from tir.checking import check
from tir.codegen.c99 import export_c
from tir.codegen.casadi import casadi_function
from tir.codegen.matlab import export_matlab
from tir.equations.forces import Forces, State
from tir.errors import Problem, TirError, TirWarning
from tir.record import Quantity
from tir.tyre import Tyre, read

__all__ = [
    "Forces",
    "Problem",
    "Quantity",
    "State",
    "TirError",
    "TirWarning",
    "Tyre",
    "casadi_function",
    "check",
    "compile_kernels",
    "export_c",
    "export_matlab",
    "read",
    "transient",
]
