"""A tyre for other programs: C source files, functional mock-up units (FMI 2.0 and 3.0), MATLAB functions, lookup tables.

The equations come from ``tir``; this folder adds names, units, files and the call of a compiler.
"""

from mffit.export.code import write_c, write_matlab
from mffit.export.fmu import write_fmu
from mffit.export.table import write_table
