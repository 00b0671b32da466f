"""Words for the numbers of a fit and of a diagnosis: people read these instead of keys of the rig."""

from __future__ import annotations

from mffit.rig_errors import error_of, words_of
from mffit.rig_errors import unit_of as rig_unit_of
from tir.parameters import BY_NAME


def of_rig(name: str) -> str:
    """Words for a number of the rig, of the whole test, or of one run or set-up; empty for a coefficient of the tyre."""
    return words_of(name)


def of_number(name: str) -> str:
    """Words for a number of the rig; a coefficient of the tyre keeps its name."""
    return of_rig(name) or name


def unit_of(name: str) -> str:
    """Unit of a coefficient or of a number of the rig; empty without one."""
    unit = rig_unit_of(name) if error_of(name) else BY_NAME[name].unit if name in BY_NAME else ""
    return "" if unit == "-" else unit
