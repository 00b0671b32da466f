"""A tyre for other programs: C source files, functional mock-up units (FMI 2.0 and 3.0), and lookup tables.

The equations come from ``tir.export_c``; this folder adds names, units, files and the call of a compiler.
"""

from mffit.export.c import write_c
from mffit.export.fmu import write_fmu
from mffit.export.table import write_table

__all__ = ["write_c", "write_fmu", "write_table"]
