"""Words for the numbers of a fit and of a diagnosis: people read these instead of keys of the rig."""

from __future__ import annotations

from mffit.rig_errors import BY_NAME as RIG_ERRORS
from mffit.rig_errors import OF_RUN, UNITS, WORDS
from tir.parameters import BY_NAME


def of_rig(name: str) -> str:
    """Words for a number of the rig, of all runs or of one; empty for a coefficient of the tyre."""
    fault, of_run, run = name.partition(OF_RUN)
    words = WORDS.get(fault, "")
    return f"{words}, {run}" if of_run and words else words


def of_number(name: str) -> str:
    """Words for a number of the rig; a coefficient of the tyre keeps its name."""
    return of_rig(name) or name


def unit_of(name: str) -> str:
    """Unit of a coefficient or of a number of the rig; empty without one."""
    fault = name.partition(OF_RUN)[0]
    unit = UNITS[fault] if fault in RIG_ERRORS else BY_NAME[name].unit if name in BY_NAME else ""
    return "" if unit == "-" else unit
